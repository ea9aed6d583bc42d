//! A family of loops against the law that made it, its continuity, and what it refuses.

use super::*;
use crate::DescribingFunction;

/// Loops that the paper's law makes of one loop at the amplitudes α W*.
fn made_by(law: &ScaledLoop, alphas: &[f64]) -> Vec<Loop> {
    alphas
        .iter()
        .map(|&alpha| {
            let a = alpha * law.reference_displacement();
            let coefficients = law.coefficients(law.first(alpha).0).collect();
            Loop::new(a, coefficients).unwrap()
        })
        .collect()
}

/// The paper's amplitudes 0.8 µm to 8 µm would be 0.1 … 1; the tests' motions lie below, between and above these.
pub(super) fn odd_family() -> LoopFamily {
    let loops = made_by(&scaled(&odd_loop()), &[0.2, 0.3, 0.5, 1.0]);
    LoopFamily::new(&loops, 0.0, Symmetry::Auto).unwrap()
}

pub(super) fn uneven_family() -> LoopFamily {
    let loops = made_by(&scaled(&uneven_loop()), &[1.0, 0.15, 0.6]);
    LoopFamily::new(&loops, 0.0, Symmetry::Full).unwrap()
}

#[test]
fn a_family_made_by_the_papers_law_reproduces_it_between_the_loops() {
    let law = scaled(&odd_loop());
    // Largest difference of F_1 over the range, relative to F*.
    let error = |count: usize| -> f64 {
        let alphas: Vec<f64> =
            (0..count).map(|i| 0.1 * 10.0_f64.powf(i as f64 / (count - 1) as f64)).collect();
        let family = LoopFamily::new(&made_by(&law, &alphas), 0.0, Symmetry::Auto).unwrap();
        (0..=1000)
            .map(|j| 8e-6 * 0.1 * 10.0_f64.powf(f64::from(j) / 1000.0))
            .map(|a| {
                let exact = law.describing_function().unwrap().first_harmonic(a).force;
                (family.first_harmonic(a).force - exact).norm() / 12.0
            })
            .fold(0.0, f64::max)
    };
    let errors: Vec<f64> = [6, 11, 21, 41, 81].into_iter().map(error).collect();
    let rate = (errors[1] / errors[4]).log2() / 3.0;
    assert!((rate - 3.0).abs() < 0.2, "{rate}: {errors:?}");
    assert!(errors[0] < 0.01, "{errors:?}");
    // In time too, with higher harmonics, at a motion with interior reversals.
    let alphas: Vec<f64> = (0..41).map(|i| 0.1 * 10.0_f64.powf(f64::from(i) / 40.0)).collect();
    let family = LoopFamily::new(&made_by(&law, &alphas), 0.0, Symmetry::Auto).unwrap();
    let motion = Sampled::new(&motions()[3], 256);
    let (one, other) = (force_of(&law, &motion).unwrap().0, force_of(&family, &motion).unwrap().0);
    let difference = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference < 30.0 * errors[3] * 12.0, "{difference} {}", errors[3]);
}

#[test]
fn measured_loops_are_met_exactly_with_a_continuous_derivative() {
    let law = scaled(&odd_loop());
    let alphas = [0.2, 0.3, 0.5, 1.0];
    let loops = made_by(&law, &alphas);
    let family = odd_family();
    for one in &loops {
        let a = one.displacement_amplitude();
        let met: Vec<Complex64> = family.harmonics(a).map(|(c, _)| c).collect();
        assert_eq!(met, one.coefficients());
        let sides = [1.0 - 1e-9, 1.0 + 1e-9].map(|s| family.harmonics(s * a).collect::<Vec<_>>());
        for (below, above) in sides[0].iter().zip(&sides[1]) {
            assert!((below.0 - above.0).norm() < 1e-8 * one.force_amplitude());
            assert!((below.1 - above.1).norm() * a < 1e-7 * one.force_amplitude(), "{below:?} {above:?}");
        }
    }
}

#[test]
fn below_the_loops_it_sticks_and_above_it_levels_off() {
    for family in [odd_family(), uneven_family()] {
        let (smallest, largest) = family.range();
        let first = |a: f64| family.first_harmonic(a).force;
        assert_eq!(family.holding_force(), 0.0);
        let stiffness = first(1e-9 * smallest) / (1e-9 * smallest);
        assert!((first(1e-6 * smallest) / (1e-6 * smallest) - stiffness).norm() < 1e-5 * stiffness.norm());
        assert!(stiffness.re > 0.0 && stiffness.im >= 0.0, "{stiffness}");
        let far = first(1e9 * largest);
        assert!((first(1e6 * largest) - far).norm() < 1e-5 * far.norm());
        assert!(far.im > 0.0);
        assert!(!family.marks(largest).extrapolated && family.marks(1.01 * largest).extrapolated);
        assert!(!family.marks(0.1 * smallest).extrapolated);
    }
}

#[test]
fn no_loop_in_between_creates_energy() {
    for family in [odd_family(), uneven_family()] {
        for j in 0..400 {
            let a = 1e-8 * 1.03_f64.powi(j);
            let c: Vec<Complex64> = family.harmonics(a).map(|(c, _)| c).collect();
            assert!(c[1].im > 0.0);
            for i in 1..64 {
                let theta = PI * f64::from(i) / 64.0;
                let width: f64 = c.iter().enumerate().map(|(k, c)| c.im * (k as f64 * theta).sin()).sum();
                assert!(width > -1e-3 * c[1].norm(), "a = {a:e}, θ = {theta}: {width}");
            }
        }
    }
}

#[test]
fn what_is_no_family_is_refused() {
    let loops = made_by(&scaled(&odd_loop()), &[0.5, 1.0, 0.5]);
    let key = |loops: &[Loop]| LoopFamily::new(loops, 0.0, Symmetry::Auto).unwrap_err().key.into_owned();
    assert_eq!(key(&loops[..1]), "loops");
    assert_eq!(key(&[]), "loops");
    assert_eq!(key(&loops), "loops[2]");
    let error = LoopFamily::new(&loops, 0.0, Symmetry::Auto).unwrap_err().to_string();
    assert!(error.contains("loops[0]"), "{error}");
}

#[test]
fn even_harmonics_stay_or_go_as_asked() {
    let loops = made_by(&scaled(&uneven_loop()), &[0.5, 1.0]);
    let content = loops.iter().map(Loop::even_content).fold(0.0, f64::max);
    assert!(content > 0.02);
    let odd = |noise, symmetry| LoopFamily::new(&loops, noise, symmetry).unwrap().nature().odd;
    assert!(!odd(0.0, Symmetry::Auto) && odd(1.1 * content, Symmetry::Auto));
    assert!(odd(0.0, Symmetry::Odd) && !odd(1.0, Symmetry::Full));
}
