//! Stability: Floquet multipliers against closed forms, tables, time integration and exact orbits.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

use contact::{Coulomb, CoulombParameters, Law, Linear, LinearParameters};
use faer::{Mat, mat};
use hbm::{
    ContinuationOptions, Curve, Excitation, Hill, NoStability, PeriodicSpring, Plan, Problem, Settings,
    Solution, Stability, StabilityMethod, Status, Verdict, frequency_curve,
};
use num_complex::Complex64;
use orbit::{Orbit, State};
use scene::Scene;
use stickslip_tests::joint_models::{balanced, one_mass, planar, preloaded};
use stickslip_tests::orbit_models::{orbit, orbit_from};
use stickslip_tests::{elastic_coulomb, force, model, scene_p_cubic, scene_r, to_ground, unit_masses};

fn settings(harmonics: usize) -> Settings {
    Settings { stability: true, all_solutions: true, ..Settings::new(harmonics) }
}

fn solve(problem: &Problem, harmonics: usize, hertz: f64) -> (Plan, Solution) {
    let plan = Plan::new(problem, &settings(harmonics)).unwrap();
    let solution = plan.solve(hertz, &mut plan.workspace());
    assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
    (plan, solution)
}

/// The largest distance from one of `values` to the nearest of `others`.
fn distance(values: &[Complex64], others: &[Complex64]) -> f64 {
    assert_eq!(values.len(), others.len());
    let nearest = |value: &Complex64| others.iter().map(|z| (z - value).norm()).fold(f64::INFINITY, f64::min);
    values.iter().map(nearest).fold(0.0, f64::max)
}

fn linear(stiffness: f64) -> Arc<dyn Law> {
    Arc::new(Linear::new(LinearParameters { stiffness }).unwrap())
}

fn coulomb(slip_force: f64, velocity: f64) -> Arc<dyn Law> {
    Arc::new(Coulomb::new(CoulombParameters { slip_force, velocity }).unwrap())
}

/// Two masses m between walls and each other, springs c, damping d on each: modes in phase, ω² = c/m, and against each
/// other, ω² = 3c/m; e^{λT} with λ = −d/2m ± i√(ω² − (d/2m)²).
#[test]
fn a_linear_structure_has_its_closed_form() {
    let (m, c, d) = (2.5, 4e5, 30.0);
    let mut problem = unit_masses(linear(0.5 * c));
    problem.model =
        model(mat![[m, 0.0], [0.0, m]], mat![[d, 0.0], [0.0, d]], mat![[1.5 * c, -c], [-c, 2.0 * c]]);
    for hertz in [3.0, 20.0, 71.0, 4000.0] {
        let (_, solution) = solve(&problem, 3, hertz);
        let stability = solution.stability.unwrap();
        let decay = 0.5 * d / m;
        let expected: Vec<Complex64> = [c / m, 3.0 * c / m]
            .iter()
            .flat_map(|square| {
                [1.0, -1.0].map(|sign| Complex64::new(-decay, sign * (square - decay * decay).sqrt()))
            })
            .map(|exponent| (exponent / hertz).exp())
            .collect();
        let error = distance(&stability.multipliers, &expected);
        assert!(
            error < 1e-12 && error <= stability.error && stability.error < 1e-11,
            "{hertz} Hz: {error:e}"
        );
        assert_eq!((stability.verdict, stability.method), (Verdict::Stable, StabilityMethod::Hill));
    }
}

/// y″ + (a − 2q cos 2x) y = 0 over its period π, θ = 2x.
fn mathieu(a: f64, q: f64) -> Hill {
    let spring = PeriodicSpring {
        direction: vec![1.0],
        stiffness: vec![Complex64::ZERO, Complex64::from(-q / 4.0)],
        rate: Vec::new(),
    };
    Hill::new(&mat![[a / 4.0]], &mat![[0.0]], &[spring]).unwrap()
}

