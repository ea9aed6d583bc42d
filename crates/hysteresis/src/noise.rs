//! How noisy a record is: scatter of its samples, and what of it reaches every harmonic.

use num_complex::Complex64;

use crate::average::{Bin, Polygon};
use crate::hysteresis_loop::evaluate;
use crate::loop_phase::LoopPhases;

/// Noise of a record about its mean cycle.
pub(crate) struct Noise {
    /// Root mean square of the force's scatter \[N\].
    pub scatter: f64,
    /// Standard error of every harmonic's complex amplitude \[N\], from harmonic 0 on.
    pub harmonics: Vec<f64>,
    /// Scatter where the contact slides over that where it sticks; none when too few samples tell.
    pub sliding_ratio: Option<f64>,
}

/// Measures noise. `series` is the fit with all harmonics that the samples can determine, `means` the
/// averaged cycle.
pub(crate) fn measure(phases: &LoopPhases, means: &[Bin], series: &[Complex64]) -> Noise {
    let defect = |theta: f64, force: f64| force - evaluate(series, theta);
    let n = phases.samples.len() as f64;
    let free = (n - (2 * series.len() - 1) as f64).max(1.0);
    let about_series = phases.samples.iter().map(|s| defect(s.theta, s.force).powi(2)).sum::<f64>() / free;
    let mut square = about_series;

    // Several cycles: what one differs from the other is noise, however many harmonics their mean has.
    let repeated = phases.branches.0.max(phases.branches.1) > 1;
    let free = n - means.len() as f64;
    if repeated && free > 0.3 * n {
        let mean = Polygon::through(means);
        let sum: f64 = phases.samples.iter().map(|s| (s.force - mean.value(s.theta)).powi(2)).sum();
        square = square.min(sum / free);
    }

    let harmonics = if repeated {
        repeatability(phases, series)
    } else {
        // White noise of variance s² in n samples of one cycle: E|F_k|² = 4 s²/n.
        vec![(4.0 * square / n).sqrt(); series.len()]
    };
    let middle = series.first().map_or(0.0, |mean| mean.re);
    Noise { scatter: square.sqrt(), harmonics, sliding_ratio: sliding_ratio(phases, means, middle) }
}

/// Standard error of every harmonic from how much the branches of a direction differ.
///
/// A harmonic is the mean of an unloading and a loading integral, each averaged over its branches, so the
/// variances add: `σ_k² = Σ_directions var / branches`. Few branches tell a variance badly; neighbouring
/// harmonics, whose noise is alike, are averaged.
fn repeatability(phases: &LoopPhases, series: &[Complex64]) -> Vec<f64> {
    let branches = phases.branches.0 + phases.branches.1;
    let harmonics = series.len();
    // Per branch: number of samples and Σ defect · e^{−ikθ}.
    let mut sums = vec![(0.0_f64, vec![Complex64::ZERO; harmonics]); branches];
    for sample in &phases.samples {
        let Some((count, sum)) = sums.get_mut(sample.branch) else { continue };
        *count += 1.0;
        let turn = Complex64::cis(-sample.theta);
        let mut term = Complex64::from(sample.force - evaluate(series, sample.theta));
        for harmonic in sum {
            *harmonic += term;
            term *= turn;
        }
    }
    let projections: Vec<Vec<Complex64>> =
        sums.into_iter().map(|(count, sum)| sum.into_iter().map(|c| c / count.max(1.0)).collect()).collect();
    let (unloading, loading) = projections.split_at(phases.branches.0.min(projections.len()));
    // A harmonic's sum of squared deviations from the mean branch of its direction.
    let deviations = |direction: &[Vec<Complex64>], k: usize| -> f64 {
        let value = |branch: &Vec<Complex64>| branch.get(k).copied().unwrap_or_default();
        let mean = direction.iter().map(value).sum::<Complex64>() / direction.len().max(1) as f64;
        direction.iter().map(|branch| (value(branch) - mean).norm_sqr()).sum()
    };
    let freedom = (branches.saturating_sub(2)).max(1) as f64;
    let per_mean = 1.0 / unloading.len().max(1) as f64 + 1.0 / loading.len().max(1) as f64;
    let variances: Vec<f64> = (0..harmonics)
        .map(|k| (deviations(unloading, k) + deviations(loading, k)) / freedom * per_mean)
        .collect();
    (0..harmonics)
        .map(|k| {
            let near = variances.iter().take(k + 3).skip(k.saturating_sub(2));
            let count = near.len().max(1) as f64;
            (near.sum::<f64>() / count).sqrt()
        })
        .collect()
}

/// Scatter where the contact slides, over that where it sticks: sliding is told by the force, which is then
/// more than half of its largest.
fn sliding_ratio(phases: &LoopPhases, means: &[Bin], middle: f64) -> Option<f64> {
    let mean = Polygon::through(means);
    let largest = means.iter().map(|bin| (bin.value - middle).abs()).fold(0.0, f64::max);
    let (mut sliding, mut sticking) = ((0.0, 0.0), (0.0, 0.0));
    for sample in &phases.samples {
        let force = mean.value(sample.theta);
        let part = if (force - middle).abs() > 0.5 * largest { &mut sliding } else { &mut sticking };
        part.0 += (sample.force - force).powi(2);
        part.1 += 1.0;
    }
    let square = |(sum, count): (f64, f64)| (count > 50.0).then_some(sum / count);
    Some((square(sliding)? / square(sticking)?).sqrt()).filter(|ratio| ratio.is_finite())
}
