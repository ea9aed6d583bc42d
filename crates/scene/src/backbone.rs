//! Damped nonlinear modes of a scene's structure: the curve that a designer of friction dampers reads.

use std::time::Instant;

use hbm::{ModeEnd, ModeOptions, ModePoint, Origin};
use serde::Serialize;

use crate::error::SceneError;
use crate::outcome::{Names, Point};
use crate::scene::Scene;

/// Which mode of a scene, and over which amplitudes.
#[derive(Clone, Copy)]
pub struct BackboneOptions<'a> {
    /// Counted from one in the order of the frequencies of the structure that `origin` names.
    pub mode: usize,
    /// The linear structure from which the mode is followed.
    pub origin: Origin,
    /// The dof whose amplitude is given; the first that is excited, else the first that is recovered, where none is named.
    pub dof: Option<&'a str>,
    /// Smallest and largest amplitude |W_1| in m; by the contacts' own lengths where none are given.
    pub amplitudes: (Option<f64>, Option<f64>),
    /// Points wanted.
    pub points: usize,
    /// Called with the amplitude of every new point; `false` stops.
    pub progress: &'a dyn Fn(f64) -> bool,
}

/// A nonlinear mode as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BackboneOutcome {
    /// 1; raised when a reader of older results would be misled.
    pub format_version: u32,
    /// The scene's name.
    pub scene: String,
    /// Units of every number.
    pub units: &'static str,
    /// Counted from one.
    pub mode: usize,
    /// `stuck` or `free`: the linear structure from which the mode was followed.
    pub origin: &'static str,
    /// The dof whose amplitude |W_1| is given.
    pub dof: String,
    /// `reached`, or why the mode ended before all amplitudes had their point.
    pub end: &'static str,
    /// The same in words; empty when all were reached.
    pub reason: &'static str,
    /// What a user should know beyond the numbers.
    pub notes: Vec<String>,
    /// The resonance at the scene's own excitation, interpolated between points.
    pub expected: Option<Expected>,
    /// Along the mode, from small amplitudes to large ones; in between the amplitude may turn back.
    pub points: Vec<BackbonePoint>,
    /// Time in s.
    pub solve_s: f64,
}

/// A resonance that a mode predicts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// Where the response is largest, in Hz.
    pub frequency: f64,
    /// |W_1| of the dof there, in m.
    pub amplitude: f64,
    /// Natural frequency in Hz at that amplitude.
    pub natural_frequency: f64,
    /// Ratio of critical damping at that amplitude.
    pub damping_ratio: f64,
}

/// A nonlinear mode at one amplitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BackbonePoint {
    /// |W_1| of the dof in m.
    pub amplitude: f64,
    /// Ratio of critical damping.
    pub damping_ratio: f64,
    /// √(w_1ᴴ M w_1) in m √kg.
    pub modal_amplitude: f64,
    /// Factor on the scene's excitation at which the response has its resonance at this amplitude; null where nothing
    /// excites the mode or its damping is negative.
    pub excitation: Option<f64>,
    /// Frequency of that resonance in Hz.
    pub resonance: Option<f64>,
    /// The motion at the natural frequency, which is `frequency`.
    #[serde(flatten)]
    pub point: Point,
}

/// Amplitudes where none are given, as parts of the largest length of a contact law.
const RANGE: (f64, f64) = (0.1, 1e3);

/// From this damping on a prediction from one mode is rough.
const HEAVY: f64 = 0.05;

/// How a mode ended, for programs and for readers.
fn words(end: ModeEnd) -> (&'static str, &'static str) {
    match end {
        ModeEnd::Reached => ("reached", ""),
        ModeEnd::NoStart => (
            "no start",
            "the mode was found at no amplitude of the range; choose another range, or follow it from the other side (--from \
             stuck or free)",
        ),
        ModeEnd::Lost => (
            "lost",
            "the shortest step found no further amplitude; this dof may not move in the mode there (--dof names another)",
        ),
        ModeEnd::Returned => (
            "returned",
            "the amplitude of this dof turned back for good; another dof may tell more of the mode (--dof)",
        ),
        ModeEnd::Stopped => ("stopped", "stopped; the points so far are kept"),
    }
}

