//! One size of one family, timed.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use hbm::{Plan, Settings, SweepOptions, sweep};

use super::chain;
use super::family::Family;

/// Repeats of a run, and the seconds after which there are no more.
const REPEATS: usize = 7;
const ENOUGH: f64 = 4.0;

/// A family's size and what it costs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Measured {
    pub(crate) family: Family,
    pub(crate) size: usize,
    /// A point, the plan being made: the median of the runs.
    pub(crate) seconds: f64,
    pub(crate) repeats: usize,
    /// Newton steps a point.
    pub(crate) iterations: f64,
    pub(crate) unsolved: usize,
    pub(crate) points: usize,
}

pub(super) fn measure(family: Family, size: usize) -> Result<Measured> {
    let problem = chain::problem(family.dofs(size), family.contacts(size))?;
    let plan = Plan::new(&problem, &Settings::new(family.harmonics(size)))?;
    let frequencies = chain::frequencies(family.points(size));
    let options = SweepOptions { threads: Some(family.threads()), ..SweepOptions::default() };
    let mut times = Vec::new();
    let began = Instant::now();
    let solved = loop {
        let start = Instant::now();
        let solved = sweep(&plan, &frequencies, &options);
        times.push(start.elapsed().as_secs_f64());
        if times.len() >= REPEATS || began.elapsed().as_secs_f64() > ENOUGH {
            break solved;
        }
    };
    ensure!(solved.threads == family.threads(), "{} threads worked", solved.threads);
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2).context("no run")?;
    let count = frequencies.len() as f64;
    Ok(Measured {
        family,
        size,
        seconds: median / count,
        repeats: times.len(),
        iterations: solved.solutions.iter().map(|s| s.stats.iterations as f64).sum::<f64>() / count,
        unsolved: solved.solutions.iter().filter(|s| !s.status.solved()).count(),
        points: frequencies.len(),
    })
}

impl Measured {
    pub(super) const HEAD: &str = "family,size,seconds_a_point,repeats,iterations_a_point,unsolved,points";

    pub(super) fn row(&self) -> String {
        let Self { family, size, seconds, repeats, iterations, unsolved, points } = self;
        format!("{},{size},{seconds:e},{repeats},{iterations},{unsolved},{points}\n", family.name())
    }

    pub(super) fn read(row: &str) -> Result<Self> {
        let cells: Vec<&str> = row.split(',').collect();
        let [family, size, seconds, repeats, iterations, unsolved, points] = cells[..] else {
            anyhow::bail!("not seven cells: {row}");
        };
        Ok(Self {
            family: Family::of(family)?,
            size: size.parse()?,
            seconds: seconds.parse()?,
            repeats: repeats.parse()?,
            iterations: iterations.parse()?,
            unsolved: unsolved.parse()?,
            points: points.parse()?,
        })
    }
}
