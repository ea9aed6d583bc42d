//! What can be asked for: commands, flags and their help.

#[cfg(feature = "report")]
mod reports;
mod studies;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use hysteresis::{Columns, ForceSign, ReadOptions, Units};
use scene::{Frequencies, Harmonics, Scene};

#[cfg(feature = "report")]
pub use reports::ReportArguments;
pub use studies::{
    BackboneArguments, ContinueArguments, MergeArguments, OrbitArguments, PeaksArguments, Quantity,
    StudyArguments, StudyResultArguments, TruncationArguments,
};

use crate::ending::Failure;
use crate::progress::Waiting;

const OVERVIEW: &str = "\
Examples:
  stickslip init                                   an example scene, to look at and to change
  stickslip sweep two-mass.json                    its forced response: peaks, worst points, time
  stickslip sweep two-mass.json -o response.json   the full result
  stickslip explain two-mass.json                  what this scene needs, what it leaves out, and why
  stickslip truncation two-mass.json               how many harmonics it needs
  stickslip orbit scene.json --frequency 57        the exact periodic motion at 57 Hz
  stickslip backbone scene.json                    natural frequency and damping against amplitude
  stickslip peaks scene.json --vary /contacts/0/law/slip_force --from 1 --to 100 --log
                                                   the best slip force of a damper
  stickslip study damper.json -o peaks.csv         a grid over entries of a scene
  stickslip report response.json -o report.html    a page to look at it in a browser
  stickslip loop fit record.csv                    what is in a measured loop
  stickslip loop scale loops/*.csv                 how loops scale with their amplitude

Exit codes:
  0  all points solved               3    the output cannot be written
  1  some points not solved,         130  stopped by Ctrl-C; finished points are kept
     or --require missed
  2  bad scene, record or arguments";

/// Forced response of structures with measured friction loops, by multi-harmonic balance.
#[derive(Debug, Parser)]
#[command(version, about, after_help = OVERVIEW, arg_required_else_help = true, propagate_version = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a scene at its frequencies
    #[command(after_help = SWEEP)]
    Sweep(SweepArguments),
    /// Say what a scene needs, what it leaves out, and why
    #[command(after_help = "Example:\n  stickslip explain two-mass.json --harmonics 7")]
    Explain(ExplainArguments),
    /// Read and check a scene, nothing else
    #[command(after_help = "Example:\n  stickslip check two-mass.json && echo fine")]
    Check(SceneArguments),
    /// Say how many harmonics a scene needs: error and time against N
    #[command(after_help = studies::TRUNCATION)]
    Truncation(TruncationArguments),
    /// Find the exact periodic motion at one frequency, without harmonics
    #[command(after_help = studies::ORBIT)]
    Orbit(OrbitArguments),
    /// Follow the response as a curve, through its folds
    #[command(after_help = studies::CONTINUE)]
    Continue(ContinueArguments),
    /// Follow a damped nonlinear mode: natural frequency and damping against amplitude
    #[command(after_help = studies::BACKBONE)]
    Backbone(BackboneArguments),
    /// Follow the highest peak over an entry of a scene, and find where it is lowest: damper optimisation
    #[command(after_help = studies::PEAKS)]
    Peaks(PeaksArguments),
    /// Solve a scene over a grid of its entries: peaks against excitation, normal load, harmonics
    #[command(after_help = studies::STUDY)]
    Study(StudyArguments),
    /// Put the parts of a study together that several machines solved
    #[command(after_help = studies::MERGE)]
    Merge(MergeArguments),
    /// Show results as one HTML page: curves, loops, waveforms, error estimates
    #[cfg(feature = "report")]
    #[command(after_help = reports::REPORT)]
    Report(ReportArguments),
    /// Look at measured friction loops
    #[command(subcommand, arg_required_else_help = true)]
    Loop(LoopCommand),
    /// Write an example scene and its loop into the current folder
    #[command(after_help = "Example:\n  stickslip init two-mass && stickslip sweep two-mass.json")]
    Init(InitArguments),
    /// Print the JSON Schema of a scene or a study, for editors
    #[command(after_help = SCHEMA)]
    Schema {
        /// Of which file
        #[arg(value_enum, default_value = "scene")]
        of: Described,
    },
    /// Print the completions of a shell
    #[command(
        after_help = "Example:\n  stickslip completions bash > ~/.local/share/bash-completion/completions/stickslip"
    )]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    #[command(after_help = MAN)]
    Man {
        /// The page of one command
        command: Vec<String>,
        /// Write the pages of all commands into FOLDER instead
        #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
        all: Option<PathBuf>,
    },
}

const SCHEMA: &str = "\
Examples:
  stickslip schema > scene.schema.json
  stickslip schema study > study.schema.json

A scene that begins with \"$schema\": \"scene.schema.json\" is then completed and checked while it is written; a study likewise.";

const MAN: &str = "\
Examples:
  stickslip man | man -l -
  stickslip man sweep | man -l -
  stickslip man loop fit | man -l -
  stickslip man --all ~/.local/share/man/man1";

const SWEEP: &str = "\
To a terminal without -o a short table is printed: peaks, worst points, time. Everything else gets the full result.

Examples:
  stickslip sweep blade.json
  stickslip sweep blade.json --harmonics 7 --frequencies 20:200:721 -o response.csv
  stickslip sweep blade.json -o response.npz                  arrays for numpy.load
  stickslip sweep blade.json --plot response.svg
  stickslip sweep blade.json --at 57 --waveform motion.csv
  stickslip sweep blade.json | jq '.points[] | select(.status == \"failed\")'";

/// A scene, and what the command line changes in it.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene's file, JSON
    pub scene: PathBuf,
    /// Solve for N harmonics instead of the scene's, or, as 1e-6:63, for as many as each point needs
    #[arg(long, value_name = "N|TOLERANCE:MAX")]
    pub harmonics: Option<Harmonics>,
    /// Solve at other frequencies than the scene's, in Hz
    #[arg(long, value_name = FREQUENCIES)]
    pub frequencies: Option<Frequencies>,
}

/// How frequencies are written.
const FREQUENCIES: &str = "FROM:TO:POINTS[:log]|HZ,HZ,…";

/// Reads a scene's file.
pub fn read_scene(path: &Path) -> Result<Scene, Failure> {
    let _waiting = Waiting::new(format!("reading {}", path.display()));
    Scene::from_file(path).map_err(|error| match error {
        unreadable @ scene::SceneError::Unreadable { .. } => Failure::input(unreadable),
        error => in_file(path, error),
    })
}

/// An error about what is written in a file.
pub fn in_file(path: &Path, error: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure::Input(anyhow::Error::new(error).context(path.display().to_string()))
}

impl SceneArguments {
    /// Reads the scene and changes it as asked for.
    pub fn read(&self) -> Result<Scene, Failure> {
        let mut scene = read_scene(&self.scene)?;
        if let Some(harmonics) = self.harmonics {
            scene = scene.with_harmonics(harmonics).map_err(|error| Failure::input(format!("--{error}")))?;
        }
        if let Some(frequencies) = &self.frequencies {
            scene = scene.with_frequencies(frequencies.clone());
        }
        Ok(scene)
    }

    /// An error that turned up when the scene was made ready.
    pub fn unsolvable(&self, error: scene::SceneError) -> Failure {
        in_file(&self.scene, error)
    }
}

/// `stickslip sweep`.
#[derive(Debug, Args)]
#[command(group(clap::ArgGroup::new("period").args(["waveform", "loops"]).multiple(true)))]
pub struct SweepArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "T")]
    pub threads: Option<NonZeroUsize>,
    /// Form of the result [default: by the extension of -o, else json]
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// Write the result to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the response of every output dof, with contacts and without
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
    /// Solve this one frequency instead, for --waveform and --loops
    #[arg(
        long,
        value_name = "HZ",
        requires = "period",
        conflicts_with = "frequencies",
        allow_negative_numbers = true
    )]
    pub at: Option<f64>,
    /// Write one period in time: displacements and contact forces, CSV
    #[arg(long, value_name = "FILE.csv", requires = "at")]
    pub waveform: Option<PathBuf>,
    /// Draw the loops of the contacts in that period: friction force against relative displacement
    #[arg(long, value_name = "FILE.svg|.png", requires = "at")]
    pub loops: Option<PathBuf>,
    /// List every solution where all are known (one contact, one harmonic), not the reported one alone
    #[arg(long)]
    pub all_solutions: bool,
    /// Find out whether every point is stable (Floquet multipliers)
    #[arg(long)]
    pub stability: bool,
}

/// `stickslip explain`.
#[derive(Debug, Args)]
pub struct ExplainArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Form of the answer
    #[arg(long, value_enum, default_value = "text")]
    pub format: TextFormat,
}

/// `stickslip loop …`.
#[derive(Debug, Subcommand)]
pub enum LoopCommand {
    /// Fit the Fourier series over loop phase to a measured record
    #[command(after_help = FIT)]
    Fit(FitArguments),
    /// Identify the scaling laws, eqs (6) and (7), from records at several amplitudes
    #[command(after_help = SCALE)]
    Scale(ScaleArguments),
}

const FIT: &str = "\
A record is a text table, one sample a line, with names and units in its first line:

  time [s],displacement [um],force [N]

or arrays of NumPy (.npy, .npz), variables of MATLAB (.mat up to -v7), or datasets 58 of a universal file (ASCII). The \
time is optional. Columns that are not recognised, units that are missing and a force with the wrong sign are given on the \
command line. A column is a name or a number; of a matrix among several variables data:2.

Examples:
  stickslip loop fit record.csv
  stickslip loop fit record.csv --plot loop.svg
  stickslip loop fit rig.txt --columns displacement=2,force=3 --units displacement=in,force=kip --flip-force
  stickslip loop fit rig.mat --columns displacement=disp,force=F --units displacement=um,force=N
  stickslip loop fit rig.npz --columns displacement=data:2,force=data:3 --units displacement=mm,force=N
  stickslip loop fit rig.uff --columns displacement=12+X,force=13+X";

/// How records are to be read.
#[derive(Debug, Args)]
pub struct ReadingArguments {
    /// Which column, variable or dataset holds what: its name, or its number from 1
    #[arg(long, visible_alias = "variables", value_name = "displacement=2,force=3")]
    pub columns: Option<Columns>,
    /// Units of the columns
    #[arg(long, value_name = "displacement=um,force=N")]
    pub units: Option<Units>,
    /// The force is the specimen's reaction: turn its sign
    #[arg(long)]
    pub flip_force: bool,
}

impl ReadingArguments {
    /// The same for the reader.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            columns: self.columns.clone().unwrap_or_default(),
            units: self.units.clone().unwrap_or_default(),
            force_sign: if self.flip_force { ForceSign::Reaction } else { ForceSign::Rig },
        }
    }
}

/// `stickslip loop fit`.
#[derive(Debug, Args)]
pub struct FitArguments {
    /// The record: a text table, .npy, .npz, .mat or .uff
    pub file: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArguments,
    /// Draw the averaged cycle and the fitted series
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
    /// Form of the answer [default: text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TextFormat>,
}

const SCALE: &str = "\
Each record is one loop; amplitudes must differ, three at least, six or more are good. The laws are

  g(α) = offset + slope ln(α + shift)          force over that of the reference loop
  ψ(α) = limit − span e^(−decay α)             phase of the force on the mass, rad

over α, the amplitude relative to the reference loop's. The reference is the largest loop; name it in the scene as the \
law's loop.

Examples:
  stickslip loop scale loops/*.csv
  stickslip loop scale loops/*.csv --magnitude first-harmonic --plot laws.svg
  stickslip loop scale loops/*.csv --reference loops/8um.csv | jq .law";

/// `stickslip loop scale`.
#[derive(Debug, Args)]
pub struct ScaleArguments {
    /// The records, one amplitude each
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Which force the magnitude law is fitted to
    #[arg(long, value_enum, default_value = "turning-points")]
    pub magnitude: Magnitude,
    /// What the loops count, and where the errors come from
    #[arg(long, value_enum, default_value = "equal")]
    pub weights: Weights,
    /// The record to which the laws are relative [default: the largest loop]
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArguments,
    /// Draw the loops and the laws over the amplitude
    #[arg(long, value_name = "FILE.svg|.png")]
    pub plot: Option<PathBuf>,
    /// Form of the answer [default: text to a terminal, else json]
    #[arg(long, value_enum)]
    pub format: Option<TableFormat>,
}

/// `stickslip init`.
#[derive(Debug, Args)]
pub struct InitArguments {
    /// Which example
    #[arg(value_enum, default_value = "two-mass")]
    pub template: Template,
    /// Replace files that are there already
    #[arg(long)]
    pub force: bool,
}

/// Files with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Described {
    /// A structure, its contacts, its excitation
    Scene,
    /// A grid over entries of a scene
    Study,
}

/// Forms of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Everything.
    Json,
    /// A flat table.
    Csv,
    /// Arrays for NumPy.
    Npz,
    /// The flat table for data frames.
    Parquet,
}

impl From<Format> for TableFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Json => Self::Json,
            Format::Csv => Self::Csv,
            Format::Npz => Self::Npz,
            Format::Parquet => Self::Parquet,
        }
    }
}

/// Forms of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TextFormat {
    /// For readers.
    Text,
    /// For programs.
    Json,
}

/// Forms of an answer that is a table as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TableFormat {
    /// For readers.
    Text,
    /// Everything, for programs.
    Json,
    /// The numbers alone, line by line.
    Csv,
    /// Arrays for NumPy.
    Npz,
    /// The numbers alone, for data frames.
    Parquet,
}

/// Forces of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Magnitude {
    /// The force at the turning points, as in the paper
    TurningPoints,
    /// The magnitude of the first harmonic
    FirstHarmonic,
}

/// Weights of loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Weights {
    /// All count the same; errors from their scatter about the law
    Equal,
    /// By measured noise; errors from noise, or scatter where it is larger
    Noise,
}

/// Example scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Template {
    /// Blade and root with a measured loop, one harmonic
    TwoMass,
    /// The same structure with elastic Coulomb friction, 31 harmonics
    ElasticCoulomb,
    /// Two masses with a hardening spring and a bent resonance
    Cubic,
    /// The paper's Fig. 4: a measured loop, and elastic Coulomb friction beside it
    #[value(name = "hoffmann-2017")]
    Hoffmann2017,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
