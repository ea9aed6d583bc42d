//! Damped nonlinear modes: against closed forms, and as a prediction of forced resonances.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use contact::{Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Law};
use faer::mat;
use hbm::{
    Contact, ContinuationOptions, Damping, Excitation, ExcitationKind, ModeEnd, ModeOptions, ModePoint,
    Model, NonlinearMode, Origin, Problem, Settings, frequency_curve, nonlinear_mode,
};
use num_complex::Complex64;
use stickslip_tests::scene_r;

/// One mass of 2 kg on a spring of 8e4 N/m with damping d, and a contact to the ground.
fn oscillator(d: f64, law: Arc<dyn Law>) -> Problem {
    let contact = Contact { name: "c".into(), first: 0, second: None, law, scale: 1.0 };
    let excitation =
        Excitation { dof: 0, harmonic: 1, amplitude: 1.0, phase: 0.0, kind: ExcitationKind::Force };
    Problem {
        joints: Vec::new(),
        model: Model::new(mat![[2.0]], Damping::Matrix(mat![[d]]), mat![[8e4]]).unwrap(),
        excitation: vec![excitation],
        contacts: vec![contact],
        output: vec![0],
    }
}

fn options(amplitudes: (f64, f64), points: usize) -> ModeOptions<'static> {
    ModeOptions { mode: 0, origin: Origin::Stuck, reference: 0, amplitudes, points, progress: &|_| true }
}

