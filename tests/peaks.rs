//! Peaks over a parameter: against closed forms, dense sweeps, published peaks and nonlinear modes.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use contact::{Cubic, CubicParameters};
use faer::mat;
use hbm::{
    Damping, Model, OptimumKind, PeakCurve, PeakEnd, PeakOptions, PeakStatus, Plan, Problem, Settings,
    follow_peaks,
};
use num_complex::Complex64;
use stickslip_tests::{elastic_coulomb, force, scene_r, to_ground, two_mass, unit_masses};

fn options(range: (f64, f64), frequencies: (f64, f64)) -> PeakOptions<'static> {
    PeakOptions {
        range,
        logarithmic: true,
        surveys: 9,
        frequencies,
        output: 0,
        threads: Some(2),
        progress: &|_, _| true,
    }
}

fn follow(problem: &(dyn Fn(f64) -> Problem + Sync), harmonics: usize, options: &PeakOptions) -> PeakCurve {
    let curve = follow_peaks(&|x| Some(problem(x)), &Settings::new(harmonics), options).unwrap();
    assert_eq!(curve.end, PeakEnd::Reached);
    assert!(curve.points.iter().all(|p| p.status.sound()), "{:?}", statuses(&curve));
    curve
}

fn statuses(curve: &PeakCurve) -> Vec<(f64, PeakStatus)> {
    curve.points.iter().map(|p| (p.parameter, p.status)).collect()
}

fn close(found: f64, known: f64, tolerance: f64) {
    assert!((found / known - 1.0).abs() < tolerance, "{found} instead of {known}");
}

/// One mass of 2 kg on 8e4 N/m under 3 N, with damping d and a contact to the ground.
fn oscillator(d: f64, contacts: Vec<hbm::Contact>) -> Problem {
    Problem {
        joints: Vec::new(),
        model: Model::new(mat![[2.0]], Damping::Matrix(mat![[d]]), mat![[8e4]]).unwrap(),
        excitation: vec![force(0, 3.0)],
        contacts,
        output: vec![0],
    }
}

/// |W| is largest at ω² = ω0² − d²/2m², where it is f/(d √(ω0² − d²/4m²)).
#[test]
fn a_linear_peak_over_its_damping() {
    let options = options((2.0, 200.0), (1.0, 100.0));
    let curve = follow(&|d| oscillator(d, Vec::new()), 1, &options);
    assert!(curve.points.len() > 20);
    for point in &curve.points {
        let decay = (point.parameter / 2.0).powi(2);
        let natural = 8e4 / 2.0;
        assert_eq!(point.peaks.len(), 1);
        let peak = &point.peaks[0];
        close(peak.solution.frequency * TAU, (natural - 0.5 * decay).sqrt(), 1e-8);
        close(peak.amplitude, 3.0 / (point.parameter * (natural - 0.25 * decay).sqrt()), 1e-10);
    }
    let optimum = curve.optimum.unwrap();
    assert_eq!((optimum.kind, optimum.point.parameter), (OptimumKind::End, 200.0));
}
