//! Speed of each stage: loop fit, one law evaluation, one Newton solve, one sweep.
//!
//! `cargo bench -p stickslip-tests`. Times are a point's own: planned and warm, all dofs recovered, no files.

use std::hint::black_box;
use std::path::Path;

use contact::Workspace;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_main};
use hbm::{Plan, Problem, Settings, Solution, SweepOptions, sweep};
use hysteresis::{FitSettings, ReadOptions, Record};
use num_complex::Complex64;
use stickslip_tests::orbit_models::two_mass;
use stickslip_tests::{SampledMotion, elastic_coulomb, paper_scene, scene_p_cubic, scene_r};

fn loop_fit(c: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/loops/reference.csv");
    let record = Record::read(&path, &ReadOptions::default()).unwrap();
    c.bench_function("loop fit, 1000 samples", |b| {
        b.iter(|| hysteresis::fit(black_box(&record), &FitSettings::default()).unwrap());
    });
}

fn law_evaluation(c: &mut Criterion) {
    let mut group = c.benchmark_group("force and tangent, 256 samples");
    let samples = 256;
    let spectrum =
        [Complex64::ZERO, Complex64::new(7e-6, 1e-6), Complex64::ZERO, Complex64::new(5e-7, -4e-7)];
    let motion = SampledMotion::new(&spectrum, samples);
    for problem in [scene_r(), paper_scene(), scene_p_cubic()] {
        let law = &problem.contacts[0].law;
        let mut workspace = Workspace::new(samples);
        let mut force = vec![0.0; samples];
        group.bench_function(law.name(), |b| {
            b.iter(|| {
                law.force(black_box(&motion.motion()), &mut workspace, &mut force).unwrap();
                law.tangent(&motion.motion(), &mut workspace).local[0]
            });
        });
    }
    group.finish();
}

/// Frequencies that visit stick, slip, resonances and interior reversals.
fn frequencies(points: usize) -> Vec<f64> {
    (0..points).map(|i| 15.0 + 185.0 * i as f64 / (points - 1) as f64).collect()
}

/// Mean time of one frequency point on one core.
fn points(c: &mut Criterion) {
    let mut group = c.benchmark_group("point");
    let frequencies = frequencies(64);
    group.throughput(Throughput::Elements(frequencies.len() as u64));
    let problems: [(&str, Problem); 3] =
        [("elastic_coulomb", scene_r()), ("scaled_loop", paper_scene()), ("cubic", scene_p_cubic())];
    for (name, problem) in &problems {
        for harmonics in [1, 7, 31] {
            let plan = Plan::new(problem, &Settings::new(harmonics)).unwrap();
            let mut workspace = plan.workspace();
            let mut solution = Solution::default();
            group.bench_function(BenchmarkId::new(*name, harmonics), |b| {
                b.iter(|| {
                    for &hertz in &frequencies {
                        plan.solve_into(black_box(hertz), &mut workspace, &mut solution);
                    }
                });
            });
        }
    }
    group.finish();
}

/// Mean time of one exact orbit, from rest; frequencies at which the contact slips.
fn orbits(c: &mut Criterion) {
    let mut group = c.benchmark_group("exact orbit");
    let frequencies = [57.0, 62.0, 75.0, 100.0, 108.0, 112.0];
    group.throughput(Throughput::Elements(frequencies.len() as u64));
    let system = two_mass(elastic_coulomb(6.705e6, 6.705e6 * 2.232e-6));
    group.bench_function("elastic_coulomb", |b| {
        b.iter(|| {
            frequencies.map(|hertz| orbit::find(black_box(&system), hertz, &orbit::Settings::default()))
        });
    });
    group.finish();
}

/// 20 000 points at N = 7 on one and two threads.
fn threads(c: &mut Criterion) {
    let mut group = c.benchmark_group("sweep of 20000 points, N = 7");
    group.sample_size(10);
    let frequencies = frequencies(20_000);
    let plan = Plan::new(&scene_r(), &Settings::new(7)).unwrap();
    for threads in [1, 2] {
        let options = SweepOptions { threads: Some(threads), ..Default::default() };
        group.bench_function(BenchmarkId::new("threads", threads), |b| {
            b.iter(|| sweep(&plan, black_box(&frequencies), &options));
        });
    }
    group.finish();
}

/// The groups above, as criterion's macro collects them.
#[allow(missing_docs)]
mod collected {
    use super::{law_evaluation, loop_fit, orbits, points, threads};
    criterion::criterion_group!(benches, loop_fit, law_evaluation, points, orbits, threads);
}

criterion_main!(collected::benches);
