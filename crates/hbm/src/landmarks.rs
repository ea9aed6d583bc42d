//! Folds and peaks between two places of a curve.

use faer::c64;

use crate::tracer::{Metric, Place, Tracer};

/// A peak is found to this part of the steps beside it; its height then to the square.
const PEAK: f64 = 1e-3;

/// A tangent across the parameter to this part counts as the fold itself.
const FOLD: f64 = 1e-7;

impl Tracer<'_> {
    /// The fold between two places, by the sign of t_λ over the length of the step; and its distance from the first.
    pub(crate) fn fold(&mut self, before: &Place, after: &Place) -> Option<(Place, f64)> {
        let metric = Metric::at(before, self.least);
        let along = |place: &Place| place.tangent.last().copied().unwrap_or(0.0);
        let apart: Vec<f64> = (after.unknowns.iter().zip(&before.unknowns))
            .map(|(a, b)| a - b)
            .chain([after.parameter - before.parameter])
            .collect();
        let (mut low, mut high) = (0.0, metric.product(&before.tangent, &apart));
        let (mut at_low, mut at_high) = (along(before), along(after));
        let mut best = None;
        for round in 0..40 {
            // Illinois would do; halving now and then keeps it honest at kinks.
            let part = if round % 3 == 2 { 0.5 } else { (at_low / (at_low - at_high)).clamp(0.02, 0.98) };
            let middle = low + part * (high - low);
            let (place, _) = self.advance(before, &metric, middle)?;
            let slope = along(&place);
            let done = slope.abs() <= FOLD || high - low <= 1e-12;
            if slope * along(before) > 0.0 {
                (low, at_low) = (middle, slope);
            } else {
                (high, at_high) = (middle, slope);
            }
            best = Some((place, middle));
            if done {
                break;
            }
        }
        best
    }

    /// Amplitudes of the output dofs at the base frequency, at a place.
    pub(crate) fn amplitudes(&mut self, place: &Place) -> Vec<f64> {
        let slot = self.course.plan().first_slot();
        let solution = self.solution(place);
        let first = |row: &Vec<c64>| slot.and_then(|slot| row.get(slot)).map_or(0.0, |w| w.norm());
        solution.displacement.iter().map(first).collect()
    }

    /// The place of largest amplitude of output dof `dof` at distances in `range` from a place, and its distance: golden
    /// section, since the curve may have kinks.
    pub(crate) fn peak(&mut self, from: &Place, range: (f64, f64), dof: usize) -> Option<(Place, f64)> {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let metric = Metric::at(from, self.least);
        let at = |tracer: &mut Self, length: f64| -> Option<(Place, f64)> {
            let (place, _) = tracer.advance(from, &metric, length)?;
            let amplitude = tracer.amplitudes(&place)[dof];
            Some((place, amplitude))
        };
        let (mut low, mut high) = range;
        let width = high - low;
        let (mut x, mut y) = (high - RATIO * (high - low), low + RATIO * (high - low));
        let (mut left, mut right) = (at(self, x)?, at(self, y)?);
        while high - low > PEAK * width {
            if left.1 >= right.1 {
                (high, y, right) = (y, x, left);
                x = high - RATIO * (high - low);
                left = at(self, x)?;
            } else {
                (low, x, left) = (x, y, right);
                y = low + RATIO * (high - low);
                right = at(self, y)?;
            }
        }
        Some(if left.1 >= right.1 { (left.0, x) } else { (right.0, y) })
    }
}
