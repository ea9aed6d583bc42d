//! Misuse: matrices that are no structure.

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
