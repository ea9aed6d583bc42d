//! Identification of the scaling laws, eqs (6) and (7), from loops measured at several amplitudes.
//!
//! ```text
//! g(α) = offset + slope · ln(α + shift)       force magnitude over F*, eq. (6)
//! ψ_C(α) = limit − span · e^{−decay α}        phase of the force on the mass, eq. (7)
//! ```
//!
//! with α = a/W*. Each law is linear in two numbers once the third, `shift` or `decay`, is given. Its least
//! squares are therefore a search along one line, on which every minimum is found, with a straight-line fit at
//! each step: no initial guess, no local minimum taken for the global one.
//!
//! W* and F* are the amplitude and the force of one of the loops, as measured. They are units: the six numbers
//! are relative to them, and their errors do not include an error of the reference.
//!
//! It lives beside the laws, and not with the measurement, because its result *is* the laws' parameters.

mod covariance;
mod error;
mod law_fit;
mod loop_point;
mod note;
mod separable;
mod student;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::scaling::{MagnitudeLaw, PhaseLaw};

pub use error::IdentificationError;
pub use law_fit::{Estimate, LawFit, Parameter};
pub use loop_point::{LoopPoint, PointNoise};
pub use note::{Law, Note};

use separable::{Family, Observation};

/// Which force of a loop eq. (6) is fitted to. Only ratios to the reference loop's own force enter, so loops of
/// one shape give the same numbers with both; where the shape changes with amplitude they differ.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Magnitude {
    /// The force at the turning points of the displacement, as in the paper.
    #[default]
    TurningPoints,
    /// The first harmonic |F_1|, which is what the scaled loop uses g for.
    FirstHarmonic,
}

/// What the loops count, and where the errors come from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// All loops count the same, as in the paper. Errors come from the scatter of the loops about the law, with
    /// Student's t for n − 3 degrees of freedom: they cover everything that makes loops scatter, and need at
    /// least four loops.
    #[default]
    Equal,
    /// Each loop counts by its own measured noise, that of its amplitude included, and errors come from that
    /// noise (normal distribution). Where the loops scatter by more, errors grow with the scatter (Student's t).
    /// Three loops have errors too.
    Noise,
}

/// How to identify. The default is what the paper did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IdentificationSettings {
    /// Which force eq. (6) is fitted to.
    pub magnitude: Magnitude,
    /// What the loops count.
    pub weighting: Weighting,
    /// The loop, by its place in the list, whose amplitude and force are W* and F*; the largest if none.
    pub reference: Option<usize>,
}

/// The loop to which the laws are relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Its place in the list of loops.
    pub index: usize,
    /// W* \[m\].
    pub displacement: f64,
    /// F* \[N\], of the kind that [`Magnitude`] says.
    pub force: f64,
}

/// One loop against the laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// α = a/W*.
    pub alpha: f64,
    /// Measured force over F*.
    pub magnitude: f64,
    /// Measured minus g(α).
    pub magnitude_residual: f64,
    /// Measured phase ψ_C \[rad\].
    pub phase: f64,
    /// Measured minus ψ_C(α) \[rad\].
    pub phase_residual: f64,
}

/// The identified laws, how sure they are, and how well they follow the loops.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// Eq. (6): offset, slope, shift.
    pub magnitude: LawFit<MagnitudeLaw>,
    /// Eq. (7): limit, span, decay; angles in rad.
    pub phase: LawFit<PhaseLaw>,
    /// Which force eq. (6) was fitted to.
    pub kind: Magnitude,
    /// Where the errors come from.
    pub weighting: Weighting,
    /// W* and F*.
    pub reference: Reference,
    /// The loops, in the order given.
    pub points: Vec<Compared>,
    /// Root mean square over the loops of |measured − law| as complex forces, magnitude and phase together,
    /// relative to F* \[-\].
    pub residual_rms: f64,
    /// What the loops do not tell, or do not agree with.
    pub notes: Vec<Note>,
}

/// Amplitudes closer than this, relative, are one amplitude measured twice: as far apart as cycles that count
/// as steady may be.
pub const SAME_AMPLITUDE: f64 = 0.02;

