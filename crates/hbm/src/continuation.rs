//! The response as a curve: pseudo-arclength continuation in the frequency or in any other parameter.
//!
//! A point (û, λ) of the curve solves `r(û, λ) = 0`; the next one lies on the plane across the tangent t at distance s,
//!
//! ```text
//! [ J   r_λ ] [δû]      [ r                     ]
//! [ t_uᵀ t_λ ] [δλ]  = − [ ⟨t, (û, λ) − guess⟩ ],      ⟨·,·⟩ = Re(·, ·)/‖û‖² + (· ·)/λ²
//! ```
//!
//! so that folds are points like any other: there t_λ changes sign, and the place is refined. Lengths are relative to
//! the amplitude and the parameter where a step begins, so units do not matter.

use faer::{Mat, c64};

use crate::balance::Homotopy;
use crate::course::{Course, EntryCourse, FrequencyCourse, HOMOTOPY_START, HomotopyCourse};
use crate::dense::Lu;
use crate::error::PlanError;
use crate::newton::FLOOR;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::prominence::{keep_prominent, keep_wide};
use crate::settings::Settings;
use crate::solution::{Solution, Status};
use crate::workspace::Workspace;

/// How a curve is followed.
#[derive(Clone, Copy)]
pub struct ContinuationOptions<'a> {
    /// The longest step along the parameter, as a part of the way from beginning to end.
    pub longest_step: f64,
    /// Points after which the curve is given up.
    pub most_points: usize,
    /// Called with the parameter of every new point; `false` stops.
    pub progress: &'a dyn Fn(f64) -> bool,
}

impl Default for ContinuationOptions<'_> {
    fn default() -> Self {
        Self { longest_step: 0.02, most_points: 20_000, progress: &|_| true }
    }
}

/// How a curve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurveEnd {
    /// At the end of the range.
    Reached,
    /// Back at its beginning, or beyond it: a branch that does not lead to the end.
    Returned,
    /// No point was found to begin with.
    NoStart,
    /// The shortest step found no further point.
    Lost,
    /// A contact came to rest, where its law is set-valued and no curve leads on.
    Rest,
    /// As many points as were allowed.
    TooLong,
    /// Stopped from outside.
    Stopped,
}

/// One point of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// The parameter: a frequency in Hz, or the entry that is varied.
    pub parameter: f64,
    /// Length of the curve up to here, relative steps added up.
    pub arclength: f64,
    /// The curve turns back here.
    pub fold: bool,
    /// Output dofs whose amplitude at the base frequency is largest here, within its neighbourhood.
    pub peaks: Vec<usize>,
    /// The response.
    pub solution: Solution,
}

/// A response curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// In the order of the curve.
    pub points: Vec<CurvePoint>,
    /// How it ended.
    pub end: CurveEnd,
}

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

/// A peak is found to this part of the steps beside it; its height then to the square.
const PEAK: f64 = 1e-3;

/// A last correction of this relative length leaves an error of its square.
const SHORT_STEP: f64 = 1e-5;

/// Where corrections are as small as this, rounding allows no smaller residual than there is.
const ROUNDING: f64 = 1e-9;

/// A dimensionless displacement below this is rest.
const AT_REST: f64 = 1e-9;

/// A tangent across the parameter to this part counts as the fold itself.
const FOLD: f64 = 1e-7;

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

/// The response of `problem` as a curve from one frequency in Hz to another, with N harmonics solved by Newton's method
/// throughout (no tail, no estimates). No resonance of the linear structure, with contacts sticking or without any, is
/// stepped over. A point (u, λ) of a curve follows from the guess along the last tangent t by pseudo-arclength,
///
/// ```math
/// r(u, \lambda) = 0, \qquad \langle t, (u, \lambda) - \text{guess} \rangle = 0 .
/// ```
///
/// # Errors
/// As [`Plan::new`].
pub fn frequency_curve(
    problem: &Problem,
    settings: &Settings,
    (from, to): (f64, f64),
    options: &ContinuationOptions,
) -> Result<Curve, PlanError> {
    Ok(follow(&mut FrequencyCourse::new(problem, settings)?, from, to, options))
}

/// The response at one `frequency` in Hz as a curve in a parameter of the problem; `problem` answers `None` for a
/// parameter that makes no sense.
///
/// # Errors
/// As [`Plan::new`], at the beginning of the curve.
pub fn entry_curve(
    problem: &dyn Fn(f64) -> Option<Problem>,
    frequency: f64,
    settings: &Settings,
    (from, to): (f64, f64),
    options: &ContinuationOptions,
) -> Result<Curve, PlanError> {
    Ok(follow(&mut EntryCourse::new(problem, frequency, from, settings)?, from, to, options))
}

