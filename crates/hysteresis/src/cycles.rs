//! Steady cycles told from run-up and run-down, their offset and drift.

use std::collections::VecDeque;
use std::ops::Range;

use crate::error::FitError;
use crate::turning_points::TurningPoint;

/// The steady part of a record.
pub(crate) struct Steady {
    /// Its turning points.
    pub points: Vec<TurningPoint>,
    /// Where the record before and after it is left to, by position: the neighbouring turning points.
    pub reach: (f64, f64),
    /// Branches left out before and after it.
    pub skipped: (usize, usize),
    /// Mean upper and lower displacement \[m\] at `centre`.
    upper: f64,
    lower: f64,
    pub centre: f64,
    /// Drift of the displacement \[m per unit of position\].
    pub drift: f64,
}

impl Steady {
    /// The longest run of branches whose heights agree within `tolerance` (relative, ±).
    pub(crate) fn find(points: &[TurningPoint], tolerance: f64) -> Result<Self, FitError> {
        let inside = points.iter().filter(|p| !p.at_edge).count();
        let heights: Vec<f64> = points
            .iter()
            .zip(points.iter().skip(1))
            .map(|(a, b)| (a.displacement - b.displacement).abs())
            .collect();
        let run = longest_run(&heights, tolerance);
        let closed = run.len() >= 2 || (run.len() == 1 && inside == 2);
        if !closed && inside > 2 {
            let shown: Vec<String> = heights.iter().take(12).map(|h| format!("{:.4}", 0.5e6 * h)).collect();
            let more = if heights.len() > 12 { ", …" } else { "" };
            return Err(FitError::NotSteady {
                heights: shown.join(", ") + more,
                tolerance: 100.0 * tolerance,
            });
        }
        let taken = points.get(run.start..=run.end).filter(|_| closed);
        let Some(taken) = taken else {
            let reason = match inside {
                0 => "the displacement never turns back".to_owned(),
                1 => "the displacement turns back only once".to_owned(),
                _ => "one of its branches is not complete".to_owned(),
            };
            return Err(FitError::OpenCurve { reason });
        };
        let position = |p: &TurningPoint| p.position;
        let before = run.start.checked_sub(1).and_then(|i| points.get(i)).map_or(f64::NEG_INFINITY, position);
        let after = points.get(run.end + 1).map_or(f64::INFINITY, position);
        let (upper, lower, centre, drift) = levels(taken);
        Ok(Self {
            points: taken.to_vec(),
            reach: (before, after),
            skipped: (run.start, heights.len() - run.end),
            upper,
            lower,
            centre,
            drift,
        })
    }

    /// Displacement amplitude \[m\]: half the range between the turning points of the averaged cycle.
    pub(crate) fn amplitude(&self) -> f64 {
        0.5 * (self.upper - self.lower)
    }

    /// Mean of upper and lower turning points \[m\].
    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.upper + self.lower)
    }

    /// Displacement \[m\] where a turning point at `position` would be expected.
    pub(crate) fn level(&self, upper: bool, position: f64) -> f64 {
        (if upper { self.upper } else { self.lower }) + self.drift * (position - self.centre)
    }

    /// Number of cycles: pairs of an upper and a lower turning point.
    pub(crate) fn cycles(&self) -> usize {
        self.points.len() / 2
    }

    /// Length of a cycle in units of position, where two turning points of a kind were seen from both
    /// sides: from the pair that lies furthest apart.
    pub(crate) fn period(&self) -> Option<f64> {
        let whole = |upper: bool| {
            let mut seen = self.points.iter().enumerate().filter(|(_, p)| p.upper == upper && !p.at_edge);
            let (first, last) = (seen.next()?, seen.next_back()?);
            let cycles = (last.0 - first.0) / 2;
            Some((cycles, (last.1.position - first.1.position) / cycles as f64))
        };
        let (upper, lower) = (whole(true), whole(false));
        let longer = if lower.map(|l| l.0) > upper.map(|u| u.0) { lower } else { upper };
        longer.map(|(_, period)| period)
    }
}

