//! A scene in the terms of exact orbits.

use std::f64::consts::TAU;

use hbm::{Excitation, ExcitationKind, Problem};
use num_complex::Complex64;
use orbit::{Contact, Joint, Load, System};

/// The system of `problem` at `hertz`: its matrices, its excitation as forces on dofs, its contacts and joints.
pub fn system(problem: &Problem, hertz: f64) -> System {
    let model = &problem.model;
    let omega = TAU * hertz;
    let contact = |contact: &hbm::Contact| Contact {
        name: contact.name.clone(),
        first: contact.first,
        second: contact.second,
        law: contact.law.clone(),
        scale: contact.scale,
    };
    let joint = |joint: &hbm::Joint| Joint {
        name: joint.name.clone(),
        directions: joint.directions.iter().map(|direction| direction.parts.clone()).collect(),
        law: joint.law.clone(),
        scale: joint.scale,
    };
    System {
        mass: model.mass().clone(),
        damping: model.damping().clone(),
        stiffness: model.stiffness().clone(),
        loads: problem.excitation.iter().flat_map(|entry| loads(entry, omega, model)).collect(),
        contacts: problem.contacts.iter().map(contact).collect(),
        joints: problem.joints.iter().map(joint).collect(),
    }
}

/// The forces of one excitation.
fn loads(entry: &Excitation, omega: f64, model: &hbm::Model) -> Vec<Load> {
    let mut amplitude = Complex64::from_polar(entry.amplitude, entry.phase);
    if entry.harmonic == 0 {
        amplitude.im = 0.0;
    }
    let on = |dof: usize, amplitude: Complex64| Load { dof, harmonic: entry.harmonic, amplitude };
    match entry.kind {
        ExcitationKind::Force => vec![on(entry.dof, amplitude)],
        ExcitationKind::Unbalance => vec![on(entry.dof, amplitude * omega * omega)],
        // −M·r on all dofs, whose displacements are relative to the base.
        ExcitationKind::Base => {
            let inertia = model.base_loads().get(entry.dof).into_iter().flatten().enumerate();
            inertia.map(|(dof, inertia)| on(dof, -amplitude * inertia)).collect()
        }
    }
}
