//! NumPy arrays (`.npy`).
//!
//! Source: NumPy Enhancement Proposal 1, "A Simple File Format for NumPy Arrays": magic text, version, length of the
//! header, the header (a Python dictionary with `descr`, `fortran_order` and `shape`), the numbers.

use std::io::Read;

use crate::error::{ArrayError, extents, wrong};
use crate::header::{self, Field, Kind};

/// How every file begins.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// Numbers beyond this do not fit in memory together with what is made of them.
pub const MOST_NUMBERS: usize = 200_000_000;

/// Headers are a line; this is far beyond every one.
const LONGEST_HEADER: usize = 1 << 16;

/// Items for which room is made before they are read: a length that a file only claims costs nothing.
const ROOM: usize = 1 << 20;

/// An array whose header was read.
#[derive(Debug)]
pub struct NpyReader<R> {
    bytes: R,
    fields: Vec<Field>,
    /// Bytes of one item, all fields together.
    size: usize,
    column_by_column: bool,
    shape: Vec<usize>,
    count: usize,
}

impl<R: Read> NpyReader<R> {
    /// Reads the header of an array in a file of `length` bytes: one that promises more numbers is refused before room is
    /// made for them.
    ///
    /// # Errors
    /// [`ArrayError`] with what is wrong.
    pub fn open(mut bytes: R, length: u64) -> Result<Self, ArrayError> {
        let mut start = [0; 8];
        let begins = bytes.read_exact(&mut start).is_ok() && start.starts_with(MAGIC);
        if !begins {
            return Err(wrong("is no .npy array: it does not begin with \\x93NUMPY"));
        }
        let [.., major, _minor] = start;
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
        let fields = header::fields(&header)?;
        let size = fields.iter().map(|field| field.size).sum();
        let column_by_column = match header::after(&header, "fortran_order")? {
            text if text.starts_with("True") => true,
            text if text.starts_with("False") => false,
            _ => return Err(wrong("fortran_order in the header is neither True nor False")),
        };
        let shape = header::shape(&header)?;
        let count = shape.iter().try_fold(1_usize, |product, extent| product.checked_mul(*extent));
        let fits = |count: &usize| (*count as u64).saturating_mul(size as u64) <= length;
        let count = count.filter(fits).ok_or_else(|| {
            wrong(format!(
                "the header promises an array of {}, which {length} bytes cannot hold",
                extents(&shape)
            ))
        })?;
        Ok(Self { bytes, fields, size, column_by_column, shape, count })
    }

    /// Its extents.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Whether the first index runs fastest ("Fortran order"), not the last.
    pub fn column_by_column(&self) -> bool {
        self.column_by_column
    }

    /// The fields of an item: one without a name, or those of a structured array.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Calls `take` with the place and value of every number in the order of the file; of structured arrays, those of the
    /// first field.
    ///
    /// # Errors
    /// When the file ends before, holds no real numbers, or `take` refuses.
    pub fn numbers<E: From<ArrayError>>(
        self,
        take: impl FnMut(usize, f64) -> Result<(), E>,
    ) -> Result<(), E> {
        self.numbers_of(0, take)
    }

    /// Likewise those of a field.
    ///
    /// # Errors
    /// When the file ends before, the field holds no real numbers, or `take` refuses.
    pub fn numbers_of<E: From<ArrayError>>(
        mut self,
        field: usize,
        mut take: impl FnMut(usize, f64) -> Result<(), E>,
    ) -> Result<(), E> {
        let field = match self.fields.get(field) {
            Some(field) => field.clone(),
            None => return Err(wrong("has no such field").into()),
        };
        field.check_numeric()?;
        let mut block = vec![0; self.size << 12];
        let mut done = 0;
        while done < self.count {
            let items = (self.count - done).min(1 << 12);
            let part = block.get_mut(..items * self.size).unwrap_or_default();
            self.bytes.read_exact(part).map_err(|error| match error.kind() {
                std::io::ErrorKind::UnexpectedEof => {
                    wrong(format!("the file ends after {done} of its {} numbers", self.count))
                }
                _ => ArrayError::Unreadable(error),
            })?;
            for (i, item) in part.chunks_exact(self.size).enumerate() {
                take(done + i, field.number(item))?;
            }
            done += items;
        }
        Ok(())
    }

    /// All numbers of a field in the order of the file.
    ///
    /// # Errors
    /// When there are too many of them, or they cannot be read.
    pub fn values(self, field: usize) -> Result<Vec<f64>, ArrayError> {
        if self.count > MOST_NUMBERS {
            return Err(wrong(format!("has {} numbers; more than {MOST_NUMBERS} are refused", self.count)));
        }
        let mut values = Vec::with_capacity(self.count.min(ROOM));
        self.numbers_of(field, |_, value| {
            values.push(value);
            Ok::<(), ArrayError>(())
        })?;
        Ok(values)
    }

    /// The numbers of a vector.
    ///
    /// # Errors
    /// When it is no vector of numbers.
    pub fn vector(self) -> Result<Vec<f64>, ArrayError> {
        if self.shape.len() != 1 {
            return Err(wrong(format!("must be a vector, but is an array of {}", extents(&self.shape))));
        }
        self.values(0)
    }

    /// A vector of numbers that count something.
    ///
    /// # Errors
    /// When it is no vector of whole numbers from 0 on.
    pub fn indices(self) -> Result<Vec<usize>, ArrayError> {
        let index = |value: f64| match value.fract() {
            0.0 if (0.0..9e15).contains(&value) => Ok(value as usize),
            _ => Err(wrong(format!("must hold whole numbers from 0 on, got {value}"))),
        };
        self.vector()?.into_iter().map(index).collect()
    }

    /// A single short text.
    ///
    /// # Errors
    /// When it is none.
    pub fn text(mut self) -> Result<String, ArrayError> {
        let Some(field) = self.fields.first().cloned() else { return Err(wrong("must be a text")) };
        let step = match field.kind {
            Kind::Bytes => 1,
            Kind::Unicode => 4,
            _ => return Err(wrong("must be a text")),
        };
        if self.count != 1 || self.size > 64 {
            return Err(wrong("must be one short text"));
        }
        let mut bytes = vec![0; self.size];
        self.bytes.read_exact(&mut bytes).map_err(|_| wrong("ends within its text"))?;
        let letter = if field.big_endian { step - 1 } else { 0 };
        let letters = bytes.chunks_exact(step).filter_map(|c| c.get(letter)).filter(|c| **c != 0);
        Ok(letters.map(|c| char::from(*c)).collect())
    }
}
