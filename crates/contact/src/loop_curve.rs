//! The branches of one friction loop, as force drop from the upper tip and force rise from the lower one.
//!
//! A loop `L(θ) = Re Σ c_k e^{ikθ}` over loop phase is evaluated without any arc cosine: with the distance
//! p ∈ [0, 2] from a tip in units of the amplitude, e^{iθ} = (1 − p) + i √(p (2 − p)) on the unloading branch, and the
//! negative of that on the loading branch.

use num_complex::{Complex, Complex64};

use crate::real::Real;

/// Which way the displacement goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From an upper turning point down.
    Unloading,
    /// From a lower turning point up.
    Loading,
}

impl Direction {
    pub(crate) fn reversed(self) -> Self {
        match self {
            Self::Unloading => Self::Loading,
            Self::Loading => Self::Unloading,
        }
    }

    /// Sign of the force change along the branch.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Unloading => -1.0,
            Self::Loading => 1.0,
        }
    }
}

/// Where on a branch: distance from the tip it starts at, in amplitudes, and what is left of the full range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<T> {
    /// p = |w − w_tip| / a, in [0, 2].
    pub(crate) gone: T,
    /// 2 − p, given apart so that neither end suffers from cancellation.
    pub(crate) left: T,
}

/// The force over loop phase at one amplitude, `L(θ) = Re Σ c_k e^{ikθ}`.
#[derive(Debug, Clone, Default)]
pub(crate) struct LoopCurve<T> {
    /// c_k, index k = 0 … K, in N.
    coefficients: Vec<Complex<T>>,
    /// Even coefficients are all zero, so that powers of z² do.
    odd: bool,
    /// L(0), force at the upper tip.
    pub(crate) upper: T,
    /// L(π), force at the lower tip.
    pub(crate) lower: T,
}

impl<T: Real> LoopCurve<T> {
    /// e^{iθ} at a place.
    #[inline]
    fn unit(direction: Direction, place: Place<T>) -> Complex<T> {
        let cos =
            if place.gone.value() < 1.0 { T::from(1.0) - place.gone } else { place.left - T::from(1.0) };
        let product = place.gone * place.left;
        // The derivative of √ at 0 is infinite; a tip itself carries none.
        let sin = if product.value() > 0.0 { product.sqrt() } else { T::from(0.0) };
        match direction {
            Direction::Unloading => Complex { re: cos, im: sin },
            Direction::Loading => Complex { re: -cos, im: -sin },
        }
    }

    /// L at e^{iθ} = z, by Horner's rule.
    #[inline]
    fn at(&self, z: Complex<T>) -> T {
        let zero = Complex { re: T::from(0.0), im: T::from(0.0) };
        let mut sum = zero;
        if self.odd {
            let square = multiply(z, z);
            for &c in self.coefficients.iter().skip(1).step_by(2).rev() {
                sum = multiply(sum, square);
                sum = Complex { re: sum.re + c.re, im: sum.im + c.im };
            }
            sum = multiply(sum, z);
        } else {
            for &c in self.coefficients.iter().rev() {
                sum = multiply(sum, z);
                sum = Complex { re: sum.re + c.re, im: sum.im + c.im };
            }
        }
        sum.re
    }

    /// Replaces the coefficients; `odd` says that those of even index are zero.
    pub(crate) fn set(&mut self, coefficients: impl Iterator<Item = Complex<T>>, odd: bool) {
        self.coefficients.clear();
        self.coefficients.extend(coefficients);
        self.odd = odd;
        self.upper = self.at(Complex { re: T::from(1.0), im: T::from(0.0) });
        self.lower = self.at(Complex { re: -T::from(1.0), im: T::from(0.0) });
    }

    /// Whether the two branches mirror each other.
    pub(crate) fn is_odd(&self) -> bool {
        self.odd
    }

    /// Magnitude of the force change since the tip: D(p) = L(0) − L(θ) unloading, U(p) = L(θ) − L(π) loading.
    #[inline]
    pub(crate) fn change(&self, direction: Direction, place: Place<T>) -> T {
        let force = self.at(Self::unit(direction, place));
        match direction {
            Direction::Unloading => self.upper - force,
            Direction::Loading => force - self.lower,
        }
    }
}

#[inline(always)]
fn multiply<T: Real>(a: Complex<T>, b: Complex<T>) -> Complex<T> {
    Complex { re: a.re * b.re - a.im * b.im, im: a.re * b.im + a.im * b.re }
}

impl LoopCurve<f64> {
    /// dL/dθ at e^{iθ} = z: Re Σ i k c_k z^k.
    fn slope(&self, z: Complex64) -> f64 {
        let mut sum = Complex64::ZERO;
        if self.odd {
            let square = z * z;
            let count = self.coefficients.len() / 2;
            let mut k = (2 * count) as f64 - 1.0;
            for &c in self.coefficients.iter().skip(1).step_by(2).rev() {
                sum = sum * square + k * c;
                k -= 2.0;
            }
            sum *= z;
        } else {
            let mut k = self.coefficients.len() as f64 - 1.0;
            for &c in self.coefficients.iter().rev() {
                sum = sum * z + k * c;
                k -= 1.0;
            }
        }
        -sum.im
    }

    /// dD/dp or dU/dp. Infinite at the tips of a loop with rounded ends.
    pub(crate) fn stiffness(&self, direction: Direction, place: Place<f64>) -> f64 {
        let z = Self::unit(direction, place);
        // Unloading: θ' = 1/sin θ and D' = −L_θ θ'; loading: θ' = −1/sin θ with sin θ < 0 and U' = L_θ θ'.
        -self.slope(z) / z.im
    }

    /// dL/dθ at the upper tip (unloading) or the lower tip (loading), in N.
    pub(crate) fn slope_at_tip(&self, direction: Direction) -> f64 {
        match direction {
            Direction::Unloading => self.slope(Complex64::ONE),
            Direction::Loading => self.slope(-Complex64::ONE),
        }
    }
}