/// The longest range of `values` in which the largest is within `±tolerance` of the smallest; among equally
/// long ones the one of larger values. One pass with the window's largest and smallest in monotone queues.
fn longest_run(values: &[f64], tolerance: f64) -> Range<usize> {
    let mut best = 0..0;
    let mut best_sum = 0.0;
    let (mut largest, mut smallest) = (VecDeque::new(), VecDeque::new());
    let (mut start, mut sum) = (0, 0.0);
    for (i, &value) in values.iter().enumerate() {
        while largest.back().is_some_and(|&(_, v)| v <= value) {
            largest.pop_back();
        }
        largest.push_back((i, value));
        while smallest.back().is_some_and(|&(_, v)| v >= value) {
            smallest.pop_back();
        }
        smallest.push_back((i, value));
        sum += value;
        while let (Some(&(at_high, high)), Some(&(at_low, low))) = (largest.front(), smallest.front())
            && high - low > tolerance * (high + low)
        {
            sum -= values.get(start).copied().unwrap_or(0.0);
            start += 1;
            if at_high < start {
                largest.pop_front();
            }
            if at_low < start {
                smallest.pop_front();
            }
        }
        let length = i + 1 - start;
        if length > best.len() || (length == best.len() && sum > best_sum) {
            best = start..i + 1;
            best_sum = sum;
        }
    }
    best
}

/// Upper and lower level at their common centre, and the drift that upper and lower points share: least
/// squares.
fn levels(points: &[TurningPoint]) -> (f64, f64, f64, f64) {
    let of_kind = |upper: bool| -> Vec<&TurningPoint> {
        let kind = || points.iter().filter(move |p| p.upper == upper);
        let seen: Vec<_> = kind().filter(|p| !p.at_edge).collect();
        if seen.is_empty() { kind().collect() } else { seen }
    };
    let (uppers, lowers) = (of_kind(true), of_kind(false));
    let mean = |kind: &[&TurningPoint], value: fn(&TurningPoint) -> f64| {
        kind.iter().map(|p| value(p)).sum::<f64>() / kind.len().max(1) as f64
    };
    let position = |p: &TurningPoint| p.position;
    let displacement = |p: &TurningPoint| p.displacement;
    let centre = 0.5 * (mean(&uppers, position) + mean(&lowers, position));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for kind in [&uppers, &lowers] {
        let (at, level) = (mean(kind, position), mean(kind, displacement));
        for p in kind {
            covariance += (p.position - at) * (p.displacement - level);
            variance += (p.position - at).powi(2);
        }
    }
    // With a single point of each kind nothing tells drift.
    let drift = if variance > 0.0 { covariance / variance } else { 0.0 };
    let level = |kind: &[&TurningPoint]| mean(kind, displacement) - drift * (mean(kind, position) - centre);
    (level(&uppers), level(&lowers), centre, drift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(levels: &[f64]) -> Vec<TurningPoint> {
        levels
            .iter()
            .enumerate()
            .map(|(i, &w)| TurningPoint {
                sample: i,
                position: i as f64,
                displacement: w,
                upper: w > 0.0,
                at_edge: false,
                window: i..i + 1,
                curvature: None,
            })
            .collect()
    }

    #[test]
    fn the_longest_run_is_found() {
        assert_eq!(longest_run(&[1.0, 5.0, 5.1, 5.05, 9.0, 9.0], 0.02), 1..4);
        assert_eq!(longest_run(&[1.0, 2.0, 3.0], 0.02), 2..3);
        assert_eq!(longest_run(&[3.0, 3.0, 1.0, 1.0], 0.02), 0..2);
        assert_eq!(longest_run(&[], 0.02), 0..0);
    }

    #[test]
    fn run_up_and_run_down_are_left_out() {
        let all = points(&[0.3, -0.6, 1.0, -1.0, 1.0, -1.0, 1.0, -0.5, 0.2]);
        let steady = Steady::find(&all, 0.03).unwrap();
        assert_eq!((steady.points.len(), steady.cycles(), steady.skipped), (5, 2, (2, 2)));
        assert_eq!(steady.period(), Some(2.0));
        assert_eq!(steady.reach, (1.0, 7.0));
    }

    #[test]
    fn offset_and_drift_are_separated_from_the_amplitude() {
        let all = points(&(0..7).map(|i| [1.0, -1.0][i % 2] + 0.2 + 0.01 * i as f64).collect::<Vec<_>>());
        let steady = Steady::find(&all, 0.03).unwrap();
        assert!((steady.amplitude() - 1.0).abs() < 1e-14);
        assert!((steady.drift - 0.01).abs() < 1e-14);
        assert!((steady.middle() - 0.23).abs() < 1e-14);
        assert!((steady.level(true, 0.0) - 1.2).abs() < 1e-14);
    }

    #[test]
    fn an_amplitude_that_never_settles_is_refused() {
        let growing = points(&[0.1, -0.2, 0.4, -0.8, 1.6]);
        assert!(matches!(Steady::find(&growing, 0.03), Err(FitError::NotSteady { .. })));
        assert!(matches!(Steady::find(&points(&[1.0]), 0.03), Err(FitError::OpenCurve { .. })));
    }
}