/// Characteristic values of Mathieu's equation (Abramowitz and Stegun, table 20.1; DLMF 28.6): the trace of the monodromy
/// over π is 2 for those of period π and −2 for those of period 2π.
#[test]
fn mathieu_functions_have_their_characteristic_values() {
    let known = [
        (1.0, -0.455_138_60, 2.0),
        (1.0, -0.110_248_82, -2.0),
        (1.0, 1.859_108_07, -2.0),
        (1.0, 3.917_024_77, 2.0),
        (1.0, 4.371_300_98, 2.0),
        (5.0, -5.800_046_02, 2.0),
        (5.0, -5.790_080_60, -2.0),
        (5.0, 1.858_187_54, -2.0),
    ];
    for (q, a, trace) in known {
        let monodromy = |a: f64| mathieu(a, q).monodromy(30, 1);
        let at = |a: f64| {
            let monodromy = monodromy(a);
            monodromy[(0, 0)] + monodromy[(1, 1)] - trace
        };
        // The table has 8 decimals: the root is that near.
        assert!(at(a - 6e-9) * at(a + 6e-9) < 0.0, "q = {q}, a = {a}: {:e} {:e}", at(a - 6e-9), at(a + 6e-9));
    }
    // Between b_1 and a_1 solutions grow; above, up to b_2, they are bounded and nothing is damped.
    let largest = |a: f64| mathieu(a, 1.0).multipliers().unwrap();
    assert!(largest(1.0).values[0].norm() > 1.5);
    let bounded = largest(3.0);
    assert!((bounded.values[0].norm() - 1.0).abs() <= bounded.error && bounded.error < 1e-11);
}

/// With e^{A_0 t} a rotation (a = 4) the bound of the truncation error is ρ^{−N−1} e^{2π·2·(q/4)·ρ} for every ρ > 1. The error
/// stays below it and falls faster than exponentially; parts of a period need fewer harmonics.
#[test]
fn the_truncation_error_falls_faster_than_exponentially() {
    let (a, q) = (4.0, 4.0);
    let hill = mathieu(a, q);
    let apart = |x: &Mat<f64>, y: &Mat<f64>| (x - y).norm_l2();
    let exact = hill.monodromy(60, 1);
    assert!(apart(&exact, &hill.monodromy(60, 16)) < 1e-12 * exact.norm_l2());
    let error = |n: usize, parts: usize| apart(&hill.monodromy(n, parts), &exact);
    let bound = |n: usize| {
        let at = |rho: f64| (PI * q * rho - (n as f64 + 1.0) * rho.ln()).exp();
        (1..400).map(|i| at(1.0 + 0.02 * f64::from(i))).fold(f64::INFINITY, f64::min)
    };
    let errors: Vec<(usize, f64)> = (2..40).map(|n| (n, error(n, 1))).filter(|(_, e)| *e > 1e-11).collect();
    assert!(errors.len() > 8, "{errors:?}");
    for (n, e) in &errors {
        assert!(*e <= bound(*n), "N = {n}: {e:e} above {:e}", bound(*n));
    }
    // The factor by which two more harmonics help grows with N.
    let falls: Vec<f64> = errors.windows(3).skip(4).map(|part| part[2].1 / part[0].1).collect();
    assert!(falls.len() > 4 && falls.windows(3).all(|part| part[2] < part[0]), "{errors:?}");
    assert!(error(9, 8) < 1e-3 * error(9, 1));
}

/// dz/dθ = A(θ) z from the identity by the classical fourth-order method.
fn integrated(a: &dyn Fn(f64) -> Mat<f64>, size: usize, steps: usize) -> Mat<f64> {
    let mut z = Mat::<f64>::identity(size, size);
    let h = TAU / steps as f64;
    for step in 0..steps {
        let theta = h * step as f64;
        let (first, middle, last) = (a(theta), a(theta + 0.5 * h), a(theta + h));
        let k1 = &first * &z;
        let k2 = &middle * (&z + &k1 * faer::Scale(0.5 * h));
        let k3 = &middle * (&z + &k2 * faer::Scale(0.5 * h));
        let k4 = &last * (&z + &k3 * faer::Scale(h));
        z = &z + (k1 + (k2 + k3) * faer::Scale(2.0) + k4) * faer::Scale(h / 6.0);
    }
    z
}

