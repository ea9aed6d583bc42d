//! What can be wrong with a study.

use std::path::PathBuf;

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
    /// The study's file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// An entry of the study is missing, unknown or has a value that cannot be.
    #[error(transparent)]
    Study(SceneError),
    /// The scene of the study cannot be used.
    #[error("{}: {error}", path.display())]
    InScene {
        /// The scene's file.
        path: PathBuf,
        /// What is wrong with it.
        error: SceneError,
    },
    /// The values of a case make no scene.
    #[error("with {case}: {error}")]
    Case {
        /// The varied entries and their values.
        case: String,
        /// What is wrong with the scene they make.
        error: SceneError,
    },
    /// Finished cases of another study are in the way.
    #[error(
        "{} holds cases of another study: the study, its scene, a record or the program has changed since; --restart \
         begins anew, or name another output",
        path.display()
    )]
    OtherStudy {
        /// The file with the finished cases.
        path: PathBuf,
    },
    /// A file that should hold finished cases of the study does not.
    #[error(
        "{} holds no cases of this study: it is another file, or the study, its scene, a record or the program has changed since",
        path.display()
    )]
    NoCases {
        /// The file.
        path: PathBuf,
    },
    /// Another run has the finished cases.
    #[error("{} is in use by another run of this study; wait for it, or name another output", path.display())]
    Busy {
        /// The file with the finished cases.
        path: PathBuf,
    },
    /// The finished cases cannot be kept.
    #[error("cannot keep finished cases in {}: {source}", path.display())]
    Keeping {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl From<hbm::PlanError> for StudyError {
    fn from(error: hbm::PlanError) -> Self {
        Self::Scene(SceneError::Entry { place: error.place, problem: error.problem })
    }
}
