//! Damped Newton iteration on the balance, with a line search and a stop that looks at the rate.

use contact::LawError;
use faer::{Mat, c64};

use crate::balance::{Balance, BalanceBuffers, Homotopy};
use crate::dense::Lu;
use crate::point::Point;
use crate::settings::Jacobian;

/// When an iteration ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Criteria {
    /// Relative residual to reach.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    pub(crate) jacobian: Jacobian,
}

/// Relative residual that is accepted where rounding allows no further descent.
const FLOOR: f64 = 1e-9;

/// A last step of this relative length leaves an error of its square: no further step is needed.
const SHORT_STEP: f64 = 1e-6;

/// Shortest step of the line search.
const SHORTEST: f64 = 1.0 / 1024.0;

/// Steps over which the rate of convergence is judged.
const RATE_WINDOW: usize = 5;

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) converged: bool,
    pub(crate) iterations: usize,
    /// Relative residual at the end.
    pub(crate) residual: f64,
    /// What stopped it, where a law did.
    pub(crate) law_error: Option<LawError>,
}

impl Outcome {
    /// Nothing tried yet.
    pub(crate) const NONE: Self =
        Self { converged: false, iterations: 0, residual: f64::INFINITY, law_error: None };
}

/// Buffers of the iteration for one thread.
#[derive(Debug)]
pub(crate) struct NewtonBuffers {
    lu: Lu<f64>,
    step: Mat<f64>,
    correction: Mat<f64>,
    trial: Vec<c64>,
    /// Relative residuals of the last iteration.
    pub(crate) history: Vec<f64>,
}

impl NewtonBuffers {
    /// Room for `entries` complex unknowns.
    pub(crate) fn new(entries: usize) -> Self {
        let size = 2 * entries;
        Self {
            lu: Lu::new(size, 1),
            step: Mat::zeros(size, 1),
            correction: Mat::zeros(size, 1),
            trial: vec![c64::ZERO; entries],
            history: Vec::with_capacity(128),
        }
    }
}

/// One balance to be solved: everything [`solve`] reads.
pub(crate) struct Task<'a> {
    pub(crate) balance: Balance<'a>,
    pub(crate) point: &'a Point,
    pub(crate) slots: usize,
    pub(crate) homotopy: Homotopy,
    pub(crate) criteria: Criteria,
}

/// Improves `unknowns` until the residual, relative to the excitation, is below the tolerance. On failure `unknowns`
/// holds the best point reached.
pub(crate) fn solve(
    task: &Task,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) -> Outcome {
    let Task { balance, point, slots, homotopy, criteria } = task;
    let count = slots * point.width();
    let reference = point.excitation_norm(*slots) * homotopy.excitation;
    let relative = |norm: f64| if reference > 0.0 { norm / reference } else { norm };
    newton.history.clear();
    let mut norm = match balance.evaluate(point, *slots, *homotopy, unknowns, buffers) {
        Ok(norm) => norm,
        Err(error) => {
            return Outcome {
                converged: false,
                iterations: 0,
                residual: f64::INFINITY,
                law_error: Some(error),
            };
        }
    };
    newton.history.push(relative(norm));
    let mut law_error = None;
    let mut last_step = f64::INFINITY;
    for iteration in 0..criteria.max_iterations {
        let residual = relative(norm);
        let done = residual <= criteria.tolerance;
        if done && last_step <= SHORT_STEP {
            return Outcome { converged: true, iterations: iteration, residual, law_error: None };
        }
        if !done && hopeless(&newton.history, criteria, iteration) {
            return Outcome { converged: false, iterations: iteration, residual, law_error };
        }
        let length = newton_step(task, unknowns, buffers, newton);
        if !length.is_finite() {
            break;
        }
        let scale: f64 = unknowns.iter().take(count).map(|u| u.norm_sqr()).sum::<f64>().sqrt();
        let mut lambda = 1.0;
        let accepted = loop {
            apply_step(balance, point, *slots, unknowns, newton, lambda);
            match balance.evaluate(point, *slots, *homotopy, &newton.trial, buffers) {
                Ok(trial) if trial <= (1.0 - 1e-4 * lambda) * norm => break Some(trial),
                Ok(trial) if !done && closer(task, buffers, newton, length, lambda) => break Some(trial),
                Ok(_) => {}
                Err(error) => law_error = Some(error),
            }
            lambda *= 0.5;
            if lambda < SHORTEST || done {
                break None;
            }
        };
        let Some(next) = accepted else {
            // Rounding allows no further descent, or none exists in this direction. The buffers must end at the
            // point that is kept.
            let _ = balance.evaluate(point, *slots, *homotopy, unknowns, buffers);
            let converged = residual <= criteria.tolerance.max(FLOOR);
            return Outcome { converged, iterations: iteration + 1, residual, law_error };
        };
        unknowns[..count].copy_from_slice(&newton.trial[..count]);
        norm = next;
        last_step = if lambda == 1.0 { length / scale } else { f64::INFINITY };
        newton.history.push(relative(norm));
    }
    let residual = relative(norm);
    Outcome {
        converged: residual <= criteria.tolerance,
        iterations: criteria.max_iterations,
        residual,
        law_error,
    }
}

