//! Error and run time against the number of harmonics: how many does a scene need?

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use hbm::{Plan, Solution, Status};
use rayon::prelude::*;
use scene::{Prepared, Scene};
use serde::Serialize;

use crate::error::StudyError;
use crate::truth::{NoTruth, Reference, Truth, Truths};

/// How a truncation study runs.
#[derive(Default)]
pub struct TruncationOptions<'a> {
    /// Threads that look for truths; solutions are timed one after the other. `None` is one a core.
    pub threads: Option<usize>,
    /// Raised from outside to stop early; finished frequencies are kept.
    pub cancel: Option<&'a AtomicBool>,
    /// Called with the number of frequencies finished so far.
    pub progress: Option<&'a dyn Fn(usize)>,
}

/// Errors of a scene's solutions for several numbers of harmonics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truncation {
    /// The scene's name.
    pub scene: String,
    /// The dofs whose worst counts.
    pub dofs: Vec<String>,
    /// `orbit` or `harmonics:255`: what the solutions are compared with. A row that differs says so.
    pub reference: String,
    /// The numbers of harmonics that were compared, ascending.
    pub harmonics: Vec<usize>,
    /// Frequency by frequency, harmonics ascending.
    pub rows: Vec<Row>,
    /// One entry a frequency.
    pub rates: Vec<Rate>,
    /// What a user should be told.
    pub notes: Vec<String>,
    /// Stopped before the last frequency.
    #[serde(skip)]
    pub interrupted: bool,
}

/// One frequency with one number of harmonics. Errors are relative, the worst of the output dofs, and `None` where there
/// is no solution or no truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// In Hz.
    pub frequency: f64,
    /// N.
    pub harmonics: usize,
    /// `converged`, `stuck` or `failed`.
    pub status: &'static str,
    /// l2 error of the displacement spectrum over all harmonics.
    pub error: Option<f64>,
    /// Of |W_1|, the lowest excited harmonic.
    pub error_first: Option<f64>,
    /// Of half the peak-to-peak displacement.
    pub error_peak: Option<f64>,
    /// Of the energy that all contacts together dissipate; `None` also where nothing is dissipated.
    pub error_dissipation: Option<f64>,
    /// The solver's own estimate of `error`.
    pub estimate: Option<f64>,
    /// Time to solve this point, s: the median of a few repetitions on one thread.
    pub seconds: f64,
    /// Where this truth differs from the usual one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
}

/// How fast the errors of one frequency fall: error ~ (N + 1)^exponent, fitted to the last numbers of harmonics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rate {
    /// In Hz.
    pub frequency: f64,
    /// Exponent of the l2 error; `None` with fewer than two errors above rounding.
    pub error: Option<f64>,
    /// Exponent of the error of |W_1|.
    pub error_first: Option<f64>,
    /// The balance converges to another solution than the orbit that was found: errors there are no truncation errors.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub other_branch: bool,
}

/// A rate is fitted to that many of the largest N.
const FITTED: usize = 3;

/// Errors below this are rounding and the tolerance of the iteration.
const ROUNDING: f64 = 1e-10;

/// A best harmonic solution that is further than this from the orbit is another motion.
const OTHER_BRANCH: f64 = 0.1;

/// A point is solved that often for its time, unless it takes longer than [`PATIENCE`] altogether.
const REPEATS: usize = 5;
const PATIENCE: Duration = Duration::from_millis(100);

