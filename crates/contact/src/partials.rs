//! A number with its derivatives to a few inputs: one step of a slider through these gives the coefficients of its recursion.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::Real;

/// A value and its P partial derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Partials<const P: usize> {
    pub(crate) value: f64,
    pub(crate) slopes: [f64; P],
}

impl<const P: usize> Partials<P> {
    /// Input number `index`.
    pub(crate) fn input(value: f64, index: usize) -> Self {
        Self { value, slopes: from_fn(|i| if i == index { 1.0 } else { 0.0 }) }
    }

    /// A function of two numbers with this value and these derivatives here.
    #[inline(always)]
    fn with(self, other: Self, value: f64, first: f64, second: f64) -> Self {
        Self { value, slopes: from_fn(|i| self.slopes[i] * first + other.slopes[i] * second) }
    }

    /// A function of one number with this value and derivative here.
    #[inline(always)]
    fn through(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|s| s * slope) }
    }
}

impl<const P: usize> From<f64> for Partials<P> {
    fn from(value: f64) -> Self {
        Self { value, slopes: [0.0; P] }
    }
}

impl<const P: usize> Add for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slopes: from_fn(|i| self.slopes[i] + other.slopes[i]) }
    }
}

impl<const P: usize> Sub for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slopes: from_fn(|i| self.slopes[i] - other.slopes[i]) }
    }
}

impl<const P: usize> Mul for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, self.value * other.value, other.value, self.value)
    }
}

impl<const P: usize> Div for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (value, per) = (self.value / other.value, 1.0 / other.value);
        self.with(other, value, per, -value * per)
    }
}

impl<const P: usize> Neg for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.through(-self.value, -1.0)
    }
}

impl<const P: usize> Mul<f64> for Partials<P> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.through(self.value * factor, factor)
    }
}

impl<const P: usize> Real for Partials<P> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, 0.5 / root)
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.through(value, value)
    }

    fn ln_1p(self) -> Self {
        self.through(self.value.ln_1p(), 1.0 / (1.0 + self.value))
    }

    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.through(value, 1.0 - value * value)
    }
}
