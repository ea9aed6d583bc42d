//! `cargo xtask estimates`: what the solver's error estimates are worth on every point of the scene library.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use hbm::{Plan, Settings, Solution};
use rayon::prelude::*;
use scene::Scene;
use study::{EstimateQuality, JudgedPoint};

use crate::library;
use crate::markdown::{significant, table};
use crate::truths::{self, Known};

/// N at which every point is judged.
const HARMONICS: [usize; 8] = [1, 3, 5, 7, 11, 15, 23, 31];
/// Most underestimated points that are listed.
const LISTED: usize = 15;

/// Judges every scene of the library, or those whose name contains one of `names`; prints tables and writes
/// `target/estimates.csv`.
pub(crate) fn run(root: &Path, names: &[&str]) -> Result<()> {
    let began = Instant::now();
    let points = judge_library(root, names)?;
    print!("{}", report(&points));
    let path = root.join("target").join("estimates.csv");
    fs::write(&path, csv(&points)).with_context(|| path.display().to_string())?;
    eprintln!("{}: {} points in {:.1} s", path.display(), points.len(), began.elapsed().as_secs_f64());
    Ok(())
}

/// Every scene of the library, or those whose name contains one of `names`.
pub(crate) fn judge_library(root: &Path, names: &[&str]) -> Result<Vec<JudgedPoint>> {
    let wanted = |scene: &Scene| names.is_empty() || names.iter().any(|name| scene.name().contains(name));
    let mut points = Vec::new();
    for scene in library::scenes(root)?.into_iter().filter(wanted) {
        let began = Instant::now();
        points.extend(judge(&scene)?);
        eprintln!("estimates of {}: {:.1} s", scene.name(), began.elapsed().as_secs_f64());
    }
    ensure!(!points.is_empty(), "no scene of the library has such a name");
    Ok(points)
}

/// Every frequency of `scene` at every N that carries its excitation.
fn judge(scene: &Scene) -> Result<Vec<JudgedPoint>> {
    let truths = truths::of_scene(scene, HARMONICS[HARMONICS.len() - 1], 0)?;
    let lowest = scene.problem()?.excitation.iter().map(|e| e.harmonic).max().unwrap_or(1);
    let mut points = Vec::new();
    for harmonics in HARMONICS.into_iter().filter(|n| *n >= lowest) {
        let mut settings = Settings::new(harmonics);
        settings.estimate = true;
        let plan = Plan::new(scene.problem()?, &settings)?;
        let judged: Vec<_> = truths
            .par_iter()
            .flatten()
            .map_init(
                || plan.workspace(),
                |workspace, truth| {
                    let solution = plan.solve(truth.truth.frequency, workspace);
                    point(scene.name(), harmonics, truth, &plan, &solution)
                },
            )
            .collect();
        points.extend(judged);
    }
    Ok(points)
}

fn point(scene: &str, harmonics: usize, known: &Known, plan: &Plan, solution: &Solution) -> JudgedPoint {
    let errors = known.truth.errors(plan.orders(), solution);
    let (error, peak) = errors.map_or((f64::INFINITY, 0.0), |errors| (errors.spectrum, errors.peak));
    let sampling = solution.sampling_error.unwrap_or(0.0);
    JudgedPoint {
        scene: scene.to_owned(),
        frequency: known.truth.frequency,
        harmonics,
        error,
        estimate: solution.truncation_error.map(|truncation| truncation.hypot(sampling)),
        reference_accuracy: known.accuracy,
        elsewhere: JudgedPoint::elsewhere(error, peak),
    }
}

fn report(points: &[JudgedPoint]) -> String {
    let count = |n: &usize| {
        let quality = EstimateQuality::of(points.iter().filter(|point| point.harmonics == *n));
        row(n.to_string(), quality)
    };
    let counts: Vec<_> = HARMONICS.iter().map(count).collect();
    format!(
        "{}\n{}\n{}\n{}",
        scene_table(&by_scene(points)),
        table(head("N"), &counts),
        worst(points),
        elsewhere(points)
    )
}

/// What estimates are worth scene by scene, on all, and on all whose motion is the truth's.
pub(crate) fn by_scene(points: &[JudgedPoint]) -> Vec<(String, Option<EstimateQuality>)> {
    let mut names: Vec<&str> = points.iter().map(|point| point.scene.as_str()).collect();
    names.dedup();
    let of = |label: &str, holds: &dyn Fn(&JudgedPoint) -> bool| {
        (label.to_owned(), EstimateQuality::of(points.iter().filter(|point| holds(point))))
    };
    let mut rows: Vec<_> = names.iter().map(|name| of(name, &|point| point.scene == *name)).collect();
    rows.push(of("all", &|_| true));
    rows.push(of("all on the truth's motion", &|point| !point.elsewhere));
    rows
}

