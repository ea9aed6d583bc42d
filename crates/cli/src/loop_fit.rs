//! `stickslip loop fit`: what is in a measured loop.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::io::{self, IsTerminal};
use std::path::Path;

use hysteresis::{Fit, FitError, FitSettings, Record};
use scene::Spectrum;
use serde::Serialize;

use crate::arguments::{FitArguments, ReadingArguments, TextFormat};
use crate::ending::{Ending, Failure};
use crate::figure::{self, Figure};
use crate::output;

/// The answer for programs.
#[derive(Serialize)]
struct Answer {
    displacement_amplitude: f64,
    force_amplitude: f64,
    phase: f64,
    dissipation: f64,
    harmonics: Spectrum,
    cycles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    period: Option<f64>,
    noise: f64,
    even_content: f64,
    notes: Vec<String>,
}

/// Reads the record, fits it and says what came out.
pub fn run(arguments: &FitArguments) -> Result<Ending, Failure> {
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    let (record, fit) = measured(&arguments.file, &arguments.reading)?;
    let usual = if io::stdout().is_terminal() { TextFormat::Text } else { TextFormat::Json };
    match arguments.format.unwrap_or(usual) {
        TextFormat::Text => output::print(&text(&fit))?,
        TextFormat::Json => output::print_json(&answer(&fit))?,
    };
    if let Some(figure) = figure {
        figure::hysteresis_loop(figure, &record, &fit)?;
    }
    Ok(Ending::Done)
}

/// Reads a record and fits it.
pub fn measured(file: &Path, reading: &ReadingArguments) -> Result<(Record, Fit), Failure> {
    let record = Record::read(file, &reading.options()).map_err(Failure::input)?;
    match hysteresis::fit(&record, &FitSettings::default()) {
        Ok(fit) => Ok((record, fit)),
        Err(FitError::AgainstMotion { .. }) if reading.flip_force => Err(Failure::input(format!(
            "{}: with --flip-force the force drives the motion; leave --flip-force out",
            file.display()
        ))),
        Err(error) => Err(Failure::input(format!("{}: {error}", file.display()))),
    }
}

fn answer(fit: &Fit) -> Answer {
    let series = &fit.hysteresis_loop;
    let coefficients = series.coefficients().iter().copied().enumerate();
    Answer {
        displacement_amplitude: series.displacement_amplitude(),
        force_amplitude: series.force_amplitude(),
        phase: series.phase(),
        dissipation: series.dissipation(),
        harmonics: Spectrum(coefficients.filter(|(_, amplitude)| amplitude.norm() > 0.0).collect()),
        cycles: fit.cycles,
        period: fit.period,
        noise: fit.noise,
        even_content: fit.even_content,
        notes: fit.notes.iter().map(ToString::to_string).collect(),
    }
}

fn text(fit: &Fit) -> String {
    let series = &fit.hysteresis_loop;
    let mut lines = vec![
        (
            "displacement amplitude",
            format!("{} m (half peak-to-peak)", digits(series.displacement_amplitude())),
        ),
        ("force amplitude |F_1|", format!("{} N", digits(series.force_amplitude()))),
        ("phase of F_1", format!("{:.4} rad = {:.4} π", series.phase(), series.phase() / PI)),
        ("dissipation", format!("{} J a cycle", digits(series.dissipation()))),
        ("steady cycles", fit.cycles.to_string()),
    ];
    if let Some(period) = fit.period {
        lines.push(("period", format!("{} s ({} Hz)", digits(period), digits(1.0 / period))));
    }
    let kept: Vec<usize> = fit.kept_harmonics().collect();
    lines.extend([
        ("noise", format!("{:.2} % of |F_1|", 100.0 * fit.noise)),
        ("even content", format!("{:.2} % of |F_1|", 100.0 * fit.even_content)),
        ("harmonics above noise", format!("{}: {}", kept.len(), runs(&kept))),
    ]);
    let mut text = String::new();
    for (name, value) in lines {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:<24}{value}");
    }
    for note in &fit.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// "1, 3–31": neighbours are drawn together.
fn runs(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).filter_map(|run| Some((run.first()?, run.last()?)));
    let written = runs.map(|(first, last)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first}–{last}"),
    });
    written.collect::<Vec<_>>().join(", ")
}

/// Five digits, with a power of ten only where it is needed.
pub fn digits(value: f64) -> String {
    let magnitude = value.abs().log10().floor();
    if !(-2.0..5.0).contains(&magnitude) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - magnitude).max(0.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::{digits, runs};

    #[test]
    fn neighbours_are_drawn_together() {
        assert_eq!(runs(&[1, 3, 4, 5, 8, 9]), "1, 3–5, 8, 9");
        assert_eq!(runs(&[]), "");
    }

    #[test]
    fn five_digits() {
        assert_eq!(
            ["12.000", "0.050000", "8.0000e-6", "1.2346e5"],
            [12.0, 0.05, 8e-6, 123_456.0].map(digits)
        );
        assert_eq!(digits(0.0), "0.0000e0");
    }
}
