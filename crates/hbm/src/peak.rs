//! Resonance peaks over a parameter: the largest amplitudes of a response followed directly, without sweeps between.
//!
//! At some values of the parameter the whole response is surveyed for its peaks (`peak_survey`). Between them each peak is
//! followed from its neighbours (`peak_branch`): a search along the response curve for the place where the amplitude is
//! stationary (`peak_search`). The optimum is where the highest of them is lowest (`peak_optimum`).

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::error::PlanError;
use crate::peak_branch::{Axis, Family, Node, Value};
use crate::peak_search::{Search, Summit};
use crate::peak_survey::Survey;
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
    /// No peak was found, or one that exists on both sides was not.
    Failed,
}

impl PeakStatus {
    /// Whether the highest peak is known.
    pub fn sound(&self) -> bool {
        !matches!(self, Self::Incomplete(..) | Self::Failed)
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

/// The machinery of one curve.
struct Follower<'a> {
    problem: &'a (dyn Fn(f64) -> Option<Problem> + Sync),
    options: &'a PeakOptions<'a>,
    search: Search<'a>,
    axis: Axis,
    corrections: AtomicUsize,
    searches: AtomicUsize,
    done: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Follower<'a> {
    fn new(
        problem: &'a (dyn Fn(f64) -> Option<Problem> + Sync),
        settings: &'a Settings,
        options: &'a PeakOptions<'a>,
    ) -> Self {
        Self {
            problem,
            options,
            search: Search { settings, range: options.frequencies, dof: options.output },
            axis: if options.logarithmic { Axis::Log } else { Axis::Linear },
            corrections: AtomicUsize::new(0),
            searches: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
        }
    }

    fn family(&self) -> Family<'_> {
        Family {
            problem: self.problem,
            search: self.search,
            axis: self.axis,
            corrections: &self.corrections,
            searches: &self.searches,
        }
    }

