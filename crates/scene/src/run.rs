//! A scene made ready: its sweep, its linear response, its motion in time.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use hbm::{Plan, Solution, Sweep, SweepOptions, Waveform};

use crate::explain::{self, Step};
use crate::outcome::{Outcome, Timing};
use crate::pose::Posed;
use crate::reduction::ReductionFacts;
use crate::response::Responses;
use crate::scene::Scene;
use crate::stability::{self, Judge};

/// A scene and the plan that solves it.
#[derive(Debug)]
pub struct Prepared<'s> {
    pub(crate) scene: &'s Scene,
    /// Not there where a large structure is solved as it is.
    pub(crate) posed: Option<&'s Posed>,
    pub(crate) plan: Plan,
    setup: Duration,
}

/// One period of a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Instants in s, from 0 up to a period, which is left out.
    pub time: Vec<f64>,
    /// Displacements and forces at these instants.
    pub waveform: Waveform,
}

/// The solved points of a sweep.
#[derive(Debug)]
pub struct Solved<'s> {
    pub(crate) prepared: &'s Prepared<'s>,
    pub(crate) sweep: Sweep,
    /// Where stability is not known, and why.
    pub(crate) unknown: Vec<(f64, String)>,
    solve: Duration,
}

impl<'s> Prepared<'s> {
    pub(crate) fn new(scene: &'s Scene, posed: Option<&'s Posed>, plan: Plan, setup: Duration) -> Self {
        Self { scene, posed, plan, setup }
    }

    /// How the structure was reduced, where it was.
    pub fn reduction(&self) -> Option<ReductionFacts> {
        self.posed?.facts(self.scene.dofs().len())
    }

    /// What a user should know about the scene's data and its reduction.
    pub fn notes(&self) -> Vec<String> {
        [self.scene.notes(), &self.posed.map(Posed::notes).unwrap_or_default()].concat()
    }

    /// What the scene needs and what it leaves out, and why.
    pub fn explain(&self) -> Vec<Step> {
        explain::steps(self)
    }

    /// Solves every frequency of the scene.
    pub fn solve(&self, options: &SweepOptions) -> Solved<'_> {
        let began = Instant::now();
        let mut sweep = hbm::sweep(&self.plan, self.scene.frequencies.as_slice(), options);
        let mut unknown = Vec::new();
        if self.scene.settings.stability {
            let by_balance =
                |_: f64, solution: &Solution| self.plan.stability(solution).map_err(|why| why.to_string());
            unknown = stability::judge(by_frequency(&mut sweep), &by_balance);
        }
        Solved { prepared: self, sweep, unknown, solve: began.elapsed() }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        self.scene
    }

    /// The plan behind it.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How many frequencies there are to solve.
    pub fn points(&self) -> usize {
        self.scene.frequencies.as_slice().len()
    }
}

fn by_frequency(sweep: &mut Sweep) -> impl Iterator<Item = (f64, &mut Solution)> {
    sweep.solutions.iter_mut().map(|solution| (solution.frequency, solution))
}

impl Solved<'_> {
    /// Asks `judge` for the stability of the points whose contacts remember, where stability is wanted.
    pub fn judge(&mut self, judge: &Judge) {
        let Some(posed) = self.prepared.posed.filter(|_| !self.unknown.is_empty()) else { return };
        let began = Instant::now();
        let orders = self.prepared.plan.orders();
        let find = |_: f64, solution: &Solution| judge(&posed.problem, orders, solution);
        self.unknown = stability::judge(by_frequency(&mut self.sweep), &find);
        self.solve += began.elapsed();
    }

    /// Stopped before the last point.
    pub fn interrupted(&self) -> bool {
        self.sweep.interrupted
    }

    /// The points that were solved or given up, in the scene's order.
    pub fn solutions(&self) -> &[Solution] {
        &self.sweep.solutions
    }

    /// The result as plain data.
    pub fn outcome(&self) -> Outcome {
        let timing = Timing {
            setup_s: self.prepared.setup.as_secs_f64(),
            solve_s: self.solve.as_secs_f64(),
            threads: self.sweep.threads,
        };
        Outcome::new(self, timing)
    }

    /// Amplitudes over frequency, with contacts and without them.
    pub fn responses(&self) -> Responses {
        Responses::new(self)
    }

    /// One period of the first point; `None` when it failed, or when it is static and has no period.
    pub fn motion(&self) -> Option<Motion> {
        let solution = self.sweep.solutions.first()?;
        let samples = (32 * solution.harmonics).next_power_of_two().max(512);
        let waveform = self.prepared.plan.waveform(solution, samples)?;
        let omega = TAU * solution.frequency;
        let time = waveform.phase.iter().map(|phase| phase / omega).collect();
        (omega > 0.0).then_some(Motion { time, waveform })
    }
}
