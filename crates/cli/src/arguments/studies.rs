//! Arguments of the commands that look at how good solutions are.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use scene::{Frequencies, Origin};
use study::Shard;

use super::{FREQUENCIES, Format, SceneArguments, TableFormat, TextFormat};

pub const TRUNCATION: &str = "\
Solutions with N harmonics are compared with the exact periodic motion where every contact law has a mechanism that can \
be followed in time, else with a solution of far more harmonics. The error is the relative l2 error of the displacement \
spectrum, the worst of the output dofs; the errors of |W_1|, of the peak and of the dissipated energy stand beside it.

Examples:
  stickslip truncation blade.json --frequencies 57,75,108
  stickslip truncation blade.json --harmonics 1,3,7,15,31,63 --plot error.svg
  stickslip truncation blade.json --harmonics 15 --require 1e-3      for CI: exit code 1 when it is missed
  stickslip truncation blade.json | jq '.rows[] | select(.harmonics == 15) | .error'";

/// `stickslip truncation`.
#[derive(Debug, Args)]
pub struct TruncationArguments {
    /// The scene's file, JSON
    pub scene: PathBuf,
    /// Numbers of harmonics to compare; those below an excited harmonic are skipped
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', default_value = "1,3,7,15,31")]
    pub harmonics: Vec<usize>,
    /// Exit with code 1 unless the largest N has at most this error at every frequency
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, allow_negative_numbers = true)]
    pub require: Option<f64>,
    /// Other frequencies than the scene's, in Hz
    #[arg(long, value_name = FREQUENCIES)]
    pub frequencies: Option<Frequencies>,
    /// Threads that look for the truth; solutions are timed one after the other [default: one a core]
    #[arg(long, value_name = "T")]
    pub threads: Option<NonZeroUsize>,
    /// Form of the answer [default: by the extension of -o, text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
    /// Write the answer to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the error against N, a curve a frequency
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tolerance) if f64::is_finite(tolerance) && tolerance > 0.0 => Ok(tolerance),
        _ => Err("must be a positive relative error, for example 1e-3".into()),
    }
}

pub const ORBIT: &str = "\
Every contact law must have a mechanism that can be followed in time: elastic Coulomb elements and springs, one by one \
or in parallel, and smooth forces. A measured loop has none; compare with many harmonics instead (stickslip truncation).

Examples:
  stickslip orbit elastic-coulomb.json --frequency 57
  stickslip orbit elastic-coulomb.json --frequency 62 --plot orbit.svg --waveform orbit.csv
  stickslip orbit elastic-coulomb.json --frequency 57 --format json | jq .events";

/// `stickslip orbit`.
#[derive(Debug, Args)]
pub struct OrbitArguments {
    /// The scene's file, JSON
    pub scene: PathBuf,
    /// The frequency of the excitation in Hz
    #[arg(long, value_name = "HZ", value_parser = hertz, allow_negative_numbers = true)]
    pub frequency: f64,
    /// Harmonics of the spectrum that is reported
    #[arg(long, value_name = "K", default_value = "31", value_parser = clap::value_parser!(u16).range(1..=4095))]
    pub harmonics: u16,
    /// Form of the answer [default: by the extension of -o, text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TextFormat>,
    /// Write the answer to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write one period in time: displacements, velocities and contact forces, CSV
    #[arg(long, value_name = "FILE.csv")]
    pub waveform: Option<PathBuf>,
    /// Draw displacements and contact forces over a period
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
}

fn hertz(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hertz) if f64::is_finite(hertz) && hertz > 0.0 => Ok(hertz),
        _ => Err("must be a positive number of Hz".into()),
    }
}

fn number(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if f64::is_finite(number) => Ok(number),
        _ => Err("must be a finite number".into()),
    }
}

pub const CONTINUE: &str = "\
The curve begins with the solution that a sweep reports at --from and is followed by its arc length, so it turns at folds \
instead of jumping, and passes every resonance. Folds and peaks are refined. All points have the same harmonics: with \
TOLERANCE:MAX these are MAX. Of --frequencies only the range counts. The exit code is 1 when the curve ends before --to; \
the points so far are written.

Examples:
  stickslip continue cubic.json                                   the range of the scene's frequencies
  stickslip continue cubic.json --from 46 --to 41 --harmonics 7   from above
  stickslip continue cubic.json --plot curve.svg -o curve.json
  stickslip continue cubic.json --along /excitation/0/amplitude --at 43.5 --from 0.1 --to 20";

