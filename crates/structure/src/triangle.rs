//! One triangle or both: the full matrix that a file means.

use faer::sparse::SparseColMat;

use crate::entries::{Entries, transposed};
use crate::matrix_file::{MatrixFile, MatrixFileError, MatrixNote};

/// What a file says of the symmetry of its matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Declared {
    /// Nothing.
    General,
    /// A_ij = A_ji; one triangle is stored.
    Symmetric,
    /// A_ij = −A_ji; one triangle without the diagonal is stored.
    Skew,
}

/// Relative difference of two triangles that is rounding.
const ROUNDING: f64 = 1e-9;

/// How a matrix fills its triangles; the diagonal does not count.
#[derive(Default)]
struct Triangles {
    lower: usize,
    upper: usize,
    /// Places of the lower triangle whose mirror image is stored as well.
    pairs: usize,
    /// The first pair that differs.
    different: Option<(usize, usize, f64, f64)>,
}

impl Triangles {
    fn of(matrix: &SparseColMat<usize, f64>) -> Self {
        let mirror = transposed(matrix);
        let mut found = Self::default();
        for column in 0..matrix.ncols() {
            let mut image = (mirror.symbolic().row_idx_of_col_raw(column).iter())
                .zip(mirror.val_of_col(column))
                .peekable();
            let entries = matrix.symbolic().row_idx_of_col_raw(column).iter().zip(matrix.val_of_col(column));
            for (&row, &value) in entries {
                if row < column {
                    found.upper += 1;
                }
                if row <= column {
                    continue;
                }
                found.lower += 1;
                while image.next_if(|(other, _)| **other < row).is_some() {}
                if let Some((_, &other)) = image.next_if(|(other, _)| **other == row) {
                    found.pairs += 1;
                    if found.different.is_none()
                        && (value - other).abs() > ROUNDING * value.abs().max(other.abs())
                    {
                        found.different = Some((row, column, value, other));
                    }
                }
            }
        }
        found
    }
}

/// The matrix that the entries of a file mean: mirrored where one triangle was stored.
pub(crate) fn completed(entries: Entries, declared: Declared) -> Result<MatrixFile, MatrixFileError> {
    let (matrix, repeated) = entries.matrix();
    let mut notes = Vec::new();
    if repeated > 0 {
        notes.push(MatrixNote::Repeated(repeated));
    }
    let triangles = Triangles::of(&matrix);
    let (lower, upper) = (triangles.lower, triangles.upper);
    let one_sided = (lower == 0) != (upper == 0);
    let matrix = match declared {
        Declared::General if one_sided => {
            notes.push(MatrixNote::OneTriangle);
            mirrored(&matrix, 1.0)?
        }
        Declared::General => matrix,
        Declared::Symmetric if lower + upper == 0 => matrix,
        Declared::Symmetric if triangles.pairs == lower && lower == upper => {
            if let Some((row, column, value, other)) = triangles.different {
                return Err(MatrixFileError::content(format!(
                    "the file says symmetric, but row {0}, column {1} is {value} and row {1}, column {0} is {other}",
                    row + 1,
                    column + 1
                )));
            }
            notes.push(MatrixNote::BothTriangles);
            matrix
        }
        Declared::Symmetric if triangles.pairs > 0 => {
            return Err(MatrixFileError::content(format!(
                "the file says symmetric and holds {lower} entries below the diagonal and {upper} above it, but only {} \
                 of them in pairs; write one triangle, or say general",
                triangles.pairs
            )));
        }
        Declared::Symmetric => {
            if lower == 0 {
                notes.push(MatrixNote::UpperTriangle);
            } else if upper > 0 {
                notes.push(MatrixNote::MixedTriangles);
            }
            mirrored(&matrix, 1.0)?
        }
        Declared::Skew => {
            if !one_sided && lower > 0 {
                return Err(MatrixFileError::content(
                    "the file says skew-symmetric and has entries on both sides of the diagonal; write one triangle",
                ));
            }
            if let Some(i) = (0..matrix.ncols()).find(|&i| matrix.get(i, i).is_some()) {
                let i = i + 1;
                return Err(MatrixFileError::content(format!(
                    "the file says skew-symmetric, but row {i}, column {i} is not zero"
                )));
            }
            mirrored(&matrix, -1.0)?
        }
    };
    Ok(MatrixFile { matrix, notes })
}

/// A + sign · Aᵀ with the diagonal once.
fn mirrored(
    matrix: &SparseColMat<usize, f64>,
    sign: f64,
) -> Result<SparseColMat<usize, f64>, MatrixFileError> {
    let mut entries = Entries::new(matrix.nrows())?;
    entries.reserve(2 * matrix.val().len());
    for triplet in matrix.triplet_iter() {
        let (row, column, value) = (triplet.row, triplet.col, *triplet.val);
        entries.push(row, column, value).map_err(MatrixFileError::Content)?;
        if row != column {
            entries.push(column, row, sign * value).map_err(MatrixFileError::Content)?;
        }
    }
    Ok(entries.matrix().0)
}
