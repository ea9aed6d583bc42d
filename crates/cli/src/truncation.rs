//! `stickslip truncation`: error and time against the number of harmonics.

use std::fmt::Write as _;

use arrays::{Cell, Kind};
use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, presets};
use scene::Harmonics;
use study::{Row, Truncation, TruncationOptions, truncation};

use crate::arguments::{TableFormat, TruncationArguments, in_file, read_scene};
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Progress, interrupt, posed};
use crate::summary::duration;

/// Frequencies up to which every row is printed; of more the worst a number of harmonics.
const EVERY_ROW: usize = 8;

/// Compares and writes what was asked for.
pub fn run(arguments: &TruncationArguments) -> Result<Ending, Failure> {
    let format = output::table_format(arguments.format, arguments.output.as_deref())?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    output::distinct(&arguments.scene, &[&arguments.output, &arguments.plot])?;
    let mut scene = read_scene(&arguments.scene)?;
    for n in &arguments.harmonics {
        let refused = |error| Failure::input(format!("--{error}"));
        scene.clone().with_harmonics(Harmonics::All(*n)).map_err(refused)?;
    }
    if let Some(frequencies) = &arguments.frequencies {
        scene = scene.with_frequencies(frequencies.clone());
    }
    let interrupted = interrupt();
    let answer = Output::open(arguments.output.as_deref())?;

    // What a large structure needs is made here, where it can be watched, and found again below.
    if let Some(largest) = arguments.harmonics.iter().max() {
        let ready = scene.clone().with_harmonics(Harmonics::All(*largest));
        let ready = ready.map_err(|error| in_file(&arguments.scene, error))?;
        posed(&ready).map_err(|error| in_file(&arguments.scene, error))?;
    }
    let progress = Progress::of(scene.frequencies().as_slice().len(), "frequencies");
    let finished = |count| progress.finished(count);
    let options = TruncationOptions {
        threads: arguments.threads.map(usize::from),
        cancel: Some(interrupted),
        progress: Some(&finished),
    };
    let study = truncation(&scene, &arguments.harmonics, &options);
    progress.clear();
    let study = study.map_err(|error| in_file(&arguments.scene, error))?;

    answer.write(|out| match format {
        TableFormat::Text => out.write_all(text(&study).as_bytes()),
        TableFormat::Json => scene::write_json(out, &study),
        flat => output::table(out, flat, &rows(&study), &study.scene),
    })?;
    if format != TableFormat::Text {
        for note in &study.notes {
            say(format_args!("note: {note}"));
        }
    }
    if let Some(figure) = figure {
        figure::truncation(figure, &study, arguments.require)?;
    }
    Ok(ending(&study, arguments.require))
}

/// Says what misses the tolerance.
fn ending(study: &Truncation, require: Option<f64>) -> Ending {
    if study.interrupted {
        return Ending::Interrupted;
    }
    let missed = require.map(|tolerance| (tolerance, study.misses(tolerance))).unwrap_or_default();
    let (tolerance, rows) = missed;
    for row in rows.iter().take(EVERY_ROW) {
        let Row { harmonics, frequency, .. } = row;
        match row.error {
            Some(error) => say(format_args!(
                "missed: N = {harmonics} has an error of {error:.2e} at {frequency} Hz, {tolerance:e} is required"
            )),
            None => say(format_args!("missed: N = {harmonics} has no known error at {frequency} Hz")),
        }
    }
    if rows.len() > EVERY_ROW {
        say(format_args!("and {} more frequencies", rows.len() - EVERY_ROW));
    }
    let unsolved = study.rows.iter().any(|row| row.error.is_none());
    if unsolved || !rows.is_empty() { Ending::SomeFailed } else { Ending::Done }
}

