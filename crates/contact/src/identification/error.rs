//! Why the laws cannot be identified.

use thiserror::Error;

/// Loops from which no scaling law can be identified.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// Too few amplitudes for three numbers a law.
    #[error(
        "each scaling law has three numbers, so at least three different amplitudes are needed (four for errors, six or more are good), \
         but the {loops} loop{s} given {have} {amplitudes}",
        s = if *loops == 1 { "" } else { "s" },
        have = if *loops == 1 { "has" } else { "have" }
    )]
    TooFewAmplitudes {
        /// Number of loops.
        loops: usize,
        /// Number of different amplitudes among them.
        amplitudes: usize,
    },
    /// A loop with numbers that cannot be.
    #[error("loop {number}: its {quantity} must be {must}, got {value}", number = index + 1)]
    BadLoop {
        /// Its place in the list, from 0.
        index: usize,
        /// Which number.
        quantity: &'static str,
        /// What it must be.
        must: &'static str,
        /// What it is \[SI\].
        value: f64,
    },
    /// Weights from noise, but a loop has none.
    #[error(
        "loop {number} has no measured noise to be weighted by; let all loops count the same instead",
        number = index + 1
    )]
    UnknownNoise {
        /// Its place in the list, from 0.
        index: usize,
    },
    /// The reference is none of the loops.
    #[error("the reference must be one of the {loops} loops, got number {number}", number = index + 1)]
    NoSuchReference {
        /// Its place in the list, from 0.
        index: usize,
        /// Number of loops.
        loops: usize,
    },
}