/// Solves `scene` at its frequencies with each of the numbers of harmonics and compares with the truth.
///
/// # Errors
/// [`StudyError`] when the scene cannot be solved as posed or no number of harmonics reaches its excitation.
pub fn truncation(
    scene: &Scene,
    harmonics: &[usize],
    options: &TruncationOptions,
) -> Result<Truncation, StudyError> {
    let highest = highest_excited(scene);
    let all: BTreeSet<usize> = harmonics.iter().copied().collect();
    let (skipped, kept): (Vec<usize>, Vec<usize>) = all.into_iter().partition(|n| *n < highest);
    let Some(&largest) = kept.last() else {
        return Err(StudyError::TooFewHarmonics { highest });
    };
    let mut notes = scene.notes().to_vec();
    if !skipped.is_empty() {
        let list = skipped.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        notes.push(format!("N = {list} skipped: harmonic {highest} is excited"));
    }
    // A structure that is reduced is so once, for the largest N: what differs is the truncation alone.
    let scene = &scene.clone().with_harmonics(largest)?.settled()?;
    let scenes: Vec<Scene> =
        kept.iter().map(|n| scene.clone().with_harmonics(*n)).collect::<Result<_, _>>()?;
    let prepared: Vec<Prepared> = scenes.iter().map(Scene::prepare).collect::<Result<_, _>>()?;
    if let Some(prepared) = prepared.last() {
        notes.extend(prepared.notes().into_iter().skip(scene.notes().len()));
    }
    let truths = Truths::new(scene, largest)?;
    let frequencies = scene.frequencies().as_slice();

    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).build().ok();
    let stopped = || options.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed));
    let mut found: Vec<Frequency> = Vec::with_capacity(frequencies.len());
    for some in frequencies.chunks(CHUNK).take_while(|_| !stopped()) {
        let known: Vec<Result<Truth, NoTruth>> = match &pool {
            Some(pool) => pool.install(|| some.par_iter().map(|hertz| truths.at(*hertz)).collect()),
            None => some.iter().map(|hertz| truths.at(*hertz)).collect(),
        };
        for (&hertz, truth) in some.iter().zip(known) {
            if stopped() {
                break;
            }
            let points = prepared.iter().map(|prepared| timed(prepared.plan(), hertz)).collect();
            found.push(Frequency { hertz, truth, points });
            if let Some(progress) = options.progress {
                progress(found.len());
            }
        }
    }
    let interrupted = found.len() < frequencies.len();
    let reference = usual_reference(&found).unwrap_or(truths.usual()).to_string();
    let rows: Vec<Row> = found.iter().flat_map(|one| one.rows(&kept, &prepared, &reference)).collect();
    notes.extend(remarks(&found, &reference));
    if interrupted {
        let (done, all) = (found.len(), frequencies.len());
        notes.push(format!("stopped after {done} of {all} frequencies; the others are not in the result"));
    }
    Ok(Truncation {
        scene: scene.name().to_owned(),
        dofs: scene.output().into_iter().map(str::to_owned).collect(),
        rates: found.iter().zip(rows.chunks(kept.len())).map(|(one, rows)| one.rate(rows)).collect(),
        rows,
        reference,
        harmonics: kept,
        notes,
        interrupted,
    })
}

/// Frequencies whose truths are looked for together.
const CHUNK: usize = 16;

impl Truncation {
    /// The frequencies at which the largest number of harmonics misses `tolerance`, or has no error to show.
    pub fn misses(&self, tolerance: f64) -> Vec<&Row> {
        let largest = self.harmonics.last().copied().unwrap_or(0);
        let missed = |row: &&Row| row.harmonics == largest && row.error.is_none_or(|error| error > tolerance);
        self.rows.iter().filter(missed).collect()
    }
}

fn highest_excited(scene: &Scene) -> usize {
    scene.excited().max().unwrap_or(0)
}

/// The solution at `hertz` and the median time in s it took, after one that warms up.
fn timed(plan: &Plan, hertz: f64) -> (Solution, f64) {
    let mut workspace = plan.workspace();
    let mut solution = Solution::default();
    plan.solve_into(hertz, &mut workspace, &mut solution);
    let mut times: Vec<f64> = Vec::with_capacity(REPEATS);
    let began = Instant::now();
    while times.len() < REPEATS && (times.is_empty() || began.elapsed() < PATIENCE) {
        let start = Instant::now();
        plan.solve_into(hertz, &mut workspace, &mut solution);
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2).copied().unwrap_or_default();
    (solution, median)
}

/// Everything at one frequency.
struct Frequency {
    hertz: f64,
    truth: Result<Truth, NoTruth>,
    /// Solution and time in s, one a number of harmonics.
    points: Vec<(Solution, f64)>,
}

impl Frequency {
    fn reference(&self) -> Option<Reference> {
        self.truth.as_ref().ok().map(|truth| truth.reference)
    }

