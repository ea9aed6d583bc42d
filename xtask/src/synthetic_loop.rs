//! The synthetic loops: Dahl's friction with sliding branches that fall, made to agree with the paper's laws.
//!
//! With ξ = cos θ and loop phase θ from the upper tip, the unloading branch of the loop at amplitude α W* is
//!
//! ```text
//! f(θ)/f_c = −1 + (1 + tanh s) e^{−s (1 − ξ)} − β ξ,   0 ≤ θ ≤ π,   f(θ + π) = −f(θ)
//! ```
//!
//! s is the ratio of amplitude to Dahl's sliding length. β is not chosen but follows from the phase that (7) gives at α.
//! At α = 1 it cannot be zero: a loop with monotone branches has a first harmonic in phase with the displacement that
//! only a sliding length below a thousandth of the amplitude brings down to 0.9 % of π/2, a rectangle that no 15
//! harmonics describe. So the force after breakaway is larger than at the end of the stroke.
//!
//! The series is cut to 15 odd harmonics. The reference loop, α = 1, has |F_1| = F*; f_c of the other loops is such that
//! their turning points lie on eq. (6), scaled to go through the reference loop's.

use std::f64::consts::PI;

use anyhow::Result;
use contact::{MagnitudeLaw, PhaseLaw};
use hysteresis::Loop;
use num_complex::Complex64;

/// W*: displacement amplitude of the reference loop in m.
pub(crate) const DISPLACEMENT: f64 = 8e-6;
/// F*: magnitude of its first force harmonic in N.
pub(crate) const FORCE: f64 = 12.0;
/// s of the reference loop: amplitude over sliding length.
pub(crate) const SHARPNESS: f64 = 20.0;
/// Odd harmonics kept.
pub(crate) const HARMONICS: usize = 15;

/// A series over loop phase, `f(θ) = Re Σ F_k e^{ikθ}`, as pairs (k, F_k in N).
pub(crate) struct Series {
    terms: Vec<(f64, Complex64)>,
    /// β.
    pub(crate) fall: f64,
}

impl Series {
    /// The loop at W*.
    pub(crate) fn reference() -> Self {
        let mut series = Self::shaped(1.0);
        let first = series.terms.first().map_or(1.0, |(_, c)| c.norm());
        series.scale(FORCE / first);
        series
    }

    /// The loop at α W*.
    pub(crate) fn at(alpha: f64) -> Self {
        let law = MagnitudeLaw::default();
        let tip = Self::reference().force(0.0) * law.value(alpha) / law.value(1.0);
        let mut series = Self::shaped(alpha);
        series.scale(tip / series.force(0.0));
        series
    }

    /// With the phase of eq. (7), for unit friction force.
    fn shaped(alpha: f64) -> Self {
        let phase = PI + PhaseLaw::default().value(alpha);
        let mut terms: Vec<(f64, Complex64)> = (0..HARMONICS)
            .map(|i| (2 * i + 1) as f64)
            .map(|k| (k, dahl_coefficient(k, alpha * SHARPNESS)))
            .collect();
        // −β ξ = −β cos θ changes Re F_1 alone.
        let first = terms.first().map_or(Complex64::ZERO, |(_, c)| *c);
        let fall = first.re - first.im / phase.tan();
        if let Some((_, c)) = terms.first_mut() {
            c.re -= fall;
        }
        Self { terms, fall }
    }

    fn scale(&mut self, factor: f64) {
        self.terms.iter_mut().for_each(|(_, c)| *c *= factor);
    }

    /// As a loop of amplitude α W*.
    pub(crate) fn to_loop(&self, alpha: f64) -> Result<Loop> {
        let mut coefficients = vec![Complex64::ZERO; 2 * HARMONICS];
        for (k, c) in &self.terms {
            if let Some(entry) = coefficients.get_mut(*k as usize) {
                *entry = *c;
            }
        }
        Ok(Loop::new(alpha * DISPLACEMENT, coefficients)?)
    }

    pub(crate) fn force(&self, phase: f64) -> f64 {
        self.terms.iter().map(|(k, c)| (c * Complex64::cis(k * phase)).re).sum()
    }