/// `stickslip continue`.
#[derive(Debug, Args)]
pub struct ContinueArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the curve begins [default: the scene's lowest frequency, or the entry's value]
    #[arg(long, value_name = "VALUE", value_parser = number, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Where it ends [default: the scene's highest frequency]
    #[arg(long, value_name = "VALUE", value_parser = number, allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Follow a number of the scene (a JSON pointer) instead of the frequency
    #[arg(long, value_name = "/excitation/0/amplitude")]
    pub along: Option<String>,
    /// The frequency in Hz for --along
    #[arg(long, value_name = "HZ", value_parser = hertz, requires = "along", allow_negative_numbers = true)]
    pub at: Option<f64>,
    /// Form of the answer [default: by the extension of -o, text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
    /// Write the answer to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Find out whether every point is stable (Floquet multipliers)
    #[arg(long)]
    pub stability: bool,
    /// Draw the curve, one panel a dof; unstable parts dashed
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
}

pub const BACKBONE: &str = "\
The structure moves freely in one of its modes; a negative damping proportional to the mass keeps the motion going, and \
its size is the damping of the mode at that amplitude (the extended periodic motion concept). Of the excitation only a \
static preload acts; its other parts say at which factor on them a forced response has its resonance at an amplitude, \
which is a prediction from this mode alone: other modes near it are left out.

Examples:
  stickslip backbone elastic-coulomb.json                         the first mode, from all contacts stuck
  stickslip backbone elastic-coulomb.json --from free --mode 2    the second, from large amplitudes
  stickslip backbone elastic-coulomb.json --amplitudes 1e-6:1e-3 --harmonics 15 --plot backbone.svg
  stickslip backbone elastic-coulomb.json -o backbone.csv";

/// `stickslip backbone`.
#[derive(Debug, Args)]
pub struct BackboneArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Which mode, counted from one in the order of frequencies
    #[arg(long, value_name = "R", default_value = "1")]
    pub mode: NonZeroUsize,
    /// The linear structure whose modes are counted and from which the mode is followed
    #[arg(long, value_enum, default_value = "stuck")]
    pub from: From,
    /// The dof whose amplitude is given [default: the first that is excited]
    #[arg(long, value_name = "NAME")]
    pub dof: Option<String>,
    /// Smallest and largest amplitude |W_1| of that dof in m [default: 0.1 to 1000 times where a contact begins to slip]
    #[arg(long, value_name = "FROM:TO", value_parser = amplitudes)]
    pub amplitudes: Option<(Option<f64>, Option<f64>)>,
    /// Points wanted, evenly over the logarithm of the amplitude; more where the mode changes fast
    #[arg(long, value_name = "POINTS", default_value = "100", value_parser = clap::value_parser!(u16).range(2..))]
    pub points: u16,
    /// Form of the answer [default: by the extension of -o, text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
    /// Write the answer to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw natural frequency and damping ratio over the amplitude
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
}

/// From where a mode is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum From {
    /// All contacts stuck: from small amplitudes
    Stuck,
    /// Without contacts: from large amplitudes
    Free,
}

impl From {
    /// The same in the terms of the library.
    pub fn origin(self) -> Origin {
        match self {
            Self::Stuck => Origin::Stuck,
            Self::Free => Origin::Free,
        }
    }
}

/// FROM:TO, either of which may be left out.
fn amplitudes(text: &str) -> Result<(Option<f64>, Option<f64>), String> {
    let wrong = || "write two growing positive numbers of m, for example 1e-6:1e-3".to_owned();
    let (from, to) = text.split_once(':').ok_or_else(wrong)?;
    let end = |text: &str| match text.trim() {
        "" => Ok(None),
        text => text.parse().ok().filter(|a: &f64| *a > 0.0 && a.is_finite()).map(Some).ok_or_else(wrong),
    };
    match (end(from)?, end(to)?) {
        (Some(from), Some(to)) if from >= to => Err(wrong()),
        ends => Ok(ends),
    }
}

pub const PEAKS: &str = "\
The highest amplitude |W_1| of a dof over the frequencies of the scene, followed over an entry of it. At --points values \
the whole response is looked at; between them each peak is found from its neighbours in a few solutions, at as many values \
as the curve needs. The optimum is where the highest peak is lowest: the best slip force or normal load of a damper. The \
exit code is 1 when the highest peak is not known everywhere; those values are marked.

Examples:
  stickslip peaks damper.json --vary /contacts/0/law/slip_force --from 1 --to 100 --log
  stickslip peaks damper.json --vary /contacts/0/scale --from 0.1 --to 10 --log --harmonics 1,3,7 --plot peaks.svg
  stickslip peaks cubic.json --vary /excitation/0/amplitude --from 0.5 --to 20 -o peaks.csv";

