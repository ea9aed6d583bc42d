//! Tables: named columns and rows that are made anew for every pass, so that a long table needs no memory.

use std::borrow::Cow;
use std::io::{self, Write};

use crate::npz_writer::NpzWriter;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Numbers, written with a power of ten where they are text.
    Number,
    /// Numbers, written without one.
    Plain,
    /// Counts.
    Whole,
    /// True or not.
    Truth,
    /// Text.
    Text,
}

/// A cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'c> {
    /// There is nothing.
    Missing,
    /// In a column of numbers.
    Number(f64),
    /// In a column of counts.
    Whole(usize),
    /// In a column of truth values.
    Truth(bool),
    /// In a column of text.
    Text(&'c str),
}

impl From<Option<f64>> for Cell<'_> {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Missing, Self::Number)
    }
}

/// Takes one row: a cell a column.
pub type TakeRow<'t> = dyn FnMut(&[Cell<'_>]) -> io::Result<()> + 't;

type MakeRows<'t> = dyn Fn(&mut TakeRow<'_>) -> io::Result<()> + 't;

/// A table.
pub struct Table<'t> {
    columns: Vec<(Cow<'t, str>, Kind)>,
    rows: Box<MakeRows<'t>>,
}

impl<'t> Table<'t> {
    /// A table whose rows `rows` hands over, the same ones in every pass, each with a cell a column of that column's kind.
    pub fn new<N: Into<Cow<'t, str>>>(
        columns: impl IntoIterator<Item = (N, Kind)>,
        rows: impl Fn(&mut TakeRow<'_>) -> io::Result<()> + 't,
    ) -> Self {
        let columns = columns.into_iter().map(|(name, kind)| (name.into(), kind)).collect();
        Self { columns, rows: Box::new(rows) }
    }

    /// The columns' names and kinds.
    pub fn columns(&self) -> impl Iterator<Item = (&str, Kind)> {
        self.columns.iter().map(|(name, kind)| (name.as_ref(), *kind))
    }

    /// Hands over every row.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn rows(&self, take: &mut TakeRow<'_>) -> io::Result<()> {
        (self.rows)(take)
    }

    /// Hands over the cells of a column.
    fn cells(&self, column: usize, mut take: impl FnMut(Cell<'_>) -> io::Result<()>) -> io::Result<()> {
        self.rows(&mut |row| take(row.get(column).copied().unwrap_or(Cell::Missing)))
    }

    /// Writes it as CSV; cells without a value are empty, truth is 1.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(self.columns.iter().map(|(name, _)| name.as_ref()))?;
        self.rows(&mut |row| {
            for (cell, (_, kind)) in row.iter().zip(&self.columns) {
                match (cell, kind) {
                    (Cell::Missing, _) => table.write_field("")?,
                    (Cell::Number(value), Kind::Number) => table.write_field(format!("{value:e}"))?,
                    (Cell::Number(value), _) => table.write_field(value.to_string())?,
                    (Cell::Whole(value), _) => table.write_field(value.to_string())?,
                    (Cell::Truth(value), _) => table.write_field(if *value { "1" } else { "0" })?,
                    (Cell::Text(text), _) => table.write_field(text)?,
                }
            }
            Ok(table.write_record(None::<&[u8]>)?)
        })?;
        table.flush()
    }

    /// Writes every column as an array of an `.npz` archive: numbers are NaN where there are none, counts −1, texts empty.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_npz<W: Write>(&self, archive: &mut NpzWriter<W>) -> io::Result<()> {
        let mut count = 0;
        let mut widest = vec![0; self.columns.len()];
        self.rows(&mut |row| {
            count += 1;
            for (cell, widest) in row.iter().zip(&mut widest) {
                if let Cell::Text(text) = cell {
                    *widest = text.chars().count().max(*widest);
                }
            }
            Ok(())
        })?;
        for (at, ((name, kind), widest)) in self.columns.iter().zip(widest).enumerate() {
            let shape = [count];
            match kind {
                Kind::Number | Kind::Plain => {
                    let values = self.column(at, count, |cell| match cell {
                        Cell::Number(value) => value,
                        _ => f64::NAN,
                    })?;
                    archive.numbers(name, &shape, values)?;
                }
                Kind::Whole => {
                    let values = self.column(at, count, |cell| match cell {
                        Cell::Whole(value) => i64::try_from(value).unwrap_or(i64::MAX),
                        _ => -1,
                    })?;
                    archive.whole(name, &shape, values)?;
                }
                Kind::Truth => {
                    archive.truth(name, &shape, self.column(at, count, |cell| cell == Cell::Truth(true))?)?
                }
                Kind::Text => {
                    let mut column = archive.text_column(name, &shape, widest)?;
                    self.cells(at, |cell| column.put(if let Cell::Text(text) = cell { text } else { "" }))?;
                    column.finish()?;
                }
            }
        }
        Ok(())
    }

    /// The values of a column.
    fn column<T>(&self, at: usize, count: usize, of: impl Fn(Cell<'_>) -> T) -> io::Result<Vec<T>> {
        let mut values = Vec::with_capacity(count);
        self.cells(at, |cell| {
            values.push(of(cell));
            Ok(())
        })?;
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::NpzReader;

    fn table() -> Table<'static> {
        let columns = [
            ("hertz", Kind::Plain),
            ("re", Kind::Number),
            ("k", Kind::Whole),
            ("fold", Kind::Truth),
            ("dof", Kind::Text),
        ];
        Table::new(columns, |take| {
            take(&[
                Cell::Number(20.5),
                Cell::Number(1e-6),
                Cell::Whole(3),
                Cell::Truth(true),
                Cell::Text("a,b"),
            ])?;
            take(&[Cell::Number(21.0), Cell::Missing, Cell::Missing, Cell::Truth(false), Cell::Missing])
        })
    }

    #[test]
    fn cells_are_text_in_csv() {
        let mut text = Vec::new();
        table().write_csv(&mut text).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "hertz,re,k,fold,dof\n20.5,1e-6,3,1,\"a,b\"\n21,,,0,\n");
    }

    #[test]
    fn columns_are_arrays_in_npz() {
        let mut bytes = Vec::new();
        let mut archive = NpzWriter::new(&mut bytes);
        table().write_npz(&mut archive).unwrap();
        archive.finish().unwrap();
        let mut archive = NpzReader::open(Cursor::new(&bytes)).unwrap();
        let mut column = |name: &str| archive.read(name, |array| array.values(0)).unwrap();
        assert_eq!(column("hertz"), [20.5, 21.0]);
        assert_eq!(column("re")[0], 1e-6);
        assert!(column("re")[1].is_nan());
        assert_eq!(column("k"), [3.0, -1.0]);
        assert_eq!(column("fold"), [1.0, 0.0]);
    }
}
