//! A chain of equal masses of any length, clamped at one end, with contacts to the ground.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use anyhow::Result;
use contact::{ElasticCoulomb, ElasticCoulombParameters, Law};
use faer::Mat;
use hbm::{Contact, Damping, Excitation, ExcitationKind, Model, Problem};

/// Speed of longitudinal waves over the length of the rod that the chain stands for, in 1/s.
const WAVES: f64 = 400.0;

/// Resonances in the range of frequencies.
const RESONANCES: f64 = 3.0;

/// A rod of 1 kg divided into `dofs` masses, `contacts` of them on frictional ground, a force on the free end.
///
/// The contacts together have a stiffness and a slip force that does not depend on their number.
pub(super) fn problem(dofs: usize, contacts: usize) -> Result<Problem> {
    let n = dofs as f64;
    let mass = 1.0 / n;
    // c = a √(k/m) with a = 1/n the spacing.
    let spring = mass * (WAVES * n).powi(2);
    let stiffness = Mat::from_fn(dofs, dofs, |i, j| match i.abs_diff(j) {
        0 if i + 1 == dofs => spring,
        0 => 2.0 * spring,
        1 => -spring,
        _ => 0.0,
    });
    let mass = Mat::from_fn(dofs, dofs, |i, j| if i == j { mass } else { 0.0 });
    // About 0.2 % of critical at the first resonance.
    let damping = Damping::Rayleigh { mass: 1.0, stiffness: 4e-6 };
    let share = 1.0 / contacts as f64;
    let law: Arc<dyn Law> = Arc::new(ElasticCoulomb::new(ElasticCoulombParameters {
        stiffness: 2e5 * share,
        slip_force: 8.0 * share,
    })?);
    let contact = |c: usize| Contact {
        name: format!("c{c}"),
        // Spread over the chain, the free end among them.
        first: (c + 1) * dofs / contacts - 1,
        second: None,
        law: law.clone(),
        scale: 1.0,
    };
    let excitation =
        Excitation { dof: dofs - 1, harmonic: 1, amplitude: 10.0, phase: 0.0, kind: ExcitationKind::Force };
    Ok(Problem {
        joints: Vec::new(),
        model: Model::new(mass, damping, stiffness)?,
        excitation: vec![excitation],
        contacts: (0..contacts).map(contact).collect(),
        output: vec![dofs - 1],
    })
}

/// So many frequencies in Hz over the first resonances of the rod without contacts, ω_r = (r − ½) π · waves.
pub(super) fn frequencies(points: usize) -> Vec<f64> {
    let last = 2.0 * RESONANCES * FRAC_PI_2 * WAVES / TAU;
    let first = 0.2 * last;
    (0..points).map(|i| first + (last - first) * (i as f64 + 0.5) / points as f64).collect()
}
