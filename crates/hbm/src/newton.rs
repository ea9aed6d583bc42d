//! Damped Newton iteration on the balance, with a line search and a stop that looks at the rate.
//!
//! High harmonics to which the structure hardly answers need no derivative: beyond the *core* the map
//! `û_k ↦ û⁰_k − Ĝ_k F̂_k(û)` contracts, and each pass replaces them by it (the slaved tail). While passes converge fast
//! the core keeps its factored derivative, so that a pass costs one evaluation.

use contact::LawError;
use faer::{Mat, c64};

use crate::balance::{Balance, BalanceBuffers, Homotopy};
use crate::dense::Lu;
use crate::krylov::Krylov;
use crate::point::Point;
use crate::settings::Jacobian;

/// When an iteration ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Criteria {
    /// Relative residual to reach.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    pub(crate) jacobian: Jacobian,
    /// Go on until the last step was short, so that its square is lost in rounding.
    pub(crate) polish: bool,
}

/// Relative residual that is accepted where rounding allows no further descent.
pub(crate) const FLOOR: f64 = 1e-9;

/// So many rounding units of the terms of the balance are accepted as well, where these terms exceed the excitation far: near a
/// resonance that nothing damps.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// No more than this is accepted of them: beyond, the balance says nothing about the excitation.
const ROUNDED: f64 = 1e-7;

/// A last step of this relative length leaves an error of its square: no further step is needed.
const SHORT_STEP: f64 = 1e-6;

/// While a step leaves less than this of the residual, the next one uses the same derivative where there is a tail.
const FAST: f64 = 0.15;

/// Shortest step of the line search.
const SHORTEST: f64 = 1.0 / 1024.0;

/// A step that leaves no more than this of the residual is taken. What leaves more must pass the natural test as well where a
/// factorisation is at hand: the residual of a loop with rounded tips falls slowly along ways that lead nowhere.
const CLEARLY: f64 = 0.3;

/// Steps over which the rate of convergence is judged.
const RATE_WINDOW: usize = 12;

/// Real unknowns for which a factorisation has room from the start. More are made room for when they are met: with a
/// slaved tail they hardly ever are.
const USUAL_SIZE: usize = 512;

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
    /// Of the whole derivative; small until one is factored.
    lu: Lu<f64>,
    krylov: Krylov,
    /// The derivative of the step before is in `krylov`, not in `lu`.
    iterated: bool,
    /// Of the core, in its real unknowns.
    step: Mat<f64>,
    correction: Mat<f64>,
    /// Of the tail, entry `[slot][i]` beyond the core.
    tail_step: Vec<c64>,
    trial: Vec<c64>,
    /// Relative residuals of the last iteration.
    pub(crate) history: Vec<f64>,
}

impl NewtonBuffers {
    /// Room for `entries` complex unknowns.
    pub(crate) fn new(entries: usize) -> Self {
        let size = 2 * entries;
        Self {
            lu: Lu::new(size.min(USUAL_SIZE), 1),
            krylov: Krylov::new(),
            iterated: false,
            step: Mat::zeros(size, 1),
            correction: Mat::zeros(size, 1),
            tail_step: vec![c64::ZERO; entries],
            trial: vec![c64::ZERO; entries],
            history: Vec::with_capacity(128),
        }
    }

    /// Entry `[slot][i]` of the step.
    #[inline]
    fn entry(&self, task: &Task, entry: usize) -> c64 {
        let width = task.point.width();
        if entry >= task.core * width {
            return self.tail_step[entry];
        }
        let (r, is_complex) = task.balance.real_index(width, entry / width, entry % width);
        c64::new(self.step[(r, 0)], if is_complex { self.step[(r + 1, 0)] } else { 0.0 })
    }
}

/// One balance to be solved: everything [`solve`] reads.
pub(crate) struct Task<'a> {
    pub(crate) balance: Balance<'a>,
    pub(crate) point: &'a Point,
    pub(crate) slots: usize,
    /// The first harmonics, which are solved by Newton's method; the others follow by substitution.
    pub(crate) core: usize,
    /// Steps by GMRES instead of a factorisation of the whole derivative.
    pub(crate) krylov: bool,
    pub(crate) homotopy: Homotopy,
    pub(crate) criteria: Criteria,
}

impl Task<'_> {
    fn has_tail(&self) -> bool {
        self.core < self.slots
    }

    /// Real unknowns of the core.
    fn size(&self) -> usize {
        self.balance.size(self.point.width(), self.core)
    }
}

