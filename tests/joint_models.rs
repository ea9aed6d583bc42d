//! Small structures with joints, as systems for exact orbits.

use std::sync::Arc;

use contact::{FrictionContact, FrictionContactParameters, JointLaw};
use faer::mat;
use hbm::{Contact, Direction, Excitation, ExcitationKind, Problem};
use num_complex::Complex64;
use orbit::{Joint, Load, Orbit, System};

use crate::model;
use crate::orbit_models::load;

/// k_t, k_n, μ of all joints here.
pub const JOINT: FrictionContactParameters = FrictionContactParameters {
    tangential_stiffness: 3e5,
    normal_stiffness: 2e5,
    friction_coefficient: 0.4,
    preload: None,
    gap: None,
};

/// The law with a preload in N.
pub fn preloaded(preload: f64) -> FrictionContactParameters {
    FrictionContactParameters { preload: Some(preload), ..JOINT }
}

/// The law with a gap in m.
pub fn with_gap(gap: f64) -> FrictionContactParameters {
    FrictionContactParameters { gap: Some(gap), ..JOINT }
}

/// One mass with a tangential (0) and a normal (1) dof on a coupled support, against the ground.
pub fn one_mass(parameters: FrictionContactParameters) -> System {
    let law: Arc<dyn JointLaw> = Arc::new(FrictionContact::new(parameters, 1).unwrap());
    let directions = vec![vec![(0, 1.0)], vec![(1, 1.0)]];
    System {
        mass: mat![[1.0, 0.0], [0.0, 1.0]],
        damping: mat![[20.0, 0.0], [0.0, 30.0]],
        stiffness: mat![[2e5, 3e4], [3e4, 4e5]],
        loads: vec![load(0, 1, 12.0), Load { dof: 1, harmonic: 1, amplitude: Complex64::new(4.0, 9.0) }],
        contacts: Vec::new(),
        joints: vec![Joint { name: "pad".into(), directions, law, scale: 1.0 }],
    }
}

/// A blade (tangential 0) over a root (tangential 1, normal 2) that is pressed against its disc at an angle.
pub fn root(parameters: FrictionContactParameters) -> System {
    let law: Arc<dyn JointLaw> = Arc::new(FrictionContact::new(parameters, 1).unwrap());
    let directions = vec![vec![(1, 0.8), (2, -0.6)], vec![(1, 0.6), (2, 0.8)]];
    System {
        mass: mat![[0.8, 0.0, 0.0], [0.0, 1.6, 0.1], [0.0, 0.1, 1.6]],
        damping: mat![[9.0, -3.0, 0.0], [-3.0, 25.0, 0.0], [0.0, 0.0, 25.0]],
        stiffness: mat![[1.2e5, -1.2e5, 0.0], [-1.2e5, 4e5, 2e4], [0.0, 2e4, 5e5]],
        loads: vec![load(0, 1, 6.0), load(2, 2, 5.0), load(1, 0, 1.0)],
        contacts: Vec::new(),
        joints: vec![Joint { name: "flank".into(), directions, law, scale: 1.5 }],
    }
}

/// What one joint of an orbit does at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Instant {
    /// Relative displacements in m.
    pub tangential: f64,
    /// Likewise.
    pub normal: f64,
    /// Rig convention, in N.
    pub friction: f64,
    /// N.
    pub pressure: f64,
}

/// The first joint at time `t`.
pub fn instant(orbit: &Orbit, t: f64) -> Instant {
    Instant {
        tangential: orbit.joint_displacement(0, 0, t),
        normal: orbit.joint_displacement(0, 1, t),
        friction: -orbit.joint_force(0, 0, t),
        pressure: orbit.joint_pressure(0, t),
    }
}

/// The same structure for harmonic balance; all dofs are asked for.
pub fn balanced(system: &System) -> Problem {
    let excitation = |load: &Load| Excitation {
        dof: load.dof,
        harmonic: load.harmonic,
        amplitude: load.amplitude.norm(),
        phase: load.amplitude.arg(),
        kind: ExcitationKind::Force,
    };
    let contact = |contact: &orbit::Contact| Contact {
        name: contact.name.clone(),
        first: contact.first,
        second: contact.second,
        law: contact.law.clone(),
        scale: contact.scale,
    };
    let joint = |joint: &Joint| hbm::Joint {
        name: joint.name.clone(),
        directions: joint.directions.iter().map(|parts| Direction { parts: parts.clone() }).collect(),
        law: joint.law.clone(),
        scale: joint.scale,
    };
    Problem {
        model: model(system.mass.clone(), system.damping.clone(), system.stiffness.clone()),
        excitation: system.loads.iter().map(excitation).collect(),
        contacts: system.contacts.iter().map(contact).collect(),
        joints: system.joints.iter().map(joint).collect(),
        output: (0..system.mass.nrows()).collect(),
    }
}

/// A mass in a plane (0, 1) with a normal dof (2), pressed against the ground with friction in both tangential directions;
/// damped so that motions settle soon.
pub fn planar(parameters: FrictionContactParameters) -> System {
    let law: Arc<dyn JointLaw> = Arc::new(FrictionContact::new(parameters, 2).unwrap());
    let directions = (0..3).map(|dof| vec![(dof, 1.0)]).collect();
    System {
        mass: mat![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        damping: mat![[200.0, 0.0, 0.0], [0.0, 200.0, 0.0], [0.0, 0.0, 250.0]],
        stiffness: mat![[2e5, 0.0, 3e4], [0.0, 3e5, 0.0], [3e4, 0.0, 4e5]],
        loads: vec![
            load(0, 1, 18.0),
            Load { dof: 1, harmonic: 1, amplitude: Complex64::new(9.0, -5.0) },
            Load { dof: 2, harmonic: 1, amplitude: Complex64::new(4.0, 6.0) },
        ],
        contacts: Vec::new(),
        joints: vec![Joint { name: "pad".into(), directions, law, scale: 1.0 }],
    }
}
