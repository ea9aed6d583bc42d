//! Sweeps: independent of threads, units and neighbours; nothing is allocated on the way.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use contact::{MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry};
use faer::Mat;
use hbm::{Plan, Problem, Settings, Solution, Start, Status, Sweep, SweepOptions, sweep};
use hysteresis::Loop;
use num_complex::Complex64;
use stickslip_tests::{
    elastic_coulomb, force, model, paper_scene, reference_loop, scene_p_cubic, scene_r, to_ground,
};

fn run(problem: &Problem, settings: &Settings, frequencies: &[f64], threads: usize) -> Sweep {
    let plan = Plan::new(problem, settings).unwrap();
    sweep(&plan, frequencies, &SweepOptions { threads: Some(threads), ..Default::default() })
}

fn range(from: f64, to: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| from + (to - from) * i as f64 / (points - 1) as f64).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let frequencies = range(15.0, 200.0, 300);
    for (problem, harmonics) in [(scene_r(), 7), (paper_scene(), 7), (paper_scene(), 1), (scene_p_cubic(), 3)]
    {
        let settings = Settings::new(harmonics);
        let one = run(&problem, &settings, &frequencies, 1);
        for threads in [2, 3] {
            let several = run(&problem, &settings, &frequencies, threads);
            assert_eq!(several.threads, threads);
            assert_eq!(one.solutions, several.solutions);
        }
        // Nor do the neighbours: a point alone is the same point.
        let plan = Plan::new(&problem, &settings).unwrap();
        assert_eq!(plan.solve(frequencies[57], &mut plan.workspace()), one.solutions[57]);
    }
}

/// Every point from 15 to 200 Hz converges at every N, and marching up and down in frequency finds the same.
#[test]
fn the_papers_scene_solves_everywhere_and_marching_agrees() {
    let frequencies = range(15.0, 200.0, 186);
    for harmonics in [1, 3, 7, 15, 31] {
        let mut settings = Settings::new(harmonics);
        let points = run(&paper_scene(), &settings, &frequencies, 2).solutions;
        settings.start = Start::March;
        let up = run(&paper_scene(), &settings, &frequencies, 1).solutions;
        let reversed: Vec<f64> = frequencies.iter().rev().copied().collect();
        let down = run(&paper_scene(), &settings, &reversed, 1).solutions;
        for ((point, up), down) in points.iter().zip(&up).zip(down.iter().rev()) {
            for other in [up, down] {
                assert_eq!((point.status, other.status), (Status::Converged, Status::Converged));
                let error = distance(point, other);
                assert!(error < 1e-8, "N = {harmonics} at {} Hz: {error:e}", point.frequency);
            }
        }
    }
}

fn distance(a: &Solution, b: &Solution) -> f64 {
    let pairs = || a.displacement.iter().flatten().zip(b.displacement.iter().flatten());
    let difference: f64 = pairs().map(|(a, b)| (a - b).norm_sqr()).sum();
    (difference / pairs().map(|(a, _)| a.norm_sqr()).sum::<f64>()).sqrt()
}

