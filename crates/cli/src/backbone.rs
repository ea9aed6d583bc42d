//! `stickslip backbone`: natural frequency and damping ratio against amplitude.

use std::fmt::Write as _;
use std::sync::atomic::Ordering;

use arrays::{Cell, Kind, Table};
use scene::{BackboneOptions, BackboneOutcome, BackbonePoint};

use crate::arguments::{BackboneArguments, TableFormat};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::interrupt;
use crate::summary::duration;

/// Rows of the table that a terminal gets.
const ROWS: usize = 12;

/// Follows the mode and writes what was asked for.
pub fn run(arguments: &BackboneArguments) -> Result<Ending, Failure> {
    let format = output::table_format(arguments.format, arguments.output.as_deref())?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    output::distinct(&arguments.scene.scene, &[&arguments.output, &arguments.plot])?;
    let scene = arguments.scene.read()?;
    let interrupted = interrupt();
    let answer = Output::open(arguments.output.as_deref())?;
    let progress = |_: f64| !interrupted.load(Ordering::Relaxed);
    let options = BackboneOptions {
        mode: arguments.mode.get(),
        origin: arguments.from.origin(),
        dof: arguments.dof.as_deref(),
        amplitudes: arguments.amplitudes.unwrap_or_default(),
        points: arguments.points.into(),
        progress: &progress,
    };
    let mode = scene.backbone(&options).map_err(|error| arguments.scene.unsolvable(error))?;
    answer.write(|out| match format {
        TableFormat::Text => out.write_all(text(&mode).as_bytes()),
        TableFormat::Json => scene::write_json(out, &mode),
        flat => output::table(out, flat, &rows(&mode), &mode.scene),
    })?;
    if format != TableFormat::Text {
        for note in &mode.notes {
            say(format_args!("note: {note}"));
        }
        if !mode.reason.is_empty() {
            say(format_args!("note: {}", mode.reason));
        }
    }
    match figure {
        Some(_) if mode.points.is_empty() => say(format_args!("note: without a point there is no picture")),
        Some(figure) => figure::backbone(figure, &mode)?,
        None => {}
    }
    Ok(match mode.end {
        "reached" => Ending::Done,
        "stopped" => Ending::Interrupted,
        _ => Ending::SomeFailed,
    })
}

/// Every point, for programs.
fn rows(mode: &BackboneOutcome) -> Table<'_> {
    let columns = ["amplitude", "frequency", "damping_ratio", "modal_amplitude", "excitation", "resonance"];
    Table::new(columns.map(|name| (name, Kind::Number)), |take| {
        mode.points.iter().try_for_each(|point| {
            take(&[
                Cell::Number(point.amplitude),
                Cell::Number(point.point.frequency),
                Cell::Number(point.damping_ratio),
                Cell::Number(point.modal_amplitude),
                point.excitation.into(),
                point.resonance.into(),
            ])
        })
    })
}

fn text(mode: &BackboneOutcome) -> String {
    let mut text = String::new();
    let harmonics = mode.points.first().map_or(String::new(), |p| format!(", N = {}", p.point.harmonics));
    let points = count(mode.points.len(), "amplitude", "amplitudes");
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{}: mode {} from the {} structure, {points}{harmonics}",
        mode.scene, mode.mode, mode.origin
    );
    if !mode.points.is_empty() {
        let head = format!("|W_1| of {}", mode.dof);
        let _ = writeln!(text, "{head:>16}  frequency    damping  excitation  resonance");
    }
    let step = mode.points.len().div_ceil(ROWS).max(1);
    let last = mode.points.len().saturating_sub(1);
    for (i, point) in mode.points.iter().enumerate() {
        if i % step == 0 || i == last {
            let _ = writeln!(text, "{}", row(point));
        }
    }
    if let Some(expected) = mode.expected {
        let _ = writeln!(
            text,
            "at the scene's excitation: resonance near {:.5} Hz, {:.4e} m (natural frequency {:.5} Hz, damping {:.3} %)",
            expected.frequency,
            expected.amplitude,
            expected.natural_frequency,
            100.0 * expected.damping_ratio
        );
    }
    if !mode.reason.is_empty() {
        let _ = writeln!(text, "{}", mode.reason);
    }
    for note in &mode.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(text, "time: {}", duration(mode.solve_s));
    text
}

fn row(point: &BackbonePoint) -> String {
    let factor = point.excitation.map_or("-".into(), |factor| format!("× {factor:.4}"));
    let resonance = point.resonance.map_or("-".into(), |hertz| format!("{hertz:.4} Hz"));
    format!(
        "{:>14.4e} m {:>10.4} Hz {:>8.4} % {factor:>11} {resonance:>12}",
        point.amplitude,
        point.point.frequency,
        100.0 * point.damping_ratio
    )
}
