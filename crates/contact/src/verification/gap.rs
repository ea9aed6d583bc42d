//! Checks of the unilateral spring.

use super::*;
use crate::{Gap, GapParameters, PiecewiseLinear};

const K: f64 = 3e6;

pub(super) fn gap(g: f64) -> Gap {
    Gap::new(GapParameters { stiffness: K, gap: g }).unwrap()
}

/// One-sided harmonics of the force by its events, by quadrature of κ w + c over each piece.
fn by_events(law: &Gap, motion: &Sampled, highest: usize) -> (Vec<Complex64>, Marks) {
    let mut pieces = Vec::new();
    let marks = law.pieces(&motion.motion(), &mut Workspace::new(64), &mut pieces).unwrap();
    let w = |tau: f64| -> f64 {
        motion.spectrum.iter().enumerate().map(|(k, c)| (c * Complex64::cis(k as f64 * tau)).re).sum()
    };
    let mut sums = vec![Complex64::ZERO; highest + 1];
    for piece in &pieces {
        assert!(piece.to >= piece.from && piece.memory.is_none());
        // Simpson's rule on 400 panels.
        let h = (piece.to - piece.from) / 800.0;
        for i in 0..=800 {
            let weight = if i == 0 || i == 800 { 1.0 } else { f64::from(2 + 2 * (i % 2)) } * h / 3.0 / TAU;
            let tau = piece.from + h * f64::from(i);
            let f = piece.stiffness * w(tau) + piece.offset;
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += Complex64::cis(-(k as f64) * tau) * (f * weight * if k == 0 { 1.0 } else { 2.0 });
            }
        }
    }
    (sums, marks)
}

/// w = m + a cos τ is above g for |τ| < β, cos β = (g − m)/a:
/// F_0 = (k a/π)(sin β − β cos β), F_1 = (k a/π)(β − sin β cos β),
/// F_n = (2 k a/π)(sin nβ cos β − n cos nβ sin β)/(n (n² − 1)).
fn closed_form(mean: f64, a: f64, g: f64, n: usize) -> f64 {
    let cosine = (g - mean) / a;
    let beta = cosine.clamp(-1.0, 1.0).acos();
    let (sin, order) = (beta.sin(), n as f64);
    K * a / PI
        * match n {
            0 if cosine < -1.0 => -PI * cosine,
            0 => sin - beta * beta.cos(),
            1 => beta - sin * beta.cos(),
            _ => {
                let (own, turned) = (order * beta).sin_cos();
                2.0 * (own * beta.cos() - order * turned * sin) / (order * (order * order - 1.0))
            }
        }
}

#[test]
fn harmonic_motion_about_any_mean_has_closed_forms() {
    let a = 5e-6;
    for (mean, g, state) in [
        (0.0, 2e-6, ContactState::Mixed),
        (1e-6, -3e-6, ContactState::Mixed),
        (-2e-6, 2.9e-6, ContactState::Mixed),
        (0.0, 0.0, ContactState::Mixed),
        (1e-6, -4.1e-6, ContactState::Stick),
        (-2e-6, 4e-6, ContactState::Apart),
    ] {
        for phase in [0.0, 1.9, -0.3] {
            let turn = Complex64::cis(phase);
            let motion = Sampled::new(&[complex(mean, 0.0), a * turn], 64);
            let (exact, marks) = by_events(&gap(g), &motion, 6);
            assert_eq!(marks.state, state);
            let fine = Sampled::new(&[complex(mean, 0.0), a * turn], 1 << 12);
            let (force, marks) = force_of(&gap(g), &fine).unwrap();
            assert_eq!(marks.state, state);
            let sampled = harmonics(&force, 6);
            for n in 0..=6 {
                let expected = closed_form(mean, a, g, n) * turn.powu(n as u32);
                assert!(
                    (exact[n] - expected).norm() < 1e-9 * K * a,
                    "{mean} {g} F_{n} {} {expected}",
                    exact[n]
                );
                assert!((sampled[n] - expected).norm() < 1e-6 * K * a, "{mean} {g} F_{n}");
            }
        }
    }
}

#[test]
fn several_contacts_in_a_period() {
    for spectrum in motions() {
        for g in [-2.5e-6, -1e-6, 0.0, 0.4e-6, 2e-6] {
            let exact = by_events(&gap(g), &Sampled::new(&spectrum, 96), 7).0;
            let fine = Sampled::new(&spectrum, 1 << 13);
            let sampled = harmonics(&force_of(&gap(g), &fine).unwrap().0, 7);
            for (a, b) in exact.iter().zip(sampled) {
                assert!((a - b).norm() < 1e-6 * K * 5e-6, "{spectrum:?} {g}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_constant_displacement_is_pressed_or_apart() {
    let still = |w: f64| Sampled::new(&[complex(w, 0.0), Complex64::ZERO], 64);
    let (pressed, marks) = by_events(&gap(1e-6), &still(3e-6), 1);
    assert!((pressed[0] - complex(K * 2e-6, 0.0)).norm() < 1e-12 * K && marks.state == ContactState::Stick);
    let (apart, marks) = by_events(&gap(1e-6), &still(0.5e-6), 1);
    assert!(apart[0] == Complex64::ZERO && marks.state == ContactState::Apart);
}

#[test]
fn parameters_are_checked_by_name() {
    let key = |stiffness, gap| Gap::new(GapParameters { stiffness, gap }).unwrap_err().key;
    assert_eq!(key(0.0, 0.0), "stiffness");
    assert_eq!(key(K, f64::INFINITY), "gap");
}
