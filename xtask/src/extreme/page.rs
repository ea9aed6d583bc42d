//! The generated part of `docs/src/extreme.md`: between two marks, so that the prose stays as it was written.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::families::FAMILIES;
use super::invariants::Invariants;
use super::table::Table;
use crate::markdown;

const BEGIN: &str = "<!-- written by cargo xtask extreme -->\n";
const END: &str = "<!-- end -->\n";

/// Replaces the tables of the page.
pub(super) fn write(root: &Path, table: &Table, invariants: &Invariants) -> Result<()> {
    let path = root.join("docs/src/extreme.md");
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let (before, rest) = text.split_once(BEGIN).context("the page has no place for its tables")?;
    let (_, after) = rest.split_once(END).context("the page's tables have no end")?;
    let families: Vec<[String; 2]> =
        FAMILIES.iter().map(|family| [family.name.to_owned(), family.what.to_owned()]).collect();
    let families = markdown::table(["family", "what is driven to its limits"], &families);
    let tables = format!("{BEGIN}\n{families}\n{}\n{invariants}\n\n{END}", table.markdown());
    fs::write(&path, format!("{before}{tables}{after}")).with_context(|| path.display().to_string())
}
