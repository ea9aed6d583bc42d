//! Resonance peaks over a parameter: the largest amplitudes of a response followed directly, without sweeps between.
//!
//! At some values of the parameter the whole response is surveyed for its peaks (`peak_survey`). Between them each peak is
//! followed from its neighbours (`peak_follow`, `peak_branch`): a search along the response curve for the place where the amplitude is
//! stationary (`peak_search`). The optimum is where the highest of them is lowest (`peak_optimum`).

use crate::error::PlanError;
use crate::peak_follow::Follower;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::solution::Solution;

/// How peaks are followed.
#[derive(Clone, Copy)]
pub struct PeakOptions<'a> {
    /// Smallest and largest value of the parameter.
    pub range: (f64, f64),
    /// Values are spaced evenly over the logarithm of the parameter, which is positive then.
    pub logarithmic: bool,
    /// Values at which the whole response is surveyed, at least two.
    pub surveys: usize,
    /// Frequencies in Hz between which peaks are looked for.
    pub frequencies: (f64, f64),
    /// The output dof whose amplitude at the base frequency counts.
    pub output: usize,
    /// Threads to use; `None` is one a core. The result does not depend on it.
    pub threads: Option<usize>,
    /// Called with how many parts of the work are done, of how many, from any thread; `false` stops.
    pub progress: &'a (dyn Fn(usize, usize) -> bool + Sync),
}

/// What is known about a value of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PeakStatus {
    /// The whole response was surveyed: no point of it is higher than its peaks.
    Surveyed,
    /// The peaks were followed from surveyed neighbours.
    Followed,
    /// No peak inside the range is as high as the response at this end of it (Hz, m); there may be none.
    HigherAtEnd(f64, f64),
    /// The response at this frequency in Hz is higher (m) than every peak that was found.
    Incomplete(f64, f64),
    /// Followed, but a survey beside it is incomplete or failed: a higher peak may be missing here too.
    Doubtful,
    /// No peak was found, or one that exists on both sides was not.
    Failed,
}

impl PeakStatus {
    /// Whether the highest peak is known.
    pub fn sound(&self) -> bool {
        !matches!(self, Self::Incomplete(..) | Self::Doubtful | Self::Failed)
    }
}

/// A peak of the response.
#[derive(Debug, Clone, PartialEq)]
pub struct Peak {
    /// Which of the curves over the parameter it belongs to.
    pub branch: usize,
    /// |W| of the dof at the base frequency in m.
    pub amplitude: f64,
    /// The response there.
    pub solution: Solution,
}

/// The peaks at one value of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakPoint {
    /// Value of the parameter.
    pub parameter: f64,
    /// What is known about it.
    pub status: PeakStatus,
    /// The highest first; of those far below it only some.
    pub peaks: Vec<Peak>,
}

/// What makes the highest peak lowest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptimumKind {
    /// A smooth minimum of one peak.
    Smooth,
    /// Two peaks are equally high, one rising and one falling.
    Crossing,
    /// An end of the range of the parameter.
    End,
}

/// Where the highest peak is lowest.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// What makes it lowest.
    pub kind: OptimumKind,
    /// The peaks there; surveyed.
    pub point: PeakPoint,
}

/// How following peaks ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PeakEnd {
    /// The whole range.
    Reached,
    /// Stopped from outside.
    Stopped,
}

/// What it took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PeakEffort {
    /// Responses surveyed.
    pub surveys: usize,
    /// Those of them whose curve has more places than are followed: it was given up there, and points solved one by one had to do.
    pub cut: usize,
    /// Newton steps in surveys.
    pub survey_steps: usize,
    /// Peaks sought between surveys.
    pub searches: usize,
    /// Newton steps in these.
    pub search_steps: usize,
}

/// Peaks over a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakCurve {
    /// By growing parameter.
    pub points: Vec<PeakPoint>,
    /// Where the highest peak is lowest; `None` where that is not known.
    pub optimum: Option<Optimum>,
    /// Harmonics of the solutions, as [`Plan::orders`].
    pub orders: Vec<usize>,
    /// How it ended.
    pub end: PeakEnd,
    /// What it took.
    pub effort: PeakEffort,
}

/// Follows the peaks of the response of `problem(λ)` over λ; `problem` answers `None` where λ makes no sense. All points
/// have N harmonics, solved by Newton's method throughout.
///
/// # Errors
/// Ranges that are none, a dof that is no output, and as [`Plan::new`].
pub fn follow_peaks(
    problem: &(dyn Fn(f64) -> Option<Problem> + Sync),
    settings: &Settings,
    options: &PeakOptions,
) -> Result<PeakCurve, PlanError> {
    let orders = check(problem, settings, options)?;
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = options.threads.unwrap_or(cores).max(1);
    let follow = || Follower::new(problem, settings, options).run(orders);
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(follow),
        // No threads to be had beside this one.
        Err(_) => follow(),
    }
}

/// Refuses what makes no sense; the harmonics of the solutions.
fn check(
    problem: &(dyn Fn(f64) -> Option<Problem> + Sync),
    settings: &Settings,
    options: &PeakOptions,
) -> Result<Vec<usize>, PlanError> {
    let error = |place: &str, problem: String| Err(PlanError { place: place.into(), problem });
    let (from, to) = options.range;
    let least = if options.logarithmic { 0.0 } else { f64::NEG_INFINITY };
    if !(from.is_finite() && to.is_finite() && from > least && to > from) {
        let positive = if options.logarithmic { " positive" } else { "" };
        return error("range", format!("must be two growing{positive} numbers, got {from} and {to}"));
    }
    let (low, high) = options.frequencies;
    if !(low > 0.0 && high > low && high.is_finite()) {
        return error("frequencies", format!("peaks need a range of frequencies, got {low} to {high} Hz"));
    }
    if options.surveys < 2 {
        return error("surveys", format!("must be at least 2, got {}", options.surveys));
    }
    let Some(first) = problem(from) else {
        return error("range", format!("there is no problem at {from}"));
    };
    if options.output >= first.output.len() {
        return error("output", format!("there are {} output dofs", first.output.len()));
    }
    let plan = Plan::new(&first, &crate::course::whole(settings))?;
    if plan.first_slot().is_none() {
        return error("excitation", "nothing oscillates, so there is no peak".into());
    }
    Ok(plan.orders().to_vec())
}
