//! Harmonic balance with joints against exact orbits, and in two tangential directions against motion followed in time.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{FrictionContactParameters, Gap, GapParameters};
use faer::mat;
use hbm::{Plan, Settings, Status};
use num_complex::Complex64;
use orbit::{Load, System};
use stickslip_tests::joint_models::{JOINT, balanced, one_mass, planar, preloaded, root};
use stickslip_tests::orbit_models::{contact, load, orbit};
use stickslip_tests::planar_truth::Planar;

/// One row a dof, k = 0 ….
type Spectra = Vec<Vec<Complex64>>;

/// Amplitudes of a solution, k = 0 …, and the estimate of its error from sampling.
fn solved(system: &System, hertz: f64, harmonics: usize, samples: Option<usize>) -> (Spectra, Option<f64>) {
    let settings = Settings { samples, estimate: true, ..Settings::new(harmonics) };
    let plan = Plan::new(&balanced(system), &settings).unwrap();
    let solution = plan.solve(hertz, &mut plan.workspace());
    assert_eq!(solution.status, Status::Converged, "{hertz} Hz, N = {harmonics}");
    let row = |row: &Vec<Complex64>| {
        let mut all = vec![Complex64::ZERO; harmonics + 1];
        plan.orders().iter().zip(row).for_each(|(&k, w)| all[k] = *w);
        all
    };
    (solution.displacement.iter().map(row).collect(), solution.sampling_error)
}

/// l2 distance of spectra relative to the second, all dofs together; harmonics that one does not have are zero there.
fn distance(a: &Spectra, b: &Spectra) -> f64 {
    let at = |row: &[Complex64], k: usize| row.get(k).copied().unwrap_or_default();
    let (mut sum, mut size) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        for k in 0..a.len().max(b.len()) {
            sum += (at(a, k) - at(b, k)).norm_sqr();
            size += at(b, k).norm_sqr();
        }
    }
    (sum / size).sqrt()
}

fn impact(gap: f64) -> System {
    System {
        mass: mat![[1.3]],
        damping: mat![[25.0]],
        stiffness: mat![[2.1e5]],
        loads: vec![load(0, 1, 6.0)],
        contacts: vec![contact(0, None, Arc::new(Gap::new(GapParameters { stiffness: 9e5, gap }).unwrap()))],
        joints: Vec::new(),
    }
}