/// Three dofs, gyroscopic damping, two periodic springs and dampers that share harmonics, against a Runge–Kutta method; and
/// det Φ = e^{−∮ tr D} (Liouville).
#[test]
fn several_dofs_agree_with_time_integration() {
    let stiffness = mat![[3.0, -1.0, 0.2], [-1.0, 2.0, -0.5], [0.2, -0.5, 40.0]];
    let damping = mat![[0.1, 0.3, 0.0], [-0.3, 0.2, 0.0], [0.0, 0.1, 0.05]];
    let z = Complex64::new;
    let springs = [
        PeriodicSpring {
            direction: vec![1.0, -1.0, 0.0],
            stiffness: vec![z(0.4, 0.0), z(0.3, 0.2), z(0.0, 0.0), z(-0.1, 0.15)],
            rate: vec![z(0.1, 0.0), z(0.05, -0.1)],
        },
        PeriodicSpring {
            direction: vec![0.0, 0.3, 1.0],
            stiffness: vec![z(1.0, 0.0), z(0.0, -0.5), z(0.8, 0.3)],
            rate: vec![z(0.2, 0.0), z(0.0, 0.0), z(0.1, 0.05)],
        },
    ];
    let value = |coefficients: &[Complex64], theta: f64| -> f64 {
        let term = |(j, a): (usize, &Complex64)| {
            (a * Complex64::cis(j as f64 * theta)).re * if j == 0 { 1.0 } else { 2.0 }
        };
        coefficients.iter().enumerate().map(term).sum()
    };
    let a = |theta: f64| {
        Mat::from_fn(6, 6, |i, j| {
            if i < 3 {
                return f64::from(u8::from(j == i + 3));
            }
            let part = |of: fn(&PeriodicSpring) -> &Vec<Complex64>, column: usize| -> f64 {
                springs.iter().map(|s| s.direction[i - 3] * value(of(s), theta) * s.direction[column]).sum()
            };
            match j {
                0..3 => -stiffness[(i - 3, j)] - part(|s| &s.stiffness, j),
                _ => -damping[(i - 3, j - 3)] - part(|s| &s.rate, j - 3),
            }
        })
    };
    let expected = integrated(&a, 6, 6000).eigenvalues().unwrap();
    let hill = Hill::new(&stiffness, &damping, &springs).unwrap();
    let found = hill.multipliers().unwrap();
    let error = distance(&found.values, &expected);
    assert!(error < 1e-9 && found.error < 1e-10, "{error:e} {:e}", found.error);
    let product: Complex64 = found.values.iter().product();
    let trace = 0.1 + 0.2 + 0.05 + 2.0 * 0.1 + (0.09 + 1.0) * 0.2;
    assert!((product - (-TAU * trace).exp()).norm() < 1e-12, "{product}");
}

fn curve(problem: &Problem, harmonics: usize, (from, to): (f64, f64)) -> Curve {
    let options = ContinuationOptions::default();
    frequency_curve(problem, &settings(harmonics), (from, to), &options).unwrap()
}

