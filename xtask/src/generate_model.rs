//! `cargo xtask generate-model`: structures as a finite-element code would write them, without one.
//!
//! Steel, SI units, sizes of a real blade. What comes out is a folder with `mass.mtx`, `stiffness.mtx`, `dofs.txt` and
//! `scene.json`; equal options give equal bytes on one machine.

mod blade;
mod files;
mod hexahedron;
mod lumped;
mod material;
mod mesh;
mod plan;
mod resonances;
mod sector;
mod structure;
#[cfg(test)]
mod verification;

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use clap::{Parser, ValueEnum};

use self::blade::{Blade, Cells};
use self::files::{Contacts, Words};
use self::plan::{Generated, Pair, Site, choose_sites};
use self::sector::Sectors;

/// Structures for trying out the solver: Matrix Market files and a scene.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask generate-model", disable_version_flag = true)]
struct Options {
    /// What to build.
    kind: Kind,
    /// Folder for mass.mtx, stiffness.mtx, dofs.txt and scene.json; made if missing.
    #[arg(short, long)]
    output: PathBuf,
    /// About so many dofs in all (300, 1000, 10000, 50000, or any other number).
    #[arg(long, default_value_t = 1000)]
    dofs: usize,
    /// Elements along chord, thickness and span of a blade, instead of --dofs.
    #[arg(long, value_delimiter = ',', num_args = 3)]
    elements: Option<Vec<usize>>,
    /// Sectors of the whole disk.
    #[arg(long, default_value_t = 24)]
    sectors: usize,
    /// Contacts, spread evenly over the places of the structure; left out: one a blade, two for a sector. With --joints pairs
    /// of nodes.
    #[arg(long)]
    contacts: Option<usize>,
    /// Span of the blade in m.
    #[arg(long, default_value_t = 0.2)]
    length: f64,
    /// Chord at the root in m.
    #[arg(long, default_value_t = 0.045)]
    chord: f64,
    /// Thickness at the root in m.
    #[arg(long, default_value_t = 0.006)]
    thickness: f64,
    /// Chord and thickness of the tip over those of the root.
    #[arg(long, default_value_t = 0.7)]
    taper: f64,
    /// Angle between root and tip in degrees.
    #[arg(long, default_value_t = 30.0)]
    twist: f64,
    /// Thickness of the edges over that of the middle of the chord.
    #[arg(long, default_value_t = 0.4)]
    edge: f64,
    /// Stiffness of all contacts of a blade together in N/m.
    #[arg(long, default_value_t = 2e5)]
    stiffness: f64,
    /// Slip force of all contacts of a blade together in N.
    #[arg(long, default_value_t = 5.0)]
    slip_force: f64,
    /// Amplitude of the force on each blade in N; left out for a ring: 50, for a sector with --joints: 10, as less hardly
    /// makes their contacts slip.
    #[arg(long, default_value_t = 1.0, default_value_ifs([("kind", "ring", "50"), ("joints", "true", "10")]))]
    force: f64,
    /// Shrouds touch in three directions: friction along the axis and outwards under a normal load around it, with the
    /// stiffness in all of them, and a preload under which a contact slips at the slip force.
    #[arg(long)]
    joints: bool,
    /// Waves around a ring with which the forces travel; left out: an eighth of the sectors.
    #[arg(long)]
    engine_order: Option<usize>,
    /// Rayleigh damping with a ratio of 0.002 at the first natural frequency and at five times it, instead of the same
    /// ratio in every mode.
    #[arg(long)]
    rayleigh: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// A blade alone, clamped at its root, rubbing with its tip.
    Blade,
    /// A blade with its part of the disk and a shroud that rubs against the ground.
    Sector,
    /// Sectors around a disk, coupled by it and by friction between the shrouds.
    Ring,
    /// A ring of three masses a sector; --dofs and sizes play no role.
    Lumped,
}

/// Damping ratio of the first mode, and of all others unless damping is Rayleigh's.
const RATIO: f64 = 0.002;

