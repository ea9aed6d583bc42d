//! Harmonic truncation against exact periodic orbits (`reference/exact_orbits.json`).

use hbm::{Plan, Problem, Settings, Status};
use num_complex::Complex64;
use stickslip_tests::{exact_orbits, paper_scene, scene_p, scene_r};

fn plan(problem: &Problem, harmonics: usize, samples: usize) -> Plan {
    let mut settings = Settings::new(harmonics);
    settings.samples = Some(samples);
    Plan::new(problem, &settings).unwrap()
}

/// Hz, |W_1| of w1 in m, l2 error at N = 1 with half a unit of its last digit, l2 error at N = 31; two independent
/// computations agree on them.
const SCENE_R: [(f64, f64, (f64, f64), f64); 6] = [
    (57.0, 2.774688183e-6, (0.675, 5e-4), 2.55e-5),
    (62.0, 2.943539707e-6, (4.70, 5e-3), 1.29e-5),
    (75.0, 1.988362982e-5, (0.090, 5e-4), 5.4e-6),
    (100.0, 2.388795768e-5, (0.032, 5e-4), 2.9e-6),
    (108.0, 2.781522903e-5, (0.046, 6e-4), 4.0e-6),
    (112.0, 5.219603747e-6, (0.58, 5e-3), 5.9e-6),
];

#[test]
fn scene_r_has_the_known_truncation_errors() {
    let exact = exact_orbits("R");
    for (hertz, amplitude, one, thirty_one) in SCENE_R {
        let orbit = exact.iter().find(|orbit| orbit.hertz == hertz).unwrap();
        assert!((orbit.harmonics[0].1.norm() / amplitude - 1.0).abs() < 1e-9, "{hertz} Hz");
        for harmonics in [1, 3, 7, 15, 31] {
            let plan = plan(&scene_r(), harmonics, 4096);
            let solution = plan.solve(hertz, &mut plan.workspace());
            assert_eq!(solution.status, Status::Converged, "{hertz} Hz, N = {harmonics}");
            let error = orbit.error(&plan, &solution.displacement[0]);
            let (expected, tolerance) = match harmonics {
                1 => one,
                // 10 % for what 4096 samples leave.
                31 => (thirty_one, 0.1 * thirty_one),
                _ => continue,
            };
            assert!((error - expected).abs() <= tolerance, "{hertz} Hz, N = {harmonics}: {error:e}");
            if harmonics == 31 {
                assert!(
                    (solution.contacts[0].dissipation / orbit.dissipation - 1.0).abs() < 1e-4,
                    "{hertz} Hz"
                );
            }
        }
    }
}

#[test]
fn scene_p_reaches_the_exact_orbit() {
    let amplitudes = [
        (40.0, 1.166768192e-4),
        (55.0, 3.591562365e-5),
        (60.0, 2.509777370e-5),
        (108.0, 1.945075923e-5),
        (118.0, 3.460092910e-5),
    ];
    let exact = exact_orbits("P");
    let plan = plan(&scene_p(), 31, 4096);
    let mut workspace = plan.workspace();
    for (hertz, amplitude) in amplitudes {
        let orbit = exact.iter().find(|orbit| orbit.hertz == hertz).unwrap();
        assert!((orbit.harmonics[0].1.norm() / amplitude - 1.0).abs() < 1e-9, "{hertz} Hz");
        let solution = plan.solve(hertz, &mut workspace);
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        let error = orbit.error(&plan, &solution.displacement[0]);
        assert!(error < 2e-6, "{hertz} Hz: {error:e}");
    }
}

/// By its events the force has no sampling error: the table's two digits, and no samples asked for.
#[test]
fn events_leave_truncation_alone() {
    for (problem, scene) in [(scene_r(), "R"), (scene_p(), "P")] {
        let plan = Plan::new(&problem, &Settings::new(31)).unwrap();
        assert_eq!((plan.facts().event_exact, plan.facts().samples), (1, 0));
        let mut workspace = plan.workspace();
        for orbit in exact_orbits(scene) {
            let solution = plan.solve(orbit.hertz, &mut workspace);
            assert_eq!(solution.status, Status::Converged, "{} Hz", orbit.hertz);
            let error = orbit.error(&plan, &solution.displacement[0]);
            match SCENE_R.iter().find(|row| row.0 == orbit.hertz && scene == "R") {
                // Half a unit of the second digit of the smallest entry.
                Some(row) => assert!((error / row.3 - 1.0).abs() < 0.02, "{} Hz: {error:e}", orbit.hertz),
                None => assert!(error < 2e-6, "{} Hz: {error:e}", orbit.hertz),
            }
        }
    }
}

/// The sampled force approaches the one by events with the square of the number of samples.
#[test]
fn samples_approach_events() {
    let settings = Settings::new(7);
    let exact = Plan::new(&scene_r(), &settings).unwrap();
    let expected = exact.solve(75.0, &mut exact.workspace());
    let error = |samples: usize| -> f64 {
        // Averaged over phases of the excitation, which move kinks against samples.
        (0..8)
            .map(|shift| {
                let mut problem = scene_r();
                problem.excitation[0].phase = 0.31 * f64::from(shift);
                let plan = plan(&problem, 7, samples);
                let solution = plan.solve(75.0, &mut plan.workspace());
                (solution.displacement[0][0].norm() / expected.displacement[0][0].norm() - 1.0).abs()
            })
            .sum()
    };
    let rate = (error(128) / error(4096)).log2() / 5.0;
    assert!((rate - 2.0).abs() < 0.25, "{rate}");
}