/// Along the bent resonance of the cubic scene the branch between the folds is unstable and nothing else; a multiplier passes
/// through +1 at the folds.
#[test]
fn stability_changes_at_folds() {
    let curve = curve(&scene_p_cubic(), 7, (42.5, 44.0));
    let folds: Vec<usize> = (0..curve.points.len()).filter(|&i| curve.points[i].fold).collect();
    let &[first, second] = folds.as_slice() else { panic!("{folds:?}") };
    let stability = |i: usize| curve.points[i].solution.stability.clone().unwrap();
    let nearest_to_one = |i: usize| {
        let values = stability(i).multipliers;
        values.into_iter().min_by(|a, b| (a - 1.0).norm().total_cmp(&(b - 1.0).norm())).unwrap()
    };
    assert!(second > first + 4);
    for i in (0..curve.points.len()).filter(|i| !folds.contains(i)) {
        let expected = if first < i && i < second { Verdict::Unstable } else { Verdict::Stable };
        assert_eq!(stability(i).verdict, expected, "point {i}, {} Hz", curve.points[i].parameter);
    }
    for (fold, inside) in [(first, first + 1), (second, second - 1)] {
        let (at, beside) = (nearest_to_one(fold) - 1.0, nearest_to_one(inside) - 1.0);
        assert!(at.im == 0.0 && beside.im == 0.0 && beside.re > 0.0, "{at} {beside}");
        // Along the arc the multiplier changes linearly, the frequency with the square.
        let away = (curve.points[inside].parameter - curve.points[fold].parameter).abs();
        let shift = away * (at.re / beside.re).powi(2);
        assert!(shift < 1e-6 * curve.points[fold].parameter, "{shift:e} Hz");
        assert!(at.re.abs() < 1e-5, "{at}");
    }
}

/// The exact orbit beside a solution.
fn orbit_beside(problem: &Problem, plan: &Plan, solution: &Solution) -> Orbit {
    let turn = Complex64::new(0.0, TAU * solution.frequency);
    let sum = |row: &Vec<Complex64>, power: i32| -> f64 {
        plan.orders().iter().zip(row).map(|(&k, w)| (w * (turn * k as f64).powi(power)).re).sum()
    };
    let state = State {
        displacement: solution.displacement.iter().map(|row| sum(row, 0)).collect(),
        velocity: solution.displacement.iter().map(|row| sum(row, 1)).collect(),
        sliders: Vec::new(),
    };
    let system = study::system(problem, solution.frequency);
    let orbit = orbit_from(
        &system,
        solution.frequency,
        &orbit::Settings { start: Some(state), ..orbit::Settings::default() },
    );
    let apart = (orbit.spectrum(1, 1)[1] - solution.displacement[1][0]).norm();
    assert!(apart < 0.1 * solution.displacement[1][0].norm(), "{} Hz: another orbit", solution.frequency);
    orbit
}

/// The error that is claimed is one, and not much more: solutions with few harmonics too, on all branches.
#[test]
fn the_claimed_error_is_the_distance_from_exact_orbits() {
    let mut seen = 0;
    for (harmonics, hertz) in [1, 3, 5, 15]
        .into_iter()
        .flat_map(|n| [14.0, 30.0, 43.225, 43.24, 43.255, 108.0].map(|hertz| (n, hertz)))
    {
        let problem = scene_p_cubic();
        let (plan, solution) = solve(&problem, harmonics, hertz);
        for solution in std::iter::once(&solution).chain(&solution.others) {
            let exact = orbit_beside(&problem, &plan, solution).multipliers().unwrap();
            let stability = solution.stability.clone().unwrap();
            let error = distance(&stability.multipliers, &exact);
            let place = format!("N = {harmonics}, {hertz} Hz: {error:e}, claimed {:e}", stability.error);
            assert!(error <= stability.error + 1e-11, "{place}");
            assert!(stability.error < 10.0 * error + 1e-11, "{place}");
            seen += 1;
        }
    }
    assert!(seen > 24);
}

/// Regularised friction from creeping to turning round within a tenth of the velocity amplitude.
#[test]
fn regularised_friction_has_the_multipliers_of_its_orbit() {
    for (velocity, harmonics) in [(0.1, 15), (0.02, 63)] {
        let problem = unit_masses(coulomb(1.0, velocity));
        for hertz in [30.0, 43.25, 108.0] {
            let (plan, solution) = solve(&problem, harmonics, hertz);
            let exact = orbit_beside(&problem, &plan, &solution).multipliers().unwrap();
            let stability = solution.stability.unwrap();
            let error = distance(&stability.multipliers, &exact);
            let place = format!("{velocity} m/s, {hertz} Hz: {error:e}, claimed {:e}", stability.error);
            assert!(error <= stability.error + 1e-11 && stability.error < 1e-6, "{place}");
            assert_eq!(stability.verdict, Verdict::Stable, "{place}");
        }
    }
}

