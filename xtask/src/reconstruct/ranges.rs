//! How well the parameters are determined: the set of all that fulfil every statement.

use anyhow::Result;

use super::parameters::{Parameters, QUANTITIES};
use super::search::{at, descend, deviations};

/// Least and greatest value of each of [`QUANTITIES`] while every statement keeps its tolerance, as far as the search
/// reached; everything else adapts.
pub(crate) struct Ranges(pub(crate) Vec<(f64, f64)>);

/// Steepness of the wall around the admissible set.
const WALL: f64 = 100.0;
/// Edges of the simplices, each begun where the one before ended: one that met the wall is flat.
const EDGES: [f64; 5] = [0.01, 0.01, 0.005, 0.005, 0.002];
const ITERATIONS: u64 = 120;

/// Walks from `best` as far as possible in both directions of every quantity.
pub(crate) fn ranges(best: &Parameters) -> Result<Ranges> {
    let start = best.place();
    let mut ranges = Vec::new();
    for quantity in QUANTITIES {
        let value = |place: &[f64]| -> Result<f64> {
            let set = at(place);
            Ok(set.physical()?.map_or(f64::NAN, |physical| (quantity.value)(&set, &physical)))
        };
        let here = value(&start)?;
        let mut range = (here, here);
        for sign in [-1.0, 1.0] {
            let far = |place: &[f64]| -> Result<f64> {
                let outside = worst(place)?.map_or(1e3, |worst| (worst - 1.0).max(0.0));
                let value = value(place)?;
                Ok(if value > 0.0 { WALL * outside - sign * value.ln() } else { 1e6 })
            };
            let mut place = start.to_vec();
            for edge in EDGES {
                place = descend(&place, edge, ITERATIONS, far)?.1;
            }
            if worst(&place)?.is_some_and(|worst| worst <= 1.0 + 1e-3) {
                range = (range.0.min(value(&place)?), range.1.max(value(&place)?));
            }
        }
        ranges.push(range);
    }
    Ok(Ranges(ranges))
}

/// The largest deviation in its tolerance.
fn worst(place: &[f64]) -> Result<Option<f64>> {
    Ok(deviations(place)?.map(|all| all.iter().fold(0.0, |top, d| d.abs().max(top))))
}
