//! `stickslip peaks`: the highest peak over an entry of a scene, and where it is lowest.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};

use arrays::{Cell, Kind, Table};
use scene::{Harmonics, PeaksCurve, PeaksOptions, PeaksOutcome, PeaksPoint, Variants};

use crate::arguments::{PeaksArguments, TableFormat, in_file, read_scene};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Progress, interrupt};
use crate::summary::duration;

/// Rows of the table that a terminal gets, a number of harmonics.
const ROWS: usize = 12;

/// Parts into which the work of a number of harmonics is divided for the bar.
const PARTS: usize = 100;

/// Follows the peaks and writes what was asked for.
pub fn run(arguments: &PeaksArguments) -> Result<Ending, Failure> {
    let format = output::table_format(arguments.format, arguments.output.as_deref())?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    let path = &arguments.scene;
    output::distinct(path, &[&arguments.output, &arguments.plot])?;
    let mut scene = read_scene(path)?;
    for n in &arguments.harmonics {
        let refused = |error| Failure::input(format!("--{error}"));
        scene.clone().with_harmonics(Harmonics::All(*n)).map_err(refused)?;
    }
    if let Some(frequencies) = &arguments.frequencies {
        scene = scene.with_frequencies(frequencies.clone());
    }
    let variants = Variants::from_file(path).map_err(|error| in_file(path, error))?;
    let interrupted = interrupt();
    let runs = arguments.harmonics.len().max(1);
    let bar = Progress::of(runs * PARTS, "parts");
    // Runs come one after the other, and each begins with nothing done.
    let (run, last) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let progress = |done: usize, total: usize| {
        let part = PARTS * done / total.max(1);
        if part < last.swap(part, Ordering::Relaxed) && part == 0 {
            run.fetch_add(1, Ordering::Relaxed);
        }
        bar.finished(run.load(Ordering::Relaxed).min(runs - 1) * PARTS + part);
        !interrupted.load(Ordering::Relaxed)
    };
    let options = PeaksOptions {
        pointer: &arguments.vary,
        range: (arguments.from, arguments.to),
        logarithmic: arguments.log,
        points: arguments.points.into(),
        dof: arguments.dof.as_deref(),
        harmonics: &arguments.harmonics,
        threads: arguments.threads.map(usize::from),
        progress: &progress,
    };
    options.check(&variants).map_err(|error| Failure::input(format!("--{error}")))?;
    let answer = Output::open(arguments.output.as_deref())?;
    let found = scene.peaks(&variants, &options);
    bar.clear();
    let found = found.map_err(|error| in_file(path, error))?;

    answer.write(|out| match format {
        TableFormat::Text => out.write_all(text(&found).as_bytes()),
        TableFormat::Json => scene::write_json(out, &found),
        flat => output::table(out, flat, &rows(&found), &found.scene),
    })?;
    if format != TableFormat::Text {
        for note in &found.notes {
            say(format_args!("note: {note}"));
        }
    }
    let known = found.curves.iter().flat_map(|curve| &curve.points).any(|p| p.highest().is_some());
    match figure {
        Some(_) if !known => say(format_args!("note: without a peak there is no picture")),
        Some(figure) => figure::peaks(figure, &found)?,
        None => {}
    }
    let sound = |curve: &PeaksCurve| !curve.points.is_empty() && curve.points.iter().all(PeaksPoint::sound);
    Ok(match () {
        () if found.curves.iter().any(|curve| curve.end == "stopped") => Ending::Interrupted,
        () if found.curves.iter().all(sound) => Ending::Done,
        () => Ending::SomeFailed,
    })
}