/// A structure that feeds on its motion, held back by friction: small motions are stable, large ones are not.
#[test]
fn friction_holds_back_a_self_excited_structure_up_to_an_amplitude() {
    let mut verdicts = Vec::new();
    for amplitude in [0.5, 100.0] {
        let mut problem = unit_masses(coulomb(1.0, 0.05));
        problem.model = model(
            mat![[1.0, 0.0], [0.0, 1.0]],
            mat![[-4.0, 0.0], [0.0, 1.0]],
            mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]],
        );
        problem.excitation = vec![force(1, amplitude)];
        let (plan, solution) = solve(&problem, 31, 52.0);
        let exact = orbit_beside(&problem, &plan, &solution).multipliers().unwrap();
        let stability = solution.stability.unwrap();
        let error = distance(&stability.multipliers, &exact);
        assert!(
            error <= stability.error + 1e-11 && stability.error < 1e-8,
            "{error:e} {:e}",
            stability.error
        );
        verdicts.push(stability.verdict);
    }
    assert_eq!(verdicts, [Verdict::Stable, Verdict::Unstable]);
}

/// Harmonic 3 at a frequency is harmonic 1 at three times of it, seen for three periods; and a static load, which lets even
/// harmonics in, changes little when it is small.
#[test]
fn multipliers_belong_to_a_period_of_the_excitation() {
    let plain = scene_p_cubic();
    let (_, once) = solve(&plain, 9, 90.0);
    let once = once.stability.unwrap();
    let mut third = plain.clone();
    third.excitation[0].harmonic = 3;
    let (_, thrice) = solve(&third, 27, 30.0);
    let thrice = thrice.stability.unwrap();
    let expected: Vec<Complex64> = once.multipliers.iter().map(|z| z.powi(3)).collect();
    let error = distance(&thrice.multipliers, &expected);
    assert!(error < 1e-12 && error <= thrice.error + 3.0 * once.error, "{error:e}");
    let mut loaded = plain.clone();
    loaded.excitation.push(Excitation { harmonic: 0, amplitude: 1e-7, ..plain.excitation[0] });
    let (plan, solution) = solve(&loaded, 9, 90.0);
    assert!(!plan.facts().odd);
    let error = distance(&solution.stability.unwrap().multipliers, &once.multipliers);
    assert!(error > 0.0 && error < 1e-11, "{error:e}");
}

/// A slider that sticks is a spring; one that slips remembers, and so does a loop.
#[test]
fn friction_that_remembers_is_left_to_its_orbit() {
    let (stiffness, slip_force) = (6e4, 1.0);
    let sticking =
        solve(&unit_masses(elastic_coulomb(stiffness, 1e3 * slip_force)), 7, 60.0).1.stability.unwrap();
    let spring = solve(&unit_masses(linear(stiffness)), 7, 60.0).1.stability.unwrap();
    assert!(distance(&sticking.multipliers, &spring.multipliers) < 1e-13);
    let (plan, slipping) = solve(&unit_masses(elastic_coulomb(stiffness, slip_force)), 7, 40.0);
    assert_eq!(slipping.stability, None);
    let reason = plan.stability(&slipping).unwrap_err();
    assert_eq!(reason, NoStability::Memory { contact: "root".into(), law: "elastic_coulomb" });
}

