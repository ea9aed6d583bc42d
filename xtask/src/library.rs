//! The scene library: the scenes and points that methods and estimates are judged on.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use scene::Scene;

/// Every scene of `scenes/library` in the order of its names.
pub(crate) fn scenes(root: &Path) -> Result<Vec<Scene>> {
    let folder = root.join("scenes").join("library");
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            files.push(path);
        }
    }
    files.sort();
    ensure!(!files.is_empty(), "{} has no scenes", folder.display());
    files.iter().map(|path| Scene::from_file(path).with_context(|| path.display().to_string())).collect()
}
