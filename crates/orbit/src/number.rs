//! Numbers that series are computed with: plain ones, and pairs that carry a first derivative along.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or one with its derivative.
pub(crate) trait Number:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The square root.
    fn sqrt(self) -> Self;
}

impl Number for f64 {
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
}

/// `value + ε change` with ε² = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    pub(crate) value: f64,
    pub(crate) change: f64,
}

impl From<f64> for Pair {
    fn from(value: f64) -> Self {
        Self { value, change: 0.0 }
    }
}

impl Add for Pair {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, change: self.change + other.change }
    }
}

impl Sub for Pair {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, change: self.change - other.change }
    }
}

impl Mul for Pair {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            change: self.change * other.value + self.value * other.change,
        }
    }
}

impl Div for Pair {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, change: (self.change - value * other.change) / other.value }
    }
}

impl Neg for Pair {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, change: -self.change }
    }
}

impl Number for Pair {
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self { value, change: 0.5 * self.change / value }
    }
}
