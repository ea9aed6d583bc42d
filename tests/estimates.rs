//! Estimates of errors against the errors themselves, and harmonics chosen by them.

use faer::mat;
use hbm::{Plan, Problem, Settings, Status};
use stickslip_tests::{
    elastic_coulomb, exact_orbits, force, model, paper_scene, scene_p, scene_p_cubic, scene_r, to_ground,
};

fn estimating(harmonics: usize) -> Settings {
    Settings { estimate: true, ..Settings::new(harmonics) }
}

/// Every problem with exact orbits, at the frequencies of the reference data.
fn known() -> [(Problem, &'static str); 2] {
    [(scene_r(), "R"), (scene_p(), "P")]
}

/// At least the error and at most ten times as much, from a factor of five down to 1e-8.
#[test]
fn the_estimate_bounds_the_truncation_error() {
    for (problem, scene) in known() {
        for harmonics in [1, 3, 7, 15, 31, 63, 127, 255] {
            let plan = Plan::new(&problem, &estimating(harmonics)).unwrap();
            let mut workspace = plan.workspace();
            for orbit in exact_orbits(scene) {
                let solution = plan.solve(orbit.hertz, &mut workspace);
                // The reference stops at harmonic 511, which shows in none of these.
                let error = orbit.error(&plan, &solution.displacement[0]);
                let ratio = solution.truncation_error.unwrap() / error;
                assert!(
                    (1.0..10.0).contains(&ratio),
                    "{scene}, {} Hz, N = {harmonics}: {ratio}",
                    orbit.hertz
                );
            }
        }
    }
}

/// An estimate changes nothing but itself.
#[test]
fn a_solution_is_the_same_with_and_without_estimate() {
    for problem in [scene_r(), paper_scene(), scene_p_cubic()] {
        for harmonics in [1, 7] {
            let without = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
            let with = Plan::new(&problem, &estimating(harmonics)).unwrap();
            assert_eq!(without.orders(), with.orders());
            for hertz in [30.0, 75.0, 111.0] {
                let a = without.solve(hertz, &mut without.workspace());
                let b = with.solve(hertz, &mut with.workspace());
                assert_eq!((&a.displacement, &a.contacts), (&b.displacement, &b.contacts), "{hertz} Hz");
                assert_eq!((a.residual, a.stats, a.truncation_error), (b.residual, b.stats, None));
                assert!(b.truncation_error.is_some() && b.sampling_error.is_some());
            }
        }
    }
}

/// The estimate from twice the samples against the difference to the force by its events.
#[test]
fn the_sampling_error_is_estimated() {
    let exact = Plan::new(&scene_r(), &Settings::new(7)).unwrap();
    let (mut honest, mut count) = (0, 0);
    for samples in [64, 256, 1024] {
        let plan = Plan::new(&scene_r(), &Settings { samples: Some(samples), ..estimating(7) }).unwrap();
        for orbit in exact_orbits("R") {
            let expected = exact.solve(orbit.hertz, &mut exact.workspace());
            let found = plan.solve(orbit.hertz, &mut plan.workspace());
            let size: f64 = expected.displacement[0].iter().map(|w| w.norm_sqr()).sum();
            let pairs = expected.displacement[0].iter().zip(&found.displacement[0]);
            let error = (pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>() / size).sqrt();
            let estimate = found.sampling_error.unwrap();
            assert!(estimate < 20.0 * error, "{} Hz, {samples}: {estimate:e} for {error:e}", orbit.hertz);
            // Where the kinks fall between samples is chance: a single estimate may be low, but not by much.
            assert!(estimate > 0.2 * error, "{} Hz, {samples}: {estimate:e} for {error:e}", orbit.hertz);
            honest += usize::from(estimate >= error);
            count += 1;
        }
        let solution = exact.solve(75.0, &mut exact.workspace());
        assert_eq!(solution.sampling_error, None);
    }
    assert!(4 * honest >= 3 * count, "{honest} of {count}");
    let by_events = Plan::new(&scene_r(), &estimating(7)).unwrap();
    assert_eq!(by_events.solve(75.0, &mut by_events.workspace()).sampling_error, Some(0.0));
}

/// As many harmonics as a tolerance needs, and at most twice as many.
#[test]
fn harmonics_follow_the_tolerance() {
    for (problem, scene) in known() {
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let settings = Settings { truncation: Some(tolerance), ..Settings::new(511) };
            let plan = Plan::new(&problem, &settings).unwrap();
            let mut workspace = plan.workspace();
            for orbit in exact_orbits(scene) {
                let solution = plan.solve(orbit.hertz, &mut workspace);
                assert_eq!(solution.status, Status::Converged);
                assert_eq!(solution.displacement[0].len(), solution.harmonics.div_ceil(2));
                let error = orbit.error(&plan, &solution.displacement[0]);
                assert!(error <= tolerance, "{scene}, {} Hz: {error:e} > {tolerance:e}", orbit.hertz);
                assert!(solution.truncation_error.unwrap() <= tolerance);
                // Half as many would not have met the estimate's factor of safety.
                if solution.harmonics > 1 {
                    let half = Plan::new(&problem, &estimating(solution.harmonics / 2)).unwrap();
                    let estimate = half.solve(orbit.hertz, &mut half.workspace()).truncation_error;
                    assert!(estimate.unwrap() > tolerance, "{scene}, {} Hz, {tolerance:e}", orbit.hertz);
                }
            }
        }
    }
}

