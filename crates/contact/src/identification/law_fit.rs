//! The fit of one law: its numbers, their errors, what is doubtful about them.

use std::fmt;

use super::Weighting;
use super::covariance::inverse_normal;
use super::note::{Law, Note};
use super::separable::{Family, Observation, Optimum, Place, Problem};
use super::student::{NORMAL, t95};

/// One of the six numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Of g, eq. (6).
    Offset,
    /// Of g, eq. (6).
    Slope,
    /// Of g, eq. (6); positive.
    Shift,
    /// Of ψ_C, eq. (7) \[rad\].
    Limit,
    /// Of ψ_C, eq. (7) \[rad\].
    Span,
    /// Of ψ_C, eq. (7); positive.
    Decay,
}

impl Parameter {
    /// Its name in a scene, within its law.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Offset => "offset",
            Self::Slope => "slope",
            Self::Shift => "shift",
            Self::Limit => "limit",
            Self::Span => "span",
            Self::Decay => "decay",
        }
    }

    /// Whether it must be positive.
    fn is_positive(self) -> bool {
        matches!(self, Self::Shift | Self::Decay)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One number and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
    /// Its standard error, where the loops determine one.
    pub std_error: Option<f64>,
    /// Its 95 % interval, value ± t · std_error; it does not know of constraints.
    pub interval: Option<(f64, f64)>,
}

/// One identified law.
#[derive(Debug, Clone, PartialEq)]
pub struct LawFit<L> {
    /// The law.
    pub law: L,
    /// Its three numbers, in the order in which the law is written.
    pub estimates: [Estimate; 3],
    /// Covariance of the three, at the optimum linearised: s² (Jᵀ J)⁻¹, or (Jᵀ W J)⁻¹ with
    /// [`Weighting::Noise`].
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Root mean square of the residuals \[-, rad\].
    pub residual_rms: f64,
    /// Root mean square of the residuals, each over its own noise, with n − 3 in the denominator: 1 is expected
    /// if the law is true. None for three loops, or loops of unknown noise.
    pub misfit: Option<f64>,
    /// Degrees of freedom n − 3.
    pub freedom: usize,
}

/// Residuals that are this many times the noise are not noise.
const MISFIT: f64 = 3.0;

/// Fits a law to observations in ascending order, of which there are at least three.
pub(super) fn fit<L>(
    family: &Family<L>,
    observations: &[Observation],
    weighting: Weighting,
) -> (LawFit<L>, Vec<Note>) {
    let weight = |seen: &Observation| match weighting {
        Weighting::Equal => 1.0,
        Weighting::Noise => seen.noise.map_or(0.0, |noise| noise.powi(-2)),
    };
    let weights: Vec<f64> = observations.iter().map(weight).collect();
    let problem = Problem { family, observations, weights: &weights };
    let optimum = problem.optimum();
    let numbers = [optimum.line.constant, optimum.line.factor, optimum.p];
    let freedom = observations.len().saturating_sub(3);

    // Variance of an observation of weight 1, and the half width of a 95 % interval in standard errors.
    let scale = match weighting {
        Weighting::Equal => (freedom > 0).then(|| (optimum.line.sum / freedom as f64, t95(freedom))),
        Weighting::Noise => Some((1.0, NORMAL)),
    };
    let rows = observations.iter().zip(&weights).map(|(seen, weight)| {
        problem.jacobian(seen.alpha, numbers).map(|derivative| weight.sqrt() * derivative)
    });
    let inverse = inverse_normal(&rows.collect::<Vec<_>>()).filter(|_| optimum.place == Place::Inside);
    let covariance = inverse
        .zip(scale)
        .map(|(inverse, (variance, _))| inverse.map(|line| line.map(|entry| variance * entry)));
    let errors: [Option<f64>; 3] = match covariance {
        Some([[offset, ..], [_, slope, _], [.., p]]) => [offset, slope, p].map(|square| Some(square.sqrt())),
        None => [None; 3],
    };
    let estimate = |((parameter, value), std_error): ((Parameter, f64), Option<f64>)| {
        let half = std_error.zip(scale).map(|(error, (_, t))| t * error);
        let interval = half.map(|half| (value - half, value + half));
        Estimate { parameter, value, std_error, interval }
    };
    let [a, b, c] = family.parameters;
    let ([u, v, w], [e, f, g]) = (numbers, errors);
    let estimates = [((a, u), e), ((b, v), f), ((c, w), g)].map(estimate);

    let residual =
        |seen: &Observation| seen.value - numbers[0] - numbers[1] * (family.basis)(seen.alpha, numbers[2]).0;
    let n = observations.len() as f64;
    let residual_rms = (observations.iter().map(|seen| residual(seen).powi(2)).sum::<f64>() / n).sqrt();
    let over_noise: Option<f64> =
        observations.iter().map(|seen| seen.noise.map(|noise| (residual(seen) / noise).powi(2))).sum();
    let misfit = over_noise.filter(|_| freedom > 0).map(|sum| (sum / freedom as f64).sqrt());

    let law_name = if family.parameters[0] == Parameter::Offset { Law::Magnitude } else { Law::Phase };
    let mut notes = search_notes(&optimum, c, scale);
    if inverse.is_none() && optimum.place == Place::Inside {
        notes.push(Note::Undetermined { law: law_name });
    }
    notes.extend(estimates.iter().filter_map(doubt));
    if let Some(ratio) = misfit.filter(|ratio| *ratio > MISFIT) {
        notes.push(Note::Misfit { law: law_name, ratio });
    }
    let law = (family.law)(numbers);
    (LawFit { law, estimates, covariance, residual_rms, misfit, freedom }, notes)
}

/// What the search along p says about it.
fn search_notes(optimum: &Optimum, parameter: Parameter, scale: Option<(f64, f64)>) -> Vec<Note> {
    let value = optimum.p;
    match optimum.place {
        Place::End { lower } => return vec![Note::AtBound { parameter, value, lower }],
        Place::Flat => return vec![Note::Unbounded { parameter, below: true, above: true }],
        Place::Inside => {}
    }
    let mut notes = Vec::new();
    // Likelihood ratio: the p with S(p) ≤ S + t² s² are not refuted at 95 %.
    let margin = scale.map_or(0.0, |(variance, t)| t * t * variance);
    let limit = (optimum.line.sum + margin).max(optimum.rounding);
    let (below, above) = (optimum.ends.0 <= limit, optimum.ends.1 <= limit);
    if below || above {
        notes.push(Note::Unbounded { parameter, below, above });
    }
    let rivals = optimum.others.iter().filter(|(_, sum)| *sum <= limit);
    if let Some(&(other, _)) = rivals.min_by(|(_, a), (_, b)| a.total_cmp(b)) {
        notes.push(Note::SeveralMinima { parameter, value, other });
    }
    notes
}

fn doubt(estimate: &Estimate) -> Option<Note> {
    let Estimate { parameter, value, .. } = *estimate;
    let std_error = estimate.std_error?;
    if std_error > value.abs() {
        return Some(Note::Uncertain { parameter, value, std_error });
    }
    let (lower, _) = estimate.interval.filter(|(lower, _)| parameter.is_positive() && *lower <= 0.0)?;
    Some(Note::IncludesBound { parameter, lower })
}
