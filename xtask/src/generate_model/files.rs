//! The files of a structure: Matrix Market, names of dofs, and a scene that solves it.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};

use super::plan::{Excited, Pair};
use super::structure::Lower;

/// Everything a scene says beside its matrices.
pub(super) struct Words<'a> {
    pub(super) name: &'a str,
    pub(super) comment: &'a str,
    /// Amplitude of every force in N.
    pub(super) force: f64,
    pub(super) excited: &'a [Excited],
    pub(super) contacts: &'a [Pair],
    /// Of each contact, in N/m and N.
    pub(super) stiffness: f64,
    pub(super) slip_force: f64,
    /// The value of `damping`.
    pub(super) damping: String,
    /// In Hz.
    pub(super) frequencies: (f64, f64),
}

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
    let mut pairs = Vec::new();
    for &(first, second) in words.contacts {
        let second = second.map_or(Ok("ground"), |dof| name(dof).map(String::as_str))?;
        pairs.push(format!("        [\"{}\", \"{second}\"]", name(first)?));
    }
    let mut text = String::new();
    writeln!(text, "{{\n  \"comment\": \"{}\",\n  \"name\": \"{}\",", words.comment, words.name)?;
    writeln!(text, "  \"model\": {{\n    \"dofs\": {{\"file\": \"dofs.txt\"}},")?;
    writeln!(text, "    \"mass\": {{\"matrix_market\": \"mass.mtx\"}},")?;
    writeln!(text, "    \"stiffness\": {{\"matrix_market\": \"stiffness.mtx\"}},")?;
    writeln!(text, "    \"damping\": {}\n  }},", words.damping)?;
    writeln!(text, "  \"excitation\": [\n{}\n  ],", forces.join(",\n"))?;
    if pairs.is_empty() {
        writeln!(text, "  \"contacts\": [],")?;
    } else {
        writeln!(text, "  \"contacts\": [\n    {{\n      \"name\": \"friction\",\n      \"pairs\": [")?;
        writeln!(text, "{}\n      ],", pairs.join(",\n"))?;
        let (stiffness, slip) = (words.stiffness, words.slip_force);
        let law =
            format!("\"type\": \"elastic_coulomb\", \"stiffness\": {stiffness:?}, \"slip_force\": {slip:?}");
        writeln!(text, "      \"law\": {{{law}}}\n    }}\n  ],")?;
    }
    let (from, to) = words.frequencies;
    writeln!(text, "  \"frequencies\": {{\"from\": {from:?}, \"to\": {to:?}, \"points\": 101}},")?;
    writeln!(text, "  \"harmonics\": 7,\n  \"output\": [{}]\n}}", output.join(", "))?;
    Ok(text)
}