    fn other_branch(&self) -> bool {
        self.truth.as_ref().is_ok_and(|truth| truth.distance.is_some_and(|distance| distance > OTHER_BRANCH))
    }

    fn rows(&self, harmonics: &[usize], prepared: &[Prepared], usual: &str) -> Vec<Row> {
        let own = self.reference().map(|reference| reference.to_string()).filter(|own| own != usual);
        let points = harmonics.iter().zip(prepared).zip(&self.points);
        let row = |((n, prepared), (solution, seconds)): ((&usize, &Prepared), &(Solution, f64))| {
            let truth = self.truth.as_ref().ok();
            let errors = truth.and_then(|truth| truth.errors(prepared.plan().orders(), solution));
            Row {
                frequency: self.hertz,
                harmonics: *n,
                status: match solution.status {
                    Status::Converged => "converged",
                    Status::Stuck => "stuck",
                    Status::Failed(_) => "failed",
                },
                error: errors.map(|errors| errors.spectrum),
                error_first: errors.map(|errors| errors.first),
                error_peak: errors.map(|errors| errors.peak),
                error_dissipation: errors.and_then(|errors| errors.dissipation),
                estimate: solution.truncation_error,
                seconds: *seconds,
                reference: own.clone(),
            }
        };
        points.map(row).collect()
    }

    fn rate(&self, rows: &[Row]) -> Rate {
        Rate {
            frequency: self.hertz,
            error: exponent(rows, |row| row.error),
            error_first: exponent(rows, |row| row.error_first),
            other_branch: self.other_branch(),
        }
    }
}

/// Exponent p of error ~ (N + 1)^p by least squares over the logarithms of the last errors above rounding.
fn exponent(rows: &[Row], error: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    let large = rows.iter().rev().filter_map(|row| Some((row.harmonics, error(row)?)));
    let points: Vec<(f64, f64)> = large
        .filter(|(_, error)| *error > ROUNDING)
        .take(FITTED)
        .map(|(n, error)| ((n as f64 + 1.0).ln(), error.ln()))
        .collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let (above, below) = points.iter().fold((0.0, 0.0), |(above, below), point| {
        (above + (point.0 - x) * (point.1 - y), below + (point.0 - x).powi(2))
    });
    (points.len() >= 2).then_some(above / below)
}

/// The orbit where there is any, else the harmonics.
fn usual_reference(found: &[Frequency]) -> Option<Reference> {
    let mut known = found.iter().filter_map(Frequency::reference);
    let first = known.next()?;
    Some(if first == Reference::Orbit {
        first
    } else {
        known.find(|r| *r == Reference::Orbit).unwrap_or(first)
    })
}

