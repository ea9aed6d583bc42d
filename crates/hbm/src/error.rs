//! Misuse: a problem that cannot be solved as posed.

use thiserror::Error;

/// A problem that cannot be planned. `place` is its path in a scene.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{place}: {problem}")]
pub struct PlanError {
    /// For example `excitation[1].harmonic`.
    pub place: String,
    /// What is wrong, with values.
    pub problem: String,
}
