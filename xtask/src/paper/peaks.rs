//! Peaks and crossings of a curve, refined by Brent's methods, never read off a grid.

use std::cell::RefCell;

use anyhow::{Context, Error, Result};
use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::{BrentOpt, BrentRoot};

/// A local maximum of an amplitude over frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    /// In Hz.
    pub(crate) frequency: f64,
    /// In m.
    pub(crate) amplitude: f64,
}

/// Position of a peak or crossing in Hz. An amplitude at a peak is exact to the square of it.
const RESOLUTION: f64 = 1e-6;

/// A function of one variable for argmin, with a sign.
struct Curve<F>(RefCell<F>, f64);

impl<F: FnMut(f64) -> f64> CostFunction for Curve<F> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, x: &f64) -> Result<f64, Error> {
        let Ok(mut curve) = self.0.try_borrow_mut() else { return Ok(f64::NAN) };
        Ok(self.1 * curve(*x))
    }
}

/// The highest local maximum of `curve` inside `from..to`, bracketed in steps of about `step`; `None` when the curve
/// has none there.
pub(crate) fn peak(
    (from, to): (f64, f64),
    step: f64,
    mut curve: impl FnMut(f64) -> f64,
) -> Result<Option<Peak>> {
    let places = grid(from, to, step);
    let values: Vec<f64> = places.iter().map(|&x| curve(x)).collect();
    let inner = |i: &usize| values[*i] >= values[i - 1] && values[*i] > values[i + 1];
    let top =
        (1..values.len().saturating_sub(1)).filter(inner).max_by(|a, b| values[*a].total_cmp(&values[*b]));
    let Some(i) = top else { return Ok(None) };
    let solver = BrentOpt::new(places[i - 1], places[i + 1]).set_tolerance(f64::EPSILON.sqrt(), RESOLUTION);
    let run =
        Executor::new(Curve(RefCell::new(&mut curve), -1.0), solver).run().context("Brent's minimiser")?;
    let frequency = run.state.best_param.context("Brent's minimiser found nothing")?;
    Ok(Some(Peak { frequency, amplitude: curve(frequency) }))
}

/// First and last place in `from..to` where `curve` changes its sign, bracketed in steps of about `step`.
pub(crate) fn crossings(
    (from, to): (f64, f64),
    step: f64,
    mut curve: impl FnMut(f64) -> f64,
) -> Result<Option<(f64, f64)>> {
    let places = grid(from, to, step);
    let values: Vec<f64> = places.iter().map(|&x| curve(x)).collect();
    let changes = |i: &usize| values[*i] * values[i + 1] <= 0.0;
    let (Some(first), Some(last)) =
        ((0..values.len() - 1).find(changes), (0..values.len() - 1).rev().find(changes))
    else {
        return Ok(None);
    };
    let mut refine = |i: usize| -> Result<f64> {
        let solver = BrentRoot::new(places[i], places[i + 1], RESOLUTION);
        let run =
            Executor::new(Curve(RefCell::new(&mut curve), 1.0), solver).run().context("Brent's root")?;
        run.state.best_param.context("Brent's root found nothing")
    };
    Ok(Some((refine(first)?, refine(last)?)))
}

/// Both ends and equal steps between.
pub(crate) fn grid(from: f64, to: f64, step: f64) -> Vec<f64> {
    let steps = ((to - from) / step).ceil().max(2.0);
    (0..=steps as usize).map(|i| from + (to - from) * i as f64 / steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_found_between_grid_points() {
        let curve = |x: f64| 1.0 / (1.0 + (x - 3.217_3).powi(2)) + 0.1 / (1.0 + 9.0 * (x - 8.0).powi(2));
        let peak = peak((0.0, 10.0), 0.5, curve).unwrap().unwrap();
        assert!((peak.frequency - 3.217_3).abs() < 1e-3 && (peak.amplitude - curve(3.217_3)).abs() < 1e-6);
        assert_eq!(super::peak((4.0, 6.0), 0.5, curve).unwrap(), None);
    }

    #[test]
    fn crossings_are_first_and_last() {
        let (first, last) = crossings((0.1, 10.0), 0.3, f64::sin).unwrap().unwrap();
        assert!(
            (first - std::f64::consts::PI).abs() < 1e-6 && (last - 3.0 * std::f64::consts::PI).abs() < 1e-6
        );
        assert_eq!(crossings((0.1, 3.0), 0.3, f64::sin).unwrap(), None);
    }
}