/// Stick–slip: F_k ~ k⁻², W_k ~ k⁻⁴, so the l2 error falls like (N + 1)^−3.5, √Σ_{k>N} k⁻⁸. The first harmonic feels the
/// tail through Σ_{k>N} W_k K_{1−k} ~ Σ k⁻⁵, and through w at the turning points, Σ k⁻⁴ e^{ik(τ_r − τ_e)}, whose terms
/// alternate since slip does not begin where it ends: both fall like (N + 1)^−4.
#[test]
fn rates_of_convergence_of_stick_slip() {
    let orders = [31, 63, 127, 255];
    let (mut spectra, mut firsts) = (Vec::new(), Vec::new());
    for (problem, scene) in [(scene_r(), "R"), (scene_p(), "P")] {
        let plans = orders.map(|n| Plan::new(&problem, &Settings::new(n)).unwrap());
        let mut workspaces = plans.each_ref().map(Plan::workspace);
        for orbit in exact_orbits(scene) {
            let first = orbit.harmonics[0].1.norm();
            let mut errors = Vec::new();
            for (plan, workspace) in plans.iter().zip(&mut workspaces) {
                let solution = plan.solve(orbit.hertz, workspace);
                let found = &solution.displacement[0];
                errors.push((orbit.error(plan, found), (found[0].norm() / first - 1.0).abs()));
            }
            spectra.push(rate(&orders, errors.iter().map(|e| e.0)));
            firsts.push(rate(&orders, errors.iter().map(|e| e.1)));
        }
    }
    let mean = |rates: &[f64]| rates.iter().sum::<f64>() / rates.len() as f64;
    assert!((mean(&spectra) + 3.5).abs() < 0.1, "{spectra:?}");
    assert!(spectra.iter().all(|rate| (rate + 3.5).abs() < 0.4), "{spectra:?}");
    // A single frequency may pass a zero of its error; all together do not.
    assert!((mean(&firsts) + 4.0).abs() < 0.2, "{firsts:?}");
}

/// Slope of ln error over ln (N + 1).
fn rate(orders: &[usize], errors: impl Iterator<Item = f64>) -> f64 {
    let points: Vec<(f64, f64)> =
        orders.iter().zip(errors).map(|(&n, error)| ((n as f64 + 1.0).ln(), error.ln())).collect();
    let n = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    covariance / points.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

/// Newton's method for the harmonics that need it, substitution for the rest: the same balance, and errors that samples
/// cannot reach.
#[test]
fn a_slaved_tail_reaches_the_exact_orbit() {
    let with_tail = Plan::new(&scene_r(), &Settings::new(287)).unwrap();
    let mut tail_workspace = with_tail.workspace();
    let mut settings = Settings::new(95);
    let short = Plan::new(&scene_r(), &settings).unwrap();
    settings.slaving = false;
    let by_newton = Plan::new(&scene_r(), &settings).unwrap();
    for orbit in exact_orbits("R") {
        let solution = with_tail.solve(orbit.hertz, &mut tail_workspace);
        assert_eq!((solution.status, solution.slaved), (Status::Converged, 128), "{} Hz", orbit.hertz);
        let error = orbit.error(&with_tail, &solution.displacement[0]);
        assert!(error < 1e-8, "{} Hz: {error:e}", orbit.hertz);

        let slaved = short.solve(orbit.hertz, &mut short.workspace());
        let full = by_newton.solve(orbit.hertz, &mut by_newton.workspace());
        assert_eq!((slaved.slaved, full.slaved), (32, 0));
        let size = full.displacement[0][0].norm();
        for (a, b) in slaved.displacement[0].iter().zip(&full.displacement[0]) {
            assert!((a - b).norm() < 1e-10 * size, "{} Hz", orbit.hertz);
        }
    }
}

/// Where the structure answers high harmonics as much as low ones there is no tail.
#[test]
fn no_tail_where_substitution_does_not_contract() {
    let plan = Plan::new(&scene_r(), &Settings::new(63)).unwrap();
    // |Ĝ| at harmonic k is about 6.7e6 / (3.98 (kΩ)²): at 5 Hz above 0.05 up to k = 185.
    let slow = plan.solve(5.0, &mut plan.workspace());
    assert_eq!((slow.status, slow.slaved), (Status::Converged, 0));
    assert_eq!(plan.solve(75.0, &mut plan.workspace()).slaved, 16);
}

/// The loop law without interior reversals is smooth: its error falls faster than any power of N that a kink would leave.
#[test]
fn a_smooth_loop_converges_fast() {
    let problem = paper_scene();
    let spectrum = |harmonics: usize, hertz: f64| {
        let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
        let solution = plan.solve(hertz, &mut plan.workspace());
        assert_eq!((solution.status, solution.contacts[0].turning_points), (Status::Converged, 2));
        solution.displacement[0].clone()
    };
    for hertz in [75.0, 90.0, 100.0, 108.0, 112.0] {
        let reference = spectrum(127, hertz);
        let size: f64 = reference.iter().map(|w| w.norm_sqr()).sum();
        let error = |harmonics: usize| {
            let found = spectrum(harmonics, hertz);
            let padded = found.iter().copied().chain(std::iter::repeat(Complex64::ZERO));
            let change: f64 = reference.iter().zip(padded).map(|(a, b)| (a - b).norm_sqr()).sum();
            (change / size).sqrt()
        };
        let errors = [7, 15, 31, 63].map(error);
        let rates: Vec<f64> = errors.windows(2).map(|pair| (pair[1] / pair[0]).log2()).collect();
        // More than stick–slip's −3.5 from the first doubling, and far more at the last.
        assert!(rates[0] < -4.0 && rates[2] < -10.0, "{hertz} Hz: {rates:?}");
        assert!(errors[3] < 1e-8, "{hertz} Hz: {errors:?}");
    }
}
