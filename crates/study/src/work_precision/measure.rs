//! One method on all points of one scene.

use hbm::{Plan, Problem, Solution};
use num_complex::Complex64;
use orbit::{Orbit, System};
use scene::Scene;

use super::{Measurement, Method, Patience};
use crate::error::StudyError;
use crate::start;
use crate::stepping::{Stepped, SteppingSettings, step_until_periodic};
use crate::system::system;
use crate::truth::{TrueDof, Truth};

/// Relative difference of two periods at which time stepping ends, and the most periods it may take.
const REPEATS: f64 = 1e-9;
const MOST_PERIODS: usize = 4000;

/// Solves `scene` at the frequencies of `truths` by `method`, one after the other, as often as `patience` asks.
///
/// # Errors
/// [`StudyError`] when the scene cannot be solved as posed.
pub fn measure(
    scene: &Scene,
    truths: &[Truth],
    method: Method,
    patience: &Patience,
) -> Result<Measurement, StudyError> {
    let blank = Measurement {
        scene: scene.name().to_owned(),
        method,
        points: truths.len(),
        unsolved: 0,
        median_error: None,
        worst_error: None,
        seconds: 0.0,
        repeats: 0,
        iterations: 0.0,
        harmonics: 0.0,
        slaved: 0.0,
        samples: 0,
        periods: 0.0,
    };
    let problem = scene.problem()?;
    match method {
        Method::Stepping { steps } => Ok(stepping(problem, truths, steps, patience, blank)),
        Method::Orbit => Ok(orbit(problem, truths, patience, blank)),
        Method::OrbitFromBalance { .. } => orbit_from_balance(problem, truths, patience, blank),
        _ => balance(problem, truths, patience, blank),
    }
}

/// The mean over points.
fn mean(values: impl Iterator<Item = f64>, count: usize) -> f64 {
    values.sum::<f64>() / count.max(1) as f64
}

impl Measurement {
    /// Fills in what all methods have; `errors` are infinite where a point is not solved.
    fn judged(mut self, mut errors: Vec<f64>, timed: super::Timed) -> Self {
        let finite = |error: Option<&f64>| error.copied().filter(|error| error.is_finite());
        errors.sort_by(f64::total_cmp);
        self.unsolved = errors.iter().filter(|error| !error.is_finite()).count();
        self.median_error = finite(errors.get(errors.len() / 2));
        self.worst_error = finite(errors.last());
        self.seconds = timed.seconds / self.points.max(1) as f64;
        self.repeats = timed.repeats;
        self
    }
}

fn balance(
    problem: &Problem,
    truths: &[Truth],
    patience: &Patience,
    mut blank: Measurement,
) -> Result<Measurement, StudyError> {
    let Some(settings) = blank.method.settings() else { return Ok(blank) };
    let plan = Plan::new(problem, &settings)?;
    let mut workspace = plan.workspace();
    let mut solutions = vec![Solution::default(); truths.len()];
    let timed = patience.time(|| {
        for (truth, solution) in truths.iter().zip(&mut solutions) {
            plan.solve_into(truth.frequency, &mut workspace, solution);
        }
    });
    let errors = truths.iter().zip(&solutions).map(|(truth, solution)| {
        truth.errors(plan.orders(), solution).map_or(f64::INFINITY, |errors| errors.spectrum)
    });
    blank.iterations = mean(solutions.iter().map(|s| s.stats.iterations as f64), truths.len());
    blank.harmonics = mean(solutions.iter().map(|s| s.harmonics as f64), truths.len());
    blank.slaved = mean(solutions.iter().map(|s| s.slaved as f64), truths.len());
    blank.samples = plan.facts().samples;
    Ok(blank.judged(errors.collect(), timed))
}

fn systems(problem: &Problem, truths: &[Truth]) -> Vec<System> {
    truths.iter().map(|truth| system(problem, truth.frequency)).collect()
}

