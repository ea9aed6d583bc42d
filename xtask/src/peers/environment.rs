//! A virtual environment of Python with the peers, under `target/peers`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use super::answer::Answer;
use super::request::{Case, Scene, text};

/// Where scripts are, and what runs them.
pub(super) struct Environment {
    scripts: PathBuf,
    folder: PathBuf,
}

impl Environment {
    /// Makes the environment unless it is there with the same packages.
    ///
    /// # Errors
    /// Without Python, or where packages cannot be had.
    pub(super) fn prepare(root: &Path) -> Result<Self> {
        let environment =
            Self { scripts: root.join("xtask").join("peers"), folder: root.join("target").join("peers") };
        let wanted = environment.scripts.join("requirements.txt");
        let packages = fs::read_to_string(&wanted).with_context(|| wanted.display().to_string())?;
        let stamp = environment.folder.join("installed.txt");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == packages) {
            return Ok(environment);
        }
        let Ok(version) = Command::new("python3").arg("--version").output() else {
            bail!("python3 is missing; the peers are Python packages, so there is nothing to compare with");
        };
        ensure!(version.status.success(), "`python3 --version` fails; a Python 3.11 or later is needed");
        fs::create_dir_all(&environment.folder)?;
        let venv = environment.folder.join("venv");
        eprintln!("making {}", venv.display());
        let made = Command::new("python3").arg("-m").arg("venv").arg("--clear").arg(&venv).status()?;
        ensure!(
            made.success(),
            "`python3 -m venv` fails; on Debian and Ubuntu it needs the package python3-venv"
        );
        let installed = Command::new(environment.python())
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"])
            .arg(&wanted)
            .status()?;
        ensure!(
            installed.success(),
            "pip cannot install {}; it needs a package index, and these versions need Python 3.11 or later",
            wanted.display()
        );
        fs::write(stamp, packages)?;
        Ok(environment)
    }

    fn python(&self) -> PathBuf {
        let venv = self.folder.join("venv");
        if cfg!(windows) { venv.join("Scripts").join("python.exe") } else { venv.join("bin").join("python") }
    }

    /// What a script answers to the cases of a scene.
    pub(super) fn ask(&self, script: &str, scene: &Scene, cases: &[Case]) -> Result<Answer> {
        let [request, answer] =
            ["request", "answer"].map(|end| self.folder.join(format!("{script}-{end}.json")));
        fs::write(&request, text(scene, cases)?).with_context(|| request.display().to_string())?;
        let status = Command::new(self.python())
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
