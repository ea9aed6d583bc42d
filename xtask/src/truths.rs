//! The truth at every point of a scene, and how well it is known.

use anyhow::Result;
use hbm::{Plan, Settings};
use rayon::prelude::*;
use scene::Scene;
use study::{Reference, Truth, Truths};

/// The truth at one frequency.
pub(crate) struct Known {
    pub(crate) truth: Truth,
    /// Its own relative error, at most.
    pub(crate) accuracy: f64,
}

/// What closes an orbit, and rounding.
const ORBIT: f64 = 1e-11;

/// The truth at every frequency of `scene`, in its order, for comparison with solutions of up to `largest` harmonics, or
/// of up to `highest` where it is an orbit; none where none was found.
pub(crate) fn of_scene(scene: &Scene, largest: usize, highest: usize) -> Result<Vec<Option<Known>>> {
    let truths = Truths::new(scene, largest)?.compared_up_to(highest);
    let known = |hertz: &f64| -> Result<Option<Known>> {
        let Ok(truth) = truths.at(*hertz) else { return Ok(None) };
        let accuracy = match truth.reference {
            Reference::Orbit => ORBIT,
            // What half as many harmonics are off by is more than what these are off by.
            Reference::Harmonics(n) => {
                let plan = Plan::new(scene.problem()?, &Settings::new(n / 2))?;
                let solution = plan.solve(*hertz, &mut plan.workspace());
                truth.errors(plan.orders(), &solution).map_or(f64::INFINITY, |errors| errors.spectrum)
            }
        };
        Ok(Some(Known { truth, accuracy }))
    };
    scene.frequencies().as_slice().par_iter().map(known).collect()
}
