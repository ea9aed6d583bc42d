//! Solving the cases of a study, in parallel; what is kept of each.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use hbm::{Solution, Status};
use rayon::prelude::*;
use scene::{Curve, RunOptions, Scene};
use serde::{Deserialize, Serialize};

use crate::error::StudyError;
use crate::grid::{Keep, Study};
use crate::periodic::{dense, half_range};
use crate::shard::Shard;
use crate::truth;

/// What is kept of one point or one maximum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Position in [`Study::dofs`].
    pub dof: usize,
    /// In Hz.
    pub frequency: f64,
    /// Of a point: its status. Of a maximum: `local`, or `highest` for the highest point of the response.
    pub kind: Kind,
    /// Half the peak-to-peak displacement in m; `None` when the point failed.
    pub amplitude: Option<f64>,
    /// Amplitude of the lowest excited harmonic in m.
    pub first: Option<f64>,
    /// Energy in J that all contacts dissipate in a period.
    pub dissipation: Option<f64>,
    /// The solver's estimate.
    pub truncation_error: Option<f64>,
}

/// What an entry is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A point that was solved.
    Converged,
    /// A point at which contacts are held.
    Stuck,
    /// A point without a solution.
    Failed,
    /// A maximum inside the range.
    Local,
    /// The highest point of the response, the ends of the range included.
    Highest,
}

impl Kind {
    /// As results spell it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stuck => "stuck",
            Self::Failed => "failed",
            Self::Local => "local",
            Self::Highest => "highest",
        }
    }
}

/// A finished case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FinishedCase {
    /// Its number.
    pub case: usize,
    /// Points without a solution.
    pub failed: usize,
    /// What is kept, frequency by frequency (points) or dof by dof (maxima).
    pub entries: Vec<Entry>,
}

/// Takes a finished case for keeping.
pub type Keeper<'a> = dyn FnMut(&FinishedCase) -> Result<(), StudyError> + Send + 'a;

/// How a study runs.
#[derive(Default)]
pub struct StudyOptions<'a> {
    /// The part of the cases to solve; `None` is all.
    pub shard: Option<Shard>,
    /// Threads to use; `None` is one a core.
    pub threads: Option<usize>,
    /// Raised from outside to stop early; finished cases are kept.
    pub cancel: Option<&'a AtomicBool>,
    /// Called with the number of cases finished so far, from any thread.
    pub progress: Option<&'a (dyn Fn(usize) + Sync)>,
    /// Gets every case when it is finished, in no order.
    pub keeper: Option<&'a mut Keeper<'a>>,
}