/// Where the most harmonics do not suffice the point is solved all the same, and its estimate says so.
#[test]
fn a_tolerance_out_of_reach_is_reported() {
    let settings = Settings { truncation: Some(1e-9), ..Settings::new(31) };
    let plan = Plan::new(&scene_r(), &settings).unwrap();
    let solution = plan.solve(57.0, &mut plan.workspace());
    assert_eq!((solution.status, solution.harmonics), (Status::Converged, 31));
    assert!((2.5e-5..1e-4).contains(&solution.truncation_error.unwrap()));
}

/// A smooth law needs few harmonics, a contact that sticks one.
#[test]
fn easy_points_need_few_harmonics() {
    let settings = Settings { truncation: Some(1e-10), ..Settings::new(63) };
    let cubic = Plan::new(&scene_p_cubic(), &settings).unwrap();
    assert!(cubic.solve(75.0, &mut cubic.workspace()).harmonics <= 7);
    let mut problem = scene_r();
    problem.excitation[0].amplitude = 1e-3;
    let stick = Plan::new(&problem, &settings).unwrap();
    let solution = stick.solve(75.0, &mut stick.workspace());
    assert_eq!((solution.harmonics, solution.truncation_error.map(|e| e < 1e-12)), (1, Some(true)));
}

/// The last rung of a ladder may add hardly any harmonics, or none: an estimate looks further.
#[test]
fn a_short_last_rung_is_no_estimate() {
    let truth = Plan::new(&scene_r(), &Settings::new(511)).unwrap();
    let truth = truth.solve(75.0, &mut truth.workspace());
    for (rung, most) in [(7, 8), (7, 9), (63, 64), (63, 65)] {
        let plan = Plan::new(&scene_r(), &Settings::new(rung)).unwrap();
        let solution = plan.solve(75.0, &mut plan.workspace());
        let at = |i: usize| solution.displacement[0].get(i).copied().unwrap_or_default();
        let (change, size) = truth.displacement[0]
            .iter()
            .enumerate()
            .fold((0.0, 0.0), |sums, (i, w)| (sums.0 + (w - at(i)).norm_sqr(), sums.1 + w.norm_sqr()));
        let settings = Settings { truncation: Some(0.9 * f64::sqrt(change / size)), ..Settings::new(most) };
        let plan = Plan::new(&scene_r(), &settings).unwrap();
        assert_eq!(plan.solve(75.0, &mut plan.workspace()).harmonics, most);
    }
}

/// A part of the structure that no contact sees, undamped and in resonance with the third harmonic.
#[test]
fn harmonics_that_cannot_be_taken_are_not_taken() {
    let at_third = (3.0 * 20.0 * std::f64::consts::TAU).powi(2);
    let problem = Problem {
        joints: Vec::new(),
        model: model(
            mat![[1.0, 0.0], [0.0, 1.0]],
            mat![[5.0, 0.0], [0.0, 0.0]],
            mat![[1e5, 0.0], [0.0, at_third]],
        ),
        excitation: vec![force(0, 10.0)],
        contacts: vec![to_ground(elastic_coulomb(1e5, 1.0))],
        output: vec![0],
    };
    let one = Plan::new(&problem, &Settings::new(1)).unwrap();
    let settings = Settings { truncation: Some(1e-9), ..Settings::new(31) };
    let adaptive = Plan::new(&problem, &settings).unwrap();
    let mut workspace = adaptive.workspace();
    let elsewhere = adaptive.solve(23.0, &mut workspace);
    assert!(elsewhere.harmonics > 3);
    let solution = adaptive.solve(20.0, &mut workspace);
    assert_eq!((solution.harmonics, solution.truncation_error), (1, None));
    let expected = one.solve(20.0, &mut one.workspace());
    let change = (solution.displacement[0][0] - expected.displacement[0][0]).norm();
    assert!(change < 1e-12 * expected.displacement[0][0].norm());
}

/// Without output dofs it is the contacts that are looked at.
#[test]
fn no_outputs_are_no_excuse() {
    let problem = Problem { output: Vec::new(), ..scene_r() };
    let plan = Plan::new(&problem, &estimating(7)).unwrap();
    let problem = Problem { output: vec![0], ..scene_r() };
    let with = Plan::new(&problem, &estimating(7)).unwrap();
    let estimate = |plan: &Plan| plan.solve(75.0, &mut plan.workspace()).truncation_error;
    assert_eq!(estimate(&plan), estimate(&with));
}

/// Beside a contact at rest nothing is estimated: such a point takes all harmonics.
#[test]
fn beside_a_contact_at_rest_all_harmonics_are_taken() {
    let mut problem = paper_scene();
    let contact = to_ground(elastic_coulomb(3e5, 0.75));
    problem.contacts.push(hbm::Contact { first: 1, ..contact });
    problem.excitation[0].amplitude = 1.0;
    let plan = Plan::new(&problem, &Settings { truncation: Some(1e-3), ..Settings::new(31) }).unwrap();
    let fixed = Plan::new(&problem, &Settings::new(31)).unwrap();
    let solution = plan.solve(300.0, &mut plan.workspace());
    assert_eq!((solution.status, solution.harmonics), (Status::Stuck, 31));
    assert_eq!(solution.displacement, fixed.solve(300.0, &mut fixed.workspace()).displacement);
}
