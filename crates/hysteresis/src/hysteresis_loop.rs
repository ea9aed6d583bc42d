//! One friction hysteresis loop as a Fourier series over loop phase.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::error::LoopError;

/// One friction hysteresis loop in rig convention: force in N and displacement in m over the loop phase θ in rad,
///
/// ```math
/// f(\theta) = \operatorname{Re} \sum_{k=0}^{K} F_k \,\mathrm e^{\mathrm i k \theta}, \qquad w(\theta) = a \cos \theta
/// ```
///
/// (Hoffmann et al. 2017, section 3: the measured hysteresis decomposed into its Fourier series; here one-sided and over
/// loop phase).
///
/// θ from 0 to π is the unloading branch, from −π to 0 the loading branch. Because `f` is the force the rig
/// applies, $`\oint f\,\mathrm dw = \pi a \operatorname{Im} F_1 > 0`$; the force on a vibrating body has the opposite sign.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    displacement_amplitude: f64,
    coefficients: Vec<Complex64>,
}

impl Loop {
    /// A loop of displacement amplitude `a` > 0 \[m\] (half peak-to-peak) with the one-sided complex
    /// amplitudes `F_k` \[N\] of the force, `coefficients[k]` being harmonic `k` = 0..=K. Zeros at the end
    /// are dropped.
    ///
    /// # Errors
    /// An amplitude that is not positive, numbers that are not finite, a mean that is not real, no harmonic
    /// 1, or `Im F_1 ≤ 0`: such a loop would create energy.
    pub fn new(displacement_amplitude: f64, mut coefficients: Vec<Complex64>) -> Result<Self, LoopError> {
        if !(displacement_amplitude.is_finite() && displacement_amplitude > 0.0) {
            return Err(LoopError::Amplitude(displacement_amplitude));
        }
        if let Some(k) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(LoopError::NotFinite(k));
        }
        if let Some(mean) = coefficients.first()
            && mean.im != 0.0
        {
            return Err(LoopError::MeanNotReal(mean.im));
        }
        let first = coefficients.get(1).copied().unwrap_or_default();
        if first == Complex64::ZERO {
            return Err(LoopError::NoFirstHarmonic);
        }
        if first.im <= 0.0 {
            let dissipation = PI * displacement_amplitude * first.im;
            return Err(LoopError::CreatesEnergy { imaginary: first.im, dissipation });
        }
        while coefficients.last() == Some(&Complex64::ZERO) {
            coefficients.pop();
        }
        Ok(Self { displacement_amplitude, coefficients })
    }

    /// Displacement amplitude `a` \[m\], half peak-to-peak.
    #[must_use]
    pub fn displacement_amplitude(&self) -> f64 {
        self.displacement_amplitude
    }

    /// One-sided complex amplitudes `F_k` \[N\] of the force; the index is the harmonic, 0 the mean.
    #[must_use]
    pub fn coefficients(&self) -> &[Complex64] {
        &self.coefficients
    }

    /// The first harmonic `F_1` \[N\].
    #[must_use]
    pub fn first_harmonic(&self) -> Complex64 {
        self.coefficients.get(1).copied().unwrap_or_default()
    }

    /// Magnitude of the first harmonic, `|F_1|` \[N\].
    #[must_use]
    pub fn force_amplitude(&self) -> f64 {
        self.first_harmonic().norm()
    }

    /// Phase of the first harmonic, `arg F_1` \[rad\], between 0 (a spring) and π; π/2 is a loop without
    /// stiffness.
    #[must_use]
    pub fn phase(&self) -> f64 {
        self.first_harmonic().arg()
    }

    /// Even content `√(Σ_{k=2,4,…} |F_k|²) / |F_1|` \[-\]: how far the loop is from symmetric about its
    /// centre. The mean is left out.
    #[must_use]
    pub fn even_content(&self) -> f64 {
        self.content(2)
    }

    /// Content of the odd harmonics above the first, `√(Σ_{k=3,5,…} |F_k|²) / |F_1|` \[-\]: how far the
    /// loop is from an ellipse.
    #[must_use]
    pub fn odd_content(&self) -> f64 {
        self.content(3)
    }

    fn content(&self, from: usize) -> f64 {
        // A sum of nothing would be −0.
        let squares = self.coefficients.iter().skip(from).step_by(2).map(Complex64::norm_sqr);
        squares.fold(0.0, |sum, square| sum + square).sqrt() / self.force_amplitude()
    }

    /// Force `f(θ)` \[N\] at loop phase `theta` \[rad\].
    #[must_use]
    pub fn force(&self, theta: f64) -> f64 {
        evaluate(&self.coefficients, theta)
    }

    /// First derivative `df/dθ` \[N/rad\] at loop phase `theta` \[rad\].
    #[must_use]
    pub fn force_derivative(&self, theta: f64) -> f64 {
        let weighted = |(k, c): (usize, &Complex64)| Complex64::I * (k as f64) * c;
        series(self.coefficients.iter().enumerate().map(weighted), theta)
    }

    /// Second derivative `d²f/dθ²` \[N/rad²\] at loop phase `theta` \[rad\].
    #[must_use]
    pub fn force_second_derivative(&self, theta: f64) -> f64 {
        let weighted = |(k, c): (usize, &Complex64)| -((k * k) as f64) * c;
        series(self.coefficients.iter().enumerate().map(weighted), theta)
    }

    /// Dissipation `∮ f dw = π a Im F_1` \[J per cycle\], positive.
    #[must_use]
    pub fn dissipation(&self) -> f64 {
        PI * self.displacement_amplitude * self.first_harmonic().im
    }

    /// The loop's odd part: even harmonics and the mean set to zero, so that it is symmetric about its
    /// centre, `f(θ + π) = −f(θ)`. Dissipation and first harmonic stay the same.
    #[must_use]
    pub fn odd_part(&self) -> Self {
        let odd = |(k, c): (usize, &Complex64)| if k % 2 == 1 { *c } else { Complex64::ZERO };
        let mut coefficients: Vec<Complex64> = self.coefficients.iter().enumerate().map(odd).collect();
        while coefficients.last() == Some(&Complex64::ZERO) {
            coefficients.pop();
        }
        Self { displacement_amplitude: self.displacement_amplitude, coefficients }
    }
}