/// Error of spectra `W_0 … ` that `of` tells for every output dof.
fn error(problem: &Problem, truth: &Truth, of: impl Fn(usize) -> Vec<Complex64>) -> f64 {
    let spectra: Vec<Vec<Complex64>> = problem.output.iter().map(|dof| of(*dof)).collect();
    let orders: Vec<usize> = (0..spectra.iter().map(Vec::len).max().unwrap_or(0)).collect();
    let rows: Vec<&[Complex64]> = spectra.iter().map(Vec::as_slice).collect();
    truth.spectrum_error(&orders, &rows)
}

fn stepping(
    problem: &Problem,
    truths: &[Truth],
    steps: usize,
    patience: &Patience,
    mut blank: Measurement,
) -> Measurement {
    let systems = systems(problem, truths);
    let settings = SteppingSettings { steps, tolerance: REPEATS, most_periods: MOST_PERIODS };
    let mut motions: Vec<Option<Stepped>> = Vec::new();
    let timed = patience.time(|| {
        let step =
            |(system, truth): (&System, &Truth)| step_until_periodic(system, truth.frequency, &settings).ok();
        motions = systems.iter().zip(truths).map(step).collect();
    });
    let errors = truths.iter().zip(&motions).map(|(truth, motion)| {
        motion.as_ref().map_or(f64::INFINITY, |motion| {
            error(problem, truth, |dof| motion.spectrum(dof, motion.displacement.len()))
        })
    });
    let solved = || motions.iter().flatten();
    blank.iterations = mean(solved().map(|motion| motion.iterations as f64), solved().count());
    blank.periods = mean(solved().map(|motion| motion.periods as f64), solved().count());
    blank.samples = steps;
    blank.judged(errors.collect(), timed)
}

/// Harmonics of an orbit that are compared with the truth, itself an orbit: what lies beyond is no truncation.
const COMPARED: usize = 128;

fn orbit_errors(problem: &Problem, truths: &[Truth], orbits: &[Option<Orbit>]) -> Vec<f64> {
    let one = |(truth, orbit): (&Truth, &Option<Orbit>)| {
        let Some(orbit) = orbit else { return f64::INFINITY };
        let dofs = problem.output.iter().zip(&truth.dofs);
        let error = |(dof, known): (&usize, &TrueDof)| {
            let found = orbit.spectrum(*dof, COMPARED);
            let square: f64 = found.iter().zip(&known.spectrum).map(|(a, b)| (a - b).norm_sqr()).sum();
            if known.norm > 0.0 { square.sqrt() / known.norm } else { 0.0 }
        };
        dofs.map(error).fold(0.0, f64::max)
    };
    truths.iter().zip(orbits).map(one).collect()
}

fn orbit(problem: &Problem, truths: &[Truth], patience: &Patience, blank: Measurement) -> Measurement {
    let systems = systems(problem, truths);
    let settings = orbit::Settings::default();
    let mut orbits = Vec::new();
    let timed = patience.time(|| {
        let find = |(system, truth): (&System, &Truth)| orbit::find(system, truth.frequency, &settings).ok();
        orbits = systems.iter().zip(truths).map(find).collect();
    });
    blank.judged(orbit_errors(problem, truths, &orbits), timed)
}

fn orbit_from_balance(
    problem: &Problem,
    truths: &[Truth],
    patience: &Patience,
    mut blank: Measurement,
) -> Result<Measurement, StudyError> {
    let Some(settings) = blank.method.settings() else { return Ok(blank) };
    let systems = systems(problem, truths);
    let mut problem = problem.clone();
    problem.output = (0..problem.model.dofs()).collect();
    let plan = Plan::new(&problem, &settings)?;
    let mut workspace = plan.workspace();
    let mut solution = Solution::default();
    let mut orbits = Vec::new();
    let timed = patience.time(|| {
        orbits.clear();
        for (system, truth) in systems.iter().zip(truths) {
            plan.solve_into(truth.frequency, &mut workspace, &mut solution);
            let start = (solution.status.solved())
                .then(|| start::state(system, plan.orders(), &solution.displacement, &solution));
            let settings = orbit::Settings { start, ..orbit::Settings::default() };
            orbits.push(orbit::find(system, truth.frequency, &settings).ok());
        }
    });
    blank.harmonics = settings.harmonics as f64;
    Ok(blank.judged(orbit_errors(&problem, truths, &orbits), timed))
}
