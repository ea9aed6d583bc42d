//! The search: Nelder and Mead's simplex in the logarithms of the parameters, from many seeded places.
//!
//! A derivative would not help: peaks appear and vanish, and where one is missing there is no deviation to speak of.

use anyhow::{Context, Error, Result};
use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::parameters::{COUNT, Parameters};
use crate::paper::reading::Reading;
use crate::paper::statements::STATEMENTS;

/// What the search found.
pub(crate) struct Search {
    pub(crate) best: Parameters,
    /// Sum of squared deviations in their tolerances, ascending, one a start.
    pub(crate) costs: Vec<f64>,
    /// End of each start, in the same order.
    pub(crate) ends: Vec<Parameters>,
}

/// Where the starts lie: from, to.
const BOX: [(f64, f64); COUNT] = [
    (30.0, 120.0), // √(c1/m1) / 2π in Hz
    (0.1, 3.0),    // m2/m1
    (1.0, 30.0),   // d/m1 in 1/s
    (0.5, 20.0),   // F*/(c1 W*)
    (0.1, 5.0),    // f̂/F*
    (0.05, 1.0),   // x_c/W*
];

const SEED: u64 = 2017;
/// Places looked at, and how many of the best become starts.
pub(crate) const PLACES: usize = 1000;
const STARTS: usize = 12;
/// More starts beyond m2/m1 = 1/2, which divides the two mass ratios that 43 Hz and 108 Hz allow.
const OTHER_STARTS: usize = 4;
const SPLIT: f64 = 0.5;
/// Edges of the simplices of one start: a simplex that has collapsed goes no further, a fresh one may.
const EDGES: [f64; 6] = [0.2, 0.1, 0.1, 0.05, 0.02, 0.02];
const ITERATIONS: u64 = 150;
/// Cost of a response without the features that the paper describes.
pub(crate) const SHAPELESS: f64 = 1e6;

/// Searches from the best of many random places.
pub(crate) fn search() -> Result<Search> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut place = || BOX.map(|(low, high)| f64::ln(low) + rng.random::<f64>() * f64::ln(high / low));
    let places: Vec<_> = (0..PLACES).map(|_| place()).collect();
    let look = |place: &[f64; COUNT]| Ok((cost(place)?, place.to_vec()));
    let mut places = places.par_iter().map(look).collect::<Result<Vec<_>>>()?;
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let heavy = |(_, place): &&(f64, Vec<f64>)| place.get(1).is_some_and(|ratio| ratio.exp() > SPLIT);
    let other: Vec<_> = places.iter().filter(heavy).take(OTHER_STARTS).cloned().collect();
    places.truncate(STARTS);
    places.extend(other);
    let go = |(_, start): &(f64, Vec<f64>)| descend_on(start, &EDGES, ITERATIONS, cost);
    let mut ends = places.par_iter().map(go).collect::<Result<Vec<_>>>()?;
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sets: Vec<Parameters> = ends.iter().map(|(_, place)| at(place)).collect();
    let best = *sets.first().context("no start")?;
    Ok(Search { best, costs: ends.iter().map(|(cost, _)| *cost).collect(), ends: sets })
}

/// One simplex after the other, each with its edges from where the one before ended.
pub(crate) fn descend_on(
    start: &[f64],
    edges: &[f64],
    iterations: u64,
    cost: impl Fn(&[f64]) -> Result<f64> + Copy,
) -> Result<(f64, Vec<f64>)> {
    let mut end = (f64::INFINITY, start.to_vec());
    for edge in edges {
        end = descend(&end.1, *edge, iterations, cost)?;
    }
    Ok(end)
}

/// The simplex with edges of `size` from `start`; cost and place of its best corner.
fn descend(
    start: &[f64],
    size: f64,
    iterations: u64,
    cost: impl Fn(&[f64]) -> Result<f64>,
) -> Result<(f64, Vec<f64>)> {
    let corner = |i: usize| {
        let mut corner = start.to_vec();
        if let Some(entry) = i.checked_sub(1).and_then(|i| corner.get_mut(i)) {
            *entry += size;
        }
        corner
    };
    let solver = NelderMead::new((0..=start.len()).map(corner).collect()).with_sd_tolerance(1e-9)?;
    let run = Executor::new(Function(cost), solver).configure(|state| state.max_iters(iterations)).run()?;
    let place = run.state.get_best_param().context("Nelder and Mead's simplex is empty")?;
    Ok((run.state.get_best_cost(), place.clone()))
}

/// A function of several variables for argmin.
struct Function<F>(F);

impl<F: Fn(&[f64]) -> Result<f64>> CostFunction for Function<F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        (self.0)(x)
    }
}

/// The set at a place of the search.
pub(crate) fn at(place: &[f64]) -> Parameters {
    let mut values = [0.0; COUNT];
    values.iter_mut().zip(place).for_each(|(value, logarithm)| *value = logarithm.exp());
    Parameters::from_values(values)
}

/// Deviations of all statements in their tolerances; `None` when the response lacks what they are about.
pub(crate) fn deviations(place: &[f64]) -> Result<Option<Vec<f64>>> {
    let Some(physical) = at(place).physical()? else { return Ok(None) };
    let reading = Reading::of(&physical.hysteresis()?, &physical.coulomb()?)?;
    Ok(reading.map(|r| STATEMENTS.iter().map(|s| s.deviation(&r) / s.tolerance).collect()))
}

fn cost(place: &[f64]) -> Result<f64> {
    let deviations = deviations(place)?;
    let squares = deviations.map(|all| all.iter().map(|d| d * d).sum());
    Ok(squares.filter(|sum: &f64| sum.is_finite()).unwrap_or(SHAPELESS))
}
