//! Steps along a curve: guesses along its tangent, corrected across it.

use faer::{Mat, c64};

use crate::continuation::ContinuationOptions;
use crate::course::Course;
use crate::dense::Lu;
use crate::newton::FLOOR;
use crate::solution::{Solution, Status};
use crate::workspace::Workspace;

/// Newton steps in a corrector at most.
const CORRECTIONS: usize = 10;

/// The step is adapted so that a corrector takes about so many.
const WANTED_CORRECTIONS: f64 = 3.5;

/// The tangent may turn by this much (cosine) in a step.
const STRAIGHT: f64 = 0.94;

/// First, longest and shortest relative step.
const FIRST_STEP: f64 = 0.01;
const LONGEST_STEP: f64 = 0.25;
const SHORTEST_STEP: f64 = 1e-9;

/// Lengths are relative to the parameter down to this part of its range.
const LEAST: f64 = 1e-3;

/// Beside a resonance of no width steps are this part of the longest at least.
const SLOWEST: f64 = 1e-6;

/// A last correction of this relative length leaves an error of its square.
const SHORT_STEP: f64 = 1e-5;

/// Where corrections are as small as this, rounding allows no smaller residual than there is.
const ROUNDING: f64 = 1e-9;

/// A dimensionless displacement below this is rest.
const AT_REST: f64 = 1e-9;

/// A place on the curve: real unknowns, parameter, tangent.
#[derive(Debug, Clone, Default)]
pub(crate) struct Place {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) parameter: f64,
    /// Unit tangent in the metric of this place: real unknowns, then the parameter.
    pub(crate) tangent: Vec<f64>,
    /// Relative residual.
    pub(crate) residual: f64,
}

impl Place {
    /// Whether the parameter grows along the tangent.
    pub(crate) fn rises(&self) -> bool {
        self.tangent.last().is_some_and(|t| *t > 0.0)
    }
}

/// The machinery of one curve.
pub(crate) struct Tracer<'c> {
    pub(crate) course: &'c mut dyn Course,
    pub(crate) ws: &'c mut Workspace,
    /// Direction of the first step along the parameter.
    forward: f64,
    /// Longest step of the parameter.
    pub(crate) longest: f64,
    /// Below this the parameter is as good as zero.
    pub(crate) least: f64,
    /// Relative length of the next step.
    pub(crate) length: f64,
    /// Newton steps of correctors so far.
    pub(crate) corrections: usize,
    lu: Lu<f64>,
    column: Mat<f64>,
    slope: Vec<c64>,
}

impl<'c> Tracer<'c> {
    pub(crate) fn new(
        course: &'c mut dyn Course,
        ws: &'c mut Workspace,
        (from, to): (f64, f64),
        options: &ContinuationOptions,
    ) -> Self {
        let entries = ws.point.width() * course.plan().rungs[ws.goal].slots;
        Self {
            forward: (to - from).signum(),
            longest: options.longest_step * (to - from).abs(),
            least: LEAST * (to - from).abs(),
            length: FIRST_STEP,
            corrections: 0,
            lu: Lu::new(2 * entries + 1, 1),
            column: Mat::zeros(2 * entries + 1, 1),
            slope: vec![c64::ZERO; entries],
            course,
            ws,
        }
    }

    /// Number of real unknowns.
    fn size(&self) -> usize {
        let plan = self.course.plan();
        plan.balance(self.ws.goal).size(self.ws.point.width(), plan.rungs[self.ws.goal].slots)
    }

    /// Copies real unknowns to the complex ones of the workspace.
    pub(crate) fn load(&mut self, unknowns: &[f64]) {
        let (plan, width) = (self.course.plan(), self.ws.point.width());
        let balance = plan.balance(self.ws.goal);
        for entry in 0..plan.rungs[self.ws.goal].slots * width {
            let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
            self.ws.unknowns[entry] = c64::new(unknowns[r], if is_complex { unknowns[r + 1] } else { 0.0 });
        }
    }

    /// Writes complex entries `[slot][i]` as real ones.
    pub(crate) fn real(&self, entries: &[c64]) -> Vec<f64> {
        let (plan, width) = (self.course.plan(), self.ws.point.width());
        let balance = plan.balance(self.ws.goal);
        let mut real = vec![0.0; self.size()];
        for (entry, value) in entries.iter().enumerate().take(plan.rungs[self.ws.goal].slots * width) {
            let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
            real[r] = value.re;
            if is_complex {
                real[r + 1] = value.im;
            }
        }
        real
    }

    /// Residual at real unknowns and parameter; its norm relative to the excitation.
    pub(crate) fn evaluate(&mut self, unknowns: &[f64], parameter: f64) -> Option<f64> {
        if !self.course.place(parameter, self.ws) {
            return None;
        }
        self.load(unknowns);
        let (plan, goal) = (self.course.plan(), self.ws.goal);
        let slots = plan.rungs[goal].slots;
        let homotopy = self.course.homotopy(parameter);
        let norm = plan.balance(goal).evaluate(
            &self.ws.point,
            slots,
            homotopy,
            &self.ws.unknowns,
            &mut self.ws.balance[goal],
        );
        let reference = self.ws.point.excitation_norm(slots);
        Some(norm.ok()? / if reference > 0.0 { reference } else { 1.0 })
    }

