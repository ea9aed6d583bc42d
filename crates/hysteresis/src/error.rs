//! What can be wrong with a record, a fit or a loop, and what to try.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

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

/// Why a record is not a friction hysteresis loop.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too few samples.
    #[error("{found} sample{s} cannot make a loop; at least {needed} are needed, well over twenty a cycle are good",
            s = if *found == 1 { "" } else { "s" })]
    TooFewSamples {
        /// Number of samples in the record or its steady cycle.
        found: usize,
        /// Number needed.
        needed: usize,
    },
    /// A sample is NaN or infinite.
    #[error("{place}: the {quantity} is not a finite number; cut the record there or repair the sample")]
    NotFinite {
        /// Where.
        place: String,
        /// What.
        quantity: Quantity,
    },
    /// The vectors of the record differ in length.
    #[error("the record's vectors differ in length: {displacement} displacements, {force} forces")]
    Lengths {
        /// Number of displacements.
        displacement: usize,
        /// Number of forces.
        force: usize,
    },
    /// A quantity does not change.
    #[error(
        "the {quantity} is constant ({value:e} in SI units) from the first sample to the last; is this the right column?"
    )]
    Constant {
        /// Which quantity.
        quantity: Quantity,
        /// Its value [m or N].
        value: f64,
    },
    /// The curve does not close.
    #[error(
        "the curve is open: {reason}. A loop needs a whole cycle, from one turning point to the other and back"
    )]
    OpenCurve {
        /// In which way.
        reason: String,
    },
    /// The amplitude never settles.
    #[error(
        "no cycle is steady: the branches between turning points have half heights {heights} µm, no two in a row within {tolerance} %. \
         Cut the record to its steady part, or allow a larger steady tolerance"
    )]
    NotSteady {
        /// The half heights in micrometres, in order.
        heights: String,
        /// The tolerance [%].
        tolerance: f64,
    },
    /// The loop runs the wrong way round.
    #[error(
        "the force does {work:.3e} J a cycle, as if friction drove the motion: it is the specimen's reaction rather than the rig's force, \
         or displacement and force are swapped. Turn its sign with --flip-force (\"force_sign\": -1 in a scene)"
    )]
    AgainstMotion {
        /// `∮ f dw` of the steady cycle [J], negative.
        work: f64,
    },
    /// The curve encloses no area.
    #[error(
        "the curve encloses no area: |∮ f dw| = {work:.1e} J a cycle is not above its own uncertainty of {uncertainty:.1e} J. \
         This is a spring, or friction lost in noise"
    )]
    NoArea {
        /// `∮ f dw` [J].
        work: f64,
        /// What noise can make of it [J].
        uncertainty: f64,
    },
    /// A setting makes no sense.
    #[error("the setting {name} must be {must}, got {value}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// What it must be.
        must: &'static str,
        /// What it is.
        value: f64,
    },
    /// The fitted series is no loop.
    #[error(transparent)]
    Loop(#[from] LoopError),
}

/// Why a Fourier series is not a friction hysteresis loop.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LoopError {
    /// The displacement amplitude is not a positive finite number.
    #[error("the displacement amplitude must be positive and finite, got {0} m")]
    Amplitude(f64),
    /// A coefficient is NaN or infinite.
    #[error("harmonic {0} of the force is not finite")]
    NotFinite(usize),
    /// The mean force has an imaginary part.
    #[error("the mean force, harmonic 0, must be real, got imaginary part {0}")]
    MeanNotReal(f64),
    /// There is no first harmonic.
    #[error("harmonic 1 of the force is missing or zero; without it nothing can be scaled")]
    NoFirstHarmonic,
    /// The loop would create energy.
    #[error(
        "harmonic 1 of the force has imaginary part {imaginary} N, so the loop would dissipate {dissipation:e} J a cycle; friction takes \
         energy out. A measured loop needs a positive one: turn the sign of the force"
    )]
    CreatesEnergy {
        /// Im F_1 [N].
        imaginary: f64,
        /// π a Im F_1 [J].
        dissipation: f64,
    },
}
