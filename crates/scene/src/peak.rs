//! Resonance peaks over an entry of a scene: a damper's optimum without sweeps.

use std::time::Instant;

use hbm::{OptimumKind, Peak, PeakCurve, PeakEnd, PeakOptions, PeakPoint, PeakStatus};
use serde::Serialize;

use crate::error::SceneError;
use crate::frequencies::Frequencies;
use crate::harmonics::Harmonics;
use crate::notes;
use crate::outcome::{Names, Point};
use crate::scene::Scene;
use crate::variants::Variants;

/// Which peaks, and over what.
#[derive(Clone, Copy)]
pub struct PeaksOptions<'a> {
    /// The entry that varies, a JSON pointer.
    pub pointer: &'a str,
    /// Its smallest and largest value.
    pub range: (f64, f64),
    /// Values are spaced evenly over its logarithm.
    pub logarithmic: bool,
    /// Values at which the whole response is surveyed.
    pub points: usize,
    /// The dof whose amplitude counts; the first that is excited, else the first that is recovered, where none is named.
    pub dof: Option<&'a str>,
    /// Numbers of harmonics, a curve each; none: the scene's.
    pub harmonics: &'a [usize],
    /// Threads to use; `None` is one a core.
    pub threads: Option<usize>,
    /// Called with how many parts of the work are done, of how many, from any thread; `false` stops.
    pub progress: &'a (dyn Fn(usize, usize) -> bool + Sync),
}

/// The parts of a scene on which its response depends without jumps.
const FOLLOWED: [&str; 3] = ["/model/", "/excitation/", "/contacts/"];

impl PeaksOptions<'_> {
    /// Refuses what varies nothing, or what makes no scene: worth asking before the work.
    ///
    /// # Errors
    /// [`SceneError`] at `vary`, with what is wrong.
    pub fn check(&self, variants: &Variants) -> Result<(), SceneError> {
        let Self { pointer, range: (from, to), .. } = *self;
        let place = format!("vary {pointer}");
        variants.number(pointer).map_err(|why| SceneError::entry(&place, why))?;
        if !FOLLOWED.iter().any(|part| pointer.starts_with(part)) {
            let problem =
                "peaks are no curve over it; name an entry of the model, the excitation or a contact";
            return Err(SceneError::entry(&place, problem));
        }
        // NaN is refused as well.
        if from.partial_cmp(&to) != Some(std::cmp::Ordering::Less) {
            return Err(SceneError::entry(&place, format!("its range must grow, got {from} to {to}")));
        }
        if self.logarithmic && from <= 0.0 {
            let problem = format!("a range over its logarithm begins above zero, got {from}");
            return Err(SceneError::entry(&place, problem));
        }
        // What lies between them is tried as well: entries that must be whole numbers have no curve.
        for value in [from, to, from + 0.382 * (to - from)] {
            let scene = variants.scene(&[(pointer, value)]).and_then(|scene| scene.prepare().map(|_| ()));
            scene.map_err(|error| SceneError::entry(&format!("{place} = {value}"), error.to_string()))?;
        }
        Ok(())
    }
}

/// Peaks over an entry as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeaksOutcome {
    /// 1; raised when a reader of older results would be misled.
    pub format_version: u32,
    /// The scene's name.
    pub scene: String,
    /// Units of every number.
    pub units: &'static str,
    /// The JSON pointer of the entry that varies.
    pub parameter: String,
    /// Whether its values are spaced evenly over their logarithm.
    pub logarithmic: bool,
    /// The dof whose amplitude counts.
    pub dof: String,
    /// The harmonic of that amplitude.
    pub harmonic: usize,
    /// Frequencies in Hz between which peaks were looked for.
    pub frequencies: (f64, f64),
    /// What a user should know beyond the numbers.
    pub notes: Vec<String>,
    /// One entry a number of harmonics.
    pub curves: Vec<PeaksCurve>,
    /// Time in s.
    pub solve_s: f64,
}

/// The peaks with one number of harmonics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeaksCurve {
    /// N.
    pub harmonics: usize,
    /// `reached`, or `stopped` before all values had their peaks.
    pub end: &'static str,
    /// Where the highest peak is lowest; null where that is not known.
    pub optimum: Option<PeaksOptimum>,
    /// By growing parameter.
    pub points: Vec<PeaksPoint>,
    /// What it took.
    pub effort: PeaksEffort,
}

