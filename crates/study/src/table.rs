//! The result of a study: one flat table, as JSON or CSV.

use std::io::{self, Write};

use scene::{Harmonics, Named};
use serde::Serialize;
use serde_json::Value;

use crate::cases::{Entry, FinishedCase};
use crate::grid::{Case, Keep, Study};

/// The finished cases of a study.
pub struct Table<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its cases, in their order.
    pub cases: &'a [FinishedCase],
}

#[derive(Serialize)]
struct Answer<'a> {
    format_version: u32,
    study: &'a str,
    units: &'static str,
    keep: &'static str,
    vary: Vec<&'a str>,
    dofs: &'a [String],
    cases: usize,
    complete: bool,
    rows: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    case: usize,
    vary: Named<f64>,
    harmonics: Value,
    dof: &'a str,
    frequency: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak: Option<&'static str>,
    amplitude: Option<f64>,
    first: Option<f64>,
    dissipation: Option<f64>,
    truncation_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<usize>,
}

/// Columns beside the varied entries.
const COLUMNS: [&str; 9] = [
    "harmonics",
    "dof",
    "frequency",
    "what",
    "amplitude",
    "first",
    "dissipation",
    "truncation_error",
    "failed",
];

impl Table<'_> {
    fn rows(&self) -> impl Iterator<Item = (Case, &FinishedCase, &Entry)> {
        self.cases.iter().flat_map(|finished| {
            let case = self.study.case(finished.case);
            finished.entries.iter().map(move |entry| (case.clone(), finished, entry))
        })
    }

    fn dof(&self, entry: &Entry) -> &str {
        self.study.dofs().get(entry.dof).map_or("", String::as_str)
    }

    /// Writes it as JSON, one line a row.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_json(&self, out: impl Write) -> io::Result<()> {
        let study = self.study;
        let peaks = study.keep() == Keep::Peaks;
        let row = |(case, finished, entry): (Case, &FinishedCase, &Entry)| {
            let word = entry.kind.word();
            let names = study.axes().iter().map(|axis| axis.pointer.clone());
            Row {
                case: finished.case,
                vary: Named(names.zip(case.values).collect()),
                harmonics: harmonics(case.harmonics),
                dof: study.dofs().get(entry.dof).map_or("", String::as_str),
                frequency: entry.frequency,
                status: (!peaks).then_some(word),
                peak: peaks.then_some(word),
                amplitude: entry.amplitude,
                first: entry.first,
                dissipation: entry.dissipation,
                truncation_error: entry.truncation_error,
                failed: peaks.then_some(finished.failed),
            }
        };
        let answer = Answer {
            format_version: 1,
            study: study.name(),
            units: "SI, Hz, rad",
            keep: if peaks { "peaks" } else { "points" },
            vary: study.axes().iter().map(|axis| axis.pointer.as_str()).collect(),
            dofs: study.dofs(),
            cases: study.cases(),
            complete: self.cases.len() == study.cases(),
            rows: self.rows().map(row).collect(),
        };
        scene::write_json(out, &answer)
    }

    /// Writes it as CSV, one line a row; the varied entries come first, named by their pointers.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let mut table = csv::Writer::from_writer(out);
        let what = if self.study.keep() == Keep::Peaks { "peak" } else { "status" };
        let columns = COLUMNS.map(|column| if column == "what" { what } else { column });
        let pointers = self.study.axes().iter().map(|axis| axis.pointer.as_str());
        table.write_record(pointers.chain(columns))?;
        let cell = |value: Option<f64>| value.map(|value| format!("{value:e}")).unwrap_or_default();
        for (case, finished, entry) in self.rows() {
            let mut line: Vec<String> = case.values.iter().map(f64::to_string).collect();
            line.extend([
                short(case.harmonics),
                self.dof(entry).to_owned(),
                entry.frequency.to_string(),
                entry.kind.word().to_owned(),
                cell(entry.amplitude),
                cell(entry.first),
                cell(entry.dissipation),
                cell(entry.truncation_error),
                finished.failed.to_string(),
            ]);
            table.write_record(&line)?;
        }
        table.flush()
    }
}

/// N, or `"1e-6:63"`.
fn harmonics(harmonics: Harmonics) -> Value {
    match harmonics {
        Harmonics::All(n) => Value::from(n),
        Harmonics::Needed { .. } => Value::from(short(harmonics)),
    }
}

/// As the command line takes it.
pub(crate) fn short(harmonics: Harmonics) -> String {
    match harmonics {
        Harmonics::All(n) => n.to_string(),
        Harmonics::Needed { tolerance, max } => format!("{tolerance:e}:{max}"),
    }
}
