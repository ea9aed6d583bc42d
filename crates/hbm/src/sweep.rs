//! Many frequencies: a parallel map over independent points, or the paper's march.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::plan::Plan;
use crate::settings::Start;
use crate::solution::Solution;
use crate::workspace::Workspace;

/// How a sweep runs.
#[derive(Default)]
pub struct SweepOptions<'a> {
    /// Threads to use; `None` is one a core.
    pub threads: Option<usize>,
    /// Raised from outside to stop early; finished points are kept.
    pub cancel: Option<&'a AtomicBool>,
    /// Called with the number of points finished so far, from any thread.
    pub progress: Option<&'a (dyn Fn(usize) + Sync)>,
}

/// The points of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// One solution a frequency, in the order asked for; fewer when interrupted.
    pub solutions: Vec<Solution>,
    /// Stopped early.
    pub interrupted: bool,
    /// Threads that worked.
    pub threads: usize,
}

/// Points that one task of a parallel sweep solves at least where a point takes microseconds: enough that handing it out
/// costs nothing, few enough that threads stay busy to the end.
const QUICK_POINTS: usize = 16;

/// A model or a balance of more than so many unknowns takes long enough that every point is a task.
const QUICK_UNKNOWNS: usize = 48;

impl Plan {
    /// Points that one task of a parallel sweep solves at least. Sweeps of no more points use one thread.
    pub fn points_a_task(&self) -> usize {
        let unknowns = self.facts().unknowns.max(self.structure.dofs());
        if unknowns > QUICK_UNKNOWNS { 1 } else { QUICK_POINTS }
    }
}

/// Solves `plan` at every frequency in Hz. The result does not depend on the number of threads, bit for bit.
pub fn sweep(plan: &Plan, frequencies: &[f64], options: &SweepOptions) -> Sweep {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let wanted = options.threads.unwrap_or(cores).max(1);
    let points_a_task = plan.points_a_task();
    let tasks = frequencies.len().div_ceil(points_a_task).max(1);
    // A march is sequential, and a handful of points is solved before a pool of threads has started.
    let threads = if plan.settings.start == Start::March { 1 } else { wanted.min(tasks) };
    let finished = AtomicUsize::new(0);
    let one = |hertz: f64, workspace: &mut Workspace| -> Option<Solution> {
        if options.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
            return None;
        }
        let mut solution = Solution::default();
        match plan.settings.start {
            Start::Ladder => plan.solve_into(hertz, workspace, &mut solution),
            Start::March => plan.solve_next(hertz, workspace, &mut solution),
        }
        let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(progress) = options.progress {
            progress(count);
        }
        Some(solution)
    };
    let in_order = |frequencies: &[f64]| -> Vec<Option<Solution>> {
        let mut workspace = plan.workspace();
        frequencies.iter().map(|&hertz| one(hertz, &mut workspace)).collect()
    };
    let pool = (threads > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let (points, threads) = match pool {
        Some(Ok(pool)) => {
            let points = pool.install(|| {
                frequencies
                    .par_iter()
                    .with_min_len(points_a_task)
                    .map_init(|| plan.workspace(), |workspace, &hertz| one(hertz, workspace))
                    .collect()
            });
            (points, threads)
        }
        // One thread, or none to be had beside this one.
        _ => (in_order(frequencies), 1),
    };
    let solutions: Vec<Solution> = points.into_iter().flatten().collect();
    Sweep { interrupted: solutions.len() < frequencies.len(), solutions, threads }
}
