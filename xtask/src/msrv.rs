//! `cargo xtask msrv`: the oldest compiler that the workspace declares (`rust-version`) is one that can build it.
//!
//! Three ways to be wrong: a function of the standard library that is newer, which clippy's `incompatible_msrv` refuses in every
//! run of the lints (here it is only tried that it does); a dependency that wants a newer compiler; syntax that is newer, which only
//! that compiler itself finds.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::packages::{Packages, cargo};

/// Crates that nobody builds but who works on them.
const OURS_ALONE: [&str; 2] = ["xtask", "stickslip-tests"];

/// Runs all checks.
///
/// # Errors
/// What is newer than declared.
pub(crate) fn run(root: &Path) -> Result<()> {
    let packages = Packages::read(root, None)?;
    let declared = declared(&packages)?;
    eprintln!("rust-version is {declared}");
    dependencies(&packages, &declared)?;
    lint(root)?;
    compiler(root, &declared)
}

/// The one `rust-version` of all members.
fn declared(packages: &Packages) -> Result<String> {
    let mut versions: Vec<&str> = packages.ours().filter_map(|p| p.rust_version.as_deref()).collect();
    ensure!(versions.len() == packages.ours().count(), "a member of the workspace has no rust-version");
    versions.sort_unstable();
    versions.dedup();
    match versions.as_slice() {
        [one] => Ok((*one).to_owned()),
        others => bail!("members of the workspace declare different versions: {}", others.join(", ")),
    }
}

/// No dependency of a shipped crate declares a newer compiler.
fn dependencies(packages: &Packages, declared: &str) -> Result<()> {
    let shipped: Vec<&str> =
        packages.ours().map(|p| p.name.as_str()).filter(|name| !OURS_ALONE.contains(name)).collect();
    let needed = packages.needed(&shipped, true);
    let limit = version(declared)?;
    let (mut newer, mut silent, mut highest) = (Vec::new(), 0, (vec![0], String::new()));
    for package in needed.iter().filter(|package| !package.is_ours()) {
        let Some(wanted) = &package.rust_version else {
            silent += 1;
            continue;
        };
        let name = format!("{} {} wants {wanted}", package.name, package.version);
        let wanted = version(wanted)?;
        if wanted > limit {
            newer.push(name.clone());
        }
        highest = highest.max((wanted, name));
    }
    ensure!(newer.is_empty(), "newer than rust-version {declared}: {}", newer.join(", "));
    eprintln!(
        "{} dependencies of the shipped crates: the highest is {}, {silent} declare nothing",
        needed.iter().filter(|package| !package.is_ours()).count(),
        highest.1
    );
    Ok(())
}

/// `1.90` and `1.90.0` are the same.
fn version(text: &str) -> Result<Vec<u64>> {
    let mut numbers: Vec<u64> = text
        .split('.')
        .map(|part| part.parse().with_context(|| format!("version {text}")))
        .collect::<Result<_>>()?;
    numbers.resize(3, 0);
    Ok(numbers)
}

/// A crate that uses a function newer than what it declares must be refused.
const TRIAL: &str = "\
//! Newer than it says.

/// `Duration::from_mins` is of 1.91.
pub fn newer() -> std::time::Duration {
    std::time::Duration::from_mins(1)
}
";

/// Clippy's lint does what is expected of it.
fn lint(root: &Path) -> Result<()> {
    let folder = root.join("target").join("msrv-trial");
    fs::create_dir_all(folder.join("src"))?;
    let manifest =
        "[package]\nname = \"trial\"\nedition = \"2024\"\nrust-version = \"1.85\"\n\n[workspace]\n";
    fs::write(folder.join("Cargo.toml"), manifest)?;
    fs::write(folder.join("src").join("lib.rs"), TRIAL)?;
    let output = Command::new(cargo())
        .args(["clippy", "--quiet", "--offline", "--", "-D", "warnings"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .context("cargo clippy")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(
        !output.status.success() && said.contains("incompatible_msrv"),
        "clippy does not refuse a function that is newer than rust-version: {said}"
    );
    eprintln!("clippy refuses what is newer in the standard library");
    Ok(())
}

/// The compiler itself, where rustup has it.
fn compiler(root: &Path, declared: &str) -> Result<()> {
    let listed = Command::new("rustup").args(["toolchain", "list"]).output();
    let installed = listed.is_ok_and(|output| {
        let toolchains = String::from_utf8_lossy(&output.stdout).into_owned();
        toolchains.lines().any(|line| {
            line.strip_prefix(declared).is_some_and(|rest| rest.starts_with(['.', '-']) || rest.is_empty())
        })
    });
    if !installed {
        eprintln!(
            "Rust {declared} is not installed, nothing was built with it: rustup toolchain install {declared}"
        );
        return Ok(());
    }
    let mut command = Command::new("cargo");
    command.arg(format!("+{declared}")).args(["check", "--workspace", "--locked"]);
    for package in OURS_ALONE {
        command.args(["--exclude", package]);
    }
    // The cargo that runs this names its own compiler to what it starts.
    for variable in ["CARGO", "RUSTC", "RUSTUP_TOOLCHAIN"] {
        command.env_remove(variable);
    }
    let checked =
        command.current_dir(root).env("CARGO_TARGET_DIR", root.join("target").join("msrv")).status()?;
    ensure!(checked.success(), "Rust {declared} cannot build the workspace");
    eprintln!("Rust {declared} builds the workspace");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::version;

    #[test]
    fn versions_are_compared_as_numbers() {
        let version = |text| version(text).unwrap();
        assert_eq!(version("1.90"), version("1.90.0"));
        assert!(version("1.100") > version("1.90") && version("1.90.1") > version("1.90"));
        assert!(super::version("1.x").is_err());
    }
}
