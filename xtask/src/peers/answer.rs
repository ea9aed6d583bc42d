//! What a script answers.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use num_complex::Complex64;
use serde::Deserialize;

/// Versions, and every case with its points.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Answer {
    pub(super) versions: BTreeMap<String, String>,
    pub(super) cases: Vec<Answered>,
}

/// One case, solved.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Answered {
    pub(super) harmonics: usize,
    pub(super) samples: Option<usize>,
    method: Option<String>,
    steps: Option<usize>,
    accuracy: Option<f64>,
    /// A point.
    pub(super) seconds: f64,
    pub(super) points: Vec<Point>,
}

/// Spectra at one frequency.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Point {
    /// In Hz.
    pub(super) frequency: f64,
    pub(super) solved: bool,
    /// One-sided amplitudes `[k, re, im]` of every dof; empty where it is not solved.
    displacement: Vec<Vec<(usize, f64, f64)>>,
}

impl Answer {
    /// Reads an answer; points that count as solved must have finite spectra of all dofs.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let answer: Self = serde_json::from_str(text)?;
        for (number, case) in answer.cases.iter().enumerate() {
            for point in &case.points {
                let finite = |dof: &Vec<(usize, f64, f64)>| {
                    !dof.is_empty() && dof.iter().all(|(_, re, im)| re.is_finite() && im.is_finite())
                };
                let whole = !point.displacement.is_empty() && point.displacement.iter().all(finite);
                ensure!(whole == point.solved, "case {number}: spectra at {} Hz", point.frequency);
            }
        }
        Ok(answer)
    }
}

impl Answered {
    pub(super) fn unsolved(&self) -> usize {
        self.points.iter().filter(|point| !point.solved).count()
    }

    /// For tables.
    pub(super) fn name(&self) -> String {
        match (self.method.as_deref(), self.steps, self.accuracy) {
            (Some(method), Some(steps), _) => format!("`{method}`, {steps} steps a period"),
            (Some(method), _, Some(accuracy)) => format!("`{method}`, `rtol` {accuracy:.0e}"),
            _ => format!("N = {}", self.harmonics),
        }
    }
}

impl Point {
    /// `W_0 … W_highest` of every dof; harmonics that are not listed are zero.
    pub(super) fn spectra(&self) -> Vec<Vec<Complex64>> {
        let dense = |dof: &Vec<(usize, f64, f64)>| {
            let highest = dof.iter().map(|(k, ..)| *k).max().unwrap_or(0);
            let mut spectrum = vec![Complex64::ZERO; highest + 1];
            for &(k, re, im) in dof {
                spectrum[k] += Complex64::new(re, im);
            }
            spectrum
        };
        self.displacement.iter().map(dense).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read_and_unfinished_ones_refused() {
        let answer = |displacement: &str| {
            Answer::parse(&format!(
                r#"{{"versions": {{"numpy": "2"}}, "cases": [{{"harmonics": 3, "samples": 256, "seconds": 0.01, "extra": 1,
                   "points": [{{"frequency": 20.0, "solved": true, "displacement": {displacement}}}]}}]}}"#
            ))
        };
        let read = answer("[[[1, 1.0, -2.0], [3, 0.5, 0.0]]]").unwrap();
        let zero = Complex64::ZERO;
        let expected = [zero, Complex64::new(1.0, -2.0), zero, Complex64::new(0.5, 0.0)];
        assert_eq!(read.cases[0].points[0].spectra(), [expected]);
        assert_eq!((read.cases[0].unsolved(), read.cases[0].samples), (0, Some(256)));
        for bad in ["[]", "[[]]", "[[[1, 1e999, 0.0]]]", "[[[1, NaN, 0.0]]]", "[[[-1, 0.0, 0.0]]]"] {
            assert!(answer(bad).is_err(), "{bad}");
        }
    }
}