#[test]
fn one_harmonic_of_a_duffing_oscillator_has_its_closed_form() {
    let (d, cubic) = (6.0, 2e11);
    let law = Arc::new(Cubic::new(CubicParameters { stiffness: cubic }).unwrap());
    let mode = nonlinear_mode(&oscillator(d, law), &Settings::new(1), &options((1e-6, 2e-3), 25)).unwrap();
    assert_eq!(mode.end, ModeEnd::Reached);
    assert!(mode.points.len() >= 25);
    for point in &mode.points {
        let stiffness = 8e4 + 0.75 * cubic * point.amplitude.powi(2);
        let omega = (stiffness / 2.0).sqrt();
        assert!((point.frequency * TAU / omega - 1.0).abs() < 1e-9, "{point:?}");
        assert!((point.damping_ratio - d / (2.0 * 2.0 * omega)).abs() < 1e-9);
        assert!((point.modal_amplitude / (2.0_f64.sqrt() * point.amplitude) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn one_harmonic_of_a_slider_has_its_closed_form() {
    let (kt, slip) = (3e4, 0.6);
    let xc = slip / kt;
    let law =
        Arc::new(ElasticCoulomb::new(ElasticCoulombParameters { stiffness: kt, slip_force: slip }).unwrap());
    let mode = nonlinear_mode(&oscillator(0.0, law), &Settings::new(1), &options((1e-6, 2e-3), 30)).unwrap();
    assert_eq!(mode.end, ModeEnd::Reached);
    let mut slipping = 0;
    for point in &mode.points {
        let a = point.amplitude;
        // physics of the describing function: in phase and quadrature secant stiffness.
        let (elastic, loss) = if a <= xc {
            (kt, 0.0)
        } else {
            slipping += 1;
            let theta = (1.0 - 2.0 * xc / a).acos();
            (kt / PI * (theta - 0.5 * (2.0 * theta).sin()), 4.0 * slip / (PI * a) * (1.0 - xc / a))
        };
        let omega = ((8e4 + elastic) / 2.0).sqrt();
        assert!((point.frequency * TAU / omega - 1.0).abs() < 1e-9, "{a}: {}", point.frequency);
        assert!((point.damping_ratio - loss / (2.0 * 2.0 * omega * omega)).abs() < 1e-9, "{a}");
    }
    assert!(slipping > 10);
}

/// Local maxima of the amplitude of the first output dof over a response curve, in Hz and m.
fn peaks(problem: &Problem, harmonics: usize, range: (f64, f64)) -> Vec<(f64, f64)> {
    let options = ContinuationOptions { longest_step: 0.002, ..ContinuationOptions::default() };
    let curve = frequency_curve(problem, &Settings::new(harmonics), range, &options).unwrap();
    let at = |p: &hbm::CurvePoint| (p.parameter, p.solution.displacement[0][0].norm());
    curve.points.iter().filter(|p| p.peaks.contains(&0)).map(at).collect()
}

/// Frequency in Hz and amplitude in m of the resonance that the mode predicts at `factor` times the problem's excitation.
fn predicted(mode: &NonlinearMode, factor: f64) -> (f64, f64) {
    let level = |p: &ModePoint| p.excitation.map_or(f64::NEG_INFINITY, |e| (e / factor).ln());
    let around = mode.points.windows(2).find(|w| level(&w[0]) <= 0.0 && level(&w[1]) > 0.0).unwrap();
    let (a, b) = (&around[0], &around[1]);
    let part = -level(a) / (level(b) - level(a));
    let between = |x: f64, y: f64| x + part * (y - x);
    let hertz = between(a.resonance.unwrap(), b.resonance.unwrap());
    (hertz, between(a.amplitude.ln(), b.amplitude.ln()).exp())
}

#[test]
fn resonances_of_scene_r_are_predicted_at_five_levels() {
    let mut problem = scene_r();
    problem.output = vec![1];
    let at = ModeOptions { origin: Origin::Free, reference: 1, ..options((1e-4, 1.0), 200) };
    let mode = nonlinear_mode(&problem, &Settings::new(7), &at).unwrap();
    assert_eq!(mode.end, ModeEnd::Reached);
    for factor in [3.0, 10.0, 30.0, 100.0, 300.0] {
        problem.excitation[0].amplitude = 9.1 * factor;
        let (hertz, amplitude) = predicted(&mode, factor);
        let direct = peaks(&problem, 7, (40.0, 46.0));
        assert_eq!(direct.len(), 1, "{direct:?}");
        assert!((hertz / direct[0].0 - 1.0).abs() < 1e-3, "{factor}: {hertz} Hz, {direct:?}");
        assert!((amplitude / direct[0].1 - 1.0).abs() < 1e-3, "{factor}: {amplitude} m, {direct:?}");
    }
}

/// det(C − ω² M + iω (D − 2ζω M)) of scene R with `spring` at w1, relative to its largest term.
fn determinant(point: &ModePoint, spring: f64) -> f64 {
    let omega = point.frequency * TAU;
    let own = |k: f64, m: f64| {
        let damping = 24.0 - 2.0 * point.damping_ratio * omega * m;
        Complex64::new(k - omega * omega * m, omega * damping)
    };
    let (first, second) = (own(8.2e5 + spring, 3.98), own(4.1e5, 1.27));
    (first * second - 4.1e5 * 4.1e5).norm() / 4.1e5_f64.powi(2)
}

/// All sticking, all slipping: the modes of the structure with and without the contact's spring.
#[test]
fn modes_end_at_the_linear_ones() {
    let problem = scene_r();
    let at = ModeOptions { reference: 1, ..options((1e-7, 1e-2), 60) };
    let stuck = nonlinear_mode(&problem, &Settings::new(3), &at).unwrap();
    assert!(determinant(&stuck.points[0], 6.705e6) < 1e-9, "{}", determinant(&stuck.points[0], 6.705e6));
    // Friction of 15 N against 5e9 N in the springs.
    let at = ModeOptions { origin: Origin::Free, reference: 1, ..options((1e-3, 1e4), 60) };
    let free = nonlinear_mode(&problem, &Settings::new(3), &at).unwrap();
    let last = determinant(free.points.last().unwrap(), 0.0);
    assert!(last < 1e-7, "{last}");
}

/// One harmonic of a Jenkins element is a complex stiffness that its own amplitude determines (textbook describing function), so
/// every point of a mode is an eigenvalue of the structure with it. That of scene R leads from 88 Hz, stuck, to 43 Hz, slipping,
/// while the amplitude of w2 turns back and forth; from both sides it is the same curve.
#[test]
fn a_mode_goes_on_where_its_amplitude_turns_back() {
    let mut problem = scene_r();
    problem.output = vec![0, 1];
    let law = problem.contacts[0].law.describing_function().unwrap();
    let follow = |origin| {
        let at = ModeOptions { origin, reference: 1, ..options((2e-7, 2e-3), 40) };
        nonlinear_mode(&problem, &Settings::new(1), &at).unwrap()
    };
    // √ of the eigenvalues of M⁻¹C with and without the element's spring, over 2π.
    const STUCK: f64 = 87.4487;
    const FREE: f64 = 42.9849;
    let modes = [follow(Origin::Stuck), follow(Origin::Free)];
    for mode in &modes {
        assert_eq!(mode.end, ModeEnd::Reached);
        for point in &mode.points {
            let a = point.solution.displacement[0][0].norm();
            let spring = law.first_harmonic(a).force / a;
            let omega = point.frequency * TAU;
            let own = |k: Complex64, m: f64| {
                let damping = 24.0 - 2.0 * point.damping_ratio * omega * m;
                k + Complex64::new(-omega * omega * m, omega * damping)
            };
            let (first, second) = (own(8.2e5 + spring, 3.98), own(4.1e5.into(), 1.27));
            let error = (first * second - 4.1e5 * 4.1e5).norm() / 4.1e5_f64.powi(2);
            assert!(error < 1e-8, "{} Hz: {error:e}", point.frequency);
        }
        let (first, last) = (&mode.points[0], mode.points.last().unwrap());
        let ends = (first.frequency, last.frequency);
        assert!((ends.0 - STUCK).abs() < 0.05 && (ends.1 - FREE).abs() < 0.1, "{ends:?}");
        // It turns back, and no step is a jump: one in ln ω is as long as one in ln A may be at most.
        assert!(mode.points.windows(2).any(|pair| pair[1].amplitude < pair[0].amplitude));
        let longest = 1e4_f64.ln() / 39.0;
        let turns = mode.points.windows(2).map(|pair| (pair[1].frequency / pair[0].frequency).ln().abs());
        assert!(turns.fold(0.0, f64::max) < longest);
    }
}
