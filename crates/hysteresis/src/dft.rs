//! The oracle of the tests: Fourier coefficients by the definition, itself tested against closed forms.

use std::f64::consts::TAU;

use num_complex::Complex64;

/// One-sided complex amplitudes of `n` samples of one period, straight from the definition
/// `F_k = (2/n) Σ_j f_j e^{−2πi jk/n}` (1/n for k = 0).
pub(crate) fn naive_one_sided(samples: &[f64], harmonics: usize) -> Vec<Complex64> {
    let n = samples.len();
    (0..=harmonics)
        .map(|k| {
            let sum: Complex64 = (samples.iter().enumerate())
                .map(|(j, f)| f * Complex64::cis(-TAU * ((j * k) % n) as f64 / n as f64))
                .sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
        })
        .collect()
}

#[test]
fn a_cosine_with_phase_is_one_complex_amplitude() {
    let samples: Vec<f64> =
        (0..24).map(|j| 0.5 + 3.0 * (5.0 * TAU * f64::from(j) / 24.0 + 0.7).cos()).collect();
    for (k, found) in naive_one_sided(&samples, 11).iter().enumerate() {
        let exact = match k {
            0 => Complex64::new(0.5, 0.0),
            5 => Complex64::from_polar(3.0, 0.7),
            _ => Complex64::ZERO,
        };
        assert!((found - exact).norm() < 1e-14, "{k} {found}");
    }
}

#[test]
fn a_geometric_series_has_its_closed_form() {
    // Re 1/(1 − q e^{iθ}) = Re Σ q^k e^{ikθ}; aliases add q^{n−k} and smaller.
    let (q, n) = (0.5_f64, 128);
    let samples: Vec<f64> = (0..n)
        .map(|j| 1.0 / (1.0 - q * Complex64::cis(TAU * f64::from(j) / f64::from(n))))
        .map(|c| c.re)
        .collect();
    for (k, found) in naive_one_sided(&samples, 20).iter().enumerate() {
        assert!((found - Complex64::from(q.powi(k as i32))).norm() < 1e-15, "{k} {found}");
    }
}

#[test]
fn a_rectangular_loop_has_its_closed_form() {
    // Samples +1 before and −1 after half a period, at mid steps: |F_k| = (4/n) / sin(πk/n) for odd k, of
    // which 4/(πk) is the limit.
    let n = 64;
    let samples: Vec<f64> = (0..n).map(|j| if j < n / 2 { 1.0 } else { -1.0 }).collect();
    for (k, found) in naive_one_sided(&samples, 31).iter().enumerate() {
        let exact = if k % 2 == 1 { 4.0 / n as f64 / (TAU / 2.0 * k as f64 / n as f64).sin() } else { 0.0 };
        assert!((found.norm() - exact).abs() < 1e-14, "{k} {found}");
    }
}
