//! `stickslip study`: a grid over entries of a scene.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use scene::reading::show;
use study::{Axis, Entry, FinishedCase, Keep, Kind, Partial, Shard, Study, StudyError, StudyOptions, Table};

use crate::arguments::{
    MergeArguments, Quantity, StudyArguments, StudyResultArguments, TableFormat, in_file,
};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Progress, interrupt};

/// Solves the cases and writes what was asked for.
pub fn run(arguments: &StudyArguments) -> Result<Ending, Failure> {
    let path = &arguments.study;
    let wanted = match arguments.shard {
        Some(_) => None,
        None => Some(Wanted::of(&arguments.result, path)?),
    };
    let study = read(path, &arguments.result)?;
    let dof = drawn_dof(&study, &arguments.result)?;
    if arguments.dry_run {
        return output::print(&plan(&study));
    }
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    let to_solve = shard.cases(study.cases());
    let output = arguments.result.output.as_deref();
    if let (Some(shard), Some(path)) = (arguments.shard, output.filter(|path| path.exists())) {
        let known = Partial::finished(&study, path).map_err(|error| refused(&arguments.study, error))?;
        if !arguments.restart && known.iter().filter(|case| shard.has(case.case)).count() == to_solve {
            say(format_args!("part {shard} is finished already"));
            return Ok(ending(&known));
        }
    }
    let interrupted = interrupt();
    let answer = Output::open(output)?;
    let kept = match (output, &answer) {
        // A device or a pipe has nothing beside it.
        (Some(path), Output::Beside { .. }) => Some(
            Partial::open(&study, path, arguments.restart)
                .map_err(|error| refused(&arguments.study, error))?,
        ),
        _ => None,
    };
    let (mut partial, known) = match kept {
        Some((partial, known)) => (Some(partial), known),
        None => (None, Vec::new()),
    };
    if !known.is_empty() {
        say(format_args!("{} of {to_solve} cases are finished already", known.len()));
    }

    let progress = Progress::of(to_solve, "cases");
    let finished = |cases| progress.finished(cases);
    let mut keeper = |case: &FinishedCase| partial.as_mut().map_or(Ok(()), |partial| partial.keep(case));
    let solved = study.run(
        known,
        StudyOptions {
            shard: arguments.shard,
            threads: arguments.threads.map(usize::from),
            cancel: Some(interrupted),
            progress: Some(&finished),
            keeper: Some(&mut keeper),
        },
    );
    progress.clear();
    let cases = solved.map_err(|error| refused(&arguments.study, error))?;

    let complete = cases.iter().filter(|case| shard.has(case.case)).count() == to_solve;
    if let Some(partial) = partial.as_ref().filter(|_| !complete) {
        let (done, path) = (cases.len(), partial.path().display());
        say(format_args!(
            "{done} of {to_solve} cases are kept in {path}; the same command goes on from there"
        ));
        return Ok(Ending::Interrupted);
    }
    match (wanted, partial, output) {
        (None, Some(partial), Some(path)) => {
            partial.finish(path).map_err(|error| refused(&arguments.study, error))?;
        }
        (None, ..) => {
            return Err(Failure::input("--shard: -o must name a file, where finished cases are kept"));
        }
        (Some(wanted), partial, _) => {
            wanted.write(answer, &arguments.result, &study, &cases, dof)?;
            if let Some(partial) = partial {
                partial.remove();
            }
        }
    }
    Ok(if complete { ending(&cases) } else { Ending::Interrupted })
}

/// Puts the parts of a study together.
pub fn merge(arguments: &MergeArguments) -> Result<Ending, Failure> {
    let path = &arguments.study;
    let wanted = Wanted::of(&arguments.result, path)?;
    for part in &arguments.parts {
        output::distinct(part, &[&arguments.result.output, &arguments.result.plot])?;
    }
    let study = read(path, &arguments.result)?;
    let dof = drawn_dof(&study, &arguments.result)?;
    let mut all: BTreeMap<usize, FinishedCase> = BTreeMap::new();
    for part in &arguments.parts {
        let cases = Partial::finished(&study, part).map_err(|error| refused(path, error))?;
        all.extend(cases.into_iter().map(|case| (case.case, case)));
    }
    let missing: Vec<usize> = (0..study.cases()).filter(|case| !all.contains_key(case)).collect();
    if !missing.is_empty() {
        let first: Vec<String> = missing.iter().take(NAMED).map(usize::to_string).collect();
        let more = if missing.len() > NAMED { ", …" } else { "" };
        say(format_args!(
            "{} of {} cases are in none of the parts: {}{more}",
            missing.len(),
            study.cases(),
            first.join(", ")
        ));
        if !arguments.incomplete {
            say(format_args!("nothing was written; solve them, or merge what there is with --incomplete"));
            return Ok(Ending::SomeFailed);
        }
    }
    let cases: Vec<FinishedCase> = all.into_values().collect();
    let answer = Output::open(arguments.result.output.as_deref())?;
    wanted.write(answer, &arguments.result, &study, &cases, dof)?;
    Ok(if missing.is_empty() { ending(&cases) } else { Ending::SomeFailed })
}

