//! The derivative of the period map against central differences.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use contact::{Coulomb, CoulombParameters, Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters};
use contact::{FrictionContact, FrictionContactParameters, Iwan, Law};
use contact::{Linear, LinearParameters};
use faer::{Mat, mat};
use num_complex::Complex64;

use crate::piecewise::Piecewise;
use crate::scaled::Scaled;
use crate::settings::EventKind;
use crate::shooting::Map;
use crate::smooth::Smooth;
use crate::{Contact, Joint, Load, System};

fn system(laws: [Arc<dyn Law>; 2]) -> System {
    let [first, second] = laws;
    let contact =
        |name: &str, first, second, law, scale| Contact { name: name.into(), first, second, law, scale };
    let load = |dof, harmonic, re, im| Load { dof, harmonic, amplitude: Complex64::new(re, im) };
    System {
        mass: mat![[4.0, 0.1, 0.0], [0.1, 1.3, 0.0], [0.0, 0.0, 0.8]],
        damping: mat![[24.0, 0.0, 0.0], [0.0, 20.0, -3.0], [0.0, -3.0, 9.0]],
        stiffness: mat![[9e5, -4e5, 0.0], [-4e5, 7e5, -2e5], [0.0, -2e5, 5e5]],
        loads: vec![load(1, 1, 9.0, 1.0), load(2, 2, -1.0, 3.0), load(2, 0, 2.0, 0.0)],
        contacts: vec![contact("a", 0, None, first, 1.5), contact("b", 1, Some(2), second, 1.0)],
        joints: Vec::new(),
    }
}

fn check(map: &mut dyn Map, state: &[f64], until: f64, step: f64) {
    let n = state.len();
    let (mut derivative, mut end) = (Mat::zeros(n, n), Vec::new());
    map.pass(state, until, &mut end, Some(&mut derivative)).unwrap();
    let scale = derivative.norm_max();
    let mut moved = |j: usize, h: f64| {
        let mut from = state.to_vec();
        from[j] += h;
        map.pass(&from, until, &mut end, None).unwrap();
        end.clone()
    };
    for j in 0..n {
        let (up, down) = (moved(j, step), moved(j, -step));
        for i in 0..n {
            let slope = (up[i] - down[i]) / (2.0 * step);
            let error = (slope - derivative[(i, j)]).abs() / scale;
            assert!(error < 1e-7, "d x_{i} / d x_{j}: {slope} by differences, {}", derivative[(i, j)]);
        }
    }
}

/// A state reached after some periods, every slider drawn back from its limit: at a limit the map has no derivative
/// outwards, where there is no state.
fn settled(map: &mut dyn Map, size: usize) -> Vec<f64> {
    let (mut state, mut end) = (vec![0.0; size], Vec::new());
    for _ in 0..5 {
        map.pass(&state, TAU, &mut end, None).unwrap();
        std::mem::swap(&mut state, &mut end);
    }
    state.iter_mut().skip(6).for_each(|force| *force *= 0.7);
    state
}

#[test]
fn the_derivative_of_the_piecewise_linear_map_agrees_with_differences() {
    let jenkins = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 2e6, slip_force: 2.0 }).unwrap();
    let backbone = [[1e-6, 1.0], [3e-6, 2.0], [9e-6, 3.0], [4e-5, 4.0]];
    let stack = Iwan::from_backbone(&backbone).unwrap();
    let system = system([Arc::new(jenkins), Arc::new(stack)]);
    let mut events = 0;
    for hertz in [30.0, 70.0, 100.0] {
        let scaled = Scaled::new(&system, hertz).unwrap();
        let mut map = Piecewise::new(&scaled);
        let state = settled(&mut map, 6 + scaled.sliders.len());
        events += map.record(&state, TAU).unwrap().0.events.len();
        for until in [0.3, PI, TAU] {
            check(&mut map, &state, until, 1e-7);
        }
    }
    assert!(events > 30, "{events}");
}

#[test]
fn the_derivative_of_the_smooth_map_agrees_with_differences() {
    let cubic = Cubic::new(CubicParameters { stiffness: 1e15 }).unwrap();
    let coulomb = Coulomb::new(CoulombParameters { slip_force: 2.0, velocity: 1e-3 }).unwrap();
    let system = system([Arc::new(cubic), Arc::new(coulomb)]);
    for hertz in [30.0, 70.0, 100.0] {
        let scaled = Scaled::new(&system, hertz).unwrap();
        let mut map = Smooth::new(&scaled, 1e-14);
        let state = settled(&mut map, 6);
        for until in [0.3, TAU] {
            check(&mut map, &state, until, 1e-5);
        }
    }
}

