//! Peaks over a parameter: against closed forms, dense sweeps, published peaks and nonlinear modes.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use contact::{Cubic, CubicParameters};
use faer::mat;
use hbm::{
    Damping, ModeOptions, Model, NonlinearMode, OptimumKind, Origin, PeakCurve, PeakEnd, PeakOptions,
    PeakPoint, PeakStatus, Plan, Problem, Settings, Status, follow_peaks, nonlinear_mode,
};
use num_complex::Complex64;
use stickslip_tests::{elastic_coulomb, force, paper_scene, scene_r, to_ground, two_mass, unit_masses};

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

/// While the root holds still the blade of the paper's scene is an oscillator of its own, with its peak at Ω² = (c − d²/2m)/m. The
/// root may hold still up to the excitation at which a point solved on its own is no longer at rest there.
#[test]
fn a_peak_at_rest_is_that_of_the_structure_held_there() {
    let with = |amplitude: f64| {
        let mut problem = paper_scene();
        problem.excitation[0].amplitude = amplitude;
        problem.output = vec![1];
        problem
    };
    let scene = with(1.0);
    let (m, d, c) = (scene.model.mass()[(1, 1)], 24.0, scene.model.stiffness()[(1, 1)]);
    let options = options((1e-5, 1e-1), (20.0, 200.0));
    let curve = follow(&with, 1, &options);
    let (mut resting, mut sliding) = (0, 0);
    for point in &curve.points {
        let peak = &point.peaks[0];
        if peak.solution.status == Status::Stuck {
            resting += 1;
            let omega = ((c - 0.5 * d * d / m) / m).sqrt();
            let height = point.parameter / (d * (c / m - 0.25 * (d / m).powi(2)).sqrt());
            close(peak.solution.frequency * TAU, omega, 1e-6);
            close(peak.amplitude, height, 1e-8);
        } else {
            sliding += 1;
            let hertz = peak.solution.frequency;
            let dense = summit_of_points(&with(point.parameter), 1, 0, (hertz - 0.1, hertz + 0.1));
            close(peak.solution.frequency, dense.0, 1e-6);
            close(peak.amplitude, dense.1, 1e-8);
        }
    }
    assert!(resting > 3 && sliding > 3, "{resting} at rest, {sliding} sliding");
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

/// One harmonic of elastic Coulomb friction without other damping: the excitation meets 4 F (1 − x_c/A)/π in quadrature, so
/// the peak is A = x_c/(1 − π f/(4 F)), at the frequency of the springs in phase. It is lowest at F = π f/2, where A = π f/k:
/// Griffin's optimal slip force.
#[test]
fn a_friction_damper_of_one_harmonic_has_griffins_optimum() {
    let (kt, f) = (3e4, 3.0);
    let with = |slip: f64| oscillator(0.0, vec![to_ground(elastic_coulomb(kt, slip))]);
    let options = options((1.2 * PI * f / 4.0, 40.0 * f), (20.0, 60.0));
    let curve = follow(&with, 1, &options);
    for point in &curve.points {
        let slip = point.parameter;
        let (xc, peak) = (slip / kt, &point.peaks[0]);
        let amplitude = xc / (1.0 - PI * f / (4.0 * slip));
        close(peak.amplitude, amplitude, 1e-9);
        let theta = (1.0 - 2.0 * xc / amplitude).acos();
        let elastic = kt / PI * (theta - 0.5 * (2.0 * theta).sin());
        close(peak.solution.frequency * TAU, ((8e4 + elastic) / 2.0).sqrt(), 1e-7);
        // All that the excitation puts in, π f A in quadrature.
        close(peak.solution.contacts[0].dissipation, PI * f * amplitude, 1e-8);
    }
    let optimum = curve.optimum.unwrap();
    assert_eq!((optimum.kind, optimum.point.status), (OptimumKind::Smooth, PeakStatus::Surveyed));
    close(optimum.point.parameter, 0.5 * PI * f, 1e-6);
    close(optimum.point.peaks[0].amplitude, PI * f / kt, 1e-11);
}

/// Straight lines between the points are off by no more than is promised, and the curve is not drowned in points.
#[test]
fn the_curve_is_resolved() {
    let (kt, f) = (3e4, 3.0);
    let with = |slip: f64| oscillator(0.0, vec![to_ground(elastic_coulomb(kt, slip))]);
    let curve = follow(&with, 1, &options((1.05 * PI * f / 4.0, 40.0 * f), (20.0, 60.0)));
    let truth = |slip: f64| slip / kt / (1.0 - PI * f / (4.0 * slip));
    for pair in curve.points.windows(2) {
        let (a, b) = (pair[0].parameter, pair[1].parameter);
        let straight = 0.5 * (truth(a).ln() + truth(b).ln());
        assert!((truth((a * b).sqrt()).ln() - straight).abs() < 1e-2, "{a} to {b}");
    }
    assert!(curve.points.len() < 100, "{}", curve.points.len());
}

/// The largest amplitude near a frequency by points solved one by one: ever finer grids, then a parabola.
fn summit_of_points(problem: &Problem, harmonics: usize, dof: usize, around: (f64, f64)) -> (f64, f64) {
    let plan = Plan::new(problem, &Settings { estimate: false, ..Settings::new(harmonics) }).unwrap();
    let mut workspace = plan.workspace();
    let mut at = |hertz: f64| plan.solve(hertz, &mut workspace).displacement[dof][0].norm();
    let (mut low, mut high) = around;
    while high - low > 2e-3 {
        let step = (high - low) / 40.0;
        let heights: Vec<f64> = (0..=40).map(|i| at(low + step * f64::from(i))).collect();
        let best = (0..=40).max_by(|&a, &b| heights[a].total_cmp(&heights[b])).unwrap();
        let centre = low + step * best as f64;
        (low, high) = (centre - 2.0 * step, centre + 2.0 * step);
    }
    let (middle, step) = (0.5 * (low + high), 1e-4);
    let [before, here, after] = [middle - step, middle, middle + step].map(&mut at);
    let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
    (middle - step * slope / bend, here - 0.5 * slope * slope / bend)
}

fn scene_r_with(slip: f64) -> Problem {
    Problem { output: vec![1], ..two_mass(elastic_coulomb(6.705e6, slip)) }
}

#[test]
fn peaks_are_those_of_dense_sweeps() {
    let options = options((1.0, 60.0), (20.0, 130.0));
    let curve = follow(&scene_r_with, 7, &options);
    let last = curve.points.len() - 1;
    for point in [2, last / 3, last / 2, 2 * last / 3, last - 1].map(|i| &curve.points[i]) {
        let problem = scene_r_with(point.parameter);
        let (hertz, height) = summit_of_points(&problem, 7, 0, options.frequencies);
        let peak = &point.peaks[0];
        close(peak.solution.frequency, hertz, 1e-6);
        close(peak.amplitude, height, 1e-8);
    }
}

/// The published peak of the bent resonance, which lies between two folds.
#[test]
fn the_peak_of_the_cubic_scene() {
    let with = |amplitude: f64| {
        let law = Arc::new(Cubic::new(CubicParameters { stiffness: 1e9 }).unwrap());
        Problem { output: vec![1], excitation: vec![force(1, amplitude)], ..unit_masses(law) }
    };
    let options = PeakOptions { surveys: 3, ..options((1.0, 9.0), (35.0, 50.0)) };
    let curve = follow(&with, 7, &options);
    let at = |p: &&PeakPoint| (p.parameter - 3.0).abs() < 1e-12;
    let peak = &curve.points.iter().find(at).unwrap().peaks[0];
    assert!((peak.solution.frequency - 43.2426).abs() < 3e-4, "{}", peak.solution.frequency);
    assert!((peak.amplitude - 4.0177e-3).abs() < 5e-8, "{}", peak.amplitude);
    let (hertz, height) = summit_of_points(&with(3.0), 7, 0, (43.235, 43.25));
    close(peak.solution.frequency, hertz, 1e-6);
    close(peak.amplitude, height, 1e-9);
    // It bends further the higher it is.
    let hertz: Vec<f64> = curve.points.iter().map(|p| p.peaks[0].solution.frequency).collect();
    assert!(hertz.is_sorted() && hertz[hertz.len() - 1] > 1.02 * hertz[0]);
}

/// Frequency in Hz and amplitude in m of the resonance that the mode predicts at `factor` times the problem's excitation.
fn predicted(mode: &NonlinearMode, factor: f64) -> (f64, f64) {
    let level = |p: &hbm::ModePoint| p.excitation.map_or(f64::NEG_INFINITY, |e| (e / factor).ln());
    let around = mode.points.windows(2).find(|w| level(&w[0]) <= 0.0 && level(&w[1]) > 0.0).unwrap();
    let (a, b) = (&around[0], &around[1]);
    let part = -level(a) / (level(b) - level(a));
    let between = |x: f64, y: f64| x + part * (y - x);
    let hertz = between(a.resonance.unwrap(), b.resonance.unwrap());
    (hertz, between(a.amplitude.ln(), b.amplitude.ln()).exp())
}

#[test]
fn peaks_over_the_excitation_are_those_that_a_nonlinear_mode_predicts() {
    let mut problem = scene_r();
    problem.output = vec![1];
    let mode = ModeOptions {
        mode: 0,
        origin: Origin::Free,
        reference: 1,
        amplitudes: (1e-4, 1.0),
        points: 200,
        progress: &|_| true,
    };
    let mode = nonlinear_mode(&problem, &Settings::new(7), &mode).unwrap();
    let with = |factor: f64| Problem { excitation: vec![force(1, 9.1 * factor)], ..problem.clone() };
    let curve = follow(&with, 7, &options((3.0, 300.0), (35.0, 60.0)));
    assert!(curve.points.len() > 15);
    for point in &curve.points {
        let (hertz, amplitude) = predicted(&mode, point.parameter);
        close(point.peaks[0].solution.frequency, hertz, 1e-3);
        close(point.peaks[0].amplitude, amplitude, 1e-3);
    }
}

/// Two masses in the way of a tuned damper: the main one on k, the small one on a spring of `tuning`·μk.
fn tuned_damper(tuning: f64) -> Problem {
    let (k, mu) = (8e4, 0.05);
    let small = tuning * mu * k;
    Problem {
        joints: Vec::new(),
        model: Model::new(
            mat![[2.0, 0.0], [0.0, 2.0 * mu]],
            Damping::Matrix(mat![[4.0, -2.0], [-2.0, 2.0]]),
            mat![[k + small, -small], [-small, small]],
        )
        .unwrap(),
        excitation: vec![force(0, 3.0)],
        contacts: Vec::new(),
        output: vec![0],
    }
}

/// Largest |W| of the main mass by Cramer's rule, over a fine grid and by thirds.
fn highest_of_tuned_damper(tuning: f64) -> f64 {
    let (k, mu) = (8e4, 0.05);
    let small = tuning * mu * k;
    let at = |hertz: f64| {
        let omega = TAU * hertz;
        let own = |k: f64, m: f64, d: f64| Complex64::new(k - m * omega * omega, omega * d);
        let (main, damper) = (own(k + small, 2.0, 4.0), own(small, 2.0 * mu, 2.0));
        let coupling = Complex64::new(-small, -2.0 * omega);
        (3.0 * damper / (main * damper - coupling * coupling)).norm()
    };
    // Every maximum of the grid, since two may be equally high.
    let grid: Vec<(f64, f64)> =
        (0..2000).map(|i| 20.0 + 0.01 * f64::from(i)).map(|hertz| (hertz, at(hertz))).collect();
    let maxima = grid.windows(3).filter(|w| w[1].1 >= w[0].1 && w[1].1 >= w[2].1).map(|w| {
        let (mut low, mut high) = (w[0].0, w[2].0);
        while high - low > 1e-7 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if at(a) > at(b) { high = b } else { low = a }
        }
        at(0.5 * (low + high))
    });
    maxima.fold(0.0, f64::max)
}

