//! The law that the book adds step by step: its page and the code here are the same, and the code is right.

#[path = "book_law/stribeck.rs"]
mod stribeck;

use std::sync::Arc;

use contact::{Coulomb, CoulombParameters, Law, Motion, SmoothForce, Workspace};
use faer::mat;
use hbm::{Contact, Plan, Settings, Status};
use num_complex::Complex64;
use stickslip_tests::{force, model};
use stribeck::Stribeck;

const PAGE: &str = include_str!("../docs/src/add-a-law.md");
const LAW: &str = include_str!("book_law/stribeck.rs");
const HERE: &str = include_str!("book_law.rs");

/// Falls by a fifth within 50 mm/s, and turns round within 20 mm/s.
const SQUEAL: Stribeck = Stribeck { coulomb: 4.0, peak: 5.0, fall: 0.05, turn: 0.02 };

/// Every Rust block of the page stands in one of the two files, the whole law in the first.
#[test]
fn the_page_shows_this_code() {
    let blocks: Vec<&str> =
        PAGE.split("```rust\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert!(blocks.len() >= 3, "{} blocks", blocks.len());
    assert_eq!(blocks[0], LAW, "the first block is the law's file");
    for block in &blocks[1..] {
        assert!(HERE.contains(block), "not in tests/book_law.rs:\n{block}");
    }
}

#[test]
fn the_derivative_is_that_of_the_force() {
    for v in [-0.05, -0.013, 0.0, 0.002, 0.02, 0.3] {
        let h = 1e-6;
        let slope = (SQUEAL.at(0.0, v + h) - SQUEAL.at(0.0, v - h)) / (2.0 * h);
        let exact = SQUEAL.slopes(0.0, v).1;
        assert!((slope - exact).abs() < 1e-5 * SQUEAL.peak / SQUEAL.turn, "{v}: {slope} {exact}");
    }
}

/// Without a fall it is the regularised Coulomb law, force and tangent.
#[test]
fn without_a_fall_it_is_coulombs() {
    let level = Stribeck { peak: 4.0, ..SQUEAL }.checked().unwrap();
    let coulomb = Coulomb::new(CoulombParameters { slip_force: 4.0, velocity: 0.02 }).unwrap();
    let velocity: Vec<f64> =
        (0..16).map(|j| -1e-4 * (j as f64 * std::f64::consts::TAU / 16.0).sin()).collect();
    let spectrum = [Complex64::ZERO, Complex64::from(1e-4)];
    let motion = Motion {
        spectrum: &spectrum,
        displacement: &[0.0; 16],
        velocity: &velocity,
        odd: true,
        omega: 300.0,
    };
    let answer = |law: &dyn Law| {
        let mut workspace = Workspace::new(16);
        let mut force = vec![0.0; 16];
        law.force(&motion, &mut workspace, &mut force).unwrap();
        let tangent = law.tangent(&motion, &mut workspace);
        assert!(tangent.local.iter().all(|&kappa| kappa == 0.0));
        (force, tangent.rate().unwrap().to_vec())
    };
    let ((f, c), (f_coulomb, c_coulomb)) = (answer(&level), answer(&coulomb));
    for j in 0..16 {
        assert!((f[j] - f_coulomb[j]).abs() < 1e-14 * 4.0, "sample {j}");
        assert!((c[j] - c_coulomb[j]).abs() < 1e-12 * 4.0 / 0.02 * 300.0, "sample {j}");
    }
}

#[test]
fn a_wrong_parameter_is_named() {
    let error = Stribeck { turn: 0.0, ..SQUEAL }.checked().unwrap_err();
    assert_eq!(error.to_string(), "turn: must be positive, got 0");
}

/// Harmonic balance with the law, against the same motion followed in time.
#[test]
fn the_balance_is_the_motion_in_time() {
    let law: Arc<dyn Law> = Arc::new(SQUEAL.checked().unwrap());
    let problem = hbm::Problem {
        model: model(mat![[1.0]], mat![[20.0]], mat![[1e5]]),
        excitation: vec![force(0, 10.0)],
        contacts: vec![Contact { name: "pad".into(), first: 0, second: None, law: law.clone(), scale: 1.0 }],
        joints: Vec::new(),
        output: vec![0],
    };
    let plan = Plan::new(&problem, &Settings::new(127)).unwrap();
    let system = orbit::System {
        mass: mat![[1.0]],
        damping: mat![[20.0]],
        stiffness: mat![[1e5]],
        loads: vec![orbit::Load { dof: 0, harmonic: 1, amplitude: Complex64::from(10.0) }],
        contacts: vec![orbit::Contact { name: "pad".into(), first: 0, second: None, law, scale: 1.0 }],
        joints: Vec::new(),
    };
    for hertz in [40.0, 50.0, 65.0] {
        let solution = plan.solve(hertz, &mut plan.workspace());
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        let exact = orbit::find(&system, hertz, &orbit::Settings::default()).unwrap().spectrum(0, 127);
        let w = &solution.displacement[0];
        let pairs = plan.orders().iter().zip(w).map(|(&k, w)| (w - exact[k]).norm());
        let error = pairs.fold(0.0, f64::max) / exact[1].norm();
        assert!(error < 1e-8, "{hertz} Hz: {error:e}");
    }
}
