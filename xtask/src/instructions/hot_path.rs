//! What is counted: points of small scenes, planned and warm, on one thread.

use std::hint::black_box;
use std::path::Path;

use anyhow::{Result, ensure};
use hbm::{Plan, Settings, Solution};
use scene::Scene;
use serde_json::json;

/// Frequencies of a pass, from 15 to 200 Hz: stick, slip, resonances, interior reversals.
pub(super) const POINTS: usize = 16;

/// A scene with some N.
#[derive(Debug, Clone, Copy)]
pub(super) struct HotPath {
    pub(super) name: &'static str,
    scene: Source,
    harmonics: usize,
    /// Passes that are enough for a count and do not take long.
    pub(super) passes: usize,
}

#[derive(Debug, Clone, Copy)]
enum Source {
    File(&'static str),
    /// A chain of as many masses, held by friction at one end.
    Chain(usize),
}

const FRICTION: Source = Source::File("scenes/elastic-coulomb.json");
const LOOP: Source = Source::File("scenes/two-mass.json");
const SPRING: Source = Source::File("scenes/cubic.json");

const ALL: [HotPath; 8] = [
    HotPath { name: "elastic_coulomb, N = 1", scene: FRICTION, harmonics: 1, passes: 20 },
    HotPath { name: "elastic_coulomb, N = 7", scene: FRICTION, harmonics: 7, passes: 4 },
    HotPath { name: "elastic_coulomb, N = 31", scene: FRICTION, harmonics: 31, passes: 2 },
    HotPath { name: "scaled_loop, N = 1", scene: LOOP, harmonics: 1, passes: 20 },
    HotPath { name: "scaled_loop, N = 7", scene: LOOP, harmonics: 7, passes: 1 },
    HotPath { name: "scaled_loop, N = 31", scene: LOOP, harmonics: 31, passes: 1 },
    HotPath { name: "cubic, N = 7", scene: SPRING, harmonics: 7, passes: 10 },
    HotPath { name: "condensation of 100 dofs", scene: Source::Chain(100), harmonics: 1, passes: 40 },
];

impl HotPath {
    pub(super) fn all() -> &'static [Self] {
        &ALL
    }

    pub(super) fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|path| path.name == name)
    }

    /// Solves all points so many times, after once to grow the buffers.
    pub(super) fn run(&self, root: &Path, passes: usize) -> Result<()> {
        let scene = match self.scene {
            Source::File(file) => Scene::from_file(&root.join(file))?,
            Source::Chain(masses) => chain(masses)?,
        };
        let plan = Plan::new(scene.problem()?, &Settings::new(self.harmonics))?;
        let mut workspace = plan.workspace();
        let mut solution = Solution::default();
        for _ in 0..=passes {
            for point in 0..POINTS {
                let hertz = 15.0 + 185.0 * point as f64 / (POINTS - 1) as f64;
                plan.solve_into(black_box(hertz), &mut workspace, &mut solution);
                ensure!(solution.status.solved(), "{}: {hertz} Hz is not solved", self.name);
            }
        }
        Ok(())
    }
}

/// Masses of 1 kg between springs, the first on a friction contact, the last excited.
fn chain(masses: usize) -> Result<Scene> {
    let names: Vec<String> = (1..=masses).map(|mass| format!("w{mass}")).collect();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..masses).map(|i| (0..masses).map(|j| entry(i, j)).collect()).collect()
    };
    let last = masses - 1;
    let stiffness = matrix(&|i, j| match i.abs_diff(j) {
        0 if i == last => 4e5,
        0 => 8e5,
        1 => -4e5,
        _ => 0.0,
    });
    let scene = json!({
        "name": "chain",
        "model": {
            "dofs": names,
            "mass": matrix(&|i, j| f64::from(i == j)),
            "damping": {"rayleigh": {"mass": 2.0, "stiffness": 1e-5}},
            "stiffness": stiffness,
        },
        "excitation": [{"dof": names[last], "harmonic": 1, "amplitude": 3.0}],
        "contacts": [{
            "name": "foot", "between": ["w1", "ground"],
            "law": {"type": "elastic_coulomb", "stiffness": 6e4, "slip_force": 1.0},
        }],
        "frequencies": [50.0],
        "harmonics": 1,
        "output": ["w1"],
    });
    Ok(Scene::from_str(&scene.to_string(), Path::new("."))?)
}
