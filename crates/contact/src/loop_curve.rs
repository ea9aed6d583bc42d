//! The branches of one friction loop, as force drop from the upper tip and force rise from the lower one.
//!
//! A loop `L(θ) = Re Σ c_k e^{ikθ}` over loop phase is evaluated without any arc cosine: with the distance
//! p ∈ [0, 2] from a tip in units of the amplitude, e^{iθ} = (1 − p) + i √(p (2 − p)) on the unloading branch, and the
//! negative of that on the loading branch.

use num_complex::{Complex, Complex64};

use crate::masing::Shape;
use crate::masing_tangent::{Growth, Local};
use crate::place::{Direction, Place};
use crate::real::Real;

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
        pulp::Arch::new().dispatch(Evaluation { series: self, units, values });
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

/// A series at many points, in the widest registers of the machine.
struct Evaluation<'a, T> {
    series: &'a Series<T>,
    units: &'a [Complex<T>],
    values: &'a mut [T],
}

impl<T: Real> pulp::NullaryFnOnce for Evaluation<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (chunks, rest) = self.units.as_chunks::<LANES>();
        let (value_chunks, value_rest) = self.values.as_chunks_mut::<LANES>();
        for (z, value) in chunks.iter().zip(value_chunks) {
            self.series.lanes(z, value);
        }
        for (z, value) in rest.iter().zip(value_rest) {
            self.series.lanes(&[*z], std::array::from_mut(value));
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
}

/// Branches whose raw values are the forces of the loop: D(p) = L(0) − L(θ) unloading, U(p) = L(θ) − L(π) loading.
impl<T: Real> Shape<T> for LoopCurve<T> {
    /// e^{iθ}.
    type Spot = Complex<T>;

    fn is_odd(&self) -> bool {
        self.force.odd
    }

    fn tip(&self, direction: Direction) -> T {
        match direction {
            Direction::Unloading => self.upper,
            Direction::Loading => self.lower,
        }
    }

    #[inline(always)]
    fn spot(direction: Direction, place: Place<T>) -> Complex<T> {
        place.unit(direction)
    }

    fn evaluate(&self, spots: &[Complex<T>], values: &mut [T]) {
        self.force.evaluate(spots, values);
    }

    #[inline(always)]
    fn change_to(&self, direction: Direction, value: T) -> T {
        match direction {
            Direction::Unloading => self.upper - value,
            Direction::Loading => value - self.lower,
        }
    }
}

/// |sin θ| below which a sample may be on a tip.
const NEAR_TIP: f64 = 1e-3;

/// ∂c_k/∂a, itself a curve: how a loop changes with its amplitude.
impl Growth<LoopCurve<f64>> for LoopCurve<f64> {
    fn tip(&self, _curve: &LoopCurve<f64>, direction: Direction) -> [f64; 2] {
        let growth = Shape::tip(self, direction);
        [0.5 * growth, -0.5 * growth]
    }

    fn local(&self, curve: &LoopCurve<f64>, direction: Direction, place: Place<f64>, a: f64) -> Local {
        let z = place.unit(direction);
        let kappa = stiffness(curve.slope.at(z), z) / a;
        Local {
            kappa,
            amplitude: self.change(direction, place) - kappa * place.gone,
            change: curve.change(direction, place),
        }
    }

    /// κ first holds dL/dθ, g first dL/da, and S first L of every sample.
    fn evaluate(
        &self,
        curve: &LoopCurve<f64>,
        spots: &[Complex64],
        kappa: &mut [f64],
        amplitude: &mut [f64],
        change: &mut [f64],
    ) {
        curve.slope.evaluate(spots, kappa);
        self.force.evaluate(spots, amplitude);
        if !curve.is_odd() {
            curve.force.evaluate(spots, change);
        }
    }

    #[inline(always)]
    fn finish(
        &self,
        curve: &LoopCurve<f64>,
        direction: Direction,
        z: Complex64,
        per_amplitude: f64,
        at_tip: bool,
        raw: Local,
    ) -> Local {
        let gone = match direction {
            Direction::Unloading => 1.0 - z.re,
            Direction::Loading => 1.0 + z.re,
        };
        let kappa = if at_tip || z.im == 0.0 { 0.0 } else { stiffness(raw.kappa, z) * per_amplitude };
        Local {
            kappa,
            amplitude: self.change_to(direction, raw.amplitude) - kappa * gone,
            change: curve.change_to(direction, raw.change),
        }
    }

    #[inline(always)]
    fn near_tip(z: Complex64) -> bool {
        z.im.abs() < NEAR_TIP
    }

    /// dL/dθ at the upper tip (unloading) or the lower tip (loading), in N.
    fn slope_at_tip(&self, curve: &LoopCurve<f64>, direction: Direction) -> f64 {
        match direction {
            Direction::Unloading => curve.slope.at(Complex64::ONE),
            Direction::Loading => curve.slope.at(-Complex64::ONE),
        }
    }
}

/// dD/dp or dU/dp from dL/dθ at e^{iθ} = z. Unloading: θ' = 1/sin θ and D' = −L_θ θ'; loading: θ' = −1/sin θ with
/// sin θ < 0 and U' = L_θ θ'. Infinite at the tips of a loop with rounded ends.
#[inline(always)]
fn stiffness(slope: f64, z: Complex64) -> f64 {
    -slope / z.im
}
