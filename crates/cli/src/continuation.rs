//! `stickslip continue`: the response as a curve, through its folds.

use std::fmt::Write as _;
use std::sync::atomic::Ordering;

use scene::{Along, ContinuationOptions, CurveOutcome, CurveOutcomePoint, Scene, Variants};

use crate::arguments::{ContinueArguments, TableFormat, in_file};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::{Waiting, interrupt};
use crate::summary::duration;

/// Follows the curve and writes what was asked for.
pub fn run(arguments: &ContinueArguments) -> Result<Ending, Failure> {
    let format = output::table_format(arguments.format, arguments.output.as_deref())?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    let path = &arguments.scene.scene;
    output::distinct(path, &[&arguments.output, &arguments.plot])?;
    let mut scene = arguments.scene.read()?;
    if arguments.stability {
        scene = scene.with_stability();
    }
    let variants = match &arguments.along {
        Some(_) => Some(Variants::from_file(path).map_err(|error| in_file(path, error))?),
        None => None,
    };
    let (along, range) = course(arguments, &scene, variants.as_ref())?;
    let interrupted = interrupt();
    let answer = Output::open(arguments.output.as_deref())?;
    let progress = |_: f64| !interrupted.load(Ordering::Relaxed);
    let options = ContinuationOptions { progress: &progress, ..ContinuationOptions::default() };
    let waiting = Waiting::new("following the curve");
    let curve = scene.curve_judged(along, range, variants.as_ref(), &options, Some(&study::stability));
    drop(waiting);
    let curve = curve.map_err(|error| arguments.scene.unsolvable(error))?;

    answer.write(|out| match format {
        TableFormat::Text => out.write_all(text(&curve).as_bytes()),
        TableFormat::Json => scene::write_json(out, &curve),
        TableFormat::Npz => curve.write_npz(out),
        flat => output::table(out, flat, &curve.table(), &curve.scene),
    })?;
    if format != TableFormat::Text {
        for note in &curve.notes {
            say(format_args!("note: {note}"));
        }
        if !curve.reason.is_empty() {
            say(format_args!("note: {}", ended(&curve)));
        }
    }
    match figure {
        Some(_) if curve.points.is_empty() => say(format_args!("note: without a point there is no picture")),
        Some(figure) => figure::curve(figure, &curve)?,
        None => {}
    }
    Ok(match curve.end {
        "reached" => Ending::Done,
        "stopped" => Ending::Interrupted,
        _ => Ending::SomeFailed,
    })
}

/// What the curve runs along, and from where to where.
fn course<'a>(
    arguments: &'a ContinueArguments,
    scene: &Scene,
    variants: Option<&Variants>,
) -> Result<(Along<'a>, (f64, f64)), Failure> {
    let listed = scene.frequencies().as_slice();
    let (Some(pointer), Some(variants)) = (&arguments.along, variants) else {
        let ends = listed.iter().copied().fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f), b.max(f)));
        let (from, to) = (arguments.from.unwrap_or(ends.0), arguments.to.unwrap_or(ends.1));
        if !(from > 0.0 && to > 0.0 && from != to) {
            return Err(Failure::input(format!(
                "a curve in the frequency needs two different positive ends, got {from} and {to} Hz; name them with \
                 --from and --to"
            )));
        }
        return Ok((Along::Frequency, (from, to)));
    };
    let now = variants.number(pointer).map_err(|why| Failure::input(format!("--along {pointer}: {why}")))?;
    if !FOLLOWED.iter().any(|part| pointer.starts_with(part)) {
        return Err(Failure::input(format!(
            "--along {pointer}: the motion at one frequency is no curve over it; name an entry of the model, the \
             excitation or a contact"
        )));
    }
    let frequency = match (arguments.at, listed) {
        (Some(hertz), _) => hertz,
        (None, [hertz]) => *hertz,
        _ => {
            return Err(Failure::input(
                "--along: at which frequency? The scene has several; name one with --at",
            ));
        }
    };
    let from = arguments.from.unwrap_or(now);
    let Some(to) = arguments.to.filter(|to| *to != from) else {
        return Err(Failure::input(format!(
            "--along: where to? {pointer} is {from}; name another value with --to"
        )));
    };
    // What lies between them is tried as well: entries that must be whole numbers have no curve.
    for value in [from, to, from + 0.382 * (to - from)] {
        let with = || format!("--along: with {pointer} = {value}");
        let scene = variants.scene(&[(pointer, value)]).and_then(|scene| scene.prepare().map(|_| ()));
        scene.map_err(|error| Failure::Input(anyhow::Error::new(error).context(with())))?;
    }
    Ok((Along::Entry { pointer, frequency }, (from, to)))
}

/// The parts of a scene on which the motion at one frequency depends without jumps.
const FOLLOWED: [&str; 3] = ["/model/", "/excitation/", "/contacts/"];

fn text(curve: &CurveOutcome) -> String {
    let mut text = String::new();
    let (first, last) = (curve.points.first(), curve.points.last());
    let harmonics = first.map_or(String::new(), |first| format!(", N = {}", first.point.harmonics));
    let ends = first.zip(last).map_or("no point".into(), |(first, last)| {
        let ends = [first, last].map(|point| place(curve, point.parameter));
        format!("{} from {} to {}", count(curve.points.len(), "point", "points"), ends[0], ends[1])
    });
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{} along {}: {ends}{harmonics}", curve.scene, curve.parameter);
    let amplitudes = |point: &CurveOutcomePoint| {
        let each = curve
            .dofs
            .iter()
            .enumerate()
            .filter_map(|(dof, name)| Some(format!("{name} {:.5e} m", curve.amplitude(dof, point)?)));
        each.collect::<Vec<_>>().join(", ")
    };
    for point in curve.points.iter().filter(|point| point.fold) {
        let _ = writeln!(text, "fold at {}: {}", place(curve, point.parameter), amplitudes(point));
    }
    for point in &curve.points {
        for name in &point.peaks {
            let dof = curve.dofs.iter().position(|dof| dof == name);
            if let Some(amplitude) = dof.and_then(|dof| curve.amplitude(dof, point)) {
                let at = place(curve, point.parameter);
                let _ = writeln!(text, "peak of {name} at {at}: {amplitude:.5e} m");
            }
        }
    }
    if !curve.reason.is_empty() {
        let _ = writeln!(text, "{}", ended(curve));
    }
    for note in &curve.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(text, "time: {}", duration(curve.solve_s));
    text
}

/// A place on the curve for readers, to eight digits.
fn place(curve: &CurveOutcome, parameter: f64) -> String {
    let unit = if curve.parameter == "frequency" { " Hz" } else { "" };
    let rounded: f64 = format!("{parameter:.7e}").parse().unwrap_or(parameter);
    match rounded.abs() {
        0.0 | 1e-3..1e7 => format!("{rounded}{unit}"),
        _ => format!("{rounded:e}{unit}"),
    }
}

fn ended(curve: &CurveOutcome) -> String {
    match curve.points.last() {
        Some(last) => format!("the curve ends at {}: {}", place(curve, last.parameter), curve.reason),
        None => format!("there is no curve: {}", curve.reason),
    }
}
