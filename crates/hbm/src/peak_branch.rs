//! One peak over the parameter: summits in steps that resolve the curve, each found from its neighbours.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::PlanError;
use crate::peak_search::{Pose, Search, Summit};
use crate::problem::Problem;

/// How values of the parameter are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    Linear,
    Log,
}

impl Axis {
    /// The coordinate of a parameter in which steps are even.
    pub(crate) fn place(self, parameter: f64) -> f64 {
        match self {
            Self::Linear => parameter,
            Self::Log => parameter.ln(),
        }
    }

    /// The parameter at a coordinate.
    pub(crate) fn parameter(self, at: f64) -> f64 {
        match self {
            Self::Linear => at,
            Self::Log => at.exp(),
        }
    }
}

/// The peak at one value of the parameter; `None` where it was not found although there is one on both sides.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Coordinate of the parameter.
    pub(crate) at: f64,
    pub(crate) parameter: f64,
    pub(crate) summit: Option<Summit>,
}

/// Straight lines between neighbours are off by about this much, relative to the amplitude.
const RESOLUTION: f64 = 2e-3;

/// By how much an extrapolated amplitude may be off: eight times what a straight line between neighbours is off by.
const OFF: f64 = 8.0 * RESOLUTION;

/// The same without two neighbours to extrapolate from, and for frequencies, to which peaks are less sensitive.
const OFF_ALONE: f64 = 0.05;
const OFF_FREQUENCY: f64 = 0.01;

/// A summit between two neighbours is no farther from the line between them (logarithm of the amplitude).
const BETWEEN: f64 = 0.05;

/// The shortest step, as a part of the way; there a peak has vanished.
const SHORTEST: f64 = 1e-5;

/// The problem over the parameter.
pub(crate) struct Family<'a> {
    pub(crate) problem: &'a (dyn Fn(f64) -> Option<Problem> + Sync),
    pub(crate) search: Search<'a>,
    pub(crate) axis: Axis,
    /// Newton steps.
    pub(crate) corrections: &'a AtomicUsize,
    /// Summits sought near a guess.
    pub(crate) searches: &'a AtomicUsize,
}

impl Family<'_> {
    /// The summit near a guess at a value of the parameter.
    pub(crate) fn near(&self, guess: &Pose, parameter: f64) -> Result<Option<Summit>, PlanError> {
        let Some(problem) = (self.problem)(parameter) else { return Ok(None) };
        let (summit, corrections) = self.search.near(guess, &problem)?;
        self.corrections.fetch_add(corrections, Ordering::Relaxed);
        self.searches.fetch_add(1, Ordering::Relaxed);
        Ok(summit)
    }

    /// Follows a summit from one parameter to another, ends included; it stops before the other where the summit
    /// vanishes.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn march(&self, from: &Summit, start: f64, end: f64) -> Result<Vec<Node>, PlanError> {
        let (first, last) = (self.axis.place(start), self.axis.place(end));
        let way = last - first;
        let mut nodes = vec![(first, start, from.clone())];
        let mut step = 0.5;
        while let Some((at, _, here)) = nodes.last() {
            let done = (at - first) / way;
            if done >= 1.0 || step < SHORTEST {
                break;
            }
            let ends = done + step > 1.0 - 0.1 * step;
            let (at_next, parameter) = match ends {
                true => (last, end),
                false => {
                    let next = first + (done + step) * way;
                    (next, self.axis.parameter(next))
                }
            };
            let before = nodes.len().checked_sub(2).and_then(|i| nodes.get(i));
            let before =
                before.map(|(at_before, _, before)| (before, (at_next - at_before) / (at - at_before)));
            let guess = match before {
                Some((before, part)) => here.pose.between(&before.pose, 1.0 - part),
                None => here.pose.clone(),
            };
            let found = self.near(&guess, parameter)?;
            let Some(found) = found else {
                step *= 0.4;
                continue;
            };
            let expected = before.map_or(here.amplitude.ln(), |(before, part)| {
                before.amplitude.ln() + part * (here.amplitude.ln() - before.amplitude.ln())
            });
            let off = (found.amplitude.ln() - expected).abs();
            let moved = (found.hertz() / guess.hertz - 1.0).abs();
            let most = if before.is_some() { OFF } else { OFF_ALONE };
            if off > most || moved > OFF_FREQUENCY {
                step *= 0.5;
                continue;
            }
            if 4.0 * off < most && 2.0 * moved < OFF_FREQUENCY {
                step = (1.7 * step).min(0.5);
            }
            nodes.push((at_next, parameter, found));
        }
        Ok(nodes.into_iter().map(|(at, parameter, s)| Node { at, parameter, summit: Some(s) }).collect())
    }

    /// The summit of a branch at coordinate `at`, from the nodes beside it; `None` where the branch does not reach, and
    /// `Some(None)` where it was not found.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn on(&self, branch: &[Node], at: f64) -> Result<Option<Option<Summit>>, PlanError> {
        let after = branch.partition_point(|node| node.at < at);
        if let Some(node) = branch.get(after).filter(|node| node.at == at) {
            return Ok(Some(node.summit.clone()));
        }
        let beside = |node: Option<&Node>| node.and_then(|node| Some((node.at, node.summit.clone()?)));
        let left = beside(after.checked_sub(1).and_then(|i| branch.get(i)));
        let (Some((low, left)), Some((high, right))) = (left, beside(branch.get(after))) else {
            return Ok(None);
        };
        let part = (at - low) / (high - low);
        let guess = match part <= 0.5 {
            true => left.pose.between(&right.pose, part),
            false => right.pose.between(&left.pose, 1.0 - part),
        };
        let expected = left.amplitude.ln() + part * (right.amplitude.ln() - left.amplitude.ln());
        let found = self.near(&guess, self.axis.parameter(at))?;
        Ok(Some(found.filter(|found| (found.amplitude.ln() - expected).abs() <= BETWEEN)))
    }
}
