//! The paper's strategy, marching over frequencies, beside points that are solved on their own.

use anyhow::Result;
use hbm::{Jacobian, Plan, Settings, Solution, Start};
use scene::Scene;
use serde::{Deserialize, Serialize};
use study::work_precision::Patience;

/// One sweep in one way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct March {
    pub(super) scene: String,
    pub(super) harmonics: usize,
    pub(super) way: Way,
    /// Frequencies from the scene's lowest to its highest, equally spaced.
    pub(super) points: usize,
    pub(super) unsolved: usize,
    /// Share of the points at which the solution is that of independent points, up to 1e-6.
    pub(super) same: f64,
    /// Time a point in s: the median over repeats of the whole sweep, after a warm-up.
    pub(super) seconds: f64,
    pub(super) repeats: usize,
    /// Newton steps a point, mean.
    pub(super) iterations: f64,
}

/// How a sweep gets from point to point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Way {
    /// Every point on its own, closed-form derivatives.
    Independent,
    /// From the previous frequency's solution, closed-form derivatives.
    March,
    /// From the previous frequency's solution, derivatives by differences.
    MarchDifference,
}

/// Scenes that are swept.
const SCENES: [&str; 5] =
    ["cubic", "hoffmann-2017", "hoffmann-2017-elastic-coulomb", "many-contacts", "scene-p"];
const HARMONICS: [usize; 3] = [1, 7, 31];
const POINTS: usize = 200;
const WAYS: [Way; 3] = [Way::Independent, Way::March, Way::MarchDifference];

/// Relative difference beyond which two solutions are two.
const SAME: f64 = 1e-6;

pub(super) fn measure(scenes: &[Scene], patience: &Patience) -> Result<Vec<March>> {
    let mut marches = Vec::new();
    for scene in scenes.iter().filter(|scene| SCENES.contains(&scene.name())) {
        for harmonics in HARMONICS {
            let mut own: Vec<Solution> = Vec::new();
            for way in WAYS {
                let (march, solutions) = sweep(scene, harmonics, way, &own, patience)?;
                if way == Way::Independent {
                    own = solutions;
                }
                marches.push(march);
            }
        }
    }
    Ok(marches)
}

fn sweep(
    scene: &Scene,
    harmonics: usize,
    way: Way,
    own: &[Solution],
    patience: &Patience,
) -> Result<(March, Vec<Solution>)> {
    let mut settings = Settings::new(harmonics);
    if way != Way::Independent {
        settings.start = Start::March;
    }
    if way == Way::MarchDifference {
        settings.jacobian = Jacobian::Difference;
    }
    let plan = Plan::new(scene.problem()?, &settings)?;
    let mut workspace = plan.workspace();
    let given = scene.frequencies().as_slice();
    let lowest = given.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = given.iter().copied().fold(0.0, f64::max);
    let hertz = |i: usize| lowest + (highest - lowest) * i as f64 / (POINTS - 1) as f64;
    let mut solutions = vec![Solution::default(); POINTS];
    let timed = patience.time(|| {
        for (i, solution) in solutions.iter_mut().enumerate() {
            if i == 0 || way == Way::Independent {
                plan.solve_into(hertz(i), &mut workspace, solution);
            } else {
                plan.solve_next(hertz(i), &mut workspace, solution);
            }
        }
    });
    let compared = if way == Way::Independent { &solutions } else { own };
    let same = solutions.iter().zip(compared).filter(|(a, b)| same(a, b)).count();
    let march = March {
        scene: scene.name().to_owned(),
        harmonics,
        way,
        points: POINTS,
        unsolved: solutions.iter().filter(|solution| !solution.status.solved()).count(),
        same: same as f64 / POINTS as f64,
        seconds: timed.seconds / POINTS as f64,
        repeats: timed.repeats,
        iterations: solutions.iter().map(|s| s.stats.iterations as f64).sum::<f64>() / POINTS as f64,
    };
    Ok((march, solutions))
}

fn same(a: &Solution, b: &Solution) -> bool {
    let pairs = || a.displacement.iter().flatten().zip(b.displacement.iter().flatten());
    let difference: f64 = pairs().map(|(a, b)| (a - b).norm_sqr()).sum();
    let size: f64 = pairs().map(|(_, b)| b.norm_sqr()).sum();
    a.status.solved() && b.status.solved() && difference <= SAME * SAME * size
}
