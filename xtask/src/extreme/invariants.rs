//! What must not change an answer: units, threads.

use std::fmt;

use anyhow::{Result, ensure};
use hbm::{Plan, Settings, SweepOptions, sweep};
use rayon::prelude::*;

use super::case::{Case, Label};
use super::families::{FAMILIES, case};

/// How many cases were compared.
pub(super) struct Invariants {
    rescaled: usize,
    threads: usize,
}

impl fmt::Display for Invariants {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} cases end alike in m and N and in mm and kN; {} sweeps are identical, bit for bit, with 1 and 2 threads.",
            self.rescaled, self.threads
        )
    }
}

/// Families whose cases are compared.
const COMPARED: [&str; 6] = ["stiffness", "force", "damping", "free-resonance", "grazing", "mixed"];

/// Compares `repeats` · 20 cases of each family.
pub(super) fn check(seed: u64, repeats: usize) -> Result<Invariants> {
    let cases: Vec<Case> = COMPARED
        .iter()
        .filter_map(|name| FAMILIES.iter().position(|family| family.name == *name))
        .flat_map(|family| (0..20 * repeats).map(move |index| case(seed, family, index)))
        .filter(|case| case.label == Label::Solvable)
        .collect();
    let rescaled = cases.par_iter().map(rescaling).collect::<Result<Vec<bool>>>()?;
    let mut threads = 0;
    for case in cases.iter().step_by(7) {
        same_on_threads(case)?;
        threads += 1;
    }
    Ok(Invariants { rescaled: rescaled.into_iter().filter(|compared| *compared).count(), threads })
}

/// Whether the case has a closed form or exact events and so ends alike in other units; `false` where it has neither.
fn rescaling(case: &Case) -> Result<bool> {
    let status = |case: &Case| -> Result<Option<bool>> {
        let ready = case.build()?;
        let plan = Plan::new(&ready.problem, &Settings::new(case.harmonics))?;
        let facts = plan.facts();
        if !(facts.scalar || facts.linear || facts.samples == 0) {
            return Ok(None);
        }
        let solution = plan.solve(case.frequency, &mut plan.workspace());
        Ok(Some(solution.status.solved()))
    };
    let Some(one) = status(case)? else { return Ok(false) };
    // Metres to millimetres, newtons to kilonewtons.
    let other = status(&case.in_units(1e3, 1e-3))?;
    ensure!(other == Some(one), "{} ends otherwise in mm and kN", case.id);
    Ok(true)
}

/// A sweep around the case's frequency, with one thread and with two.
fn same_on_threads(case: &Case) -> Result<()> {
    let ready = case.build()?;
    let plan = Plan::new(&ready.problem, &Settings::new(case.harmonics.min(7).max(case_order(case))))?;
    let frequencies: Vec<f64> = (0..24).map(|i| case.frequency * (1.0 + 0.02 * f64::from(i))).collect();
    let run =
        |threads| sweep(&plan, &frequencies, &SweepOptions { threads: Some(threads), ..Default::default() });
    let (one, two) = (run(1), run(2));
    ensure!(
        format!("{:?}", one.solutions) == format!("{:?}", two.solutions),
        "{} depends on threads",
        case.id
    );
    Ok(())
}

fn case_order(case: &Case) -> usize {
    case.loads.iter().map(|load| load.harmonic).max().unwrap_or(1).max(1)
}
