//! The measured data in the repository: JSON, one measurement a line.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use study::EstimateQuality;
use study::work_precision::WorkPrecisionSet;

use super::march::March;

/// Everything that figures and page are made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Data {
    #[serde(flatten)]
    pub(super) set: WorkPrecisionSet,
    /// What the errors of each scene are measured against.
    pub(super) origins: Vec<Origin>,
    /// The paper's frequency marching beside independent points.
    pub(super) marches: Vec<March>,
    /// What estimates are worth, by name of the scene.
    pub(super) estimates: Vec<(String, Option<EstimateQuality>)>,
}

/// Truths of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Origin {
    pub(super) scene: String,
    /// Points of the scene, those with a truth, and those of them whose truth is an exact orbit.
    pub(super) points: usize,
    pub(super) truths: usize,
    pub(super) orbits: usize,
    /// Where the first truth comes from.
    pub(super) reference: String,
    /// Relative error of the worst truth, at most.
    pub(super) accuracy: f64,
}

fn file(root: &Path) -> PathBuf {
    root.join("docs").join("figures").join("error-vs-runtime.json")
}

impl Data {
    pub(super) fn read(root: &Path) -> Result<Self> {
        let path = file(root);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    pub(super) fn write(&self, root: &Path) -> Result<()> {
        let path = file(root);
        // An entry of a list a line: small, and a change shows where it is.
        let text = serde_json::to_string(self)?.replace("},{", "},\n{").replace(":[{", ":[\n{");
        fs::write(&path, text + "\n").with_context(|| path.display().to_string())
    }

    /// What the errors of `scene` are measured against.
    pub(super) fn origin(&self, scene: &str) -> Option<&Origin> {
        self.origins.iter().find(|origin| origin.scene == scene)
    }
}
