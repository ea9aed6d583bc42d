//! `stickslip study`: a grid over entries of a scene.

use std::fmt::Write as _;
use std::io::{self, IsTerminal};

use scene::reading::show;
use study::{Axis, Entry, FinishedCase, Keep, Kind, Partial, Study, StudyError, StudyOptions, Table};

use crate::arguments::{Format, Quantity, StudyArguments, in_file};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Progress, interrupt};

/// Solves the cases and writes what was asked for.
pub fn run(arguments: &StudyArguments) -> Result<Ending, Failure> {
    let format = match (arguments.format, &arguments.output) {
        (Some(format), _) => Some(format),
        (None, Some(path)) => Some(output::full_format(path)?),
        (None, None) if io::stdout().is_terminal() => None,
        (None, None) => Some(Format::Json),
    };
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    output::distinct(&arguments.study, &[&arguments.output, &arguments.plot])?;
    let study = Study::from_file(&arguments.study).map_err(|error| refused(arguments, error))?;
    for file in study.files() {
        output::distinct(&file, &[&arguments.output, &arguments.plot])?;
    }
    let dof = drawn_dof(&study, arguments)?;
    if arguments.dry_run {
        return output::print(&plan(&study));
    }
    let interrupted = interrupt();
    let answer = Output::open(arguments.output.as_deref())?;
    let kept = match (&arguments.output, &answer) {
        // A device or a pipe has nothing beside it.
        (Some(path), Output::Beside { .. }) => {
            Some(Partial::open(&study, path, arguments.restart).map_err(|error| refused(arguments, error))?)
        }
        _ => None,
    };
    let (mut partial, known) = match kept {
        Some((partial, known)) => (Some(partial), known),
        None => (None, Vec::new()),
    };
    if !known.is_empty() {
        say(format_args!("{} of {} cases are finished already", known.len(), study.cases()));
    }

    let progress = Progress::of(study.cases(), "cases");
    let finished = |cases| progress.finished(cases);
    let mut keeper = |case: &FinishedCase| partial.as_mut().map_or(Ok(()), |partial| partial.keep(case));
    let solved = study.run(
        known,
        StudyOptions {
            threads: arguments.threads.map(usize::from),
            cancel: Some(interrupted),
            progress: Some(&finished),
            keeper: Some(&mut keeper),
        },
    );
    progress.clear();
    let cases = solved.map_err(|error| refused(arguments, error))?;

    let complete = cases.len() == study.cases();
    if let Some(partial) = partial {
        if !complete {
            let (done, all) = (cases.len(), study.cases());
            let path = partial.path().display();
            say(format_args!(
                "{done} of {all} cases are kept in {path}; the same command goes on from there"
            ));
            return Ok(Ending::Interrupted);
        }
        write(answer, format, &study, &cases)?;
        partial.remove();
    } else {
        write(answer, format, &study, &cases)?;
    }
    if let Some(figure) = figure {
        draw(figure, arguments, &study, &cases, dof)?;
    }
    Ok(match (complete, cases.iter().any(|case| case.failed > 0)) {
        (false, _) => Ending::Interrupted,
        (true, true) => Ending::SomeFailed,
        (true, false) => Ending::Done,
    })
}

fn refused(arguments: &StudyArguments, error: StudyError) -> Failure {
    match error {
        StudyError::Keeping { .. } => Failure::Output(anyhow::Error::new(error)),
        StudyError::Unreadable { .. } | StudyError::OtherStudy { .. } | StudyError::Busy { .. } => {
            Failure::input(error)
        }
        error => in_file(&arguments.study, error),
    }
}

fn write(
    answer: Output,
    format: Option<Format>,
    study: &Study,
    cases: &[FinishedCase],
) -> Result<(), Failure> {
    let table = Table { study, cases };
    match format {
        Some(Format::Json) => answer.write(|out| table.write_json(out)),
        Some(Format::Csv) => answer.write(|out| table.write_csv(out)),
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
fn drawn_dof(study: &Study, arguments: &StudyArguments) -> Result<usize, Failure> {
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
    arguments: &StudyArguments,
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
