//! What can go wrong with a contact law: when it is built, and when it is evaluated.

use std::borrow::Cow;

use thiserror::Error;

/// A parameter that a law cannot be built from. `key` is the parameter's name in a scene file, so that a
/// reader of the message finds the entry.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{key}: {problem}")]
pub struct ParameterError {
    /// Dotted path of the offending parameter below the law, for example `slip_force`, `phase.decay` or
    /// `backbone[2]`.
    pub key: Cow<'static, str>,
    /// What is wrong, with the value that was given.
    pub problem: String,
}

impl ParameterError {
    /// An error about the parameter `key`.
    pub fn new(key: impl Into<Cow<'static, str>>, problem: impl Into<String>) -> Self {
        Self { key: key.into(), problem: problem.into() }
    }

    /// Checks that `value` is finite and positive.
    pub(crate) fn positive(key: &'static str, value: f64) -> Result<f64, Self> {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(Self::new(key, format!("must be positive, got {value}")))
        }
    }

    /// Checks that `value` is finite and not negative.
    pub(crate) fn not_negative(key: &'static str, value: f64) -> Result<f64, Self> {
        if value.is_finite() && value >= 0.0 {
            Ok(value)
        } else {
            Err(Self::new(key, format!("must not be negative, got {value}")))
        }
    }

    /// Checks that `value` is finite.
    pub(crate) fn finite(key: &'static str, value: f64) -> Result<f64, Self> {
        if value.is_finite() {
            Ok(value)
        } else {
            Err(Self::new(key, format!("must be finite, got {value}")))
        }
    }
}

/// A motion for which a law has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LawError {
    /// The relative displacement is constant: a loop of zero amplitude has no loop phase, and the force is
    /// any value up to the holding force.
    #[error("the contact does not move, so its force is undetermined up to the holding force")]
    NoMotion,
    /// The magnitude law g(α) is negative at this amplitude ratio.
    #[error("the magnitude law g(α) is negative at α = {alpha:.3e}")]
    NegativeMagnitude {
        /// Amplitude ratio α = a / W*.
        alpha: f64,
    },
    /// The displacement is not a finite number.
    #[error("the displacement is not a finite number")]
    NotFinite,
    /// The state of the contact still changed after many periods of the motion.
    #[error(
        "the contact found no periodic state in {cycles} periods (its slider still moved by {change:.1e} m)"
    )]
    NoPeriodicState {
        /// Periods that were followed.
        cycles: usize,
        /// Change of the state over the last one, in m.
        change: f64,
    },
    /// The buffers belong to another law or another number of samples.
    #[error("the workspace was made by another law or for another number of samples or directions")]
    OtherWorkspace,
}
