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

use crate::balance::Homotopy;
use crate::course::{Course, EntryCourse, FrequencyCourse, HOMOTOPY_START, HomotopyCourse};
use crate::error::PlanError;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::prominence::{keep_prominent, keep_wide};
use crate::settings::Settings;
use crate::solution::{Solution, Status};
use crate::tracer::{Place, Tracer};
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

impl Tracer<'_> {
    /// A place as a point of the curve.
    fn point(&mut self, place: &Place, arclength: f64) -> CurvePoint {
        let mut solution = self.solution(place);
        self.course.plan().judge(&mut solution);
        CurvePoint { parameter: place.parameter, arclength, fold: false, peaks: Vec::new(), solution }
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
