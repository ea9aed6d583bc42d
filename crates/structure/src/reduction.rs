//! What is asked of a reduction, and what comes out.

use thiserror::Error;

use crate::error::ModelError;
use crate::model::Model;

/// How many modes a reduction keeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeCount {
    /// All up to 1.5 times the highest frequency, and as many static shapes for the inertia of the others as it takes
    /// until the estimated error is at most `tolerance`.
    Automatic {
        /// Relative error of the response of the kept dofs, see [`Reduction::error`].
        tolerance: f64,
    },
    /// The lowest so many, or all if there are fewer.
    Exactly(usize),
}

/// What a reduction is made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionOptions {
    /// How many modes to keep.
    pub modes: ModeCount,
    /// Lowest frequency of the response in Hz.
    pub lowest: f64,
    /// Highest frequency of the response in Hz, harmonics included.
    pub highest: f64,
}

/// A structure reduced onto some of its dofs.
#[derive(Debug, Clone)]
pub struct Reduction {
    /// The reduced structure: first the kept dofs in the order they were given, then one coordinate a mode
    /// or static shape.
    pub model: Model,
    /// Number of modes, static shapes for the inertia of further modes included.
    pub modes: usize,
    /// Natural frequencies in Hz of the structure with the kept dofs held, of its modes alone, ascending. Zero for a motion
    /// without stiffness.
    pub fixed_frequencies: Vec<f64>,
    /// Shift in rad²/s² of the constraint modes: zero, or negative when the structure with the kept dofs held is not
    /// fixed. The response is exact at this square of the angular frequency, whatever the number of modes.
    pub shift: f64,
    /// Largest of the errors in `checked_at`, an estimate; `None` when nothing was left to check: no inner dofs, or no
    /// kept ones.
    /// It may be above the tolerance asked for: then further modes did not help, or the reduced structure is at its
    /// largest size.
    pub error: Option<f64>,
    /// Where the reduced structure was compared with the full one: frequency in Hz and relative error.
    pub checked_at: Vec<(f64, f64)>,
}

/// What a reduction is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Ordering and factorising the stiffness of the inner dofs.
    Factorising,
    /// Static shapes of the kept dofs.
    ConstraintModes,
    /// Looking for modes.
    Modes {
        /// So many are there.
        found: usize,
        /// So many are wanted.
        of: usize,
    },
    /// Comparing with the full structure.
    Checking {
        /// Frequencies that are compared.
        done: usize,
        /// Frequencies to compare.
        of: usize,
    },
}

/// Why a structure could not be reduced.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReductionError {
    /// A kept dof that the structure does not have.
    #[error("dof {dof} cannot be kept: the structure has dofs 0 to {last}", last = dofs - 1)]
    NoSuchDof {
        /// The dof.
        dof: usize,
        /// Dofs of the structure.
        dofs: usize,
    },
    /// A dof that is kept twice.
    #[error("dof {dof} is kept twice")]
    KeptTwice {
        /// The dof.
        dof: usize,
    },
    /// A base load that does not fit.
    #[error("base load {index} must have one finite number for each of {dofs} dofs")]
    BaseLoad {
        /// Which one, counted from zero.
        index: usize,
        /// Dofs of the structure.
        dofs: usize,
    },
    /// A band or a tolerance that is none.
    #[error("{0}")]
    Options(String),
    /// The stiffness of the inner dofs has negative eigenvalues, or is none.
    #[error(
        "with the kept dofs held, the structure is unstable or singular even with a shift: is its stiffness positive \
         semidefinite, and does every dof have stiffness or mass?"
    )]
    Singular,
    /// Modes that the iteration did not find.
    #[error("only {found} of {of} modes were found")]
    Modes {
        /// Modes found.
        found: usize,
        /// Modes that there are.
        of: usize,
    },
    /// A structure too large to be reduced here.
    #[error("the reduction does not fit into memory: its factors and shapes take {gigabytes:.1} GB")]
    TooLarge {
        /// Memory that would be needed.
        gigabytes: f64,
    },
    /// Memory was refused.
    #[error("not enough memory")]
    Memory,
    /// Matrices that are no structure.
    #[error(transparent)]
    Model(#[from] ModelError),
}
