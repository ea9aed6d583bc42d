//! `cargo xtask error-vs-runtime`: error against run time of every method on every scene of the library.
//!
//! The full run measures, and writes `docs/figures/error-vs-runtime.json`, figures and `docs/src/error-vs-runtime.md`.
//! `--draw` makes figures and page again from the measured data, `--quick` checks errors (never times) on a small part and
//! that the page is that of the committed data.

mod data;
mod figures;
mod grid;
mod march;
mod page;
mod quick;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};
use scene::Scene;
use study::work_precision::{Machine, Measurement, Patience, WorkPrecisionSet, measure};
use study::{Reference, Truth};

use crate::estimates;
use crate::{library, truths};
use data::{Data, Origin};
pub(crate) use page::time;

/// What a user types.
pub(crate) const COMMAND: &str = "cargo xtask error-vs-runtime";

/// A point with N up to this is compared with truths that are far better.
const LARGEST: usize = 127;

/// Harmonics of orbits that solutions are compared with: what lies beyond adds less than 1 % to the error at N = 1023.
const HIGHEST: usize = 2048;

const PATIENCE: Patience = Patience { least: 5, most: 101, enough: 0.2, longest: 0.5 };

/// Measures everything and writes data, figures and page.
pub(crate) fn run(root: &Path) -> Result<()> {
    let began = Instant::now();
    let mut set = WorkPrecisionSet {
        command: COMMAND.to_owned(),
        machine: Machine::here(rustc()),
        patience: PATIENCE,
        measurements: Vec::new(),
    };
    let mut origins = Vec::new();
    let scenes = library::scenes(root)?;
    for scene in &scenes {
        let began = Instant::now();
        let known = known(scene)?;
        origins.push(known.origin);
        let measured = measure_scene(scene, &known.truths, known.exact, PATIENCE)?;
        eprintln!("{}: {} settings, {:.1} s", scene.name(), measured.len(), began.elapsed().as_secs_f64());
        set.measurements.extend(measured);
    }
    let marches = march::measure(&scenes, &PATIENCE)?;
    let judged = estimates::judge_library(root, &[])?;
    fs::write(root.join("docs/figures/estimates.csv"), estimates::csv(&judged))?;
    let data = Data { set, origins, marches, estimates: estimates::by_scene(&judged) };
    data.write(root)?;
    draw_all(root, &data)?;
    eprintln!("all of it: {:.0} s", began.elapsed().as_secs_f64());
    Ok(())
}

/// Figures and page once more from the measured data.
pub(crate) fn draw(root: &Path) -> Result<()> {
    draw_all(root, &Data::read(root)?)
}

/// Errors on a small part, and whether the page is that of the committed data.
pub(crate) fn quick(root: &Path) -> Result<()> {
    quick::check(root)
}

fn draw_all(root: &Path, data: &Data) -> Result<()> {
    figures::write(root, data)?;
    let path = page_file(root);
    fs::write(&path, page::page(data)?).with_context(|| path.display().to_string())
}

fn page_file(root: &Path) -> PathBuf {
    root.join("docs").join("src").join("error-vs-runtime.md")
}

/// The truths of a scene's points.
struct KnownScene {
    truths: Vec<Truth>,
    /// Exact orbits, all of them.
    exact: bool,
    origin: Origin,
}

fn known(scene: &Scene) -> Result<KnownScene> {
    let found = truths::of_scene(scene, LARGEST, HIGHEST)?;
    let points = found.len();
    let known: Vec<_> = found.into_iter().flatten().collect();
    let accuracy = known.iter().map(|known| known.accuracy).fold(0.0, f64::max);
    let orbits = known.iter().filter(|known| known.truth.reference == Reference::Orbit).count();
    let origin = Origin {
        scene: scene.name().to_owned(),
        points,
        truths: known.len(),
        orbits,
        reference: known.first().map_or(String::new(), |known| known.truth.reference.to_string()),
        accuracy,
    };
    let truths: Vec<Truth> = known.into_iter().map(|known| known.truth).collect();
    Ok(KnownScene { exact: orbits == truths.len(), truths, origin })
}

/// Every method of the grid; larger settings of a method are left out once one takes too long.
fn measure_scene(
    scene: &Scene,
    truths: &[Truth],
    exact: bool,
    patience: Patience,
) -> Result<Vec<Measurement>> {
    let mut measured = Vec::new();
    for series in grid::series(scene, exact)? {
        for method in series {
            let measurement = measure(scene, truths, method, &patience)?;
            let too_long = measurement.seconds * truths.len() as f64 > grid::LONGEST;
            measured.push(measurement);
            if too_long {
                break;
            }
        }
    }
    Ok(measured)
}

/// The compiler's own words.
pub(crate) fn rustc() -> String {
    let output = Command::new("rustc").arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    text.ok().filter(|text| !text.is_empty()).unwrap_or_else(|| "unknown compiler".to_owned())
}