/// Every row, for programs.
fn rows(study: &Truncation) -> arrays::Table<'_> {
    let columns = [
        ("frequency", Kind::Plain),
        ("harmonics", Kind::Whole),
        ("status", Kind::Text),
        ("error", Kind::Number),
        ("error_first", Kind::Number),
        ("error_peak", Kind::Number),
        ("error_dissipation", Kind::Number),
        ("estimate", Kind::Number),
        ("seconds", Kind::Number),
        ("reference", Kind::Text),
    ];
    arrays::Table::new(columns, |take| {
        study.rows.iter().try_for_each(|row| {
            take(&[
                Cell::Number(row.frequency),
                Cell::Whole(row.harmonics),
                Cell::Text(row.status),
                row.error.into(),
                row.error_first.into(),
                row.error_peak.into(),
                row.error_dissipation.into(),
                row.estimate.into(),
                Cell::Number(row.seconds),
                Cell::Text(row.reference.as_deref().unwrap_or(&study.reference)),
            ])
        })
    })
}

fn text(study: &Truncation) -> String {
    let against = match study.reference.strip_prefix("harmonics:") {
        Some(n) => format!("N = {n}"),
        None => "the exact orbit".into(),
    };
    let many = study.rates.len() > EVERY_ROW;
    let mut text = format!(
        "{}: relative errors against {against}, the worst of {}\n",
        study.scene,
        study.dofs.join(", ")
    );
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}", if many { worst(study) } else { every(study) });
    for rate in study.rates.iter().filter(|_| !many) {
        if let Some(exponent) = rate.error {
            let _ = writeln!(text, "at {} Hz the error falls like (N+1)^{exponent:.1}", rate.frequency);
        }
    }
    for note in &study.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

fn small(value: Option<f64>) -> String {
    value.map_or("-".into(), |value| format!("{value:.1e}"))
}

/// One line a frequency and number of harmonics.
fn every(study: &Truncation) -> Table {
    let header =
        ["Hz", "N", "error", "of |W_1|", "of the peak", "of the dissipation", "estimate", "time", ""];
    table(
        &header,
        study.rows.iter().map(|row| {
            let remark = match (row.status, &row.reference) {
                ("converged", None) => String::new(),
                ("converged", Some(reference)) => format!("against {reference}"),
                (status, _) => status.to_owned(),
            };
            vec![
                row.frequency.to_string(),
                row.harmonics.to_string(),
                small(row.error),
                small(row.error_first),
                small(row.error_peak),
                small(row.error_dissipation),
                small(row.estimate),
                duration(row.seconds),
                remark,
            ]
        }),
    )
}

/// One line a number of harmonics: the worst frequency and the median ones.
fn worst(study: &Truncation) -> Table {
    let header = [
        "N",
        "worst error",
        "at Hz",
        "median error",
        "worst of |W_1|",
        "worst of the peak",
        "median time",
        "unknown",
    ];
    table(
        &header,
        study.harmonics.iter().map(|n| {
            let rows = || study.rows.iter().filter(|row| row.harmonics == *n);
            let worst = |of: fn(&Row) -> Option<f64>| {
                rows().filter_map(|row| Some((of(row)?, row.frequency))).max_by(|a, b| a.0.total_cmp(&b.0))
            };
            let unknown = rows().filter(|row| row.error.is_none()).count();
            let error = worst(|row| row.error);
            vec![
                n.to_string(),
                small(error.map(|(error, _)| error)),
                error.map_or("-".into(), |(_, hertz)| hertz.to_string()),
                small(median(rows().filter_map(|row| row.error))),
                small(worst(|row| row.error_first).map(|(error, _)| error)),
                small(worst(|row| row.error_peak).map(|(error, _)| error)),
                median(rows().map(|row| row.seconds)).map_or("-".into(), duration),
                if unknown > 0 { unknown.to_string() } else { String::new() },
            ]
        }),
    )
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::NOTHING.header_separator(LineStyle::none().fill('─').junction('─')))
        .set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(header);
    for row in rows {
        table.add_row(row);
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
