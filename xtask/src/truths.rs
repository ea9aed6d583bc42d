//! The truth at every point of a scene: the best solution there is to compare with.

use anyhow::{Context, Result};
use hbm::{Plan, Problem, Settings, Solution, Workspace};
use rayon::prelude::*;
use scene::Scene;
use study::Reference;

/// The truth at one frequency.
pub(crate) struct Truth {
    pub(crate) reference: Reference,
    /// Half the range of each contact's relative displacement in m.
    pub(crate) amplitudes: Vec<f64>,
}

/// Largest system that a reference may take.
const MOST_UNKNOWNS: usize = 800;
/// N of references, the best first.
const HARMONICS: [usize; 4] = [255, 127, 63, 31];
/// Samples a period and harmonic for laws that need samples.
const SAMPLES: usize = 16;

/// The truth at every frequency of `scene`, in its order; none where no reference was found.
pub(crate) fn of_scene(scene: &Scene) -> Result<Vec<Option<Truth>>> {
    let problem = scene.problem();
    let mut pairs = Vec::new();
    for pair in HARMONICS.windows(2) {
        let [most, fewer] = [plan(problem, pair[0])?, plan(problem, pair[1])?];
        if most.facts().unknowns <= MOST_UNKNOWNS || pair[1] == HARMONICS[HARMONICS.len() - 1] {
            pairs.push((most, fewer));
            break;
        }
    }
    let (most, fewer) = pairs.first().context("no reference fits")?;
    let frequencies = scene.frequencies().as_slice();
    let buffers = || (most.workspace(), fewer.workspace());
    Ok(frequencies
        .par_iter()
        .map_init(buffers, |(a, b), &hertz| truth((most, a), (fewer, b), hertz))
        .collect())
}

fn truth(most: (&Plan, &mut Workspace), fewer: (&Plan, &mut Workspace), hertz: f64) -> Option<Truth> {
    let best = most.0.solve(hertz, most.1);
    let half = fewer.0.solve(hertz, fewer.1);
    let reference = Reference::of_solution(most.0, &best, 0.0)?;
    // What half as many harmonics are off by is more than what these are off by.
    let accuracy = reference.error(fewer.0, &half);
    Some(Truth { reference: Reference { accuracy, ..reference }, amplitudes: amplitudes(&best) })
}

/// Half the range of each contact's relative displacement in m.
pub(crate) fn amplitudes(solution: &Solution) -> Vec<f64> {
    solution.contacts.iter().map(|contact| contact.amplitude).collect()
}

/// Events where all laws have them, else so many samples that they do not matter.
fn plan(problem: &Problem, harmonics: usize) -> Result<Plan> {
    let mut settings = Settings::new(harmonics);
    let plan = Plan::new(problem, &settings)?;
    if plan.facts().samples == 0 {
        return Ok(plan);
    }
    settings.samples = Some(SAMPLES * harmonics);
    Ok(Plan::new(problem, &settings)?)
}