    /// Factors the bordered derivative at the place evaluated last; `border` is its last row.
    fn factor(&mut self, parameter: f64, border: &[f64]) -> bool {
        let (goal, size) = (self.ws.goal, self.size());
        // First the slope: it may evaluate at other parameters, and comes back.
        if !self.course.slope(parameter, self.ws, &mut self.slope) {
            return false;
        }
        let plan = self.course.plan();
        let balance = plan.balance(goal);
        balance.jacobian(
            &self.ws.point,
            plan.rungs[goal].slots,
            self.course.homotopy(parameter),
            &mut self.ws.balance[goal],
            &mut self.lu.matrix,
        );
        for (r, slope) in self.real(&self.slope).into_iter().enumerate() {
            self.lu.matrix[(r, size)] = slope;
        }
        for (column, entry) in border.iter().enumerate() {
            self.lu.matrix[(size, column)] = *entry;
        }
        self.lu.factor(size + 1);
        true
    }

    /// Solves with the bordered derivative: right-hand side `(upper, last)`.
    fn solve(&mut self, upper: Option<&[f64]>, last: f64) -> Vec<f64> {
        let size = self.size();
        for r in 0..size {
            self.column[(r, 0)] = upper.map_or(0.0, |upper| upper[r]);
        }
        self.column[(size, 0)] = last;
        self.lu.solve(self.column.as_mut().subrows_mut(0, size + 1));
        (0..=size).map(|r| self.column[(r, 0)]).collect()
    }

    /// The place where the workspace is, with the tangent that leads forward.
    pub(crate) fn begin(&mut self, parameter: f64) -> Place {
        let unknowns = self.real(&self.ws.unknowns);
        let mut border = vec![0.0; unknowns.len() + 1];
        if let Some(last) = border.last_mut() {
            *last = self.forward;
        }
        let residual = self.evaluate(&unknowns, parameter).unwrap_or(f64::INFINITY);
        let mut place = Place { unknowns, parameter, tangent: border.clone(), residual };
        if self.factor(parameter, &border) {
            place.tangent = self.solve(None, 1.0);
        }
        Metric::at(&place, self.least).normalise(&mut place.tangent);
        place
    }

    /// One step forward and its length; shorter ones until one succeeds.
    pub(crate) fn step(&mut self, from: &Place) -> Option<(Place, f64)> {
        let metric = Metric::at(from, self.least);
        while self.length >= SHORTEST_STEP {
            let along = from.tangent.last().map_or(0.0, |t| t.abs());
            let limit = self.course.reach(from.parameter).clamp(SLOWEST * self.longest, self.longest);
            let length = if along > 0.0 { self.length.min(limit / along) } else { self.length };
            if let Some((next, corrections)) = self.advance(from, &metric, length) {
                let straight = metric.product(&from.tangent, &next.tangent)
                    / metric.product(&next.tangent, &next.tangent).sqrt();
                if straight >= STRAIGHT || length <= 1e3 * SHORTEST_STEP {
                    let change = (WANTED_CORRECTIONS / corrections as f64).clamp(0.5, 1.6);
                    // A turning tangent shortens the next step before it has to be repeated.
                    let turn = if straight < 0.98 { 0.7 } else { 1.0 };
                    self.length = (length * change * turn).min(LONGEST_STEP);
                    return Some((next, length));
                }
            }
            self.length = 0.4 * length;
        }
        None
    }

    /// Predictor and corrector; the place and how many corrections it took.
    pub(crate) fn advance(&mut self, from: &Place, metric: &Metric, length: f64) -> Option<(Place, usize)> {
        let border = metric.row(&from.tangent);
        self.correct(&metric.moved(from, length), metric, &border, 2.0 * length.abs().max(1e-3))
    }

    /// Newton's method from a guess, on the plane through it across `border`, no step of it longer than `farthest`; the
    /// place and how many corrections it took until they were short. Those after that are of rounding, which near a narrow
    /// resonance leaves a larger residual than elsewhere, and say nothing about the length of the step.
    pub(crate) fn correct(
        &mut self,
        guess: &[f64],
        metric: &Metric,
        border: &[f64],
        farthest: f64,
    ) -> Option<(Place, usize)> {
        let mut here = guess.to_vec();
        let mut last_step = f64::INFINITY;
        let mut needed = None;
        let tolerance = self.course.plan().criteria().tolerance;
        for correction in 1..=CORRECTIONS {
            if last_step <= SHORT_STEP {
                needed = needed.or(Some(correction));
            }
            let (parameter, unknowns) = here.split_last()?;
            self.corrections += 1;
            let residual = self.evaluate(unknowns, *parameter)?;
            if !self.factor(*parameter, border) {
                return None;
            }
            let settled = residual <= FLOOR && last_step <= ROUNDING;
            if settled || (residual <= tolerance && last_step <= SHORT_STEP) {
                let mut place = Place {
                    unknowns: unknowns.to_vec(),
                    parameter: *parameter,
                    tangent: Vec::new(),
                    residual,
                };
                place.tangent = self.solve(None, 1.0);
                // The new place measures with its own metric.
                Metric::at(&place, self.least).normalise(&mut place.tangent);
                return Some((place, needed.unwrap_or(correction)));
            }
            let upper = self.real(&self.ws.balance[self.ws.goal].residual);
            let off: f64 = border.iter().zip(here.iter().zip(guess)).map(|(b, (x, g))| b * (x - g)).sum();
            let step = self.solve(Some(&upper), off);
            let size = metric.product(&step, &step).sqrt();
            // Diverging: the step was too long.
            if !size.is_finite() || size > farthest || (correction > 3 && size > 0.7 * last_step) {
                return None;
            }
            for (x, step) in here.iter_mut().zip(&step) {
                *x -= step;
            }
            last_step = size;
        }
        None
    }