/// The exact orbit's multipliers stand in where sliders slip; a motion that the balance knows too coarsely has none.
#[test]
fn orbits_judge_sliders() {
    for hertz in [57.0, 75.0, 108.0] {
        let (plan, solution) = solve(&scene_r(), 31, hertz);
        let stability = study::stability(&scene_r(), plan.orders(), &solution).unwrap();
        assert_eq!(
            (stability.verdict, stability.method),
            (Verdict::Stable, StabilityMethod::Orbit),
            "{hertz} Hz"
        );
        assert!(stability.multipliers[0].norm() < 1.0 - 1e-6);
    }
    let (plan, solution) = solve(&scene_r(), 1, 57.0);
    let why = study::stability(&scene_r(), plan.orders(), &solution).unwrap_err();
    assert!(why.contains("more harmonics"), "{why}");
}

/// Friction under a normal load that changes, in one tangential direction and in two, pressed all the time and lifting off: the
/// multipliers of the orbit that is known to be the balance's motion.
#[test]
fn orbits_judge_friction_under_a_normal_load() {
    for (name, system, hertz) in [
        ("pressed", one_mass(preloaded(18.0)), 60.0),
        ("lifted", one_mass(preloaded(6.0)), 70.0),
        ("pressed in a plane", planar(preloaded(18.0)), 60.0),
        ("lifted in a plane", planar(preloaded(5.0)), 70.0),
    ] {
        let problem = balanced(&system);
        let (plan, solution) = solve(&problem, 15, hertz);
        assert_eq!(plan.stability(&solution), Err(NoStability::Joint));
        let stability = study::stability(&problem, plan.orders(), &solution).unwrap();
        assert_eq!(
            (stability.verdict, stability.method),
            (Verdict::Stable, StabilityMethod::Orbit),
            "{name}"
        );
        let exact = orbit(&system, hertz).multipliers().unwrap();
        assert!(distance(&stability.multipliers, &exact) < 1e-9, "{name}");
    }
}

/// What cannot be is refused with its reason.
#[test]
fn what_has_no_multipliers_says_why() {
    let mut massless = unit_masses(linear(1e3));
    massless.model = model(
        mat![[1.0, 0.0], [0.0, 0.0]],
        mat![[2.0, 0.0], [0.0, 2.0]],
        mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]],
    );
    let (plan, solution) = solve(&massless, 3, 20.0);
    assert_eq!(plan.stability(&solution), Err(NoStability::Massless));
    let (plan, solution) = solve(&unit_masses(linear(1e3)), 3, 0.0);
    assert_eq!(plan.stability(&solution), Err(NoStability::Static));
    let n = 101;
    let mut large = unit_masses(linear(1e3));
    let diagonal = |x: f64| Mat::from_fn(n, n, |i, j| if i == j { x } else { 0.0 });
    large.model = model(diagonal(1.0), diagonal(2.0), diagonal(1e5));
    let (plan, solution) = solve(&large, 3, 20.0);
    assert_eq!(plan.stability(&solution), Err(NoStability::TooLarge { dofs: n }));
    let spring = |direction| PeriodicSpring { direction, stiffness: Vec::new(), rate: Vec::new() };
    assert!(Hill::new(&mat![[1.0]], &mat![[0.0]], &[spring(vec![1.0, 0.0])]).is_err());
    assert!(Hill::new(&mat![[1.0]], &mat![[f64::NAN]], &[]).is_err());
    // Nothing damps: a multiplier on the unit circle decides nothing.
    let undamped = Stability::new(vec![Complex64::cis(0.3)], 1e-13, StabilityMethod::Hill);
    assert_eq!(undamped.verdict, Verdict::Undecided);
    let mut free = unit_masses(linear(1e3));
    free.contacts = vec![to_ground(linear(1e3))];
    free.model =
        model(mat![[1.0, 0.0], [0.0, 1.0]], Mat::zeros(2, 2), mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]]);
    assert_eq!(solve(&free, 1, 20.0).1.stability.unwrap().verdict, Verdict::Undecided);
}