/// Follows the curve of `course` from one parameter to another.
fn follow(course: &mut dyn Course, from: f64, to: f64, options: &ContinuationOptions) -> Curve {
    let mut workspace = course.plan().workspace();
    let mut curve = Curve { points: Vec::new(), end: CurveEnd::NoStart };
    let first = course.plan().solve(course.frequency(from), &mut workspace);
    if first.status != Status::Converged || workspace.point.width() < course.plan().rows() {
        curve.end = if first.status.solved() { CurveEnd::Rest } else { CurveEnd::NoStart };
        return curve;
    }
    let mut tracer = Tracer::new(course, &mut workspace, (from, to), options);
    let mut place = tracer.begin(from);
    let mut arclength = 0.0;
    curve.points.push(CurvePoint {
        parameter: from,
        arclength,
        fold: false,
        peaks: Vec::new(),
        solution: first,
    });
    if from == to {
        curve.end = CurveEnd::Reached;
        return curve;
    }
    let inside = |place: &Place| place.parameter >= from.min(to) && place.parameter <= from.max(to);
    // Amplitudes at the two places before, and the step between them.
    let mut rising: Option<(Vec<f64>, f64)> = None;
    let mut here = tracer.amplitudes(&place);
    // Index of the point at `place`.
    let mut latest = 0;
    curve.end = loop {
        if curve.points.len() >= options.most_points {
            break CurveEnd::TooLong;
        }
        if !(options.progress)(place.parameter) {
            break CurveEnd::Stopped;
        }
        let Some((next, length)) = tracer.step(&place) else {
            // The range may end where nothing makes sense beyond, so that no step passes its end.
            let apart = (to - place.parameter).abs();
            if apart <= tracer.least
                && let Some(last) = tracer.at(&place, to)
            {
                curve.points.push(tracer.point(&last, arclength + apart / to.abs().max(tracer.least)));
                break CurveEnd::Reached;
            }
            break CurveEnd::Lost;
        };
        if place.rises() != next.rises()
            && let Some((fold, at)) = tracer.fold(&place, &next)
            && inside(&fold)
        {
            curve.points.push(CurvePoint { fold: true, ..tracer.point(&fold, arclength + at) });
        }
        let ahead = tracer.amplitudes(&next);
        if tracer.comes_to_rest() {
            break CurveEnd::Rest;
        }
        if let Some((before, step)) = &rising {
            for dof in (0..here.len()).filter(|&o| before[o] < here[o] && here[o] >= ahead[o]) {
                match tracer.peak(&place, (-step, length), dof) {
                    Some((peak, at)) if inside(&peak) => {
                        let point = tracer.point(&peak, arclength + at);
                        curve.points.push(CurvePoint { peaks: vec![dof], ..point });
                    }
                    Some(_) => {}
                    // What keeps it from being closed in is small: the highest place of the steps.
                    None => curve.points.get_mut(latest).into_iter().for_each(|p| p.peaks.push(dof)),
                }
            }
        }
        let beyond = |end: f64, sign: f64| (next.parameter - end) * sign * (to - from).signum() >= 0.0;
        let end = [(to, 1.0, CurveEnd::Reached), (from, -1.0, CurveEnd::Returned)];
        if let Some(&(end, _, reason)) = end.iter().find(|&&(end, sign, _)| beyond(end, sign)) {
            if let Some(last) = tracer.at(&next, end) {
                curve.points.push(tracer.point(&last, arclength + length));
            }
            break reason;
        }
        arclength += length;
        latest = curve.points.len();
        curve.points.push(tracer.point(&next, arclength));
        rising = Some((here, length));
        (place, here) = (next, ahead);
    };
    curve.points.sort_by(|a, b| a.arclength.total_cmp(&b.arclength));
    keep_prominent(&mut curve.points, course.plan());
    keep_wide(&mut curve.points, course.plan());
    curve
}

