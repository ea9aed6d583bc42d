//! Writes archives of NumPy arrays that `numpy.load` reads without `allow_pickle`.

use std::fmt::Write as _;
use std::io::{self, Write};

use num_complex::Complex64;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

/// Bytes that are handed on together.
const BLOCK: usize = 1 << 16;

/// From this size on a member of an archive needs the 64-bit form.
const LARGE: usize = u32::MAX as usize;

/// An archive that is written from its beginning to its end, array by array.
///
/// The same arrays make the same bytes: members carry no time.
pub struct NpzWriter<W: Write>(ZipWriter<StreamWriter<W>>);

impl<W: Write> NpzWriter<W> {
    /// An archive without arrays as yet.
    pub fn new(out: W) -> Self {
        Self(ZipWriter::new_stream(out))
    }

    /// Adds real numbers (`float64`), the last index running fastest.
    ///
    /// # Errors
    /// When `out` cannot be written, or there are not as many numbers as `shape` says.
    pub fn numbers(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = f64>,
    ) -> io::Result<()> {
        self.array(name, "<f8", 8, shape, values, |value, block| block.extend(value.to_le_bytes()))
    }

    /// Adds complex numbers (`complex128`).
    ///
    /// # Errors
    /// As [`NpzWriter::numbers`].
    pub fn complex(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = Complex64>,
    ) -> io::Result<()> {
        self.array(name, "<c16", 16, shape, values, |value, block| {
            block.extend(value.re.to_le_bytes());
            block.extend(value.im.to_le_bytes());
        })
    }

    /// Adds whole numbers (`int64`).
    ///
    /// # Errors
    /// As [`NpzWriter::numbers`].
    pub fn whole(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = i64>,
    ) -> io::Result<()> {
        self.array(name, "<i8", 8, shape, values, |value, block| block.extend(value.to_le_bytes()))
    }

    /// Adds truth values (`bool`).
    ///
    /// # Errors
    /// As [`NpzWriter::numbers`].
    pub fn truth(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = bool>,
    ) -> io::Result<()> {
        self.array(name, "|b1", 1, shape, values, |value, block| block.push(u8::from(value)))
    }

    /// Adds texts, all with the room of the longest.
    ///
    /// # Errors
    /// As [`NpzWriter::numbers`].
    pub fn text<'t>(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = &'t str> + Clone,
    ) -> io::Result<()> {
        let widest = values.clone().into_iter().map(|text| text.chars().count()).max().unwrap_or(0);
        let mut column = self.text_column(name, shape, widest)?;
        for value in values {
            column.put(value)?;
        }
        column.finish()
    }

    /// Begins texts of at most `widest` characters, which are put in one by one.
    pub(crate) fn text_column(
        &mut self,
        name: &str,
        shape: &[usize],
        widest: usize,
    ) -> io::Result<Texts<'_, W>> {
        let width = widest.max(1);
        let count = self.begin(name, &format!("<U{width}"), 4 * width, shape)?;
        Ok(Texts { archive: self, width, left: count, block: Vec::with_capacity(BLOCK + 4 * width) })
    }

    /// Writes the list of arrays and ends the archive.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn finish(self) -> io::Result<()> {
        self.0.finish()?.flush()
    }

    fn array<T>(
        &mut self,
        name: &str,
        descr: &str,
        size: usize,
        shape: &[usize],
        values: impl IntoIterator<Item = T>,
        put: impl Fn(T, &mut Vec<u8>),
    ) -> io::Result<()> {
        let mut left = self.begin(name, descr, size, shape)?;
        let mut block = Vec::with_capacity(BLOCK + size);
        for value in values {
            left = left.checked_sub(1).ok_or_else(|| miscounted(name))?;
            put(value, &mut block);
            if block.len() >= BLOCK {
                self.0.write_all(&block)?;
                block.clear();
            }
        }
        if left > 0 {
            return Err(miscounted(name));
        }
        self.0.write_all(&block)
    }

    /// Begins an array; how many items it has.
    fn begin(&mut self, name: &str, descr: &str, size: usize, shape: &[usize]) -> io::Result<usize> {
        let product = shape.iter().try_fold(1_usize, |product, extent| product.checked_mul(*extent));
        let count = product.ok_or_else(|| miscounted(name))?;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .large_file(count.saturating_mul(size) >= LARGE - BLOCK);
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0.write_all(&header(descr, shape))?;
        Ok(count)
    }
}

