//! What the loops do not tell about the laws, or where they do not agree with them.

use std::fmt;

use crate::error::ParameterError;
use crate::scaling::{MagnitudeLaw, PhaseLaw};

use super::separable::Observation;
use super::student::t95;
use super::{Parameter, Weighting};

/// Which of the two laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// g(α), eq. (6).
    Magnitude,
    /// ψ_C(α), eq. (7).
    Phase,
}

/// A remark about an identification: nothing that forbids its use, except [`Note::NotPassive`], and all that a
/// careful engineer would want to hear.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Three amplitudes for three numbers.
    ExactlyDetermined {
        /// Number of loops; more than three only where amplitudes repeat.
        loops: usize,
        /// Where errors come from.
        weighting: Weighting,
    },
    /// Errors from few degrees of freedom.
    FewLoops {
        /// n − 3.
        freedom: usize,
    },
    /// The amplitudes lie close together.
    NarrowRange {
        /// Largest over smallest.
        ratio: f64,
    },
    /// The smallest loop is too large for this parameter.
    NoSmallLoop {
        /// `shift` or `span`.
        parameter: Parameter,
        /// Smallest α.
        smallest: f64,
        /// The α below which a loop would tell.
        needed: f64,
    },
    /// The largest loop is too small to see the phase's limit.
    NoLargeLoop {
        /// Largest α.
        largest: f64,
        /// The α above which a loop would tell.
        needed: f64,
    },
    /// The best value lies at the end of the range that was searched.
    AtBound {
        /// Which.
        parameter: Parameter,
        /// The end.
        value: f64,
        /// Whether it is the lower one.
        lower: bool,
    },
    /// The sum of squares is flat: it never rises enough to exclude values at the end of the search.
    Unbounded {
        /// Which.
        parameter: Parameter,
        /// Down to the smallest values.
        below: bool,
        /// Up to the largest values.
        above: bool,
    },
    /// Another value fits about as well.
    SeveralMinima {
        /// Which.
        parameter: Parameter,
        /// The best.
        value: f64,
        /// The other.
        other: f64,
    },
    /// The three numbers of a law cannot be told apart.
    Undetermined {
        /// Which law.
        law: Law,
    },
    /// The standard error is larger than the value.
    Uncertain {
        /// Which.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// Its standard error.
        std_error: f64,
    },
    /// The 95 % interval reaches values that are not allowed.
    IncludesBound {
        /// Which.
        parameter: Parameter,
        /// Lower end of its interval, zero or below.
        lower: f64,
    },
    /// The loops scatter about the law by more than their noise.
    Misfit {
        /// Which law.
        law: Law,
        /// Residuals over noise, root mean square.
        ratio: f64,
    },
    /// The law would create energy: no contact can be built from it.
    NotPassive(ParameterError),
}

/// Amplitudes that span less than this ratio are close together.
const NARROW: f64 = 4.0;

/// What the number of loops and of different amplitudes cannot tell.
pub(super) fn of_count(loops: usize, amplitudes: usize, weighting: Weighting) -> Vec<Note> {
    let mut notes = Vec::new();
    let freedom = loops.saturating_sub(3);
    if amplitudes == 3 {
        notes.push(Note::ExactlyDetermined { loops, weighting });
    }
    if (1..=2).contains(&freedom) {
        notes.push(Note::FewLoops { freedom });
    }
    notes
}

/// What the amplitudes cannot tell; `observations` ascend in α. A shift that rests `at_bound` has its own note.
pub(super) fn of_range(
    observations: &[Observation],
    magnitude: &MagnitudeLaw,
    at_bound: bool,
    phase: &PhaseLaw,
) -> Vec<Note> {
    let mut notes = Vec::new();
    let (Some(first), Some(last)) = (observations.first(), observations.last()) else { return notes };
    let (smallest, largest) = (first.alpha, last.alpha);
    if largest < NARROW * smallest {
        notes.push(Note::NarrowRange { ratio: largest / smallest });
    }
    // At α = 3 shift, the shift is worth 0.29 slope; it should be seen well above the noise.
    if smallest > 3.0 * magnitude.shift && !at_bound {
        let needed = 3.0 * magnitude.shift;
        notes.push(Note::NoSmallLoop { parameter: Parameter::Shift, smallest, needed });
    }
    // At α = 1/decay, the phase is span/e below its limit.
    let needed = 1.0 / phase.decay;
    if smallest > needed {
        notes.push(Note::NoSmallLoop { parameter: Parameter::Span, smallest, needed });
    }
    if largest < needed {
        notes.push(Note::NoLargeLoop { largest, needed });
    }
    notes
}