/// `stickslip peaks`.
#[derive(Debug, Args)]
pub struct PeaksArguments {
    /// The scene's file, JSON
    pub scene: PathBuf,
    /// The number of the scene over which peaks are followed (a JSON pointer)
    #[arg(long, value_name = "/contacts/0/law/slip_force")]
    pub vary: String,
    /// Its smallest value
    #[arg(long, value_name = "VALUE", value_parser = number, allow_negative_numbers = true)]
    pub from: f64,
    /// Its largest value
    #[arg(long, value_name = "VALUE", value_parser = number, allow_negative_numbers = true)]
    pub to: f64,
    /// Space the values evenly over the logarithm
    #[arg(long)]
    pub log: bool,
    /// The dof whose amplitude counts [default: the first that is excited]
    #[arg(long, value_name = "NAME")]
    pub dof: Option<String>,
    /// Numbers of harmonics, a curve each [default: the scene's]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',')]
    pub harmonics: Vec<usize>,
    /// Other frequencies than the scene's, in Hz; only their range counts
    #[arg(long, value_name = FREQUENCIES)]
    pub frequencies: Option<Frequencies>,
    /// Values at which the whole response is looked at, ends included
    #[arg(long, value_name = "POINTS", default_value = "13", value_parser = clap::value_parser!(u16).range(2..))]
    pub points: u16,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "T")]
    pub threads: Option<NonZeroUsize>,
    /// Form of the answer [default: by the extension of -o, text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
    /// Write the answer to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the highest peak and its frequency over the entry
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
}

pub const STUDY: &str = "\
A study is a JSON file: a scene, entries of it that are varied (JSON pointers), numbers of harmonics, and what is kept:

  {
    \"scene\": \"blade.json\",
    \"vary\": {
      \"/contacts/0/law/slip_force\": {\"from\": 1, \"to\": 100, \"points\": 20, \"spacing\": \"log\"},
      \"/excitation/0/amplitude\": [5, 10, 20]
    },
    \"harmonics\": [1, 7],
    \"keep\": \"peaks\"
  }

Finished cases are kept in OUT.part beside the result: after Ctrl-C the same command goes on where it stopped.

Examples:
  stickslip study damper.json --dry-run                        what it would do
  stickslip study damper.json -o peaks.csv --plot peaks.svg
  stickslip study damper.json -o peaks.csv --restart           forget what was finished before
  stickslip study damper.json --shard 2/8 -o part2             the second of eight parts, on one of eight machines
  stickslip merge damper.json part* -o peaks.csv               the same result as without parts";

/// `stickslip study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The study's file, JSON
    pub study: PathBuf,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "T")]
    pub threads: Option<NonZeroUsize>,
    /// Begin anew instead of going on where an interrupted run stopped
    #[arg(long, requires = "output")]
    pub restart: bool,
    /// Say how many cases there are, and stop
    #[arg(long)]
    pub dry_run: bool,
    /// Solve part I of N alone; -o gets its finished cases, for stickslip merge
    #[arg(long, value_name = "I/N", requires = "output", conflicts_with_all = ["format", "plot", "dry_run"])]
    pub shard: Option<Shard>,
    #[command(flatten)]
    pub result: StudyResultArguments,
}

pub const MERGE: &str = "\
The parts may be in any order, and cases that are in several of them are the same. Cases that are in none are named, and the exit \
code is 1 unless --incomplete is given.

Examples:
  stickslip merge damper.json part1 part2 part3 -o peaks.csv
  stickslip merge damper.json part* -o peaks.csv --plot peaks.svg";

/// `stickslip merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The study's file, JSON
    pub study: PathBuf,
    /// What stickslip study --shard wrote
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// Write a result although cases are missing; it says so
    #[arg(long)]
    pub incomplete: bool,
    #[command(flatten)]
    pub result: StudyResultArguments,
}

/// What becomes of a study's finished cases.
#[derive(Debug, Args)]
pub struct StudyResultArguments {
    /// Form of the result [default: by the extension of -o, else json]
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// Write the result to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the response's highest point over one varied entry, or over two as a heat map
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
    /// What is drawn
    #[arg(long, value_enum, default_value = "amplitude", requires = "plot")]
    pub quantity: Quantity,
    /// The dof whose response is drawn [default: the first output dof]
    #[arg(long, value_name = "NAME", requires = "plot")]
    pub dof: Option<String>,
}

/// What a study's picture shows of the highest point of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Quantity {
    /// Half the peak-to-peak displacement
    Amplitude,
    /// The amplitude of the lowest excited harmonic
    First,
    /// Its frequency
    Frequency,
    /// The energy that all contacts dissipate in a period there
    Dissipation,
}