    /// Whether a contact whose law is set-valued at rest hardly moves any more at the place evaluated last.
    pub(crate) fn comes_to_rest(&self) -> bool {
        let (plan, width) = (self.course.plan(), self.ws.point.width());
        let slots = plan.rungs[self.ws.goal].slots;
        let moves = |row: usize| (0..slots).any(|slot| self.ws.unknowns[slot * width + row].norm() > AT_REST);
        let holds = |row: usize| plan.contacts[self.ws.point.active[row]].law.holding_force() > 0.0;
        (0..width - plan.joint_rows).any(|row| holds(row) && !moves(row))
    }

    /// The place at parameter `parameter`, from one beyond it.
    pub(crate) fn at(&mut self, beyond: &Place, parameter: f64) -> Option<Place> {
        let mut unknowns = beyond.unknowns.clone();
        let mut border = vec![0.0; unknowns.len() + 1];
        if let Some(last) = border.last_mut() {
            *last = 1.0;
        }
        let tolerance = self.course.plan().criteria().tolerance;
        let metric = Metric::at(beyond, self.least);
        let mut last_step = f64::INFINITY;
        for _ in 0..2 * CORRECTIONS {
            let residual = self.evaluate(&unknowns, parameter)?;
            if residual <= tolerance || (residual <= FLOOR && last_step <= ROUNDING) {
                return Some(Place { unknowns, parameter, tangent: beyond.tangent.clone(), residual });
            }
            if !self.factor(parameter, &border) {
                return None;
            }
            let upper = self.real(&self.ws.balance[self.ws.goal].residual);
            let step = self.solve(Some(&upper), 0.0);
            last_step = metric.product(&step, &step).sqrt();
            for (x, step) in unknowns.iter_mut().zip(&step) {
                *x -= step;
            }
        }
        None
    }

    /// A place as a solution.
    pub(crate) fn solution(&mut self, place: &Place) -> Solution {
        let residual = self.evaluate(&place.unknowns, place.parameter).unwrap_or(place.residual);
        let frequency = self.course.frequency(place.parameter);
        let mut solution = Solution::empty(frequency, self.course.plan().slots());
        self.course.plan().report(Status::Converged, residual, self.ws, &mut solution);
        solution
    }
}

/// Lengths relative to the amplitude and the parameter of a place.
pub(crate) struct Metric {
    /// 1/‖û‖² and 1/λ², λ no less than a small part of the range: it may pass through zero.
    weights: (f64, f64),
}

impl Metric {
    /// Parameters below `least` are measured as if they were so large.
    pub(crate) fn at(place: &Place, least: f64) -> Self {
        let size: f64 = place.unknowns.iter().map(|u| u * u).sum();
        let parameter = place.parameter.abs().max(least).powi(2);
        let weight = |square: f64| if square > 0.0 { 1.0 / square } else { 1.0 };
        Self { weights: (weight(size), weight(parameter)) }
    }

    pub(crate) fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        match (a.split_last(), b.split_last()) {
            (Some((a_last, a)), Some((b_last, b))) => {
                let unknowns: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                unknowns * self.weights.0 + a_last * b_last * self.weights.1
            }
            _ => 0.0,
        }
    }

    pub(crate) fn normalise(&self, tangent: &mut [f64]) {
        let size = self.product(tangent, tangent).sqrt();
        for entry in tangent.iter_mut() {
            *entry /= size;
        }
    }

    /// The row whose product with a vector is the metric's product with `tangent`.
    pub(crate) fn row(&self, tangent: &[f64]) -> Vec<f64> {
        let last = tangent.len().saturating_sub(1);
        let weight = |i: usize| if i == last { self.weights.1 } else { self.weights.0 };
        tangent.iter().enumerate().map(|(i, t)| t * weight(i)).collect()
    }

    /// The place at a distance along the tangent.
    pub(crate) fn moved(&self, from: &Place, length: f64) -> Vec<f64> {
        let start = from.unknowns.iter().chain([&from.parameter]);
        start.zip(&from.tangent).map(|(x, t)| x + length * t).collect()
    }
}
