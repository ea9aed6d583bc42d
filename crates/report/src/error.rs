//! What can be wrong with the results and scenes of a report.

use scene::{BadFrequencies, Mismatch, SceneError};
use thiserror::Error;

/// A report that cannot be made.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A text that is no result.
    #[error("not a result of stickslip: {0}")]
    NoResult(String),
    /// A result of a command that a report does not show.
    #[error("this is a result of stickslip {0}; a report shows those of sweep, continue and backbone (JSON)")]
    OtherCommand(&'static str),
    /// A result of a later program.
    #[error("the result has format_version {0}; this program reads 1")]
    Version(u32),
    /// Results that do not belong over one axis.
    #[error(
        "{first} runs along {along}, {second} along {other}: they do not fit over one axis; make two reports"
    )]
    Axes {
        /// The first result.
        first: String,
        /// Its parameter.
        along: String,
        /// The other result.
        second: String,
        /// Its parameter.
        other: String,
    },
    /// A result without a point.
    #[error("{0} has no points to show")]
    Empty(String),
    /// No results at all.
    #[error("a report needs a result")]
    Nothing,
    /// A scene that cannot be read or posed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Frequencies of a result that are none.
    #[error("{label}: {problem}")]
    Frequencies {
        /// The result.
        label: String,
        /// What is wrong.
        problem: BadFrequencies,
    },
    /// A scene to which no result belongs.
    #[error("the scene is called {scene:?}, the results are of {results}")]
    OtherScene {
        /// Its name.
        scene: String,
        /// Names of the results' scenes.
        results: String,
    },
    /// A result that its scene does not have.
    #[error("{label} is not a result of this scene: {mismatch}")]
    Mismatch {
        /// The result.
        label: String,
        /// Where they differ.
        mismatch: Mismatch,
    },
    /// A program that was built without the page.
    #[error(
        "this program was built without the report page: run `cargo xtask report-page` (it needs Node.js 20 or later and a \
         package registry), then build again"
    )]
    NoPage,
    /// Data that cannot be written down.
    #[error("the data of the page cannot be written: {0}")]
    Data(#[from] serde_json::Error),
}