/// A crossing of two peaks: there is no parabola, and both are reported.
#[test]
fn a_tuned_damper_is_best_where_two_peaks_are_equally_high() {
    let options = PeakOptions { logarithmic: false, ..options((0.6, 1.3), (20.0, 40.0)) };
    let curve = follow(&tuned_damper, 1, &options);
    let optimum = curve.optimum.unwrap();
    assert_eq!(optimum.kind, OptimumKind::Crossing);
    let (best, peaks) = (optimum.point.parameter, &optimum.point.peaks);
    assert_eq!(peaks.len(), 2);
    close(peaks[0].amplitude, peaks[1].amplitude, 1e-6);
    close(peaks[0].amplitude, highest_of_tuned_damper(best), 1e-9);
    for step in [1e-6, 1e-4, 1e-2] {
        for beside in [best * (1.0 - step), best * (1.0 + step)].map(highest_of_tuned_damper) {
            assert!(beside > peaks[0].amplitude, "{best} {step}: {beside} below {}", peaks[0].amplitude);
        }
    }
    for point in &curve.points {
        close(point.peaks[0].amplitude, highest_of_tuned_damper(point.parameter), 1e-9);
    }
}

/// Against a grid of slip forces with a fine sweep each.
#[test]
fn the_optimum_is_that_of_brute_force() {
    let options = options((2.0, 60.0), (20.0, 130.0));
    let curve = follow(&scene_r_with, 1, &options);
    let optimum = curve.optimum.unwrap();
    assert_eq!(optimum.point.status, PeakStatus::Surveyed);
    let best = optimum.point.parameter;
    let brute = |slip: f64| summit_of_points(&scene_r_with(slip), 1, 0, options.frequencies).1;
    close(optimum.point.peaks[0].amplitude, brute(best), 1e-9);
    let grid = (0..60).map(|i| 2.0 * 30_f64.powf(f64::from(i) / 59.0));
    for slip in grid.chain([best * (1.0 - 1e-3), best * (1.0 + 1e-3)]) {
        assert!(brute(slip) > optimum.point.peaks[0].amplitude, "{slip}");
    }
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let with = |threads| PeakOptions { threads: Some(threads), ..options((2.0, 40.0), (20.0, 130.0)) };
    let one = follow(&scene_r_with, 3, &with(1));
    assert_eq!(one, follow(&scene_r_with, 3, &with(3)));
    // Surveys look at more than 33 points each; between them a peak takes a few solutions.
    let effort = one.effort;
    assert_eq!(effort.surveys, 10);
    assert!(effort.searches > 20 && effort.search_steps < 60 * effort.searches, "{effort:?}");
}

