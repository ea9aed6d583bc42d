//! A matrix out of a file: what was read, what was noticed, what can be wrong.

use std::fmt;

use arrays::ArrayError;
use faer::sparse::SparseColMat;
use thiserror::Error;

/// A square matrix, both triangles stored, and what was noticed while it was read.
#[derive(Debug, Clone)]
pub struct MatrixFile {
    /// Rows sorted in every column, no explicit zeros.
    pub matrix: SparseColMat<usize, f64>,
    /// What a user should know.
    pub notes: Vec<MatrixNote>,
}

/// Something about a file that may not be what its author meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixNote {
    /// A `symmetric` Matrix Market file should hold the lower triangle; this one holds the upper.
    UpperTriangle,
    /// A `symmetric` file whose entries lie on both sides of the diagonal, each place once.
    MixedTriangles,
    /// A `symmetric` file that holds both triangles; they agree and are not added.
    BothTriangles,
    /// A file that says nothing of symmetry and holds one triangle.
    OneTriangle,
    /// So many entries were added to others at the same place.
    Repeated(usize),
    /// A vector, taken as the diagonal.
    Diagonal,
}

impl fmt::Display for MatrixNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UpperTriangle => f.write_str(
                "a symmetric file should hold the lower triangle, this one holds the upper; it is mirrored all the same",
            ),
            Self::MixedTriangles => f.write_str(
                "a symmetric file should hold the lower triangle, this one has entries on both sides; all are mirrored",
            ),
            Self::BothTriangles => f.write_str(
                "a symmetric file should hold the lower triangle, this one holds both; they agree and are not added",
            ),
            Self::OneTriangle => {
                f.write_str(
                    "the file does not say symmetric but holds one triangle only; the matrix is taken as symmetric",
                )
            }
            Self::Repeated(1) => f.write_str("1 entry stands at a place that has one already; they are added"),
            Self::Repeated(count) => {
                write!(f, "{count} entries stand at places that have one already; they are added")
            }
            Self::Diagonal => f.write_str("a vector is taken as the diagonal of a matrix"),
        }
    }
}

/// A file that holds no matrix of a structure.
#[derive(Debug, Error)]
pub enum MatrixFileError {
    /// The system refused.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// A line of a text is wrong.
    #[error("line {line}: {problem}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong, with the value.
        problem: String,
    },
    /// The whole is wrong.
    #[error("{0}")]
    Content(String),
}

impl From<ArrayError> for MatrixFileError {
    fn from(error: ArrayError) -> Self {
        match error {
            ArrayError::Unreadable(error) => Self::Unreadable(error),
            ArrayError::Content(problem) => Self::Content(problem),
        }
    }
}

impl MatrixFileError {
    pub(crate) fn content(problem: impl Into<String>) -> Self {
        Self::Content(problem.into())
    }
}
