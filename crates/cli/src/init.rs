//! `stickslip init`: example scenes to start from.

use std::fs;
use std::path::Path;

use clap::ValueEnum;

use crate::arguments::{InitArguments, Template};
use crate::ending::{Ending, Failure, say};
use crate::output::{Output, unwritable};

/// A file of an example: its name and its text.
type File = (&'static str, &'static str);

// Links into the folder of scenes, which become files in a published crate.
const REFERENCE_LOOP: File = ("loops/reference.csv", include_str!("init/reference.csv"));
const TWO_MASS: File = ("two-mass.json", include_str!("init/two-mass.json"));
const ELASTIC_COULOMB: File = ("elastic-coulomb.json", include_str!("init/elastic-coulomb.json"));
const CUBIC: File = ("cubic.json", include_str!("init/cubic.json"));
const PAPER: File = ("hoffmann-2017.json", include_str!("init/hoffmann-2017.json"));
const PAPER_COULOMB: File =
    ("hoffmann-2017-elastic-coulomb.json", include_str!("init/hoffmann-2017-elastic-coulomb.json"));

// Where git cannot make links it writes their target into them.
const _: () = assert!(
    !matches!(PAPER.1.as_bytes().first(), Some(b'.')),
    "crates/cli/src/init holds no links: check the sources out with core.symlinks=true"
);

/// The scene comes first.
fn files(template: Template) -> Vec<File> {
    match template {
        Template::TwoMass => vec![TWO_MASS, REFERENCE_LOOP],
        Template::ElasticCoulomb => vec![ELASTIC_COULOMB],
        Template::Cubic => vec![CUBIC],
        Template::Hoffmann2017 => vec![PAPER, PAPER_COULOMB, REFERENCE_LOOP],
    }
}

/// Writes the example, or nothing when one of its files is there and differs.
pub fn run(arguments: &InitArguments) -> Result<Ending, Failure> {
    let files = files(arguments.template);
    let new: Vec<&File> = files.iter().filter(|(name, text)| !is_there(name, text)).collect();
    if !arguments.force
        && let Some((name, _)) = new.iter().find(|(name, _)| Path::new(name).exists())
    {
        return Err(unwritable(
            Path::new(name),
            "it is there already; --force replaces it, or run this in an empty folder",
        ));
    }
    for (name, text) in new {
        let path = Path::new(name);
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).map_err(|error| unwritable(folder, error))?;
        }
        Output::open(Some(path))?.write(|out| out.write_all(text.as_bytes()))?;
        say(format_args!("wrote {name}"));
    }
    if let Some((scene, _)) = files.first() {
        say(format_args!(
            "next: stickslip sweep {scene}    or, to see how it is solved: stickslip explain {scene}"
        ));
    }
    let others: Vec<String> = (Template::value_variants().iter().filter(|t| **t != arguments.template))
        .filter_map(|template| Some(template.to_possible_value()?.get_name().to_owned()))
        .collect();
    say(format_args!("other examples: stickslip init {}", others.join(" | ")));
    Ok(Ending::Done)
}

/// The file is there with this text.
fn is_there(name: &str, text: &str) -> bool {
    fs::read(name).is_ok_and(|found| found == text.as_bytes())
}