impl Place {
    /// Whether the parameter grows along the tangent.
    fn rises(&self) -> bool {
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
    longest: f64,
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

    /// The fold between two places, by the sign of t_λ over the length of the step; and its distance from the first.
    fn fold(&mut self, before: &Place, after: &Place) -> Option<(Place, f64)> {
        let metric = Metric::at(before, self.least);
        let along = |place: &Place| place.tangent.last().copied().unwrap_or(0.0);
        let apart: Vec<f64> = (after.unknowns.iter().zip(&before.unknowns))
            .map(|(a, b)| a - b)
            .chain([after.parameter - before.parameter])
            .collect();
        let (mut low, mut high) = (0.0, metric.product(&before.tangent, &apart));
        let (mut at_low, mut at_high) = (along(before), along(after));
        let mut best = None;
        for round in 0..40 {
            // Illinois would do; halving now and then keeps it honest at kinks.
            let part = if round % 3 == 2 { 0.5 } else { (at_low / (at_low - at_high)).clamp(0.02, 0.98) };
            let middle = low + part * (high - low);
            let (place, _) = self.advance(before, &metric, middle)?;
            let slope = along(&place);
            let done = slope.abs() <= FOLD || high - low <= 1e-12;
            if slope * along(before) > 0.0 {
                (low, at_low) = (middle, slope);
            } else {
                (high, at_high) = (middle, slope);
            }
            best = Some((place, middle));
            if done {
                break;
            }
        }
        best
    }

    /// Whether a contact whose law is set-valued at rest hardly moves any more at the place evaluated last.
    pub(crate) fn comes_to_rest(&self) -> bool {
        let (plan, width) = (self.course.plan(), self.ws.point.width());
        let slots = plan.rungs[self.ws.goal].slots;
        let moves = |row: usize| (0..slots).any(|slot| self.ws.unknowns[slot * width + row].norm() > AT_REST);
        let holds = |row: usize| plan.contacts[self.ws.point.active[row]].law.holding_force() > 0.0;
        (0..width - plan.joint_rows).any(|row| holds(row) && !moves(row))
    }

    /// Amplitudes of the output dofs at the base frequency, at a place.
    fn amplitudes(&mut self, place: &Place) -> Vec<f64> {
        let slot = self.course.plan().first_slot();
        let solution = self.solution(place);
        let first = |row: &Vec<c64>| slot.and_then(|slot| row.get(slot)).map_or(0.0, |w| w.norm());
        solution.displacement.iter().map(first).collect()
    }

    /// The place of largest amplitude of output dof `dof` at distances in `range` from a place, and its distance: golden
    /// section, since the curve may have kinks.
    fn peak(&mut self, from: &Place, range: (f64, f64), dof: usize) -> Option<(Place, f64)> {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let metric = Metric::at(from, self.least);
        let at = |tracer: &mut Self, length: f64| -> Option<(Place, f64)> {
            let (place, _) = tracer.advance(from, &metric, length)?;
            let amplitude = tracer.amplitudes(&place)[dof];
            Some((place, amplitude))
        };
        let (mut low, mut high) = range;
        let width = high - low;
        let (mut x, mut y) = (high - RATIO * (high - low), low + RATIO * (high - low));
        let (mut left, mut right) = (at(self, x)?, at(self, y)?);
        while high - low > PEAK * width {
            if left.1 >= right.1 {
                (high, y, right) = (y, x, left);
                x = high - RATIO * (high - low);
                left = at(self, x)?;
            } else {
                (low, x, left) = (x, y, right);
                y = low + RATIO * (high - low);
                right = at(self, y)?;
            }
        }
        Some(if left.1 >= right.1 { (left.0, x) } else { (right.0, y) })
    }

    /// The place at parameter `parameter`, from one beyond it.
    fn at(&mut self, beyond: &Place, parameter: f64) -> Option<Place> {
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

    /// A place as a point of the curve.
    fn point(&mut self, place: &Place, arclength: f64) -> CurvePoint {
        let mut solution = self.solution(place);
        self.course.plan().judge(&mut solution);
        CurvePoint { parameter: place.parameter, arclength, fold: false, peaks: Vec::new(), solution }
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

/// Points of a homotopy's curve.
const MOST_HOMOTOPY_POINTS: usize = 300;

impl Plan {
    /// Follows `homotopy` from a solution in the unknowns at 0 to the problem at 1 along the arc, so through folds;
    /// whether the end was reached. The unknowns then hold what was found there.
    pub(crate) fn follow_homotopy(&self, homotopy: fn(f64) -> Homotopy, ws: &mut Workspace) -> bool {
        let mut course = HomotopyCourse { plan: self, homotopy };
        let (from, to) = (HOMOTOPY_START, HOMOTOPY_START + 1.0);
        let mut tracer = Tracer::new(&mut course, ws, (from, to), &ContinuationOptions::default());
        tracer.longest = 0.2;
        let mut place = tracer.begin(from);
        for _ in 0..MOST_HOMOTOPY_POINTS {
            let Some((next, _)) = tracer.step(&place) else { return false };
            if next.parameter >= to {
                let Some(last) = tracer.at(&next, to) else { return false };
                tracer.load(&last.unknowns);
                return true;
            }
            if next.parameter < from - 0.5 {
                return false;
            }
            place = next;
        }
        false
    }
}
