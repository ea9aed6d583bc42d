//! A virtual environment of Python with the peers, under `target/peers`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use super::answer::Answer;
use super::request::{Case, Scene, text};
use crate::virtual_environment::{VirtualEnvironment, requirements};

/// Where scripts are, and what runs them.
pub(super) struct Environment {
    scripts: PathBuf,
    folder: PathBuf,
    venv: VirtualEnvironment,
}

impl Environment {
    /// Makes the environment unless it is there with the same packages.
    ///
    /// # Errors
    /// Without Python, or where packages cannot be had.
    pub(super) fn prepare(root: &Path) -> Result<Self> {
        let (scripts, folder) = (root.join("xtask").join("peers"), root.join("target").join("peers"));
        let packages = requirements(&scripts.join("requirements.txt"))?;
        let venv = VirtualEnvironment::with(&folder, &packages)
            .context("the peers are Python packages and need Python 3.11 or later")?;
        Ok(Self { scripts, folder, venv })
    }

    /// What a script answers to the cases of a scene.
    pub(super) fn ask(&self, script: &str, scene: &Scene, cases: &[Case]) -> Result<Answer> {
        let [request, answer] =
            ["request", "answer"].map(|end| self.folder.join(format!("{script}-{end}.json")));
        fs::write(&request, text(scene, cases)?).with_context(|| request.display().to_string())?;
        let status = self
            .venv
            .python()
            .arg(self.scripts.join(format!("{script}.py")))
            .args([&request, &answer])
            // pyHarm leaves a folder where it runs.
            .current_dir(&self.folder)
            // One thread, as on the other side, and no files among the sources.
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("PYTHONWARNINGS", "ignore")
            .status()
            .with_context(|| script.to_owned())?;
        ensure!(status.success(), "{script}.py failed");
        let text = fs::read_to_string(&answer).with_context(|| answer.display().to_string())?;
        Answer::parse(&text).with_context(|| answer.display().to_string())
    }
}
