//! Fourier series of unevenly spaced samples over loop phase: FFT of a resampled grid, corrected.
//!
//! Samples are averaged in bins, joined by straight lines, resampled evenly and transformed by an FFT.
//! Straight lines cut the crests, so what the series misses at the samples themselves is fitted in the same
//! way and added until nothing changes (defect correction). The limit depends no longer on the lines: a
//! series with no more than `harmonics` harmonics is found to rounding.

use num_complex::Complex64;
use rustfft::FftPlanner;

use crate::average::{Polygon, bin_means};
use crate::hysteresis_loop::evaluate;

/// One-sided complex amplitudes `F_k`, k = 0..=harmonics, of `n` samples of one period:
/// `f_j = Re Σ_k F_k e^{2πi jk/n}`. `harmonics` must be below n/2; higher ones come out as zero.
pub(crate) fn one_sided(samples: &[f64], harmonics: usize) -> Vec<Complex64> {
    let n = samples.len();
    let mut spectrum: Vec<Complex64> = samples.iter().map(|&f| Complex64::from(f)).collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut spectrum);
    let resolved = spectrum.iter().take(n.div_ceil(2));
    let scaled = resolved.enumerate().map(|(k, c)| match k {
        0 => Complex64::from(c.re / n as f64),
        _ => c * (2.0 / n as f64),
    });
    scaled.chain(std::iter::repeat(Complex64::ZERO)).take(harmonics + 1).collect()
}

/// The series of `harmonics` harmonics through samples `(theta, value)`, theta in [0, 2π].
pub(crate) fn fit_series(samples: &[(f64, f64)], bins: usize, harmonics: usize) -> Vec<Complex64> {
    const PASSES: usize = 60;
    let grid = (8 * (harmonics + 1)).max(bins).next_power_of_two();
    let mut series = vec![Complex64::ZERO; harmonics + 1];
    let mut last_step = f64::INFINITY;
    for _ in 0..PASSES {
        let defect = samples.iter().map(|&(theta, value)| (theta, value - evaluate(&series, theta)));
        let means = bin_means(defect, bins);
        let correction = one_sided(&Polygon::through(&means).resample(grid), harmonics);
        let step = norm(&correction);
        if step >= last_step {
            break; // down at rounding, or the samples do not determine the highest harmonics
        }
        for (coefficient, change) in series.iter_mut().zip(&correction) {
            *coefficient += change;
        }
        if step <= 1e-15 * norm(&series) {
            break;
        }
        last_step = step;
    }
    series
}

fn norm(series: &[Complex64]) -> f64 {
    series.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dft::naive_one_sided;
    use rand::{RngExt as _, SeedableRng};
    use std::f64::consts::TAU;

    fn noise(n: usize) -> Vec<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(n as u64);
        (0..n).map(|_| rng.random_range(-1.0..1.0)).collect()
    }

    #[test]
    fn the_transform_agrees_with_the_naive_one() {
        for n in [1, 2, 3, 8, 15, 64, 101] {
            let samples = noise(n);
            let harmonics = (n - 1) / 2;
            let naive = naive_one_sided(&samples, harmonics);
            for (fast, slow) in one_sided(&samples, harmonics).iter().zip(&naive) {
                assert!((fast - slow).norm() < 1e-13, "n = {n}: {fast} {slow}");
            }
        }
    }

    #[test]
    fn a_band_limited_series_is_found_to_rounding_from_uneven_samples() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut truth: Vec<Complex64> = (0..16)
            .map(|k| {
                Complex64::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0))
                    / (1.0 + f64::from(k))
            })
            .collect();
        truth[0].im = 0.0;
        // 150 samples, each up to half a step off the even grid.
        let samples: Vec<(f64, f64)> = (0..150)
            .map(|j| TAU * (f64::from(j) + rng.random_range(0.0..1.0)) / 150.0)
            .map(|theta| (theta, evaluate(&truth, theta)))
            .collect();
        let fitted = fit_series(&samples, 256, 15);
        for (k, (found, exact)) in fitted.iter().zip(&truth).enumerate() {
            assert!((found - exact).norm() < 1e-12, "harmonic {k}: {found} {exact}");
        }
    }
}