/// Identifies eqs (6) and (7) from loops by least squares. The order of the loops and their units do not
/// matter.
///
/// # Errors
/// [`IdentificationError`]: fewer than three different amplitudes for three numbers a law; a loop with numbers
/// that cannot be; a reference that is none of the loops; [`Weighting::Noise`] with a loop of unknown noise.
pub fn identify(
    points: &[LoopPoint],
    settings: &IdentificationSettings,
) -> Result<Identification, IdentificationError> {
    for (index, point) in points.iter().enumerate() {
        point.check(index, settings.weighting)?;
    }
    // Sorted, so that sums do not depend on the order of files.
    let mut sorted = points.to_vec();
    sorted.sort_by(LoopPoint::order);
    let amplitudes = different(sorted.iter().map(|point| point.displacement));
    if amplitudes < 3 {
        return Err(IdentificationError::TooFewAmplitudes { loops: points.len(), amplitudes });
    }
    let largest = points.iter().enumerate().max_by(|(_, a), (_, b)| a.order(b)).map(|(index, _)| index);
    let index = settings.reference.or(largest).unwrap_or_default();
    let Some(chosen) = points.get(index) else {
        return Err(IdentificationError::NoSuchReference { index, loops: points.len() });
    };
    let kind = settings.magnitude;
    let reference = Reference { index, displacement: chosen.displacement, force: chosen.force(kind) };

    let alpha = |point: &LoopPoint| point.displacement / reference.displacement;
    let relative = |point: &LoopPoint| point.force(kind) / reference.force;
    let observe = |value: &dyn Fn(&LoopPoint) -> f64, noise: &dyn Fn(&PointNoise) -> f64| {
        let seen = sorted.iter().map(|point| Observation {
            alpha: alpha(point),
            value: value(point),
            noise: point
                .noise
                .as_ref()
                .map(|errors| (noise(errors), errors.displacement / reference.displacement))
                .filter(|(noise, _)| *noise > 0.0),
        });
        seen.collect::<Vec<_>>()
    };
    let magnitudes = observe(&relative, &|errors| errors.force(kind) / reference.force);
    let phases = observe(&LoopPoint::law_phase, &|errors| errors.phase);

    let (magnitude, mut notes) = law_fit::fit(&Family::MAGNITUDE, &magnitudes, settings.weighting);
    let (phase, of_phase) = law_fit::fit(&Family::PHASE, &phases, settings.weighting);
    notes.extend(of_phase);
    let shift_at_bound =
        notes.iter().any(|note| matches!(note, Note::AtBound { parameter: Parameter::Shift, .. }));
    notes.extend(note::of_count(points.len(), amplitudes, settings.weighting));
    notes.extend(note::of_range(&magnitudes, &magnitude.law, shift_at_bound, &phase.law));
    notes.extend(note::not_passive(magnitude.law.check().err()));
    notes.extend(note::not_passive(phase.law.check().err()));

    let compare = |point: &LoopPoint| {
        let (alpha, measured, angle) = (alpha(point), relative(point), point.law_phase());
        Compared {
            alpha,
            magnitude: measured,
            magnitude_residual: measured - magnitude.law.value(alpha),
            phase: angle,
            phase_residual: angle - phase.law.value(alpha),
        }
    };
    let off = |point: &LoopPoint| {
        let Compared { alpha, magnitude: measured, phase: angle, .. } = compare(point);
        let law = Complex64::from_polar(1.0, phase.law.value(alpha)) * magnitude.law.value(alpha);
        (Complex64::from_polar(measured, angle) - law).norm_sqr()
    };
    let residual_rms = (sorted.iter().map(off).sum::<f64>() / sorted.len() as f64).sqrt();
    Ok(Identification {
        points: points.iter().map(compare).collect(),
        kind,
        weighting: settings.weighting,
        reference,
        residual_rms,
        notes,
        magnitude,
        phase,
    })
}

/// How many different amplitudes there are in an ascending list.
fn different(ascending: impl Iterator<Item = f64>) -> usize {
    let mut last = f64::NEG_INFINITY;
    ascending
        .filter(|amplitude| {
            let new = *amplitude > (1.0 + SAME_AMPLITUDE) * last || last == f64::NEG_INFINITY;
            if new {
                last = *amplitude;
            }
            new
        })
        .count()
}

#[cfg(test)]
mod tests;