/// Missing cases that a message names.
const NAMED: usize = 12;

fn ending(cases: &[FinishedCase]) -> Ending {
    if cases.iter().any(|case| case.failed > 0) { Ending::SomeFailed } else { Ending::Done }
}

/// Reads a study whose files must not be overwritten.
fn read(path: &Path, result: &StudyResultArguments) -> Result<Study, Failure> {
    let study = Study::from_file(path).map_err(|error| refused(path, error))?;
    for file in study.files() {
        output::distinct(&file, &[&result.output, &result.plot])?;
    }
    Ok(study)
}

/// The forms in which a result is wanted, looked at before anything is solved.
struct Wanted {
    /// Text where there is none.
    format: Option<TableFormat>,
    figure: Option<Figure>,
}

impl Wanted {
    fn of(result: &StudyResultArguments, study: &Path) -> Result<Self, Failure> {
        let format = output::full_format(result.format, result.output.as_deref())?;
        let figure = result.plot.as_deref().map(Figure::new).transpose()?;
        output::distinct(study, &[&result.output, &result.plot])?;
        Ok(Self { format, figure })
    }

    fn write(
        self,
        answer: Output,
        result: &StudyResultArguments,
        study: &Study,
        cases: &[FinishedCase],
        dof: usize,
    ) -> Result<(), Failure> {
        write(answer, self.format, study, cases)?;
        match self.figure {
            Some(figure) => draw(figure, result, study, cases, dof),
            None => Ok(()),
        }
    }
}

fn refused(study: &Path, error: StudyError) -> Failure {
    match error {
        StudyError::Keeping { .. } => Failure::Output(anyhow::Error::new(error)),
        StudyError::Unreadable { .. }
        | StudyError::OtherStudy { .. }
        | StudyError::NoCases { .. }
        | StudyError::Busy { .. } => Failure::input(error),
        error => in_file(study, error),
    }
}

fn write(
    answer: Output,
    format: Option<TableFormat>,
    study: &Study,
    cases: &[FinishedCase],
) -> Result<(), Failure> {
    let table = Table { study, cases };
    match format {
        Some(TableFormat::Json) => answer.write(|out| table.write_json(out)),
        Some(flat) => answer.write(|out| output::table(out, flat, &table.flat(), study.name())),
        None => output::print(&text(study, cases)).map(|_| ()),
    }
}

/// What there is to do.
fn plan(study: &Study) -> String {
    let mut text = format!("{}: {}", study.name(), count(study.cases(), "case", "cases"));
    let points = count(study.points(), "frequency", "frequencies");
    // Writing to a String cannot fail.
    let _ = writeln!(text, " of {points}, {} points to solve", study.cases() * study.points());
    for axis in study.axes() {
        let ends = axis
            .values
            .first()
            .zip(axis.values.last())
            .map(|(a, b)| (show(*a), show(*b)))
            .unwrap_or_default();
        let values = count(axis.values.len(), "value", "values");
        let _ = writeln!(text, "  {}: {values} from {} to {}", axis.pointer, ends.0, ends.1);
    }
    let harmonics: Vec<String> = study.harmonics().iter().map(ToString::to_string).collect();
    let _ = writeln!(text, "  harmonics: {}", harmonics.join(", "));
    let kept = if study.keep() == Keep::Peaks { "the maxima" } else { "every point" };
    let _ = writeln!(text, "  kept: {kept} of {}", study.dofs().join(", "));
    text
}