impl Scene {
    /// Follows a damped nonlinear mode of the scene over its amplitude.
    ///
    /// # Errors
    /// [`SceneError`] when dof, mode or amplitudes make no sense, or the problem cannot be posed.
    pub fn backbone(&self, options: &BackboneOptions) -> Result<BackboneOutcome, SceneError> {
        let began = Instant::now();
        let dof = match options.dof {
            Some(dof) => dof.to_owned(),
            None => self.usual_reference(),
        };
        let scene = self.clone().with_output(std::slice::from_ref(&dof))?;
        let problem = scene.problem()?;
        let mode = ModeOptions {
            mode: options.mode.saturating_sub(1),
            origin: options.origin,
            reference: problem.output.first().copied().unwrap_or(0),
            amplitudes: range(problem, options.amplitudes)?,
            points: options.points,
            progress: options.progress,
        };
        let failed = |error: hbm::PlanError| SceneError::entry(&error.place, error.problem);
        let found = hbm::nonlinear_mode(problem, &self.settings, &mode).map_err(failed)?;
        let names = Names::of(&scene, &found.orders);
        let point = |point: &ModePoint| BackbonePoint {
            amplitude: point.amplitude,
            damping_ratio: point.damping_ratio,
            modal_amplitude: point.modal_amplitude,
            excitation: point.excitation,
            resonance: point.resonance,
            point: names.point(&point.solution, false),
        };
        let (end, reason) = words(found.end);
        let points: Vec<BackbonePoint> = found.points.iter().map(point).collect();
        let expected = expected(&points);
        let mut notes = self.notes.clone();
        notes.extend(expected.filter(|e| e.damping_ratio > HEAVY).map(|e| {
            let percent = 100.0 * e.damping_ratio;
            format!(
                "at the scene's excitation the mode is damped by {percent:.0} %, so its resonance is wide and other modes \
                 take part in it: the prediction is rough; compare with stickslip sweep"
            )
        }));
        Ok(BackboneOutcome {
            format_version: 1,
            scene: self.name.clone(),
            units: "SI, Hz, rad",
            mode: options.mode,
            origin: match options.origin {
                Origin::Stuck => "stuck",
                Origin::Free => "free",
            },
            dof,
            end,
            reason,
            notes,
            expected,
            points,
            solve_s: began.elapsed().as_secs_f64(),
        })
    }

    /// The first dof that is excited, else the first that is recovered.
    pub(crate) fn usual_reference(&self) -> String {
        let known = self.dofs();
        let forces = self.excitation.iter().filter(|entry| entry.kind != hbm::ExcitationKind::Base);
        let excited =
            forces.filter(|entry| entry.amplitude != 0.0).find_map(|entry| known.get(entry.dof).cloned());
        excited.or_else(|| self.output().first().map(|dof| (*dof).to_owned())).unwrap_or_default()
    }
}

/// The amplitudes over which a mode is followed.
fn range(problem: &hbm::Problem, given: (Option<f64>, Option<f64>)) -> Result<(f64, f64), SceneError> {
    let lengths = problem.contacts.iter().filter_map(|contact| contact.law.length());
    // Of joints those of the tangential directions: where friction begins to slip.
    let tangential = |joint: &hbm::Joint| joint.law.length(0);
    let largest = lengths.chain(problem.joints.iter().map(tangential)).filter(|l| *l > 0.0).reduce(f64::max);
    let from = given.0.or_else(|| Some(RANGE.0 * largest?));
    let to = given.1.or_else(|| Some(RANGE.1 * largest?));
    match (from, to) {
        (Some(from), Some(to)) => Ok((from, to)),
        _ => Err(SceneError::entry(
            "amplitudes",
            "no contact law has a length of its own, so name both ends: --amplitudes 1e-6:1e-3",
        )),
    }
}

/// Where the factor on the excitation passes one, at the largest amplitude: logarithms between the points beside it.
fn expected(points: &[BackbonePoint]) -> Option<Expected> {
    let level = |point: &BackbonePoint| Some((point.excitation?.ln(), point.resonance?));
    let passes = |pair: &&[BackbonePoint]| match pair {
        [a, b] => level(a).zip(level(b)).is_some_and(|(a, b)| a.0 <= 0.0 && b.0 > 0.0),
        _ => false,
    };
    let [a, b] = points.windows(2).rev().find(passes)? else { return None };
    let ((low, low_hertz), (high, high_hertz)) = level(a).zip(level(b))?;
    let between = |x: f64, y: f64| x + (y - x) * low / (low - high);
    Some(Expected {
        frequency: between(low_hertz, high_hertz),
        amplitude: between(a.amplitude.ln(), b.amplitude.ln()).exp(),
        natural_frequency: between(a.point.frequency, b.point.frequency),
        damping_ratio: between(a.damping_ratio, b.damping_ratio),
    })
}
