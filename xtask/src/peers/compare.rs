//! Differences between answers, and errors against the truth.

use anyhow::Result;
use hbm::{Plan, Settings, Solution};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use study::Truth;
use study::work_precision::Patience;

use super::answer::Answered;
use super::request::Scene;

/// `W_0 … W_N` of every dof at one frequency; `None` where it is not solved.
pub(super) type Spectra = Option<Vec<Vec<Complex64>>>;

/// Middle and largest of the points' values; points that one side did not solve do not count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) worst: f64,
}

/// What stickslip finds.
pub(super) struct Own {
    pub(super) points: Vec<Spectra>,
    /// A point.
    pub(super) seconds: f64,
}

impl Own {
    /// All points on one thread: as the solver does it unasked, or with forces at `samples` like the peers.
    pub(super) fn solve(
        scene: &Scene,
        harmonics: usize,
        samples: Option<usize>,
        patience: &Patience,
    ) -> Result<Self> {
        let settings = Settings { samples, slaving: samples.is_none(), ..Settings::new(harmonics) };
        let plan = Plan::new(scene.scene.problem()?, &settings)?;
        let mut workspace = plan.workspace();
        let mut solutions = vec![Solution::default(); scene.frequencies.len()];
        let timed = patience.time(|| {
            for (hertz, solution) in scene.frequencies.iter().zip(&mut solutions) {
                plan.solve_into(*hertz, &mut workspace, solution);
            }
        });
        let dense = |amplitudes: &Vec<Complex64>| {
            let mut spectrum = vec![Complex64::ZERO; harmonics + 1];
            for (order, amplitude) in plan.orders().iter().zip(amplitudes) {
                if let Some(entry) = spectrum.get_mut(*order) {
                    *entry = *amplitude;
                }
            }
            spectrum
        };
        let spectra = |solution: &Solution| {
            solution.status.solved().then(|| solution.displacement.iter().map(dense).collect())
        };
        let points: Vec<Spectra> = solutions.iter().map(spectra).collect();
        Ok(Self { seconds: timed.seconds / points.len().max(1) as f64, points })
    }

    pub(super) fn unsolved(&self) -> usize {
        self.points.iter().filter(|point| point.is_none()).count()
    }
}

/// `‖a − b‖ / ‖b‖` over all dofs and harmonics, at the points that both solved.
pub(super) fn difference(answer: &Answered, own: &[Spectra]) -> Option<Spread> {
    let pairs = answer.points.iter().zip(own).filter(|(point, _)| point.solved);
    spread(pairs.filter_map(|(point, own)| Some(distance(&point.spectra(), own.as_ref()?))).collect())
}

fn distance(a: &[Vec<Complex64>], b: &[Vec<Complex64>]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let at = |spectrum: &[Complex64], k: usize| spectrum.get(k).copied().unwrap_or_default();
    let (mut square, mut size) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        for k in 0..a.len().max(b.len()) {
            square += (at(a, k) - at(b, k)).norm_sqr();
            size += at(b, k).norm_sqr();
        }
    }
    (square / size).sqrt()
}

/// Errors of an answer: the worst dof's relative l2 error of the displacement spectrum, where a truth is known.
pub(super) fn errors(answer: &Answered, truths: &[Option<Truth>]) -> Option<Spread> {
    let points: Vec<Spectra> = answer.points.iter().map(|p| p.solved.then(|| p.spectra())).collect();
    errors_of(&points, truths)
}

/// The same for spectra.
pub(super) fn errors_of(points: &[Spectra], truths: &[Option<Truth>]) -> Option<Spread> {
    let error = |(spectra, truth): (&Spectra, &Option<Truth>)| {
        let (spectra, truth) = (spectra.as_ref()?, truth.as_ref()?);
        let longest = spectra.iter().map(Vec::len).max().unwrap_or(0);
        let orders: Vec<usize> = (0..longest).collect();
        let rows: Vec<&[Complex64]> = spectra.iter().map(Vec::as_slice).collect();
        Some(truth.spectrum_error(&orders, &rows))
    };
    spread(points.iter().zip(truths).filter_map(error).collect())
}

fn spread(mut values: Vec<f64>) -> Option<Spread> {
    values.sort_by(f64::total_cmp);
    Some(Spread { median: *values.get(values.len() / 2)?, worst: *values.last()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::answer::Answer;

    const ONE: Complex64 = Complex64::ONE;

    fn answered() -> Answered {
        let text = r#"{"versions": {}, "cases": [{"harmonics": 1, "seconds": 1.0, "points": [
            {"frequency": 1.0, "solved": true, "displacement": [[[1, 1.0, 0.0]], [[1, 0.0, 1.0]]]},
            {"frequency": 2.0, "solved": false, "displacement": []},
            {"frequency": 3.0, "solved": true, "displacement": [[[1, 3.0, 0.0]], [[1, 0.0, 4.0]]]}]}]}"#;
        Answer::parse(text).unwrap().cases.remove(0)
    }

    #[test]
    fn differences_are_relative_and_over_all_dofs() {
        let zero = Complex64::ZERO;
        let same = vec![vec![zero, ONE], vec![zero, Complex64::I]];
        let other = vec![vec![zero, 3.0 * ONE, zero, 5.0 * ONE], vec![zero, zero]];
        // √(25 + 16)/√(9 + 25).
        let own = [Some(same.clone()), Some(same), Some(other)];
        let spread = difference(&answered(), &own).unwrap();
        assert!((spread.worst - (41.0_f64 / 34.0).sqrt()).abs() < 1e-15, "{spread:?}");
        assert_eq!(difference(&answered(), &[None, None, None]), None);
    }

    #[test]
    fn another_number_of_dofs_is_no_agreement() {
        assert_eq!(distance(&[vec![ONE]], &[vec![ONE], vec![ONE]]), f64::INFINITY);
    }
}
