//! How far error estimates can be trusted: true errors beside estimated ones, and the shares that hold.

use serde::{Deserialize, Serialize};

/// One solved point at one N.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedPoint {
    /// Name of the scene.
    pub scene: String,
    /// In Hz.
    pub frequency: f64,
    /// N.
    pub harmonics: usize,
    /// Relative l2 error of the displacement spectrum against the reference, the worst of the output dofs.
    pub error: f64,
    /// What the solver said it would be, truncation and sampling together; none where it made no estimate.
    pub estimate: Option<f64>,
    /// Error of the reference itself.
    pub reference_accuracy: f64,
    /// The motion is not a truncation of the truth but another one: see [`JudgedPoint::elsewhere`].
    pub elsewhere: bool,
}

/// Errors are measured where they exceed that of the reference by this factor.
const MEASURABLE: f64 = 3.0;
/// Rounding of the solutions themselves.
const ROUNDING: f64 = 1e-13;
/// A motion this far from the truth, and with an amplitude this far from the truth's, is another motion.
const FAR: f64 = 0.5;

impl JudgedPoint {
    /// Whether a motion with relative l2 error `error` and relative error `peak` of its amplitude is another one than
    /// the truth: both are above one half. Such a point has not begun to converge; no estimate from its neighbourhood
    /// can be right in size, it can only say that the error is large.
    pub fn elsewhere(error: f64, peak: f64) -> bool {
        error > FAR && peak > FAR
    }

    /// Whether the reference is good enough to say anything about this point.
    pub fn measurable(&self) -> bool {
        self.error.is_finite() && self.error > MEASURABLE * self.reference_accuracy.max(ROUNDING)
    }

    /// Estimate over error, where both are known.
    pub fn ratio(&self) -> Option<f64> {
        self.estimate.filter(|_| self.measurable()).map(|estimate| estimate / self.error)
    }
}

/// What the estimates of some points are worth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EstimateQuality {
    /// Points with an estimate and a measurable error.
    pub points: usize,
    /// Points with a measurable error that the solver made no estimate of.
    pub without: usize,
    /// Share of them whose estimate is not below the error.
    pub safe: f64,
    /// Share of them whose estimate is at most ten times the error.
    pub tight: f64,
    /// Least, middle and greatest ratio of estimate to error.
    pub ratios: [f64; 3],
}

impl EstimateQuality {
    /// Over `points`; `None` when none of them has an estimate and a measurable error.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a JudgedPoint>) -> Option<Self> {
        let measurable: Vec<&JudgedPoint> = points.into_iter().filter(|point| point.measurable()).collect();
        let mut ratios: Vec<f64> = measurable.iter().filter_map(|point| point.ratio()).collect();
        ratios.sort_by(f64::total_cmp);
        let (least, greatest) = (*ratios.first()?, *ratios.last()?);
        let share = |holds: fn(f64) -> bool| {
            ratios.iter().filter(|ratio| holds(**ratio)).count() as f64 / ratios.len() as f64
        };
        Some(Self {
            points: ratios.len(),
            without: measurable.len() - ratios.len(),
            safe: share(|ratio| ratio >= 1.0),
            tight: share(|ratio| ratio <= 10.0),
            ratios: [least, ratios.get(ratios.len() / 2).copied().unwrap_or(least), greatest],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(error: f64, estimate: Option<f64>) -> JudgedPoint {
        JudgedPoint {
            scene: String::new(),
            frequency: 1.0,
            harmonics: 3,
            error,
            estimate,
            reference_accuracy: 1e-9,
            elsewhere: false,
        }
    }

    #[test]
    fn shares_count_what_can_be_measured() {
        let points = [
            point(1e-3, Some(2e-3)),
            point(1e-3, Some(5e-4)),
            point(1e-3, Some(2e-2)),
            point(1e-3, Some(1e-3)),
            point(1e-3, None),
            // Below what the reference can tell.
            point(2e-9, Some(1.0)),
            point(f64::INFINITY, Some(1.0)),
        ];
        let quality = EstimateQuality::of(&points).unwrap();
        assert_eq!((quality.points, quality.without), (4, 1));
        assert_eq!((quality.safe, quality.tight), (0.75, 0.75));
        assert!((quality.ratios[0] - 0.5).abs() < 1e-12 && (quality.ratios[2] - 20.0).abs() < 1e-12);
        assert!(EstimateQuality::of(&points[4..5]).is_none());
    }

    #[test]
    fn a_wrong_amplitude_alone_is_no_other_motion() {
        assert!(JudgedPoint::elsewhere(0.8, 0.9));
        assert!(!JudgedPoint::elsewhere(0.4, 0.9));
        assert!(!JudgedPoint::elsewhere(0.8, 0.2));
    }
}
