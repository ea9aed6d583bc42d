//! `cargo xtask figures`: the paper's figures and numbers from the repository alone, and what the paper could not draw.
//!
//! Every figure is an SVG for print, a PNG to look at, and a CSV with the numbers drawn. With `--check` everything is
//! made again in memory. The scenes must be what the search finds, stated
//! numbers must keep their tolerance, committed files must say the same: CSV and page up to
//! 1e-4 of each number, SVG up to 0.05 px; a PNG byte for byte where its SVG is the same byte for byte.

mod alike;
mod figure;
mod loops;
mod page;
mod pens;
mod response;
mod waveforms;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use scene::Scene;

use crate::paper::statements::Comparison;
use crate::reconstruct::{self, Reconstruction};
use alike::Slack;
use figure::Figure;

/// Numbers of CSV files and of the page.
const NUMBERS: Slack = Slack { relative: 1e-4, absolute: 0.0 };
/// Coordinates in px.
const COORDINATES: Slack = Slack { relative: 0.0, absolute: 0.05 };
/// Largest committed file in bytes.
const LARGEST: usize = 300_000;

/// Everything that the command makes.
struct Made {
    search: Reconstruction,
    figures: Vec<Figure>,
    page: String,
}

fn make(root: &Path) -> Result<Made> {
    let files = reconstruct::files(root);
    let comparison = Comparison::of_scenes(&files)?;
    comparison.require()?;
    let [hysteresis, coulomb] = [Scene::from_file(&files[0])?, Scene::from_file(&files[1])?];
    let loops = loops::Loops::measure()?;
    let harmonics = response::Harmonics::solve(&hysteresis)?;
    let search = Reconstruction::find()?;
    let page = page::page(&[
        ("statements", comparison.table()),
        ("agreement", comparison.agreement_table()),
        ("parameters", search.parameter_table()),
        ("scene", search.physical_table()),
        ("search", search.search_table()),
        ("ratios", reconstruct::mass_ratios()),
        ("places", reconstruct::PLACES.to_string()),
        ("loops", loops.table()?),
        ("harmonics", harmonics.table()),
    ])?;
    let figures = vec![
        loops.measured()?,
        loops.predicted()?,
        response::paper(&hysteresis, &coulomb)?,
        harmonics.figure()?,
        waveforms::figure(&hysteresis)?,
    ];
    Ok(Made { search, figures, page })
}

/// Writes figures and page.
pub(crate) fn write(root: &Path) -> Result<()> {
    let made = make(root)?;
    for figure in &made.figures {
        let file = |extension| file(root, figure, extension);
        let svg = figure.svg();
        plot::write(&svg, &file("svg"))?;
        plot::write(&svg, &file("png"))?;
        put(&file("csv"), &figure.csv())?;
        for extension in ["svg", "png", "csv"] {
            let size = fs::metadata(file(extension))?.len() as usize;
            ensure!(size <= LARGEST, "{}: {size} bytes are too many", file(extension).display());
        }
    }
    put(&page_file(root), &made.page)
}

/// Fails when a stated number leaves its tolerance, or a committed file is not what [`write()`] writes.
pub(crate) fn check(root: &Path) -> Result<()> {
    let made = make(root)?;
    made.search.check(root)?;
    let folder = tempfile::tempdir()?;
    for figure in &made.figures {
        let committed = |extension| file(root, figure, extension);
        compare(&committed("csv"), &figure.csv(), NUMBERS)?;
        let svg = figure.svg();
        compare(&committed("svg"), &svg, COORDINATES)?;
        if text(&committed("svg"))? == svg {
            let again = folder.path().join("figure.png");
            plot::write(&svg, &again)?;
            let path = committed("png");
            let same = fs::read(&path).with_context(|| path.display().to_string())? == fs::read(&again)?;
            ensure!(same, "{} is not the picture of its .svg; run `cargo xtask figures`", path.display());
        }
    }
    compare(&page_file(root), &made.page, NUMBERS)
}

fn compare(path: &Path, made: &str, slack: Slack) -> Result<()> {
    alike::require(&text(path)?, made, slack)
        .with_context(|| format!("{} is not what `cargo xtask figures` writes", path.display()))
}

fn file(root: &Path, figure: &Figure, extension: &str) -> PathBuf {
    root.join("docs").join("figures").join(figure.name).with_extension(extension)
}

fn page_file(root: &Path) -> PathBuf {
    root.join("docs").join("src").join("reproduction.md")
}

/// A committed text; a checkout may have changed its line ends.
fn text(path: &Path) -> Result<String> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    Ok(text.replace("\r\n", "\n"))
}

fn put(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| path.display().to_string())
}
