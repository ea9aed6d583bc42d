//! What can be wrong with the file of a record, where, and what to try.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::channel_error::ChannelError;
use crate::options::Column;
use crate::record::Quantity;
use crate::units::UnknownUnit;

/// Why a file is no record. Lines and columns are counted from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file could not be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Something is wrong inside a file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong there.
        source: Box<RecordError>,
    },
    /// The arrays or datasets of a file make no record.
    #[error(transparent)]
    Channel(#[from] ChannelError),
    /// There is no line of numbers.
    #[error(
        "there are no samples: expected a header such as `displacement [um],force [N]` and one line of numbers a sample"
    )]
    Empty,
    /// Neither a header nor the caller says which column is which.
    #[error(
        "line {line} already holds numbers, so no header says which column holds the {quantity}; give the numbers of the columns \
         (1 is the first) and their units, as in --columns displacement=1,force=2 --units displacement=um,force=N, \
         or \"columns\" and \"units\" in a scene"
    )]
    NoHeader {
        /// First line of numbers.
        line: usize,
        /// The quantity whose column is unknown.
        quantity: Quantity,
    },
    /// No column of the header looks like the quantity.
    #[error(
        "line {line}: no column of the header looks like a {quantity} (found {found}); say which it is, as in --columns {quantity}=2"
    )]
    ColumnMissing {
        /// The header's line.
        line: usize,
        /// The quantity without a column.
        quantity: Quantity,
        /// The header's columns.
        found: String,
    },
    /// Several columns could hold the quantity.
    #[error(
        "line {line}: columns {candidates} could each be the {quantity}; say which it is, as in --columns {quantity}={first}"
    )]
    ColumnAmbiguous {
        /// The header's line.
        line: usize,
        /// The quantity.
        quantity: Quantity,
        /// The columns that could hold it.
        candidates: String,
        /// Number of the first of them.
        first: usize,
    },
    /// The column asked for does not exist.
    #[error("there is no column {wanted} for the {quantity}; the file has {found}")]
    ColumnUnknown {
        /// The quantity.
        quantity: Quantity,
        /// The column asked for.
        wanted: Column,
        /// What the file has.
        found: String,
    },
    /// Two quantities are to come from the same column.
    #[error(
        "column {column} would be both the {first} and the {second}; say which column is which with --columns"
    )]
    ColumnTwice {
        /// The column's number.
        column: usize,
        /// One quantity.
        first: Quantity,
        /// The other.
        second: Quantity,
    },
    /// A column has no unit.
    #[error(
        "column {column} ({quantity}) has no unit; write it into the header in brackets, as in `{quantity} [{example}]`, \
         or give it, as in --units {quantity}={example}"
    )]
    UnitMissing {
        /// The column's number.
        column: usize,
        /// The quantity.
        quantity: Quantity,
        /// A unit of that quantity.
        example: &'static str,
    },
    /// A column has a unit that is not known, or is no unit of this quantity.
    #[error(
        "column {column} ({quantity}): {source}; the header's unit can be overruled, as in --units {quantity}={example}"
    )]
    UnitUnknown {
        /// The column's number.
        column: usize,
        /// The quantity.
        quantity: Quantity,
        /// What was found and what is known.
        source: UnknownUnit,
        /// A unit of that quantity.
        example: &'static str,
    },
    /// A cell is not a number.
    #[error("line {line}, column {column} ({quantity}): `{text}` is not a number{hint}")]
    NotANumber {
        /// Line of the cell.
        line: usize,
        /// Column of the cell.
        column: usize,
        /// What it should hold.
        quantity: Quantity,
        /// What it holds.
        text: String,
        /// What might have happened.
        hint: &'static str,
    },
    /// A cell holds NaN or infinity.
    #[error(
        "line {line}, column {column} ({quantity}): `{text}` is not a finite number; \
         cut the record there or repair the sample, a gap cannot be averaged away"
    )]
    NotFinite {
        /// Line of the cell.
        line: usize,
        /// Column of the cell.
        column: usize,
        /// What it should hold.
        quantity: Quantity,
        /// What it holds.
        text: String,
    },
    /// A line has too few cells.
    #[error(
        "line {line} has {found} column{s}, but the {quantity} is in column {needed}; is the line cut off, or is another delimiter meant?",
        s = if *found == 1 { "" } else { "s" }
    )]
    ShortLine {
        /// The line.
        line: usize,
        /// How many cells it has.
        found: usize,
        /// The column that is missing.
        needed: usize,
        /// What it should hold.
        quantity: Quantity,
    },
    /// Time runs backwards.
    #[error(
        "line {line}, column {column} (time): time goes back from {before} to {after}; \
         were several records joined? Keep one of them"
    )]
    TimeBackwards {
        /// Line of the earlier time.
        line: usize,
        /// Column of the time.
        column: usize,
        /// Time of the sample before, as in the file.
        before: f64,
        /// Time of this sample, as in the file.
        after: f64,
    },
    /// The vectors of a record differ in length.
    #[error(
        "a record needs as many forces as displacements (and times), got {displacement} displacements, {force} forces and {time:?} times"
    )]
    Lengths {
        /// Number of times, if any.
        time: Option<usize>,
        /// Number of displacements.
        displacement: usize,
        /// Number of forces.
        force: usize,
    },
}
