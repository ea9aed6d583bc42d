//! What can be wrong with a record's curve or a loop's series, and what to try.

use thiserror::Error;

use crate::record::Quantity;

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
        /// Its value \[m or N\].
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
        /// The tolerance \[%\].
        tolerance: f64,
    },
    /// The loop runs the wrong way round.
    #[error(
        "the force does {work:.3e} J a cycle, as if friction drove the motion: it is the specimen's reaction rather than the rig's force, \
         or displacement and force are swapped. Turn its sign with --flip-force (\"force_sign\": -1 in a scene)"
    )]
    AgainstMotion {
        /// `∮ f dw` of the steady cycle \[J\], negative.
        work: f64,
    },
    /// The curve encloses no area.
    #[error(
        "the curve encloses no area: |∮ f dw| = {work:.1e} J a cycle is not above its own uncertainty of {uncertainty:.1e} J. \
         This is a spring, or friction lost in noise"
    )]
    NoArea {
        /// `∮ f dw` \[J\].
        work: f64,
        /// What noise can make of it \[J\].
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
        /// Im F_1 \[N\].
        imaginary: f64,
        /// π a Im F_1 \[J\].
        dissipation: f64,
    },
}
