//! Iwan's law against sums of Jenkins elements, quadrature, and its own refinement.

use super::*;
use crate::{DescribingFunction, IwanParameters};

/// The magnitude law's backbone, W* = 8 µm and F* = 12 N, sliders up to `range` W*.
pub(super) fn logarithmic(range: f64) -> Iwan {
    let magnitude = MagnitudeLaw::default();
    Iwan::from_magnitude(IwanParameters { displacement: 8e-6, force: 12.0, magnitude, range }).unwrap()
}

/// Four sliders, three of them within the amplitudes of the tests, and a spring.
pub(super) fn polygon() -> Iwan {
    Iwan::from_backbone(&[[1.1e-6, 5.5], [2.4e-6, 9.0], [4.7e-6, 11.0], [2e-5, 15.0], [3e-5, 16.0]]).unwrap()
}

/// The force of the elements and the spring, one by one.
fn sum_of_elements(law: &Iwan, motion: &Sampled) -> Vec<f64> {
    let mut sum: Vec<f64> = motion.displacement.iter().map(|w| law.spring() * w).collect();
    for element in law.sliders().unwrap() {
        for (sum, f) in sum.iter_mut().zip(force_of(element, motion).unwrap().0) {
            *sum += f;
        }
    }
    sum
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn masings_rule_is_the_sum_of_the_jenkins_elements() {
    let stacks =
        [polygon(), logarithmic(10.0).discretised(30).unwrap(), logarithmic(0.2).discretised(7).unwrap()];
    for law in &stacks {
        for spectrum in motions() {
            let motion = Sampled::new(&spectrum, 512);
            let (force, _) = force_of(law, &motion).unwrap();
            let difference = largest_difference(&force, &sum_of_elements(law, &motion));
            assert!(difference < 1e-12, "{spectrum:?}: {difference:e} N of about 10 N");
        }
    }
}

proptest! {
    #[test]
    fn masings_rule_is_the_sum_of_the_jenkins_elements_for_any_motion(
        parts in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 6),
        mean in -3.0..3.0_f64,
        size in -7.0..-4.5_f64,
    ) {
        let size = 10.0_f64.powf(size);
        let spectrum: Vec<Complex64> = std::iter::once(complex(mean * size, 0.0))
            .chain(parts.iter().map(|&(re, im)| complex(re, im) * size))
            .collect();
        let motion = Sampled::new(&spectrum, 256);
        let law = polygon();
        let (force, _) = force_of(&law, &motion).unwrap();
        let difference = largest_difference(&force, &sum_of_elements(&law, &motion));
        prop_assert!(difference < 1e-11, "{} N", difference);
    }
}

#[test]
fn the_discretised_stack_converges_with_the_square_of_its_sliders() {
    // In closed form, for amplitudes below and above the last slider; averaged over a few, as the error depends on
    // where between two sliders the amplitude falls.
    for (range, a) in [(10.0, 5e-6), (10.0, 4e-7), (10.0, 2e-4), (0.2, 5e-6)] {
        let law = logarithmic(range);
        let error = |count: usize| -> f64 {
            let coarse = law.discretised(count).unwrap();
            assert_eq!(coarse.sliders().unwrap().len(), count);
            assert!((coarse.spring() / law.spring() - 1.0).abs() < 1e-15);
            (0..32)
                .map(|j| a * (1.0 + 0.01 * f64::from(j)))
                .map(|a| (coarse.first_harmonic(a).force - law.first_harmonic(a).force).norm())
                .sum()
        };
        let rate = (error(64) / error(1024)).log2() / 4.0;
        assert!((rate - 2.0).abs() < 0.05, "range {range}, a = {a:e}: {rate}");
    }
    // The bound of the chords: C q²/8, q = ln(1 + x_m/b)/n.
    let (law, n) = (logarithmic(10.0), 40);
    let coarse = law.discretised(n).unwrap();
    let bound = 0.21 * 12.0 * ((1001.0_f64).ln() / n as f64).powi(2) / 8.0;
    let worst = (0..20_000)
        .map(|j| 8e-5 * (f64::from(j) / 2e4).powi(3))
        .map(|x| law.backbone(x) - coarse.backbone(x))
        .fold(0.0, f64::max);
    assert!(worst < bound * 1.001 && worst > bound * 0.9, "{worst} {bound}");
}