/// Every peak, for programs; a value without one has a row of its own.
fn rows(found: &PeaksOutcome) -> Table<'_> {
    let columns = [
        ("harmonics", Kind::Whole),
        ("parameter", Kind::Number),
        ("status", Kind::Text),
        ("branch", Kind::Whole),
        ("frequency", Kind::Number),
        ("amplitude", Kind::Number),
        ("dissipation", Kind::Number),
    ];
    Table::new(columns, |take| {
        for curve in &found.curves {
            for point in &curve.points {
                let harmonics = Cell::Whole(curve.harmonics);
                let (parameter, status) = (Cell::Number(point.parameter), Cell::Text(point.status));
                if point.peaks.is_empty() {
                    let none = Cell::Missing;
                    take(&[harmonics, parameter, status, none, none, none, none])?;
                }
                for peak in &point.peaks {
                    let [hertz, amplitude, dissipation] =
                        [peak.point.frequency, peak.amplitude, peak.dissipation].map(Cell::Number);
                    let branch = Cell::Whole(peak.branch);
                    take(&[harmonics, parameter, status, branch, hertz, amplitude, dissipation])?;
                }
            }
        }
        Ok(())
    })
}

fn text(found: &PeaksOutcome) -> String {
    let mut text = String::new();
    for curve in &found.curves {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{}: highest peak of {} over {}, {}, N = {}",
            found.scene,
            found.dof,
            found.parameter,
            count(curve.points.len(), "value", "values"),
            curve.harmonics
        );
        let quantity = format!("|W_{}|", found.harmonic);
        let _ = writeln!(text, "{:>12} {:>14} {quantity:>14} {:>14}", "value", "frequency", "dissipation");
        let step = curve.points.len().div_ceil(ROWS).max(1);
        let last = curve.points.len().saturating_sub(1);
        for (i, point) in curve.points.iter().enumerate() {
            if i % step == 0 || i == last || !point.sound() {
                let _ = writeln!(text, "{}", row(point));
            }
        }
        let _ = writeln!(text, "{}", optimum(found, curve));
        let effort = curve.effort;
        let _ = writeln!(
            text,
            "{} with {} Newton steps, {} between them with {}",
            count(effort.surveys, "response surveyed", "responses surveyed"),
            effort.survey_steps,
            count(effort.searches, "peak sought", "peaks sought"),
            effort.search_steps
        );
    }
    for note in &found.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(text, "time: {}", duration(found.solve_s));
    text
}

fn row(point: &PeaksPoint) -> String {
    let value = format!("{:>12}", Short(point.parameter));
    let Some(peak) = point.peaks.first() else {
        let end = point.higher.filter(|_| point.sound());
        let why = end.map_or(point.status.into(), |(hertz, height)| {
            format!("in the range of frequencies; {height:.4e} m at its end, {hertz:.4} Hz")
        });
        return format!("{value} no peak: {why}");
    };
    let mark = match (point.sound(), point.higher) {
        (false, Some((hertz, height))) => format!("  {}: {height:.4e} m at {hertz:.4} Hz", point.status),
        (false, None) => format!("  {}", point.status),
        _ => String::new(),
    };
    format!(
        "{value} {:>11.5} Hz {:>12.5e} m {:>12.4e} J{mark}",
        peak.point.frequency, peak.amplitude, peak.dissipation
    )
}

/// A number for readers, short whatever its size.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rounded: f64 = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        let text = match rounded.abs() {
            0.0 | 1e-3..1e7 => format!("{rounded}"),
            _ => format!("{rounded:e}"),
        };
        f.pad(&text)
    }
}

/// The optimum in a sentence.
fn optimum(found: &PeaksOutcome, curve: &PeaksCurve) -> String {
    let known = curve.optimum.as_ref().and_then(|o| Some((o, o.point.highest()?)));
    let Some((optimum, peak)) = known else { return "the optimum is not known".into() };
    let unit = unit(&found.parameter);
    let value = format!("{:.8e}", optimum.point.parameter);
    let value: f64 = value.parse().unwrap_or(optimum.point.parameter);
    let place = format!("{value}{unit}");
    let height = format!("{:.6e} m at {:.6} Hz", peak.amplitude, peak.point.frequency);
    match optimum.kind {
        "end" => format!("lowest at the end of the range, {place}: {height}"),
        "crossing" => format!("optimum: {place}, where two peaks are equally high: {height}"),
        _ => format!("optimum: {place}, where the highest peak is lowest: {height}"),
    }
}

/// The unit of an entry whose name says it, with a space before it.
fn unit(pointer: &str) -> &'static str {
    match pointer.rsplit('/').next() {
        Some("slip_force" | "preload") => " N",
        Some("phase") => " rad",
        _ => "",
    }
}
