//! Response curves through folds: against closed forms, published folds, and points solved one by one.

use std::sync::Arc;

use contact::{Coulomb, CoulombParameters};
use faer::mat;
use hbm::{
    ContinuationOptions, Curve, CurveEnd, Damping, Model, Plan, Problem, Settings, Status, entry_curve,
    frequency_curve,
};
use stickslip_tests::{
    elastic_coulomb, force, model, paper_scene, scaled_reference_loop, scene_p, scene_p_cubic, scene_r,
    to_ground, unit_masses,
};

fn curve(problem: &Problem, harmonics: usize, from: f64, to: f64) -> Curve {
    frequency_curve(problem, &Settings::new(harmonics), (from, to), &ContinuationOptions::default()).unwrap()
}

fn folds(curve: &Curve) -> Vec<(f64, f64)> {
    let amplitude = |p: &hbm::CurvePoint| p.solution.displacement[1][0].norm();
    curve.points.iter().filter(|p| p.fold).map(|p| (p.parameter, amplitude(p))).collect()
}

/// Peak and folds of the hardening spring as other codes find them (N = 7).
#[test]
fn the_bent_resonance_of_the_cubic_scene() {
    let curve = curve(&scene_p_cubic(), 7, 10.0, 150.0);
    assert_eq!(curve.end, CurveEnd::Reached);
    let folds = folds(&curve);
    assert_eq!(folds.len(), 2);
    for ((hertz, amplitude), (known_hertz, known_amplitude)) in
        folds.into_iter().zip([(43.262, 3.90e-3), (43.219, 2.66e-3)])
    {
        assert!((hertz - known_hertz).abs() < 5e-4, "{hertz}");
        assert!((amplitude / known_amplitude - 1.0).abs() < 6e-3, "{amplitude}");
    }
    let peak = curve.points.iter().find(|p| p.peaks == [1]).unwrap();
    assert!((peak.parameter - 43.2426).abs() < 3e-4, "{}", peak.parameter);
    assert!((peak.solution.displacement[1][0].norm() - 4.0177e-3).abs() < 5e-8);
    assert!(curve.points.iter().all(|p| p.solution.residual < 1e-9));
}

/// With one harmonic the number of solutions is known in closed form; it changes by two at a fold.
#[test]
fn solutions_appear_and_vanish_at_folds() {
    let problem = scene_p_cubic();
    let plan = Plan::new(&problem, &Settings::new(1)).unwrap();
    let mut workspace = plan.workspace();
    let mut solutions = |hertz: f64| plan.solve(hertz, &mut workspace).solutions.unwrap();
    for (from, to) in [(41.0, 46.0), (46.0, 41.0)] {
        let found = folds(&curve(&problem, 1, from, to));
        assert_eq!(found.len(), 2);
        for (hertz, _) in found {
            let counts = [solutions(hertz * (1.0 - 1e-9)), solutions(hertz * (1.0 + 1e-9))];
            assert!(counts == [1, 3] || counts == [3, 1], "{hertz}: {counts:?}");
        }
    }
}

/// Without folds a curve is what a sweep finds, in both directions.
#[test]
fn a_curve_passes_through_the_points_of_a_sweep() {
    for (problem, from) in [(scene_r(), 20.0), (scene_p(), 20.0), (paper_scene(), 55.0)] {
        let plan = Plan::new(&problem, &Settings::new(7)).unwrap();
        let mut workspace = plan.workspace();
        for curve in [curve(&problem, 7, from, 150.0), curve(&problem, 7, 150.0, from)] {
            assert_eq!(curve.end, CurveEnd::Reached);
            assert!(folds(&curve).is_empty());
            let ends = [curve.points.first().unwrap().parameter, curve.points.last().unwrap().parameter];
            assert!(ends.contains(&from) && ends.contains(&150.0));
            for point in curve.points.iter().step_by(7) {
                let alone = plan.solve(point.parameter, &mut workspace);
                let pairs =
                    alone.displacement.iter().flatten().zip(point.solution.displacement.iter().flatten());
                let (change, size) = pairs.fold((0.0, 0.0), |(change, size), (a, b)| {
                    (change + (a - b).norm_sqr(), size + a.norm_sqr())
                });
                assert!(change.sqrt() < 1e-8 * f64::sqrt(size), "{} Hz", point.parameter);
            }
        }
    }
}

/// A resonance a millionth as wide as the range is not stepped over, with the contact sticking and without.
#[test]
fn no_resonance_is_missed() {
    for (stiffness, slip_force) in [(6e4, 1e6), (1e-3, 1e-9)] {
        let mut problem = unit_masses(elastic_coulomb(stiffness, slip_force));
        let (mass, stiff) = (problem.model.mass().to_owned(), problem.model.stiffness().to_owned());
        problem.model = Model::new(mass, Damping::ModalRatio(1e-6), stiff).unwrap();
        let curve = curve(&problem, 1, 10.0, 200.0);
        assert_eq!(curve.end, CurveEnd::Reached);
        // Of w2, with the spring where it sticks: the roots of (3.8e5 + k − x)(1.9e5 − x) = 1.9e5².
        let k = if slip_force > 1.0 { stiffness } else { 0.0 };
        let (sum, product) = (5.7e5 + k, (3.8e5 + k) * 1.9e5 - 1.9e5 * 1.9e5);
        let root = f64::sqrt(sum * sum / 4.0 - product);
        for square in [sum / 2.0 - root, sum / 2.0 + root] {
            let hertz = f64::sqrt(square) / std::f64::consts::TAU;
            let peak = curve
                .points
                .iter()
                .find(|p| p.peaks.contains(&1) && (p.parameter - hertz).abs() < 1e-5 * hertz);
            assert!(peak.is_some(), "{stiffness} N/m: nothing at {hertz} Hz");
        }
    }
}

