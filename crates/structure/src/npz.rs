//! Archives of NumPy arrays (`.npz`): one of their arrays, or what `scipy.sparse.save_npz` writes.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use arrays::{ArrayError, NpzReader};

use crate::entries::Entries;
use crate::matrix_file::{MatrixFile, MatrixFileError};
use crate::npy;
use crate::triangle::{Declared, completed};

/// Reads a square matrix from a `.npz` file: the array `entry`; without a name the sparse matrix that SciPy wrote, or
/// the only array there is.
///
/// # Errors
/// [`MatrixFileError`] with what is wrong, and in which array.
pub fn read_npz(path: &Path, entry: Option<&str>) -> Result<MatrixFile, MatrixFileError> {
    parse_npz(BufReader::new(File::open(path)?), entry)
}

/// Reads it from bytes.
///
/// # Errors
/// [`MatrixFileError`] with what is wrong, and in which array.
pub fn parse_npz(bytes: impl Read + Seek, entry: Option<&str>) -> Result<MatrixFile, MatrixFileError> {
    let mut archive = NpzReader::open(bytes)?;
    let names = archive.names();
    let has = |name: &str| names.iter().any(|known| known == name);
    match entry {
        Some(entry) if has(entry) => matrix(&mut archive, entry),
        Some(entry) => Err(wrong(format!("there is no array {entry:?} in it; it has {}", names.join(", ")))),
        None if has("format") && has("data") && has("shape") => scipy(&mut archive),
        None => match names.as_slice() {
            [] => Err(wrong("has no array in it")),
            [only] => matrix(&mut archive, only),
            several => Err(wrong(format!("has several arrays; say which one: {}", several.join(", ")))),
        },
    }
}

/// The matrix of an array.
fn matrix<R: Read + Seek>(archive: &mut NpzReader<R>, name: &str) -> Result<MatrixFile, MatrixFileError> {
    let within = |error: MatrixFileError| ArrayError::Content(error.to_string());
    Ok(archive.read(name, |array| npy::matrix(array).map_err(within))?)
}

/// `save_npz`: format, shape, data, and where the data stand.
fn scipy<R: Read + Seek>(archive: &mut NpzReader<R>) -> Result<MatrixFile, MatrixFileError> {
    let format = archive.read("format", |array| array.text())?;
    if !["csc", "csr", "coo"].contains(&format.as_str()) {
        return Err(wrong(format!(
            "a sparse matrix in the format {format:?}; save K.tocsc(), K.tocsr() or K.tocoo()"
        )));
    }
    let shape = archive.read("shape", |array| array.indices())?;
    let &[rows, columns] = shape.as_slice() else {
        return Err(wrong(format!("array \"shape\": must have two numbers, got {}", shape.len())));
    };
    if rows != columns {
        return Err(wrong(format!("a matrix of a structure is square, this one is {rows} x {columns}")));
    }
    let mut entries = Entries::new(rows)?;
    let data = archive.read("data", |array| array.vector())?;
    let mut push = |row, column, value| entries.push(row, column, value).map_err(wrong);
    if format == "coo" {
        let row = archive.read("row", |array| array.indices())?;
        let column = archive.read("col", |array| array.indices())?;
        if row.len() != data.len() || column.len() != data.len() {
            return Err(wrong("its arrays \"row\", \"col\" and \"data\" have different lengths"));
        }
        for ((&row, &column), &value) in row.iter().zip(&column).zip(&data) {
            push(row, column, value)?;
        }
    } else {
        let inner = archive.read("indices", |array| array.indices())?;
        let starts = archive.read("indptr", |array| array.indices())?;
        let grows = starts.windows(2).all(|pair| pair.first() <= pair.last());
        let ends = (starts.first(), starts.last()) == (Some(&0), Some(&data.len()));
        if starts.len() != rows + 1 || !grows || !ends || inner.len() != data.len() {
            return Err(wrong("its arrays \"indptr\", \"indices\" and \"data\" do not fit together"));
        }
        for (outer, pair) in starts.windows(2).enumerate() {
            let &[from, to] = pair else { continue };
            let (indices, values) = (inner.get(from..to), data.get(from..to));
            for (&index, &value) in indices.into_iter().flatten().zip(values.into_iter().flatten()) {
                if format == "csc" { push(index, outer, value)? } else { push(outer, index, value)? }
            }
        }
    }
    completed(entries, Declared::General)
}

fn wrong(problem: impl Into<String>) -> MatrixFileError {
    MatrixFileError::content(problem)
}

#[cfg(test)]
mod tests;