#[test]
fn what_was_found_is_kept_when_stopped() {
    let calls = AtomicUsize::new(0);
    for most in [0, 5, 14] {
        calls.store(0, Ordering::Relaxed);
        let progress = |_: usize, _: usize| calls.fetch_add(1, Ordering::Relaxed) < most;
        let options =
            PeakOptions { progress: &progress, threads: Some(1), ..options((2.0, 40.0), (20.0, 130.0)) };
        let curve = follow_peaks(&|x| Some(scene_r_with(x)), &Settings::new(3), &options).unwrap();
        assert_eq!((curve.end, curve.optimum), (PeakEnd::Stopped, None));
        assert!(curve.points.len() >= most.min(9) && curve.points.iter().all(|p| p.status.sound()));
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |options: PeakOptions| {
        let answer = follow_peaks(&|x| Some(scene_r_with(x)), &Settings::new(1), &options);
        answer.unwrap_err().to_string()
    };
    let good = options((1.0, 2.0), (20.0, 130.0));
    for (options, culprit) in [
        (PeakOptions { range: (2.0, 1.0), ..good }, "range"),
        (PeakOptions { range: (0.0, 1.0), ..good }, "range"),
        (PeakOptions { range: (1.0, f64::NAN), ..good }, "range"),
        (PeakOptions { frequencies: (0.0, 100.0), ..good }, "frequencies"),
        (PeakOptions { surveys: 1, ..good }, "surveys"),
        (PeakOptions { output: 1, ..good }, "output"),
    ] {
        assert!(refused(options).starts_with(culprit), "{}", refused(options));
    }
    let nothing = follow_peaks(&|_| None, &Settings::new(1), &good);
    assert!(nothing.unwrap_err().to_string().contains("no problem"));
}

/// A value without a problem is marked, and no optimum is claimed beside it.
#[test]
fn values_without_a_problem_are_marked() {
    let with = |slip: f64| (!(20.0..=45.0).contains(&slip)).then(|| scene_r_with(slip));
    let options = options((2.0, 60.0), (20.0, 130.0));
    let curve = follow_peaks(&with, &Settings::new(1), &options).unwrap();
    let marked = |status| -> Vec<f64> {
        curve.points.iter().filter(|p| p.status == status).map(|p| p.parameter).collect()
    };
    let failed = marked(PeakStatus::Failed);
    assert!(!failed.is_empty() && failed.iter().all(|slip| (20.0..=45.0).contains(slip)), "{failed:?}");
    assert!(curve.points.iter().all(|p| p.peaks.is_empty() == (p.status == PeakStatus::Failed)));
    // Between a value without a problem and the survey beside it a peak may be missing.
    let (first, last) = (failed[0], failed[failed.len() - 1]);
    let surveyed = marked(PeakStatus::Surveyed);
    let before = surveyed.iter().copied().filter(|slip| *slip < first).fold(0.0, f64::max);
    let after = surveyed.iter().copied().filter(|slip| *slip > last).fold(f64::INFINITY, f64::min);
    assert!(marked(PeakStatus::Doubtful).iter().all(|slip| *slip > before && *slip < after));
    assert!(marked(PeakStatus::Followed).iter().all(|slip| *slip < before || *slip > after));
}
