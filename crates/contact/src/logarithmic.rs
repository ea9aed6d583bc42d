//! The backbone that belongs to the paper's magnitude law, and its describing function in closed form.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::law::FirstHarmonic;
use crate::real::Real;
use crate::turning_points::angle_minus_sine;

/// f(x) = C ln(1 + x/b) up to x_m, from there on with the slope k = C/(x_m + b).
///
/// It is F* (g(x/W*) − g(0)) with g of eq. (6): C = 0.21 F*, b = 0.01 W*. As a stack of sliders it has the stiffness
/// density −f''(y) = C/(y + b)² over the yield displacement y ∈ (0, x_m), and a spring k beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Logarithmic {
    /// C in N.
    pub(crate) force: f64,
    /// b in m.
    pub(crate) length: f64,
    /// x_m in m.
    pub(crate) end: f64,
}

impl Logarithmic {
    /// k in N/m.
    pub(crate) fn spring(&self) -> f64 {
        self.force / (self.end + self.length)
    }

    /// f(x) for x ≥ 0.
    #[inline]
    pub(crate) fn value<T: Real>(&self, x: T) -> T {
        let log = |x: T| (x * (1.0 / self.length)).ln_1p() * self.force;
        if x.value() <= self.end {
            return log(x);
        }
        log(T::from(self.end)) + (x - T::from(self.end)) * self.spring()
    }

    /// f'(x) for x ≥ 0.
    #[inline]
    pub(crate) fn slope(&self, x: f64) -> f64 {
        self.force / (x.min(self.end) + self.length)
    }

    /// F_1(a) and dF_1/da of the loop that Masing's rule makes of the backbone,
    /// `f(τ) = f(a) − 2 f(a (1 − cos τ)/2)` for w = a cos τ, 0 ≤ τ ≤ π.
    ///
    /// Up to x_m, with r = a/b and A − B cos τ = 1 + (r/2)(1 − cos τ):
    ///
    /// * in phase, `Re F_1 = −(4/π) ∫_0^π f(a (1 − cos τ)/2) cos τ dτ`. From the Fourier series
    ///   `ln(A − B cos τ) = const − 2 Σ qⁿ cos(nτ)/n` with `q = (A − √(A² − B²))/B = (√(1+r) − 1)/(√(1+r) + 1)`,
    ///   `Re F_1 = 4 C q` (and 4 C qᵏ/k for every odd k);
    /// * in quadrature, with y = a (1 − cos τ)/2, `Im F_1 = (4/π) [(2/a) ∫_0^a f dy − f(a)]`, which is
    ///   `(4 C/π) [(1 + 2/r) ln(1 + r) − 2] = (8 C/π) [artanh(u)/u − 1]` with u = r/(r + 2): no cancellation.
    ///
    /// Beyond x_m, as the sum of the sliders' describing functions over their density, θ_m = arccos(1 − 2 x_m/a):
    ///
    /// * in quadrature, `(4/π) ∫_0^{x_m} (C/(y+b)²) y (1 − y/a) dy`;
    /// * in phase, integrated by parts with f' = C/(y + b) and y = a (1 − cos θ)/2,
    ///   `k a [1 − (θ_m − ½ sin 2θ_m)/π] + (4 C/π) ∫_0^{θ_m} sin²θ/(A' − cos θ) dθ`, A' = 1 + 2 b/a, whose integral is
    ///   `sin θ_m + A' θ_m − 2 √(A'² − 1) arctan(√(1 + r) tan(θ_m/2))`. In its derivative the terms of δθ_m cancel.
    pub(crate) fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        if a <= self.end { self.within(a) } else { self.beyond(a) }
    }

    fn within(&self, a: f64) -> FirstHarmonic {
        let (c, b) = (self.force, self.length);
        let root = (1.0 + a / b).sqrt();
        let q = a / b / ((root + 1.0) * (root + 1.0));
        let u = a / (a + 2.0 * b);
        let excess = artanh_excess(u);
        // d/du of artanh(u)/u − 1, and 1 − u² = 4 b (a + b)/(a + 2b)².
        let slope = if u > 0.0 { (a * a / (4.0 * b * (a + b)) - excess) / u } else { 0.0 };
        let du = 2.0 * b / ((a + 2.0 * b) * (a + 2.0 * b));
        FirstHarmonic {
            force: Complex64::new(4.0 * c * q, 8.0 * c / PI * excess),
            derivative: Complex64::new(c * (1.0 - q * q) / (a + b), 8.0 * c / PI * slope * du),
        }
    }

    fn beyond(&self, a: f64) -> FirstHarmonic {
        let (c, b, end, k) = (self.force, self.length, self.end, self.spring());
        // ∫ y/(y+b)² and ∫ y²/(y+b)² over the sliders.
        let r = end / b;
        let (log, part) = (r.ln_1p(), end / (end + b));
        let (one, two) = (log - part, b * (r - 2.0 * log + part));
        let theta = 2.0 * (end / a).sqrt().asin();
        let sine = 2.0 * (end * (a - end)).sqrt() / a;
        let sliding = angle_minus_sine(2.0 * theta) / (2.0 * PI);
        let outer = 1.0 + 2.0 * b / a;
        let root = 2.0 * (b * (a + b)).sqrt() / a;
        let turn = f64::atan2((end * (1.0 + a / b)).sqrt(), (a - end).sqrt());
        let integral = sine + outer * theta - 2.0 * root * turn;
        // ∂/∂A', with ∂A'/∂a = −2 b/a².
        let product = (end * (a - end)).sqrt() / (a - end + (1.0 + a / b) * end);
        let by_outer = theta - 2.0 * outer / root * turn + a / b * product;
        FirstHarmonic {
            force: Complex64::new(
                k * a * (1.0 - sliding) + 4.0 * c / PI * integral,
                4.0 * c / PI * (one - two / a),
            ),
            derivative: Complex64::new(
                k * (1.0 - sliding) - 4.0 * c / PI * by_outer * 2.0 * b / (a * a),
                4.0 * c / PI * two / (a * a),
            ),
        }
    }
}

/// artanh(u)/u − 1 for 0 ≤ u < 1.
fn artanh_excess(u: f64) -> f64 {
    if u > 0.3 {
        return u.atanh() / u - 1.0;
    }
    // Σ u^{2m}/(2m+1), m ≥ 1; the 17th term is below the rounding error of the first.
    let y = u * u;
    (1..=17).rev().fold(0.0, |sum, m| y * (1.0 / f64::from(2 * m + 1) + sum))
}
