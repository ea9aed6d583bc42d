//! Samples of many cycles averaged over loop phase: narrow bins, each with its own mean phase.

use std::f64::consts::TAU;

/// The mean of the samples that fell into one narrow range of loop phase.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Bin {
    /// Their mean loop phase \[rad\].
    pub theta: f64,
    /// Their mean value.
    pub value: f64,
    /// How many they are.
    pub count: usize,
}

/// Number of the bin, of `bins` equal ones, that holds a loop phase in [0, 2π].
pub(crate) fn bin_of(theta: f64, bins: usize) -> usize {
    ((theta / TAU * bins as f64) as usize).min(bins - 1)
}

/// Averages `(theta, value)` pairs over `bins` equal bins of the circle; empty bins are left out. The means
/// are in the order of θ.
pub(crate) fn bin_means(samples: impl Iterator<Item = (f64, f64)>, bins: usize) -> Vec<Bin> {
    let mut sums = vec![Bin::default(); bins];
    for (theta, value) in samples {
        if let Some(bin) = sums.get_mut(bin_of(theta, bins)) {
            bin.theta += theta;
            bin.value += value;
            bin.count += 1;
        }
    }
    sums.retain(|bin| bin.count > 0);
    for bin in &mut sums {
        bin.theta /= bin.count as f64;
        bin.value /= bin.count as f64;
    }
    sums
}

/// Straight lines between the means, around the circle.
pub(crate) struct Polygon<'a> {
    bins: &'a [Bin],
}

impl<'a> Polygon<'a> {
    pub(crate) fn through(bins: &'a [Bin]) -> Self {
        Self { bins }
    }

    /// Value at a loop phase in [0, 2π].
    pub(crate) fn value(&self, theta: f64) -> f64 {
        let after = self.bins.partition_point(|bin| bin.theta <= theta);
        let (Some(first), Some(last)) = (self.bins.first(), self.bins.last()) else { return 0.0 };
        let (from, to) = match (after.checked_sub(1).and_then(|i| self.bins.get(i)), self.bins.get(after)) {
            (Some(a), Some(b)) => ((a.theta, a.value), (b.theta, b.value)),
            (Some(a), None) => ((a.theta, a.value), (first.theta + TAU, first.value)),
            (None, _) => ((last.theta - TAU, last.value), (first.theta, first.value)),
        };
        let step = to.0 - from.0;
        if step > 0.0 { from.1 + (to.1 - from.1) * (theta - from.0) / step } else { from.1 }
    }

    /// Values on a uniform grid of `n` loop phases that begins at 0.
    pub(crate) fn resample(&self, n: usize) -> Vec<f64> {
        (0..n).map(|j| self.value(TAU * j as f64 / n as f64)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_survives_binning_and_resampling() {
        // Off the seam, means of a line lie on that line wherever the samples fell.
        let samples = (0..997).map(|j| (TAU * j as f64 / 997.0, 3.0 * TAU * j as f64 / 997.0 + 1.0));
        let bins = bin_means(samples, 64);
        assert_eq!(bins.len(), 64);
        let line = Polygon::through(&bins);
        for theta in [0.5, 1.0, 4.0, 6.0] {
            assert!((line.value(theta) - (3.0 * theta + 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_polygon_closes_around_the_circle() {
        let bins = [(1.0, 2.0), (TAU - 1.0, 4.0)].map(|(theta, value)| Bin { theta, value, count: 1 });
        let polygon = Polygon::through(&bins);
        assert!((polygon.value(0.0) - 3.0).abs() < 1e-14);
        assert!((polygon.value(TAU) - 3.0).abs() < 1e-14);
    }
}
