//! What must hold on any machine: errors and their orders on a small part, and the page. Times are never judged.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use study::Convergence;
use study::work_precision::{Measurement, Method, Patience, measure};

use super::data::Data;
use super::{COMMAND, grid, page, page_file};
use crate::{estimates, library, truths};

/// Scenes that are solved.
const SCENES: [&str; 2] = ["scene-p", "scene-r"];
/// Everything once.
const ONCE: Patience = Patience { least: 1, most: 1, enough: 0.0, longest: 0.0 };

/// Fails when an error is out of order, or the page is not that of the committed data.
pub(super) fn check(root: &Path) -> Result<()> {
    for scene in library::scenes(root)?.iter().filter(|scene| SCENES.contains(&scene.name())) {
        let known = truths::of_scene(scene, 63, 0)?;
        let truths: Vec<_> = known.into_iter().flatten().map(|known| known.truth).collect();
        ensure!(
            truths.len() == scene.frequencies().as_slice().len(),
            "{}: a point has no truth",
            scene.name()
        );
        let methods = grid::quick();
        let measured: Result<Vec<Measurement>, _> =
            methods.into_iter().map(|method| measure(scene, &truths, method, &ONCE)).collect();
        errors(&measured?).with_context(|| scene.name().to_owned())?;
    }
    let judged = estimates::judge_library(root, &SCENES)?;
    estimates::require(&judged)?;
    let data = Data::read(root)?;
    let path = page_file(root);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    ensure!(text.contains(COMMAND), "{} does not say how it was measured", path.display());
    let same = text.lines().eq(page::page(&data)?.lines());
    ensure!(same, "{} is not the page of its data; run `{COMMAND} --draw`", path.display());
    eprintln!("errors are in order, and so is {}", path.display());
    Ok(())
}

/// Errors fall as theory says, and in the right order between methods.
fn errors(measured: &[Measurement]) -> Result<()> {
    ensure!(measured.iter().all(|m| m.unsolved == 0), "a point was not solved");
    let at = |method: Method| -> Result<(f64, f64)> {
        let found = measured.iter().find(|m| m.method == method).context("is not measured")?;
        Ok((found.median_error.context("no error")?, found.worst_error.context("no error")?))
    };
    let mut convergence = Convergence::default();
    for harmonics in [7, 15, 31, 63] {
        convergence.points.push((harmonics as f64 + 1.0, at(Method::Balance { harmonics })?.0));
    }
    let order = convergence.rate(0.0, f64::MAX).context("no order")?.order;
    ensure!((3.0..4.2).contains(&order), "the truncation error falls with order {order}, not 3.5");

    let events = at(Method::Balance { harmonics: 63 })?.0;
    let [few, more] = [256, 1024].map(|samples| at(Method::Sampled { harmonics: 63, samples }).map(|e| e.0));
    let (few, more) = (few?, more?);
    ensure!(events < more && more < few, "samples: 256 leave {few:e}, 1024 {more:e}, events {events:e}");

    for (tolerance, most) in grid::QUICK_TOLERANCES.map(|tolerance| (tolerance, grid::QUICK_MOST)) {
        let worst = at(Method::Adaptive { tolerance, most })?.1;
        ensure!(worst <= tolerance, "asked for {tolerance:e}, an error of {worst:e} is left");
    }

    let [coarse, fine] = [128, 512].map(|steps| at(Method::Stepping { steps }).map(|e| e.0));
    let order = (coarse? / fine?).log2() / 2.0;
    ensure!((1.2..3.0).contains(&order), "time steps converge with order {order}, not 2");
    Ok(())
}