/// The same scene with masses, stiffnesses and forces in other units of mass (`unit` of them a kilogram).
fn in_units(measured: &Loop, friction: bool, unit: f64) -> Problem {
    let scaled = |m: [[f64; 2]; 2]| Mat::from_fn(2, 2, |i, j| m[i][j] * unit);
    let forces = measured.coefficients().iter().map(|c| c * unit).collect();
    let rescaled = Loop::new(measured.displacement_amplitude(), forces).unwrap();
    let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
    let law: Arc<dyn contact::Law> = match friction {
        true => elastic_coulomb(6.705e6 * unit, 14.9 * unit),
        false => Arc::new(ScaledLoop::new(&rescaled, 0.0, magnitude, phase, Symmetry::Auto).unwrap()),
    };
    Problem {
        joints: Vec::new(),
        model: model(
            scaled([[3.98, 0.0], [0.0, 1.27]]),
            scaled([[24.0, 0.0], [0.0, 24.0]]),
            scaled([[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]),
        ),
        excitation: vec![force(1, 9.1 * unit)],
        contacts: vec![to_ground(law)],
        output: vec![0, 1],
    }
}

#[test]
fn units_do_not_matter() {
    let measured = reference_loop();
    for friction in [false, true] {
        for harmonics in [1, 7] {
            let settings = Settings::new(harmonics);
            let frequencies = [30.0, 60.0, 75.0, 100.0, 150.0];
            let reference = run(&in_units(&measured, friction, 1.0), &settings, &frequencies, 1);
            for unit in [1e12, 1e-12] {
                let other = run(&in_units(&measured, friction, unit), &settings, &frequencies, 1);
                for (a, b) in reference.solutions.iter().zip(&other.solutions) {
                    assert_eq!(b.status, Status::Converged);
                    let error = distance(a, b);
                    assert!(error < 1e-10, "unit {unit:e}, N = {harmonics}, {} Hz: {error:e}", a.frequency);
                }
            }
        }
    }
}

/// Starting phase of the excitation: the whole answer turns with it.
#[test]
fn the_origin_of_time_does_not_matter() {
    let settings = Settings::new(7);
    let plain = run(&paper_scene(), &settings, &[60.0, 75.0, 108.0], 1);
    for phase in [0.1, 1.0, -2.5] {
        let mut problem = paper_scene();
        problem.excitation[0].phase = phase;
        let turned = run(&problem, &settings, &[60.0, 75.0, 108.0], 1);
        for (a, b) in plain.solutions.iter().zip(&turned.solutions) {
            for (row, turned) in a.displacement.iter().zip(&b.displacement) {
                for (slot, (w, t)) in row.iter().zip(turned).enumerate() {
                    let expected = w * Complex64::cis((2 * slot + 1) as f64 * phase);
                    assert!((t - expected).norm() < 1e-11 * row[0].norm(), "{} Hz", a.frequency);
                }
            }
        }
    }
}

/// Once buffers have grown, a point allocates nothing.
#[test]
fn no_allocation_per_point() {
    let frequencies = range(15.0, 200.0, 60);
    for (problem, harmonics) in [(paper_scene(), 1), (scene_r(), 7), (paper_scene(), 7), (scene_p_cubic(), 3)]
    {
        let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
        let mut workspace = plan.workspace();
        let mut solution = Solution::default();
        let mut all = || {
            for &hertz in &frequencies {
                plan.solve_into(hertz, &mut workspace, &mut solution);
            }
        };
        all();
        let counted = allocation_counter::measure(all);
        assert_eq!(counted.count_total, 0, "N = {harmonics}");
    }
}

#[test]
fn an_interrupted_sweep_keeps_what_is_finished() {
    let plan = Plan::new(&paper_scene(), &Settings::new(3)).unwrap();
    let frequencies = range(15.0, 200.0, 400);
    let cancel = AtomicBool::new(false);
    let most = AtomicUsize::new(0);
    let progress = |finished: usize| {
        most.fetch_max(finished, Ordering::Relaxed);
        if finished == 50 {
            cancel.store(true, Ordering::Relaxed);
        }
        // The other thread must not run ahead of a first one that the machine stopped between the two lines above.
        while finished > 50 && !cancel.load(Ordering::Relaxed) {
            std::thread::yield_now();
        }
    };
    let options = SweepOptions { threads: Some(2), cancel: Some(&cancel), progress: Some(&progress) };
    let partial = sweep(&plan, &frequencies, &options);
    assert!(partial.interrupted);
    // Fifty, and the one point that the other thread may have had in hand.
    assert!((50..=51).contains(&partial.solutions.len()), "{}", partial.solutions.len());
    assert_eq!(most.into_inner(), partial.solutions.len());
    for solution in &partial.solutions {
        assert_eq!(*solution, plan.solve(solution.frequency, &mut plan.workspace()));
    }
}