/// The excitation varied at one frequency: the amplitude folds over, and all points belong to their excitation.
#[test]
fn along_an_entry_of_the_problem() {
    let problem = |amplitude: f64| {
        let mut problem = scene_p_cubic();
        problem.excitation[0].amplitude = amplitude;
        Some(problem)
    };
    let hertz = 43.5;
    let along = |harmonics: usize| {
        let options = ContinuationOptions::default();
        entry_curve(&problem, hertz, &Settings::new(harmonics), (0.1, 20.0), &options).unwrap()
    };
    let curve = along(5);
    assert_eq!((curve.end, folds(&curve).len()), (CurveEnd::Reached, 2));
    let folds = folds(&curve);
    // With one harmonic the number of solutions at an excitation is known.
    for point in along(1).points.iter().filter(|p| p.fold) {
        let count = |excitation: f64| {
            let plan = Plan::new(&problem(excitation).unwrap(), &Settings::new(1)).unwrap();
            plan.solve(hertz, &mut plan.workspace()).solutions.unwrap()
        };
        let counts = [count(point.parameter * (1.0 - 1e-9)), count(point.parameter * (1.0 + 1e-9))];
        assert!(counts == [1, 3] || counts == [3, 1], "{}: {counts:?}", point.parameter);
        // More harmonics move the folds a little.
        assert!(folds.iter().any(|(at, _)| (at / point.parameter - 1.0).abs() < 0.05));
    }
}

/// Where friction holds the contact there is no curve to follow.
#[test]
fn a_contact_at_rest_has_no_curve() {
    let mut problem = paper_scene();
    problem.excitation[0].amplitude = 1e-3;
    assert_eq!(curve(&problem, 3, 70.0, 80.0).end, CurveEnd::Rest);
}

/// Ranges may begin at, end at and pass through zero; beyond it there may be no problem.
#[test]
fn zero_is_a_parameter_like_any_other() {
    let options = ContinuationOptions { most_points: 1500, ..ContinuationOptions::default() };
    let creeping = Coulomb::new(CoulombParameters { slip_force: 3.0, velocity: 0.05 }).unwrap();
    for problem in [scene_r(), unit_masses(Arc::new(creeping))] {
        for (from, to) in [(0.0, 60.0), (60.0, 0.0)] {
            let curve = frequency_curve(&problem, &Settings::new(3), (from, to), &options).unwrap();
            assert_eq!((curve.end, curve.points.last().unwrap().parameter), (CurveEnd::Reached, to));
        }
    }
    let damped = |ratio: f64| {
        let mut problem = scene_r();
        let (mass, stiffness) = (problem.model.mass().to_owned(), problem.model.stiffness().to_owned());
        problem.model = Model::new(mass, Damping::ModalRatio(ratio), stiffness).ok()?;
        Some(problem)
    };
    let turned = |phase: f64| {
        let mut problem = scene_r();
        problem.excitation[0].phase = phase;
        Some(problem)
    };
    type Family<'a> = &'a dyn Fn(f64) -> Option<Problem>;
    let cases: [(Family, f64, f64); 3] = [(&damped, 0.0, 0.1), (&damped, 0.1, 0.0), (&turned, -1.0, 1.0)];
    for (problem, from, to) in cases {
        let curve = entry_curve(problem, 40.0, &Settings::new(3), (from, to), &options).unwrap();
        assert_eq!((curve.end, curve.points.last().unwrap().parameter), (CurveEnd::Reached, to));
    }
}

/// A peak just beyond the end of the range is not part of the curve.
#[test]
fn nothing_lies_outside_the_range() {
    let curve = curve(&scene_p_cubic(), 5, 10.0, 43.2425);
    assert_eq!(curve.end, CurveEnd::Reached);
    assert!(curve.points.iter().all(|p| (10.0..=43.2425).contains(&p.parameter)));
}

/// With one harmonic a contact may slide or rest; the curve is that of the sliding one.
#[test]
fn a_contact_that_could_rest_slides_on() {
    let problem = Problem {
        joints: Vec::new(),
        model: model(mat![[1.0]], mat![[2.0]], mat![[1e5]]),
        excitation: vec![force(0, 0.08)],
        contacts: vec![to_ground(scaled_reference_loop())],
        output: vec![0],
    };
    let plan = Plan::new(&problem, &Settings::new(1)).unwrap();
    let solution = plan.solve(970.0, &mut plan.workspace());
    assert_eq!((solution.status, solution.solutions), (Status::Converged, Some(3)));
    let curve = curve(&problem, 1, 970.0, 990.0);
    assert_eq!(curve.end, CurveEnd::Reached);
    let (a, b) = (curve.points[0].solution.displacement[0][0], solution.displacement[0][0]);
    assert!((a - b).norm() < 1e-9 * b.norm());
}

/// A structure without contacts has a curve as well.
#[test]
fn a_linear_structure_has_a_curve() {
    let problem = Problem { contacts: Vec::new(), ..scene_r() };
    let curve = curve(&problem, 1, 10.0, 150.0);
    assert_eq!((curve.end, curve.points.iter().filter(|p| p.peaks == [1]).count()), (CurveEnd::Reached, 2));
}
