//! Running cases: each by itself, panics caught, timed.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use anyhow::{Context, Result};
use hbm::{FailureReason, Plan, Settings, Solution, Status};
use rayon::prelude::*;

use super::case::{Case, Label, Ready, Reason};
use super::families::{FAMILIES, case};
use super::judge::{Margin, judge};

/// How a case ended, and why.
#[derive(Debug, Clone)]
pub(super) enum Ending {
    Solved(Margin),
    Stuck(Margin),
    /// Refused with a reason that fits the label.
    Refused(String),
    /// No solution of a case that has one, or a refusal whose reason does not fit.
    Failed(String),
    /// A reported solution that is none.
    Wrong(String),
    Panicked(String),
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Solved(margin) => write!(f, "solved, residual {:.1e}", margin.backward),
            Self::Stuck(margin) => write!(f, "stuck, residual {:.1e}", margin.backward),
            Self::Refused(why) => write!(f, "refused: {why}"),
            Self::Failed(why) => write!(f, "FAILED: {why}"),
            Self::Wrong(why) => write!(f, "WRONG: {why}"),
            Self::Panicked(why) => write!(f, "PANICKED: {why}"),
        }
    }
}

/// One line of the record.
#[derive(Debug, Clone)]
pub(super) struct Record {
    pub(super) id: String,
    pub(super) family: &'static str,
    pub(super) law: &'static str,
    pub(super) label: Label,
    pub(super) ending: Ending,
    pub(super) seconds: f64,
    pub(super) harmonics: usize,
}

/// A case slower than this is worth a line, in s.
const SLOW: f64 = 1.0;

impl Record {
    pub(super) fn notable(&self) -> bool {
        self.seconds > SLOW
            || matches!(self.ending, Ending::Failed(_) | Ending::Wrong(_) | Ending::Panicked(_))
    }
}

impl fmt::Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { id, law, label, ending, seconds, harmonics, .. } = self;
        write!(f, "{id} ({law}, N = {harmonics}, {label}, {seconds:.3} s): {ending}")
    }
}

/// Runs all cases on all cores, in their order.
pub(super) fn all(seed: u64, cases: &[(usize, usize)]) -> Vec<Record> {
    // Panics become lines of the table.
    std::panic::set_hook(Box::new(|_| {}));
    let records = cases.par_iter().map(|&(family, index)| record(&case(seed, family, index))).collect();
    let _ = std::panic::take_hook();
    records
}

/// Runs one case and prints all there is to know of it.
pub(super) fn one(seed: u64, id: &str) -> Result<()> {
    let (name, index) = id.rsplit_once('-').context("a case is FAMILY-NUMBER")?;
    let family = FAMILIES.iter().position(|f| f.name == name).with_context(|| format!("no family {name}"))?;
    let case = case(seed, family, index.parse().context("a case is FAMILY-NUMBER")?);
    println!("{case:#?}");
    if let Ok(ready) = case.build() {
        let plan = Plan::new(&ready.problem, &Settings::new(case.harmonics))?;
        println!("{:#?}", plan.facts());
        println!("{:#?}", plan.solve(case.frequency, &mut plan.workspace()));
    }
    println!("{}", record(&case));
    Ok(())
}

/// Solves and judges one case.
pub(super) fn record(case: &Case) -> Record {
    let began = Instant::now();
    let mut seconds = 0.0;
    let outcome = catch_unwind(AssertUnwindSafe(|| attempt(case, &began, &mut seconds)));
    let ending = outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
        Ending::Panicked(text.unwrap_or_default())
    });
    let law = case.contacts.first().map_or("", |c| c.law.name());
    let Case { id, family, label, harmonics, .. } = case;
    Record { id: id.clone(), family, law, label: *label, ending, seconds, harmonics: *harmonics }
}

fn attempt(case: &Case, began: &Instant, seconds: &mut f64) -> Ending {
    let refusal = |what: String, fits: bool| match case.label {
        Label::MayBeRefused(_) if fits => Ending::Refused(what),
        _ => Ending::Failed(what),
    };
    let input = matches!(case.label, Label::MayBeRefused(Reason::NoLoop | Reason::NegativeMagnitude));
    let solved = solve(case);
    *seconds = began.elapsed().as_secs_f64();
    let (ready, plan, solution) = match solved {
        Ok(all) => all,
        Err(error) => return refusal(format!("{error:#}"), input),
    };
    match solution.status {
        Status::Failed(reason) => refusal(reason.to_string(), fits(case.label, reason)),
        Status::Converged | Status::Stuck => match judge(case, &ready, &plan, &solution) {
            Ok(margin) if solution.status == Status::Stuck => Ending::Stuck(margin),
            Ok(margin) => Ending::Solved(margin),
            Err(error) => Ending::Wrong(format!("{error:#}")),
        },
    }
}

fn solve(case: &Case) -> Result<(Ready, Plan, Solution)> {
    let ready = case.build()?;
    let plan = Plan::new(&ready.problem, &Settings::new(case.harmonics))?;
    let solution = plan.solve(case.frequency, &mut plan.workspace());
    Ok((ready, plan, solution))
}

/// Whether a typed reason is the one that the label names.
fn fits(label: Label, reason: FailureReason) -> bool {
    let Label::MayBeRefused(expected) = label else { return false };
    match expected {
        Reason::UnboundedResonance => matches!(reason, FailureReason::SingularStructure { .. }),
        // A contact may hold what nothing else supports, up to its limit.
        Reason::FreeBody => {
            matches!(reason, FailureReason::SingularStructure { .. } | FailureReason::HoldingLimit)
        }
        // At an undamped resonance the reason is the resonance.
        Reason::Staircase => {
            matches!(reason, FailureReason::NotConverged | FailureReason::SingularStructure { .. })
        }
        Reason::Undetermined => reason == FailureReason::NotConverged,
        Reason::HoldingShell => matches!(reason, FailureReason::HoldingLimit | FailureReason::NotConverged),
        Reason::NegativeMagnitude => {
            matches!(
                reason,
                FailureReason::Law(_) | FailureReason::HoldingLimit | FailureReason::NotConverged
            )
        }
        Reason::NoLoop => true,
    }
}
