//! Features of a record that its user should know: its area, minor loops, backlash.

use std::f64::consts::PI;

use crate::fit::MeanCycle;
use crate::loop_phase::LoopPhases;
use crate::notes::Note;
use crate::turning_points::{REVERSAL, TurningPoint, extremes, range, sample_noise};

/// `∮ f dw` per cycle by the trapezoid rule over the raw samples between turning points; over the averaged cycle where
/// there is no complete branch of each direction.
pub(crate) fn direct_dissipation(
    phases: &LoopPhases,
    displacement: &[f64],
    force: &[f64],
    points: &[TurningPoint],
    cycle: &MeanCycle,
) -> f64 {
    let work = |w: &[f64], f: &[f64]| -> f64 {
        let (starts, ends) = (w.iter().zip(f), w.iter().skip(1).zip(f.iter().skip(1)));
        starts.zip(ends).map(|((w0, f0), (w1, f1))| 0.5 * (f0 + f1) * (w1 - w0)).sum()
    };
    if phases.joined {
        let closed = |values: &[f64]| -> Vec<f64> { values.iter().chain(values.first()).copied().collect() };
        return work(&closed(&cycle.displacement), &closed(&cycle.force));
    }
    let mean = |upper: bool| {
        let pairs = points.iter().zip(points.iter().skip(1)).filter(|(a, _)| a.upper == upper);
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, n), (a, b)| {
            let branch = a.sample..b.sample + 1;
            let columns = (displacement.get(branch.clone()).unwrap_or(&[]), force.get(branch).unwrap_or(&[]));
            (sum + work(columns.0, columns.1), n + 1.0)
        });
        sum / f64::max(count, 1.0)
    };
    mean(true) + mean(false)
}

/// Reversals inside the steady part that are too large for noise.
pub(crate) fn interior_reversals(
    (position, displacement): (&[f64], &[f64]),
    main: usize,
    height: f64,
) -> Option<Note> {
    let threshold = (12.0 * sample_noise(position, displacement)).max(0.02 * height);
    let all = extremes(displacement, threshold);
    let count = all.len().saturating_sub(main);
    let levels: Vec<f64> = all.iter().filter_map(|(sample, _)| displacement.get(*sample).copied()).collect();
    let steps = levels.iter().zip(levels.iter().skip(1)).map(|(a, b)| (a - b).abs());
    let largest = steps.filter(|step| *step < REVERSAL * height).fold(0.0, f64::max) / height;
    (count > 0 && largest > 0.0).then_some(Note::InteriorReversals { count, largest })
}

/// A plateau in the middle of the force, in both directions: the displacement travelled in bands of a
/// twentieth of the force's range has a peak there, and is at least a third smaller on both sides. (Without
/// backlash the way a band takes grows all along a branch.) Less than 3 % of the amplitude is not told from
/// noise.
pub(crate) fn backlash(cycle: &MeanCycle) -> Option<Note> {
    const BANDS: usize = 20;
    let low = cycle.force.iter().copied().fold(f64::INFINITY, f64::min);
    let band = range(&cycle.force) / BANDS as f64;
    let n = cycle.force.len();
    let next = |values: &[f64], j: usize| values.get((j + 1) % n).copied().unwrap_or(0.0);
    let mut width = 0.0;
    for unloading in [true, false] {
        let mut ways = [0.0; BANDS];
        for (j, ((theta, w), f)) in cycle.theta.iter().zip(&cycle.displacement).zip(&cycle.force).enumerate()
        {
            let force = 0.5 * (f + next(&cycle.force, j));
            let way = ways.get_mut(((force - low) / band) as usize);
            if let Some(way) = way.filter(|_| (*theta < PI) == unloading) {
                *way += (next(&cycle.displacement, j) - w).abs();
            }
        }
        let way = |i: usize| ways.get(i).copied().unwrap_or(0.0);
        let peak = (7..13).max_by(|&i, &j| way(i).total_cmp(&way(j))).unwrap_or(0);
        let (above, below) = (0.5 * (way(peak + 3) + way(peak + 4)), 0.5 * (way(peak - 3) + way(peak - 4)));
        if way(peak) < 1.5 * f64::max(above, below) {
            return None;
        }
        let around: f64 = (peak - 1..=peak + 1).map(way).sum();
        width += 0.5 * (around - 1.5 * (above + below));
    }
    (width > 0.03 * range(&cycle.displacement) / 2.0).then_some(Note::Backlash { width })
}
