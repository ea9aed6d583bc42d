//! The measured data in the repository.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use study::work_precision::Machine;

use super::answer::Answer;
use super::compare::Spread;

/// Everything that the page is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Data {
    pub(super) command: String,
    pub(super) machine: Machine,
    /// Of Python and its packages.
    pub(super) versions: Vec<(String, String)>,
    pub(super) rows: Vec<Row>,
    /// Samples, and how far pyHarm and stickslip are apart with friction at N = 7.
    pub(super) finer: Vec<(usize, Option<Spread>)>,
    pub(super) stepped: Vec<Stepped>,
}

/// One scene, peer and N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) peer: String,
    pub(super) harmonics: usize,
    pub(super) samples: usize,
    pub(super) points: usize,
    pub(super) peer_unsolved: usize,
    pub(super) own_unsolved: usize,
    /// Peer against stickslip with as many samples.
    pub(super) difference: Option<Spread>,
    /// Against the truth: the peer, stickslip with as many samples, stickslip unasked.
    pub(super) peer_error: Option<Spread>,
    pub(super) sampled_error: Option<Spread>,
    pub(super) own_error: Option<Spread>,
    /// A point, in s.
    pub(super) peer_seconds: f64,
    pub(super) sampled_seconds: f64,
    pub(super) own_seconds: f64,
}

/// A way to step through time, or stickslip with some N, at the points with exact orbits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Stepped {
    pub(super) method: String,
    /// Whether it is a peer's.
    pub(super) peer: bool,
    pub(super) unsolved: usize,
    pub(super) error: Option<Spread>,
    /// A point, in s.
    pub(super) seconds: f64,
}

fn file(root: &Path) -> PathBuf {
    root.join("docs").join("figures").join("peers.json")
}

impl Data {
    pub(super) fn read(root: &Path) -> Result<Self> {
        let path = file(root);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    pub(super) fn write(&self, root: &Path) -> Result<()> {
        let path = file(root);
        let text = serde_json::to_string(self)?.replace("},{", "},\n{").replace(":[{", ":[\n{");
        fs::write(&path, text + "\n").with_context(|| path.display().to_string())
    }

    /// Notes the versions of an answer.
    pub(super) fn knows(&mut self, answer: &Answer) {
        for (name, version) in &answer.versions {
            if !self.versions.iter().any(|(known, _)| known == name) {
                self.versions.push((name.clone(), version.clone()));
            }
        }
    }
}