/// ∫_0^π by Gauss's rule of two points on many graded panels: another way than samples in time.
fn quadrature(f: impl Fn(f64) -> f64, kink: f64) -> f64 {
    let panels = 4000;
    let mut sum = 0.0;
    for (from, to) in [(0.0, kink), (kink, PI)] {
        for j in 0..panels {
            let edge = |j: i32| {
                let s = f64::from(j) / f64::from(panels);
                // Graded towards the beginning, where the backbone bends most.
                from + (to - from) * s * s
            };
            let (left, right) = (edge(j), edge(j + 1));
            let (mid, half) = (0.5 * (left + right), 0.5 * (right - left));
            let step = half / 3.0_f64.sqrt();
            sum += half * (f(mid - step) + f(mid + step));
        }
    }
    sum
}

#[test]
fn the_closed_form_is_the_quadrature_of_the_loop() {
    for range in [0.02, 0.2, 1.0, 10.0] {
        let law = logarithmic(range);
        let backbone = |x: f64| {
            let (c, b, end) = (0.21 * 12.0, 0.01 * 8e-6, range * 8e-6);
            if x <= end { c * (x / b).ln_1p() } else { c * (end / b).ln_1p() + c * (x - end) / (end + b) }
        };
        for a in [1e-9, 3e-8, 1e-7, 1e-6, 1.59e-6, 1.61e-6, 8e-6, 1e-4, 1e-3] {
            let unloading = |tau: f64| backbone(a) - 2.0 * backbone(0.5 * a * (1.0 - tau.cos()));
            let kink = (1.0 - 2.0 * range * 8e-6 / a).max(-1.0).acos();
            let expected = complex(
                2.0 / PI * quadrature(|tau| unloading(tau) * tau.cos(), kink),
                -2.0 / PI * quadrature(|tau| unloading(tau) * tau.sin(), kink),
            );
            let closed = law.first_harmonic(a).force;
            let error = (closed - expected).norm() / expected.norm();
            assert!(error < 1e-11, "range {range}, a = {a:e}: {error:e}");
        }
    }
}

#[test]
fn the_closed_form_is_smooth_where_the_last_slider_yields() {
    let law = logarithmic(0.2);
    let (below, above) =
        (law.first_harmonic(1.6e-6 * (1.0 - 1e-9)), law.first_harmonic(1.6e-6 * (1.0 + 1e-9)));
    assert!((below.force - above.force).norm() < 1e-8 * below.force.norm());
    assert!((below.derivative - above.derivative).norm() < 1e-3 * below.derivative.norm());
}

#[test]
fn limits() {
    // Small: a spring f'(0) that loses nothing; large: the spring that is left, and the rectangle's friction.
    let law = logarithmic(1.0);
    let small = law.first_harmonic(1e-15);
    let stiffness = 0.21 * 12.0 / (0.01 * 8e-6);
    assert!((small.force.re / 1e-15 / stiffness - 1.0).abs() < 1e-7);
    // Im F_1 → (2 C/3π) (a/b)².
    let loss = 2.0 * 0.21 * 12.0 / (3.0 * PI) * (1e-15_f64 / 8e-8).powi(2);
    assert!((small.force.im / loss - 1.0).abs() < 1e-7, "{}", small.force.im / loss);
    assert!((small.derivative.re / stiffness - 1.0).abs() < 1e-7);
    assert_eq!(law.holding_force(), 0.0);
    let far = law.first_harmonic(1e3);
    assert!((far.force.re / 1e3 / law.spring() - 1.0).abs() < 1e-3);
    let slip = law.backbone(8e-6) - law.spring() * 8e-6;
    assert!((far.force.im / (4.0 / PI * slip) - 1.0).abs() < 1e-7);
}

