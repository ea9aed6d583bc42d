//! `cargo xtask deny`: what is built may be distributed, comes from where it should, and has no known hole, by cargo-deny and
//! `deny.toml`.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::packages::cargo;

/// Runs cargo-deny; where it is not installed, says so and passes.
///
/// # Errors
/// What is not allowed.
pub(crate) fn run(root: &Path) -> Result<()> {
    let deny = || {
        let mut command = Command::new(cargo());
        command.current_dir(root).arg("deny");
        command
    };
    if !deny().arg("--version").output().is_ok_and(|output| output.status.success()) {
        eprintln!("cargo-deny is missing, licences are not checked: cargo install cargo-deny --locked");
        return Ok(());
    }
    let checked = deny()
        .args(["--locked", "--offline", "check", "--hide-inclusion-graph", "licenses", "bans", "sources"])
        .status();
    ensure!(checked.context("cargo deny")?.success(), "cargo deny finds what deny.toml does not allow");
    Ok(())
}
