//! The `stickslip` command line: one command a file, one result mapped to one exit code.

mod arguments;
mod backbone;
mod check;
mod continuation;
mod ending;
mod explain;
mod figure;
mod init;
mod loop_fit;
mod loop_scale;
mod manual;
mod orbit;
mod output;
mod peak;
mod progress;
#[cfg(feature = "report")]
mod report;
mod study;
mod summary;
mod sweep;
mod truncation;
mod waveform;

use std::process::ExitCode;

use clap::Parser;

use crate::arguments::{Arguments, Command, Described, LoopCommand};
use crate::ending::{Ending, Failure, say};

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version arrive here too, with code 0; a closed pipe is no failure.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match run(&arguments.command) {
        Ok(ending) => ending.code(),
        Err(failure) => {
            if let Some(message) = failure.message() {
                say(format_args!("error: {message}"));
            }
            failure.code()
        }
    }
}

fn run(command: &Command) -> Result<Ending, Failure> {
    match command {
        Command::Sweep(arguments) => sweep::run(arguments),
        Command::Explain(arguments) => explain::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Truncation(arguments) => truncation::run(arguments),
        Command::Orbit(arguments) => orbit::run(arguments),
        Command::Continue(arguments) => continuation::run(arguments),
        Command::Backbone(arguments) => backbone::run(arguments),
        Command::Peaks(arguments) => peak::run(arguments),
        Command::Study(arguments) => study::run(arguments),
        Command::Merge(arguments) => study::merge(arguments),
        #[cfg(feature = "report")]
        Command::Report(arguments) => report::run(arguments),
        Command::Loop(LoopCommand::Fit(arguments)) => loop_fit::run(arguments),
        Command::Loop(LoopCommand::Scale(arguments)) => loop_scale::run(arguments),
        Command::Init(arguments) => init::run(arguments),
        Command::Schema { of: Described::Scene } => output::print(scene::SCHEMA),
        Command::Schema { of: Described::Study } => output::print(::study::SCHEMA),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Man { all: Some(folder), .. } => manual::pages(folder),
        Command::Man { command, all: None } => manual::page(command),
    }
}
