//! What a page of the book quotes from a command: a CSV file of figures, and tables in the text.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

fn file(root: &Path, command: &str) -> PathBuf {
    root.join("docs").join("figures").join(format!("{command}.csv"))
}

/// Writes `docs/figures/COMMAND.csv`.
pub(crate) fn write(root: &Path, command: &str, csv: &str) -> Result<()> {
    let path = file(root, command);
    fs::write(&path, csv).with_context(|| path.display().to_string())
}

/// Fails unless `docs/figures/COMMAND.csv` is `csv` and every line of `tables` stands in `docs/src/COMMAND.md`.
pub(crate) fn check(root: &Path, command: &str, csv: &str, tables: &str) -> Result<()> {
    let path = file(root, command);
    let written = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    // A checkout may have changed line ends.
    let same = written.lines().eq(csv.lines());
    ensure!(same, "{} is not what `cargo xtask {command}` writes", path.display());
    let path = root.join("docs").join("src").join(format!("{command}.md"));
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    for line in tables.lines() {
        ensure!(
            text.lines().any(|known| known == line),
            "{} lacks a line that `cargo xtask {command}` prints: {line}",
            path.display()
        );
    }
    Ok(())
}
