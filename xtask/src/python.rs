//! `cargo xtask python`: builds the wheel of the Python package, and tests it where nothing but the wheel is installed.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result, ensure};

use crate::virtual_environment::VirtualEnvironment;

/// What builds the wheel and checks its types.
const BUILDING: &str = "maturin>=1.8,<2\nmypy>=1.11\nnumpy>=2\n";

/// What the tests use beside the wheel.
const TESTING: &str =
    "pytest>=8\nnumpy>=1.24\nscipy>=1.11\npandas>=2\npyarrow>=15\nmatplotlib>=3.8\ndistributed>=2024.1\n";

/// Builds the wheel and runs type check and tests; without Python it says so, and with `required` fails.
///
/// # Errors
/// What failed.
pub(crate) fn run(root: &Path, required: bool) -> Result<()> {
    if !required && !Command::new("python3").arg("--version").output().is_ok_and(|o| o.status.success()) {
        eprintln!("python3 is missing, the Python package is not tested");
        return Ok(());
    }
    let package = root.join("crates").join("python");
    let building = building(root)?;
    let wheel = build(root, &building, &["--release"], None)?;
    eprintln!("checking types");
    let types = building.python().args(["-m", "mypy", "python/stickslip"]).current_dir(&package).status()?;
    ensure!(types.success(), "mypy finds mistakes");
    let clean = VirtualEnvironment::with(&root.join("target").join("python").join("testing"), TESTING)?;
    clean.install(&["--force-reinstall".as_ref(), "--no-deps".as_ref(), wheel.as_os_str()])?;
    eprintln!("testing {}", wheel.display());
    // The command line, whose files the tests read.
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(program).args(["build", "--release", "--quiet"]).current_dir(root).status()?;
    ensure!(built.success(), "cargo build --release failed");
    let command = root.join("target").join("release").join(format!("stickslip{}", env::consts::EXE_SUFFIX));
    let tests = clean
        .python()
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        // The package of the sources has no compiled part: what is tested is what was installed.
        .current_dir(&package)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("MPLBACKEND", "Agg")
        .env("STICKSLIP_COMMAND", &command)
        .status()?;
    ensure!(tests.success(), "tests of the Python package fail");
    Ok(())
}

/// Builds the wheel of a release and nothing else, with flags for the compiler in the form of `CARGO_ENCODED_RUSTFLAGS`.
///
/// # Errors
/// Without Python or a package index.
pub(crate) fn wheel(root: &Path, flags: &str) -> Result<PathBuf> {
    build(root, &building(root)?, &["--profile", "dist"], Some(flags))
}

/// The environment in which it is built.
fn building(root: &Path) -> Result<VirtualEnvironment> {
    VirtualEnvironment::with(&root.join("target").join("python").join("building"), BUILDING)
}

/// The wheel, in `target/python/wheels`.
fn build(
    root: &Path,
    building: &VirtualEnvironment,
    profile: &[&str],
    flags: Option<&str>,
) -> Result<PathBuf> {
    let folder = root.join("target").join("python").join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    let mut maturin = Command::new(building.program("maturin"));
    maturin.args(["build", "--quiet"]).args(profile).arg("--out").arg(&folder);
    if let Some(flags) = flags {
        maturin.env("CARGO_ENCODED_RUSTFLAGS", flags).env_remove("RUSTFLAGS");
    }
    let built = maturin.current_dir(root.join("crates").join("python")).status().context("maturin")?;
    ensure!(built.success(), "maturin cannot build the wheel");
    let wheels: Vec<PathBuf> = fs::read_dir(&folder)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    match wheels.as_slice() {
        [wheel] => Ok(wheel.clone()),
        others => anyhow::bail!("{} wheels in {}, one was expected", others.len(), folder.display()),
    }
}
