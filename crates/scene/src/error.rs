//! What can be wrong with a scene: the place, the problem, and what to do about it.

use std::path::PathBuf;

use thiserror::Error;

/// A scene that cannot be used.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The scene's file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The text is not JSON.
    #[error("line {line}, column {column}{}: {problem}", within(place))]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// Path of the innermost entry that was being read; empty at the top.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// An entry is missing, unknown or has a value that cannot be.
    #[error("{place}: {problem}")]
    Entry {
        /// Path of the entry, for example `contacts[0].law.slip_force`.
        place: String,
        /// What is wrong, with the value.
        problem: String,
    },
}

fn within(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!(" (in {place})") }
}

impl SceneError {
    /// An error about the entry at `place`; the top of a scene is called "scene".
    pub fn entry(place: &str, problem: impl Into<String>) -> Self {
        let place = if place.is_empty() { "scene" } else { place };
        Self::Entry { place: place.to_owned(), problem: problem.into() }
    }

    /// Path of the offending entry, where there is one.
    pub fn place(&self) -> Option<&str> {
        match self {
            Self::Unreadable { .. } => None,
            Self::Syntax { place, .. } | Self::Entry { place, .. } => Some(place),
        }
    }
}
