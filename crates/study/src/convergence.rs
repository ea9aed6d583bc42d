//! Convergence studies: errors over the size of a discretisation, and the order at which they fall.

use serde::{Deserialize, Serialize};

/// Errors of one method at growing sizes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Convergence {
    /// (size, error): number of harmonics plus one, samples or steps a period, …
    pub points: Vec<(f64, f64)>,
}

/// error ≈ constant · size^(−order)
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Order of convergence, positive when errors fall.
    pub order: f64,
    /// The constant.
    pub constant: f64,
    /// Largest factor between a point and the line.
    pub spread: f64,
}

impl Convergence {
    /// The rate between sizes `from` and `to` by least squares in logarithms; `None` with fewer than two usable points.
    pub fn rate(&self, from: f64, to: f64) -> Option<Order> {
        let usable = |&&(size, error): &&(f64, f64)| {
            (from..=to).contains(&size) && size > 0.0 && error > 0.0 && error.is_finite()
        };
        let logs: Vec<(f64, f64)> =
            self.points.iter().filter(usable).map(|(n, e)| (n.ln(), e.ln())).collect();
        let count = logs.len() as f64;
        let (x, y) = logs.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
        let square: f64 = logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
        if square <= 0.0 {
            return None;
        }
        let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / square;
        let offset = y - slope * x;
        let spread = logs.iter().map(|p| (p.1 - offset - slope * p.0).abs()).fold(0.0, f64::max);
        Some(Order { order: -slope, constant: offset.exp(), spread: spread.exp() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_recovered() {
        let points = [4.0, 8.0, 16.0, 32.0, 64.0].map(|n: f64| (n, 3.0 * n.powf(-3.5))).to_vec();
        let rate = Convergence { points }.rate(8.0, 64.0).unwrap();
        assert!((rate.order - 3.5).abs() < 1e-12 && (rate.constant - 3.0).abs() < 1e-11);
        assert!((rate.spread - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_point_has_no_rate() {
        let points = vec![(4.0, 1.0), (8.0, 0.0), (16.0, f64::INFINITY)];
        assert_eq!(Convergence { points }.rate(1.0, 100.0), None);
        assert_eq!(Convergence::default().rate(1.0, 100.0), None);
    }
}
