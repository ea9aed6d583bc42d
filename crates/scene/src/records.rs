//! The records that a scene names: where they lie, and what was read from them already.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use hysteresis::ReadOptions;

use crate::error::SceneError;
use crate::loops::MeasuredLoop;

/// Records relative to a folder; each is read and fitted once.
#[derive(Debug, Default)]
pub(crate) struct Records {
    base: PathBuf,
    known: Mutex<Vec<(PathBuf, ReadOptions, MeasuredLoop)>>,
}

impl Records {
    pub(crate) fn new(base: &Path) -> Self {
        Self { base: base.to_owned(), known: Mutex::default() }
    }

    /// The loop in the record `name`, read by `read` the first time.
    pub(crate) fn get(
        &self,
        name: &str,
        options: &ReadOptions,
        read: impl FnOnce(&Path) -> Result<MeasuredLoop, SceneError>,
    ) -> Result<MeasuredLoop, SceneError> {
        let path = self.base.join(name);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, _, found)) = known.iter().find(|(other, how, _)| *other == path && how == options) {
            return Ok(found.clone());
        }
        let found = read(&path)?;
        known.push((path, options.clone(), found.clone()));
        Ok(found)
    }

    /// The files that were read, each once, in a fixed order.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let mut files: Vec<PathBuf> = known.iter().map(|(path, _, _)| path.clone()).collect();
        files.sort();
        files.dedup();
        files
    }
}
