//! Whether what the solver answers is true.
//!
//! A reported motion is a solution when, with the forces that the law gives for it, every row of the balance is zero up to
//!
//! * 3e-11 of the sum of the magnitudes of the row's terms (backward error), and 1e-12 of that of the dof's largest harmonic,
//! * what rounding of the reported displacements leaves undetermined of the force (see `reference_force`),
//! * four times the residual that the solver reports for itself.

use anyhow::{Result, ensure};
use contact::ContactState;
use hbm::{ContactSolution, Plan, Solution, Status};
use num_complex::Complex64;

use super::balance::Rows;
use super::case::{Case, Ready};
use super::motion::Motion;
use super::reference_force::{Evaluation, evaluate};

/// Backward error of a row that counts as rounding.
const BACKWARD: f64 = 3e-11;

/// How well the displacement of a contact agrees with those of its dofs, relative to the larger.
const AGREEMENT: f64 = 1e-9;

/// What a transform spreads over all harmonics: rounding of the largest.
const SPREAD: f64 = 1e-12;

/// How close a solution is to the bounds it must keep: the largest ratio of a residual to its tolerance, and of a residual
/// to the terms of the dof's largest harmonic.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Margin {
    pub(super) of_tolerance: f64,
    pub(super) backward: f64,
}

/// Checks a solved point.
///
/// # Errors
/// What is wrong.
pub(super) fn judge(case: &Case, ready: &Ready, plan: &Plan, solution: &Solution) -> Result<Margin> {
    let numbers = solution.displacement.iter().flatten();
    let forces = solution.contacts.iter().flat_map(|c| c.displacement.iter().chain(&c.force));
    ensure!(numbers.chain(forces).all(|z| z.is_finite()), "a number that is not finite");
    ensure!(solution.displacement.len() == case.mass.len(), "a dof is missing");
    if case.loads.iter().all(|load| load.amplitude == 0.0) {
        ensure!(solution.status == Status::Converged, "zero excitation ends {:?}", solution.status);
        let zero = solution.displacement.iter().flatten().all(|w| *w == Complex64::ZERO);
        ensure!(zero, "zero excitation moves something");
    }
    let orders = plan.orders();
    let fundamental = case.fundamental();
    let facts = plan.facts();
    let evaluation =
        if facts.scalar { Evaluation::ClosedForm } else { Evaluation::Period { samples: facts.samples } };
    let omega = std::f64::consts::TAU * case.frequency * fundamental as f64;
    let mut drives: Vec<Vec<Complex64>> = Vec::new();
    let mut uncertainties = Vec::new();
    for (c, contact) in solution.contacts.iter().enumerate() {
        let spectrum = |row: &[Complex64]| {
            let mut all = vec![Complex64::ZERO; orders.last().map_or(1, |k| k / fundamental + 1)];
            for (&order, value) in orders.iter().zip(row) {
                all[order / fundamental] = *value;
            }
            all
        };
        let scale = case.contacts[c].scale;
        let held = contact.state == ContactState::Held;
        ensure!(
            held || solution.status != Status::Stuck || ready.built[c].spec.holding_force() == 0.0,
            "stuck, but contact {c} is {:?}",
            contact.state
        );
        let pick =
            |row: &[Complex64]| -> Vec<Complex64> { orders.iter().map(|o| row[o / fundamental]).collect() };
        if held {
            let zero = contact.displacement.iter().all(|w| *w == Complex64::ZERO);
            ensure!(zero, "contact {c} is held but moves");
            let force = Motion { spectrum: spectrum(&contact.force) };
            let limit = ready.built[c].spec.holding_force() * scale;
            let peak = peak(&force);
            ensure!(peak <= limit * (1.0 + 1e-9), "contact {c} holds {peak:e} N, beyond {limit:e} N");
            drives.push(contact.force.iter().map(|f| -f).collect());
            uncertainties.push(BACKWARD * peak);
        } else {
            let motion = Motion { spectrum: spectrum(&contact.displacement) };
            let force = evaluate(&ready.built[c], &motion, evaluation, omega);
            drives.push(pick(&force.harmonics).into_iter().map(|f| f * scale).collect());
            uncertainties.push(force.uncertainty * scale);
        }
    }
    let share = Share::new(case, ready, solution, orders);
    let mut checks = Vec::new();
    let mut largest = vec![0.0_f64; case.mass.len()];
    for (slot, &order) in orders.iter().enumerate() {
        let rows = Rows::new(case, &ready.problem.model, order);
        let w: Vec<Complex64> = solution.displacement.iter().map(|row| row[slot]).collect();
        let loads = rows.excitation();
        let stiffness = rows.dynamic_stiffness();
        for i in 0..w.len() {
            let mut drive = Vec::new();
            let mut tolerance = 0.0;
            for (c, spec) in case.contacts.iter().enumerate() {
                if spec.first == i {
                    drive.push(drives[c][slot]);
                    tolerance += uncertainties[c];
                }
                if spec.second == Some(i) {
                    drive.push(-drives[c][slot]);
                    tolerance += uncertainties[c];
                }
                let entry = stiffness[(i, spec.first)].norm()
                    + spec.second.map_or(0.0, |second| stiffness[(i, second)].norm());
                tolerance += entry * share.displacement(slot, c);
            }
            let row = rows.row(i, &w, loads[i], &drive);
            tolerance += BACKWARD * row.size;
            largest[i] = largest[i].max(row.size);
            checks.push(Check { order, dof: i, residual: row.residual, size: row.size, tolerance });
        }
        for (c, spec) in case.contacts.iter().enumerate() {
            let one = w[spec.first];
            let other = spec.second.map_or(Complex64::ZERO, |second| w[second]);
            let u = solution.contacts[c].displacement[slot];
            let allowed = AGREEMENT * (one.norm() + other.norm() + u.norm()) + share.displacement(slot, c);
            let away = (one - other - u).norm();
            ensure!(
                away <= allowed,
                "harmonic {order}, contact {c}: {away:e} m from its dofs, allowed {allowed:e} m"
            );
        }
    }
    energy(case, solution, orders)?;
    balanced(&checks, &largest)
}

