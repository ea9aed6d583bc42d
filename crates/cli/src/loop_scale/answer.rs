//! The answer of `stickslip loop scale` for programs.

use std::collections::BTreeMap;

use contact::identification::{Estimate, LawFit, Magnitude, Weighting};
use contact::{MagnitudeLaw, PhaseLaw};
use serde::Serialize;

use super::Scaling;

/// Laws that a scene takes, as it writes them.
#[derive(Serialize)]
struct Law {
    magnitude: MagnitudeLaw,
    phase: PhaseLaw,
}

#[derive(Serialize)]
struct Value {
    value: f64,
    std_error: Option<f64>,
    interval: Option<(f64, f64)>,
}

#[derive(Serialize)]
struct Quality {
    residual_rms: f64,
    freedom: usize,
    misfit: Option<f64>,
    covariance: Option<[[f64; 3]; 3]>,
}

impl Quality {
    fn of<L>(fit: &LawFit<L>) -> Self {
        let LawFit { residual_rms, freedom, misfit, covariance, .. } = *fit;
        Self { residual_rms, freedom, misfit, covariance }
    }
}

#[derive(Serialize)]
struct Reference {
    file: String,
    displacement: f64,
    force: f64,
}

#[derive(Serialize)]
struct MeasuredLoop {
    file: String,
    alpha: f64,
    magnitude: f64,
    magnitude_residual: f64,
    phase: f64,
    phase_residual: f64,
}

/// The answer for programs.
#[derive(Serialize)]
pub struct Answer {
    magnitude: BTreeMap<&'static str, Value>,
    phase: BTreeMap<&'static str, Value>,
    residual_rms: f64,
    force: Magnitude,
    weights: Weighting,
    reference: Reference,
    passive: bool,
    law: Law,
    quality: BTreeMap<&'static str, Quality>,
    loops: Vec<MeasuredLoop>,
    notes: Vec<String>,
}

impl Answer {
    pub fn of(result: &Scaling) -> Self {
        let found = result.found;
        let values = |estimates: &[Estimate]| {
            let value = |estimate: &Estimate| {
                let Estimate { parameter, value, std_error, interval } = *estimate;
                (parameter.name(), Value { value, std_error, interval })
            };
            estimates.iter().map(value).collect()
        };
        let measured = found.points.iter().enumerate().map(|(index, point)| MeasuredLoop {
            file: result.file(index),
            alpha: point.alpha,
            magnitude: point.magnitude,
            magnitude_residual: point.magnitude_residual,
            phase: point.phase,
            phase_residual: point.phase_residual,
        });
        Self {
            magnitude: values(&found.magnitude.estimates),
            phase: values(&found.phase.estimates),
            residual_rms: found.residual_rms,
            force: found.kind,
            weights: found.weighting,
            reference: Reference {
                file: result.file(found.reference.index),
                displacement: found.reference.displacement,
                force: found.reference.force,
            },
            passive: result.is_passive(),
            law: Law { magnitude: found.magnitude.law, phase: found.phase.law },
            quality: [("magnitude", Quality::of(&found.magnitude)), ("phase", Quality::of(&found.phase))]
                .into_iter()
                .collect(),
            loops: measured.collect(),
            notes: found.notes.iter().map(ToString::to_string).collect(),
        }
    }
}
