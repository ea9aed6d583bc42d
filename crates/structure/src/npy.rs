//! The matrix that a one- or two-dimensional NumPy array (`.npy`) holds.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use arrays::{NpyReader, extents};

use crate::entries::Entries;
use crate::matrix_file::{MatrixFile, MatrixFileError, MatrixNote};
use crate::triangle::{Declared, completed};

/// Reads a square matrix, or a vector as a diagonal, from a `.npy` file.
///
/// # Errors
/// [`MatrixFileError`] with what is wrong.
pub fn read_npy(path: &Path) -> Result<MatrixFile, MatrixFileError> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    parse_npy(BufReader::with_capacity(1 << 18, file), length)
}

/// Reads it from `length` bytes: a header that promises more numbers is refused before room is made for them.
///
/// # Errors
/// [`MatrixFileError`] with what is wrong.
pub fn parse_npy(bytes: impl Read, length: u64) -> Result<MatrixFile, MatrixFileError> {
    matrix(NpyReader::open(bytes, length)?)
}

/// The square matrix of an array, or the diagonal one of a vector.
pub(crate) fn matrix(array: NpyReader<impl Read>) -> Result<MatrixFile, MatrixFileError> {
    if array.fields().len() != 1 {
        return Err(wrong("holds records with several fields, not numbers"));
    }
    let (n, diagonal) = match array.shape() {
        &[n] => (n, true),
        &[rows, columns] if rows == columns => (rows, false),
        shape @ &[_, _] => {
            return Err(wrong(format!("a matrix of a structure is square, this one is {}", extents(shape))));
        }
        other => return Err(wrong(format!("must be a matrix, but is an array of {}", extents(other)))),
    };
    let mut entries = Entries::new(n)?;
    let column_by_column = array.column_by_column();
    array.numbers(|k, value| {
        let (row, column) = match (diagonal, column_by_column) {
            (true, _) => (k, k),
            (false, true) => (k % n, k / n),
            (false, false) => (k / n, k % n),
        };
        if value == 0.0 { Ok(()) } else { entries.push(row, column, value).map_err(wrong) }
    })?;
    let mut file = completed(entries, Declared::General)?;
    if diagonal {
        file.notes.push(MatrixNote::Diagonal);
    }
    Ok(file)
}

fn wrong(problem: impl Into<String>) -> MatrixFileError {
    MatrixFileError::content(problem)
}

#[cfg(test)]
mod tests;
