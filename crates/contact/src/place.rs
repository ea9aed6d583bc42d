//! Where on a branch of a friction loop: its direction, and the distance from the tip it starts at.

use num_complex::Complex;

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
    #[inline(always)]
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

impl<T: Real> Place<T> {
    /// The place at distance `gone`, held to [0, 2].
    #[inline]
    pub(crate) fn at(gone: T) -> Self {
        let gone = if gone.value() < 0.0 { T::from(0.0) } else { gone };
        let left = T::from(2.0) - gone;
        Self { gone, left: if left.value() < 0.0 { T::from(0.0) } else { left } }
    }

    /// The same place seen from the other end.
    #[inline]
    pub(crate) fn reversed(self) -> Self {
        Self { gone: self.left, left: self.gone }
    }

    /// e^{iθ} at this place.
    #[inline]
    pub(crate) fn unit(self, direction: Direction) -> Complex<T> {
        let cos = if self.gone.value() < 1.0 { T::from(1.0) - self.gone } else { self.left - T::from(1.0) };
        let product = self.gone * self.left;
        // The derivative of √ at 0 is infinite; a tip itself carries none.
        let sin = if product.value() > 0.0 { product.sqrt() } else { T::from(0.0) };
        match direction {
            Direction::Unloading => Complex { re: cos, im: sin },
            Direction::Loading => Complex { re: -cos, im: -sin },
        }
    }
}
