//! The response as a curve, through its folds.

use std::time::Instant;

use arrays::{Cell, Kind, Table};
use hbm::{ContinuationOptions, CurveEnd, CurvePoint, Problem, Solution};
use serde::Serialize;

use crate::error::SceneError;
use crate::frequencies::Frequencies;
use crate::notes;
use crate::outcome::{Names, Point};
use crate::reduction::ReductionFacts;
use crate::scene::Scene;
use crate::stability::{self, Judge};
use crate::variants::Variants;

/// What a curve runs along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along<'a> {
    /// The frequency, over the range of the scene's frequencies or its reverse.
    Frequency,
    /// A numeric entry of the scene (a JSON pointer), at one frequency in Hz.
    Entry {
        /// Where it stands.
        pointer: &'a str,
        /// In Hz.
        frequency: f64,
    },
}

/// A response curve as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveOutcome {
    /// 1; raised when a reader of older results would be misled.
    pub format_version: u32,
    /// The scene's name.
    pub scene: String,
    /// The dofs whose displacement is given.
    pub dofs: Vec<String>,
    /// Units of every number.
    pub units: &'static str,
    /// `frequency`, or the JSON pointer of the entry that varies.
    pub parameter: String,
    /// `reached`, or why the curve ended before the end of its range.
    pub end: &'static str,
    /// The same in words; empty when the end was reached.
    pub reason: &'static str,
    /// How the structure was reduced; not there when it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reduction: Option<ReductionFacts>,
    /// What a user should know beyond the numbers.
    pub notes: Vec<String>,
    /// In the order of the curve.
    pub points: Vec<CurveOutcomePoint>,
    /// Time in s.
    pub solve_s: f64,
}

/// One point of a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveOutcomePoint {
    /// Value of the parameter.
    pub parameter: f64,
    /// Length of the curve up to here, relative steps added up.
    pub arclength: f64,
    /// The curve turns back here.
    pub fold: bool,
    /// Dofs whose amplitude |W_k| at the base frequency is a maximum here.
    pub peaks: Vec<String>,
    /// The response.
    #[serde(flatten)]
    pub point: Point,
}

impl CurveOutcome {
    /// Amplitude |W_k| at the base frequency of output dof `dof` at a point.
    pub fn amplitude(&self, dof: usize, point: &CurveOutcomePoint) -> Option<f64> {
        let (_, spectrum) = point.point.displacement.as_ref()?.0.get(dof)?;
        spectrum.0.iter().find(|(k, _)| *k > 0).map(|(_, w)| w.norm())
    }
}

impl CurveOutcome {
    /// The displacements as a long table, one row a harmonic.
    pub fn table(&self) -> Table<'_> {
        let columns = [
            ("arclength", Kind::Number),
            ("parameter", Kind::Number),
            ("fold", Kind::Truth),
            ("dof", Kind::Text),
            ("harmonic", Kind::Whole),
            ("re", Kind::Number),
            ("im", Kind::Number),
        ];
        Table::new(columns, |take| {
            for point in &self.points {
                let [arclength, parameter] = [point.arclength, point.parameter].map(Cell::Number);
                for (dof, spectrum) in point.point.displacement.iter().flat_map(|named| &named.0) {
                    for (k, w) in &spectrum.0 {
                        let (re, im) = (Cell::Number(w.re), Cell::Number(w.im));
                        let (dof, k) = (Cell::Text(dof), Cell::Whole(*k));
                        take(&[arclength, parameter, Cell::Truth(point.fold), dof, k, re, im])?;
                    }
                }
            }
            Ok(())
        })
    }
}

/// How a curve ended, for programs and for readers.
fn words(end: CurveEnd) -> (&'static str, &'static str) {
    match end {
        CurveEnd::Reached => ("reached", ""),
        CurveEnd::Returned => (
            "returned",
            "the curve came back to where it began; begin further out, or at the other end, to see the rest",
        ),
        CurveEnd::NoStart => ("no start", "no solution was found where the curve begins; begin elsewhere"),
        CurveEnd::Lost => ("lost", "the shortest step found no further point"),
        CurveEnd::Rest => (
            "rest",
            "a contact is at rest there, held by its law; a curve begins only where all contacts move",
        ),
        CurveEnd::TooLong => ("too long", "the curve has more points than are allowed"),
        CurveEnd::Stopped => ("stopped", "stopped; the points so far are kept"),
    }
}

