//! Backbones (first loading curves) of Iwan laws, and the branches that Masing's rule makes of them.

use crate::law::FirstHarmonic;
use crate::logarithmic::Logarithmic;
use crate::masing::Shape;
use crate::masing_tangent::{Growth, Local};
use crate::place::{Direction, Place};
use crate::polygon::Polygon;
use crate::real::Real;

/// A concave curve f(x), x ≥ 0, f(0) = 0: the force of a stack of sliders and a spring that is loaded from rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Backbone {
    /// Infinitely many sliders, from the magnitude law.
    Logarithmic(Logarithmic),
    /// Finitely many.
    Polygon(Polygon),
}

impl Backbone {
    /// f(x) in N for x ≥ 0 in m.
    #[inline]
    pub(crate) fn value<T: Real>(&self, x: T) -> T {
        match self {
            Self::Logarithmic(curve) => curve.value(x),
            Self::Polygon(curve) => curve.value(x),
        }
    }

    /// f'(x) in N/m.
    #[inline]
    pub(crate) fn slope(&self, x: f64) -> f64 {
        match self {
            Self::Logarithmic(curve) => curve.slope(x),
            Self::Polygon(curve) => curve.slope(x),
        }
    }

    /// Slope where every slider slips, in N/m: the spring beside them.
    pub(crate) fn spring(&self) -> f64 {
        match self {
            Self::Logarithmic(curve) => curve.spring(),
            Self::Polygon(curve) => curve.spring(),
        }
    }

    /// Displacement in m beyond which every slider slips.
    pub(crate) fn end(&self) -> f64 {
        match self {
            Self::Logarithmic(curve) => curve.end,
            Self::Polygon(curve) => curve.end(),
        }
    }

    /// Displacement in m at which the force is `force`, up to the force at [`Backbone::end`].
    pub(crate) fn reaching(&self, force: f64) -> f64 {
        match self {
            Self::Logarithmic(curve) => curve.length * (force / curve.force).exp_m1(),
            Self::Polygon(curve) => curve.reaching(force),
        }
    }

    pub(crate) fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        match self {
            Self::Logarithmic(curve) => curve.first_harmonic(a),
            Self::Polygon(curve) => curve.first_harmonic(a),
        }
    }
}

/// A stack of sliders and a spring during a motion of amplitude `a` about `mid`.
///
/// The branches follow Masing's rule, ±f(a) at the tips and 2 f(x/2) from there. Relative to a motion about zero
/// there is an offset: the spring holds k mid, and every slider that never slips rests, as in
/// [`ElasticCoulomb`](crate::ElasticCoulomb), at the mean displacement held to within (yield displacement − a) of the
/// middle. With e = mean − mid and the density −f'' of the sliders that is, in sum,
///
/// ```text
/// offset = k mid − sign(e) ∫_a^∞ −f''(y) min(|e|, y − a) dy = k mid − sign(e) [f(a + |e|) − f(a) − k |e|]
/// ```
pub(crate) struct Stack<'a, T> {
    backbone: &'a Backbone,
    a: T,
    offset: T,
    /// e in m.
    aside: f64,
}

impl<'a, T: Real> Stack<'a, T> {
    /// All in m.
    pub(crate) fn new(backbone: &'a Backbone, a: T, mid: T, mean: T) -> Self {
        let e = mean - mid;
        let side = if e.value() < 0.0 { -1.0 } else { 1.0 };
        let distance = e * side;
        let k = backbone.spring();
        let resting = backbone.value(a + distance) - backbone.value(a) - distance * k;
        Self { backbone, a, offset: mid * k - resting * side, aside: e.value() }
    }
}

impl<T: Real> Shape<T> for Stack<'_, T> {
    /// The distance p from the tip in amplitudes.
    type Spot = T;

    fn is_odd(&self) -> bool {
        true
    }

    fn tip(&self, direction: Direction) -> T {
        // The branch that unloads begins at +f(a).
        self.offset - self.backbone.value(self.a) * direction.sign()
    }

    #[inline(always)]
    fn spot(_direction: Direction, place: Place<T>) -> T {
        place.gone
    }

    fn evaluate(&self, spots: &[T], values: &mut [T]) {
        let half = self.a * 0.5;
        for (value, &p) in values.iter_mut().zip(spots) {
            *value = self.backbone.value(p * half) * 2.0;
        }
    }

    #[inline(always)]
    fn change_to(&self, _direction: Direction, value: T) -> T {
        value
    }
}

impl Stack<'_, f64> {
    /// ∂ offset/∂ mean, in N/m.
    pub(crate) fn by_mean(&self) -> f64 {
        self.backbone.spring() - self.backbone.slope(self.a + self.aside.abs())
    }
}

/// A backbone does not change with the amplitude: S = 2 f(p a/2), so κ = f'(p a/2) and S_a − S_p p/a = 0.
pub(crate) struct Unchanging;

impl Growth<Stack<'_, f64>> for Unchanging {
    fn tip(&self, stack: &Stack<f64>, direction: Direction) -> [f64; 2] {
        let at_amplitude = stack.backbone.slope(stack.a);
        let by_mid = stack.backbone.slope(stack.a + stack.aside.abs());
        let side = if stack.aside < 0.0 { -1.0 } else { 1.0 };
        let by_amplitude = -direction.sign() * at_amplitude - side * (by_mid - at_amplitude);
        [0.5 * (by_mid + by_amplitude), 0.5 * (by_mid - by_amplitude)]
    }

    fn local(&self, stack: &Stack<f64>, _direction: Direction, place: Place<f64>, a: f64) -> Local {
        let half = 0.5 * a * place.gone;
        Local { kappa: stack.backbone.slope(half), amplitude: 0.0, change: 2.0 * stack.backbone.value(half) }
    }

    fn evaluate(
        &self,
        stack: &Stack<f64>,
        spots: &[f64],
        kappa: &mut [f64],
        amplitude: &mut [f64],
        _change: &mut [f64],
    ) {
        amplitude.fill(0.0);
        for (kappa, p) in kappa.iter_mut().zip(spots) {
            *kappa = stack.backbone.slope(0.5 * stack.a * p);
        }
    }

    #[inline(always)]
    fn finish(
        &self,
        _stack: &Stack<f64>,
        _direction: Direction,
        _spot: f64,
        _per_amplitude: f64,
        _at_tip: bool,
        raw: Local,
    ) -> Local {
        raw
    }

    #[inline(always)]
    fn near_tip(_spot: f64) -> bool {
        false
    }

    /// κ is finite everywhere.
    fn slope_at_tip(&self, _stack: &Stack<f64>, _direction: Direction) -> f64 {
        0.0
    }
}
