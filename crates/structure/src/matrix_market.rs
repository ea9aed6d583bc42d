//! Matrix Market files (`.mtx`): `%%MatrixMarket matrix coordinate|array real|integer general|symmetric|skew-symmetric`.
//!
//! Source: R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix Market Exchange Formats: Initial Design", NISTIR 5935
//! (1996). Rows and columns count from 1, an array goes column by column, of symmetric matrices the lower triangle is
//! stored.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::entries::{Entries, MOST_ENTRIES};
use crate::matrix_file::{MatrixFile, MatrixFileError};
use crate::triangle::{Declared, completed};

/// Reads a square matrix from a file.
///
/// # Errors
/// [`MatrixFileError`] with the line and the entry.
pub fn read_matrix_market(path: &Path) -> Result<MatrixFile, MatrixFileError> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    parse_matrix_market(BufReader::with_capacity(1 << 18, file), length)
}

/// Reads a square matrix from a text of `length` bytes: a header that promises more entries than fit in it is refused
/// before room is made for them.
///
/// # Errors
/// [`MatrixFileError`] with the line and the entry.
pub fn parse_matrix_market(text: impl BufRead, length: u64) -> Result<MatrixFile, MatrixFileError> {
    let mut lines = Lines { text, line: Vec::new(), number: 0 };
    if !lines.next()? {
        return Err(MatrixFileError::content("the file is empty"));
    }
    let header = header(lines.words()).map_err(|problem| lines.wrong(problem))?;
    if !lines.next_data()? {
        return Err(MatrixFileError::content("the file ends before it says the size of its matrix"));
    }
    let sizes: Result<Vec<usize>, String> = lines.words().map(whole).collect();
    let sizes = sizes.map_err(|problem| lines.wrong(problem))?;
    let (rows, columns, stored) = match (header.layout, sizes.as_slice()) {
        (Layout::Coordinate, &[rows, columns, stored]) => (rows, columns, Some(stored)),
        (Layout::Array, &[rows, columns]) => (rows, columns, None),
        (Layout::Coordinate, _) => {
            return Err(lines.wrong("must be three whole numbers: rows, columns, entries"));
        }
        (Layout::Array, _) => return Err(lines.wrong("must be two whole numbers: rows, columns")),
    };
    if rows != columns {
        return Err(lines.wrong(format!("a matrix of a structure is square, this one is {rows} x {columns}")));
    }
    let entries = Entries::new(rows).map_err(|error| lines.wrong(error.to_string()))?;
    let stored = stored.unwrap_or_else(|| header.declared.array_length(rows));
    // The shortest entry of a coordinate file is "1 1 1" and its line end, that of an array "1".
    let shortest = if header.layout == Layout::Coordinate { 6 } else { 2 };
    if stored > MOST_ENTRIES || (stored as u64).saturating_mul(shortest) > length.saturating_add(shortest) {
        return Err(lines.wrong(format!(
            "promises {stored} entries, which {length} bytes cannot hold (and more than {MOST_ENTRIES} are refused)"
        )));
    }
    let entries = match header.layout {
        Layout::Coordinate => coordinate(&mut lines, entries, stored)?,
        Layout::Array => array(&mut lines, entries, rows, header.declared)?,
    };
    if lines.next_data()? {
        return Err(lines.wrong(format!("follows after the {stored} entries that the file promises")));
    }
    completed(entries, header.declared)
}

fn coordinate<R: BufRead>(
    lines: &mut Lines<R>,
    mut entries: Entries,
    stored: usize,
) -> Result<Entries, MatrixFileError> {
    entries.reserve(stored);
    for found in 0..stored {
        if !lines.next_data()? {
            return Err(MatrixFileError::content(format!(
                "the file ends after {found} of the {stored} entries that it promises"
            )));
        }
        let mut words = lines.words();
        let (row, column, value) = (words.next(), words.next(), words.next());
        let more = words.next().is_some();
        let pushed = match (row, column, value) {
            (Some(row), Some(column), Some(value)) if !more => place(row)
                .and_then(|row| Ok((row, place(column)?, number(value)?)))
                .and_then(|(row, column, value)| entries.push(row, column, value)),
            _ => Err("must be row, column and value".into()),
        };
        pushed.map_err(|problem| lines.wrong(problem))?;
    }
    Ok(entries)
}