/// The monodromy matrix in SI units against differences of the period map of the same state.
#[test]
fn monodromy_has_the_units_of_the_state() {
    let jenkins = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 2e6, slip_force: 2.0 }).unwrap();
    let backbone = [[1e-6, 1.0], [3e-6, 2.0], [9e-6, 3.0], [4e-5, 4.0]];
    let stack = Iwan::from_backbone(&backbone).unwrap();
    let system = system([Arc::new(jenkins), Arc::new(stack)]);
    let orbit = crate::find(&system, 70.0, &crate::Settings::default()).unwrap();
    let found = orbit.monodromy().unwrap();
    let scaled = Scaled::new(&system, 70.0).unwrap();
    let n = orbit.state.len();
    let unit = |i: usize| match i {
        0..3 => scaled.size / scaled.root_mass[i],
        3..6 => scaled.size / scaled.root_mass[i - 3] * scaled.omega,
        _ => scaled.sliders[i - 6].limit * scaled.force(),
    };
    let mut map = Piecewise::new(&scaled);
    let mut end = Vec::new();
    let mut moved = |j: usize, h: f64| {
        let mut from = orbit.state.clone();
        from[j] += h;
        map.pass(&from, TAU, &mut end, None).unwrap();
        end.clone()
    };
    let mut checked = 0;
    for j in (0..n).filter(|&j| j < 6 || orbit.state[j].abs() < 0.99) {
        let (up, down) = (moved(j, 1e-7), moved(j, -1e-7));
        for i in 0..n {
            let slope = (up[i] - down[i]) / 2e-7;
            let error = (slope - found[(i, j)] * unit(j) / unit(i)).abs();
            assert!(error < 1e-6, "entry {i} {j}: {slope} by differences");
            checked += 1;
        }
    }
    assert!(checked > 6 * n, "a slider sticks at t = 0");
}

/// Two joints between three dofs: one opens, one slips under a varying pressure, both stick at times. In a plane where a second
/// tangent is given.
fn jointed(second: [Option<Vec<(usize, f64)>>; 2]) -> System {
    let free: Arc<dyn Law> = Arc::new(Linear::new(LinearParameters { stiffness: 1e4 }).unwrap());
    let [first, other] = second;
    let joint =
        |name: &str, along, second, normal, (tangential_stiffness, normal_stiffness), preload, gap| {
            let directions: Vec<_> = [Some(along), second, Some(normal)].into_iter().flatten().collect();
            let parameters = FrictionContactParameters {
                tangential_stiffness,
                normal_stiffness,
                friction_coefficient: 0.6,
                preload,
                gap,
            };
            let law = Arc::new(FrictionContact::new(parameters, directions.len() - 1).unwrap());
            Joint { name: name.into(), directions, law, scale: 1.2 }
        };
    let mut system = system([free.clone(), free]);
    system.joints = vec![
        joint("opens", vec![(0, 1.0), (1, -0.5)], first, vec![(1, 1.0)], (1e6, 2e6), None, Some(-3e-6)),
        joint("pressed", vec![(2, 1.0)], other, vec![(0, 0.3), (1, 1.0)], (2e6, 1e6), Some(5.0), None),
    ];
    system
}

#[test]
fn the_derivative_of_the_map_with_joints_agrees_with_differences() {
    check_joints(&jointed([None, None]), 8);
}

#[test]
fn the_derivative_of_the_map_with_planar_joints_agrees_with_differences() {
    check_joints(&jointed([Some(vec![(2, 1.3)]), None]), 9);
    check_joints(&jointed([None, Some(vec![(0, 0.8), (1, -0.3)])]), 9);
    check_joints(&jointed([Some(vec![(2, 1.3)]), Some(vec![(0, 0.8), (1, -0.3)])]), 10);
}

fn check_joints(system: &System, size: usize) {
    let (mut kinds, mut into_stick) = (Vec::new(), 0);
    for hertz in [30.0, 45.0, 70.0, 85.0, 100.0] {
        let scaled = Scaled::new(system, hertz).unwrap();
        let mut map = Piecewise::new(&scaled);
        let mut state = settled(&mut map, size);
        map.admit(&mut state);
        let events = map.record(&state, TAU).unwrap().0.events;
        kinds.extend(events.iter().map(|event| event.kind));
        // Into stick where no slip begins at the same instant.
        let slips = |tau: f64| events.iter().any(|event| event.kind == EventKind::Slip && event.tau == tau);
        let closed = events.iter().filter(|event| event.kind == EventKind::Close);
        into_stick += closed.filter(|event| !slips(event.tau)).count();
        for until in [0.3, PI, TAU] {
            check(&mut map, &state, until, 1e-7);
        }
    }
    for kind in [EventKind::Slip, EventKind::Stick, EventKind::Open, EventKind::Close] {
        let count = kinds.iter().filter(|&&found| found == kind).count();
        assert!(count > 2, "{kind:?}: {count}");
    }
    assert!(into_stick > 0);
}
