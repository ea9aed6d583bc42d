//! First force harmonics of `w = a cos τ` in N (rig convention), each from its definition.

use std::f64::consts::PI;

use contact::{MagnitudeLaw, PhaseLaw};
use num_complex::Complex64;

use super::motion::gauss;

/// Eqs (6)–(9): `−F* g(α) e^{iψ_C(α)}`.
pub(super) fn scaled_loop(alpha: f64, force: f64, g: &MagnitudeLaw, psi: &PhaseLaw) -> Complex64 {
    // As the law states g: the rounding of g(0) is that of its numbers.
    let magnitude = g.offset + g.slope * g.shift.ln() + g.slope * (alpha / g.shift).ln_1p();
    let phase = psi.limit - psi.span * (-psi.decay * alpha).exp();
    -Complex64::new(phase.cos(), phase.sin()) * force * magnitude
}

/// Spring k in series with a slider that slips at x: `(k/π)(θ* − ½ sin 2θ*)`, `(4 F_s/πa)(1 − x/a)`, θ* = arccos(1 − 2x/a).
pub(super) fn elastic_coulomb(a: f64, k: f64, x: f64) -> Complex64 {
    if a <= x {
        return Complex64::from(k * a);
    }
    let theta = 2.0 * (x / a).sqrt().asin();
    // θ − ½ sin 2θ, by its series where the terms cancel.
    let y = 4.0 * theta * theta;
    let rest = if theta > 0.2 {
        theta - 0.5 * (2.0 * theta).sin()
    } else {
        2.0 / 3.0 * theta.powi(3) * (1.0 - y / 20.0 * (1.0 - y / 42.0 * (1.0 - y / 72.0 * (1.0 - y / 110.0))))
    };
    Complex64::new(k * a / PI * rest, 4.0 * k * x / PI * (1.0 - x / a))
}

/// Masing's loop of the backbone f: `f(a) − 2 f(a (1 − cos τ)/2)` on 0 ≤ τ ≤ π, the negative on the way back.
/// `F_1 = (2/π) ∫_0^π f(τ) e^{−iτ} dτ` by Gauss panels that shrink towards both tips, where a logarithm is nearly singular.
pub(super) fn masing(a: f64, kinks: &[f64], backbone: impl Fn(f64) -> f64) -> Complex64 {
    let tip = backbone(a);
    let mut ends: Vec<f64> = (0..60).map(|j| PI * 0.5_f64.powi(j)).collect();
    ends.extend((1..60).map(|j| PI * (1.0 - 0.5_f64.powi(j))));
    // a (1 − cos τ)/2 = x at τ = 2 asin √(x/a).
    ends.extend(kinks.iter().filter(|x| **x < a).map(|x| 2.0 * (x / a).sqrt().asin()));
    ends.push(0.0);
    ends.sort_by(f64::total_cmp);
    let rule = gauss();
    let mut sum = Complex64::ZERO;
    for pair in ends.windows(2) {
        let width = pair[1] - pair[0];
        for (node, weight) in rule {
            let tau = pair[0] + node * width;
            let way = a * (0.5 * tau).sin().powi(2);
            sum += Complex64::cis(-tau) * ((tip - 2.0 * backbone(way)) * weight * width);
        }
    }
    sum * (2.0 / PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masings_loop_of_one_slider_is_elastic_coulomb() {
        for a in [0.4, 1.5, 20.0, 1e4] {
            let one = masing(a, &[1.0], |x| 3.0 * x.min(1.0));
            let other = elastic_coulomb(a, 3.0, 1.0);
            assert!((one - other).norm() < 1e-13 * other.norm(), "{a}: {one} {other}");
        }
    }
}
