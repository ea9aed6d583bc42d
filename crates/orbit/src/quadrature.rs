//! Gauss–Legendre quadrature.

use std::f64::consts::PI;

/// Nodes and weights on [0, 1], ascending: exact for polynomials of degree 2 `count` − 1.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |i: usize| {
        // Newton's method on P_n from Tricomi's approximation of its i-th root.
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut p) = (1.0, x);
            for q in 2..=count {
                let q = q as f64;
                (before, p) = (p, ((2.0 * q - 1.0) * x * p - (q - 1.0) * before) / q);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [2, 8, 20] {
            let rule = gauss_legendre(count);
            for power in 0..2 * count {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                assert!((sum * (power + 1) as f64 - 1.0).abs() < 1e-13, "{count} nodes, power {power}");
            }
        }
    }
}
