//! `loop`: a measured record, a series over loop phase, or two amplitudes.

use std::path::Path;

use contact::{Law, ScaledLoop};
use hysteresis::{Column, Columns, FitError, FitSettings, ForceSign, Loop, Note, ReadOptions, Record, Units};
use num_complex::Complex64;

use crate::error::SceneError;
use crate::read::{Node, Object};
use crate::records::Records;

pub(crate) const KEYS: [&str; 7] =
    ["file", "columns", "units", "force_sign", "displacement", "force", "harmonics"];
pub(crate) const QUANTITIES: [&str; 3] = ["time", "displacement", "force"];

/// Harmonics of a loop beyond this are a slip of the pen.
const MOST_HARMONICS: usize = 4096;
/// Difference in rad between a loop's phase and eq. (7) that is worth a word.
const PHASE_MISMATCH: f64 = 0.02;

/// Scatter relative to |F_1| that is worth a word.
const SCATTER: f64 = 1e-3;

/// A loop as a scene gives it.
#[derive(Debug, Clone)]
pub(crate) enum MeasuredLoop {
    /// Displacement amplitude in m and first force harmonic in N.
    Ellipse { displacement: f64, force: f64 },
    /// All harmonics, noise relative to |F_1|, and what the fit noticed.
    Series { hysteresis_loop: Loop, noise: f64, notes: Vec<String> },
}

/// Reads `loop`.
pub(crate) fn read(node: &Node, records: &Records) -> Result<MeasuredLoop, SceneError> {
    let entry = node.object("file, or displacement with force or harmonics", &KEYS)?;
    if let Some(file) = entry.get("file") {
        entry.without(
            &["displacement", "force", "harmonics"],
            "is one too many beside \"file\"; keep one of them",
        )?;
        return read_record(&entry, &file, records);
    }
    entry.without(&["columns", "units", "force_sign"], "belongs to a \"file\", and there is none")?;
    let displacement = entry.need("displacement", "8e-6, the amplitude in m, or \"file\": \"record.csv\"")?;
    let amplitude = displacement.positive()?;
    match (entry.get("force"), entry.get("harmonics")) {
        (Some(force), None) => Ok(MeasuredLoop::Ellipse { displacement: amplitude, force: force.positive()? }),
        (None, Some(harmonics)) => {
            let series = read_series(&harmonics)?;
            let hysteresis_loop = Loop::new(amplitude, series).map_err(|error| harmonics.error(error.to_string()))?;
            Ok(MeasuredLoop::Series { hysteresis_loop, noise: 0.0, notes: Vec::new() })
        }
        _ => Err(entry.error("needs \"force\" (first harmonic in N) or \"harmonics\" ([[1, re, im], …]) beside \"displacement\"")),
    }
}

/// `[[k, re, im], …]`
fn read_series(node: &Node) -> Result<Vec<Complex64>, SceneError> {
    let mut series: Vec<Option<Complex64>> = Vec::new();
    for item in node.some("[[1, re, im], [3, re, im]]")? {
        let form = "[k, re, im]";
        let parts = item.list(form)?;
        let [k, re, im] = parts.as_slice() else {
            return Err(item.error(format!("must be {form}, got {} number(s)", parts.len())));
        };
        let order = k.whole(0, MOST_HARMONICS)?;
        let value = Complex64::new(re.number()?, im.number()?);
        if series.len() <= order {
            series.resize(order + 1, None);
        }
        match series.get_mut(order) {
            Some(slot @ None) => *slot = Some(value),
            _ => return Err(k.error(format!("harmonic {order} is given twice; keep one"))),
        }
    }
    Ok(series.into_iter().map(Option::unwrap_or_default).collect())
}

fn read_record(entry: &Object, file: &Node, records: &Records) -> Result<MeasuredLoop, SceneError> {
    let mut options = ReadOptions::default();
    if let Some(columns) = entry.get("columns") {
        options.columns = read_columns(&columns)?;
    }
    if let Some(units) = entry.get("units") {
        options.units = read_units(&units)?;
    }
    if let Some(sign) = entry.get("force_sign") {
        options.force_sign = ForceSign::try_from(sign.number()?).map_err(|problem| sign.error(problem))?;
    }
    let name = file.text("the name of a record's file")?;
    records.get(name, &options, |path| fit_record(path, &options, file))
}

