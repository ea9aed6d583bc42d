//! What can be wrong with a file of arrays.

use thiserror::Error;

/// A file that holds no arrays, or none of the wanted form.
#[derive(Debug, Error)]
pub enum ArrayError {
    /// The system refused.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The content is wrong.
    #[error("{0}")]
    Content(String),
}

/// A content that is wrong.
pub(crate) fn wrong(problem: impl Into<String>) -> ArrayError {
    ArrayError::Content(problem.into())
}

/// "3 x 4".
#[must_use]
pub fn extents(shape: &[usize]) -> String {
    match shape {
        [] => "no dimension".into(),
        shape => shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x "),
    }
}
