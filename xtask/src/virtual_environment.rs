//! Virtual environments of Python under `target`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// A folder with an interpreter and its own packages.
pub(crate) struct VirtualEnvironment {
    folder: PathBuf,
}

impl VirtualEnvironment {
    /// The environment in `folder` with exactly `packages` (the text of a requirements file); made anew unless it is there with
    /// the same ones.
    ///
    /// # Errors
    /// Without Python, or where packages cannot be had.
    pub(crate) fn with(folder: &Path, packages: &str) -> Result<Self> {
        let environment = Self { folder: folder.to_owned() };
        let stamp = folder.join("installed.txt");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == packages) {
            return Ok(environment);
        }
        let Ok(version) = Command::new("python3").arg("--version").output() else {
            bail!("python3 is missing");
        };
        ensure!(version.status.success(), "`python3 --version` fails");
        fs::create_dir_all(folder)?;
        eprintln!("making {}", environment.venv().display());
        let made =
            Command::new("python3").args(["-m", "venv", "--clear"]).arg(environment.venv()).status()?;
        ensure!(
            made.success(),
            "`python3 -m venv` fails; on Debian and Ubuntu it needs the package python3-venv"
        );
        let wanted = folder.join("requirements.txt");
        fs::write(&wanted, packages)?;
        environment.install(&["--requirement".as_ref(), wanted.as_os_str()])?;
        fs::write(stamp, packages)?;
        Ok(environment)
    }

    /// Installs what `arguments` of pip name.
    ///
    /// # Errors
    /// Where it cannot be had.
    pub(crate) fn install(&self, arguments: &[&std::ffi::OsStr]) -> Result<()> {
        let mut pip = self.python();
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(arguments);
        let installed = pip.status()?;
        ensure!(installed.success(), "pip cannot install {arguments:?}; it needs a package index");
        Ok(())
    }

    /// Its interpreter.
    pub(crate) fn python(&self) -> Command {
        Command::new(self.program("python"))
    }

    /// A program that one of its packages brought.
    pub(crate) fn program(&self, name: &str) -> PathBuf {
        if cfg!(windows) {
            self.venv().join("Scripts").join(format!("{name}.exe"))
        } else {
            self.venv().join("bin").join(name)
        }
    }

    fn venv(&self) -> PathBuf {
        self.folder.join("venv")
    }
}

/// The text of a requirements file.
///
/// # Errors
/// When it cannot be read.
pub(crate) fn requirements(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| path.display().to_string())
}