/// Texts of an array that is being written.
pub(crate) struct Texts<'a, W: Write> {
    archive: &'a mut NpzWriter<W>,
    width: usize,
    left: usize,
    block: Vec<u8>,
}

impl<W: Write> Texts<'_, W> {
    pub(crate) fn put(&mut self, text: &str) -> io::Result<()> {
        let characters = text.chars().map(u32::from);
        if text.chars().count() > self.width {
            return Err(miscounted(text));
        }
        self.left = self.left.checked_sub(1).ok_or_else(|| miscounted(text))?;
        for character in characters.chain(std::iter::repeat(0)).take(self.width) {
            self.block.extend(character.to_le_bytes());
        }
        if self.block.len() >= BLOCK {
            self.archive.0.write_all(&self.block)?;
            self.block.clear();
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> io::Result<()> {
        match self.left {
            0 => self.archive.0.write_all(&self.block),
            _ => Err(miscounted("a text")),
        }
    }
}

/// The header of version 1.0, padded so that the numbers begin at a multiple of 64 bytes.
fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let mut extents = String::new();
    for extent in shape {
        // Writing to a String cannot fail.
        let _ = write!(extents, "{extent}, ");
    }
    let extents = if shape.len() == 1 { extents.trim_end() } else { extents.trim_end_matches(", ") };
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({extents}), }}");
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.push_str(&" ".repeat(length - 1 - text.len()));
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

fn miscounted(name: &str) -> io::Error {
    io::Error::new(
        io::ErrorKind::InvalidInput,
        format!("{name}: an array with another number of items than its shape says"),
    )
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::{ArrayError, NpzReader};

    #[test]
    fn what_is_written_is_read() {
        let mut bytes = Vec::new();
        let mut archive = NpzWriter::new(&mut bytes);
        let many: Vec<f64> = (0..20_000).map(|i| f64::from(i).sqrt()).collect();
        archive.numbers("many", &[100, 200], many.iter().copied()).unwrap();
        archive.whole("whole", &[3], [-1, 0, i64::MAX >> 11]).unwrap();
        archive.truth("truth", &[2], [true, false]).unwrap();
        archive.text("text", &[1], ["blade"]).unwrap();
        archive.numbers("none", &[0, 3], []).unwrap();
        archive.finish().unwrap();

        let mut archive = NpzReader::open(Cursor::new(&bytes)).unwrap();
        assert_eq!(archive.names(), ["many", "whole", "truth", "text", "none"]);
        let read = archive.read("many", |array| Ok((array.shape().to_vec(), array.values(0)?))).unwrap();
        assert_eq!(read, (vec![100, 200], many));
        let mut vector = |name: &str| archive.read(name, |array| array.values(0)).unwrap();
        assert_eq!(vector("whole"), [-1.0, 0.0, (i64::MAX >> 11) as f64]);
        assert_eq!(vector("truth"), [1.0, 0.0]);
        assert!(vector("none").is_empty());
        assert_eq!(archive.read("text", |array| array.text()).unwrap(), "blade");
        assert!(matches!(archive.read("other", |_| Ok(())), Err(ArrayError::Content(_))));
    }

    #[test]
    fn a_wrong_count_is_refused() {
        let mut archive = NpzWriter::new(Vec::new());
        assert!(archive.numbers("few", &[3], [1.0]).is_err());
        let mut archive = NpzWriter::new(Vec::new());
        assert!(archive.numbers("many", &[1], [1.0, 2.0]).is_err());
    }

    #[test]
    fn headers_have_the_form_of_python() {
        let text =
            |shape: &[usize]| String::from_utf8_lossy(&header("<f8", shape)[10..]).trim_end().to_owned();
        assert_eq!(text(&[]), "{'descr': '<f8', 'fortran_order': False, 'shape': (), }");
        assert_eq!(text(&[3]), "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }");
        assert_eq!(text(&[3, 4]), "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }");
        assert_eq!(header("<f8", &[3, 4]).len() % 64, 0);
    }
}
