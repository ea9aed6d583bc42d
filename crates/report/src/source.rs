//! The scene of a result.

use std::path::Path;

use scene::{Scene, SceneError, Variants};

/// A scene, its text, and what makes variants of it.
#[derive(Debug)]
pub struct Source {
    pub(crate) scene: Scene,
    pub(crate) variants: Variants,
    pub(crate) text: String,
}

impl Source {
    /// Reads a scene's file; names of files in it are relative to it.
    ///
    /// # Errors
    /// [`SceneError`] with what is wrong and where.
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        Ok(Self { scene: Scene::from_file(path)?, variants: Variants::from_file(path)?, text })
    }
}
