//! NumPy arrays (`.npy`), and the matrix that a one- or two-dimensional one holds.
//!
//! Source: NumPy Enhancement Proposal 1, "A Simple File Format for NumPy Arrays": magic text, version, length of the
//! header, the header (a Python dictionary with `descr`, `fortran_order` and `shape`), the numbers.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::entries::{Entries, MOST_ENTRIES};
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
    Array::open(bytes, length)?.matrix()
}

/// What a number in the file is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
    /// Bytes of a text.
    Bytes,
    /// A text of four-byte characters.
    Unicode,
}

/// An array whose header was read.
pub(crate) struct Array<R> {
    bytes: R,
    kind: Kind,
    /// Bytes of one item.
    size: usize,
    big_endian: bool,
    column_by_column: bool,
    shape: Vec<usize>,
    count: usize,
}

/// Headers are a line; this is far beyond every one.
const LONGEST_HEADER: usize = 1 << 16;

impl<R: Read> Array<R> {
    /// Reads the header.
    pub(crate) fn open(mut bytes: R, length: u64) -> Result<Self, MatrixFileError> {
        let mut start = [0; 8];
        bytes
            .read_exact(&mut start)
            .map_err(|_| wrong("is no .npy array: it does not begin with \\x93NUMPY"))?;
        let [magic @ .., major, _minor] = start;
        if &magic != b"\x93NUMPY" {
            return Err(wrong("is no .npy array: it does not begin with \\x93NUMPY"));
        }
        let cut = |_| wrong("the file ends within its header");
        let header_length = match major {
            1 => {
                let mut size = [0; 2];
                bytes.read_exact(&mut size).map_err(cut)?;
                usize::from(u16::from_le_bytes(size))
            }
            2 | 3 => {
                let mut size = [0; 4];
                bytes.read_exact(&mut size).map_err(cut)?;
                u32::from_le_bytes(size) as usize
            }
            other => return Err(wrong(format!("version {other} of the .npy format is unknown"))),
        };
        if header_length > LONGEST_HEADER {
            return Err(wrong(format!("the header has {header_length} bytes, which is no header")));
        }
        let mut header = vec![0; header_length];
        bytes.read_exact(&mut header).map_err(cut)?;
        let header = String::from_utf8_lossy(&header);
        let (kind, size, big_endian) = item(&header)?;
        let column_by_column = match after(&header, "fortran_order")? {
            text if text.starts_with("True") => true,
            text if text.starts_with("False") => false,
            _ => return Err(wrong("fortran_order in the header is neither True nor False")),
        };
        let shape = shape(&header)?;
        let count = shape.iter().try_fold(1_usize, |product, extent| product.checked_mul(*extent));
        let fits = |count: &usize| (*count as u64).saturating_mul(size as u64) <= length;
        let count = count.filter(fits).ok_or_else(|| {
            wrong(format!(
                "the header promises an array of {}, which {length} bytes cannot hold",
                extents(&shape)
            ))
        })?;
        Ok(Self { bytes, kind, size, big_endian, column_by_column, shape, count })
    }

    /// Calls `take` with every number in the order of the file.
    pub(crate) fn numbers(
        mut self,
        mut take: impl FnMut(usize, f64) -> Result<(), MatrixFileError>,
    ) -> Result<(), MatrixFileError> {
        if matches!(self.kind, Kind::Bytes | Kind::Unicode) {
            return Err(wrong("holds texts, not numbers"));
        }
        let mut block = vec![0; self.size << 12];
        let mut done = 0;
        while done < self.count {
            let items = (self.count - done).min(1 << 12);
            let part = block.get_mut(..items * self.size).unwrap_or_default();
            self.bytes.read_exact(part).map_err(|error| match error.kind() {
                std::io::ErrorKind::UnexpectedEof => {
                    wrong(format!("the file ends after {done} of its {} numbers", self.count))
                }
                _ => MatrixFileError::Unreadable(error),
            })?;
            for (i, item) in part.chunks_exact(self.size).enumerate() {
                take(done + i, self.number(item))?;
            }
            done += items;
        }
        Ok(())
    }

