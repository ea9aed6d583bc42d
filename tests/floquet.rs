//! Monodromy matrices of exact orbits and their multipliers: closed forms, and differences of motions followed apart.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Linear, LinearParameters};
use faer::mat;
use num_complex::Complex64;
use orbit::{Orbit, Settings, State, System};
use stickslip_tests::orbit_models::{contact, load, orbit, orbit_from, two_mass, unit_masses};

/// `m ẅ + d ẇ + (c + k) w`: λ = −δ ± iω_d, Φ = [[C + δS, S], [−ω₀²S, C − δS]] with C = e^{−δT} cos ω_d T,
/// S = e^{−δT} sin(ω_d T)/ω_d.
#[test]
fn a_linear_oscillator_has_its_closed_form() {
    let (m, d, c, k) = (2.5, 30.0, 4e5, 1e5);
    let spring = Linear::new(LinearParameters { stiffness: k }).unwrap();
    for hertz in [20.0, 71.0, 200.0] {
        let system = System {
            mass: mat![[m]],
            damping: mat![[d]],
            stiffness: mat![[c]],
            loads: vec![load(0, 1, 3.0)],
            contacts: vec![contact(0, None, Arc::new(spring))],
            joints: Vec::new(),
        };
        let orbit = orbit(&system, hertz);
        let (decay, natural) = (0.5 * d / m, ((c + k) / m).sqrt());
        let damped = (natural * natural - decay * decay).sqrt();
        let period = 1.0 / hertz;
        let shrink = (-decay * period).exp();
        let (cos, sin) = (shrink * (damped * period).cos(), shrink * (damped * period).sin() / damped);
        let expected = mat![[cos + decay * sin, sin], [-natural * natural * sin, cos - decay * sin]];
        let found = orbit.monodromy().unwrap();
        for i in 0..2 {
            for j in 0..2 {
                let unit = natural.powi(i as i32 - j as i32);
                let error = (found[(i, j)] - expected[(i, j)]).abs() / unit;
                assert!(error < 1e-12, "{hertz} Hz, entry {i} {j}: {error:e}");
            }
        }
        let mut multipliers = orbit.multipliers().unwrap();
        multipliers.sort_by(|a, b| a.im.total_cmp(&b.im));
        let angle = (damped * period).rem_euclid(TAU);
        for sign in [-1.0, 1.0] {
            let expected = Complex64::from_polar(shrink, sign * angle);
            let nearest = multipliers.iter().map(|m| (m - expected).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12, "{hertz} Hz: {multipliers:?}, expected {expected}");
        }
    }
}

/// Liouville: det Φ = e^{−tr(M⁻¹D) T} whatever the spring; of the three orbits between the folds of a hardening
/// spring the middle one alone is unstable, by a real multiplier beyond +1.
#[test]
fn of_three_orbits_the_middle_one_is_unstable() {
    let system = unit_masses(Arc::new(Cubic::new(CubicParameters { stiffness: 1e9 }).unwrap()));
    let hertz = 43.24;
    let mut settings = hbm::Settings::new(1);
    settings.all_solutions = true;
    let plan = hbm::Plan::new(&stickslip_tests::scene_p_cubic(), &settings).unwrap();
    let solution = plan.solve(hertz, &mut plan.workspace());
    let mut orbits: Vec<Orbit> = std::iter::once(&solution)
        .chain(&solution.others)
        .map(|found| {
            let omega = TAU * hertz;
            let w: Vec<Complex64> = found.displacement.iter().map(|row| row[0]).collect();
            let start = State {
                displacement: w.iter().map(|w| w.re).collect(),
                velocity: w.iter().map(|w| -omega * w.im).collect(),
                sliders: Vec::new(),
            };
            orbit_from(&system, hertz, &Settings { start: Some(start), ..Settings::default() })
        })
        .collect();
    orbits.sort_by(|a, b| a.norm(1).total_cmp(&b.norm(1)));
    assert_eq!(orbits.len(), 3);
    for (orbit, unstable) in orbits.iter().zip([false, true, false]) {
        let multipliers = orbit.multipliers().unwrap();
        let product: Complex64 = multipliers.iter().product();
        let expected = (-4.0 / hertz).exp();
        assert!((product - expected).norm() < 1e-10, "det {product}, expected {expected}");
        let first = multipliers[0];
        assert_eq!(first.norm() > 1.0, unstable, "{multipliers:?}");
        assert!(!unstable || (first.re > 1.0 && first.im.abs() < 1e-9), "{multipliers:?}");
    }
}

