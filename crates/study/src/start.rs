//! From a harmonic solution to a state of motion, so that an orbit is looked for on the same branch.

use std::f64::consts::TAU;

use contact::{ElasticCoulomb, JointMechanism, Mechanism};
use hbm::Solution;
use num_complex::Complex64;
use orbit::{State, System};

use crate::periodic::{dense, samples};

/// The state at t = 0 of a solution, with the amplitudes of every dof of `system` at the harmonics `orders`.
pub(crate) fn state(
    system: &System,
    orders: &[usize],
    displacement: &[Vec<Complex64>],
    solution: &Solution,
) -> State {
    let omega = TAU * solution.frequency;
    let mut state = State::default();
    for row in displacement {
        let (displacement, velocity) = samples(&dense(orders, row), 1);
        state.displacement.extend(displacement);
        state.velocity.extend(velocity.iter().map(|v| v * omega));
    }
    for (contact, report) in system.contacts.iter().zip(&solution.contacts) {
        if let Mechanism::Sliders { sliders, .. } = contact.law.mechanism() {
            let path = relative_displacement(orders, &report.displacement);
            state.sliders.extend(sliders.iter().map(|slider| contact.scale * settled(slider, &path)));
        }
    }
    for (joint, report) in system.joints.iter().zip(&solution.joints) {
        if let (JointMechanism::Friction { .. }, [tangential @ .., _]) =
            (joint.law.mechanism(), report.directions.as_slice())
        {
            // The force on the first body at t = 0; a slider's is against it.
            let force =
                |direction: &hbm::DirectionSolution| -direction.force.iter().map(|f| f.re).sum::<f64>();
            state.sliders.extend(tangential.iter().map(force));
        }
    }
    state
}

/// One period in time, beginning and ending at t = 0.
fn relative_displacement(orders: &[usize], amplitudes: &[Complex64]) -> Vec<f64> {
    let spectrum = dense(orders, amplitudes);
    let count = (16 * spectrum.len()).max(512);
    let (mut path, _) = samples(&spectrum, count);
    path.extend(path.first().copied());
    path
}

/// Spring force of a slider at the end of the second of two periods: by then it has forgotten how it began.
fn settled(slider: &ElasticCoulomb, path: &[f64]) -> f64 {
    let limit = slider.slip_force();
    let steps = || path.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?));
    steps().chain(steps()).fold(0.0, |force, step| (force + slider.stiffness() * step).clamp(-limit, limit))
}