/// `Re Σ_k c_k e^{ikθ}`.
pub(crate) fn evaluate(coefficients: &[Complex64], theta: f64) -> f64 {
    series(coefficients.iter().copied(), theta)
}

/// `Re Σ_k c_k e^{ikθ}` by Horner's rule in `e^{iθ}`, from the highest harmonic down.
fn series(coefficients: impl DoubleEndedIterator<Item = Complex64>, theta: f64) -> f64 {
    let turn = Complex64::cis(theta);
    coefficients.rev().fold(Complex64::ZERO, |sum, c| sum * turn + c).re
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Loop {
        let c = Complex64::new;
        Loop::new(2e-6, vec![c(0.5, 0.0), c(1.0, 2.0), c(0.1, -0.2), c(-0.3, 0.4)]).unwrap()
    }

    #[test]
    fn force_and_derivatives_are_the_written_out_sum() {
        let (f, t) = (example(), 0.7_f64);
        let force = 0.5 + t.cos() - 2.0 * t.sin() + 0.1 * (2.0 * t).cos() + 0.2 * (2.0 * t).sin()
            - 0.3 * (3.0 * t).cos()
            - 0.4 * (3.0 * t).sin();
        let first =
            -t.sin() - 2.0 * t.cos() - 0.2 * (2.0 * t).sin() + 0.4 * (2.0 * t).cos() + 0.9 * (3.0 * t).sin()
                - 1.2 * (3.0 * t).cos();
        let second = -t.cos() + 2.0 * t.sin() - 0.4 * (2.0 * t).cos() - 0.8 * (2.0 * t).sin()
            + 2.7 * (3.0 * t).cos()
            + 3.6 * (3.0 * t).sin();
        assert!((f.force(t) - force).abs() < 1e-14);
        assert!((f.force_derivative(t) - first).abs() < 1e-14);
        assert!((f.force_second_derivative(t) - second).abs() < 1e-13);
    }

    #[test]
    fn dissipation_is_the_area_of_the_loop() {
        // Trapezoid rule over a periodic integrand: exact for a trigonometric polynomial.
        let (f, n) = (example(), 64);
        let area: f64 = (0..n)
            .map(|j| 2.0 * PI * f64::from(j) / f64::from(n))
            .map(|t| f.force(t) * -2e-6 * t.sin() * 2.0 * PI / f64::from(n))
            .sum();
        assert!((f.dissipation() - area).abs() < 1e-18, "{} {area}", f.dissipation());
    }

    #[test]
    fn odd_part_changes_sign_after_half_a_turn_and_keeps_the_dissipation() {
        let odd = example().odd_part();
        for t in [0.0, 0.3, 2.0] {
            assert!((odd.force(t) + odd.force(t + PI)).abs() < 1e-14);
        }
        assert_eq!(odd.dissipation(), example().dissipation());
        assert!(odd.even_content() == 0.0 && odd.even_content().is_sign_positive());
        assert!((example().even_content() - 0.05_f64.sqrt() / 5.0_f64.sqrt()).abs() < 1e-15);
        assert!((example().odd_content() - 0.5 / 5.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_loop_is_refused() {
        let c = Complex64::new;
        let one = |f1| vec![c(0.0, 0.0), f1];
        assert_eq!(Loop::new(0.0, one(c(0.0, 1.0))), Err(LoopError::Amplitude(0.0)));
        assert!(matches!(Loop::new(f64::NAN, one(c(0.0, 1.0))), Err(LoopError::Amplitude(_))));
        assert_eq!(Loop::new(1.0, one(c(f64::NAN, 1.0))), Err(LoopError::NotFinite(1)));
        assert_eq!(Loop::new(1.0, vec![c(0.0, 1.0), c(0.0, 1.0)]), Err(LoopError::MeanNotReal(1.0)));
        assert_eq!(Loop::new(1.0, vec![]), Err(LoopError::NoFirstHarmonic));
        assert_eq!(Loop::new(1.0, one(c(0.0, 0.0))), Err(LoopError::NoFirstHarmonic));
        assert!(matches!(Loop::new(1.0, one(c(1.0, -1.0))), Err(LoopError::CreatesEnergy { .. })));
        assert!(matches!(Loop::new(1.0, one(c(1.0, 0.0))), Err(LoopError::CreatesEnergy { .. })));
    }
}
