//! `cargo xtask loop-series FOLDER`: records at eight amplitudes whose scaling laws are known.
//!
//! Stand-ins for the measured loops behind the paper, which are not published: at amplitude α W* the force at the
//! turning points is F* g(α), eq. (6), and the first harmonic has the phase ψ_C(α), eq. (7), with the paper's numbers,
//! W* = 8 µm and F* = 12 N. Harmonics 3 and 5 make up the difference between tip and first harmonic. Loops do not
//! repeat exactly: each is off by about 0.5 % of F* and 5 mrad; the load cell has a noise of 0.5 % of F*.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use contact::{MagnitudeLaw, PhaseLaw};
use hysteresis::Loop;
use hysteresis::synthetic::DirtyRecord;
use num_complex::Complex64;

/// W* in m and F* in N.
const DISPLACEMENT: f64 = 8e-6;
const FORCE: f64 = 12.0;
/// Amplitudes in µm; the paper's reach from 0.8 to 8.
const AMPLITUDES: [f64; 8] = [0.16, 0.4, 0.8, 1.6, 2.8, 4.0, 6.0, 8.0];

pub(crate) fn write(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    for (seed, micrometres) in (0..).zip(AMPLITUDES) {
        let truth = series(micrometres * 1e-6 / DISPLACEMENT, seed)?;
        let noise = 0.005 * FORCE / truth.force_amplitude();
        let record =
            DirtyRecord { force_noise: noise, samples_per_cycle: 256.0, seed, ..DirtyRecord::new(truth) };
        let unit = |name: &str| anyhow!("no such unit: {name}");
        let text = record.generate().to_csv(
            "um".parse().map_err(|_| unit("um"))?,
            "N".parse().map_err(|_| unit("N"))?,
            "s".parse().map_err(|_| unit("s"))?,
        );
        let path = folder.join(format!("{micrometres}um.csv"));
        fs::write(&path, text).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// The loop at amplitude α.
fn series(alpha: f64, seed: u64) -> Result<Loop> {
    // Scatter that looks random and is the same every time.
    let off = |k: f64| 0.005 * 1.4 * (k * (seed as f64 + 1.0)).sin();
    let tip = FORCE * (MagnitudeLaw::default().value(alpha) + off(7.3));
    let first = Complex64::from_polar(1.1 * tip, PI + PhaseLaw::default().value(alpha) + off(4.1));
    let rest = tip - first.re;
    let zero = Complex64::ZERO;
    let third = Complex64::new(0.8 * rest, 0.05 * tip);
    let fifth = Complex64::new(0.2 * rest, 0.02 * tip);
    Ok(Loop::new(DISPLACEMENT * alpha, vec![zero, first, zero, third, zero, fifth])?)
}
