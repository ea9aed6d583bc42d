//! Peaks over a parameter, put together: surveys, the peaks between them, and the lowest.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::error::PlanError;
use crate::peak::{
    Optimum, OptimumKind, Peak, PeakCurve, PeakEffort, PeakEnd, PeakOptions, PeakPoint, PeakStatus,
};
use crate::peak_branch::{Axis, Family, Node, Value};
use crate::peak_search::{Search, Summit};
use crate::peak_survey::Survey;
use crate::problem::Problem;
use crate::settings::Settings;

/// The machinery of one curve.
pub(crate) struct Follower<'a> {
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
    pub(crate) fn new(
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

    pub(crate) fn run(&self, orders: Vec<usize>) -> Result<PeakCurve, PlanError> {
        let values = self.values();
        let surveys: Vec<Option<Survey>> =
            values.par_iter().map(|&(_, parameter)| self.survey(parameter)).collect::<Result<_, _>>()?;
        let mut branches = self.branches(&values, &surveys)?;
        let grid = self.fill(&mut branches, &values, &surveys)?;
        let points = self.points(&branches, &grid, &values, &surveys);
        let optimum = if self.going() { self.optimum(&branches, &grid, &points)? } else { None };
        let mut effort = PeakEffort {
            surveys: surveys.iter().flatten().count(),
            cut: surveys.iter().flatten().filter(|survey| survey.cut).count(),
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
        doubt(&mut points, &|point| values.iter().any(|value| value.1 == point.parameter));
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

/// Marks followed points beside a survey whose highest peak is not known.
fn doubt(points: &mut [PeakPoint], surveyed: &dyn Fn(&PeakPoint) -> bool) {
    for forward in [true, false] {
        let mut sound = true;
        let mut mark = |point: &mut PeakPoint| {
            if surveyed(point) {
                sound = point.status.sound();
            } else if !sound && point.status == PeakStatus::Followed {
                point.status = PeakStatus::Doubtful;
            }
        };
        match forward {
            true => points.iter_mut().for_each(&mut mark),
            false => points.iter_mut().rev().for_each(&mut mark),
        }
    }
}

/// What a survey says about peaks that were followed.
fn judge(survey: &Survey, peaks: &[Peak]) -> PeakStatus {
    let highest = peaks.first().map_or(0.0, |peak| peak.amplitude);
    let other = survey.summits.first().filter(|s| s.amplitude > highest * (1.0 + s.noise));
    // A peak that was followed here from elsewhere may be higher than what the survey found.
    let above = |point: &(f64, f64)| point.1 > highest;
    match (other, survey.higher.filter(above), survey.edge.filter(above)) {
        (Some(summit), ..) => PeakStatus::Incomplete(summit.hertz(), summit.amplitude),
        (None, Some((hertz, height)), _) => PeakStatus::Incomplete(hertz, height),
        (None, None, Some((hertz, height))) => PeakStatus::HigherAtEnd(hertz, height),
        (None, None, None) if peaks.is_empty() => PeakStatus::Failed,
        (None, None, None) if survey.traced || survey.unsolved == 0 => PeakStatus::Surveyed,
        (None, None, None) => PeakStatus::Followed,
    }
}