/// The frequencies between which a curve runs.
fn frequencies(along: Along, (from, to): (f64, f64)) -> Frequencies {
    match along {
        Along::Entry { frequency, .. } => Frequencies::ends(frequency, frequency),
        Along::Frequency => Frequencies::ends(from.min(to), from.max(to)),
    }
}

impl Scene {
    /// Follows the response over the range `from` to `to`. `variants` makes the scene at other values of an entry.
    ///
    /// # Errors
    /// [`SceneError`] when the problem cannot be posed where the curve begins.
    pub fn curve(
        &self,
        along: Along,
        range: (f64, f64),
        variants: Option<&Variants>,
        options: &ContinuationOptions,
    ) -> Result<CurveOutcome, SceneError> {
        self.curve_judged(along, range, variants, options, None)
    }

    /// Likewise; where stability is wanted, `judge` is asked about points whose contacts remember.
    ///
    /// # Errors
    /// [`SceneError`] when the problem cannot be posed where the curve begins.
    pub fn curve_judged(
        &self,
        along: Along,
        range: (f64, f64),
        variants: Option<&Variants>,
        options: &ContinuationOptions,
        judge: Option<&Judge>,
    ) -> Result<CurveOutcome, SceneError> {
        let began = Instant::now();
        let scene = self.clone().with_frequencies(frequencies(along, range));
        let posed = scene.posed(&mut |_| ())?;
        let problem = |value: f64| -> Option<Problem> {
            let (Along::Entry { pointer, .. }, Some(variants)) = (along, variants) else {
                return Some(posed.problem.clone());
            };
            let scene = variants.scene(&[(pointer, value)]).ok()?;
            let scene = scene.with_harmonics(self.harmonics()).ok()?;
            let scene = scene.with_frequencies(frequencies(along, range));
            Some(scene.recovering(self.output.clone()).problem().ok()?.clone())
        };
        let curve = match (along, variants) {
            (Along::Entry { frequency, .. }, Some(_)) => {
                hbm::entry_curve(&problem, frequency, &self.settings, range, options)
            }
            _ => hbm::frequency_curve(&posed.problem, &self.settings, range, options),
        };
        let mut curve = curve.map_err(|error| SceneError::entry(&error.place, error.problem))?;
        let plan = hbm::Plan::new(&posed.problem, &self.settings)
            .map_err(|error| SceneError::entry(&error.place, error.problem))?;
        let mut unknown = Vec::new();
        if self.settings.stability {
            let find = |value: f64, solution: &Solution| {
                let problem = problem(value).ok_or("the scene makes no sense there")?;
                match judge {
                    Some(judge) => judge(&problem, plan.orders(), solution),
                    None => {
                        Err(plan.stability(solution).map_or_else(|why| why.to_string(), |_| String::new()))
                    }
                }
            };
            let points = curve.points.iter_mut().map(|point| (point.parameter, &mut point.solution));
            unknown = stability::judge(points, &find);
        }
        let names = Names::of(self, plan.orders());
        let dofs: Vec<String> = self.output().into_iter().map(str::to_owned).collect();
        let point = |point: &CurvePoint| CurveOutcomePoint {
            parameter: point.parameter,
            arclength: point.arclength,
            fold: point.fold,
            peaks: point.peaks.iter().filter_map(|&dof| dofs.get(dof).cloned()).collect(),
            point: names.point(&point.solution, false),
        };
        let (end, reason) = words(curve.end);
        let (parameter, unit) = match along {
            Along::Frequency => ("frequency".to_owned(), " Hz".to_owned()),
            Along::Entry { pointer, .. } => (pointer.to_owned(), format!(" of {pointer}")),
        };
        let places: Vec<_> = curve.points.iter().map(|point| (point.parameter, &point.solution)).collect();
        let mut notes = self.notes.clone();
        notes.extend(posed.notes());
        notes.extend(notes::extrapolated(self, &places, &unit));
        notes.extend(stability::notes(places.iter().copied(), &unknown, &unit));
        Ok(CurveOutcome {
            format_version: 1,
            scene: self.name.clone(),
            units: "SI, Hz, rad",
            parameter,
            end,
            reason,
            reduction: posed.facts(self.dofs().len()),
            notes,
            points: curve.points.iter().map(point).collect(),
            dofs,
            solve_s: began.elapsed().as_secs_f64(),
        })
    }
}
