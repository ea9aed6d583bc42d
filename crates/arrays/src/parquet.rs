//! Tables as Parquet, for data frames: optional columns in one row group, plain values in pages compressed by gzip.
//!
//! Source: Apache Parquet, "File Format" with `parquet.thrift`: the magic text, the pages of one column after the other, each with a
//! header, then the metadata (schema, where each column lies, keys and values), their length, the magic text. A reader for every
//! feature of the format is a large program; what a table needs to be written is this file.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::table::{Cell, Kind, Table};
use crate::thrift::{Struct, varint};

const MAGIC: &[u8] = b"PAR1";

/// Rows of a page.
const PAGE: usize = 1 << 16;

const BOOLEAN: i32 = 0;
const INT64: i32 = 2;
const DOUBLE: i32 = 5;
const BYTE_ARRAY: i32 = 6;
const OPTIONAL: i32 = 1;
const UTF8: i32 = 0;
const PLAIN: i32 = 0;
const RLE: i32 = 3;
const GZIP: i32 = 2;

impl Table<'_> {
    /// Writes it as Parquet with `about` as keys and values of the file; cells without a value are null.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_parquet(&self, out: impl Write, about: &[(&str, &str)]) -> io::Result<()> {
        let mut out = Counting { out, written: 0 };
        out.put(MAGIC)?;
        let columns: Vec<(&str, Kind)> = self.columns().collect();
        let mut chunks = Vec::new();
        let mut rows = 0;
        for (at, (name, kind)) in columns.iter().enumerate() {
            let chunk = write_column(self, at, *kind, &mut out)?;
            rows = chunk.rows;
            chunks.push(chunk.metadata(name, *kind));
        }
        let all = out.written;
        let element = |(name, kind): &(&str, Kind)| {
            let element = Struct::default().i32(1, physical(*kind)).i32(3, OPTIONAL).text(4, name);
            // Text is UTF-8 in both the older and the newer way to say so.
            let text = *kind == Kind::Text;
            if text {
                element.i32(6, UTF8).part(10, Struct::default().part(1, Struct::default()))
            } else {
                element
            }
        };
        let root = Struct::default().text(4, "table").i32(5, columns.len() as i32);
        let schema = std::iter::once(root).chain(columns.iter().map(element));
        let group = Struct::default().parts(1, chunks).i64(2, all as i64).i64(3, rows as i64);
        let pairs = about.iter().map(|(key, value)| Struct::default().text(1, key).text(2, value));
        let metadata = Struct::default()
            .i32(1, 1)
            .parts(2, schema)
            .i64(3, rows as i64)
            .parts(4, [group])
            .parts(5, pairs)
            .text(6, concat!("stickslip version ", env!("CARGO_PKG_VERSION")))
            .end();
        out.put(&metadata)?;
        out.put(&(metadata.len() as u32).to_le_bytes())?;
        out.put(MAGIC)?;
        out.out.flush()
    }
}

fn physical(kind: Kind) -> i32 {
    match kind {
        Kind::Number | Kind::Plain => DOUBLE,
        Kind::Whole => INT64,
        Kind::Truth => BOOLEAN,
        Kind::Text => BYTE_ARRAY,
    }
}

/// Knows how much was written.
struct Counting<W> {
    out: W,
    written: u64,
}

impl<W: Write> Counting<W> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.written += bytes.len() as u64;
        self.out.write_all(bytes)
    }
}

/// Where a column lies.
#[derive(Debug, Default)]
struct Chunk {
    begin: u64,
    rows: usize,
    plain_size: usize,
    size: usize,
}

impl Chunk {
    fn metadata(&self, name: &str, kind: Kind) -> Struct {
        let column = Struct::default()
            .i32(1, physical(kind))
            .i32s(2, &[PLAIN, RLE])
            .texts(3, &[name])
            .i32(4, GZIP)
            .i64(5, self.rows as i64)
            .i64(6, self.plain_size as i64)
            .i64(7, self.size as i64)
            .i64(9, self.begin as i64);
        Struct::default().i64(2, self.begin as i64).part(3, column)
    }
}

fn write_column(table: &Table, at: usize, kind: Kind, out: &mut Counting<impl Write>) -> io::Result<Chunk> {
    let mut chunk = Chunk { begin: out.written, ..Chunk::default() };
    let mut page = Page::default();
    table.rows(&mut |row| {
        page.push(row.get(at).copied().unwrap_or(Cell::Missing), kind);
        if page.defined.len() == PAGE {
            std::mem::take(&mut page).write(out, &mut chunk)?;
        }
        Ok(())
    })?;
    // A table without rows has a page without values.
    if !page.defined.is_empty() || chunk.rows == 0 {
        page.write(out, &mut chunk)?;
    }
    Ok(chunk)
}

/// Some rows of a column.
#[derive(Debug, Default)]
struct Page {
    /// Whether each row has a value.
    defined: Vec<bool>,
    /// The values that there are.
    values: Vec<u8>,
    /// How many of them.
    count: usize,
}

impl Page {
    fn push(&mut self, cell: Cell, kind: Kind) {
        let defined = match (cell, kind) {
            (Cell::Number(value), Kind::Number | Kind::Plain) if !value.is_nan() => {
                self.values.extend(value.to_le_bytes());
                true
            }
            (Cell::Whole(value), Kind::Whole) => {
                self.values.extend(i64::try_from(value).unwrap_or(i64::MAX).to_le_bytes());
                true
            }
            // Eight a byte, the lowest bit first.
            (Cell::Truth(value), Kind::Truth) => {
                if self.count.is_multiple_of(8) {
                    self.values.push(0);
                }
                if let Some(last) = self.values.last_mut() {
                    *last |= u8::from(value) << (self.count % 8);
                }
                true
            }
            (Cell::Text(text), Kind::Text) => {
                self.values.extend((text.len() as u32).to_le_bytes());
                self.values.extend(text.as_bytes());
                true
            }
            _ => false,
        };
        self.count += usize::from(defined);
        self.defined.push(defined);
    }

    fn write(self, out: &mut Counting<impl Write>, chunk: &mut Chunk) -> io::Result<()> {
        // Which rows have a value, as runs: their length and kind.
        let mut levels = Vec::new();
        for run in self.defined.chunk_by(|a, b| a == b) {
            varint(&mut levels, (run.len() as u64) << 1);
            levels.push(u8::from(run.first() == Some(&true)));
        }
        let mut plain = (levels.len() as u32).to_le_bytes().to_vec();
        plain.extend(levels);
        plain.extend(self.values);
        let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
        gzip.write_all(&plain)?;
        let data = gzip.finish()?;
        let page = Struct::default().i32(1, self.defined.len() as i32).i32(2, PLAIN).i32(3, RLE).i32(4, RLE);
        let size = |bytes: &[u8]| {
            i32::try_from(bytes.len()).map_err(|_| io::Error::other("a page of a table is too large"))
        };
        let header =
            Struct::default().i32(1, 0).i32(2, size(&plain)?).i32(3, size(&data)?).part(5, page).end();
        out.put(&header)?;
        out.put(&data)?;
        chunk.rows += self.defined.len();
        chunk.plain_size += header.len() + plain.len();
        chunk.size += header.len() + data.len();
        Ok(())
    }
}
