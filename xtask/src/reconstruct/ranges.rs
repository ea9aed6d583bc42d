//! How well the parameters are determined: the set of all that fulfil every statement.

use anyhow::Result;
use rayon::prelude::*;

use super::parameters::{Parameters, QUANTITIES, Quantity};
use super::search::{at, descend_on, deviations};

/// Least and greatest value of each of [`QUANTITIES`] while every statement keeps its tolerance, as far as the search
/// reached; everything else adapts.
pub(crate) struct Ranges(pub(crate) Vec<(f64, f64)>);

/// Steepness of the wall around the admissible set.
const WALL: f64 = 100.0;
/// Edges of the simplices, each begun where the one before ended: one that met the wall is flat.
const EDGES: [f64; 8] = [0.03, 0.03, 0.02, 0.01, 0.01, 0.005, 0.005, 0.002];
const ITERATIONS: u64 = 120;

/// Walks from `best` as far as possible in both directions of every quantity.
pub(crate) fn ranges(best: &Parameters) -> Result<Ranges> {
    let start = best.place();
    let ends = |quantity: &Quantity| Ok((far(quantity, &start, -1.0)?, far(quantity, &start, 1.0)?));
    Ok(Ranges(QUANTITIES.par_iter().map(ends).collect::<Result<_>>()?))
}

/// The value of `quantity` at the end of the walk that raises (`sign` = 1) or lowers (−1) it.
fn far(quantity: &Quantity, start: &[f64], sign: f64) -> Result<f64> {
    let value = |place: &[f64]| -> Result<f64> {
        let set = at(place);
        Ok(set.physical()?.map_or(f64::NAN, |physical| (quantity.value)(&set, &physical)))
    };
    let cost = |place: &[f64]| -> Result<f64> {
        let outside = worst(place)?.map_or(1e3, |worst| (worst - 1.0).max(0.0));
        let value = value(place)?;
        Ok(if value > 0.0 { WALL * outside - sign * value.ln() } else { 1e6 })
    };
    let (_, end) = descend_on(start, &EDGES, ITERATIONS, cost)?;
    // A walk that ended outside does not count.
    let inside = worst(&end)?.is_some_and(|worst| worst <= 1.0 + 1e-3);
    value(if inside { &end } else { start })
}

/// The largest deviation in its tolerance.
fn worst(place: &[f64]) -> Result<Option<f64>> {
    Ok(deviations(place)?.map(|all| all.iter().fold(0.0, |top, d| d.abs().max(top))))
}
