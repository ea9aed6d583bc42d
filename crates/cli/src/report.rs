//! `stickslip report`: results as one HTML page.

use std::fs;
use std::path::{Path, PathBuf};

use report::{Recorded, Report, ReportError, Source};

use crate::arguments::{ReportArguments, in_file};
use crate::ending::{Ending, Failure};
use crate::output::{self, Output};
use crate::progress::Waiting;

/// Reads the results and their scenes and writes the page.
pub fn run(arguments: &ReportArguments) -> Result<Ending, Failure> {
    if report::page().is_none() {
        return Err(Failure::input(ReportError::NoPage));
    }
    let output = Some(arguments.output.clone());
    for input in arguments.results.iter().chain(&arguments.scene) {
        output::distinct(input, &[&output])?;
    }
    let mut report = Report::default();
    for path in &arguments.results {
        let text = fs::read_to_string(path)
            .map_err(|error| Failure::input(format!("cannot read {}: {error}", path.display())))?;
        let recorded = Recorded::from_json(&text).map_err(|error| in_file(path, error))?;
        report.add(&label(path, &arguments.results), recorded).map_err(|error| in_file(path, error))?;
    }
    let waiting = Waiting::new("putting the results back into their scenes");
    for path in &arguments.scene {
        let source = Source::from_file(path).map_err(|error| match error {
            unreadable @ scene::SceneError::Unreadable { .. } => Failure::input(unreadable),
            error => in_file(path, error),
        })?;
        report.explain(&source).map_err(|error| in_file(path, error))?;
    }
    drop(waiting);
    let page = report.html().map_err(Failure::input)?;
    Output::open(Some(&arguments.output))?.write(|out| out.write_all(page.as_bytes()))?;
    Ok(Ending::Done)
}

/// The name of a result's file, or all of its path where that name is not its alone.
fn label(path: &Path, all: &[PathBuf]) -> String {
    let alone = all.iter().filter(|other| other.file_stem() == path.file_stem()).count() == 1;
    let stem = path.file_stem().filter(|_| alone);
    stem.map_or_else(|| path.display().to_string(), |stem| stem.to_string_lossy().into_owned())
}