/// Least-squares slope of log error over log (N + 1).
fn rate(errors: &[(usize, f64)]) -> f64 {
    let points: Vec<(f64, f64)> = errors.iter().map(|(n, e)| (((n + 1) as f64).ln(), e.ln())).collect();
    let count = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    -points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Forces bend at events (k⁻²), displacements follow with k⁻⁴: what is left out beyond N is of order (N + 1)^−3.5.
#[test]
fn the_error_falls_with_the_harmonics() {
    for (name, system, hertz) in [
        ("pressed", one_mass(preloaded(18.0)), 60.0),
        ("lifted", one_mass(preloaded(6.0)), 70.0),
        ("root", root(preloaded(8.0)), 47.0),
        ("impact", impact(1.5e-5), 90.0),
        ("pressed in a plane", planar(preloaded(18.0)), 60.0),
        ("lifted in a plane", planar(preloaded(5.0)), 70.0),
    ] {
        // Two tangential directions are sampled; enough samples leave the truncation alone.
        let samples = system.joints.iter().any(|joint| joint.directions.len() == 3).then_some(1 << 14);
        let orbit = orbit(&system, hertz);
        let exact: Spectra = (0..system.mass.nrows()).map(|dof| orbit.spectrum(dof, 1023)).collect();
        let errors: Vec<(usize, f64)> = [11, 23, 47, 95]
            .into_iter()
            .map(|n| (n, distance(&solved(&system, hertz, n, samples).0, &exact)))
            .collect();
        println!("{name} at {hertz} Hz: {errors:?}, rate {}", rate(&errors));
        assert!(rate(&errors) > 3.2, "{name}: {errors:?}");
        assert!(errors.last().unwrap().1 < 1e-7, "{name}: {errors:?}");
    }
}

/// The error that samples bring, measured against many more of them, and what is said about it.
#[test]
fn the_sampling_estimate_is_truthful() {
    for (name, system, hertz) in [
        ("pressed", one_mass(preloaded(18.0)), 60.0),
        ("lifted", one_mass(preloaded(6.0)), 70.0),
        ("root", root(preloaded(8.0)), 47.0),
        ("pressed in a plane", planar(preloaded(18.0)), 60.0),
        ("lifted in a plane", planar(preloaded(5.0)), 70.0),
    ] {
        let (many, _) = solved(&system, hertz, 31, Some(1 << 15));
        for samples in [256, 1024, 4096] {
            let (few, claimed) = solved(&system, hertz, 31, Some(samples));
            let (error, claimed) = (distance(&few, &many), claimed.unwrap());
            println!("{name}, {samples} samples: {error:e}, claimed {claimed:e}");
            assert!(claimed > error && claimed < 10.0 * error, "{name}, {samples}: {error:e} {claimed:e}");
        }
    }
}

/// A rotating load on a round structure: with β = arcsin(r/A), r = μN/k_t, the force leads the displacement by π/2 − β, so
/// that `|(c − mΩ² + idΩ) A + μN (sin β + i cos β)| = F`.
fn rotating(preload: f64, hertz: f64) -> (System, f64) {
    let mut system = planar(preloaded(preload));
    system.stiffness = mat![[2e5, 0.0, 0.0], [0.0, 2e5, 0.0], [0.0, 0.0, 4e5]];
    system.loads =
        vec![load(0, 1, 14.0), Load { dof: 1, harmonic: 1, amplitude: Complex64::new(0.0, -14.0) }];
    let omega = TAU * hertz;
    let (limit, kt) = (JOINT.friction_coefficient * preload, JOINT.tangential_stiffness);
    let needed = |a: f64| {
        let sine = (limit / kt / a).min(1.0);
        let structure = Complex64::new(2e5 - omega * omega, 200.0 * omega) * a;
        (structure + limit * Complex64::new(sine, (1.0 - sine * sine).sqrt())).norm()
    };
    let (mut low, mut high) = (limit / kt, 1.0);
    assert!(needed(low) < 14.0, "it slips");
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if needed(middle) < 14.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (system, low)
}

#[test]
fn a_rotating_load_has_a_closed_form() {
    for hertz in [40.0, 80.0] {
        let (system, amplitude) = rotating(15.0, hertz);
        let errors = [256, 1024, 4096].map(|samples| {
            let (found, _) = solved(&system, hertz, 3, Some(samples));
            let error = |dof: usize| (found[dof][1].norm() / amplitude - 1.0).abs();
            error(0).max(error(1))
        });
        println!("{hertz} Hz: {errors:?}");
        // The law is of second order in the distance of its samples.
        assert!(errors[2] < 1e-6, "{hertz} Hz: {errors:?}");
        assert!(errors[1] < errors[0] / 12.0 && errors[2] < errors[1] / 12.0, "{hertz} Hz: {errors:?}");
        let mut truth = Planar::new(&system, &preloaded(15.0), hertz);
        let period = truth.periodic(512, 1e-14, 100);
        for dof in 0..2 {
            let error = (period.spectrum(dof, 1)[1].norm() / amplitude - 1.0).abs();
            assert!(error < 1e-8, "{hertz} Hz: {error:e}");
        }
    }
}

/// Motion along one axis is that of an exact orbit with one tangential direction.
#[test]
fn motion_in_time_along_one_axis_is_the_exact_orbit() {
    for (preload, hertz) in [(18.0, 60.0), (6.0, 70.0)] {
        let parameters = preloaded(preload);
        let mut line = one_mass(parameters);
        line.damping = mat![[200.0, 0.0], [0.0, 250.0]];
        line.loads.iter_mut().for_each(|load| load.amplitude *= 1.5);
        let orbit = orbit(&line, hertz);
        let mut plane = planar(parameters);
        plane.loads = line.loads.iter().map(|load| Load { dof: 2 * load.dof, ..*load }).collect();
        let mut errors = Vec::new();
        for steps in [256, 512, 1024] {
            let mut truth = Planar::new(&plane, &parameters, hertz);
            let period = truth.periodic(steps, 1e-13, 100);
            println!("{steps} steps: {} events, {} periods", truth.events, period.periods);
            let size = period.displacement.iter().map(|w| w[0].abs()).fold(0.0, f64::max);
            let instant = |j: usize| orbit.period() * j as f64 / steps as f64;
            let distance = |(j, w): (usize, &Vec<f64>)| {
                let apart = (w[0] - orbit.displacement(0, instant(j))).abs();
                apart.max((w[2] - orbit.displacement(1, instant(j))).abs()) / size
            };
            errors.push(period.displacement.iter().enumerate().map(distance).fold(0.0, f64::max));
        }
        println!("{preload} N: {errors:?}");
        assert!(errors[2] < 1e-9 && errors[1] < errors[0] / 8.0 && errors[2] < errors[1] / 8.0, "{errors:?}");
    }
}

/// Both tangential directions slip together, pressed all the time and lifting off.
#[test]
fn friction_in_two_directions_is_that_of_motion_in_time() {
    let scenes: [(&str, FrictionContactParameters, f64); 2] =
        [("pressed", preloaded(18.0), 60.0), ("lifted", preloaded(5.0), 70.0)];
    for (name, parameters, hertz) in scenes {
        let system = planar(parameters);
        let spectra = |steps: usize| -> Spectra {
            let mut truth = Planar::new(&system, &parameters, hertz);
            let period = truth.periodic(steps, 1e-12, 100);
            println!("{name}: {steps} steps, {} events, closure {:e}", truth.events, period.closure);
            (0..3).map(|dof| period.spectrum(dof, 127)).collect()
        };
        let (coarse, fine) = (spectra(256), spectra(512));
        let own = distance(&coarse, &fine);
        let errors: Vec<(usize, f64)> = [7, 15, 31]
            .into_iter()
            .map(|n| (n, distance(&solved(&system, hertz, n, Some(1 << 13)).0, &fine)))
            .collect();
        println!("{name}: {errors:?}, rate {}, truth changes by {own:e}", rate(&errors));
        assert!(own < 1e-7, "{name}: {own:e}");
        assert!(rate(&errors) > 3.0 && errors[2].1 < 3e-6, "{name}: {errors:?}");
    }
}
