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

/// A value of the parameter: its coordinate and the value itself.
pub(crate) type Value = (f64, f64);

/// The peak at one value of the parameter; `None` where it was not found although there is one on both sides.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Coordinate of the parameter.
    pub(crate) at: f64,
    pub(crate) parameter: f64,
    pub(crate) summit: Option<Summit>,
}

/// Straight lines between neighbours are off by about this much, relative to the highest peak.
const RESOLUTION: f64 = 2e-3;

/// By how much an extrapolated amplitude may be off: eight times what a straight line between neighbours is off by; and
/// without two neighbours to extrapolate from.
const OFF: f64 = 8.0 * RESOLUTION;
const OFF_ALONE: f64 = 0.05;

/// From one value to the next a peak is where it was expected to this part of its own amplitude and frequency, or it is
/// another one.
const JUMP: f64 = 0.1;
const JUMP_FREQUENCY: f64 = 0.01;

/// A peak below this part of the highest is not it, nor will it be at the next value.
pub(crate) const RELEVANT: f64 = 0.7;

/// A summit between two neighbours is no farther from the line between them (logarithm of the amplitude).
const BETWEEN: f64 = 0.05;

/// The way between two surveys in its shortest steps; where one is too long a peak has vanished. A low one is given up at
/// longer ones.
const STEPS: u32 = 1 << 16;
const SHORTEST_LOW: u32 = STEPS >> 5;

/// Summits sought on the way between two surveys at most. A hundred are usual.
const MOST_SEARCHES: usize = 600;

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

    /// Follows a summit from one value to another, ends included; it stops before the other where the summit
    /// vanishes; where that takes too long, the last node has none. About so high are the highest peaks: `highest`.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn march(
        &self,
        from: &Summit,
        (start, end): (Value, Value),
        highest: f64,
    ) -> Result<Vec<Node>, PlanError> {
        // Positions are whole numbers of the shortest step, counted from the smaller end, so that all peaks share them.
        let forward = end.0 > start.0;
        let (low, high) = if forward { (start, end) } else { (end, start) };
        let value = |done: u32| -> Value {
            match if forward { done } else { STEPS - done } {
                0 => low,
                STEPS => high,
                position => {
                    let at = low.0 + (high.0 - low.0) * f64::from(position) / f64::from(STEPS);
                    (at, self.axis.parameter(at))
                }
            }
        };
        let (at, parameter) = value(0);
        let mut nodes = vec![(at, parameter, from.clone())];
        let (mut done, mut step) = (0, STEPS / 2);
        let (mut sought, mut given_up) = (0, None);
        while let Some((at, _, here)) = nodes.last() {
            let shortest = if here.amplitude < RELEVANT * highest { SHORTEST_LOW } else { 1 };
            if done >= STEPS || step < shortest {
                break;
            }
            let (at_next, parameter) = value(done + step);
            sought += 1;
            if sought > MOST_SEARCHES {
                given_up = Some(Node { at: at_next, parameter, summit: None });
                break;
            }
            let before = nodes.len().checked_sub(2).and_then(|i| nodes.get(i));
            let before =
                before.map(|(at_before, _, before)| (before, (at_next - at_before) / (at - at_before)));
            let guess = match before {
                Some((before, part)) => here.pose.between(&before.pose, 1.0 - part),
                None => here.pose.clone(),
            };
            let Some(found) = self.near(&guess, parameter)? else {
                step /= 4;
                continue;
            };
            let expected = before.map_or(here.amplitude, |(before, part)| {
                before.amplitude * (here.amplitude / before.amplitude).powf(part)
            });
            let jump = (found.amplitude / expected).ln().abs() / JUMP;
            let moved = (found.hertz() / guess.hertz - 1.0).abs() / JUMP_FREQUENCY;
            let most = if before.is_some() { OFF } else { OFF_ALONE };
            let off = (found.amplitude - expected).abs() / found.amplitude.max(highest) / most;
            // The largest of what may be at most one.
            let worst = jump.max(moved).max(off);
            if worst.is_nan() || worst > 1.0 {
                step /= 2;
                continue;
            }
            done += step;
            // Twice as long a step errs four times as much.
            if worst < 0.2 && step < STEPS / 2 && done % (2 * step) == 0 {
                step *= 2;
            }
            nodes.push((at_next, parameter, found));
        }
        let nodes = nodes.into_iter().map(|(at, parameter, s)| Node { at, parameter, summit: Some(s) });
        Ok(nodes.chain(given_up).collect())
    }

    /// The amplitude of a branch at coordinate `at` by a straight line between the nodes beside it; `None` where it does not
    /// reach.
    pub(crate) fn expected(&self, branch: &[Node], at: f64) -> Option<f64> {
        let after = branch.partition_point(|node| node.at < at);
        let height = |node: &Node| node.summit.as_ref().map(|summit| summit.amplitude);
        let right = branch.get(after)?;
        if right.at == at {
            return height(right);
        }
        let left = branch.get(after.checked_sub(1)?)?;
        let part = (at - left.at) / (right.at - left.at);
        let (low, high) = (height(left)?, height(right)?);
        Some(low * (high / low).powf(part))
    }

    /// The summit of a branch at coordinate `at`, from the nodes beside it; `None` where it was not found.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn on(&self, branch: &[Node], at: f64) -> Result<Option<Summit>, PlanError> {
        let after = branch.partition_point(|node| node.at < at);
        if let Some(node) = branch.get(after).filter(|node| node.at == at) {
            return Ok(node.summit.clone());
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
        let expected = left.amplitude * (right.amplitude / left.amplitude).powf(part);
        let found = self.near(&guess, self.axis.parameter(at))?;
        Ok(found.filter(|found| (found.amplitude / expected).ln().abs() <= BETWEEN))
    }

    /// Which branches are the highest at coordinate `at`, or nearly so.
    pub(crate) fn relevant(&self, branches: &[Vec<Node>], at: f64) -> Vec<usize> {
        let expected = |index: usize| self.expected(branches.get(index)?, at);
        let heights: Vec<Option<f64>> = (0..branches.len()).map(expected).collect();
        let highest = heights.iter().flatten().copied().fold(0.0, f64::max);
        let relevant = |height: &Option<f64>| height.is_some_and(|height| height >= RELEVANT * highest);
        heights.iter().enumerate().filter(|(_, height)| relevant(height)).map(|(index, _)| index).collect()
    }
}
