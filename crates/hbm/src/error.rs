//! Misuse: a model or a problem that cannot be solved as posed.

use thiserror::Error;

/// A model that is none. `matrix` names the offending one as a scene does.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{matrix}: {problem}")]
pub struct ModelError {
    /// `mass`, `damping` or `stiffness`.
    pub matrix: &'static str,
    /// What is wrong, with place and value.
    pub problem: String,
}

/// A problem that cannot be planned. `place` is its path in a scene.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{place}: {problem}")]
pub struct PlanError {
    /// For example `excitation[1].harmonic`.
    pub place: String,
    /// What is wrong, with values.
    pub problem: String,
}