    /// Half the distance of the branches at loop phase θ, in N.
    fn half_width(&self, phase: f64) -> f64 {
        self.terms.iter().map(|(k, c)| c.im * (k * phase).sin()).sum()
    }

    /// The law scales the half-width and nothing else that dissipates: where it is positive, every scaled loop is passive.
    pub(crate) fn passive(&self) -> bool {
        (1..4096).all(|j| self.half_width(PI * f64::from(j) / 4096.0) > 0.0)
    }
}

/// F_k/f_c of Dahl's loop for odd k: `(2/π) ∫_0^π f e^{−ikθ} dθ` by the midpoint rule, for s = `sharpness`.
fn dahl_coefficient(k: f64, sharpness: f64) -> Complex64 {
    const POINTS: u32 = 1 << 15;
    let tip = sharpness.tanh();
    let sum: Complex64 = (0..POINTS)
        .map(|j| {
            let phase = PI * (f64::from(j) + 0.5) / f64::from(POINTS);
            let force = -1.0 + (1.0 + tip) * (-sharpness * (1.0 - phase.cos())).exp();
            force * Complex64::cis(-k * phase)
        })
        .sum();
    sum * (2.0 / f64::from(POINTS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_harmonic_agrees_with_the_law() {
        let (k, first) = Series::reference().terms[0];
        assert_eq!(k, 1.0);
        assert!((first.norm() - 12.0).abs() < 1e-12);
        assert!((first.arg() / PI - 0.491_452_7).abs() < 1e-7, "{}", first.arg() / PI);
    }

    #[test]
    fn the_coefficients_are_integrated_to_rounding() {
        // Dahl's loop dissipates 4 (a − x_s tanh(a/x_s)) a unit of friction force; only Im F_1 does: π a Im F_1.
        let exact = 4.0 * (1.0 - SHARPNESS.tanh() / SHARPNESS) / PI;
        assert!(
            (dahl_coefficient(1.0, SHARPNESS).im - exact).abs() < 1e-8,
            "{}",
            dahl_coefficient(1.0, SHARPNESS).im - exact
        );
    }

    #[test]
    fn the_cut_series_is_close_to_the_loop_it_came_from() {
        let series = Series::reference();
        let scale = series.terms[1].1.re / dahl_coefficient(3.0, SHARPNESS).re;
        for j in 1..1000 {
            let phase = PI * f64::from(j) / 1000.0;
            let xi = phase.cos();
            let branch = -1.0 + (1.0 + SHARPNESS.tanh()) * (-SHARPNESS * (1.0 - xi)).exp() - series.fall * xi;
            assert!((series.force(phase) - scale * branch).abs() < 0.06);
        }
    }

    #[test]
    fn each_branch_breaks_away_once() {
        // Falls from the tip to breakaway, rises from there on; near the end ripples of the cut series are smaller
        // than 0.05 N.
        let series = Series::reference();
        let forces: Vec<f64> = (0..=2000).map(|j| series.force(PI * f64::from(j) / 2000.0)).collect();
        let lowest = forces.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
        assert!((300..600).contains(&lowest), "{lowest}");
        assert!(forces[..lowest].windows(2).all(|pair| pair[1] < pair[0]));
        assert!(forces[lowest..].windows(2).all(|pair| pair[1] > pair[0] - 0.05));
    }

    #[test]
    fn the_branches_never_cross() {
        for alpha in [0.1, 0.25, 0.5, 0.75, 1.0] {
            assert!(Series::at(alpha).passive());
        }
    }

    #[test]
    fn the_family_agrees_with_both_laws() {
        let reference = Series::at(1.0).to_loop(1.0).unwrap();
        assert!((reference.force_amplitude() - 12.0).abs() < 1e-12);
        for alpha in [0.1, 0.4, 0.7] {
            let one = Series::at(alpha).to_loop(alpha).unwrap();
            assert!((one.phase() - PI - PhaseLaw::default().value(alpha)).abs() < 1e-12);
            let ratio = one.force(0.0) / reference.force(0.0);
            let law = MagnitudeLaw::default();
            assert!((ratio - law.value(alpha) / law.value(1.0)).abs() < 1e-12);
        }
    }
}
