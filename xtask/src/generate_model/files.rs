//! The files of a structure: Matrix Market, names of dofs, and a scene that solves it.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};

use super::plan::{Excited, Pair, Site};
use super::rounded;
use super::structure::Lower;

/// Everything a scene says beside its matrices.
pub(super) struct Words<'a> {
    pub(super) name: &'a str,
    pub(super) comment: &'a str,
    /// Amplitude of every force in N.
    pub(super) force: f64,
    pub(super) excited: &'a [Excited],
    pub(super) contacts: Contacts<'a>,
    /// Of each contact in N/m, in all its directions.
    pub(super) stiffness: f64,
    /// Of each contact in N.
    pub(super) slip_force: f64,
    /// The value of `damping`.
    pub(super) damping: String,
    /// In Hz.
    pub(super) frequencies: (f64, f64),
}

/// What rubs.
pub(super) enum Contacts<'a> {
    /// Dofs, in one direction each.
    Pairs(&'a [Pair]),
    /// Nodes, in three directions under a normal load.
    Sites(&'a [Site]),
}

/// Friction coefficient of contacts in three directions.
const FRICTION: f64 = 0.3;

/// Writes a symmetric matrix in coordinates, lower triangle, counted from one.
pub(super) fn matrix(path: &Path, matrix: &Lower, dofs: usize, what: &str) -> Result<()> {
    let write = || -> std::io::Result<()> {
        let mut file = BufWriter::new(File::create(path)?);
        writeln!(file, "%%MatrixMarket matrix coordinate real symmetric\n% {what}")?;
        writeln!(file, "{dofs} {dofs} {}", matrix.entries.len())?;
        for (row, column, value) in &matrix.entries {
            writeln!(file, "{} {} {value:e}", row + 1, column + 1)?;
        }
        file.flush()
    };
    write().with_context(|| path.display().to_string())
}

/// Writes a text.
pub(super) fn text(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| path.display().to_string())
}

/// One name a line.
pub(super) fn names(names: &[String]) -> String {
    names.iter().fold(String::new(), |text, name| text + name + "\n")
}

/// The scene; one harmonic more is one word away.
pub(super) fn scene(words: &Words, names: &[String]) -> Result<String> {
    let name = |dof: usize| names.get(dof).with_context(|| format!("there is no dof {dof}"));
    let mut forces = Vec::new();
    let mut output = Vec::new();
    for excited in words.excited {
        let dof = name(excited.dof)?;
        let (force, phase) = (words.force, excited.phase);
        let phase = if phase == 0.0 { 0.0 } else { phase };
        forces.push(format!(
            "    {{\"dof\": \"{dof}\", \"harmonic\": 1, \"amplitude\": {force:?}, \"phase\": {phase:?}}}"
        ));
        output.push(format!("\"{dof}\""));
    }
    let mut text = String::new();
    writeln!(text, "{{\n  \"comment\": \"{}\",\n  \"name\": \"{}\",", words.comment, words.name)?;
    writeln!(text, "  \"model\": {{\n    \"dofs\": {{\"file\": \"dofs.txt\"}},")?;
    writeln!(text, "    \"mass\": {{\"matrix_market\": \"mass.mtx\"}},")?;
    writeln!(text, "    \"stiffness\": {{\"matrix_market\": \"stiffness.mtx\"}},")?;
    writeln!(text, "    \"damping\": {}\n  }},", words.damping)?;
    writeln!(text, "  \"excitation\": [\n{}\n  ],", forces.join(",\n"))?;
    match words.contacts {
        Contacts::Pairs([]) | Contacts::Sites([]) => writeln!(text, "  \"contacts\": [],")?,
        Contacts::Pairs(pairs) => {
            let (stiffness, slip) = (words.stiffness, words.slip_force);
            writeln!(text, "  \"contacts\": [\n    {{\n      \"name\": \"friction\",\n      \"pairs\": [")?;
            writeln!(text, "{}\n      ],", lines(pairs.iter().copied(), name)?)?;
            let law = format!(
                "\"type\": \"elastic_coulomb\", \"stiffness\": {stiffness:?}, \"slip_force\": {slip:?}"
            );
            writeln!(text, "      \"law\": {{{law}}}\n    }}\n  ],")?;
        }
        Contacts::Sites(sites) => {
            let preload = rounded(words.slip_force / FRICTION);
            let stiffness = words.stiffness;
            writeln!(text, "  \"contacts\": [\n    {{\n      \"name\": \"shroud\",\n      \"law\": {{")?;
            writeln!(text, "        \"type\": \"friction_contact\",")?;
            writeln!(text, "        \"tangential_stiffness\": {stiffness:?},")?;
            writeln!(text, "        \"normal_stiffness\": {stiffness:?},")?;
            writeln!(text, "        \"friction_coefficient\": {FRICTION:?},")?;
            writeln!(text, "        \"preload\": {preload:?}\n      }},\n      \"node_pairs\": [")?;
            let node = |dof: usize| name(dof).map(|name| name.split(':').next().unwrap_or(name));
            let pairs = sites.iter().map(|site| (site.first, site.second));
            writeln!(text, "{}\n      ],\n      \"axes\": [", lines(pairs, node)?)?;
            // The neighbour lies around the axis of the machine; friction acts along it and outwards.
            let axes = sites.iter().map(|site| {
                let tangential = "[{\"x\": 1}, {\"r\": 1}]";
                format!("        {{\"tangential\": {tangential}, \"normal\": {{\"t\": {}}}}}", site.normal)
            });
            writeln!(text, "{}\n      ]\n    }}\n  ],", axes.collect::<Vec<_>>().join(",\n"))?;
        }
    }
    let (from, to) = words.frequencies;
    writeln!(text, "  \"frequencies\": {{\"from\": {from:?}, \"to\": {to:?}, \"points\": 101}},")?;
    writeln!(text, "  \"harmonics\": 7,\n  \"output\": [{}]\n}}", output.join(", "))?;
    Ok(text)
}

/// One pair of names a line.
fn lines<'n, N: AsRef<str> + ?Sized + 'n>(
    pairs: impl Iterator<Item = Pair>,
    name: impl Fn(usize) -> Result<&'n N>,
) -> Result<String> {
    let line = |(first, second): Pair| {
        let second = second.map_or(Ok("ground"), |dof| name(dof).map(AsRef::as_ref))?;
        Ok(format!("        [\"{}\", \"{second}\"]", name(first)?.as_ref()))
    };
    Ok(pairs.map(line).collect::<Result<Vec<String>>>()?.join(",\n"))
}