/// Where the highest peak is lowest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeaksOptimum {
    /// `minimum` of one peak, `crossing` of two, or the `end` of the range.
    pub kind: &'static str,
    /// The peaks there.
    #[serde(flatten)]
    pub point: PeaksPoint,
}

/// The peaks at one value of the entry.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeaksPoint {
    /// Value of the entry.
    pub parameter: f64,
    /// `surveyed`: the whole response was looked at; `followed`: from surveyed neighbours; `higher at end`: the response is
    /// higher at an end of the frequencies; `incomplete`: a higher place is known than the peaks; `doubtful`: beside such a
    /// value; `failed`: a peak is missing.
    pub status: &'static str,
    /// The place (Hz, m) that is higher than the peaks; null where none is.
    pub higher: Option<(f64, f64)>,
    /// The highest first.
    pub peaks: Vec<PeaksPeak>,
}

/// One peak.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeaksPeak {
    /// Which of the curves over the parameter it belongs to.
    pub branch: usize,
    /// |W| of the dof in m.
    pub amplitude: f64,
    /// Energy in J that all contacts dissipate in a period.
    pub dissipation: f64,
    /// The response there.
    #[serde(flatten)]
    pub point: Point,
}

/// What a curve took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PeaksEffort {
    /// Responses surveyed.
    pub surveys: usize,
    /// Those of them whose curve was given up after as many places as are followed.
    pub cut: usize,
    /// Newton steps in surveys.
    pub survey_steps: usize,
    /// Peaks sought between surveys.
    pub searches: usize,
    /// Newton steps in these.
    pub search_steps: usize,
}

impl PeaksPoint {
    /// Whether the highest peak is known.
    pub fn sound(&self) -> bool {
        !matches!(self.status, "incomplete" | "doubtful" | "failed")
    }

    /// The highest peak, where it is known.
    pub fn highest(&self) -> Option<&PeaksPeak> {
        self.peaks.first().filter(|_| self.sound())
    }
}

impl Scene {
    /// Follows the peaks of this scene over one of its entries; `variants` makes the scene at other values of it.
    ///
    /// # Errors
    /// [`SceneError`] when dof or ranges make no sense, or the problem cannot be posed.
    pub fn peaks(&self, variants: &Variants, options: &PeaksOptions) -> Result<PeaksOutcome, SceneError> {
        let began = Instant::now();
        let dof = options.dof.map_or_else(|| self.usual_reference(), str::to_owned);
        let listed = self.frequencies().as_slice().iter().copied();
        let frequencies = listed.fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f), b.max(f)));
        if !(frequencies.0 > 0.0 && frequencies.1 > frequencies.0) {
            let problem = format!(
                "peaks are looked for over a range of positive frequencies, got {} to {} Hz",
                frequencies.0, frequencies.1
            );
            return Err(SceneError::entry("frequencies", problem));
        }
        let scene = self.clone().with_frequencies(Frequencies::ends(frequencies.0, frequencies.1));
        let scene = scene.with_output(std::slice::from_ref(&dof))?;
        let numbers = match (options.harmonics, self.harmonics()) {
            ([], Harmonics::All(n) | Harmonics::Needed { max: n, .. }) => vec![n],
            (numbers, _) => numbers.to_vec(),
        };
        let mut curves = Vec::new();
        let mut notes = self.notes.clone();
        let mut harmonic = 1;
        for n in numbers {
            let scene = scene.clone().with_harmonics(Harmonics::All(n))?;
            let problem = |value: f64| {
                let variant = variants.scene(&[(options.pointer, value)]).ok()?;
                let variant = variant.with_harmonics(scene.harmonics()).ok()?;
                let variant = variant.with_frequencies(scene.frequencies.clone());
                Some(variant.recovering(scene.output.clone()).problem().ok()?.clone())
            };
            let wanted = PeakOptions {
                range: options.range,
                logarithmic: options.logarithmic,
                surveys: options.points,
                frequencies,
                output: 0,
                threads: options.threads,
                progress: options.progress,
            };
            let failed = |error: hbm::PlanError| SceneError::entry(&error.place, error.problem);
            let found = hbm::follow_peaks(&problem, &scene.settings, &wanted).map_err(failed)?;
            harmonic = found.orders.iter().copied().find(|&k| k > 0).unwrap_or(1);
            let places: Vec<_> = (found.points.iter())
                .filter_map(|point| Some((point.parameter, &point.peaks.first()?.solution)))
                .collect();
            let unit = format!(" of {} (N = {n})", options.pointer);
            notes.extend(notes::extrapolated(&scene, &places, &unit));
            let stopped = found.end == PeakEnd::Stopped;
            curves.push(curve(n, &found, &Names::of(&scene, &found.orders)));
            if stopped {
                break;
            }
        }
        notes.extend(curves.iter().flat_map(remarks));
        Ok(PeaksOutcome {
            format_version: 1,
            scene: self.name.clone(),
            units: "SI, Hz, rad",
            parameter: options.pointer.to_owned(),
            logarithmic: options.logarithmic,
            dof,
            harmonic,
            frequencies,
            notes,
            curves,
            solve_s: began.elapsed().as_secs_f64(),
        })
    }
}

