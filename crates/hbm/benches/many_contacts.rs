//! Time of a frequency point with many contacts: a strip of 300 dofs with 1 to 100 elastic Coulomb contacts, N = 7.
//!
//! `cargo bench -p stickslip-hbm`. Planned and warm, one output dof, one thread.

#![allow(clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_main};
use hbm::{Plan, Settings, Solution};

#[path = "../tests/shared/strip.rs"]
mod strip;

use strip::{dense, frequencies};

/// Mean time of one frequency point on one core.
fn points(c: &mut Criterion) {
    let mut group = c.benchmark_group("many contacts, N = 7");
    let frequencies = frequencies(8);
    group.throughput(Throughput::Elements(frequencies.len() as u64));
    group.sample_size(10);
    for contacts in [1, 10, 100] {
        let plan = Plan::new(&dense(300, contacts), &Settings::new(7)).unwrap();
        let mut workspace = plan.workspace();
        let mut solution = Solution::default();
        group.bench_function(BenchmarkId::from_parameter(contacts), |b| {
            b.iter(|| {
                for &hertz in &frequencies {
                    plan.solve_into(black_box(hertz), &mut workspace, &mut solution);
                }
            });
        });
    }
    group.finish();
}

/// The groups above, as criterion's macro collects them.
#[allow(missing_docs)]
mod collected {
    use super::points;
    criterion::criterion_group!(benches, points);
}

criterion_main!(collected::benches);
