//! What Fig. 4 shows, read off a scene with the paper's law and one with elastic Coulomb friction. One harmonic.

use std::sync::Arc;

use anyhow::{Result, ensure};
use contact::{Linear, LinearParameters};
use hbm::{Plan, Problem, Settings, Workspace};

use super::peaks::{Peak, crossings, grid, peak};

/// Rows of the output: m1, the blade root, and m2, the blade.
pub(crate) const ROOT: usize = 0;
pub(crate) const BLADE: usize = 1;

/// Frequency that stands for the static response, in Hz; a balance of one harmonic has none at zero.
pub(crate) const QUASI_STATIC: f64 = 1e-3;

/// Everything that the paper puts into numbers. Peaks are those of m2.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    pub(crate) linear_first: Peak,
    pub(crate) linear_second: Peak,
    pub(crate) first: Peak,
    pub(crate) second: Peak,
    /// |W_1| of m2 in m at rest, hysteresis model and elastic Coulomb.
    pub(crate) static_amplitudes: (f64, f64),
    /// Where |w1| of the sticking system passes x_c, in Hz: lowest and highest.
    pub(crate) slip: (f64, f64),
}

/// One harmonic of a problem, ready to be asked at any frequency.
pub(crate) struct Response {
    plan: Plan,
    workspace: Workspace,
}

impl Response {
    pub(crate) fn new(problem: &Problem) -> Result<Self> {
        let plan = Plan::new(problem, &Settings::new(1))?;
        let workspace = plan.workspace();
        Ok(Self { plan, workspace })
    }

    /// |W_1| of an output in m; not a number where there is no solution.
    pub(crate) fn amplitude(&mut self, hertz: f64, output: usize) -> f64 {
        let solution = self.plan.solve(hertz, &mut self.workspace);
        solution.displacement.get(output).and_then(|row| row.first()).map_or(f64::NAN, |w| w.norm())
    }

    /// Likewise without contact forces.
    pub(crate) fn linear_amplitude(&mut self, hertz: f64, output: usize) -> f64 {
        let rows = self.plan.linear_response(hertz, &mut self.workspace).unwrap_or_default();
        rows.get(output).and_then(|row| row.first()).map_or(f64::NAN, |w| w.norm())
    }
}

impl Reading {
    /// `hysteresis` and `coulomb` differ in the law of their one contact only. `None` when the response lacks one of
    /// the features that the paper describes.
    pub(crate) fn of(hysteresis: &Problem, coulomb: &Problem) -> Result<Option<Self>> {
        let natural = hysteresis.model.natural_frequencies();
        let [low, high] = natural.as_slice() else { return Ok(None) };
        let mut response = Response::new(hysteresis)?;
        let near = |f: f64| (0.9 * f, 1.1 * f);
        let between = (1.02 * low, 0.9 * high);
        let Some(linear_first) = peak(near(*low), 0.02 * low, |f| response.linear_amplitude(f, BLADE))?
        else {
            return Ok(None);
        };
        let Some(linear_second) = peak(near(*high), 0.02 * high, |f| response.linear_amplitude(f, BLADE))?
        else {
            return Ok(None);
        };
        let Some(first) = peak(between, 2.5, |f| response.amplitude(f, BLADE))? else { return Ok(None) };
        let Some(second) = peak(near(*high), 0.01 * high, |f| response.amplitude(f, BLADE))? else {
            return Ok(None);
        };
        let at_rest = response.amplitude(QUASI_STATIC, BLADE);
        let Some(slip) = slip_range(coulomb)? else { return Ok(None) };
        let static_amplitudes = (at_rest, Response::new(coulomb)?.amplitude(QUASI_STATIC, BLADE));
        Ok(Some(Self { linear_first, linear_second, first, second, static_amplitudes, slip }))
    }
}

/// Where |w1| of the sticking system passes x_c.
fn slip_range(coulomb: &Problem) -> Result<Option<(f64, f64)>> {
    let [contact] = coulomb.contacts.as_slice() else { return Ok(None) };
    let Some(limit) = contact.law.length() else { return Ok(None) };
    let stiffness = contact.law.secant_stiffness(0.5 * limit);
    let mut sticking = coulomb.clone();
    for contact in &mut sticking.contacts {
        contact.law = Arc::new(Linear::new(LinearParameters { stiffness })?);
    }
    let mut response = Response::new(&sticking)?;
    crossings((20.0, 200.0), 2.0, |f| (response.amplitude(f, ROOT) / limit).ln())
}

/// How two models agree over a range of frequencies: |a/b − 1| of |W_1|.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Agreement {
    pub(crate) median: f64,
    pub(crate) largest: f64,
    /// Where it is largest, in Hz.
    pub(crate) at: f64,
}

impl Agreement {
    /// Of `output` between two frequencies in Hz, in steps of `step`.
    pub(crate) fn of(
        hysteresis: &Problem,
        coulomb: &Problem,
        output: usize,
        (from, to): (f64, f64),
        step: f64,
    ) -> Result<Self> {
        let (mut one, mut other) = (Response::new(hysteresis)?, Response::new(coulomb)?);
        let difference = |f: f64| ((one.amplitude(f, output) / other.amplitude(f, output) - 1.0).abs(), f);
        let mut differences: Vec<(f64, f64)> = grid(from, to, step).into_iter().map(difference).collect();
        ensure!(
            differences.iter().all(|(d, _)| d.is_finite()),
            "a point between {from} Hz and {to} Hz was not solved"
        );
        differences.sort_by(|a, b| a.0.total_cmp(&b.0));
        let median = differences[differences.len() / 2].0;
        let (largest, at) = differences[differences.len() - 1];
        Ok(Self { median, largest, at })
    }
}
