//! A period of motion as hysteretic laws walk through it: turning points, and the samples between them.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::law::Motion;
use crate::turning_points::{TurningPoint, TurningPoints, drop_from};

/// Consecutive samples that share an owner (a branch, a turning point); they may run over the end of the period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) owner: usize,
    /// Number of the first sample, below the number of samples.
    pub(crate) first: usize,
    pub(crate) length: usize,
}

impl Piece {
    /// Calls `visit` for the entry of every sample of the piece in `row`.
    #[inline]
    pub(crate) fn for_each<T>(&self, row: &mut [T], mut visit: impl FnMut(&mut T)) {
        let [before, after] = self.ranges(row.len());
        row.get_mut(before).unwrap_or_default().iter_mut().for_each(&mut visit);
        row.get_mut(after).unwrap_or_default().iter_mut().for_each(visit);
    }

    /// The samples up to the end of the period, and those from its beginning.
    #[inline]
    pub(crate) fn ranges(&self, samples: usize) -> [Range<usize>; 2] {
        let end = self.first + self.length;
        [self.first..end.min(samples), 0..end.saturating_sub(samples)]
    }
}

/// Gives the samples of `row` that are not on `half`, half a period of it, what those on it are, `turned`.
pub(crate) fn mirror<T: Copy>(row: &mut [T], half: Piece, turned: impl Fn(T) -> T) {
    let (first, second) = row.split_at_mut(row.len() / 2);
    // Of two samples half a period apart one is on the half: the later one up to where it begins.
    let start = half.first % first.len().max(1);
    let later = half.first >= first.len();
    for (j, (early, late)) in first.iter_mut().zip(second).enumerate() {
        if (j < start) != later { *early = turned(*late) } else { *late = turned(*early) }
    }
}

/// Displacements at turning points and samples, for any number type.
pub(crate) trait Path<T> {
    /// Number of turning points; the first is the global maximum.
    fn count(&self) -> usize;
    /// Position of the global minimum.
    fn lowest(&self) -> usize;
    /// Whether the samples of half a period are those of the other half with the other sign: only from maximum to
    /// minimum need they be walked through.
    fn mirrors(&self) -> bool {
        false
    }
    /// Displacement at turning point `r` (`count` means the first again).
    fn tip(&self, r: usize) -> T;
    /// First sample at or after turning point `r`, counting on past a full period.
    fn first_sample(&self, r: usize) -> usize;
    /// Displacement of sample `j` < number of samples.
    fn sample(&self, j: usize) -> T;
    /// |w_j − w_r|, without cancellation when the sample is close to the turning point in time.
    fn distance(&self, j: usize, r: usize) -> T;
}

/// The path of a sampled motion.
pub(crate) struct SampledPath<'a> {
    motion: &'a Motion<'a>,
    tips: &'a TurningPoints,
    samples: usize,
    /// Below this distance from a turning point the spectrum is asked instead of the samples, in m.
    close: f64,
}

impl<'a> SampledPath<'a> {
    pub(crate) fn new(motion: &'a Motion<'a>, tips: &'a TurningPoints) -> Self {
        // θ ~ √(distance): a rounding error ε in the distance becomes ε / √(8 · 1e-4) in θ.
        Self { motion, tips, samples: motion.displacement.len(), close: 1e-4 * tips.amplitude() }
    }

    pub(crate) fn point(&self, r: usize) -> TurningPoint {
        let points = self.tips.points();
        let index = if r < points.len() { r } else { r.saturating_sub(points.len()) };
        points.get(index).copied().unwrap_or(TurningPoint { tau: 0.0, displacement: 0.0, acceleration: 0.0 })
    }

    /// Phase of sample `j` after turning point `r`, in (−π, π].
    pub(crate) fn phase_after(&self, j: usize, r: usize) -> f64 {
        let delta = j as f64 * (TAU / self.samples as f64) - self.point(r).tau;
        delta - TAU * (delta / TAU).round()
    }
}

impl Path<f64> for SampledPath<'_> {
    fn count(&self) -> usize {
        self.tips.points().len()
    }

    fn lowest(&self) -> usize {
        self.tips.lowest()
    }

    fn mirrors(&self) -> bool {
        self.motion.odd && self.samples.is_multiple_of(2) && 2 * self.lowest() == self.count()
    }

    fn tip(&self, r: usize) -> f64 {
        self.point(r).displacement
    }

    fn first_sample(&self, r: usize) -> usize {
        let whole = if r == self.count() { self.samples } else { 0 };
        whole + (self.point(r).tau * (self.samples as f64 / TAU)).ceil() as usize
    }

    #[inline]
    fn sample(&self, j: usize) -> f64 {
        self.motion.displacement.get(j).copied().unwrap_or(0.0)
    }

    #[inline]
    fn distance(&self, j: usize, r: usize) -> f64 {
        let difference = (self.sample(j) - self.tip(r)).abs();
        if difference < self.close {
            let delta = self.phase_after(j, r);
            if delta.abs() < 0.5 {
                return drop_from(self.motion.spectrum, self.point(r).tau, delta).abs();
            }
        }
        difference
    }
}