impl Study {
    /// Solves all cases of the shard but those that are `known`; returns all finished ones, known ones included, in the order of
    /// the cases. Whatever the number of threads the result is the same, bit for bit.
    ///
    /// # Errors
    /// When the values of a case make no scene, or a finished case cannot be kept.
    pub fn run(
        &self,
        known: Vec<FinishedCase>,
        options: StudyOptions,
    ) -> Result<Vec<FinishedCase>, StudyError> {
        let StudyOptions { shard, threads, cancel, progress, keeper } = options;
        let shard = shard.unwrap_or(Shard::WHOLE);
        let mut there = vec![false; self.cases()];
        for case in &known {
            if let Some(there) = there.get_mut(case.case) {
                *there = true;
            }
        }
        let missing: Vec<usize> =
            (0..there.len()).filter(|i| shard.has(*i) && there.get(*i) == Some(&false)).collect();
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        let threads = threads.unwrap_or(cores).max(1);
        // Few cases leave threads to the frequencies of each.
        let inner = (threads / missing.len().max(1)).max(1);
        let count = AtomicUsize::new(known.len());
        let keeper = Mutex::new(keeper);
        let broken = AtomicBool::new(false);
        let one = |index: &usize| -> Result<Option<FinishedCase>, StudyError> {
            let stopped = || cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed));
            if stopped() || broken.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let solved = self.solve(*index, inner, cancel).and_then(|case| {
                let Some(case) = case else { return Ok(None) };
                if let Some(keep) = keeper.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
                    keep(&case)?;
                }
                Ok(Some(case))
            });
            match &solved {
                Ok(Some(_)) => {
                    let finished = count.fetch_add(1, Ordering::Relaxed) + 1;
                    if let Some(progress) = progress {
                        progress(finished);
                    }
                }
                Ok(None) => {}
                Err(_) => broken.store(true, Ordering::Relaxed),
            }
            solved
        };
        let pool = (threads > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
        let solved: Result<Vec<Option<FinishedCase>>, StudyError> = match pool {
            Some(Ok(pool)) => pool.install(|| missing.par_iter().with_max_len(1).map(one).collect()),
            _ => missing.iter().map(one).collect(),
        };
        let mut all = known;
        all.extend(solved?.into_iter().flatten());
        all.sort_by_key(|case| case.case);
        Ok(all)
    }

    /// One case; `None` when it was stopped.
    fn solve(
        &self,
        index: usize,
        threads: usize,
        cancel: Option<&AtomicBool>,
    ) -> Result<Option<FinishedCase>, StudyError> {
        let scene = self.scene(index)?;
        let prepared = scene.prepare().map_err(|error| self.in_case(index, error))?;
        let solved = prepared.solve(&RunOptions { threads: Some(threads), cancel, progress: None });
        if solved.interrupted() {
            return Ok(None);
        }
        let plan = prepared.plan();
        let response =
            Response { scene: &scene, orders: plan.orders(), first: plan.facts().fundamental.max(1) };
        let solutions = solved.solutions();
        let entries = match self.keep() {
            Keep::Points => response.points(solutions),
            Keep::Peaks => response.maxima(solutions),
        };
        let failed = solutions.iter().filter(|solution| !solution.status.solved()).count();
        Ok(Some(FinishedCase { case: index, failed, entries }))
    }
}

/// What turns solutions into entries.
struct Response<'a> {
    scene: &'a Scene,
    orders: &'a [usize],
    first: usize,
}

impl Response<'_> {
    fn entry(&self, solution: &Solution, dof: usize, kind: Kind) -> Entry {
        let row = solution.displacement.get(dof).filter(|_| solution.status.solved());
        let first = |row: &Vec<_>| {
            let column = self.orders.iter().position(|order| *order == self.first);
            column.and_then(|column| row.get(column)).map(|w: &num_complex::Complex64| w.norm())
        };
        Entry {
            dof,
            frequency: solution.frequency,
            kind,
            amplitude: row.map(|row| half_range(&dense(self.orders, row))),
            first: row.and_then(first),
            dissipation: row.map(|_| truth::dissipation(solution)),
            truncation_error: solution.truncation_error,
        }
    }

    fn dofs(&self) -> std::ops::Range<usize> {
        0..self.scene.output().len()
    }

    fn points(&self, solutions: &[Solution]) -> Vec<Entry> {
        let kind = |solution: &Solution| match solution.status {
            Status::Converged => Kind::Converged,
            Status::Stuck => Kind::Stuck,
            Status::Failed(_) => Kind::Failed,
        };
        let pairs = solutions.iter().flat_map(|solution| self.dofs().map(move |dof| (solution, dof)));
        pairs.map(|(solution, dof)| self.entry(solution, dof, kind(solution))).collect()
    }

    /// Every local maximum of every dof, and its highest point.
    fn maxima(&self, solutions: &[Solution]) -> Vec<Entry> {
        let of_dof = |dof: usize| {
            let amplitude = |solution: &Solution| self.entry(solution, dof, Kind::Local).amplitude;
            let curve: Curve =
                solutions.iter().map(|solution| (solution.frequency, amplitude(solution))).collect();
            let at = |frequency: f64, kind| {
                let there = solutions.iter().find(|s| s.frequency == frequency && s.status.solved());
                there.map(|solution| self.entry(solution, dof, kind))
            };
            let local: Vec<Entry> =
                scene::peaks(&curve).iter().filter_map(|peak| at(peak.frequency, Kind::Local)).collect();
            let highest = scene::highest(&curve).and_then(|peak| at(peak.frequency, Kind::Highest));
            highest.into_iter().chain(local)
        };
        self.dofs().flat_map(of_dof).collect()
    }
}