/// Column by column; of symmetric matrices from the diagonal down.
fn array<R: BufRead>(
    lines: &mut Lines<R>,
    mut entries: Entries,
    n: usize,
    declared: Declared,
) -> Result<Entries, MatrixFileError> {
    for column in 0..n {
        let first = match declared {
            Declared::General => 0,
            Declared::Symmetric => column,
            Declared::Skew => column + 1,
        };
        for row in first..n {
            if !lines.next_data()? {
                return Err(MatrixFileError::content(format!(
                    "the file ends before row {}, column {} of its array",
                    row + 1,
                    column + 1
                )));
            }
            let mut words = lines.words();
            let (value, more) = (words.next(), words.next().is_some());
            let value = match value {
                Some(value) if !more => number(value),
                _ => Err("must be one number a line".into()),
            };
            let pushed = value.and_then(|value| match value {
                0.0 => Ok(()),
                value => entries.push(row, column, value),
            });
            pushed.map_err(|problem| lines.wrong(problem))?;
        }
    }
    Ok(entries)
}

/// The lines of a text, one at a time in the same memory.
struct Lines<R> {
    text: R,
    line: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// Goes to the next line; whether there is one.
    fn next(&mut self) -> Result<bool, MatrixFileError> {
        self.line.clear();
        self.number += 1;
        Ok(self.text.read_until(b'\n', &mut self.line)? > 0)
    }

    /// Goes to the next line that is no comment and not blank.
    fn next_data(&mut self) -> Result<bool, MatrixFileError> {
        while self.next()? {
            let text = self.line.trim_ascii_start();
            if !text.is_empty() && text.first() != Some(&b'%') {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn words(&self) -> impl Iterator<Item = &[u8]> {
        self.line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }

    fn wrong(&self, problem: impl Into<String>) -> MatrixFileError {
        MatrixFileError::Line { line: self.number, problem: problem.into() }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Layout {
    Coordinate,
    Array,
}

struct Header {
    layout: Layout,
    declared: Declared,
}

impl Declared {
    /// How many numbers an array of n × n holds.
    fn array_length(self, n: usize) -> usize {
        match self {
            Self::General => n.saturating_mul(n),
            Self::Symmetric => n.saturating_mul(n + 1) / 2,
            Self::Skew => n.saturating_mul(n.saturating_sub(1)) / 2,
        }
    }
}

fn header<'w>(words: impl Iterator<Item = &'w [u8]>) -> Result<Header, String> {
    let words: Vec<String> = words.take(6).map(|word| show(word).to_ascii_lowercase()).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["%%matrixmarket", "matrix", layout, field, symmetry] = words.as_slice() else {
        return Err(
            "a Matrix Market file begins with \"%%MatrixMarket matrix coordinate real symmetric\" or alike"
                .into(),
        );
    };
    let layout = match *layout {
        "coordinate" => Layout::Coordinate,
        "array" => Layout::Array,
        other => return Err(format!("the layout must be coordinate or array, got {other:?}")),
    };
    match *field {
        "real" | "integer" | "double" => {}
        "pattern" => {
            return Err("a pattern says where entries stand but not what they are; write real values".into());
        }
        "complex" => {
            return Err(
                "a complex matrix is none of a structure; write real values, damping in its own file".into(),
            );
        }
        other => return Err(format!("the field must be real or integer, got {other:?}")),
    }
    let declared = match *symmetry {
        "general" => Declared::General,
        "symmetric" => Declared::Symmetric,
        "skew-symmetric" => Declared::Skew,
        "hermitian" => return Err("a Hermitian matrix is complex; write a real symmetric one".into()),
        other => {
            return Err(format!("the symmetry must be general, symmetric or skew-symmetric, got {other:?}"));
        }
    };
    Ok(Header { layout, declared })
}

/// A short text for messages.
fn show(word: &[u8]) -> String {
    String::from_utf8_lossy(word.get(..40).unwrap_or(word)).into_owned()
}

fn whole(word: &[u8]) -> Result<usize, String> {
    let text = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    text.ok_or_else(|| format!("{:?} is no whole number", show(word)))
}

/// A row or column counted from 1, counted from 0.
fn place(word: &[u8]) -> Result<usize, String> {
    let digit = |sum: usize, byte: &u8| match byte {
        b'0'..=b'9' => sum.checked_mul(10)?.checked_add(usize::from(byte - b'0')),
        _ => None,
    };
    match word.iter().try_fold(0, digit) {
        Some(0) => Err("rows and columns count from 1, got 0".into()),
        Some(place) => Ok(place - 1),
        None => Err(format!("{:?} is no row or column", show(word))),
    }
}

/// A number; the exponent may be written with D, as Fortran does.
fn number(word: &[u8]) -> Result<f64, String> {
    let text = std::str::from_utf8(word).map_err(|_| format!("{:?} is no number", show(word)))?;
    let parsed = text.parse().ok().or_else(|| {
        let exponent =
            text.contains(['d', 'D']) && !text.contains(|c: char| c.is_alphabetic() && !"dD".contains(c));
        exponent.then(|| text.replace(['d', 'D'], "e").parse().ok())?
    });
    parsed.ok_or_else(|| format!("{:?} is no number", show(word)))
}

#[cfg(test)]
mod tests;
