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

/// Points evaluated side by side, so that the dependent steps of Horner's rule overlap.
const LANES: usize = 8;

/// `Re Σ c_k z^k` on the unit circle, by Horner's rule; of odd k alone in powers of z².
#[derive(Debug, Clone)]
pub(crate) struct Series<T> {
    /// c_0, c_1, c_2, … or, when odd, c_1, c_3, c_5, …
    coefficients: Vec<Complex<T>>,
    odd: bool,
}

impl<T: Real> Series<T> {
    /// Zero everywhere.
    fn new() -> Self {
        Self { coefficients: Vec::new(), odd: false }
    }

    /// Replaces the coefficients c_0, c_1, …; `odd` says that those of even index are zero.
    fn set(&mut self, coefficients: impl Iterator<Item = Complex<T>>, odd: bool) {
        let (skip, step) = if odd { (1, 2) } else { (0, 1) };
        self.coefficients.clear();
        self.coefficients.extend(coefficients.skip(skip).step_by(step));
        self.odd = odd;
    }

    /// The value at one z.
    fn at(&self, z: Complex<T>) -> T {
        let mut value = [T::from(0.0)];
        self.lanes(&[z], &mut value);
        value[0]
    }

    /// The values at all `units`, into `values` of the same length.
    pub(crate) fn evaluate(&self, units: &[Complex<T>], values: &mut [T]) {
        let (chunks, rest) = units.as_chunks::<LANES>();
        let (value_chunks, value_rest) = values.as_chunks_mut::<LANES>();
        for (z, value) in chunks.iter().zip(value_chunks) {
            self.lanes(z, value);
        }
        for (z, value) in rest.iter().zip(value_rest) {
            self.lanes(&[*z], std::array::from_mut(value));
        }
    }

    #[inline(always)]
    fn lanes<const N: usize>(&self, units: &[Complex<T>; N], values: &mut [T; N]) {
        let (mut zr, mut zi) = (units.map(|z| z.re), units.map(|z| z.im));
        if self.odd {
            for l in 0..N {
                let (re, im) = (zr[l], zi[l]);
                zr[l] = re * re - im * im;
                zi[l] = (re * im) * 2.0;
            }
        }
        let (mut sr, mut si) = ([T::from(0.0); N], [T::from(0.0); N]);
        for c in self.coefficients.iter().rev() {
            for l in 0..N {
                let re = sr[l] * zr[l] - si[l] * zi[l] + c.re;
                si[l] = sr[l] * zi[l] + si[l] * zr[l] + c.im;
                sr[l] = re;
            }
        }
        for l in 0..N {
            values[l] = if self.odd { sr[l] * units[l].re - si[l] * units[l].im } else { sr[l] };
        }
    }
}

/// The force over loop phase at one amplitude, `L(θ) = Re Σ c_k e^{ikθ}`.
#[derive(Debug, Clone)]
pub(crate) struct LoopCurve<T> {
    pub(crate) force: Series<T>,
    /// dL/dθ = Re Σ i k c_k e^{ikθ}.
    pub(crate) slope: Series<T>,
    /// L(0), force at the upper tip.
    pub(crate) upper: T,
    /// L(π), force at the lower tip.
    pub(crate) lower: T,
}

impl<T: Real> LoopCurve<T> {
    /// No force at all.
    pub(crate) fn new() -> Self {
        Self { force: Series::new(), slope: Series::new(), upper: T::from(0.0), lower: T::from(0.0) }
    }

    /// Replaces the coefficients c_0, c_1, …; `odd` says that those of even index are zero.
    pub(crate) fn set(&mut self, coefficients: impl Iterator<Item = Complex<T>> + Clone, odd: bool) {
        let slopes = coefficients
            .clone()
            .enumerate()
            .map(|(k, c)| Complex { re: -c.im * k as f64, im: c.re * k as f64 });
        self.slope.set(slopes, odd);
        self.force.set(coefficients, odd);
        self.upper = self.force.at(Complex { re: T::from(1.0), im: T::from(0.0) });
        self.lower = self.force.at(Complex { re: -T::from(1.0), im: T::from(0.0) });
    }

    /// Whether the two branches mirror each other.
    pub(crate) fn is_odd(&self) -> bool {
        self.force.odd
    }

    /// Magnitude of the force change since the tip: D(p) = L(0) − L(θ) unloading, U(p) = L(θ) − L(π) loading.
    pub(crate) fn change(&self, direction: Direction, place: Place<T>) -> T {
        self.change_to(direction, self.force.at(place.unit(direction)))
    }

    /// The change that leads to the loop force `force`.
    #[inline(always)]
    pub(crate) fn change_to(&self, direction: Direction, force: T) -> T {
        match direction {
            Direction::Unloading => self.upper - force,
            Direction::Loading => force - self.lower,
        }
    }
}

impl LoopCurve<f64> {
    /// dD/dp or dU/dp. Infinite at the tips of a loop with rounded ends.
    pub(crate) fn stiffness(&self, direction: Direction, place: Place<f64>) -> f64 {
        let z = place.unit(direction);
        stiffness(self.slope.at(z), z)
    }

    /// dL/dθ at the upper tip (unloading) or the lower tip (loading), in N.
    pub(crate) fn slope_at_tip(&self, direction: Direction) -> f64 {
        match direction {
            Direction::Unloading => self.slope.at(Complex64::ONE),
            Direction::Loading => self.slope.at(-Complex64::ONE),
        }
    }
}

/// dD/dp or dU/dp from dL/dθ at e^{iθ} = z. Unloading: θ' = 1/sin θ and D' = −L_θ θ'; loading: θ' = −1/sin θ with
/// sin θ < 0 and U' = L_θ θ'.
#[inline(always)]
pub(crate) fn stiffness(slope: f64, z: Complex64) -> f64 {
    -slope / z.im
}