    fn number(&self, item: &[u8]) -> f64 {
        // The most significant byte last, whatever the order of the file.
        let mut bytes = [0_u8; 8];
        for (i, slot) in bytes.iter_mut().take(self.size).enumerate() {
            let place = if self.big_endian { self.size - 1 - i } else { i };
            *slot = item.get(place).copied().unwrap_or_default();
        }
        let whole = u64::from_le_bytes(bytes);
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(whole as u32)),
            (Kind::Float, _) => f64::from_bits(whole),
            (Kind::Signed, size) => {
                let spare = 64 - 8 * size as u32;
                ((whole << spare) as i64 >> spare) as f64
            }
            _ => whole as f64,
        }
    }

    /// The numbers of a vector.
    pub(crate) fn vector(self) -> Result<Vec<f64>, MatrixFileError> {
        if self.shape.len() != 1 {
            return Err(wrong(format!("must be a vector, but is an array of {}", extents(&self.shape))));
        }
        if self.count > 2 * MOST_ENTRIES {
            return Err(wrong(format!(
                "has {} numbers; more than {} are refused",
                self.count,
                2 * MOST_ENTRIES
            )));
        }
        let mut values = Vec::with_capacity(self.count);
        self.numbers(|_, value| {
            values.push(value);
            Ok(())
        })?;
        Ok(values)
    }

    /// A vector of numbers that count something.
    pub(crate) fn indices(self) -> Result<Vec<usize>, MatrixFileError> {
        let index = |value: f64| match value.fract() {
            0.0 if (0.0..9e15).contains(&value) => Ok(value as usize),
            _ => Err(wrong(format!("must hold whole numbers from 0 on, got {value}"))),
        };
        self.vector()?.into_iter().map(index).collect()
    }

    /// A single short text.
    pub(crate) fn text(mut self) -> Result<String, MatrixFileError> {
        let step = match self.kind {
            Kind::Bytes => 1,
            Kind::Unicode => 4,
            _ => return Err(wrong("must be a text")),
        };
        if self.count != 1 || self.size > 64 {
            return Err(wrong("must be one short text"));
        }
        let mut bytes = vec![0; self.size];
        self.bytes.read_exact(&mut bytes).map_err(|_| wrong("ends within its text"))?;
        let letter = if self.big_endian { step - 1 } else { 0 };
        let letters = bytes.chunks_exact(step).filter_map(|c| c.get(letter)).filter(|c| **c != 0);
        Ok(letters.map(|c| char::from(*c)).collect())
    }

    /// The square matrix, or the diagonal one of a vector.
    pub(crate) fn matrix(self) -> Result<MatrixFile, MatrixFileError> {
        let (n, diagonal) = match self.shape.as_slice() {
            &[n] => (n, true),
            &[rows, columns] if rows == columns => (rows, false),
            &[_, _] => {
                return Err(wrong(format!(
                    "a matrix of a structure is square, this one is {}",
                    extents(&self.shape)
                )));
            }
            other => return Err(wrong(format!("must be a matrix, but is an array of {}", extents(other)))),
        };
        let mut entries = Entries::new(n)?;
        let column_by_column = self.column_by_column;
        self.numbers(|k, value| {
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
}

fn wrong(problem: impl Into<String>) -> MatrixFileError {
    MatrixFileError::content(problem)
}

/// "3 x 4".
fn extents(shape: &[usize]) -> String {
    match shape {
        [] => "no dimension".into(),
        shape => shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x "),
    }
}

/// What follows after a key of the header's dictionary.
fn after<'h>(header: &'h str, key: &str) -> Result<&'h str, MatrixFileError> {
    let find = |quote: char| header.split_once(&format!("{quote}{key}{quote}"));
    let value = find('\'').or_else(|| find('"')).and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
    value.map(str::trim_start).ok_or_else(|| wrong(format!("the header has no {key}")))
}

/// Kind, bytes and byte order of an item out of `descr`, for example `<f8`.
fn item(header: &str) -> Result<(Kind, usize, bool), MatrixFileError> {
    let descr = after(header, "descr")?;
    let text = descr.strip_prefix(['\'', '"']).and_then(|rest| rest.split(['\'', '"']).next());
    let text = text.ok_or_else(|| wrong("holds records with several fields, not numbers"))?;
    let unknown = || wrong(format!("holds numbers of type {text:?}; write float64"));
    let mut letters = text.chars();
    let (order, kind) = (letters.next().ok_or_else(unknown)?, letters.next().ok_or_else(unknown)?);
    let size: usize = letters.as_str().parse().map_err(|_| unknown())?;
    let big_endian = match order {
        '<' | '|' | '=' => false,
        '>' => true,
        _ => return Err(unknown()),
    };
    let (kind, size) = match (kind, size) {
        ('f', 4 | 8) => (Kind::Float, size),
        ('i', 1 | 2 | 4 | 8) => (Kind::Signed, size),
        ('u', 1 | 2 | 4 | 8) | ('b', 1) => (Kind::Unsigned, size),
        ('S', 0..=64) => (Kind::Bytes, size.max(1)),
        ('U', 0..=16) => (Kind::Unicode, 4 * size.max(1)),
        ('c', _) => {
            return Err(wrong("holds complex numbers; write the real matrices of mass, damping, stiffness"));
        }
        _ => return Err(unknown()),
    };
    Ok((kind, size, big_endian))
}

fn shape(header: &str) -> Result<Vec<usize>, MatrixFileError> {
    let text = after(header, "shape")?;
    let inner = text.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(inner, _)| inner);
    let inner = inner.ok_or_else(|| wrong("the header's shape is no list"))?;
    let extents = inner.split(',').map(str::trim).filter(|extent| !extent.is_empty());
    let number = |extent: &str| {
        let digits = extent.trim_end_matches('L');
        digits.parse().map_err(|_| wrong(format!("the header's shape has {extent:?} in it")))
    };
    extents.take(8).map(number).collect()
}

#[cfg(test)]
mod tests;
