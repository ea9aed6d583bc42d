//! Numbers of twice the precision of f64: an unevaluated sum of two (Dekker 1971, Knuth). Some 32 digits, for residuals
//! whose terms cancel.

use std::ops::{Add, Mul, Neg, Sub};

use num_complex::Complex64;

/// `high + low`, |low| at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// 2π to 32 digits.
pub(super) const TAU: DoubleDouble =
    DoubleDouble { high: std::f64::consts::TAU, low: 2.449_293_598_294_706_4e-16 };

impl DoubleDouble {
    pub(super) fn value(self) -> f64 {
        self.high + self.low
    }

    /// `a + b` exactly.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let all = Self::sum(high.high, high.low + low.high);
        Self::sum(all.high, all.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high) + (self.high * other.low + self.low * other.high);
        Self::sum(high, low)
    }
}

/// A complex number of that precision.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Complex {
    pub(super) re: DoubleDouble,
    pub(super) im: DoubleDouble,
}

impl Complex {
    pub(super) fn norm(self) -> f64 {
        self.re.value().hypot(self.im.value())
    }
}

impl From<Complex64> for Complex {
    fn from(z: Complex64) -> Self {
        Self { re: z.re.into(), im: z.im.into() }
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_number_loses_is_kept() {
        let one = DoubleDouble::from(1.0);
        let tiny = DoubleDouble::from(1e-25);
        assert_eq!(((one + tiny) - one).value(), 1e-25);
        // (1 + ε)² − 1 − 2ε = ε²
        let square = (one + tiny) * (one + tiny) - one - tiny - tiny;
        assert!(square.value().abs() < 1e-31);
        let x = DoubleDouble::from(1.0 + f64::EPSILON);
        assert_eq!((x * x - one - DoubleDouble::from(2.0 * f64::EPSILON)).value(), f64::EPSILON.powi(2));
    }

    #[test]
    fn complex_products_are_those_of_their_parts() {
        let product = Complex::from(Complex64::new(1.0, 2.0)) * Complex::from(Complex64::new(3.0, -1.0));
        assert_eq!((product.re.value(), product.im.value()), (5.0, 5.0));
    }
}
