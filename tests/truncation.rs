//! Harmonic truncation against exact periodic orbits (`reference/exact_orbits.json`).

use hbm::{Plan, Problem, Settings, Status};
use num_complex::Complex64;
use serde_json::Value;
use stickslip_tests::{scene_p, scene_r};

/// Exact harmonics of w1 and energy per cycle at one frequency.
struct Orbit {
    hertz: f64,
    harmonics: Vec<(usize, Complex64)>,
    dissipation: f64,
}

fn orbits(scene: &str) -> Vec<Orbit> {
    let data: Value = serde_json::from_str(include_str!("reference/exact_orbits.json")).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    let points = data[scene]["points"].as_array().unwrap();
    let orbit = |point: &Value| Orbit {
        hertz: number(&point["hertz"]),
        harmonics: point["w1"]
            .as_array()
            .unwrap()
            .iter()
            .map(|h| (h[0].as_u64().unwrap() as usize, Complex64::new(number(&h[1]), number(&h[2]))))
            .collect(),
        dissipation: number(&point["dissipation"]),
    };
    points.iter().map(orbit).collect()
}

/// Relative l2 error of the spectrum of w1 over all harmonics.
fn error(plan: &Plan, found: &[Complex64], exact: &Orbit) -> f64 {
    let at = |k: usize| {
        plan.orders().iter().position(|&order| order == k).map_or(Complex64::ZERO, |slot| found[slot])
    };
    let difference: f64 = exact.harmonics.iter().map(|&(k, w)| (at(k) - w).norm_sqr()).sum();
    let size: f64 = exact.harmonics.iter().map(|(_, w)| w.norm_sqr()).sum();
    (difference / size).sqrt()
}

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
    let exact = orbits("R");
    for (hertz, amplitude, one, thirty_one) in SCENE_R {
        let orbit = exact.iter().find(|orbit| orbit.hertz == hertz).unwrap();
        assert!((orbit.harmonics[0].1.norm() / amplitude - 1.0).abs() < 1e-9, "{hertz} Hz");
        for harmonics in [1, 3, 7, 15, 31] {
            let plan = plan(&scene_r(), harmonics, 4096);
            let solution = plan.solve(hertz, &mut plan.workspace());
            assert_eq!(solution.status, Status::Converged, "{hertz} Hz, N = {harmonics}");
            let error = error(&plan, &solution.displacement[0], orbit);
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
    let exact = orbits("P");
    let plan = plan(&scene_p(), 31, 4096);
    let mut workspace = plan.workspace();
    for (hertz, amplitude) in amplitudes {
        let orbit = exact.iter().find(|orbit| orbit.hertz == hertz).unwrap();
        assert!((orbit.harmonics[0].1.norm() / amplitude - 1.0).abs() < 1e-9, "{hertz} Hz");
        let solution = plan.solve(hertz, &mut workspace);
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        let error = error(&plan, &solution.displacement[0], orbit);
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
        for orbit in orbits(scene) {
            let solution = plan.solve(orbit.hertz, &mut workspace);
            assert_eq!(solution.status, Status::Converged, "{} Hz", orbit.hertz);
            let error = error(&plan, &solution.displacement[0], &orbit);
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

/// Stick–slip: F_k ~ k⁻², W_k ~ k⁻⁴, so the l2 error falls like (N + 1)^−3.5 and that of |W_1| like (N + 1)^−3.
#[test]
fn rates_of_convergence_of_stick_slip() {
    let exact = orbits("R");
    let orders = [31, 63, 127];
    let slope = |errors: &[f64]| {
        let n = errors.len() as f64;
        let x: Vec<f64> = orders.iter().map(|&n| f64::ln(n as f64 + 1.0)).collect();
        let y: Vec<f64> = errors.iter().map(|e| e.ln()).collect();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let covariance: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
        covariance / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>()
    };
    let mut rates = Vec::new();
    for orbit in &exact {
        let errors: Vec<f64> = orders
            .iter()
            .map(|&harmonics| {
                let plan = plan(&scene_r(), harmonics, 1 << 15);
                let solution = plan.solve(orbit.hertz, &mut plan.workspace());
                error(&plan, &solution.displacement[0], orbit)
            })
            .collect();
        rates.push(slope(&errors));
    }
    let mean = rates.iter().sum::<f64>() / rates.len() as f64;
    assert!((mean + 3.5).abs() < 0.15, "{rates:?}");
}
