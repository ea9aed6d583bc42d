//! The files that a scene names: where they lie, and what was read from them already.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use hysteresis::ReadOptions;

use crate::error::SceneError;
use crate::json::Json;
use crate::loops::MeasuredLoop;
use crate::sparse::Sparse;

/// Files relative to a folder; each record is read and fitted once, each structure in files read once.
#[derive(Debug, Default)]
pub(crate) struct Records {
    base: PathBuf,
    known: Mutex<Vec<(PathBuf, ReadOptions, MeasuredLoop)>>,
    structures: Mutex<Vec<(Json, Arc<Sparse>)>>,
    files: Mutex<Vec<PathBuf>>,
}

/// Large structures that are remembered: variants of a scene that change its model are rare.
const STRUCTURES: usize = 2;

impl Records {
    pub(crate) fn new(base: &Path) -> Self {
        Self { base: base.to_owned(), ..Self::default() }
    }

    /// The path of a file that a scene names; it is one of those the scene depends on.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        let path = self.base.join(name);
        self.files.lock().unwrap_or_else(PoisonError::into_inner).push(path.clone());
        path
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
        self.file(name);
        known.push((path, options.clone(), found.clone()));
        Ok(found)
    }

    /// The structure that the entry `model` of a scene describes, read by `read` the first time.
    pub(crate) fn structure(
        &self,
        model: &Json,
        read: impl FnOnce() -> Result<Sparse, SceneError>,
    ) -> Result<Arc<Sparse>, SceneError> {
        let mut known = self.structures.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = known.iter().find(|(other, _)| other == model) {
            return Ok(found.clone());
        }
        let found = Arc::new(read()?);
        known.insert(0, (model.clone(), found.clone()));
        known.truncate(STRUCTURES);
        Ok(found)
    }

    /// The files that were read, each once, in a fixed order.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner).clone();
        files.sort();
        files.dedup();
        files
    }
}
