use std::f64::consts::PI;

use super::separable::Problem;
use super::*;

/// Points that follow the laws exactly, W* = 8 µm, F* = 12 N; α ascending.
fn exact(alphas: &[f64], g: MagnitudeLaw, psi: PhaseLaw) -> Vec<LoopPoint> {
    let point = |alpha: &f64| LoopPoint {
        displacement: 8e-6 * alpha,
        turning_point_force: 12.0 * g.value(*alpha),
        first_harmonic: 13.0 * g.value(*alpha),
        phase: PI + psi.value(*alpha),
        noise: None,
    };
    alphas.iter().map(point).collect()
}

const ALPHAS: [f64; 8] = [0.01, 0.03, 0.07, 0.15, 0.3, 0.5, 0.75, 1.0];

/// The law relative to the force at α = 1: W* and F* are the largest loop's.
fn relative(g: MagnitudeLaw) -> MagnitudeLaw {
    MagnitudeLaw { offset: g.offset / g.value(1.0), slope: g.slope / g.value(1.0), shift: g.shift }
}

fn numbers(found: &Identification) -> [f64; 6] {
    let (g, psi) = (found.magnitude.law, found.phase.law);
    [g.offset, g.slope, g.shift, psi.limit, psi.span, psi.decay]
}

fn close(found: &Identification, g: MagnitudeLaw, psi: PhaseLaw, tolerance: f64) {
    let truth = [g.offset, g.slope, g.shift, psi.limit, psi.span, psi.decay];
    for (value, truth) in numbers(found).into_iter().zip(truth) {
        assert!((value / truth - 1.0).abs() < tolerance, "{:?}\n{truth:?}", numbers(found));
    }
}

#[test]
fn exact_loops_give_the_law_back() {
    let laws = [
        (MagnitudeLaw::default(), PhaseLaw::default()),
        (
            MagnitudeLaw { offset: 0.7, slope: 0.3, shift: 0.3 },
            PhaseLaw { limit: -1.2, span: 1.0, decay: 1.5 },
        ),
        (
            MagnitudeLaw { offset: 1.4, slope: -0.1, shift: 0.05 },
            PhaseLaw { limit: -2.0, span: -0.4, decay: 12.0 },
        ),
    ];
    for (g, psi) in laws {
        for alphas in [&ALPHAS[..], &[0.05, 0.4, 1.0], &[0.02, 0.1, 0.3, 1.0]] {
            let found = identify(&exact(alphas, g, psi), &IdentificationSettings::default()).unwrap();
            close(&found, relative(g), psi, 1e-10);
            assert!(found.residual_rms < 1e-13 && found.magnitude.residual_rms < 1e-13);
        }
    }
}

