//! `stickslip loop scale`: the scaling laws, eqs (6) and (7), from loops at several amplitudes.

mod answer;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use arrays::{Cell, Kind};
use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, presets};
use contact::identification::{
    self, Estimate, Identification, IdentificationError, IdentificationSettings, LoopPoint, Note, Weighting,
    identify,
};

use answer::Answer;

use crate::arguments::{Magnitude, ScaleArguments, TableFormat, Weights};
use crate::check::count;
use crate::ending::{Ending, Failure};
use crate::figure::{self, Figure};
use crate::loop_fit::{digits, measured};
use crate::output::{self, Output};

/// Fits every record, identifies the laws and says what came out.
pub fn run(arguments: &ScaleArguments) -> Result<Ending, Failure> {
    let format = output::table_format(arguments.format, None)?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    let files = &arguments.files;
    for (i, file) in files.iter().enumerate() {
        if files.iter().skip(i + 1).any(|other| same(file, other)) {
            return Err(Failure::input(format!("{} is given twice; it is one loop", file.display())));
        }
    }
    let place = |wanted: &PathBuf| {
        files.iter().position(|file| same(file, wanted)).ok_or_else(|| {
            Failure::input(format!("--reference {}: it must be one of the records", wanted.display()))
        })
    };
    let settings = IdentificationSettings {
        magnitude: match arguments.magnitude {
            Magnitude::TurningPoints => identification::Magnitude::TurningPoints,
            Magnitude::FirstHarmonic => identification::Magnitude::FirstHarmonic,
        },
        weighting: match arguments.weights {
            Weights::Equal => Weighting::Equal,
            Weights::Noise => Weighting::Noise,
        },
        reference: arguments.reference.as_ref().map(place).transpose()?,
    };
    let point = |file: &PathBuf| Ok(LoopPoint::from(&measured(file, &arguments.reading)?.1));
    let points = files.iter().map(point).collect::<Result<Vec<_>, Failure>>()?;
    let found = identify(&points, &settings).map_err(|error| refused(error, files))?;
    let result = Scaling { found: &found, files };

    match format {
        TableFormat::Text => output::print(&result.text())?,
        TableFormat::Json => output::print_json(&Answer::of(&result))?,
        flat => Output::Stdout
            .write(|out| output::table(out, flat, &result.rows(), "loop scale"))
            .map(|()| Ending::Done)?,
    };
    if let Some(figure) = figure {
        figure::scaling(figure, &found)?;
    }
    Ok(Ending::Done)
}

/// Whether two names are one file.
fn same(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// An error that knows the file rather than its number.
fn refused(error: IdentificationError, files: &[PathBuf]) -> Failure {
    let index = match error {
        IdentificationError::BadLoop { index, .. } | IdentificationError::UnknownNoise { index } => index,
        error => return Failure::input(error),
    };
    let file = files.get(index).map(|file| file.display().to_string()).unwrap_or_default();
    Failure::input(format!("{file}: {error}"))
}

/// What was found, with the names of the records.
struct Scaling<'a> {
    found: &'a Identification,
    files: &'a [PathBuf],
}

