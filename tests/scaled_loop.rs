//! The loop law against an independent implementation of it (`reference/scaled_loop.json`).

use std::sync::Arc;

use contact::{Law, MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry, Workspace};
use faer::mat;
use hbm::{Plan, Problem, Settings, Status};
use hysteresis::Loop;
use num_complex::Complex64;
use serde_json::Value;
use stickslip_tests::{SampledMotion, force, model, to_ground};

fn reference() -> Value {
    serde_json::from_str(include_str!("reference/scaled_loop.json")).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

fn list(v: &Value) -> &[Value] {
    v.as_array().unwrap()
}

fn complex(v: &Value) -> Complex64 {
    Complex64::new(number(&v[0]), number(&v[1]))
}

/// `[[k, re, im], …]` as a dense spectrum.
fn spectrum(v: &Value) -> Vec<Complex64> {
    let mut dense = Vec::new();
    for entry in list(v) {
        let k = number(&entry[0]) as usize;
        dense.resize(dense.len().max(k + 1), Complex64::ZERO);
        dense[k] = Complex64::new(number(&entry[1]), number(&entry[2]));
    }
    dense
}

fn law(data: &Value, name: &str) -> ScaledLoop {
    let measured = Loop::new(8e-6, spectrum(&data["parameters"]["loops"][name])).unwrap();
    ScaledLoop::new(&measured, 0.0, MagnitudeLaw::default(), PhaseLaw::default(), Symmetry::Auto).unwrap()
}

fn two_mass(law: ScaledLoop) -> Problem {
    Problem {
        joints: Vec::new(),
        model: model(
            mat![[4.0, 0.0], [0.0, 1.27]],
            mat![[24.0, 0.0], [0.0, 24.0]],
            mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
        ),
        excitation: vec![force(1, 9.1)],
        contacts: vec![to_ground(Arc::new(law))],
        output: vec![0, 1],
    }
}

#[test]
fn the_describing_function_is_eqs_6_to_9() {
    let data = reference();
    let law = law(&data, "odd");
    for row in list(&data["law"]["rows"]) {
        let w = complex(&row["w1"]);
        let expected = complex(&row["force"]);
        let first = law.describing_function().unwrap().first_harmonic(w.norm()).force * w / w.norm();
        assert!((first + expected).norm() < 1e-13 * expected.norm(), "α = {}", row["alpha"]);
    }
}

#[test]
fn one_harmonic_of_the_two_masses() {
    let data = reference();
    let plan = Plan::new(&two_mass(law(&data, "odd")), &Settings::new(1)).unwrap();
    let mut workspace = plan.workspace();
    for row in list(&data["single"]["rows"]) {
        let solution = plan.solve(number(&row["hertz"]), &mut workspace);
        assert_eq!(solution.solutions, Some(number(&row["sliding"]) as usize));
        for (found, expected) in solution.displacement.iter().zip([&row["w1"][0], &row["w2"][0]]) {
            let expected = complex(expected);
            assert!((found[0] - expected).norm() < 1e-12 * expected.norm(), "{} Hz", row["hertz"]);
        }
    }
}

/// Force over one period at 64 phases, with nested minor loops, a mean, and even harmonics.
#[test]
fn force_in_time_with_masings_memory() {
    let data = reference();
    let samples = 64;
    let mut deepest = 0.0_f64;
    // One row rests on another reading of how minor branches of a loop that is not odd are scaled; here they aim at the
    // reversal before, as Madelung's rules have it.
    for row in list(&data["forces"]["rows"]).iter().filter(|row| row["reading"] == false) {
        let law = law(&data, row["loop"].as_str().unwrap());
        let spectrum: Vec<Complex64> = spectrum(&row["w_micrometre"]).iter().map(|w| w * 1e-6).collect();
        let motion = SampledMotion::new(&spectrum, samples);
        let mut force = vec![0.0; samples];
        law.force(&motion.motion(), &mut Workspace::new(samples), &mut force).unwrap();
        for (j, (f, expected)) in force.iter().zip(list(&row["f_measured"])).enumerate() {
            let error = (f - number(expected)).abs() / 12.0;
            assert!(error < 1e-12, "{}, sample {j}: {f} instead of {expected}", row["name"]);
        }
        deepest = deepest.max(number(&row["nesting"]));
    }
    assert!(deepest >= 3.0, "no motion with loops inside loops inside loops");
}

/// Balances with three and seven harmonics, interior reversals and several solutions included.
#[test]
fn harmonic_balance_with_the_loop_law() {
    let data = reference();
    let rows = list(&data["balance"]["rows"]);
    let mut several = 0;
    for row in rows.iter().filter(|row| number(&row["solution"]) == 0.0) {
        let same = |other: &&Value| ["loop", "hertz", "n"].iter().all(|key| other[*key] == row[*key]);
        let candidates: Vec<&Value> = rows.iter().filter(same).collect();
        several += usize::from(candidates.len() > 1);
        let problem = two_mass(law(&data, row["loop"].as_str().unwrap()));
        let mut settings = Settings::new(number(&row["n"]) as usize);
        settings.samples = Some(1 << 14);
        let plan = Plan::new(&problem, &settings).unwrap();
        let solution = plan.solve(number(&row["hertz"]), &mut plan.workspace());
        assert_eq!(solution.status, Status::Converged, "{} Hz", row["hertz"]);
        let distance = |candidate: &Value| -> f64 {
            let expected = spectrum(&candidate["w1"]);
            let pairs = || plan.orders().iter().zip(&solution.displacement[0]);
            let error: f64 = pairs().map(|(&k, w)| (w - expected[k]).norm_sqr()).sum();
            (error / expected.iter().map(|w| w.norm_sqr()).sum::<f64>()).sqrt()
        };
        let best = candidates.iter().map(|c| distance(c)).fold(f64::INFINITY, f64::min);
        // Kinks at interior reversals leave a sampling error of order M⁻².
        let reversals = candidates.iter().any(|c| number(&c["turning_points"]) > 2.0);
        let tolerance = if reversals { 2e-6 } else { 1e-10 };
        assert!(best < tolerance, "{} at {} Hz, N = {}: {best:e}", row["loop"], row["hertz"], row["n"]);
    }
    assert!(several > 0);
}
