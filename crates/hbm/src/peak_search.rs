//! The summit of a response curve near a place on it: where the amplitude of a dof is stationary along the curve.
//!
//! With s the length of the curve and W the dof's amplitude at the base frequency, a summit is a change of sign of
//!
//! ```text
//! g(s) = d ln|W| / ds     from + to −
//! ```
//!
//! which is followed along the curve, so past folds, and closed in by the Illinois method: g need not be smooth, and is not
//! where a contact begins to slip. The derivative is that along the tangent, which is analytic; what it does to the dof is a
//! central difference, whose error moves the summit by far less than a step of the method.

use faer::c64;

use crate::continuation::ContinuationOptions;
use crate::course::FrequencyCourse;
use crate::error::PlanError;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::solution::{Solution, Status};
use crate::tracer::{Metric, Place, Tracer};

/// Half the difference along the tangent, as a relative length.
const DIFFERENCE: f64 = 1e-6;

/// The summit is closed in to this relative length.
const CLOSE: f64 = 1e-9;

/// Steps of a climb at most, and its first.
const MOST_STEPS: usize = 300;
const FIRST_STEP: f64 = 0.01;
const LEAST_STEP: f64 = 1e-5;

/// A guess may be wrong by this part of the motion.
const FARTHEST: f64 = 0.5;

/// The summit of a guess is no farther along the curve.
const NEARBY: f64 = 2.0;

/// Motion of the contacts at a frequency, and the direction of the response curve there.
#[derive(Debug, Clone)]
pub(crate) struct Pose {
    pub(crate) hertz: f64,
    /// In m, entry `[slot][i]`.
    motion: Vec<c64>,
    /// Change of the motion in m and of the frequency in Hz.
    tangent: (Vec<c64>, f64),
    /// −dg/ds.
    curvature: f64,
}

impl Pose {
    /// Of a response with contacts at rest, which has no curve.
    pub(crate) fn at_rest(hertz: f64) -> Self {
        Self { hertz, motion: Vec::new(), tangent: (Vec::new(), 0.0), curvature: 0.0 }
    }

    /// Without a contact a motion is empty as well, but its curve has a direction.
    fn rests(&self) -> bool {
        self.motion.is_empty() && self.tangent.1 == 0.0
    }

    /// The pose a part of the way from one to another, or beyond; with the direction of the first.
    pub(crate) fn between(&self, other: &Self, part: f64) -> Self {
        if self.motion.len() != other.motion.len() {
            return self.clone();
        }
        let motion = self.motion.iter().zip(&other.motion).map(|(a, b)| a + (b - a) * part).collect();
        Self { hertz: self.hertz + (other.hertz - self.hertz) * part, motion, ..self.clone() }
    }
}

/// A largest amplitude along a response curve.
#[derive(Debug, Clone)]
pub(crate) struct Summit {
    /// |W| at the base frequency, in m.
    pub(crate) amplitude: f64,
    /// Relative difference from which on two summits are two: see [`crate::prominence`].
    pub(crate) noise: f64,
    pub(crate) pose: Pose,
    pub(crate) solution: Solution,
}

impl Summit {
    /// In Hz.
    pub(crate) fn hertz(&self) -> f64 {
        self.pose.hertz
    }

    /// Whether this is the same place of the same response.
    pub(crate) fn is(&self, other: &Self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= self.noise * a.abs().max(b.abs());
        close(self.hertz(), other.hertz()) && close(self.amplitude, other.amplitude)
    }
}

/// What is sought: the largest amplitudes of output dof `dof` between two frequencies in Hz.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) range: (f64, f64),
    pub(crate) dof: usize,
}

