//! Ways to a periodic motion.

use hbm::Settings;
use serde::{Deserialize, Serialize};

/// A way to a periodic motion, with its setting.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case")]
pub enum Method {
    /// Harmonic balance as the solver does it unasked: forces by events and a slaved tail where laws allow it.
    Balance {
        /// N.
        harmonics: usize,
    },
    /// The same with Newton's method for every harmonic.
    WithoutTail {
        /// N.
        harmonics: usize,
    },
    /// Forces at samples, whatever the laws allow: the usual alternating frequency–time method.
    Sampled {
        /// N.
        harmonics: usize,
        /// Samples a period.
        samples: usize,
    },
    /// As many harmonics as each point needs for a tolerance.
    Adaptive {
        /// Estimated relative error of the displacement spectrum that is accepted.
        tolerance: f64,
        /// The most harmonics it may take.
        most: usize,
    },
    /// Time steps from rest until the motion repeats ([`crate::step_until_periodic`]).
    Stepping {
        /// Steps a period.
        steps: usize,
    },
    /// The exact orbit, looked for from rest.
    Orbit,
    /// The exact orbit, looked for from a harmonic solution, whose time is included.
    OrbitFromBalance {
        /// N of that solution.
        harmonics: usize,
    },
}

impl Method {
    /// Settings of the balance behind it; `None` where there is none.
    pub fn settings(&self) -> Option<Settings> {
        match *self {
            Self::Balance { harmonics } | Self::OrbitFromBalance { harmonics } => {
                Some(Settings::new(harmonics))
            }
            Self::WithoutTail { harmonics } => Some(Settings { slaving: false, ..Settings::new(harmonics) }),
            Self::Sampled { harmonics, samples } => {
                Some(Settings { samples: Some(samples), slaving: false, ..Settings::new(harmonics) })
            }
            Self::Adaptive { tolerance, most } => {
                Some(Settings { truncation: Some(tolerance), ..Settings::new(most) })
            }
            Self::Stepping { .. } | Self::Orbit => None,
        }
    }
}