pub(super) fn not_passive(refused: Option<ParameterError>) -> Option<Note> {
    refused.map(Note::NotPassive)
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Magnitude => "g(α)",
            Self::Phase => "ψ_C(α)",
        })
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ExactlyDetermined { loops, weighting } => write!(
                f,
                "{loops} loops of three amplitudes determine the three numbers of each law exactly: a law that passes through them is not \
                 tested by them, and {}",
                match (weighting, loops) {
                    (Weighting::Noise, _) => "the errors are those of the noise alone",
                    (Weighting::Equal, 3) => "there are no errors",
                    (Weighting::Equal, _) => "the errors only say how well loops repeat",
                }
            ),
            Self::FewLoops { freedom } => write!(
                f,
                "the scatter was estimated with {freedom} degree{} of freedom only: a 95 % interval is {:.1} standard errors to each side",
                if *freedom == 1 { "" } else { "s" },
                t95(*freedom)
            ),
            Self::NarrowRange { ratio } => write!(
                f,
                "the largest amplitude is only {ratio:.2} times the smallest: logarithm, exponential and straight line hardly differ over it"
            ),
            Self::NoSmallLoop { parameter: Parameter::Shift, smallest, needed } => write!(
                f,
                "no loop is small enough to show the shift: the smallest has α = {smallest:.3}, the shift matters below {needed:.2e}; \
                 g near zero, and so the holding force, is extrapolated"
            ),
            Self::NoSmallLoop { parameter, smallest, needed } => write!(
                f,
                "no loop is small enough to show the {parameter}: the smallest has α = {smallest:.3}, where the exponential, which falls \
                 by e every {needed:.2e}, has mostly gone; the phase near zero is extrapolated"
            ),
            Self::NoLargeLoop { largest, needed } => write!(
                f,
                "no loop is large enough to show the limit of the phase: the largest has α = {largest:.3}, the exponential falls by e \
                 every {needed:.2e}; beyond the largest loop the phase is extrapolated"
            ),
            Self::AtBound { parameter, value, lower } => write!(
                f,
                "the fit gets better the {} the {parameter} becomes, as far as was searched ({value:.2e}): {}; the numbers of this law \
                 have no errors",
                if *lower { "smaller" } else { "larger" },
                match (parameter, lower) {
                    (Parameter::Shift, true) =>
                        "the loops follow ln α without a shift, or bend more than that",
                    (Parameter::Decay, false) =>
                        "only the smallest loop departs from the limit, or the phase jumps more than that",
                    _ =>
                        "the loops follow a straight line over α, or bend the other way, which the law cannot",
                }
            ),
            Self::Unbounded { parameter, below, above } => write!(
                f,
                "the loops leave the {parameter} open {towards}: its standard error, and those of the numbers it goes with, tell too little",
                towards = match (below, above) {
                    (true, true) => "on both sides",
                    (true, false) => "towards zero",
                    _ => "upwards",
                }
            ),
            Self::SeveralMinima { parameter, value, other } => write!(
                f,
                "two laws fit about as well: {parameter} = {value:.4e}, which is reported, and {other:.4e}; a loop at another amplitude would decide"
            ),
            Self::Undetermined { law } => {
                write!(f, "the loops do not tell the three numbers of {law} apart, so they have no errors")
            }
            Self::Uncertain { parameter, value, std_error } => {
                write!(f, "the {parameter} is {value:.2e} with the larger standard error {std_error:.2e}")
            }
            Self::IncludesBound { parameter, lower } => write!(
                f,
                "the 95 % interval of the {parameter} begins at {lower:.2e}, but it must be positive"
            ),
            Self::Misfit { law, ratio } => write!(
                f,
                "the loops scatter about {law} by {ratio:.0} times their noise: the law only approximates them, or loops do not repeat; errors from noise \
                 alone would be too small"
            ),
            Self::NotPassive(refused) => write!(f, "no contact can be built from this law: {refused}"),
        }
    }
}
