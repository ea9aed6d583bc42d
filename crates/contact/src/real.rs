//! The few operations a force kernel needs of its number type, so that the same kernel runs on `f64` in
//! production and on dual numbers where its derivatives are verified.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number type: `f64`, or one that carries derivatives along.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + From<f64>
{
    /// The plain value, for decisions.
    fn value(self) -> f64;
    /// √x.
    fn sqrt(self) -> Self;
    /// e^x.
    fn exp(self) -> Self;
    /// ln(1 + x).
    fn ln_1p(self) -> Self;
    /// tanh x.
    fn tanh(self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        f64::exp(self)
    }

    #[inline(always)]
    fn ln_1p(self) -> Self {
        f64::ln_1p(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        f64::tanh(self)
    }
}

#[cfg(test)]
impl Real for num_dual::Dual64 {
    fn value(self) -> f64 {
        self.re
    }

    fn sqrt(self) -> Self {
        num_dual::DualNum::sqrt(&self)
    }

    fn exp(self) -> Self {
        num_dual::DualNum::exp(&self)
    }

    fn ln_1p(self) -> Self {
        num_dual::DualNum::ln_1p(&self)
    }

    fn tanh(self) -> Self {
        num_dual::DualNum::tanh(&self)
    }
}