/// Fits the record at `path`, which the scene names in `file`.
fn fit_record(path: &Path, options: &ReadOptions, file: &Node) -> Result<MeasuredLoop, SceneError> {
    let record = Record::read(path, options).map_err(|error| file.error(error.to_string()))?;
    let fit = hysteresis::fit(&record, &FitSettings::default()).map_err(|error| match error {
        FitError::AgainstMotion { .. } if options.force_sign == ForceSign::Reaction => file.error(format!(
            "{}: with \"force_sign\": -1 the force drives the motion; leave \"force_sign\" out",
            path.display()
        )),
        error => file.error(format!("{}: {error}", path.display())),
    })?;
    // What becomes of even harmonics is said below; what is the usual course is said by `loop fit`.
    let usual = |note: &Note| {
        matches!(note, Note::Asymmetric { .. } | Note::Harmonics { .. } | Note::RunUpRunDown { .. })
    };
    let mut notes: Vec<String> =
        fit.notes.iter().filter(|note| !usual(note)).map(ToString::to_string).collect();
    let chatters = fit.notes.iter().any(|note| matches!(note, Note::Chatter { .. }));
    if fit.noise > SCATTER && !chatters {
        notes
            .push(format!("the record scatters by {:.2} % of |F_1| about its mean cycle", 100.0 * fit.noise));
    }
    Ok(MeasuredLoop::Series { hysteresis_loop: fit.hysteresis_loop, noise: fit.noise, notes })
}

fn read_columns(node: &Node) -> Result<Columns, SceneError> {
    let columns = node.object("displacement, force, time: names or numbers of columns", &QUANTITIES)?;
    let column = |key: &str| columns.get(key).map(|node| read_column(&node)).transpose();
    Ok(Columns { time: column("time")?, displacement: column("displacement")?, force: column("force")? })
}

/// A name in the header, or a number from 1.
fn read_column(node: &Node) -> Result<Column, SceneError> {
    if node.is_number() {
        return Ok(Column::Number(node.whole(1, 1_000_000)?));
    }
    let what = "a column: its name in the header, or its number, 1 being the first";
    Ok(Column::Name(node.text(what)?.to_owned()))
}

fn read_units(node: &Node) -> Result<Units, SceneError> {
    let units = node.object("displacement, force, time: units such as \"um\", \"N\", \"s\"", &QUANTITIES)?;
    Ok(Units {
        time: read_unit(units.get("time"))?,
        displacement: read_unit(units.get("displacement"))?,
        force: read_unit(units.get("force"))?,
    })
}

fn read_unit<U: std::str::FromStr<Err: std::fmt::Display>>(
    node: Option<Node>,
) -> Result<Option<U>, SceneError> {
    let parse =
        |node: Node| node.text("a unit")?.parse().map_err(|error: U::Err| node.error(error.to_string()));
    node.map(parse).transpose()
}

/// What a user should know about a loop under the paper's law.
pub(crate) fn notes(measured: &Loop, law: &ScaledLoop) -> Vec<String> {
    let mut notes = Vec::new();
    notes.extend(even_note("the loop's", measured.even_content(), law.nature().odd));
    let mismatch = law.phase_mismatch();
    if mismatch.abs() > PHASE_MISMATCH {
        notes.push(format!(
            "the loop's own phase is {:.3} π, eq. (7) gives {:.3} π at its amplitude; the equation is used",
            measured.phase() / std::f64::consts::PI,
            (measured.phase() - mismatch) / std::f64::consts::PI
        ));
    }
    notes
}

/// What becomes of even harmonics, when there are any.
pub(crate) fn even_note(whose: &str, even: f64, odd: bool) -> Option<String> {
    let what = if odd {
        "is taken out (\"symmetric\": false keeps it)"
    } else {
        "is kept, so even harmonics and the mean are solved for (\"symmetric\": true takes it out)"
    };
    (even > 0.0).then(|| format!("{whose} even content, {:.2} % of |F_1|, {what}", 100.0 * even))
}