impl Search<'_> {
    /// The summit near `guess`, a pose of the same structure with other numbers; and the Newton steps it took.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn near(&self, guess: &Pose, problem: &Problem) -> Result<(Option<Summit>, usize), PlanError> {
        let mut course = FrequencyCourse::nearby(problem, self.settings)?;
        let plan = &course.plan;
        let mut ws = plan.workspace();
        if guess.rests() {
            return Ok(self.at_rest(guess.hertz, plan, &mut ws));
        }
        if !plan.begin(guess.hertz, &mut ws) || guess.motion.len() != plan.slots() * ws.point.width() {
            return Ok((None, 0));
        }
        let options = ContinuationOptions::default();
        let mut tracer = Tracer::new(&mut course, &mut ws, self.range, &options);
        let summit = tracer.seat(guess).and_then(|place| {
            tracer.length = LEAST_STEP;
            tracer.climb(place, self, Some(guess.curvature), NEARBY)
        });
        Ok((summit, tracer.corrections))
    }
}

impl Tracer<'_> {
    /// The place on this curve nearest to a pose from another, across the direction of that.
    fn seat(&mut self, guess: &Pose) -> Option<Place> {
        let tangent = self.scaled(&guess.tangent.0, guess.tangent.1);
        let unknowns = self.scaled(&guess.motion, guess.hertz);
        let (parameter, unknowns) = unknowns.split_last()?;
        let mut place =
            Place { unknowns: unknowns.to_vec(), parameter: *parameter, tangent, residual: f64::INFINITY };
        let metric = Metric::at(&place, self.least);
        metric.normalise(&mut place.tangent);
        let border = metric.row(&place.tangent);
        if border.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let guess = metric.moved(&place, 0.0);
        Some(self.correct(&guess, &metric, &border, FARTHEST)?.0)
    }

    /// Displacements in m and a frequency as unknowns and parameter.
    fn scaled(&self, displacements: &[c64], hertz: f64) -> Vec<f64> {
        let length = |entry: usize| self.ws.point.length[entry % self.ws.point.width().max(1)];
        let entries: Vec<c64> = displacements.iter().enumerate().map(|(e, w)| w / length(e)).collect();
        self.real(&entries).into_iter().chain([hertz]).collect()
    }

    /// The inverse of that, without the frequency.
    fn physical(&mut self, unknowns: &[f64]) -> Vec<c64> {
        self.load(unknowns);
        let (ws, width) = (&*self.ws, self.ws.point.width());
        let entries = width * self.course.plan().slots();
        (0..entries).map(|entry| ws.unknowns[entry] * ws.point.length[entry % width]).collect()
    }

    /// The independent solution at a frequency as a place; `None` where there is none or a contact is held.
    pub(crate) fn start(&mut self, hertz: f64) -> (Option<Place>, Solution) {
        let plan = self.course.plan();
        let solution = plan.solve(hertz, self.ws);
        self.corrections += solution.stats.iterations;
        let moving = self.ws.point.width() == plan.rows();
        if solution.status != Status::Converged || !moving {
            return (None, solution);
        }
        (Some(self.begin(hertz)), solution)
    }

    /// |W| of output dof `dof` where the balance is evaluated.
    fn amplitude(&mut self, unknowns: &[f64], parameter: f64, dof: usize) -> Option<f64> {
        let residual = self.evaluate(unknowns, parameter)?;
        let plan = self.course.plan();
        let mut solution = Solution::empty(parameter, plan.slots());
        plan.report(Status::Converged, residual, self.ws, &mut solution);
        amplitude(&solution, plan.first_slot()?, dof)
    }

    /// g at a place: relative growth of the amplitude of output dof `dof` along the curve.
    pub(crate) fn growth(&mut self, place: &Place, dof: usize) -> Option<f64> {
        self.growth_and_height(place, dof).map(|(growth, _)| growth)
    }

    /// The same, and the amplitude in m.
    pub(crate) fn growth_and_height(&mut self, place: &Place, dof: usize) -> Option<(f64, f64)> {
        let metric = Metric::at(place, self.least);
        let mut beside = |length: f64| -> Option<f64> {
            let moved = metric.moved(place, length);
            let (parameter, unknowns) = moved.split_last()?;
            self.amplitude(unknowns, *parameter, dof)
        };
        let (above, below) = (beside(DIFFERENCE)?, beside(-DIFFERENCE)?);
        let growth = (above - below) / (DIFFERENCE * (above + below));
        growth.is_finite().then_some((growth, 0.5 * (above + below)))
    }

    /// The summit uphill from a place, no farther along the curve than `farthest`, inside the range.
    pub(crate) fn climb(
        &mut self,
        mut here: Place,
        search: &Search,
        curvature: Option<f64>,
        farthest: f64,
    ) -> Option<Summit> {
        let mut growth = self.growth(&here, search.dof)?;
        if growth < 0.0 {
            growth = -growth;
            for entry in &mut here.tangent {
                *entry = -*entry;
            }
        }
        // A little farther than a parabola has its summit, so that two places enclose it.
        self.length = match curvature {
            Some(curvature) if curvature > 0.0 => (1.2 * growth / curvature).clamp(LEAST_STEP, FIRST_STEP),
            _ => FIRST_STEP,
        };
        let mut way = 0.0;
        for _ in 0..MOST_STEPS {
            let (next, length) = self.step(&here)?;
            if self.comes_to_rest() || !search.holds(next.parameter) {
                return None;
            }
            let ahead = self.growth(&next, search.dof)?;
            if ahead <= 0.0 {
                return self.enclosed(&here, (growth, ahead), length, search);
            }
            way += length;
            if way > farthest {
                return None;
            }
            (here, growth) = (next, ahead);
        }
        None
    }

    /// The summit between a place and another at distance `length`, given the growth at both.
    pub(crate) fn enclosed(
        &mut self,
        from: &Place,
        (mut at_low, mut at_high): (f64, f64),
        length: f64,
        search: &Search,
    ) -> Option<Summit> {
        let metric = Metric::at(from, self.least);
        let curvature = (at_low - at_high) / length;
        let (mut low, mut high) = (0.0, length);
        let mut last = f64::INFINITY;
        let mut best = None;
        for round in 0..80 {
            // Illinois; halving now and then where growth has a kink or jumps.
            let part = match round % 4 {
                3 => 0.5,
                _ => (at_low / (at_low - at_high)).clamp(0.001, 0.999),
            };
            let middle = low + part * (high - low);
            let (place, _) = self.advance(from, &metric, middle)?;
            let growth = self.growth(&place, search.dof)?;
            best = Some(place);
            if growth > 0.0 {
                (low, at_low) = (middle, growth);
                at_high *= if last > 0.0 { 0.5 } else { 1.0 };
            } else {
                (high, at_high) = (middle, growth);
                at_low *= if last < 0.0 { 0.5 } else { 1.0 };
            }
            last = growth;
            if high - low <= CLOSE || growth.abs() <= CLOSE * curvature.max(1.0) {
                break;
            }
        }
        let place = best?;
        search.holds(place.parameter).then(|| self.summit(&place, curvature, search.dof)).flatten()
    }

    fn summit(&mut self, place: &Place, curvature: f64, dof: usize) -> Option<Summit> {
        let solution = self.solution(place);
        let amplitude = amplitude(&solution, self.course.plan().first_slot()?, dof)?;
        let (along, tangent) = place.tangent.split_last()?;
        let tangent = (self.physical(tangent), *along);
        let motion = self.physical(&place.unknowns);
        let pose = Pose { hertz: place.parameter, motion, tangent, curvature };
        (amplitude.is_finite() && solution.is_finite()).then_some(Summit {
            amplitude,
            noise: self.course.plan().noise(),
            pose,
            solution,
        })
    }
}

impl Search<'_> {
    /// Whether a frequency is in the range.
    pub(crate) fn holds(&self, hertz: f64) -> bool {
        hertz >= self.range.0 && hertz <= self.range.1
    }
}

/// |W| of output dof `dof` at the harmonic in `slot`.
pub(crate) fn amplitude(solution: &Solution, slot: usize, dof: usize) -> Option<f64> {
    Some(solution.displacement.get(dof)?.get(slot)?.norm())
}
