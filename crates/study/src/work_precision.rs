//! Error against run time as data: scene × method × setting, with the machine that it was measured on.

mod machine;
mod measure;
mod method;
mod stopwatch;

use serde::{Deserialize, Serialize};

pub use machine::Machine;
pub use measure::measure;
pub use method::Method;
pub use stopwatch::{Patience, Timed};

/// Everything that a run measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkPrecisionSet {
    /// The command that measured it.
    pub command: String,
    /// Where it ran.
    pub machine: Machine,
    /// How often things were repeated.
    pub patience: Patience,
    /// One entry a scene, method and setting.
    pub measurements: Vec<Measurement>,
}

/// One method with one setting on all points of one scene, on one thread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Name of the scene.
    pub scene: String,
    /// What solved it.
    pub method: Method,
    /// Points of the scene that have a truth.
    pub points: usize,
    /// Those of them that were not solved; their errors count as infinite.
    pub unsolved: usize,
    /// Middle of the points' errors; an error is the worst over the output dofs of the relative l2 error of the
    /// displacement spectrum. `None` is infinite.
    pub median_error: Option<f64>,
    /// The largest of the points' errors; `None` is infinite.
    pub worst_error: Option<f64>,
    /// Time a point in s: the median over repeats of the time for all points, after a warm-up, over their number.
    pub seconds: f64,
    /// Repeats behind that median.
    pub repeats: usize,
    /// Newton steps a point (time steps: iterations of all of them), mean.
    pub iterations: f64,
    /// Highest harmonic of the solutions, mean; zero where a method has none.
    pub harmonics: f64,
    /// Harmonics of them that were found by substitution, mean.
    pub slaved: f64,
    /// Samples or steps a period; zero where a method has none.
    pub samples: usize,
    /// Periods until the motion repeats, mean; zero where none are followed.
    pub periods: f64,
}

impl WorkPrecisionSet {
    /// The measurements of a scene.
    pub fn of_scene<'a>(&'a self, scene: &'a str) -> impl Iterator<Item = &'a Measurement> {
        self.measurements.iter().filter(move |m| m.scene == scene)
    }

    /// Names of the scenes in order of appearance.
    pub fn scenes(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for measurement in &self.measurements {
            if !names.contains(&measurement.scene.as_str()) {
                names.push(&measurement.scene);
            }
        }
        names
    }
}