    /// Whether nobody asked to stop.
    fn going(&self) -> bool {
        let total = 3 * self.options.surveys;
        if !(self.options.progress)(self.done.load(Ordering::Relaxed).min(total), total) {
            self.stopped.store(true, Ordering::Relaxed);
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    fn finished(&self, parts: usize) {
        self.done.fetch_add(parts, Ordering::Relaxed);
    }

    /// Values of the parameter at which the response is surveyed, and their coordinates.
    fn values(&self) -> Vec<Value> {
        let (from, to) = self.options.range;
        let (low, high) = (self.axis.place(from), self.axis.place(to));
        let last = self.options.surveys - 1;
        let value = |i: usize| match i {
            0 => (low, from),
            i if i == last => (high, to),
            i => {
                let at = low + (high - low) * i as f64 / last as f64;
                (at, self.axis.parameter(at))
            }
        };
        (0..=last).map(value).collect()
    }

    /// The survey at a value: `None` when stopped, an empty one where there is no problem.
    fn survey(&self, parameter: f64) -> Result<Option<Survey>, PlanError> {
        if !self.going() {
            return Ok(None);
        }
        let survey = match (self.problem)(parameter) {
            Some(problem) => self.search.survey(&problem, &|| !self.stopped.load(Ordering::Relaxed)),
            None => Ok(Some(Survey::default())),
        };
        self.finished(1);
        survey
    }

    fn run(&self, orders: Vec<usize>) -> Result<PeakCurve, PlanError> {
        let values = self.values();
        let surveys: Vec<Option<Survey>> =
            values.par_iter().map(|&(_, parameter)| self.survey(parameter)).collect::<Result<_, _>>()?;
        let mut branches = self.branches(&values, &surveys)?;
        let grid = self.fill(&mut branches, &values, &surveys)?;
        let points = self.points(&branches, &grid, &values, &surveys);
        let optimum = if self.going() { self.optimum(&branches, &grid, &points)? } else { None };
        let mut effort = PeakEffort {
            surveys: surveys.iter().flatten().count(),
            survey_steps: surveys.iter().flatten().map(|survey| survey.corrections).sum(),
            searches: self.searches.load(Ordering::Relaxed),
            search_steps: self.corrections.load(Ordering::Relaxed),
        };
        let (optimum, steps) = optimum.map_or((None, None), |(optimum, steps)| (Some(optimum), Some(steps)));
        effort.surveys += usize::from(steps.is_some());
        effort.survey_steps += steps.unwrap_or(0);
        let stopped = self.stopped.load(Ordering::Relaxed);
        let end = if stopped { PeakEnd::Stopped } else { PeakEnd::Reached };
        Ok(PeakCurve { points, optimum, orders, end, effort })
    }

    /// Every peak of the surveys, followed to the surveys beside it.
    fn branches(&self, values: &[Value], surveys: &[Option<Survey>]) -> Result<Vec<Vec<Node>>, PlanError> {
        let family = self.family();
        let node = |&(at, parameter): &(f64, f64), summit: &Summit| Node {
            at,
            parameter,
            summit: Some(summit.clone()),
        };
        let summits = |survey: &Option<Survey>| survey.as_ref().map_or(Vec::new(), |s| s.summits.clone());
        let mut branches: Vec<Vec<Node>> = Vec::new();
        if let (Some(value), Some(survey)) = (values.first(), surveys.first()) {
            branches.extend(summits(survey).iter().map(|summit| vec![node(value, summit)]));
        }
        let mut active: Vec<usize> = (0..branches.len()).collect();
        for (pair, ends) in values.windows(2).zip(surveys.windows(2)) {
            let ([here, next], [before, survey]) = (pair, ends) else { continue };
            let found = summits(survey);
            let mut reached = vec![false; found.len()];
            let highest = highest(survey).min(highest(before));
            let mut arrived = Vec::new();
            for &branch in active.iter().filter(|_| self.going()) {
                let Some(nodes) = branches.get_mut(branch) else { continue };
                let Some(last) = nodes.last().and_then(|node| node.summit.clone()) else { continue };
                let way = family.march(&last, (*here, *next), highest)?;
                nodes.extend(way.into_iter().skip(1));
                let Some(last) = nodes.last_mut().filter(|node| node.at == next.0) else { continue };
                let same = found.iter().position(|known| last.summit.as_ref().is_some_and(|s| s.is(known)));
                match same.and_then(|same| Some((found.get(same)?, reached.get_mut(same)?))) {
                    // Another branch leads here as well: one of the two has jumped, and is not followed further.
                    Some((_, true)) => {}
                    Some((known, reached)) => {
                        last.summit = Some(known.clone());
                        *reached = true;
                        arrived.push(branch);
                    }
                    None => arrived.push(branch),
                }
            }
            for (summit, _) in found.iter().zip(&reached).filter(|(_, reached)| !**reached) {
                let mut nodes = vec![node(next, summit)];
                if self.going() {
                    nodes = family.march(summit, (*next, *here), highest)?;
                    nodes.reverse();
                }
                arrived.push(branches.len());
                branches.push(nodes);
            }
            active = arrived;
            self.finished(1);
        }
        Ok(branches)
    }

    /// Every branch that may be the highest at the values of all others; the values.
    fn fill(
        &self,
        branches: &mut [Vec<Node>],
        values: &[Value],
        surveys: &[Option<Survey>],
    ) -> Result<Vec<Value>, PlanError> {
        let surveyed = values.iter().zip(surveys).filter(|(_, survey)| survey.is_some());
        let mut grid: Vec<Value> = branches.iter().flatten().map(|node| (node.at, node.parameter)).collect();
        grid.extend(surveyed.map(|(value, _)| *value));
        grid.sort_by(|a, b| a.0.total_cmp(&b.0));
        grid.dedup_by(|a, b| a.0 == b.0);
        let family = self.family();
        let missing: Vec<(usize, f64, f64)> = grid
            .iter()
            .filter(|_| self.going())
            .flat_map(|&(at, parameter)| {
                let lacks =
                    |&index: &usize| branches.get(index).is_some_and(|branch| has(branch, at).is_none());
                let relevant = family.relevant(branches, at).into_iter().filter(lacks);
                relevant.map(|index| (index, at, parameter)).collect::<Vec<_>>()
            })
            .collect();
        let add = |&(index, at, parameter): &(usize, f64, f64)| -> Result<(usize, Node), PlanError> {
            let summit = match branches.get(index) {
                Some(branch) => family.on(branch, at)?,
                None => None,
            };
            Ok((index, Node { at, parameter, summit }))
        };
        let added: Vec<(usize, Node)> = missing.par_iter().map(add).collect::<Result<_, _>>()?;
        for (index, node) in added {
            if let Some(branch) = branches.get_mut(index) {
                branch.push(node);
            }
        }
        for branch in branches.iter_mut() {
            branch.sort_by(|a, b| a.at.total_cmp(&b.at));
        }
        self.finished(values.len());
        Ok(grid)
    }

    /// The peaks at every value.
    fn points(
        &self,
        branches: &[Vec<Node>],
        grid: &[Value],
        values: &[Value],
        surveys: &[Option<Survey>],
    ) -> Vec<PeakPoint> {
        let family = self.family();
        let point = |&(at, parameter): &(f64, f64)| {
            // Stopped before every branch had its place here.
            let lacks = |index: &usize| branches.get(*index).is_some_and(|branch| has(branch, at).is_none());
            let mut lost = family.relevant(branches, at).iter().any(lacks);
            let mut peaks = Vec::new();
            for (branch, nodes) in branches.iter().enumerate() {
                match has(nodes, at).map(|node| &node.summit) {
                    Some(Some(summit)) => peaks.push(peak(branch, summit)),
                    Some(None) => lost = true,
                    None => {}
                }
            }
            peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
            let survey = values.iter().position(|value| value.0 == at).and_then(|i| surveys.get(i));
            let status = match survey.and_then(Option::as_ref) {
                Some(survey) => judge(survey, &peaks),
                None if lost || peaks.is_empty() => PeakStatus::Failed,
                None => PeakStatus::Followed,
            };
            PeakPoint { parameter, status, peaks }
        };
        let mut points: Vec<PeakPoint> = grid.iter().map(point).collect();
        if self.stopped.load(Ordering::Relaxed) {
            // What is not finished is not failed.
            points.retain(|point| point.status != PeakStatus::Failed);
        }
        points
    }

    /// The lowest highest peak over the values where it is known, and the Newton steps of its survey.
    fn optimum(
        &self,
        branches: &[Vec<Node>],
        grid: &[Value],
        points: &[PeakPoint],
    ) -> Result<Option<(Optimum, usize)>, PlanError> {
        let family = self.family();
        let height = |i: usize| -> Option<f64> {
            let point = points.get(i).filter(|point| point.status.sound())?;
            Some(point.peaks.first()?.amplitude)
        };
        let lowest = (0..points.len()).filter_map(|i| Some((i, height(i)?)));
        let Some((lowest, _)) = lowest.min_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(None) };
        let beside = |i: Option<usize>| i.filter(|i| height(*i).is_some()).and_then(|i| grid.get(i));
        let around = (beside(lowest.checked_sub(1)), grid.get(lowest), beside(lowest.checked_add(1)));
        let end = lowest == 0 || lowest + 1 == points.len();
        let (parameter, summits, kind) = match around {
            (Some(left), Some(middle), Some(right)) => {
                let Some(found) = family.lowest(branches, [left.0, middle.0, right.0])? else {
                    return Ok(None);
                };
                let kind = if found.is_crossing() { OptimumKind::Crossing } else { OptimumKind::Smooth };
                (self.axis.parameter(found.at), found.summits, kind)
            }
            (_, Some(middle), _) if end => {
                let Some(summits) = family.peaks(branches, middle.0)? else { return Ok(None) };
                (middle.1, summits, OptimumKind::End)
            }
            // Beside it the highest peak is not known, so it may be lower there.
            _ => return Ok(None),
        };
        // A survey of its own says whether it is the highest peak.
        let Some(survey) = self.survey(parameter)? else { return Ok(None) };
        let mut peaks: Vec<Peak> = summits.iter().map(|(branch, summit)| peak(*branch, summit)).collect();
        peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let status = judge(&survey, &peaks);
        let point = PeakPoint { parameter, status, peaks };
        Ok(Some((Optimum { kind, point }, survey.corrections)))
    }
}

/// The highest amplitude of a survey.
fn highest(survey: &Option<Survey>) -> f64 {
    survey.as_ref().and_then(|survey| survey.summits.first()).map_or(0.0, |summit| summit.amplitude)
}

/// The node of a branch at a coordinate.
fn has(branch: &[Node], at: f64) -> Option<&Node> {
    branch.get(branch.binary_search_by(|node| node.at.total_cmp(&at)).ok()?)
}

fn peak(branch: usize, summit: &Summit) -> Peak {
    Peak { branch, amplitude: summit.amplitude, solution: summit.solution.clone() }
}

/// Relative difference from which on a peak of a survey is another one.
const HIGHER: f64 = 1e-6;

/// What a survey says about peaks that were followed.
fn judge(survey: &Survey, peaks: &[Peak]) -> PeakStatus {
    let highest = peaks.first().map_or(0.0, |peak| peak.amplitude);
    let other = survey.summits.first().filter(|s| s.amplitude > highest * (1.0 + HIGHER));
    match (other, survey.higher, survey.edge) {
        (Some(summit), ..) => PeakStatus::Incomplete(summit.hertz(), summit.amplitude),
        (None, Some((hertz, height)), _) => PeakStatus::Incomplete(hertz, height),
        (None, None, Some((hertz, height))) => PeakStatus::HigherAtEnd(hertz, height),
        (None, None, None) if peaks.is_empty() => PeakStatus::Failed,
        (None, None, None) if survey.traced || survey.unsolved == 0 => PeakStatus::Surveyed,
        (None, None, None) => PeakStatus::Followed,
    }
}
