//! Slow drift of displacement and force, found from what should repeat, and taken off.

use crate::average::bin_of;
use crate::cycles::Steady;
use crate::error::FitError;
use crate::loop_phase::LoopPhases;
use crate::turning_points::{REVERSAL, TurningPoint, extremes, range, turning_points};

/// Finds the steady cycles and takes the drift they show off the displacement, which moves the turning
/// points a little: until they stay. Returns the displacement, its steady part and the drift that was taken
/// off \[m per unit of position\], about the centre of the steady part.
pub(crate) fn without_drift(
    position: &[f64],
    displacement: &[f64],
    tolerance: f64,
) -> Result<(Vec<f64>, Steady, f64), FitError> {
    let span = position.last().copied().unwrap_or(0.0) - position.first().copied().unwrap_or(0.0);
    let mut w = displacement.to_vec();
    let (mut removed, mut centre) = (0.0, 0.0);
    let mut pass = 0;
    loop {
        let height = range(&w);
        let points = turning_points(position, &w, &extremes(&w, REVERSAL * height), height);
        // Strong drift makes the branches of one direction longer than those of the other: it goes first.
        let drift = match common_drift(&points).filter(|_| pass == 0) {
            Some(drift) => drift,
            None => {
                let steady = Steady::find(&points, tolerance)?;
                if (steady.drift * span).abs() <= 1e-9 * height || pass > 3 {
                    return Ok((w, steady, removed));
                }
                centre = steady.centre;
                steady.drift
            }
        };
        pass += 1;
        removed += drift;
        for ((w, raw), u) in w.iter_mut().zip(displacement).zip(position) {
            *w = raw - removed * (u - centre);
        }
    }
}

/// The drift from one turning point to the next of its kind \[m per unit of position\], where upper and
/// lower ones agree on it as they do in drift but not in run-up: their median, if most are within a tenth
/// of it.
fn common_drift(points: &[TurningPoint]) -> Option<f64> {
    let seen: Vec<&TurningPoint> = points.iter().filter(|p| !p.at_edge).collect();
    let slope = |(a, b): (&&TurningPoint, &&TurningPoint)| {
        (b.displacement - a.displacement) / (b.position - a.position)
    };
    let slopes: Vec<f64> = seen.iter().zip(seen.iter().skip(2)).map(slope).collect();
    let drift = median(slopes.iter().copied())?;
    let spread = median(slopes.iter().map(|slope| (slope - drift).abs()))?;
    (slopes.len() >= 3 && spread < 0.1 * drift.abs()).then_some(drift)
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Drift of the force \[N per unit of position\], from samples at the same loop phase in different cycles:
/// least squares with a mean of its own for every bin. Zero where no bin was passed twice.
pub(crate) fn force_drift(phases: &LoopPhases, bins: usize) -> f64 {
    if phases.branches.0.min(phases.branches.1) < 2 {
        return 0.0;
    }
    let mut sums = vec![(0.0, 0.0, 0.0); bins];
    for sample in &phases.samples {
        if let Some((count, position, force)) = sums.get_mut(bin_of(sample.theta, bins)) {
            *count += 1.0;
            *position += sample.position;
            *force += sample.force;
        }
    }
    let (mut covariance, mut variance) = (0.0, 0.0);
    for sample in &phases.samples {
        if let Some((count, position, force)) = sums.get(bin_of(sample.theta, bins)) {
            let later = sample.position - position / count;
            covariance += later * (sample.force - force / count);
            variance += later * later;
        }
    }
    if variance > 0.0 { covariance / variance } else { 0.0 }
}