/// Whether the rate of the last steps cannot reach the tolerance in the steps that are left.
fn hopeless(history: &[f64], criteria: &Criteria, iteration: usize) -> bool {
    let (Some(&now), Some(&before)) = (history.last(), history.iter().rev().nth(RATE_WINDOW)) else {
        return false;
    };
    let rate = (now / before).powf(1.0 / RATE_WINDOW as f64);
    let left = (criteria.max_iterations - iteration) as f64;
    // Newton speeds up near a solution: only a crawl counts, and only while far away.
    rate > 0.9 && now > 1e-4 && now * rate.powf(left) > criteria.tolerance
}

/// Solves for the Newton step, leaves it in `newton.step` and returns its norm.
fn newton_step(
    task: &Task,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) -> f64 {
    let Task { balance, point, slots, homotopy, criteria } = task;
    let width = point.width();
    let size = balance.size(width, *slots);
    load_residual(task, buffers, &mut newton.step);
    match criteria.jacobian {
        Jacobian::Analytic => balance.jacobian(point, *slots, *homotopy, buffers, &mut newton.lu.matrix),
        Jacobian::Difference => difference_jacobian(task, unknowns, buffers, newton),
    }
    newton.lu.factor(size);
    newton.lu.solve(newton.step.as_mut().subrows_mut(0, size));
    (0..size).map(|r| newton.step[(r, 0)].powi(2)).sum::<f64>().sqrt()
}

/// The natural test of Deuflhard, invariant to how residuals are scaled: the Newton correction that the old derivative
/// gives at the trial point is shorter than the step was.
fn closer(
    task: &Task,
    buffers: &BalanceBuffers,
    newton: &mut NewtonBuffers,
    length: f64,
    lambda: f64,
) -> bool {
    let Task { balance, point, slots, .. } = task;
    let size = balance.size(point.width(), *slots);
    load_residual(task, buffers, &mut newton.correction);
    newton.lu.solve(newton.correction.as_mut().subrows_mut(0, size));
    let correction = (0..size).map(|r| newton.correction[(r, 0)].powi(2)).sum::<f64>().sqrt();
    correction <= (1.0 - 0.25 * lambda) * length
}

/// Writes the residual into a column of real unknowns.
fn load_residual(task: &Task, buffers: &BalanceBuffers, column: &mut Mat<f64>) {
    let Task { balance, point, slots, .. } = task;
    let width = point.width();
    for (entry, residual) in buffers.residual.iter().enumerate().take(slots * width) {
        let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
        column[(r, 0)] = residual.re;
        if is_complex {
            column[(r + 1, 0)] = residual.im;
        }
    }
}

/// `trial = unknowns − λ · step`.
fn apply_step(
    balance: &Balance,
    point: &Point,
    slots: usize,
    unknowns: &[c64],
    newton: &mut NewtonBuffers,
    lambda: f64,
) {
    let width = point.width();
    for (entry, (trial, unknown)) in newton.trial.iter_mut().zip(unknowns).enumerate().take(slots * width) {
        let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
        let im = if is_complex { newton.step[(r + 1, 0)] } else { 0.0 };
        *trial = unknown - lambda * c64::new(newton.step[(r, 0)], im);
    }
}

/// Forward differences, one evaluation an unknown: the comparison that the paper offers.
fn difference_jacobian(
    task: &Task,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) {
    let Task { balance, point, slots, homotopy, .. } = task;
    let width = point.width();
    let count = slots * width;
    let scale = unknowns.iter().take(count).map(|u| u.norm()).fold(0.0, f64::max);
    let h = 1e-7 * if scale > 0.0 { scale } else { 1.0 };
    for entry in 0..count {
        let (column, is_complex) = balance.real_index(width, entry / width, entry % width);
        for part in 0..if is_complex { 2 } else { 1 } {
            let kept = unknowns[entry];
            unknowns[entry] += if part == 0 { c64::new(h, 0.0) } else { c64::new(0.0, h) };
            let evaluated = balance.evaluate(point, *slots, *homotopy, unknowns, buffers).is_ok();
            unknowns[entry] = kept;
            for row in 0..count {
                let (r, row_complex) = balance.real_index(width, row / width, row % width);
                // `step` still holds the residual at the undisturbed point.
                let im = if row_complex { newton.step[(r + 1, 0)] } else { 0.0 };
                let moved = if evaluated { buffers.residual[row] } else { c64::new(f64::NAN, 0.0) };
                let slope = (moved - c64::new(newton.step[(r, 0)], im)) / h;
                newton.lu.matrix[(r, column + part)] = slope.re;
                if row_complex {
                    newton.lu.matrix[(r + 1, column + part)] = slope.im;
                }
            }
        }
    }
}
