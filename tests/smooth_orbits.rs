//! Exact orbits of smooth systems against harmonic balance with many harmonics, and against their own equations.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Coulomb, CoulombParameters, Cubic, CubicParameters, Law, Linear, LinearParameters};
use faer::{Mat, mat};
use hbm::{Plan, Status};
use num_complex::Complex64;
use orbit::{Contact, Orbit, Settings, State, System};
use stickslip_tests::orbit_models::{contact, load, orbit, orbit_from, unit_masses};
use stickslip_tests::{scene_p_cubic, unit_masses as unit_masses_in_balance};

fn cubic(stiffness: f64) -> Arc<dyn Law> {
    Arc::new(Cubic::new(CubicParameters { stiffness }).unwrap())
}

fn coulomb(slip_force: f64, velocity: f64) -> Arc<dyn Law> {
    Arc::new(Coulomb::new(CoulombParameters { slip_force, velocity }).unwrap())
}

/// Largest difference of a dof's harmonics from those of harmonic balance, relative to the largest harmonic.
fn difference(orbit: &Orbit, plan: &Plan, solution: &hbm::Solution, dof: usize) -> f64 {
    let found = orbit.spectrum(dof, plan.orders().last().copied().unwrap());
    let size = found.iter().map(|w| w.norm()).fold(0.0, f64::max);
    let pairs = plan.orders().iter().zip(&solution.displacement[dof]);
    pairs.map(|(&k, w)| (w - found[k]).norm() / size).fold(0.0, f64::max)
}

#[test]
fn a_hardening_spring_moves_as_in_harmonic_balance() {
    let system = unit_masses(cubic(1e9));
    let plan = Plan::new(&scene_p_cubic(), &hbm::Settings::new(31)).unwrap();
    let mut workspace = plan.workspace();
    for hertz in [14.0, 30.0, 42.0, 50.0, 108.0] {
        let solution = plan.solve(hertz, &mut workspace);
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        let orbit = orbit(&system, hertz);
        for dof in [0, 1] {
            let error = difference(&orbit, &plan, &solution, dof);
            assert!(error < 1e-10, "{hertz} Hz, dof {dof}: {error:e}");
        }
        let exact: f64 = orbit.spectrum(1, 31).iter().map(|w| w.norm_sqr()).sum();
        assert!((orbit.norm(1) / exact.sqrt() - 1.0).abs() < 1e-12);
        assert!(orbit.dissipation(0).abs() < 1e-12 * 3.0 * orbit.norm(1));
    }
}

/// |H_k W_k + F_k − L_k| of both masses, relative to the load, with F_k from samples of k₃ w³.
fn imbalance(orbit: &Orbit, hertz: f64, stiffness: f64) -> f64 {
    let (harmonics, samples) = (31, 256);
    let w = [orbit.spectrum(0, harmonics), orbit.spectrum(1, harmonics)];
    let wave = |k: usize, j: usize| Complex64::cis(TAU * ((k * j) % samples) as f64 / samples as f64);
    let force: Vec<f64> = (0..samples)
        .map(|j| {
            let w: f64 = w[0].iter().enumerate().map(|(k, w)| (w * wave(k, j)).re).sum();
            stiffness * w.powi(3)
        })
        .collect();
    let mut worst = 0.0_f64;
    for (k, (w1, w2)) in w[0].iter().zip(&w[1]).enumerate().skip(1) {
        let f: Complex64 = force.iter().enumerate().map(|(j, f)| f * wave(k, j).conj()).sum();
        let omega = TAU * hertz * k as f64;
        let own = Complex64::new(-omega * omega, 2.0 * omega);
        let first = (3.8e5 + own) * w1 - 1.9e5 * w2 + f * (2.0 / samples as f64);
        let second = (1.9e5 + own) * w2 - 1.9e5 * w1 - if k == 1 { 3.0 } else { 0.0 };
        worst = worst.max(first.norm()).max(second.norm());
    }
    worst / 3.0
}

/// Between its folds the hardening spring has three orbits; the start chooses, also the unstable one.
#[test]
fn three_orbits_at_one_frequency() {
    let system = unit_masses(cubic(1e9));
    let mut settings = hbm::Settings::new(1);
    settings.all_solutions = true;
    let plan = Plan::new(&scene_p_cubic(), &settings).unwrap();
    for hertz in [43.225, 43.24, 43.255] {
        let solution = plan.solve(hertz, &mut plan.workspace());
        assert_eq!(solution.others.len(), 2, "{hertz} Hz");
        let mut amplitudes = Vec::new();
        for guess in std::iter::once(&solution).chain(&solution.others) {
            let first = |dof: usize| guess.displacement[dof][0];
            let rate = Complex64::new(0.0, TAU * hertz);
            let state = State {
                displacement: vec![first(0).re, first(1).re],
                velocity: vec![(rate * first(0)).re, (rate * first(1)).re],
                sliders: vec![],
            };
            let orbit = orbit_from(&system, hertz, &Settings { start: Some(state), ..Settings::default() });
            let amplitude = orbit.spectrum(1, 1)[1].norm();
            assert!((amplitude / first(1).norm() - 1.0).abs() < 0.05, "{hertz} Hz: {amplitude:e}");
            let residual = imbalance(&orbit, hertz, 1e9);
            assert!(residual < 1e-9, "{hertz} Hz: {residual:e}");
            amplitudes.push(amplitude);
        }
        amplitudes.sort_by(f64::total_cmp);
        assert!(amplitudes.windows(2).all(|pair| pair[1] > 1.02 * pair[0]), "{hertz} Hz: {amplitudes:?}");
    }
}

