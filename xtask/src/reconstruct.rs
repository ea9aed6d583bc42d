//! `cargo xtask reconstruct`: parameters of the paper's Fig. 4, found from what its text says about it.
//!
//! The paper prints no parameters. What is assumed, and nothing else: c1 = c2; the same viscous damper d on both masses
//! (Fig. 1, eq. (1)); the contact of eqs (6)–(9) with W* = 8 µm, the amplitude of its reference loop, and F* = 12 N. The
//! last two only set the scales of length and force. One harmonic, as in the paper.
//!
//! Without dimensions six numbers are left ([`Parameters`](parameters::Parameters)), for eight statements
//! ([`STATEMENTS`](crate::paper::statements::STATEMENTS)). The ninth, "tuned to fit the static response of m2",
//! gives k_t in closed form. [`search`] minimises the sum of squared deviations in units of half the last printed digit;
//! [`ranges`] says how far each number may go while every statement stays as it is printed.

mod parameters;
mod ranges;
mod report;
mod scenes;
mod search;

use std::path::Path;

use anyhow::{Context, Result};

use parameters::Physical;
use ranges::Ranges;
pub(crate) use report::mass_ratios;
use scenes::Scenes;
pub(crate) use scenes::files;
pub(crate) use search::PLACES;
use search::Search;

use crate::paper::statements::Comparison;

/// The search with its ranges and the scenes that come out of it.
pub(crate) struct Reconstruction {
    search: Search,
    physical: Physical,
    ranges: Ranges,
    scenes: Scenes,
}

impl Reconstruction {
    /// Searches; some seconds.
    pub(crate) fn find() -> Result<Self> {
        let search = search::search()?;
        let physical = search.best.physical()?.context("no spring has the static response of the law")?;
        let ranges = ranges::ranges(&search.best)?;
        let scenes = Scenes::of(&physical);
        Ok(Self { search, physical, ranges, scenes })
    }

    /// Fails unless the scenes are what the search found.
    pub(crate) fn check(&self, root: &Path) -> Result<()> {
        self.scenes.check(root)
    }
}

/// Writes the scenes and prints what they are worth.
pub(crate) fn write(root: &Path) -> Result<()> {
    let found = Reconstruction::find()?;
    found.scenes.write(root)?;
    let comparison = Comparison::of_scenes(&files(root))?;
    let tables = [
        found.search_table(),
        found.parameter_table(),
        found.physical_table(),
        comparison.table(),
        comparison.agreement_table(),
    ];
    println!("{}", tables.join("\n"));
    Ok(())
}

/// Fails unless the scenes are what [`write()`] writes.
pub(crate) fn check(root: &Path) -> Result<()> {
    Reconstruction::find()?.check(root)
}
