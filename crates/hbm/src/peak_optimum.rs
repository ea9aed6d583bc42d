//! The lowest highest peak: the smallest value over the parameter of the largest of several peaks.

use crate::error::PlanError;
use crate::peak_branch::{Family, Node};
use crate::peak_search::Summit;

/// A crossing is found to this relative accuracy in the parameter; a smooth minimum to what its flatness leaves, about 1e-7.
const CLOSE: f64 = 1e-8;

/// Evaluations at most.
const MOST: usize = 100;

/// Peaks closer than this to each other, relative, are equally high.
const EQUAL: f64 = 1e-5;

/// The lowest place between two coordinates.
pub(crate) struct Lowest {
    /// Coordinate of the parameter.
    pub(crate) at: f64,
    /// Peaks there and the branches they belong to, the highest first.
    pub(crate) summits: Vec<(usize, Summit)>,
}

impl Lowest {
    /// Whether two peaks are equally high there.
    pub(crate) fn is_crossing(&self) -> bool {
        match self.summits.as_slice() {
            [(_, first), (_, second), ..] => second.amplitude >= first.amplitude * (1.0 - EQUAL),
            _ => false,
        }
    }
}

impl Family<'_> {
    /// The highest peaks at a coordinate, the highest first; `None` where one of them was not found.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn peaks(
        &self,
        branches: &[Vec<Node>],
        at: f64,
    ) -> Result<Option<Vec<(usize, Summit)>>, PlanError> {
        let mut peaks = Vec::new();
        for index in self.relevant(branches, at) {
            let Some(branch) = branches.get(index) else { continue };
            let Some(summit) = self.on(branch, at)? else { return Ok(None) };
            peaks.push((index, summit));
        }
        peaks.sort_by(|a, b| b.1.amplitude.total_cmp(&a.1.amplitude));
        Ok((!peaks.is_empty()).then_some(peaks))
    }

    /// The place between `low` and `high` where the highest peak is lowest, with `middle` between them lower than both:
    /// Brent's method, parabolas with golden sections where they do not help, as at a crossing of two peaks.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn lowest(
        &self,
        branches: &[Vec<Node>],
        [mut low, middle, mut high]: [f64; 3],
    ) -> Result<Option<Lowest>, PlanError> {
        const GOLDEN: f64 = 0.381_966_011_250_105;
        let height = |peaks: &[(usize, Summit)]| peaks.first().map_or(f64::INFINITY, |(_, s)| s.amplitude);
        let Some(first) = self.peaks(branches, middle)? else { return Ok(None) };
        let (mut best, mut y) = ((middle, first.clone()), height(&first));
        // The second and the third best.
        let (mut w, mut v) = ((middle, y), (middle, y));
        let (mut step, mut before) = (0.0_f64, 0.0_f64);
        for _ in 0..MOST {
            let x = best.0;
            let close = match self.axis {
                crate::peak_branch::Axis::Linear => CLOSE * x.abs().max(1e-3 * (high - low)),
                crate::peak_branch::Axis::Log => CLOSE,
            };
            let centre = 0.5 * (low + high);
            if (x - centre).abs() + 0.5 * (high - low) <= 2.0 * close {
                break;
            }
            let golden = || if x < centre { high - x } else { low - x };
            let r = (x - w.0) * (y - v.1);
            let q = (x - v.0) * (y - w.1);
            let (p, q) = ((x - v.0) * q - (x - w.0) * r, 2.0 * (q - r));
            let (p, q) = if q > 0.0 { (-p, q) } else { (p, -q) };
            let parabola = q != 0.0
                && p.abs() < (0.5 * q * before).abs()
                && p > q * (low - x)
                && p < q * (high - x)
                && before.abs() > close;
            if parabola {
                (before, step) = (step, p / q);
                if x + step - low < 2.0 * close || high - x - step < 2.0 * close {
                    step = close.copysign(centre - x);
                }
            } else {
                before = golden();
                step = GOLDEN * before;
            }
            let u = x + if step.abs() >= close { step } else { close.copysign(step) };
            let Some(peaks) = self.peaks(branches, u)? else { return Ok(None) };
            let here = height(&peaks);
            if here <= y {
                if u >= x {
                    low = x;
                } else {
                    high = x;
                }
                (v, w) = (w, (x, y));
                (best, y) = ((u, peaks), here);
            } else {
                if u < x {
                    low = u;
                } else {
                    high = u;
                }
                if here <= w.1 || w.0 == x {
                    (v, w) = (w, (u, here));
                } else if here <= v.1 || v.0 == x || v.0 == w.0 {
                    v = (u, here);
                }
            }
        }
        Ok(Some(Lowest { at: best.0, summits: best.1 }))
    }
}
