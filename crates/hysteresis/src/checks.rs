//! What is refused: samples that cannot be a loop, a cycle with holes, ends that do not meet.

use std::f64::consts::{PI, TAU};

use crate::cycles::Steady;
use crate::error::FitError;
use crate::loop_phase::{LoopPhases, PhasedSample, largest_gap};
use crate::record::{Quantity, Record};

/// Fewest samples that can make a cycle.
const FEWEST: usize = 8;
/// Largest step in loop phase \[rad\] without a sample.
const GAP: f64 = 0.6;

/// Refuses what cannot be a loop whatever its shape.
pub(crate) fn check_samples(record: &Record) -> Result<(), FitError> {
    let found = record.displacement.len();
    let lengths_agree =
        record.force.len() == found && record.time.as_ref().is_none_or(|time| time.len() == found);
    if !lengths_agree {
        return Err(FitError::Lengths { displacement: found, force: record.force.len() });
    }
    if found < FEWEST {
        return Err(FitError::TooFewSamples { found, needed: FEWEST });
    }
    let columns = [
        (Quantity::Time, record.time.as_deref().unwrap_or(&[])),
        (Quantity::Displacement, &record.displacement),
        (Quantity::Force, &record.force),
    ];
    for (quantity, values) in columns {
        if let Some(sample) = values.iter().position(|value| !value.is_finite()) {
            return Err(FitError::NotFinite { place: record.place(sample), quantity });
        }
    }
    for (quantity, values) in columns.into_iter().skip(1) {
        let value = values.first().copied().unwrap_or(0.0);
        if values.iter().all(|other| *other == value) {
            return Err(FitError::Constant { quantity, value });
        }
    }
    Ok(())
}

/// Refuses a cycle with parts that nobody measured, or whose ends do not meet.
pub(crate) fn check_coverage(
    phases: &LoopPhases,
    steady: &Steady,
    force_range: f64,
    closure_tolerance: f64,
) -> Result<(), FitError> {
    let branches = (phases.branches.0 + phases.branches.1).max(1);
    if phases.samples.len() * 2 / branches < FEWEST {
        return Err(FitError::TooFewSamples { found: phases.samples.len() * 2 / branches, needed: FEWEST });
    }
    let (start, gap) = largest_gap(phases.samples.iter().map(|s| s.theta).collect());
    if gap > GAP {
        let displacement = |theta: f64| 1e6 * (steady.middle() + steady.amplitude() * theta.cos());
        let direction = if (start + 0.5 * gap) % TAU < PI { "unloading" } else { "loading" };
        return Err(FitError::OpenCurve {
            reason: format!(
                "between {:.4} µm and {:.4} µm, while {direction}, there is no sample",
                displacement(start),
                displacement(start + gap)
            ),
        });
    }
    let by_time = |a: &&PhasedSample, b: &&PhasedSample| a.position.total_cmp(&b.position);
    let ends = (phases.samples.iter().min_by(by_time), phases.samples.iter().max_by(by_time));
    if let (true, (Some(first), Some(last))) = (phases.joined, ends) {
        let apart = (first.theta - last.theta).abs();
        let jump = (first.force - last.force).abs();
        if apart.min(TAU - apart) < GAP && jump > closure_tolerance * force_range {
            let reason = format!(
                "its ends differ by {jump:.4} N, {:.0} % of the force's range",
                100.0 * jump / force_range
            );
            return Err(FitError::OpenCurve { reason });
        }
    }
    Ok(())
}
