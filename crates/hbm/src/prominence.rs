//! Which maxima and folds of a curve stand above its noise.
//!
//! The prominence of a maximum is its height above the higher of the two lowest places that lie between it and the next higher
//! ground to either side, or the end of the curve. A balance that is solved to a tolerance, and forces that are known at M instants
//! of a period, leave wiggles on a curve; a maximum counts where its prominence is larger than they are.

use std::f64::consts::TAU;

use contact::Mechanism;

use crate::continuation::CurvePoint;
use crate::plan::Plan;
use crate::problem::Contact;

/// Least prominence, relative to the height: the error that correctors leave is below it.
const NOISE: f64 = 1e-6;

impl Plan {
    /// Least prominence of a maximum, relative to its height. Trapezoidal sums of forces with kinks err by up to (2π/M)², and a
    /// resonance answers with a few times that.
    pub(crate) fn noise(&self) -> f64 {
        match self.rungs.get(self.top) {
            Some(rung) if self.has_sampled_kinks() => {
                (2.0 * TAU / rung.transform.samples() as f64).powi(2).max(NOISE)
            }
            _ => NOISE,
        }
    }

    /// Whether forces with kinks are known at samples only. Of smooth forces the sums are as good as exact, however few they are.
    fn has_sampled_kinks(&self) -> bool {
        let smooth = |contact: &Contact| matches!(contact.law.mechanism(), Mechanism::Smooth(_));
        self.has_samples() && !(self.joints.is_empty() && self.contacts.iter().all(smooth))
    }
}

/// What sampled forces do to a resonance's height they do to its frequency by less than this part.
const SIDEWAYS: f64 = 0.01;

/// Strikes out the folds of a curve with sampled forces that turn back by no more than the noise: its maxima of the parameter and
/// of its negative.
pub(crate) fn keep_wide(points: &mut [CurvePoint], plan: &Plan) {
    if !plan.has_sampled_kinks() {
        return;
    }
    let noise = SIDEWAYS * plan.noise();
    let forth: Vec<f64> = points.iter().map(|point| point.parameter).collect();
    let back: Vec<f64> = forth.iter().map(|parameter| -parameter).collect();
    for (at, point) in points.iter_mut().enumerate().filter(|(_, point)| point.fold) {
        let turned = prominence(&forth, at).max(prominence(&back, at));
        point.fold = turned > noise * point.parameter.abs();
    }
}

/// Strikes out the maxima that do not stand above the noise; `points` are in the order of the curve.
pub(crate) fn keep_prominent(points: &mut [CurvePoint], plan: &Plan) {
    let Some(slot) = plan.first_slot() else { return };
    let noise = plan.noise();
    let marked: std::collections::BTreeSet<usize> =
        points.iter().flat_map(|point| point.peaks.iter().copied()).collect();
    for dof in marked {
        let height = |point: &CurvePoint| {
            let row = point.solution.displacement.get(dof);
            row.and_then(|row| row.get(slot)).map_or(0.0, |w| w.norm())
        };
        let heights: Vec<f64> = points.iter().map(height).collect();
        for (at, point) in points.iter_mut().enumerate() {
            if point.peaks.contains(&dof) && prominence(&heights, at) <= noise * heights[at] {
                point.peaks.retain(|other| *other != dof);
            }
        }
    }
}

/// The prominence of the maximum at index `at`.
pub(crate) fn prominence(heights: &[f64], at: usize) -> f64 {
    let top = heights.get(at).copied().unwrap_or(0.0);
    let lowest = |side: &mut dyn Iterator<Item = &f64>| {
        side.take_while(|height| **height <= top).copied().fold(top, f64::min)
    };
    let before = lowest(&mut heights.iter().take(at).rev());
    let after = lowest(&mut heights.iter().skip(at + 1));
    top - before.max(after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_maximum_stands_above_the_higher_of_its_saddles() {
        let heights = [1.0, 4.0, 3.0, 3.5, 3.2, 9.0, 2.0, 2.5, 0.0];
        for (at, expected) in [(1, 1.0), (3, 0.3), (5, 8.0), (7, 0.5)] {
            let found = prominence(&heights, at);
            assert!((found - expected).abs() < 1e-12, "{at}: {found} for {expected}");
        }
    }
}
