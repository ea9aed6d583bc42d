//! What can be wrong with a study.

use scene::SceneError;
use thiserror::Error;

/// A study that cannot be made.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The scene cannot be solved as posed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No number of harmonics is left to compare.
    #[error("harmonics: none of them reaches the excited harmonic {highest}; take larger ones")]
    TooFewHarmonics {
        /// Highest excited harmonic.
        highest: usize,
    },
}

impl From<hbm::PlanError> for StudyError {
    fn from(error: hbm::PlanError) -> Self {
        Self::Scene(SceneError::Entry { place: error.place, problem: error.problem })
    }
}