/// What the numbers do not say.
fn remarks(found: &[Frequency], usual: &str) -> Vec<String> {
    let mut notes = Vec::new();
    let list = |chosen: &[&Frequency]| {
        let some = chosen.iter().take(4).map(|one| one.hertz.to_string()).collect::<Vec<_>>().join(", ");
        let more = if chosen.len() > 4 { format!(" and {} more", chosen.len() - 4) } else { String::new() };
        format!("{some} Hz{more}")
    };
    let unknown: Vec<&Frequency> = found.iter().filter(|one| one.truth.is_err()).collect();
    if let Some(why) = unknown.first().and_then(|one| one.truth.as_ref().err()) {
        notes.push(format!("no reference, and so no errors, at {}: {}", list(&unknown), why.why));
    }
    let fallen: Vec<&Frequency> =
        found.iter().filter(|one| one.truth.as_ref().is_ok_and(|truth| truth.no_orbit.is_some())).collect();
    let why = fallen.first().and_then(|one| one.truth.as_ref().ok()?.no_orbit.clone());
    if let Some(why) = why {
        let instead = fallen.first().and_then(|one| one.reference());
        let instead = instead.map(|reference| reference.to_string()).unwrap_or_default();
        let other = if instead == usual { "" } else { "; those rows say so" };
        notes.push(format!(
            "no orbit was found at {} ({why}); compared with {instead} there{other}",
            list(&fallen)
        ));
    }
    let strangers: Vec<&Frequency> = found.iter().filter(|one| one.other_branch()).collect();
    if !strangers.is_empty() {
        notes.push(format!(
            "at {} the orbit that was found is another solution than the one the balance converges to: the errors there \
             are the distance between two solutions",
            list(&strangers)
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn row(harmonics: usize, error: Option<f64>) -> Row {
        Row {
            frequency: 1.0,
            harmonics,
            status: "converged",
            error,
            error_first: None,
            error_peak: None,
            error_dissipation: None,
            estimate: None,
            seconds: 0.0,
            reference: None,
        }
    }

    #[test]
    fn exponents_are_those_of_the_last_errors() {
        let error = |n: usize| Some(3.0 * (n as f64 + 1.0).powf(-3.5));
        let mut rows =
            vec![row(1, Some(5.0)), row(3, None), row(7, error(7)), row(15, error(15)), row(31, error(31))];
        let rate = |rows: &[Row]| exponent(rows, |row| row.error);
        assert!((rate(&rows).unwrap() + 3.5).abs() < 1e-12);
        rows.push(row(4000, Some(1e-14)));
        assert!((rate(&rows).unwrap() + 3.5).abs() < 1e-12);
        assert_eq!(rate(rows.get(..2).unwrap()), None);
    }

    const SCENE: &str = r#"{
        "name": "blade",
        "model": {"dofs": ["w1", "w2"], "mass": [[3.98, 0], [0, 1.27]], "damping": [[24, 0], [0, 24]],
                  "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]},
        "excitation": [{"dof": "w2", "amplitude": 9.1, "harmonic": HARMONIC}],
        "contacts": [{"name": "root", "between": ["w1", "ground"],
                      "law": {"type": "scaled_loop", "loop": {"displacement": 8e-6, "harmonics": [[1, 0.32, 11.99], [3, 2.83, 2.55]]}}}],
        "frequencies": [60.0, 75.0]}"#;

    fn scene(harmonic: &str) -> Scene {
        Scene::from_str(&SCENE.replace("HARMONIC", harmonic), Path::new("")).unwrap()
    }

    #[test]
    fn errors_fall_and_the_tolerance_is_met_by_the_largest() {
        let seen = std::cell::Cell::new(0);
        let progress = |count: usize| seen.set(count);
        let options = TruncationOptions { progress: Some(&progress), ..TruncationOptions::default() };
        let study = truncation(&scene("1"), &[7, 1, 3, 7], &options).unwrap();
        assert_eq!((study.harmonics.as_slice(), seen.get(), study.rows.len()), ([1, 3, 7].as_slice(), 2, 6));
        assert_eq!(study.reference, "harmonics:127");
        for (rows, rate) in study.rows.chunks(3).zip(&study.rates) {
            let errors: Vec<f64> = rows.iter().map(|row| row.error.unwrap()).collect();
            assert!(errors.windows(2).all(|pair| pair[0] > pair[1]), "{errors:?}");
            assert!(rate.error.unwrap() < -1.0 && rate.frequency == rows[0].frequency);
            assert!(rows.iter().all(|row| row.seconds > 0.0 && row.status == "converged"));
        }
        assert_eq!(study.misses(1.0).len(), 0);
        assert_eq!(study.misses(1e-12).len(), 2);
    }

    #[test]
    fn harmonics_below_the_excitation_are_skipped() {
        let study = truncation(&scene("3"), &[1, 3, 9], &TruncationOptions::default()).unwrap();
        assert_eq!(study.harmonics, [3, 9]);
        assert!(
            study.notes.iter().any(|note| note == "N = 1 skipped: harmonic 3 is excited"),
            "{:?}",
            study.notes
        );
        let error = truncation(&scene("3"), &[1, 2], &TruncationOptions::default()).unwrap_err();
        assert!(error.to_string().contains("excited harmonic 3"));
    }

    #[test]
    fn a_raised_flag_stops_it() {
        let cancel = AtomicBool::new(true);
        let options = TruncationOptions { cancel: Some(&cancel), ..TruncationOptions::default() };
        let study = truncation(&scene("1"), &[1], &options).unwrap();
        assert!(study.interrupted && study.rows.is_empty());
        assert!(study.notes.iter().any(|note| note.starts_with("stopped after 0 of ")), "{:?}", study.notes);
    }
}