#[test]
fn order_and_units_do_not_matter() {
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for (j, point) in points.iter_mut().enumerate() {
        point.turning_point_force *= 1.0 + 0.01 * (j as f64 * 2.3).sin();
        point.phase += 0.01 * (j as f64 * 1.7).cos();
    }
    let settings = IdentificationSettings::default();
    let found = identify(&points, &settings).unwrap();
    let mut turned = points.clone();
    turned.reverse();
    turned.swap(2, 5);
    let again = identify(&turned, &settings).unwrap();
    assert_eq!((numbers(&again), again.notes), (numbers(&found), found.notes.clone()));
    assert_eq!(again.magnitude.covariance, found.magnitude.covariance);
    assert_eq!((again.reference.index, found.reference.index), (0, 7));
    assert_eq!(again.points[0], found.points[7]);

    let inches = |point: &LoopPoint| LoopPoint {
        displacement: point.displacement / 0.0254,
        turning_point_force: point.turning_point_force / 4448.2216152605,
        first_harmonic: point.first_harmonic / 4448.2216152605,
        ..*point
    };
    let again = identify(&points.iter().map(inches).collect::<Vec<_>>(), &settings).unwrap();
    for (a, b) in numbers(&again).into_iter().zip(numbers(&found)) {
        assert!((a / b - 1.0).abs() < 1e-11, "{a} {b}");
    }
    for (a, b) in again.phase.estimates.iter().zip(&found.phase.estimates) {
        assert!((a.std_error.unwrap() / b.std_error.unwrap() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn another_reference_changes_the_units_only() {
    let (g, psi) = (MagnitudeLaw::default(), PhaseLaw::default());
    let points = exact(&ALPHAS, g, psi);
    let settings = IdentificationSettings { reference: Some(5), ..Default::default() };
    let found = identify(&points, &settings).unwrap();
    // α' = 2α, so ln(α + shift) = ln(α' + 2 shift) − ln 2.
    let at = g.value(0.5);
    let truth = MagnitudeLaw {
        offset: (g.offset + g.slope * 0.5_f64.ln()) / at,
        slope: g.slope / at,
        shift: 2.0 * g.shift,
    };
    close(&found, truth, PhaseLaw { decay: 2.0, ..psi }, 1e-10);
    assert_eq!(found.reference, Reference { index: 5, displacement: 4e-6, force: 12.0 * at });
}

#[test]
fn the_force_that_is_fitted_is_the_one_asked_for() {
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    let other = MagnitudeLaw { offset: 1.0, slope: 0.15, shift: 0.02 };
    for (point, alpha) in points.iter_mut().zip(ALPHAS) {
        point.first_harmonic = 20.0 * other.value(alpha);
    }
    let tips = identify(&points, &IdentificationSettings::default()).unwrap();
    assert_eq!(tips.kind, Magnitude::TurningPoints);
    close(&tips, relative(MagnitudeLaw::default()), PhaseLaw::default(), 1e-10);
    let settings = IdentificationSettings { magnitude: Magnitude::FirstHarmonic, ..Default::default() };
    let first = identify(&points, &settings).unwrap();
    assert_eq!(first.kind, Magnitude::FirstHarmonic);
    close(&first, relative(other), PhaseLaw::default(), 1e-10);
}

#[test]
fn a_rectangular_loop_has_four_over_pi_between_the_two_forces() {
    let square = hysteresis::synthetic::project(1e-6, 2001, |theta| if theta < PI { -1.0 } else { 1.0 });
    let point = LoopPoint::from(&square.unwrap());
    assert!((point.first_harmonic - 4.0 / PI).abs() < 1e-5);
    let rounded = hysteresis::synthetic::dahl_loop(8e-6, 12.0, 6e6, 63).unwrap();
    let point = LoopPoint::from(&rounded);
    // F_s tanh(a/x_s) with x_s = 2 µm.
    assert!((point.turning_point_force / (12.0 * 4.0_f64.tanh()) - 1.0).abs() < 1e-3, "{point:?}");
}

#[test]
fn the_linear_part_is_the_closed_form() {
    // y = 2 + 3u + 1 at the ends, −1 in the middle, u = −1, 0, 1 (twice): by hand c₁ = 3, c₀ = ȳ.
    let p = 1.0;
    let u = |alpha: f64| (alpha + p).ln();
    let alphas = [(-1.0_f64).exp(), 1.0, 1.0_f64.exp()].map(|v| v * 10.0 - p);
    let observations = [1.0, -1.0, 1.0].iter().zip(alphas).map(|(off, alpha)| Observation {
        alpha,
        value: 2.0 + 3.0 * (u(alpha) - 10.0_f64.ln()) + off,
        noise: None,
    });
    let observations: Vec<_> = observations.collect();
    let problem = Problem { family: &Family::MAGNITUDE, observations: &observations, weights: &[1.0; 3] };
    let line = problem.line(p);
    assert!((line.factor - 3.0).abs() < 1e-13);
    assert!((line.constant - (2.0 + 1.0 / 3.0 - 3.0 * 10.0_f64.ln())).abs() < 1e-12);
    // Residuals 2/3, −4/3, 2/3.
    assert!((line.sum - 24.0 / 9.0).abs() < 1e-12);
    // With weights: the doubled middle counts as two observations.
    let twice: Vec<_> = [0, 1, 1, 2].iter().map(|j| observations[*j]).collect();
    let doubled = Problem { family: &Family::MAGNITUDE, observations: &twice, weights: &[1.0; 4] };
    let weighted = Problem { weights: &[1.0, 2.0, 1.0], ..problem };
    let (a, b) = (doubled.line(0.3), weighted.line(0.3));
    assert!((a.factor - b.factor).abs() < 1e-12 && (a.constant - b.constant).abs() < 1e-12);
    assert!((a.sum - b.sum).abs() < 1e-12);
}

fn jacobian_by_differences<L>(family: &Family<L>, value: impl Fn([f64; 3], f64) -> f64, at: [f64; 3]) {
    for alpha in [0.01, 0.2, 1.0, 1.7] {
        let analytic = family.jacobian(alpha, at);
        for j in 0..3 {
            let h = 1e-5 * at[j].abs();
            let shifted = |by: f64| {
                let mut numbers = at;
                numbers[j] += by;
                value(numbers, alpha)
            };
            let difference = (shifted(h) - shifted(-h)) / (2.0 * h);
            assert!((difference - analytic[j]).abs() < 1e-8 * (1.0 + analytic[j].abs()), "{alpha} {j}");
        }
    }
}

#[test]
fn the_jacobian_is_that_of_the_laws() {
    let g = |numbers, alpha| (Family::MAGNITUDE.law)(numbers).value(alpha);
    jacobian_by_differences(&Family::MAGNITUDE, g, [0.98, 0.21, 0.01]);
    let psi = |numbers, alpha| (Family::PHASE.law)(numbers).value(alpha);
    jacobian_by_differences(&Family::PHASE, psi, [-1.57, 1.466, 4.0]);
}

#[test]
fn the_optimum_is_stationary_and_lower_than_its_neighbourhood() {
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for (j, point) in points.iter_mut().enumerate() {
        point.turning_point_force *= 1.0 + 0.03 * (j as f64 * 2.3).sin();
    }
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    let sum = |law: MagnitudeLaw| -> f64 {
        found.points.iter().map(|point| (point.magnitude - law.value(point.alpha)).powi(2)).sum()
    };
    let best = found.magnitude.law;
    for scale in [0.5, 0.9, 0.999, 1.001, 1.1, 2.0] {
        for law in [
            MagnitudeLaw { offset: best.offset * scale, ..best },
            MagnitudeLaw { slope: best.slope * scale, ..best },
            MagnitudeLaw { shift: best.shift * scale, ..best },
        ] {
            assert!(sum(law) > sum(best));
        }
    }
    let gradient = |step: &dyn Fn(f64) -> MagnitudeLaw| (sum(step(1e-5)) - sum(step(-1e-5))) / 2e-5;
    let curvature =
        |step: &dyn Fn(f64) -> MagnitudeLaw| (sum(step(1e-5)) + sum(step(-1e-5)) - 2.0 * sum(best)) / 1e-10;
    let along_shift = |by: f64| MagnitudeLaw { shift: best.shift * (1.0 + by), ..best };
    // The step to the exact optimum is below 1e-6 of the shift.
    assert!(gradient(&along_shift).abs() < 1e-6 * curvature(&along_shift));
}

fn has(found: &Identification, matches: impl Fn(&Note) -> bool) -> bool {
    found.notes.iter().any(matches)
}

#[test]
fn three_loops_have_no_errors_and_it_is_said() {
    let points = exact(&[0.05, 0.4, 1.0], MagnitudeLaw::default(), PhaseLaw::default());
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(found.magnitude.estimates.iter().chain(&found.phase.estimates).all(|e| e.std_error.is_none()));
    assert!(found.magnitude.covariance.is_none() && found.magnitude.freedom == 0);
    assert!(has(&found, |note| matches!(note, Note::ExactlyDetermined { loops: 3, .. })));
    assert!(found.notes.iter().any(|note| note.to_string().contains("there are no errors")));

    // Noise still has errors to offer.
    let noise =
        Some(PointNoise { displacement: 0.0, turning_point_force: 0.01, first_harmonic: 0.01, phase: 0.001 });
    let noisy: Vec<_> = points.iter().map(|point| LoopPoint { noise, ..*point }).collect();
    let settings = IdentificationSettings { weighting: Weighting::Noise, ..Default::default() };
    let found = identify(&noisy, &settings).unwrap();
    assert!(found.phase.estimates.iter().all(|e| e.std_error.is_some_and(|error| error > 0.0)));
    assert!(found.notes.iter().any(|note| note.to_string().contains("noise alone")));
}

#[test]
fn the_error_of_the_limit_is_that_of_a_mean() {
    let psi = PhaseLaw { limit: -1.5, span: 1.4, decay: 40.0 };
    let alphas = [0.01, 0.02, 0.04, 1.0, 1.1, 1.2, 1.3];
    let noise =
        Some(PointNoise { displacement: 0.0, turning_point_force: 0.01, first_harmonic: 0.01, phase: 0.02 });
    let points: Vec<_> = exact(&alphas, MagnitudeLaw::default(), psi)
        .into_iter()
        .map(|point| LoopPoint { noise, ..point })
        .collect();
    let settings =
        IdentificationSettings { weighting: Weighting::Noise, reference: Some(3), ..Default::default() };
    let found = identify(&points, &settings).unwrap();
    // Four loops sit on the limit and the other three determine span and decay: 0.02/√4, nearly.
    let [limit, ..] = found.phase.estimates;
    assert!((limit.std_error.unwrap() / 0.01 - 1.0).abs() < 0.05, "{limit:?}");
}

#[test]
fn too_few_amplitudes_are_refused() {
    let points = exact(&[0.5, 0.505, 1.0], MagnitudeLaw::default(), PhaseLaw::default());
    let settings = IdentificationSettings::default();
    let error = identify(&points, &settings).unwrap_err();
    assert_eq!(error, IdentificationError::TooFewAmplitudes { loops: 3, amplitudes: 2 });
    assert!(error.to_string().contains("at least three different amplitudes"));
    assert!(identify(&[], &settings).is_err());

    let points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    let beyond = IdentificationSettings { reference: Some(8), ..settings };
    assert!(identify(&points, &beyond).unwrap_err().to_string().contains("number 9"));
    let noise = IdentificationSettings { weighting: Weighting::Noise, ..settings };
    assert_eq!(identify(&points, &noise).unwrap_err(), IdentificationError::UnknownNoise { index: 0 });
    for (bad, words) in [
        (LoopPoint { displacement: 0.0, ..points[1] }, "displacement amplitude must be positive"),
        (LoopPoint { turning_point_force: f64::NAN, ..points[1] }, "turning points must be positive"),
        (LoopPoint { phase: -0.1, ..points[1] }, "creates energy"),
    ] {
        let mut points = points.clone();
        points[1] = bad;
        let message = identify(&points, &settings).unwrap_err().to_string();
        assert!(message.starts_with("loop 2") && message.contains(words), "{message}");
    }
}

#[test]
fn repeated_amplitudes_count_once() {
    let mut points = exact(&[0.05, 0.05, 0.4, 0.4, 1.0], MagnitudeLaw::default(), PhaseLaw::default());
    points[0].turning_point_force *= 1.01;
    points[2].phase += 0.01;
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(has(&found, |note| matches!(note, Note::ExactlyDetermined { loops: 5, .. })));
    assert!(has(&found, |note| matches!(note, Note::FewLoops { freedom: 2 })));
    assert!(found.notes.iter().any(|note| note.to_string().contains("how well loops repeat")));
}

#[test]
fn what_the_range_does_not_show_is_said() {
    let (g, psi) = (MagnitudeLaw::default(), PhaseLaw::default());
    let at = |alphas: &[f64]| identify(&exact(alphas, g, psi), &IdentificationSettings::default()).unwrap();
    assert_eq!(at(&ALPHAS).notes, []);
    let large = at(&[0.4, 0.5, 0.6, 0.7, 0.8, 1.0]);
    assert!(has(&large, |n| matches!(n, Note::NarrowRange { ratio } if (ratio - 2.5).abs() < 1e-12)));
    assert!(has(&large, |n| matches!(n, Note::NoSmallLoop { parameter: Parameter::Shift, .. })));
    assert!(has(&large, |n| matches!(n, Note::NoSmallLoop { parameter: Parameter::Span, .. })));
    let slow = PhaseLaw { limit: -1.0, span: 1.5, decay: 0.5 };
    let slow = identify(&exact(&ALPHAS, g, slow), &IdentificationSettings::default()).unwrap();
    assert!(has(&slow, |n| matches!(n, Note::NoLargeLoop { largest, .. } if *largest == 1.0)));
}

#[test]
fn a_pure_logarithm_and_a_straight_line_put_the_shift_on_its_bounds() {
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for (point, alpha) in points.iter_mut().zip(ALPHAS) {
        // Steeper than a logarithm towards zero, and bent upwards.
        point.turning_point_force = 5.0 + alpha.ln() - 0.002 / alpha;
        point.first_harmonic = 1.0 + alpha + 0.3 * alpha * alpha;
    }
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(has(&found, |n| matches!(n, Note::AtBound { parameter: Parameter::Shift, lower: true, .. })));
    assert!(found.magnitude.estimates.iter().all(|estimate| estimate.std_error.is_none()));
    // ln α has g(0) = −∞: no contact.
    assert!(has(&found, |n| matches!(n, Note::NotPassive(error) if error.key == "magnitude")));
    let settings = IdentificationSettings { magnitude: Magnitude::FirstHarmonic, ..Default::default() };
    let found = identify(&points, &settings).unwrap();
    assert!(has(&found, |n| matches!(n, Note::AtBound { parameter: Parameter::Shift, lower: false, .. })));
    assert!(found.notes.iter().any(|note| note.to_string().contains("straight line")));
}

#[test]
fn laws_that_create_energy_are_flagged_with_the_reason() {
    // All measured phases are fine; the law leaves [−π, 0] at α = 0.
    let psi = PhaseLaw { limit: -1.5, span: 1.7, decay: 4.0 };
    let points = exact(&[0.1, 0.2, 0.4, 0.6, 1.0], MagnitudeLaw::default(), psi);
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(has(&found, |n| matches!(n, Note::NotPassive(error) if error.key == "phase")));
    assert!(found.notes.iter().any(|note| note.to_string().contains("[-π, 0]")));
    let g = MagnitudeLaw { offset: 0.9, slope: 0.3, shift: 0.001 };
    let points = exact(&[0.1, 0.2, 0.4, 0.6, 1.0], g, PhaseLaw::default());
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(has(&found, |n| matches!(n, Note::NotPassive(error) if error.key == "magnitude")));
}

#[test]
fn uncertain_numbers_are_named() {
    // Only large loops and much scatter: the shift is anything.
    let mut points = exact(&[0.3, 0.4, 0.6, 0.8, 0.9, 1.0], MagnitudeLaw::default(), PhaseLaw::default());
    for (j, point) in points.iter_mut().enumerate() {
        point.turning_point_force *= 1.0 + 0.01 * (j as f64 * 2.9).cos();
    }
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(
        has(&found, |n| matches!(n, Note::Unbounded { parameter: Parameter::Shift, below: true, .. })
            || matches!(n, Note::AtBound { parameter: Parameter::Shift, .. })),
        "{:#?}",
        found.notes
    );
}

#[test]
fn equal_phases_leave_the_decay_open() {
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for point in &mut points {
        point.phase = 1.5;
    }
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(
        has(&found, |n| matches!(n, Note::Unbounded { parameter: Parameter::Decay, .. })),
        "{:?}",
        found.notes
    );
    assert!(found.phase.estimates.iter().all(|estimate| estimate.std_error.is_none()));
}

#[test]
fn scatter_beyond_the_noise_is_a_misfit() {
    let noise =
        Some(PointNoise { displacement: 0.0, turning_point_force: 1e-3, first_harmonic: 1e-3, phase: 1e-4 });
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for (j, point) in points.iter_mut().enumerate() {
        point.noise = noise;
        point.turning_point_force *= 1.0 + 0.01 * (j as f64 * 2.3).sin();
    }
    let found = identify(&points, &IdentificationSettings::default()).unwrap();
    assert!(has(&found, |n| matches!(n, Note::Misfit { law: Law::Magnitude, ratio } if *ratio > 10.0)));
    assert!(!has(&found, |n| matches!(n, Note::Misfit { law: Law::Phase, .. })));
}

#[test]
fn of_several_minima_the_best_is_taken_and_the_rival_named() {
    // Phases at random, for which the sum of squares has two minima over the decay (found by scanning it).
    let alphas = [0.02, 0.1, 0.3, 0.6, 1.0];
    for (phases, best, rival) in
        [([-1.65, -2.25, -1.84, -2.53, -2.43], 2.0, 45.1), ([-1.70, -2.18, -1.91, -2.49, -2.19], 42.3, 6.10)]
    {
        let mut points = exact(&alphas, MagnitudeLaw::default(), PhaseLaw::default());
        for (point, psi) in points.iter_mut().zip(phases) {
            point.phase = PI + psi;
        }
        let found = identify(&points, &IdentificationSettings::default()).unwrap();
        assert!((found.phase.law.decay / best - 1.0).abs() < 0.05, "{:?}", found.phase);
        assert!(has(
            &found,
            |note| matches!(note, Note::SeveralMinima { parameter: Parameter::Decay, other, .. }
            if (other / rival - 1.0).abs() < 0.05)
        ));
    }
}

#[test]
fn errors_are_scatter_or_noise_times_the_same_matrix() {
    let noise =
        Some(PointNoise { displacement: 0.0, turning_point_force: 1.0, first_harmonic: 1.0, phase: 0.1 });
    let mut points = exact(&ALPHAS, MagnitudeLaw::default(), PhaseLaw::default());
    for (j, point) in points.iter_mut().enumerate() {
        point.turning_point_force += 0.02 * (j as f64 * 2.3).sin();
        point.noise = noise;
    }
    let by =
        |weighting| identify(&points, &IdentificationSettings { weighting, ..Default::default() }).unwrap();
    let (scatter, noise) = (by(Weighting::Equal), by(Weighting::Noise));
    let sum: f64 = scatter.points.iter().map(|point| point.magnitude_residual.powi(2)).sum();
    // Eight loops have five degrees of freedom; the noise is 1 N.
    let ratio = (sum / 5.0).sqrt() / (1.0 / scatter.reference.force);
    for (a, b) in scatter.magnitude.estimates.iter().zip(&noise.magnitude.estimates) {
        assert!((a.value - b.value).abs() < 1e-9);
        assert!((a.std_error.unwrap() / b.std_error.unwrap() / ratio - 1.0).abs() < 1e-6);
        let half = |estimate: &Estimate| {
            (estimate.interval.unwrap().1 - estimate.value) / estimate.std_error.unwrap()
        };
        assert!((half(a) - 2.5706).abs() < 1e-4 && (half(b) - 1.95996).abs() < 1e-5);
    }
}

#[test]
fn noise_of_the_amplitude_counts_by_the_slope_of_the_law() {
    let (g, psi) = (MagnitudeLaw::default(), PhaseLaw::default());
    let exact = exact(&ALPHAS, g, psi);
    let settings = IdentificationSettings { weighting: Weighting::Noise, ..Default::default() };
    let with = |noise: &dyn Fn(f64) -> PointNoise| {
        let points =
            exact.iter().zip(ALPHAS).map(|(point, alpha)| LoopPoint { noise: Some(noise(alpha)), ..*point });
        identify(&points.collect::<Vec<_>>(), &settings).unwrap()
    };
    // 0.1 µm is 0.0125 W*.
    let (force, phase) = (0.01, 0.002);
    let shaky = with(&|_| PointNoise {
        displacement: 1e-7,
        turning_point_force: force,
        first_harmonic: force,
        phase,
    });
    let carried = with(&|alpha| {
        let tip = force.hypot(12.0 * g.derivative(alpha) * 0.0125);
        let phase = phase.hypot(psi.derivative(alpha) * 0.0125);
        PointNoise { displacement: 0.0, turning_point_force: tip, first_harmonic: tip, phase }
    });
    let both = |found: &Identification| [found.magnitude.estimates, found.phase.estimates].concat();
    for (a, b) in both(&shaky).iter().zip(both(&carried)) {
        assert!((a.std_error.unwrap() / b.std_error.unwrap() - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    }
}
