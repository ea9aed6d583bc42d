//! The fit of one law: its numbers, their errors, what is doubtful about them.

use std::fmt;

use super::Weighting;
use super::covariance::inverse_normal;
use super::note::Note;
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
    /// Covariance of the three, linearised at the optimum: s² (Jᵀ W J)⁻¹ with the variance s² = S/(n − 3) of the
    /// residuals; with [`Weighting::Noise`] s² is at least 1.
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

/// Passes after which weights that depend on the law have settled.
const PASSES: usize = 4;

/// What a standard error is made of.
#[derive(Debug, Clone, Copy)]
struct Scale {
    /// Variance of an observation of weight 1.
    variance: f64,
    /// Half width of a 95 % interval in standard errors.
    quantile: f64,
}

/// Fits a law to observations in ascending order, of which there are at least three.
pub(super) fn fit<L>(
    family: &Family<L>,
    observations: &[Observation],
    weighting: Weighting,
) -> (LawFit<L>, Vec<Note>) {
    let (optimum, weights) = optimum(family, observations, weighting);
    let numbers = [optimum.line.constant, optimum.line.factor, optimum.p];
    let freedom = observations.len().saturating_sub(3);
    let scatter = (freedom > 0).then(|| optimum.line.sum / freedom as f64);
    let scale = match weighting {
        Weighting::Equal => scatter.map(|variance| Scale { variance, quantile: t95(freedom) }),
        Weighting::Noise => Some(match scatter.filter(|variance| *variance > 1.0) {
            Some(variance) => Scale { variance, quantile: t95(freedom) },
            None => Scale { variance: 1.0, quantile: NORMAL },
        }),
    };
    let rows = observations
        .iter()
        .zip(&weights)
        .map(|(seen, weight)| family.jacobian(seen.alpha, numbers).map(|slope| weight.sqrt() * slope));
    let inverse = inverse_normal(&rows.collect::<Vec<_>>()).filter(|_| optimum.place == Place::Inside);
    let covariance =
        inverse.zip(scale).map(|(inverse, scale)| inverse.map(|line| line.map(|c| scale.variance * c)));
    let estimates = estimates(family.parameters, numbers, covariance, scale);

    let residual = |seen: &Observation| seen.value - family.value(seen.alpha, numbers);
    let squares: f64 = observations.iter().map(|seen| residual(seen).powi(2)).sum();
    let over_noise: Option<f64> = (observations.iter())
        .map(|seen| family.noise(seen, numbers).map(|noise| (residual(seen) / noise).powi(2)))
        .sum();
    let misfit = over_noise.filter(|_| freedom > 0).map(|sum| (sum / freedom as f64).sqrt());

    let mut notes = search_notes(&optimum, family.parameters, scale);
    if inverse.is_none() && optimum.place == Place::Inside {
        notes.push(Note::Undetermined { law: family.which });
    }
    notes.extend(estimates.iter().filter_map(doubt));
    if let Some(ratio) = misfit.filter(|ratio| *ratio > MISFIT) {
        notes.push(Note::Misfit { law: family.which, ratio });
    }
    let residual_rms = (squares / observations.len() as f64).sqrt();
    let law = (family.law)(numbers);
    (LawFit { law, estimates, covariance, residual_rms, misfit, freedom }, notes)
}

/// The optimum and the weights that belong to it.
fn optimum<L>(family: &Family<L>, observations: &[Observation], weighting: Weighting) -> (Optimum, Vec<f64>) {
    let equal = vec![1.0; observations.len()];
    let search = |weights: &[f64]| Problem { family, observations, weights }.optimum();
    if weighting == Weighting::Equal {
        return (search(&equal), equal);
    }
    // The noise of α counts by the slope of the law, which is known once there is one.
    let mut numbers = [0.0; 3];
    let mut pass = || {
        let weight = |seen| family.noise(seen, numbers).map_or(0.0, |noise| noise.powi(-2));
        let weights: Vec<f64> = observations.iter().map(weight).collect();
        let found = search(&weights);
        numbers = [found.line.constant, found.line.factor, found.p];
        (found, weights)
    };
    for _ in 1..PASSES {
        pass();
    }
    pass()
}

fn estimates(
    parameters: [Parameter; 3],
    numbers: [f64; 3],
    covariance: Option<[[f64; 3]; 3]>,
    scale: Option<Scale>,
) -> [Estimate; 3] {
    let one = |parameter: Parameter, value: f64, variance: Option<f64>| {
        let std_error = variance.map(f64::sqrt);
        let half = std_error.zip(scale).map(|(error, scale)| scale.quantile * error);
        let interval = half.map(|half| (value - half, value + half));
        Estimate { parameter, value, std_error, interval }
    };
    let ([a, b, c], [x, y, z]) = (parameters, numbers);
    let of = |pick: fn([[f64; 3]; 3]) -> f64| covariance.map(pick);
    [
        one(a, x, of(|[[variance, ..], ..]| variance)),
        one(b, y, of(|[_, [_, variance, _], _]| variance)),
        one(c, z, of(|[_, _, [.., variance]]| variance)),
    ]
}

/// What the search along p says about it.
fn search_notes(optimum: &Optimum, [.., parameter]: [Parameter; 3], scale: Option<Scale>) -> Vec<Note> {
    let value = optimum.p;
    match optimum.place {
        Place::End { lower } => return vec![Note::AtBound { parameter, value, lower }],
        Place::Flat => return vec![Note::Unbounded { parameter, below: true, above: true }],
        Place::Inside => {}
    }
    let mut notes = Vec::new();
    // Likelihood ratio: the p with S(p) ≤ S + t² s² are not refuted at 95 %.
    let margin = scale.map_or(0.0, |scale| scale.quantile.powi(2) * scale.variance);
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