#[test]
fn regularised_coulomb_friction_moves_as_in_harmonic_balance() {
    // From creeping all the time to turning round within a tenth of the velocity amplitude.
    for (velocity, harmonics, bound) in [(0.1, 31, 1e-11), (0.02, 63, 1e-9), (0.005, 127, 1e-7)] {
        let law = coulomb(1.0, velocity);
        let mut settings = hbm::Settings::new(harmonics);
        settings.samples = Some(4096);
        let plan = Plan::new(&unit_masses_in_balance(law.clone()), &settings).unwrap();
        let mut workspace = plan.workspace();
        let system = unit_masses(law);
        for hertz in [30.0, 43.25, 60.0, 108.0] {
            let solution = plan.solve(hertz, &mut workspace);
            assert_eq!(solution.status, Status::Converged, "{velocity} m/s, {hertz} Hz");
            let orbit = orbit(&system, hertz);
            for dof in [0, 1] {
                let error = difference(&orbit, &plan, &solution, dof);
                assert!(error < bound, "{velocity} m/s, {hertz} Hz, dof {dof}: {error:e}");
            }
            let dissipation = solution.contacts[0].dissipation;
            assert!(
                (orbit.dissipation(0) / dissipation - 1.0).abs() < 100.0 * bound,
                "{velocity} m/s, {hertz} Hz"
            );
        }
    }
}

/// Nothing changes by more than the tolerance when the integrator has half of it, or much less.
#[test]
fn tolerances_are_kept() {
    for law in [cubic(1e9), coulomb(1.0, 1e-3)] {
        let system = unit_masses(law);
        for hertz in [30.0, 43.0, 60.0] {
            let at = |tolerance: f64| {
                orbit_from(&system, hertz, &Settings { tolerance, ..Settings::default() }).spectrum(0, 40)
            };
            let best = at(1e-14);
            for tolerance in [1e-7, 5e-8, 1e-10, 5e-11] {
                let coarse = at(tolerance);
                let error = coarse.iter().zip(&best).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
                assert!(error < 10.0 * tolerance * best[1].norm(), "{hertz} Hz, {tolerance:e}: {error:e}");
            }
        }
    }
}

/// Loads and laws without symmetry, a spring beside; in two systems of units.
#[test]
fn even_harmonics_and_units() {
    let spring: Arc<dyn Law> = Arc::new(Linear::new(LinearParameters { stiffness: 5e4 }).unwrap());
    let mut system = unit_masses(coulomb(1.0, 1e-2));
    system.loads.extend([load(0, 2, 1.0), load(1, 0, 2.0)]);
    system.contacts.push(contact(1, Some(0), cubic(3e8)));
    system.contacts.push(Contact { scale: 2.0, ..contact(1, None, spring) });
    // mm, kN, kt
    let softer: Arc<dyn Law> = Arc::new(Linear::new(LinearParameters { stiffness: 5e-2 }).unwrap());
    let times = |matrix: &Mat<f64>| Mat::from_fn(2, 2, |i, j| matrix[(i, j)] * 1e-6);
    let mut other = System {
        mass: times(&system.mass),
        damping: times(&system.damping),
        stiffness: times(&system.stiffness),
        loads: system.loads.clone(),
        contacts: vec![
            contact(0, None, coulomb(1e-3, 10.0)),
            contact(1, Some(0), cubic(3e8 * 1e-12)),
            Contact { scale: 2.0, ..contact(1, None, softer) },
        ],
        joints: Vec::new(),
    };
    other.loads.iter_mut().for_each(|load| load.amplitude *= 1e-3);
    for hertz in [20.0, 43.0, 70.0] {
        let (metres, millimetres) = (orbit(&system, hertz), orbit(&other, hertz));
        let (a, b) = (metres.spectrum(1, 20), millimetres.spectrum(1, 20));
        assert!(a[0].norm() > 0.01 * a[1].norm() && a[2].norm() > 1e-3 * a[1].norm(), "{hertz} Hz");
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b * 1e-3).norm() < 1e-12 * metres.norm(1), "{hertz} Hz");
        }
        // The mean: static equilibrium of both masses, in which friction takes no part.
        let force = |c: usize| metres.force_spectrum(c, 0)[0].re;
        let w = [metres.spectrum(0, 0)[0].re, a[0].re];
        let first = 3.8e5 * w[0] - 1.9e5 * w[1] - force(0) + force(1);
        let second = 1.9e5 * (w[1] - w[0]) - force(1) - force(2) - 2.0;
        assert!(first.abs().max(second.abs()) < 1e-10, "{hertz} Hz: {first:e} {second:e}");
    }
}

/// m ẅ + F_s tanh(ẇ/v) = f cos Ωt with ẇ ≪ v: a damper F_s/v.
#[test]
fn slow_creep_is_a_damper() {
    let system = System {
        mass: mat![[2.0]],
        damping: mat![[0.0]],
        stiffness: mat![[500.0]],
        loads: vec![load(0, 1, 1e-6)],
        contacts: vec![contact(0, None, coulomb(3.0, 0.5))],
        joints: Vec::new(),
    };
    let omega = TAU * 2.0;
    let found = orbit(&system, 2.0).spectrum(0, 3);
    let expected = 1e-6 / Complex64::new(500.0 - 2.0 * omega * omega, omega * 3.0 / 0.5);
    assert!((found[1] - expected).norm() < 1e-11 * expected.norm());
}
