//! `stickslip sweep`: the forced response of a scene.

use std::sync::atomic::{AtomicBool, Ordering};

use scene::{Frequencies, Outcome, Prepared, RunOptions, Solved};

use crate::arguments::{SweepArguments, TableFormat};
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Progress, interrupt, prepared};
use crate::{summary, waveform};

/// Where the result goes, and in which form.
enum Wanted {
    /// A short table on the terminal.
    Table,
    /// Everything.
    Full(Output, TableFormat),
}

/// Solves the scene and writes what was asked for.
pub fn run(arguments: &SweepArguments) -> Result<Ending, Failure> {
    let format = output::full_format(arguments.format, arguments.output.as_deref())?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    let loops = arguments.loops.as_deref().map(Figure::new).transpose()?;
    let files = [&arguments.output, &arguments.waveform, &arguments.plot, &arguments.loops];
    output::distinct(&arguments.scene.scene, &files)?;
    let mut scene = arguments.scene.read()?;
    if let Some(frequency) = arguments.at {
        let one = Frequencies::one(frequency).map_err(|error| Failure::input(format!("--at: {error}")))?;
        if frequency == 0.0 {
            return Err(Failure::input("--at: at 0 Hz nothing moves; name a positive frequency"));
        }
        scene = scene.with_frequencies(one);
    }
    if arguments.all_solutions {
        scene = scene.with_all_solutions();
    }
    if arguments.stability {
        scene = scene.with_stability();
    }
    let prepared = prepared(&scene).map_err(|error| arguments.scene.unsolvable(error))?;

    let interrupted = interrupt();
    // Outputs are opened before the work: what cannot be written is known at once.
    let result = match format {
        Some(format) => Wanted::Full(Output::open(arguments.output.as_deref())?, format),
        None => Wanted::Table,
    };
    let period = arguments.waveform.as_deref().map(|path| Output::open(Some(path))).transpose()?;

    let solved = solve(&prepared, arguments, interrupted);
    let outcome = solved.outcome();
    write(result, &solved, &outcome)?;
    if period.is_some() || loops.is_some() {
        match solved.motion() {
            Some(motion) => {
                period.map(|output| waveform::write(output, &scene, &motion)).transpose()?;
                loops.map(|figure| figure::contact_loops(figure, &scene, &motion)).transpose()?;
            }
            None => say(format_args!("no waveform was written: the point was not solved")),
        }
    }
    if let Some(figure) = figure {
        figure::response(figure, &scene, &solved)?;
    }
    Ok(ending(&solved))
}

fn solve<'p>(prepared: &'p Prepared, arguments: &SweepArguments, interrupted: &AtomicBool) -> Solved<'p> {
    let progress = Progress::new(prepared.points());
    let finished = |points| progress.finished(points);
    let options = RunOptions {
        threads: arguments.threads.map(usize::from),
        cancel: Some(interrupted),
        progress: Some(&finished),
    };
    let mut solved = prepared.solve(&options);
    solved.judge(&|problem, orders, solution| match interrupted.load(Ordering::Relaxed) {
        true => Err("stopped before".into()),
        false => study::stability(problem, orders, solution),
    });
    progress.clear();
    solved
}

fn write(result: Wanted, solved: &Solved, outcome: &Outcome) -> Result<(), Failure> {
    let (output, format) = match result {
        Wanted::Table => return summary::print(solved, outcome),
        Wanted::Full(output, format) => (output, format),
    };
    output.write(|out| match format {
        TableFormat::Json => scene::write_json(out, outcome),
        TableFormat::Npz => outcome.write_npz(out),
        flat => output::table(out, flat, &outcome.table(), &outcome.scene),
    })?;
    for note in &outcome.notes {
        say(format_args!("note: {note}"));
    }
    Ok(())
}

fn ending(solved: &Solved) -> Ending {
    let failed = solved.solutions().iter().any(|solution| !solution.status.solved());
    match (solved.interrupted(), failed) {
        (true, _) => Ending::Interrupted,
        (false, true) => Ending::SomeFailed,
        (false, false) => Ending::Done,
    }
}
