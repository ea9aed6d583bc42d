//! What can be wrong with the channels of a file that is no text table, and what to try.

use thiserror::Error;

use crate::options::Column;
use crate::record::Quantity;
use crate::units::UnknownUnit;

/// Why the arrays or datasets of a file make no record.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ChannelError {
    /// The file itself is damaged or of a kind that is not read.
    #[error("{0}")]
    File(String),
    /// Nothing in the file looks like the quantity.
    #[error(
        "nothing in the file looks like a {quantity} (found {found}); say what it is, as in --columns {quantity}={example}"
    )]
    Missing {
        /// The quantity.
        quantity: Quantity,
        /// What the file has.
        found: String,
        /// A name in it.
        example: String,
    },
    /// Several things could be the quantity.
    #[error(
        "{candidates} could each be the {quantity}; say which it is, as in --columns {quantity}={example}"
    )]
    Ambiguous {
        /// The quantity.
        quantity: Quantity,
        /// What it could be.
        candidates: String,
        /// One of them.
        example: String,
    },
    /// What was asked for is not in the file.
    #[error("there is no column {wanted} for the {quantity}; the file has {found}")]
    Unknown {
        /// The quantity.
        quantity: Quantity,
        /// What was asked for.
        wanted: Column,
        /// What the file has.
        found: String,
    },
    /// Two quantities are to come from the same place.
    #[error("{channel} would be both the {first} and the {second}; say which is which with --columns")]
    Twice {
        /// The place.
        channel: String,
        /// One quantity.
        first: Quantity,
        /// The other.
        second: Quantity,
    },
    /// What was chosen holds no numbers over time.
    #[error("{channel} cannot be the {quantity}: {problem}")]
    Unfit {
        /// What was chosen.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// What is wrong.
        problem: String,
    },
    /// There is no unit.
    #[error(
        "{channel} ({quantity}) has no unit; give it, as in --units {quantity}={example}, or \"units\" in a scene"
    )]
    UnitMissing {
        /// What was chosen.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// A unit of that quantity.
        example: &'static str,
    },
    /// The file has a unit that is not known, or is no unit of this quantity.
    #[error(
        "{channel} ({quantity}): {source}; the file's unit can be overruled, as in --units {quantity}={example}"
    )]
    UnitUnknown {
        /// What was chosen.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// What was found and what is known.
        source: UnknownUnit,
        /// A unit of that quantity.
        example: &'static str,
    },
    /// The numbers of samples differ.
    #[error(
        "{channel} ({quantity}) has {found} samples, but the displacement has {expected}; they must be sampled together"
    )]
    Lengths {
        /// What was chosen.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// Its samples.
        found: usize,
        /// Those of the displacement.
        expected: usize,
    },
    /// A sample is NaN or infinite.
    #[error(
        "{channel} ({quantity}), sample {sample}: {value} is not a finite number in its unit; cut the record there or repair the \
         sample, a gap cannot be averaged away"
    )]
    NotFinite {
        /// What was chosen.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// Counted from 1.
        sample: usize,
        /// What it holds.
        value: f64,
    },
    /// Time runs backwards.
    #[error(
        "{channel} (time), sample {sample}: time goes back from {before} to {after}; were several records joined? Keep one \
         of them"
    )]
    TimeBackwards {
        /// What was chosen.
        channel: String,
        /// Sample of the later time, counted from 1.
        sample: usize,
        /// Time of the sample before, as in the file.
        before: f64,
        /// Time of this sample, as in the file.
        after: f64,
    },
    /// Displacement and force of datasets with different times.
    #[error(
        "{displacement} and {force} were not sampled at the same instants; they must be sampled together"
    )]
    Instants {
        /// Where the displacement is from.
        displacement: String,
        /// Where the force is from.
        force: String,
    },
}