/// The table of [`by_scene`].
pub(crate) fn scene_table(rows: &[(String, Option<EstimateQuality>)]) -> String {
    let rows: Vec<_> = rows.iter().map(|(label, quality)| row(label.clone(), *quality)).collect();
    table(head("scene"), &rows)
}

fn head(first: &str) -> [&str; 8] {
    [first, "points", "no estimate", "≥ error", "≤ 10 × error", "least", "median", "greatest ratio"]
}

/// Share of points whose estimate must not be below the error, and share of those where it must be close to it.
const REQUIRED: f64 = 0.95;

/// Fails when estimates are not worth what they were made for.
pub(crate) fn require(points: &[JudgedPoint]) -> Result<()> {
    let quality = EstimateQuality::of(points).context("no point has an estimate")?;
    ensure!(quality.without * 20 <= quality.points, "{} points have no estimate", quality.without);
    ensure!(quality.safe >= REQUIRED, "only {:.3} of the estimates are not below the error", quality.safe);
    ensure!(
        quality.tight >= REQUIRED,
        "only {:.3} of the estimates are within ten times the error",
        quality.tight
    );
    Ok(())
}

fn row(label: String, quality: Option<EstimateQuality>) -> [String; 8] {
    let dash = || "—".to_owned();
    match quality {
        None => [label, "0".to_owned(), dash(), dash(), dash(), dash(), dash(), dash()],
        Some(EstimateQuality { points, without, safe, tight, ratios: [least, median, greatest] }) => [
            label,
            points.to_string(),
            without.to_string(),
            format!("{:.1} %", 100.0 * safe),
            format!("{:.1} %", 100.0 * tight),
            significant(least, 2),
            significant(median, 2),
            significant(greatest, 2),
        ],
    }
}

/// The points whose estimate is furthest below, and furthest above the error.
fn worst(points: &[JudgedPoint]) -> String {
    let mut known: Vec<(f64, &JudgedPoint)> =
        points.iter().filter_map(|point| Some((point.ratio()?, point))).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let line = |(ratio, point): &(f64, &JudgedPoint)| {
        let JudgedPoint { scene, frequency, harmonics, error, .. } = point;
        let mark = if point.elsewhere { "elsewhere" } else { "" };
        [
            scene.clone(),
            format!("{frequency}"),
            harmonics.to_string(),
            format!("{error:.1e}"),
            significant(*ratio, 2),
            mark.to_owned(),
        ]
    };
    let low: Vec<_> = known.iter().filter(|(ratio, _)| *ratio < 1.0).take(LISTED).map(line).collect();
    let high: Vec<_> = known.iter().rev().filter(|(ratio, _)| *ratio > 10.0).take(LISTED).map(line).collect();
    let head = |what| [what, "Hz", "N", "error", "ratio", ""];
    format!(
        "{}\n{}",
        table(head("estimate furthest below the error"), &low),
        table(head("furthest above"), &high)
    )
}

/// Points whose motion is another one than the truth's.
fn elsewhere(points: &[JudgedPoint]) -> String {
    let mut text = String::from("other motions than the truth's (see `JudgedPoint::elsewhere`):\n");
    for point in points.iter().filter(|point| point.elsewhere) {
        let estimate = point.estimate.map_or("—".to_owned(), |estimate| format!("{estimate:.2}"));
        let JudgedPoint { scene, frequency, harmonics, error, .. } = point;
        let _ = writeln!(
            text,
            "  {scene}, {frequency} Hz, N = {harmonics}: error {error:.2}, estimate {estimate}"
        );
    }
    let lost = points.iter().filter(|point| !point.error.is_finite());
    for JudgedPoint { scene, frequency, harmonics, .. } in lost {
        let _ = writeln!(text, "  {scene}, {frequency} Hz, N = {harmonics}: not solved");
    }
    text
}

/// One line a point.
pub(crate) fn csv(points: &[JudgedPoint]) -> String {
    let mut text = String::from(
        "# True and estimated relative l2 errors of the displacement spectrum. Written by `cargo xtask estimates`.\n\
         scene,frequency,harmonics,error,estimate,reference_accuracy,elsewhere\n",
    );
    for point in points {
        let JudgedPoint { scene, frequency, harmonics, error, estimate, reference_accuracy, elsewhere } =
            point;
        let estimate = estimate.map_or(String::new(), |estimate| format!("{estimate:.3e}"));
        let _ = writeln!(
            text,
            "{scene},{frequency},{harmonics},{error:.3e},{estimate},{reference_accuracy:.1e},{elsewhere}"
        );
    }
    text
}
