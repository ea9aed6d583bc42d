//! The reported motion of a contact as a trigonometric polynomial, its turning points, and integrals over its period.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

/// `w(τ) = Re Σ W_k e^{ikτ}` over the base period; index k.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub(super) spectrum: Vec<Complex64>,
}

/// Where the velocity changes sign.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    pub(super) tau: f64,
    pub(super) w: f64,
    pub(super) maximum: bool,
}

impl Motion {
    pub(super) fn highest(&self) -> usize {
        self.spectrum.len().saturating_sub(1)
    }

    /// Without the mean: `Σ |W_k|`, k ≥ 1.
    pub(super) fn size(&self) -> f64 {
        self.spectrum.iter().skip(1).map(|w| w.norm()).sum()
    }

    pub(super) fn mean(&self) -> f64 {
        self.spectrum.first().map_or(0.0, |w| w.re)
    }

    /// w(τ) and dw/dτ.
    pub(super) fn at(&self, tau: f64) -> (f64, f64) {
        let turn = Complex64::cis(tau);
        let mut wave = Complex64::ONE;
        let (mut w, mut rate) = (self.mean(), 0.0);
        for (k, amplitude) in self.spectrum.iter().enumerate().skip(1) {
            // Powers drift by a rounding unit each; a fresh start every sixteen keeps the sum exact to its size.
            wave = if k.is_multiple_of(16) { Complex64::cis(k as f64 * tau) } else { wave * turn };
            let z = amplitude * wave;
            w += z.re;
            rate -= k as f64 * z.im;
        }
        (w, rate)
    }

    fn acceleration(&self, tau: f64) -> f64 {
        let term = |(k, w): (usize, &Complex64)| -((k * k) as f64) * (w * Complex64::cis(k as f64 * tau)).re;
        self.spectrum.iter().enumerate().map(term).sum()
    }

    /// `w(τ_t) − w(τ_t + δ)` at a turning point, without cancellation:
    /// `Re Σ W_k e^{ikτ_t} (2 sin²(kδ/2) − i (sin kδ − kδ))`, as the velocity is zero there.
    pub(super) fn drop(&self, turn: &Turn, delta: f64) -> f64 {
        let term = |(k, w): (usize, &Complex64)| {
            let x = k as f64 * delta;
            let half = (0.5 * x).sin();
            (w * Complex64::cis(k as f64 * turn.tau) * Complex64::new(2.0 * half * half, sine_lag(x))).re
        };
        self.spectrum.iter().enumerate().skip(1).map(term).sum()
    }

    /// All turning points in [0, 2π), ascending; maxima and minima in turn.
    pub(super) fn turns(&self) -> Vec<Turn> {
        let cells = 48 * (self.highest() + 1);
        // An offset, so that turning points of simple motions do not fall on the ends of cells.
        let at = |j: usize| TAU * (j as f64 + 0.123_456_789) / cells as f64;
        let mut turns = Vec::new();
        let (mut left, mut rate) = (at(0), self.at(at(0)).1);
        for j in 1..=cells {
            let right = at(j);
            let next = self.at(right).1;
            let mut push = |from: f64, to: f64, rate: f64| {
                let tau = self.root(from, to, rate);
                turns.push(Turn { tau: tau.rem_euclid(TAU), w: self.at(tau).0, maximum: rate > 0.0 });
            };
            if (rate > 0.0) != (next > 0.0) {
                push(left, right, rate);
            } else if let Some(middle) = self.dip(left, right, rate) {
                // Two turning points between neighbours of the grid.
                push(left, middle, rate);
                push(middle, right, -rate);
            }
            (left, rate) = (right, next);
        }
        turns.sort_by(|a, b| a.tau.total_cmp(&b.tau));
        turns
    }

    /// Where the velocity, of one sign at both ends, has the other in between.
    fn dip(&self, left: f64, right: f64, rate: f64) -> Option<f64> {
        let sign = rate.signum();
        // |v| has a minimum inside where it falls on entering and rises on leaving.
        let falls = sign * self.acceleration(left) < 0.0 && sign * self.acceleration(right) > 0.0;
        let (mut low, mut high) = (left, right);
        for _ in 0..60 {
            if !falls {
                break;
            }
            let middle = 0.5 * (low + high);
            if sign * self.at(middle).1 < 0.0 {
                return Some(middle);
            }
            if sign * self.acceleration(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        None
    }

    /// The zero of the velocity between two instants.
    fn root(&self, left: f64, right: f64, rate: f64) -> f64 {
        let (mut low, mut high) = (left, right);
        let mut tau = 0.5 * (low + high);
        for _ in 0..80 {
            let here = self.at(tau).1;
            if (here > 0.0) == (rate > 0.0) {
                low = tau;
            } else {
                high = tau;
            }
            let newton = tau - here / self.acceleration(tau);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - tau).abs() < 1e-16 || high - low < 1e-16 {
                break;
            }
            tau = next;
        }
        tau
    }
}

/// kδ − sin kδ for the drop, signed as it is used there.
fn sine_lag(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return x - x.sin();
    }
    let y = x * x;
    x * y / 6.0
        * (1.0 - y / 20.0 * (1.0 - y / 42.0 * (1.0 - y / 72.0 * (1.0 - y / 110.0 * (1.0 - y / 156.0)))))
}

/// Nodes and weights of the Gauss–Legendre rule with 16 points on (0, 1).
pub(super) fn gauss() -> [(f64, f64); 16] {
    let mut rule = [(0.0, 0.0); 16];
    for (i, slot) in rule.iter_mut().enumerate() {
        let mut x = (PI * (i as f64 + 0.75) / 16.5).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut before, mut here) = (1.0, x);
            for n in 2..=16 {
                let n = f64::from(n);
                (before, here) = (here, ((2.0 * n - 1.0) * x * here - (n - 1.0) * before) / n);
            }
            slope = 16.0 * (x * here - before) / (x * x - 1.0);
            let step = here / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        *slot = (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope));
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_polynomials_and_waves() {
        let integral = |f: &dyn Fn(f64) -> f64| -> f64 { gauss().iter().map(|(x, w)| w * f(*x)).sum() };
        assert!((integral(&|x| x.powi(31)) - 1.0 / 32.0).abs() < 1e-15);
        assert!((integral(&|x| (4.0 * x).cos()) - 4.0_f64.sin() / 4.0).abs() < 1e-15);
    }

    #[test]
    fn turning_points_of_two_harmonics() {
        // w = cos τ + ⅔ cos 3τ: w' = −sin τ − 2 sin 3τ = −sin τ (7 − 8 sin² τ).
        let spectrum = [0.0, 1.0, 0.0, 2.0 / 3.0].map(Complex64::from).to_vec();
        let turns = Motion { spectrum }.turns();
        assert_eq!(turns.len(), 6);
        for turn in &turns {
            let rate = turn.tau.sin() * (7.0 - 8.0 * turn.tau.sin().powi(2));
            assert!(rate.abs() < 1e-14, "{turn:?}");
        }
    }

    #[test]
    fn drops_near_a_tip_keep_their_digits() {
        let motion = Motion { spectrum: vec![Complex64::ZERO, Complex64::ONE] };
        let turn = Turn { tau: 0.0, w: 1.0, maximum: true };
        assert!((motion.drop(&turn, 1e-9) / 5e-19 - 1.0).abs() < 1e-12);
        assert!((motion.drop(&turn, 2.0) - (1.0 - 2.0_f64.cos())).abs() < 1e-15);
    }
}