fn curve(harmonics: usize, found: &PeakCurve, names: &Names) -> PeaksCurve {
    let optimum = found.optimum.as_ref().map(|optimum| PeaksOptimum {
        kind: match optimum.kind {
            OptimumKind::Smooth => "minimum",
            OptimumKind::Crossing => "crossing",
            OptimumKind::End => "end",
        },
        point: point(&optimum.point, names),
    });
    PeaksCurve {
        harmonics,
        end: match found.end {
            PeakEnd::Reached => "reached",
            PeakEnd::Stopped => "stopped",
        },
        optimum,
        points: found.points.iter().map(|p| point(p, names)).collect(),
        effort: PeaksEffort {
            surveys: found.effort.surveys,
            cut: found.effort.cut,
            survey_steps: found.effort.survey_steps,
            searches: found.effort.searches,
            search_steps: found.effort.search_steps,
        },
    }
}

fn point(found: &PeakPoint, names: &Names) -> PeaksPoint {
    let (status, higher) = match found.status {
        PeakStatus::Surveyed => ("surveyed", None),
        PeakStatus::Followed => ("followed", None),
        PeakStatus::HigherAtEnd(hertz, height) => ("higher at end", Some((hertz, height))),
        PeakStatus::Incomplete(hertz, height) => ("incomplete", Some((hertz, height))),
        PeakStatus::Doubtful => ("doubtful", None),
        PeakStatus::Failed => ("failed", None),
    };
    let peak = |peak: &Peak| PeaksPeak {
        branch: peak.branch,
        amplitude: peak.amplitude,
        dissipation: peak.solution.contacts.iter().map(|contact| contact.dissipation).sum::<f64>()
            + peak.solution.joints.iter().map(|joint| joint.dissipation).sum::<f64>(),
        point: names.point(&peak.solution, false),
    };
    PeaksPoint { parameter: found.parameter, status, higher, peaks: found.peaks.iter().map(peak).collect() }
}

/// What the points of a curve do not say aloud.
fn remarks(curve: &PeaksCurve) -> Vec<String> {
    let n = curve.harmonics;
    let counted = |status: &str| curve.points.iter().filter(|point| point.status == status).count();
    let mut notes = Vec::new();
    let (incomplete, failed, ends) = (counted("incomplete"), counted("failed"), counted("higher at end"));
    if incomplete > 0 {
        notes.push(format!(
            "N = {n}: at {incomplete} of {} values the response is higher somewhere than every peak that was found, as where \
             contacts are held; these values are marked and count for no optimum",
            curve.points.len()
        ));
    }
    if failed > 0 {
        notes.push(format!(
            "N = {n}: at {failed} of {} values a peak is missing; these values are marked and count for no optimum",
            curve.points.len()
        ));
    }
    if ends > 0 {
        notes.push(format!(
            "N = {n}: at {ends} surveyed values the response is higher at an end of the frequencies than at its peaks"
        ));
    }
    if curve.effort.cut > 0 {
        notes.push(format!(
            "N = {n}: at {} of {} surveyed values the curve was given up after as many places as are followed; peaks beyond were looked \
             for from points solved one by one",
            curve.effort.cut, curve.effort.surveys
        ));
    }
    let optimum = curve.optimum.as_ref();
    if optimum.is_some_and(|optimum| !optimum.point.sound()) {
        notes.push(format!("N = {n}: the optimum is not one: the response there has a higher place"));
    }
    if optimum.is_none() && curve.end == "reached" {
        notes.push(format!("N = {n}: the optimum is not known: peaks are missing beside the lowest"));
    }
    notes
}
