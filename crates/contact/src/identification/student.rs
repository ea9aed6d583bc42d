//! Student's t: how wide a 95 % interval is when the scatter itself was estimated from few points.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Half width of the 95 % interval in standard errors, for a normal distribution of known variance.
pub(super) const NORMAL: f64 = 1.959_963_984_540_054;

/// Half width of the 95 % interval in standard errors for `freedom` ≥ 1 degrees of freedom.
pub(super) fn t95(freedom: usize) -> f64 {
    // A(t) grows with t = √ν tan θ; bisection in θ.
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if inside(middle, freedom) < 0.95 { low = middle } else { high = middle }
    }
    (freedom as f64).sqrt() * (0.5 * (low + high)).tan()
}

/// Probability A(t|ν) of |T| ≤ t with θ = arctan(t/√ν), Abramowitz and Stegun 26.7.3–4: with x = cos²θ,
///
/// ```text
/// ν odd:  (2/π) (θ + sin θ cos θ (1 + 2/3 x + 2·4/(3·5) x² + …)),   (ν − 1)/2 terms
/// ν even: sin θ (1 + 1/2 x + 1·3/(2·4) x² + …),                     ν/2 terms
/// ```
fn inside(theta: f64, freedom: usize) -> f64 {
    let (sin, cos) = theta.sin_cos();
    let odd = freedom % 2 == 1;
    let shift = if odd { 1.0 } else { 0.0 };
    let (mut term, mut sum) = (1.0, 0.0);
    for j in 0..freedom / 2 {
        sum += term;
        let n = 2.0 * j as f64 + 1.0 + shift;
        term *= n / (n + 1.0) * cos * cos;
    }
    if odd { FRAC_2_PI * (theta + sin * cos * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 26.10; 1000: normal to three digits.
        for (freedom, t) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (5, 2.571),
            (9, 2.262),
            (30, 2.042),
            (120, 1.980),
        ] {
            assert!((t95(freedom) - t).abs() < 6e-4, "{freedom}: {}", t95(freedom));
        }
        assert!((t95(100_000) - NORMAL).abs() < 1e-4);
    }
}