/// Improves `unknowns` until the residual, relative to the excitation, is below the tolerance. On failure `unknowns`
/// holds the best point reached.
pub(crate) fn solve(
    task: &Task,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) -> Outcome {
    let Task { balance, point, slots, homotopy, criteria, .. } = task;
    let count = slots * point.width();
    let reference = point.excitation_norm(*slots) * homotopy.excitation;
    let relative = |norm: f64| if reference > 0.0 { norm / reference } else { norm };
    newton.history.clear();
    newton.krylov.forget();
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
    let mut factored = false;
    for iteration in 0..criteria.max_iterations {
        let residual = relative(norm);
        let done = residual <= criteria.tolerance;
        // A tail converges at a steady rate: its residual is its error.
        if done && (last_step <= SHORT_STEP || task.has_tail() || !criteria.polish) {
            return Outcome { converged: true, iterations: iteration, residual, law_error: None };
        }
        if !done && hopeless(&newton.history, criteria, iteration) {
            return Outcome { converged: false, iterations: iteration, residual, law_error };
        }
        let length = newton_step(task, factored, residual, unknowns, buffers, newton);
        if !length.is_finite() {
            // Differences leave the buffers beside the point.
            let _ = balance.evaluate(point, *slots, *homotopy, unknowns, buffers);
            break;
        }
        let scale: f64 = unknowns.iter().take(count).map(|u| u.norm_sqr()).sum::<f64>().sqrt();
        let mut lambda = 1.0;
        let accepted = loop {
            apply_step(task, unknowns, newton, lambda);
            match balance.evaluate(point, *slots, *homotopy, &newton.trial, buffers) {
                Ok(trial) if trial <= enough(newton, done, lambda) * norm => break Some(trial),
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
            if factored && !done {
                // The derivative was an old one.
                factored = false;
                continue;
            }
            let converged = residual <= criteria.tolerance.max(floor(task, unknowns, buffers, reference));
            return Outcome { converged, iterations: iteration + 1, residual, law_error };
        };
        unknowns[..count].copy_from_slice(&newton.trial[..count]);
        factored = task.has_tail() && lambda == 1.0 && next <= FAST * norm;
        norm = next;
        last_step = if lambda == 1.0 { length / scale } else { f64::INFINITY };
        newton.history.push(relative(norm));
    }
    let residual = relative(norm);
    Outcome {
        converged: residual <= criteria.tolerance.max(floor(task, unknowns, buffers, reference)),
        iterations: criteria.max_iterations,
        residual,
        law_error,
    }
}

/// The share of the residual that a step of `lambda` may leave without a look at the natural test.
fn enough(newton: &NewtonBuffers, done: bool, lambda: f64) -> f64 {
    if done || newton.iterated { 1.0 - 1e-4 * lambda } else { CLEARLY }
}

/// The relative residual that rounding leaves at the motion of the last evaluation.
fn floor(task: &Task, unknowns: &[c64], buffers: &BalanceBuffers, reference: f64) -> f64 {
    let Task { balance, point, slots, homotopy, .. } = task;
    if reference > 0.0 {
        let rounding = ROUNDING * balance.terms(point, *slots, *homotopy, unknowns, buffers) / reference;
        rounding.clamp(FLOOR, ROUNDED)
    } else {
        FLOOR
    }
}

/// Writes the Newton step from `unknowns` into `steps`; `false` when there is none.
pub(crate) fn correction(
    task: &Task,
    unknowns: &mut [c64],
    steps: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) -> bool {
    let Task { balance, point, slots, homotopy, .. } = task;
    if balance.evaluate(point, *slots, *homotopy, unknowns, buffers).is_err() {
        return false;
    }
    newton.krylov.forget();
    let length = newton_step(task, false, 0.0, unknowns, buffers, newton);
    for (entry, step) in steps.iter_mut().enumerate().take(slots * point.width()) {
        *step = newton.entry(task, entry);
    }
    length.is_finite()
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

/// Accuracy of the linear system relative to that of the balance: with it each step converges as that of Newton's method.
const FORCING: f64 = 0.1;

/// The linear system is never solved more roughly than this, nor to more digits than that.
const ROUGHEST: f64 = 1e-3;
const FINEST: f64 = 1e-9;

/// For a comparison of lengths.
const LEADING_DIGITS: f64 = 1e-2;

/// Up to so many real unknowns the whole derivative is factored where GMRES does not converge.
const FACTORED: usize = 4096;

/// Solves for the step, leaves it in `newton` and returns its norm. With `factored` the derivative of the step before is
/// used again. `residual` is the relative one.
fn newton_step(
    task: &Task,
    factored: bool,
    residual: f64,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) -> f64 {
    let Task { balance, point, core, homotopy, criteria, krylov, .. } = task;
    let size = task.size();
    let tail = load_residual(task, buffers, &mut newton.step, Some(&mut newton.tail_step));
    let length =
        |newton: &NewtonBuffers| ((0..size).map(|r| newton.step[(r, 0)].powi(2)).sum::<f64>() + tail).sqrt();
    if !factored {
        newton.iterated = *krylov;
        if *krylov {
            newton.krylov.load(task, buffers);
        }
    }
    if newton.iterated {
        let tolerance = (FORCING * residual).clamp(FINEST, ROUGHEST);
        let NewtonBuffers { krylov, step, .. } = newton;
        let solved = krylov_solve(task, tolerance, buffers, krylov, step);
        if solved || size > FACTORED {
            return if solved { length(newton) } else { f64::INFINITY };
        }
        load_residual(task, buffers, &mut newton.step, None);
        newton.iterated = false;
    }
    if !factored || *krylov {
        newton.lu.reserve(size);
        match criteria.jacobian {
            Jacobian::Analytic => balance.jacobian(point, *core, *homotopy, buffers, &mut newton.lu.matrix),
            Jacobian::Difference => difference_jacobian(task, unknowns, buffers, newton),
        }
        newton.lu.factor(size);
    }
    newton.lu.solve(newton.step.as_mut().subrows_mut(0, size));
    length(newton)
}

/// The core of the step by GMRES into a column of real unknowns; whether it converged.
fn krylov_solve(
    task: &Task,
    tolerance: f64,
    buffers: &BalanceBuffers,
    krylov: &mut Krylov,
    column: &mut Mat<f64>,
) -> bool {
    let width = task.point.width();
    krylov.solve(task, tolerance, buffers.residual.iter().copied(), |entry, step| {
        let (r, is_complex) = task.balance.real_index(width, entry / width, entry % width);
        column[(r, 0)] = step.re;
        if is_complex {
            column[(r + 1, 0)] = step.im;
        }
    })
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
    let size = task.size();
    let NewtonBuffers { lu, krylov, iterated, correction, .. } = newton;
    let tail = load_residual(task, buffers, correction, None);
    if *iterated {
        if !krylov_solve(task, LEADING_DIGITS, buffers, krylov, correction) {
            return false;
        }
    } else {
        lu.solve(correction.as_mut().subrows_mut(0, size));
    }
    let core: f64 = (0..size).map(|r| newton.correction[(r, 0)].powi(2)).sum();
    (core + tail).sqrt() <= (1.0 - 0.25 * lambda) * length
}

/// Writes the residual of the core into a column of real unknowns, and what substitution changes in the tail into
/// `tail_step`; returns the squared norm of the latter.
fn load_residual(
    task: &Task,
    buffers: &BalanceBuffers,
    column: &mut Mat<f64>,
    mut tail_step: Option<&mut Vec<c64>>,
) -> f64 {
    let Task { balance, point, slots, core, .. } = task;
    let width = point.width();
    for (entry, residual) in buffers.residual.iter().enumerate().take(core * width) {
        let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
        column[(r, 0)] = residual.re;
        if is_complex {
            column[(r + 1, 0)] = residual.im;
        }
    }
    let mut sum = 0.0;
    for entry in core * width..slots * width {
        let step = buffers.residual[entry] / point.weight[entry];
        sum += step.norm_sqr();
        if let Some(tail) = tail_step.as_deref_mut() {
            tail[entry] = step;
        }
    }
    sum
}

/// `trial = unknowns − λ · step`.
fn apply_step(task: &Task, unknowns: &[c64], newton: &mut NewtonBuffers, lambda: f64) {
    for (entry, unknown) in unknowns.iter().enumerate().take(task.slots * task.point.width()) {
        newton.trial[entry] = unknown - lambda * newton.entry(task, entry);
    }
}

/// Forward differences, one evaluation an unknown: the comparison that the paper offers.
fn difference_jacobian(
    task: &Task,
    unknowns: &mut [c64],
    buffers: &mut BalanceBuffers,
    newton: &mut NewtonBuffers,
) {
    let Task { balance, point, slots, core, homotopy, .. } = task;
    let width = point.width();
    let count = core * width;
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