/// Builds what `words` ask for.
pub(crate) fn run(words: &[&str]) -> Result<()> {
    let program = std::iter::once(&"cargo xtask generate-model");
    let options = match Options::try_parse_from(program.chain(words)) {
        Ok(options) => options,
        Err(error) if error.use_stderr() => bail!("{error}"),
        Err(help) => return Ok(help.print()?),
    };
    let start = Instant::now();
    let generated = options.generate()?;
    let count = options.contacts.unwrap_or(match options.kind {
        Kind::Blade => 1,
        Kind::Sector => 2,
        Kind::Ring | Kind::Lumped => generated.places.bodies,
    });
    let sites = if options.joints { choose_sites(&generated.sites, count)? } else { Vec::new() };
    // What couples while all contacts stick.
    let contacts = match options.joints {
        true => sites.iter().flat_map(Site::pairs).collect(),
        false => generated.places.choose(count)?,
    };
    let share = generated.places.bodies as f64 / (count.max(generated.places.bodies)) as f64;
    let (stiffness, slip_force) = (rounded(options.stiffness * share), rounded(options.slip_force * share));
    let structure = &generated.structure;
    let first = |contacts: &[Pair]| {
        let start = generated.forces();
        let found = resonances::lowest(structure, contacts, stiffness, start, 1)?;
        found.first().copied().context("no natural frequency")
    };
    let (free, stuck) = (first(&[])?, first(&contacts)?);
    let damping = if options.rayleigh {
        // ζ = (a/ω + b ω)/2, equal at ω and 5 ω.
        let omega = TAU * free;
        let (a, b) = (2.0 * RATIO * omega * 5.0 / 6.0, 2.0 * RATIO / (6.0 * omega));
        format!("{{\"rayleigh\": {{\"mass\": {:?}, \"stiffness\": {:?}}}}}", rounded(a), rounded(b))
    } else {
        format!("{{\"modal_ratio\": {RATIO:?}}}")
    };
    let kind = options.kind.name();
    let name = format!("{kind}-{}-{count}", structure.dofs());
    let call = format!("generate-model {}", words_without_folder(words).join(" "));
    let comment = format!(
        "Made by cargo xtask {call}: {} dofs, {count} contacts{}; the force first finds a natural frequency at {} Hz, at {} \
         Hz while the contacts stick.",
        structure.dofs(),
        if options.joints { " in three directions" } else { "" },
        rounded(free),
        rounded(stuck)
    );
    let scene = Words {
        name: &name,
        comment: &comment,
        force: options.force,
        excited: &generated.excited,
        contacts: if options.joints { Contacts::Sites(&sites) } else { Contacts::Pairs(&contacts) },
        stiffness,
        slip_force,
        damping,
        frequencies: (rounded(0.85 * free), rounded(1.1 * stuck)),
    };
    let folder = &options.output;
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let dofs = structure.dofs();
    files::matrix(&folder.join("mass.mtx"), &structure.mass, dofs, &format!("mass in kg; {call}"))?;
    files::matrix(
        &folder.join("stiffness.mtx"),
        &structure.stiffness,
        dofs,
        &format!("stiffness in N/m; {call}"),
    )?;
    files::text(&folder.join("dofs.txt"), &files::names(&structure.names))?;
    files::text(&folder.join("scene.json"), &files::scene(&scene, &structure.names)?)?;
    eprintln!("{comment}\n{}: written in {:.1} s", folder.display(), start.elapsed().as_secs_f64());
    Ok(())
}

impl Options {
    fn generate(&self) -> Result<Generated> {
        for (name, value) in [
            ("length", self.length),
            ("chord", self.chord),
            ("thickness", self.thickness),
            ("taper", self.taper),
            ("edge", self.edge),
            ("stiffness", self.stiffness),
            ("slip-force", self.slip_force),
            ("force", self.force),
        ] {
            ensure!(value > 0.0 && value.is_finite(), "--{name}: must be positive, got {value}");
        }
        ensure!(self.twist.is_finite(), "--twist: must be finite, got {}", self.twist);
        let blade = Blade {
            length: self.length,
            chord: self.chord,
            thickness: self.thickness,
            taper: self.taper,
            twist: self.twist.to_radians(),
            edge: self.edge,
        };
        let engine_order = self.engine_order.unwrap_or(self.sectors / 8);
        let ring = Sectors { blade, count: self.sectors, ring: self.kind == Kind::Ring, engine_order };
        match self.kind {
            Kind::Blade => {
                let cells = match self.elements.as_deref() {
                    Some(&[chord, thickness, span]) => Cells { chord, thickness, span },
                    _ => Cells::of_dofs(self.dofs),
                };
                blade.generate(&cells)
            }
            _ if self.elements.is_some() => bail!("--elements is for a blade alone; use --dofs"),
            Kind::Sector | Kind::Ring => ring.generate(self.dofs),
            Kind::Lumped => lumped::generate(self.sectors, engine_order),
        }
    }
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Blade => "blade",
            Self::Sector => "sector",
            Self::Ring => "ring",
            Self::Lumped => "lumped",
        }
    }
}

/// Three significant digits, so that files do not depend on rounding.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// What was asked for, but not where to.
fn words_without_folder<'a>(words: &[&'a str]) -> Vec<&'a str> {
    let mut kept = Vec::new();
    let mut folder = false;
    for word in words {
        let flag = matches!(*word, "-o" | "--output");
        if !folder && !flag && !word.starts_with("--output=") {
            kept.push(*word);
        }
        folder = flag;
    }
    kept
}