/// The cases with the lowest and the highest response of each dof.
fn text(study: &Study, cases: &[FinishedCase]) -> String {
    let mut text = plan(study);
    let numbered: Vec<(usize, Vec<Option<&Entry>>)> = cases
        .iter()
        .map(|case| (case.case, (0..study.dofs().len()).map(|dof| highest(case, dof)).collect()))
        .collect();
    for (i, dof) in study.dofs().iter().enumerate() {
        let known = || {
            numbered.iter().filter_map(|(case, entries)| {
                let entry = (*entries.get(i)?)?;
                Some((*case, entry, entry.amplitude?))
            })
        };
        let least = known().min_by(|a, b| a.2.total_cmp(&b.2));
        let most = known().max_by(|a, b| a.2.total_cmp(&b.2));
        for (word, found) in [("lowest", least), ("highest", most)] {
            if let Some((case, entry, amplitude)) = found {
                let place = words(study, case);
                let _ = writeln!(
                    text,
                    "{dof}: {word} peak {amplitude:.4e} m at {:.4} Hz, {place}",
                    entry.frequency
                );
            }
        }
    }
    let failed: usize = cases.iter().map(|case| case.failed).sum();
    if failed > 0 {
        let _ = writeln!(text, "{} not solved", count(failed, "point was", "points were"));
    }
    text
}

/// The values of a case.
fn words(study: &Study, case: usize) -> String {
    let case = study.case(case);
    let values = study.axes().iter().zip(&case.values);
    let values = values.map(|(axis, value)| format!("{} = {}", axis.pointer, show(*value)));
    values.chain([format!("N = {}", case.harmonics)]).collect::<Vec<_>>().join(", ")
}

/// The highest point of a dof's response.
fn highest(case: &FinishedCase, dof: usize) -> Option<&Entry> {
    let solved = |entry: &&Entry| entry.dof == dof && entry.amplitude.is_some() && entry.kind != Kind::Local;
    case.entries
        .iter()
        .filter(solved)
        .max_by(|a, b| a.amplitude.unwrap_or(0.0).total_cmp(&b.amplitude.unwrap_or(0.0)))
}

/// A quantity over the varied entries.
#[cfg_attr(not(feature = "plot"), expect(dead_code))]
pub struct Picture<'a> {
    /// One or two.
    pub axes: &'a [Axis],
    /// Its name and unit.
    pub quantity: (String, &'static str),
    /// A name and the values, the last axis fastest, for each number of harmonics.
    pub curves: Vec<(String, Vec<Option<f64>>)>,
}

/// The position of the dof that is drawn, where a picture is wanted.
fn drawn_dof(study: &Study, arguments: &StudyResultArguments) -> Result<usize, Failure> {
    if arguments.plot.is_none() {
        return Ok(0);
    }
    if !(1..=2).contains(&study.axes().len()) {
        let varied = count(study.axes().len(), "entry is", "entries are");
        return Err(Failure::input(format!("--plot: {varied} varied; a picture shows one or two")));
    }
    let Some(name) = &arguments.dof else { return Ok(0) };
    study.dofs().iter().position(|dof| dof == name).ok_or_else(|| {
        Failure::input(format!(
            "--dof: there is no output dof {name:?}; there are {}",
            study.dofs().join(", ")
        ))
    })
}

fn draw(
    figure: Figure,
    arguments: &StudyResultArguments,
    study: &Study,
    cases: &[FinishedCase],
    dof: usize,
) -> Result<(), Failure> {
    let name = study.dofs().get(dof).map_or("", String::as_str);
    let quantity = match arguments.quantity {
        Quantity::Amplitude => (format!("peak of {name}"), "m"),
        Quantity::First => (format!("first harmonic at peak, {name}"), "m"),
        Quantity::Frequency => (format!("frequency of peak, {name}"), "Hz"),
        Quantity::Dissipation => (format!("dissipation at peak, {name}"), "J"),
    };
    let value = |case: &FinishedCase| {
        let entry = highest(case, dof)?;
        match arguments.quantity {
            Quantity::Amplitude => entry.amplitude,
            Quantity::First => entry.first,
            Quantity::Frequency => Some(entry.frequency),
            Quantity::Dissipation => entry.dissipation,
        }
    };
    let harmonics = study.harmonics().len();
    let mut curves: Vec<(String, Vec<Option<f64>>)> = study
        .harmonics()
        .iter()
        .map(|n| (format!("N = {n}"), vec![None; study.cases() / harmonics.max(1)]))
        .collect();
    for case in cases {
        let place =
            curves.get_mut(case.case % harmonics).and_then(|(_, row)| row.get_mut(case.case / harmonics));
        if let Some(place) = place {
            *place = value(case);
        }
    }
    if study.axes().len() == 2 && harmonics > 1 {
        let last = study.harmonics().last().map(ToString::to_string).unwrap_or_default();
        say(format_args!("note: the picture shows N = {last}, the last of the harmonics"));
    }
    if curves.iter().all(|(_, row)| row.iter().all(Option::is_none)) {
        say(format_args!("no picture was drawn: no case has a peak"));
        return Ok(());
    }
    figure::study(figure, Picture { axes: study.axes(), quantity, curves })
}
