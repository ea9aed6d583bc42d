//! Stability of solutions whose contacts remember: multipliers of the exact orbit beside them.

use std::f64::consts::TAU;

use contact::{JointMechanism, Mechanism};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use hbm::{Problem, Solution, Stability, StabilityMethod};
use num_complex::Complex64;
use orbit::{Orbit, OrbitError, System};

use crate::start;
use crate::system::system;

/// Dofs up to which orbits are looked for here.
const MOST_DOFS: usize = 60;

/// A relative distance between the spectra of orbit and balance beyond which nobody knows whether they are the same motion.
const SAME: f64 = 0.1;

/// Dofs that move less than this part of the largest one do not count.
const AT_REST: f64 = 1e-6;

/// Error of an orbit's multipliers, relative to the largest or to one: events and their jumps are found to rounding, and
/// followed for one period.
const ERROR: f64 = 1e-9;

/// Stability of `solution`, whose columns belong to the harmonics `orders`, by the exact orbit of `problem` beside it.
/// A slider that never slips may rest anywhere: its multiplier, exactly 1, is left out.
///
/// # Errors
/// In words: a contact without a mechanism, no orbit, or one that is not the solution's motion.
pub fn stability(problem: &Problem, orders: &[usize], solution: &Solution) -> Result<Stability, String> {
    if solution.frequency == 0.0 {
        return Err("a static response has no period".into());
    }
    for contact in &problem.contacts {
        if let Mechanism::None { why } = contact.law.mechanism() {
            return Err(format!("contact {:?} has no state in time: {why}", contact.name));
        }
    }
    for joint in &problem.joints {
        if let JointMechanism::None { why } = joint.law.mechanism() {
            return Err(format!("contact {:?} has no state in time: {why}", joint.name));
        }
    }
    let dofs = problem.model.dofs();
    if dofs > MOST_DOFS {
        return Err(format!("the structure has {dofs} dofs; orbits are looked for up to {MOST_DOFS}"));
    }
    let system = system(problem, solution.frequency);
    let rows = every_dof(&system, orders, solution);
    let start = start::state(&system, orders, &rows, solution);
    let settings = orbit::Settings { start: Some(start), ..orbit::Settings::default() };
    let orbit = orbit::find(&system, solution.frequency, &settings).map_err(|error| match error {
        OrbitError::Stuck => "every slider sticks in the exact motion".to_owned(),
        error => format!("no exact orbit was found beside it ({error})"),
    })?;
    let distance = distance(&orbit, orders, &rows);
    if distance.is_nan() || distance > SAME {
        return Err(format!(
            "the exact orbit that was found is more than {:.0} % away, so it may be another motion (more harmonics would tell)",
            100.0 * SAME
        ));
    }
    let mut multipliers = orbit.multipliers().map_err(|error| error.to_string())?;
    for _ in 0..resting(problem, &orbit) {
        let neutral = |(_, a): &(usize, &Complex64), (_, b): &(usize, &Complex64)| {
            (**a - 1.0).norm().total_cmp(&(**b - 1.0).norm())
        };
        if let Some((place, _)) = multipliers.iter().enumerate().min_by(neutral) {
            multipliers.remove(place);
        }
    }
    let largest = multipliers.iter().map(|value| value.norm()).fold(1.0, f64::max);
    Ok(Stability::new(multipliers, ERROR * largest, StabilityMethod::Orbit))
}

/// Directions in which sliders that never slip may rest anywhere: one each, in a joint as many as it has tangential ones.
fn resting(problem: &Problem, orbit: &Orbit) -> usize {
    let directions = |&(contact, _): &(usize, usize)| {
        let joint = contact.checked_sub(problem.contacts.len()).and_then(|joint| problem.joints.get(joint));
        joint.map_or(1, |joint| joint.directions.len() - 1)
    };
    orbit.locked_sliders().iter().map(directions).sum()
}

/// Spectra of all dofs, from loads and contact forces: H_k w_k = f_k + B F_k with F on the first bodies.
fn every_dof(system: &System, orders: &[usize], solution: &Solution) -> Vec<Vec<Complex64>> {
    let n = system.mass.nrows();
    let omega = TAU * solution.frequency;
    let mut rows = vec![Vec::new(); n];
    for (slot, &k) in orders.iter().enumerate() {
        let turn = k as f64 * omega;
        let stiffness = Mat::<c64>::from_fn(n, n, |i, j| {
            c64::new(
                system.stiffness[(i, j)] - turn * turn * system.mass[(i, j)],
                turn * system.damping[(i, j)],
            )
        });
        let mut force = Mat::<c64>::zeros(n, 1);
        for load in system.loads.iter().filter(|load| load.harmonic == k) {
            force[(load.dof, 0)] += load.amplitude;
        }
        for (contact, report) in system.contacts.iter().zip(&solution.contacts) {
            let on_first = report.force.get(slot).copied().unwrap_or_default();
            force[(contact.first, 0)] += on_first;
            if let Some(second) = contact.second {
                force[(second, 0)] -= on_first;
            }
        }
        for (joint, report) in system.joints.iter().zip(&solution.joints) {
            for (parts, direction) in joint.directions.iter().zip(&report.directions) {
                let on_first = direction.force.get(slot).copied().unwrap_or_default();
                for &(dof, coefficient) in parts {
                    force[(dof, 0)] += on_first * coefficient;
                }
            }
        }
        let found = stiffness.partial_piv_lu().solve(&force);
        for (row, value) in rows.iter_mut().zip(found.col(0).iter()) {
            // Where contacts alone hold the mean it is not in the forces.
            row.push(if value.re.is_finite() && value.im.is_finite() { *value } else { Complex64::ZERO });
        }
    }
    rows
}

/// The worst relative l2 distance between the spectra of a dof, the mean left out; dofs that hardly move do not count.
fn distance(orbit: &Orbit, orders: &[usize], rows: &[Vec<Complex64>]) -> f64 {
    let highest = orders.last().copied().unwrap_or(0);
    let each = rows.iter().enumerate().map(|(dof, row)| {
        let exact = orbit.spectrum(dof, highest);
        let moving = || orders.iter().zip(row).filter(|(k, _)| **k > 0);
        let of = |k: usize| exact.get(k).copied().unwrap_or_default();
        let apart: f64 = moving().map(|(&k, w)| (w - of(k)).norm_sqr()).sum();
        (apart.sqrt(), moving().map(|(&k, _)| of(k).norm_sqr()).sum::<f64>().sqrt())
    });
    let each: Vec<(f64, f64)> = each.collect();
    let largest = each.iter().map(|(_, size)| *size).fold(0.0, f64::max);
    each.iter().map(|(apart, size)| apart / size.max(AT_REST * largest)).fold(0.0, f64::max)
}