fn scene(law: &str, frequencies: &str, harmonics: usize, stability: bool) -> Scene {
    let text = format!(
        r#"{{"name": "s", "model": {{"dofs": ["w1", "w2"], "mass": [[1, 0], [0, 1]], "damping": [[2, 0], [0, 2]],
            "stiffness": [[380000, -190000], [-190000, 190000]]}},
            "excitation": [{{"dof": "w2", "harmonic": 1, "amplitude": 3}}],
            "contacts": [{{"name": "root", "between": ["w1", "ground"], "law": {law}}}],
            "frequencies": {frequencies}, "harmonics": {harmonics}, "output": ["w2"],
            "solver": {{"stability": {stability}}}}}"#
    );
    Scene::from_str(&text, Path::new("")).unwrap()
}

fn step(scene: &Scene) -> scene::Step {
    let steps = scene.prepare().unwrap().explain();
    steps.into_iter().find(|step| step.what.starts_with("stability")).unwrap()
}

/// A sweep says it for every point, with what judges the memories; nobody pays who does not ask.
#[test]
fn scenes_ask_for_stability() {
    let cubic = r#"{"type": "cubic", "stiffness": 1e9}"#;
    let friction = r#"{"type": "elastic_coulomb", "stiffness": 60000, "slip_force": 1}"#;
    let outcome = |scene: &Scene| {
        let prepared = scene.prepare().unwrap();
        let mut solved = prepared.solve(&scene::RunOptions { threads: Some(1), ..Default::default() });
        solved.judge(&study::stability);
        serde_json::to_value(solved.outcome()).unwrap()
    };
    let silent = scene(cubic, "[30]", 5, false);
    assert!(outcome(&silent)["points"][0].get("stability").is_none());
    assert!(!step(&silent).used && step(&scene(cubic, "[30]", 5, true)).used);
    assert!(step(&scene(cubic, "[30]", 5, true)).why.contains("Hill"));
    assert!(step(&scene(friction, "[30]", 5, true)).why.contains("orbit"));

    let hill = &outcome(&scene(cubic, "[0, 30]", 5, true))["points"];
    assert!(hill[0]["stability"].is_null() && hill[0].get("stability").is_some());
    assert_eq!(
        (&hill[1]["stability"]["stable"], &hill[1]["stability"]["method"]),
        (&true.into(), &"hill".into())
    );
    assert_eq!(hill[1]["stability"]["multipliers"].as_array().unwrap().len(), 4);
    assert!(hill[1]["stability"]["error"].as_f64().unwrap() < 1e-10);

    let orbit = &outcome(&scene(friction, "[40, 108]", 31, true))["points"];
    for point in orbit.as_array().unwrap() {
        assert_eq!(
            (&point["stability"]["stable"], &point["stability"]["method"]),
            (&true.into(), &"orbit".into())
        );
    }
    let loops = r#"{"type": "scaled_loop", "loop": {"displacement": 8e-6, "force": 12.0}}"#;
    let unknown = outcome(&scene(loops, "[60]", 1, true));
    assert!(unknown["points"][0]["stability"].is_null());
    let notes = unknown["notes"].to_string();
    assert!(notes.contains("stability is not known at 60 Hz") && notes.contains("root"), "{notes}");
    assert!(!step(&scene(loops, "[60]", 1, true)).used);
}

/// A curve carries its verdicts, and a note names the unstable part.
#[test]
fn curves_say_where_they_are_unstable() {
    let scene = scene(r#"{"type": "cubic", "stiffness": 1e9}"#, "[42.5, 44]", 5, true);
    let options = scene::ContinuationOptions::default();
    let curve = scene.curve(scene::Along::Frequency, (42.5, 44.0), None, &options).unwrap();
    assert!(curve.points.iter().any(|point| point.point.is_unstable()));
    assert!(curve.notes.iter().any(|note| note.contains("unstable")), "{:?}", curve.notes);
    let silent = scene.clone().with_harmonics(5).unwrap();
    assert!(silent.settings().stability);
}
