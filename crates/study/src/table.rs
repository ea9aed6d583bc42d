//! The result of a study: one flat table, as JSON or CSV.

use std::io::{self, Write};

use arrays::{Cell, Kind};
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

    /// The same as a flat table; the varied entries come first, named by their pointers.
    pub fn flat(&self) -> arrays::Table<'_> {
        let what = if self.study.keep() == Keep::Peaks { "peak" } else { "status" };
        let counts = self.study.harmonics().iter().all(|n| matches!(n, Harmonics::All(_)));
        let columns = [
            ("harmonics", if counts { Kind::Whole } else { Kind::Text }),
            ("dof", Kind::Text),
            ("frequency", Kind::Plain),
            (what, Kind::Text),
            ("amplitude", Kind::Number),
            ("first", Kind::Number),
            ("dissipation", Kind::Number),
            ("truncation_error", Kind::Number),
            ("failed", Kind::Whole),
        ];
        let pointers = self.study.axes().iter().map(|axis| (axis.pointer.as_str(), Kind::Plain));
        arrays::Table::new(pointers.chain(columns), move |take| {
            for (case, finished, entry) in self.rows() {
                let text = short(case.harmonics);
                let harmonics = match case.harmonics {
                    Harmonics::All(n) if counts => Cell::Whole(n),
                    _ => Cell::Text(&text),
                };
                let mut row: Vec<Cell> = case.values.iter().copied().map(Cell::Number).collect();
                row.extend([
                    harmonics,
                    Cell::Text(self.dof(entry)),
                    Cell::Number(entry.frequency),
                    Cell::Text(entry.kind.word()),
                    entry.amplitude.into(),
                    entry.first.into(),
                    entry.dissipation.into(),
                    entry.truncation_error.into(),
                    Cell::Whole(finished.failed),
                ]);
                take(&row)?;
            }
            Ok(())
        })
    }

    /// Writes it as CSV, one line a row.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        self.flat().write_csv(out)
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