#[test]
fn the_fundamental_has_the_magnitude_of_equation_6_and_not_the_phase_of_equation_7() {
    let law = logarithmic(10.0);
    let mut worst: f64 = 0.0;
    for j in 0..=90 {
        let alpha = 0.1 + 0.01 * f64::from(j);
        let first = law.first_harmonic(alpha * 8e-6).force;
        worst = worst.max((first.norm() / 12.0 / law_magnitude(alpha) - 1.0).abs());
    }
    assert!((worst - 0.017).abs() < 5e-4, "{worst}");
    let phase = law.first_harmonic(8e-6).force.arg() / PI - 1.0;
    assert!((phase + 0.742).abs() < 5e-4, "{phase}");
}

#[test]
fn the_spring_holds_the_mean_and_sliders_follow_it() {
    let law = logarithmic(10.0);
    assert!(law.nature().determines_mean);
    let free = Iwan::from_backbone(&[[1e-6, 1.0], [2e-6, 1.0]]).unwrap();
    assert!(!free.nature().determines_mean && free.spring() == 0.0);
    let mean_force = |law: &Iwan, mean: f64| {
        let motion = Sampled::new(&[complex(mean, 0.0), complex(5e-6, 0.0)], 256);
        harmonics(&force_of(law, &motion).unwrap().0, 0)[0].re
    };
    for mean in [1e-6, -3e-5] {
        assert!((mean_force(&law, mean) - law.spring() * mean).abs() < 1e-13);
        assert!(mean_force(&free, mean).abs() < 1e-15);
    }
}

#[test]
fn a_backbone_that_is_no_stack_of_sliders_is_refused_at_its_point() {
    let key = |points: &[[f64; 2]]| Iwan::from_backbone(points).unwrap_err().key.into_owned();
    assert_eq!(key(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.5]]), "backbone[2]");
    assert_eq!(key(&[[1.0, 1.0], [1.0, 2.0]]), "backbone[1]");
    assert_eq!(key(&[[1.0, 1.0], [2.0, 0.5]]), "backbone[1]");
    assert_eq!(key(&[[1.0, -1.0], [2.0, 0.5]]), "backbone[0]");
    assert_eq!(key(&[[0.0, 0.5], [2.0, 0.6]]), "backbone[0]");
    assert_eq!(key(&[[1.0, 1.0], [f64::NAN, 0.5]]), "backbone[1]");
    assert_eq!(key(&[[1.0, 1.0], [2.0, 2.0]]), "backbone");
    assert_eq!(key(&[]), "backbone");
    let law = polygon();
    assert_eq!(law.discretised(0).unwrap_err().key, "sliders");
    // Points on a straight line add no slider; the listed origin changes nothing.
    let same =
        Iwan::from_backbone(&[[0.0, 0.0], [0.55e-6, 2.75], [1.1e-6, 5.5], [2.4e-6, 9.0], [4.7e-6, 11.0]]);
    assert_eq!(same.unwrap().sliders().unwrap().len(), 2);
    let bad = |parameters: IwanParameters| Iwan::from_magnitude(parameters).unwrap_err().key.into_owned();
    let magnitude = MagnitudeLaw::default();
    let good = IwanParameters { displacement: 8e-6, force: 12.0, magnitude, range: 1.0 };
    assert_eq!(bad(IwanParameters { displacement: 0.0, ..good }), "displacement");
    assert_eq!(bad(IwanParameters { force: -1.0, ..good }), "force");
    assert_eq!(bad(IwanParameters { range: f64::INFINITY, ..good }), "range");
    let flat = MagnitudeLaw { slope: 0.0, ..magnitude };
    assert_eq!(bad(IwanParameters { magnitude: flat, ..good }), "magnitude.slope");
}

#[test]
fn beyond_the_measured_range_is_extrapolation() {
    let marks = |law: &Iwan, a: f64| law.describing_function().unwrap().marks(a);
    assert!(!marks(&logarithmic(10.0), 8e-6).extrapolated);
    assert!(marks(&logarithmic(10.0), 8.1e-6).extrapolated);
    assert!(!marks(&polygon(), 3e-5).extrapolated && marks(&polygon(), 3.1e-5).extrapolated);
    assert_eq!(marks(&polygon(), 1.0e-6).state, ContactState::Stick);
    assert_eq!(marks(&polygon(), 1.2e-6).state, ContactState::Mixed);
}
