//! A file of named arrays, in whichever of the known formats: what is in it, and one column of it.

use std::io::Cursor;

use crate::error::{ArrayError, extents, wrong};
use crate::mat::{self, MatReader};
use crate::npy::{self, NpyReader};
use crate::npz::{Member, NpzReader};

/// The formats of files of arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One NumPy array.
    Npy,
    /// An archive of NumPy arrays.
    Npz,
    /// Variables of MATLAB.
    Mat,
}

impl Format {
    /// The format of a file by its first bytes; none for any other file.
    ///
    /// # Errors
    /// For files that are known not to be readable: MATLAB's of version 7.3 and 4, Octave's own.
    pub fn of(bytes: &[u8]) -> Result<Option<Self>, ArrayError> {
        const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
        // MATLAB writes a header of its own before that of HDF5.
        if bytes.starts_with(HDF5) || bytes.get(512..).is_some_and(|rest| rest.starts_with(HDF5)) {
            return Err(mat::newer());
        }
        if bytes.starts_with(b"# Created by Octave") || bytes.starts_with(b"Octave-1-") {
            return Err(wrong(
                "is a file of Octave's own format, which is not read; save it with -v7: save -v7 record.mat",
            ));
        }
        Ok(match bytes {
            _ if bytes.starts_with(npy::MAGIC) => Some(Self::Npy),
            _ if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") => Some(Self::Npz),
            _ if mat::is_mat(bytes) => Some(Self::Mat),
            _ => None,
        })
    }
}

/// An array of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Empty where the file is one array; of a structured array or a struct, `array.field`.
    pub name: String,
    /// Its extents.
    pub shape: Vec<usize>,
    /// What it holds instead of real numbers.
    pub other: Option<String>,
    /// The array of the file, and the field of its items.
    source: (String, usize),
}

impl Entry {
    /// Samples and columns: of a vector one column, whichever way it lies; of a matrix a sample a row.
    #[must_use]
    pub fn samples_and_columns(&self) -> Option<(usize, usize)> {
        match *self.shape.as_slice() {
            [n] | [n, 1] | [1, n] => Some((n, 1)),
            [rows, columns] => Some((rows, columns)),
            _ => None,
        }
    }
}

/// A file of arrays whose list was read.
#[derive(Debug)]
pub struct ArrayFile<'a> {
    bytes: &'a [u8],
    format: Format,
    entries: Vec<Entry>,
}

impl<'a> ArrayFile<'a> {
    /// Reads the list of arrays.
    ///
    /// # Errors
    /// When the file is damaged.
    pub fn open(bytes: &'a [u8], format: Format) -> Result<Self, ArrayError> {
        let entries = match format {
            Format::Npy => of_array("", &NpyReader::open(bytes, bytes.len() as u64)?),
            Format::Npz => {
                let mut archive = NpzReader::open(Cursor::new(bytes))?;
                let mut entries = Vec::new();
                for name in archive.names() {
                    // Arrays that are not understood do not keep the others from being read.
                    entries.extend(archive.read(&name, |array| Ok(of_array(&name, &array))).unwrap_or_else(
                        |error| {
                            let (shape, source) = (Vec::new(), (name.clone(), 0));
                            vec![Entry { name, shape, other: Some(error.to_string()), source }]
                        },
                    ));
                }
                entries
            }
            Format::Mat => {
                let entry = |variable: mat::Variable| Entry {
                    source: (variable.name.clone(), 0),
                    name: variable.name,
                    shape: variable.shape,
                    other: variable.other.map(str::to_owned),
                };
                MatReader::open(bytes)?.variables()?.into_iter().map(entry).collect()
            }
        };
        Ok(Self { bytes, format, entries })
    }

    /// The arrays, in the order of the file.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The numbers of a column of an array, counted from 0; see [`Entry::samples_and_columns`].
    ///
    /// # Errors
    /// When it has no such column, holds no real numbers, or is damaged.
    pub fn column(&self, entry: &Entry, column: usize) -> Result<Vec<f64>, ArrayError> {
        if let Some(other) = &entry.other {
            return Err(wrong(format!("holds no real numbers: {other}")));
        }
        let (samples, columns) =
            entry.samples_and_columns().filter(|(_, columns)| column < *columns).ok_or_else(|| {
                wrong(format!("an array of {} has no column {}", extents(&entry.shape), column + 1))
            })?;
        let (name, field) = &entry.source;
        let numpy = |array: Member<'_>| Ok((array.column_by_column(), array.values(*field)?));
        let (column_by_column, values) = match self.format {
            Format::Npy => {
                let mut bytes = self.bytes;
                numpy(NpyReader::open(&mut bytes as &mut dyn std::io::Read, self.bytes.len() as u64)?)?
            }
            Format::Npz => NpzReader::open(Cursor::new(self.bytes))?.read(name, numpy)?,
            Format::Mat => (true, MatReader::open(self.bytes)?.values(name)?),
        };
        let (first, step) = if column_by_column { (column * samples, 1) } else { (column, columns) };
        Ok(values.into_iter().skip(first).step_by(step).take(samples).collect())
    }
}

/// The entries of an array: itself, or its fields.
fn of_array<R: std::io::Read>(name: &str, array: &NpyReader<R>) -> Vec<Entry> {
    let entry = |(index, field): (usize, &crate::header::Field)| Entry {
        name: match (name, field.name.as_str()) {
            (name, "") => name.to_owned(),
            ("", field) => field.to_owned(),
            (name, field) => format!("{name}.{field}"),
        },
        shape: array.shape().to_vec(),
        other: field.check_numeric().err().map(|error| error.to_string()),
        source: (name.to_owned(), index),
    };
    array.fields().iter().enumerate().map(entry).collect()
}

#[cfg(test)]
mod tests;