/// One row of the balance.
struct Check {
    order: usize,
    dof: usize,
    residual: f64,
    size: f64,
    tolerance: f64,
}

/// Whether every row is zero; `largest` are the largest terms of every dof in any harmonic.
fn balanced(checks: &[Check], largest: &[f64]) -> Result<Margin> {
    let mut margin = Margin::default();
    for &Check { order, dof, residual, size, tolerance } in checks {
        let tolerance = tolerance + SPREAD * largest[dof];
        ensure!(
            residual <= tolerance,
            "harmonic {order}, dof {dof}: residual {residual:e} N of terms {size:e} N, tolerance {tolerance:e} N"
        );
        if largest[dof] > 0.0 {
            margin.of_tolerance = margin.of_tolerance.max(residual / tolerance);
            margin.backward = margin.backward.max(residual / largest[dof]);
        }
    }
    Ok(margin)
}

/// max |f(t)|.
fn peak(force: &Motion) -> f64 {
    let ends = force.turns().into_iter().map(|turn| turn.w.abs());
    ends.fold(force.mean().abs(), f64::max)
}

/// No contact creates energy, beyond rounding.
fn energy(case: &Case, solution: &Solution, orders: &[usize]) -> Result<()> {
    for (c, contact) in solution.contacts.iter().enumerate() {
        let size: f64 = product(contact, orders, |f, u| f.norm() * u.norm());
        let slack = 1e-9 * size * std::f64::consts::PI;
        let work = contact.dissipation;
        ensure!(work >= -slack || case.harmonics > 1, "contact {c} creates {:e} J of {size:e} J", -work);
    }
    Ok(())
}

fn product(contact: &ContactSolution, orders: &[usize], f: impl Fn(Complex64, Complex64) -> f64) -> f64 {
    let pairs = contact.force.iter().zip(&contact.displacement);
    orders.iter().zip(pairs).map(|(&k, (force, u))| k as f64 * f(*force, *u)).sum()
}

/// What the reported residual means in metres at every contact and harmonic: it is relative to the norm of the excitation,
/// each row divided by 1 + |Ĝ|, with Ĝ the receptance in units of the law's own stiffness.
struct Share {
    contacts: usize,
    displacement: Vec<f64>,
}

impl Share {
    fn new(case: &Case, ready: &Ready, solution: &Solution, orders: &[usize]) -> Self {
        let contacts = case.contacts.len();
        let mut rows: Vec<(f64, f64)> = Vec::new();
        for &order in orders {
            let all = Rows::new(case, &ready.problem.model, order).receptances();
            rows.extend(all.into_iter().map(|(g, free)| (g.norm(), free.norm())));
        }
        let mut largest = vec![0.0_f64; contacts];
        for (entry, (_, free)) in rows.iter().enumerate() {
            largest[entry % contacts] = largest[entry % contacts].max(*free);
        }
        let units: Vec<(f64, f64)> = (0..contacts)
            .map(|c| {
                let law = &ready.built[c].law;
                let length = law.length().unwrap_or(if largest[c] > 0.0 { largest[c] } else { 1.0 });
                (length, law.secant_stiffness(length) * case.contacts[c].scale)
            })
            .collect();
        let weight = |entry: usize, g: f64| 1.0 + g * units[entry % contacts].1;
        let square: f64 = rows
            .iter()
            .enumerate()
            .map(|(entry, &(g, free))| (free / units[entry % contacts].0 / weight(entry, g)).powi(2))
            .sum();
        let all = 4.0 * solution.residual * square.sqrt();
        let meters =
            |(entry, &(g, _)): (usize, &(f64, f64))| all * weight(entry, g) * units[entry % contacts].0;
        let displacement = rows.iter().enumerate().map(meters).map(|x| if x.is_finite() { x } else { 0.0 });
        Self { contacts, displacement: displacement.collect() }
    }

    fn displacement(&self, slot: usize, contact: usize) -> f64 {
        self.displacement[slot * self.contacts + contact]
    }
}
