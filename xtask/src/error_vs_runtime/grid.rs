//! Which methods are measured, at which settings.

use anyhow::Result;
use contact::Mechanism;
use hbm::{Plan, Settings};
use scene::Scene;
use study::work_precision::Method;

/// A setting whose points together take longer than this, in s, is the last of its series.
pub(super) const LONGEST: f64 = 2.0;

/// N of sampled forces on request; N where no truth is exact.
const FEW: [usize; 7] = [1, 3, 7, 15, 31, 63, 127];
/// N where the truth is exact.
const MANY: [usize; 10] = [1, 3, 7, 15, 31, 63, 127, 255, 511, 1023];
/// N without a tail.
const NEWTON: [usize; 8] = [1, 3, 7, 15, 31, 63, 127, 255];
pub(super) const SAMPLES: [usize; 5] = [64, 128, 256, 1024, 4096];
const TOLERANCES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
const STEPS: [usize; 4] = [64, 256, 1024, 4096];
/// N of a solution that an orbit is looked for from.
const START: usize = 15;

/// Series of growing settings for `scene`; `exact` when its truths are orbits.
pub(super) fn series(scene: &Scene, exact: bool) -> Result<Vec<Vec<Method>>> {
    let problem = scene.problem()?;
    let lowest = problem.excitation.iter().map(|e| e.harmonic).max().unwrap_or(1).max(1);
    let by_events = Plan::new(problem, &Settings::new(7)).is_ok_and(|plan| plan.facts().samples == 0);
    let followed = problem.contacts.iter().all(|c| !matches!(c.law.mechanism(), Mechanism::None { .. }));
    let some = |all: &[usize]| all.iter().copied().filter(move |n| *n >= lowest).collect::<Vec<_>>();
    let most = if exact { &MANY[..] } else { &FEW[..] };
    let mut series = vec![some(most).into_iter().map(|harmonics| Method::Balance { harmonics }).collect()];
    if by_events {
        series.push(some(&NEWTON).into_iter().map(|harmonics| Method::WithoutTail { harmonics }).collect());
    }
    for samples in SAMPLES {
        let fits = |harmonics: &usize| 4 * (harmonics + 1) <= samples;
        let counts = some(&FEW).into_iter().filter(fits);
        series.push(counts.map(|harmonics| Method::Sampled { harmonics, samples }).collect());
    }
    let most = if exact { 1023 } else { 127 };
    series.push(TOLERANCES.iter().map(|&tolerance| Method::Adaptive { tolerance, most }).collect());
    if followed {
        series.push(STEPS.iter().map(|&steps| Method::Stepping { steps }).collect());
        if exact {
            series.push(vec![Method::Orbit]);
            series.push(vec![Method::OrbitFromBalance { harmonics: START }]);
        }
    }
    Ok(series)
}

/// Tolerances of the quick check, and the most harmonics they may take.
pub(super) const QUICK_TOLERANCES: [f64; 2] = [1e-2, 1e-4];
pub(super) const QUICK_MOST: usize = 255;

/// What the quick check solves.
pub(super) fn quick() -> Vec<Method> {
    let balance = [7, 15, 31, 63].map(|harmonics| Method::Balance { harmonics });
    let sampled = [256, 1024].map(|samples| Method::Sampled { harmonics: 63, samples });
    let adaptive = QUICK_TOLERANCES.map(|tolerance| Method::Adaptive { tolerance, most: QUICK_MOST });
    let stepping = [128, 512].map(|steps| Method::Stepping { steps });
    balance.into_iter().chain(sampled).chain(adaptive).chain(stepping).collect()
}