/// One period of the unit masses with a cubic spring, by the classical fourth-order Runge–Kutta method.
fn after_a_period(state: &[f64], hertz: f64) -> Vec<f64> {
    let steps = 4000;
    let h = 1.0 / (hertz * steps as f64);
    let rate = |t: f64, x: &[f64]| -> Vec<f64> {
        let load = 3.0 * (TAU * hertz * t).cos();
        let first = -3.8e5 * x[0] + 1.9e5 * x[1] - 2.0 * x[2] - 1e9 * x[0].powi(3);
        let second = 1.9e5 * x[0] - 1.9e5 * x[1] - 2.0 * x[3] + load;
        vec![x[2], x[3], first, second]
    };
    let add =
        |x: &[f64], dx: &[f64], h: f64| -> Vec<f64> { x.iter().zip(dx).map(|(x, d)| x + h * d).collect() };
    let mut x = state.to_vec();
    for step in 0..steps {
        let t = step as f64 * h;
        let k1 = rate(t, &x);
        let k2 = rate(t + 0.5 * h, &add(&x, &k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, &add(&x, &k2, 0.5 * h));
        let k4 = rate(t + h, &add(&x, &k3, h));
        for i in 0..4 {
            x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    x
}

/// Every column of Φ in its units against motions of another integrator that begin apart.
#[test]
fn columns_are_differences_of_motions() {
    let system = unit_masses(Arc::new(Cubic::new(CubicParameters { stiffness: 1e9 }).unwrap()));
    for hertz in [30.0, 50.0, 108.0] {
        let orbit = orbit(&system, hertz);
        let found = orbit.monodromy().unwrap();
        let state = orbit.state();
        let start: Vec<f64> = state.displacement.iter().chain(&state.velocity).copied().collect();
        let unit = |i: usize| if i < 2 { 1.0 } else { TAU * 100.0 };
        for j in 0..4 {
            let step = 1e-9 * unit(j);
            let moved = |step: f64| {
                let mut from = start.clone();
                from[j] += step;
                after_a_period(&from, hertz)
            };
            let (up, down) = (moved(step), moved(-step));
            for i in 0..4 {
                let slope = (up[i] - down[i]) / (2.0 * step);
                let error = (slope - found[(i, j)]).abs() * unit(j) / unit(i);
                assert!(error < 1e-6, "{hertz} Hz, entry {i} {j}: {slope} by differences, {}", found[(i, j)]);
            }
        }
    }
}

/// A slider that slips forgets: where it slips at t = 0 its column is zero, and all multipliers lie inside the unit
/// circle because friction only takes energy. Two motions approach each other by the largest of them every period.
#[test]
fn friction_makes_orbits_stable() {
    let slider = ElasticCoulombParameters { stiffness: 6.705e6, slip_force: 6.705e6 * 2.232e-6 };
    let system = two_mass(Arc::new(ElasticCoulomb::new(slider).unwrap()));
    for hertz in [57.0, 75.0, 100.0] {
        let orbit = orbit(&system, hertz);
        let multipliers = orbit.multipliers().unwrap();
        assert_eq!(multipliers.len(), 5);
        assert!(multipliers[0].norm() < 1.0, "{hertz} Hz: {multipliers:?}");
        let slips = (orbit.state().sliders[0].abs() - slider.slip_force).abs() < 1e-9;
        let column: f64 = (0..5).map(|i| orbit.monodromy().unwrap()[(i, 4)].abs()).sum();
        assert_eq!(slips, column == 0.0, "{hertz} Hz: force {:e}", orbit.state().sliders[0]);
    }
}
