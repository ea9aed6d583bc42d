//! What the page is given. Lists over points are in the order of the result; a point that failed has nulls.

use scene::Step;
use serde::Serialize;

/// Everything.
#[derive(Debug, Serialize)]
pub(crate) struct Page<'a> {
    pub(crate) version: &'static str,
    pub(crate) results: &'a [Shown],
}

/// One result.
#[derive(Debug, Serialize)]
pub(crate) struct Shown {
    /// By which it is told from the others.
    pub(crate) label: String,
    pub(crate) scene: String,
    /// `sweep`, `curve` or `mode`.
    pub(crate) kind: &'static str,
    pub(crate) parameter: Parameter,
    pub(crate) dofs: Vec<String>,
    /// Harmonic whose amplitude the response shows.
    pub(crate) harmonic: usize,
    pub(crate) facts: Vec<Fact>,
    pub(crate) notes: Vec<String>,
    pub(crate) peaks: Vec<PeakLine>,
    pub(crate) points: Points,
    pub(crate) contacts: Vec<ContactColumns>,
    pub(crate) motions: Motions,
    /// Where the scene is known.
    pub(crate) plan: Option<Vec<Step>>,
    pub(crate) scene_text: Option<String>,
}

/// What a result runs along.
#[derive(Debug, Serialize)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    /// Empty where it is not known.
    pub(crate) unit: &'static str,
}

/// A line of the summary.
#[derive(Debug, Serialize)]
pub(crate) struct Fact {
    pub(crate) what: &'static str,
    pub(crate) value: String,
}

/// A peak of a response.
#[derive(Debug, Serialize)]
pub(crate) struct PeakLine {
    pub(crate) dof: String,
    /// With contacts: place on the axis and amplitude in m.
    pub(crate) contact: Option<(f64, f64)>,
    /// Likewise without contacts, where the scene is known.
    pub(crate) linear: Option<(f64, f64)>,
}

/// The points, one entry a point in every list.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Points {
    pub(crate) parameter: Vec<f64>,
    /// In Hz.
    pub(crate) frequency: Vec<f64>,
    pub(crate) status: Vec<String>,
    pub(crate) reason: Vec<Option<String>>,
    pub(crate) harmonics: Vec<usize>,
    pub(crate) iterations: Vec<usize>,
    pub(crate) residual: Vec<Option<f64>>,
    /// Estimates.
    pub(crate) truncation: Vec<Option<f64>>,
    pub(crate) sampling: Vec<Option<f64>>,
    pub(crate) solutions: Vec<Option<usize>>,
    /// Null where it is not known.
    pub(crate) stable: Vec<Option<bool>>,
    pub(crate) fold: Vec<bool>,
    /// Of a mode.
    pub(crate) damping_ratio: Vec<Option<f64>>,
    /// `[dof][point]`, in m and rad.
    pub(crate) amplitude: Vec<Vec<Option<f64>>>,
    pub(crate) phase: Vec<Vec<Option<f64>>>,
    /// Without contacts, where the scene is known.
    pub(crate) linear: Option<Vec<Vec<Option<f64>>>>,
    /// Solutions beside those of the points.
    pub(crate) others: Vec<Other>,
}

/// Another solution at the place of a point.
#[derive(Debug, Serialize)]
pub(crate) struct Other {
    pub(crate) point: usize,
    /// One entry a dof, in m.
    pub(crate) amplitude: Vec<Option<f64>>,
}

/// One contact, one entry a point in every list.
#[derive(Debug, Serialize)]
pub(crate) struct ContactColumns {
    pub(crate) name: String,
    /// Empty where the contact has one direction only.
    pub(crate) directions: Vec<String>,
    pub(crate) state: Vec<Option<String>>,
    /// In J per cycle.
    pub(crate) dissipation: Vec<Option<f64>>,
    pub(crate) extrapolated: Vec<bool>,
    /// `[direction][point]`, half the range of the relative displacement in m.
    pub(crate) amplitude: Vec<Vec<Option<f64>>>,
}

/// One period at some of the points.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Motions {
    /// Indices of the points, ascending.
    pub(crate) points: Vec<usize>,
    /// Instants a period.
    pub(crate) samples: usize,
    /// Harmonics of Ω whose amplitudes are given.
    pub(crate) orders: Vec<usize>,
    /// Directions of all contacts together.
    pub(crate) rows: usize,
    /// `law`, or `series`: the harmonics of the result alone.
    pub(crate) force: &'static str,
    /// What is left out, for readers.
    pub(crate) note: Option<String>,
    /// 32-bit floats, little-endian, base64; of every point: |W_k| in m `[dof][order]`, displacement in m
    /// `[dof][instant]`, then of every direction of every contact relative displacement in m and force in N `[instant]`.
    /// Forces as a rig measures them: what moves the first body against friction.
    pub(crate) data: String,
}