impl Scaling<'_> {
    fn file(&self, index: usize) -> String {
        self.files.get(index).map(|file| file.display().to_string()).unwrap_or_default()
    }

    fn is_passive(&self) -> bool {
        !self.found.notes.iter().any(|note| matches!(note, Note::NotPassive(_)))
    }

    fn estimates(&self) -> impl Iterator<Item = (&'static str, &Estimate)> {
        let magnitude = self.found.magnitude.estimates.iter().map(|estimate| ("magnitude", estimate));
        magnitude.chain(self.found.phase.estimates.iter().map(|estimate| ("phase", estimate)))
    }

    /// The six numbers, one a row; empty where there is no error.
    fn rows(&self) -> arrays::Table<'_> {
        let columns = [
            ("law", Kind::Text),
            ("parameter", Kind::Text),
            ("value", Kind::Plain),
            ("std_error", Kind::Plain),
            ("lower", Kind::Plain),
            ("upper", Kind::Plain),
        ];
        arrays::Table::new(columns, |take| {
            self.estimates().try_for_each(|(law, estimate)| {
                let Estimate { parameter, value, std_error, interval } = *estimate;
                take(&[
                    Cell::Text(law),
                    Cell::Text(parameter.name()),
                    Cell::Number(value),
                    std_error.into(),
                    interval.map(|ends| ends.0).into(),
                    interval.map(|ends| ends.1).into(),
                ])
            })
        })
    }

    fn text(&self) -> String {
        let found = self.found;
        let reference = &found.reference;
        let (force, symbol) = match found.kind {
            identification::Magnitude::TurningPoints => ("force at the turning points", "F"),
            identification::Magnitude::FirstHarmonic => ("first harmonic of the force", "|F_1|"),
        };
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{}, relative to {}: W* = {} m, F* = {} N ({force})\n",
            count(found.points.len(), "loop", "loops"),
            self.file(reference.index),
            digits(reference.displacement),
            digits(reference.force)
        );
        let _ =
            writeln!(text, "g(α) = offset + slope ln(α + shift)\nψ(α) = limit − span e^(−decay α), rad\n");
        let _ = writeln!(text, "{}\n\n{}\n", self.numbers(), self.loops(symbol));
        let _ = writeln!(
            text,
            "residuals, root mean square: {:.2e} of F* in magnitude, {:.2e} rad in phase, {:.2e} of F* together",
            found.magnitude.residual_rms, found.phase.residual_rms, found.residual_rms
        );
        let _ = writeln!(text, "errors: {}", self.source_of_errors());
        for note in &found.notes {
            let _ = writeln!(text, "note: {note}");
        }
        if self.is_passive() {
            let (g, psi) = (found.magnitude.law, found.phase.law);
            let _ = writeln!(
                text,
                "\nfor the scaled_loop law of a scene whose loop is {}:\n\
                 \"magnitude\": {{ \"offset\": {}, \"slope\": {}, \"shift\": {} }},\n\
                 \"phase\": {{ \"limit\": {}, \"span\": {}, \"decay\": {} }}",
                self.file(reference.index),
                short(g.offset),
                short(g.slope),
                short(g.shift),
                short(psi.limit),
                short(psi.span),
                short(psi.decay)
            );
        }
        text
    }

    fn source_of_errors(&self) -> String {
        let freedom = self.found.magnitude.freedom;
        match self.found.weighting {
            Weighting::Equal if freedom == 0 => "none, as three loops determine three numbers".into(),
            Weighting::Equal => format!(
                "from the scatter of the loops about the law, Student's t with {}",
                count(freedom, "degree of freedom", "degrees of freedom")
            ),
            Weighting::Noise => {
                "from the measured noise of the loops, or their scatter where it is larger".into()
            }
        }
    }

    fn numbers(&self) -> Table {
        let mut table = table(["", "value", "std. error", "95 % interval"]);
        for (_, estimate) in self.estimates() {
            let Estimate { parameter, value, std_error, interval } = *estimate;
            table.add_row([
                parameter.to_string(),
                digits(value),
                std_error.map_or("-".into(), |error| format!("{error:.1e}")),
                interval.map_or("-".into(), |(low, high)| format!("{} … {}", digits(low), digits(high))),
            ]);
        }
        aligned(table)
    }

    fn loops(&self, symbol: &str) -> Table {
        let force = format!("{symbol}/F*");
        let mut table = table(["loop", "α", &force, "− g(α)", "phase [rad]", "− ψ(α) [rad]"]);
        for (index, point) in self.found.points.iter().enumerate() {
            table.add_row([
                self.file(index),
                digits(point.alpha),
                format!("{:.4}", point.magnitude),
                format!("{:+.1e}", point.magnitude_residual),
                format!("{:.4}", point.phase),
                format!("{:+.1e}", point.phase_residual),
            ]);
        }
        aligned(table)
    }
}

fn table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::NOTHING.header_separator(LineStyle::none().fill('─').junction('─')))
        .set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(header);
    table
}

/// Names on the left, numbers on the right.
fn aligned(mut table: Table) -> Table {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// Nine digits: enough where a large offset and a large slope nearly cancel.
fn short(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
