//! `cargo xtask reference-loop`: the synthetic friction loop of the example scenes.
//!
//! The loops behind the paper are not published. The one written here is *made to agree with its law at α = 1*: its
//! first harmonic has magnitude F* = 12 N and phase π + ψ_C(1) = 0.4914 π, eq. (7). [`crate::synthetic_loop`] says how.
//! The file is sampled from the cut series.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::synthetic_loop::{DISPLACEMENT, FORCE, HARMONICS, SHARPNESS, Series};

const CYCLES: usize = 5;
const SAMPLES: usize = 200;
/// Samples a second: 20 Hz with 200 samples a cycle.
const RATE: f64 = 4000.0;

/// Writes the file.
pub(crate) fn write(root: &Path) -> Result<()> {
    let path = file(root);
    fs::write(&path, text()?).with_context(|| path.display().to_string())
}

/// Fails unless the file is what [`write()`] writes.
pub(crate) fn check(root: &Path) -> Result<()> {
    let path = file(root);
    let written = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    // A checkout may have changed line ends.
    let same = written.lines().eq(text()?.lines());
    ensure!(same, "{} is not what `cargo xtask reference-loop` writes", path.display());
    Ok(())
}

fn file(root: &Path) -> PathBuf {
    root.join("scenes").join("loops").join("reference.csv")
}

fn text() -> Result<String> {
    let series = Series::reference();
    ensure!(series.passive(), "the reference loop creates energy");
    let amplitude = 1e6 * DISPLACEMENT;
    let mut text = format!(
        "# Synthetic friction loop, not a measurement. Written by `cargo xtask reference-loop`.\n\
         # Dahl friction, amplitude {amplitude} um = {SHARPNESS} sliding lengths, on sliding branches that fall by {:.4} of\n\
         # the friction force per amplitude, so that the first harmonic over loop phase is {FORCE} N at 0.4914 pi:\n\
         # what eq. (7) of Hoffmann et al. (2017) says at alpha = 1. {HARMONICS} odd harmonics, {CYCLES} steady cycles.\n\
         time [s],displacement [um],force [N]\n",
        series.fall
    );
    // The record begins and ends in the middle of a loading branch, as measured ones do.
    for j in 0..=CYCLES * SAMPLES {
        let phase = TAU * (j % SAMPLES) as f64 / SAMPLES as f64 - FRAC_PI_2;
        let (w, f) = (amplitude * phase.cos(), series.force(phase));
        writeln!(text, "{:.5},{:.9},{:.9}", j as f64 / RATE, tidy(w), tidy(f))?;
    }
    Ok(text)
}

/// Without the digits that rounding leaves behind, and without negative zeros.
fn tidy(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}
