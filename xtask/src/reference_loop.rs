//! `cargo xtask reference-loop`: the synthetic friction loop of the example scenes.
//!
//! The loops behind the paper are not published. The one written here is *made to agree with its law at α = 1*: its
//! first harmonic has magnitude F* = 12 N and phase π + ψ_C(1) = 0.4914 π, eq. (7). Its shape is Dahl's friction with
//! sliding branches that fall. With ξ = cos θ and loop phase θ from the upper tip, the unloading branch is
//!
//! ```text
//! f(θ)/f_c = −1 + (1 + tanh s) e^{−s (1 − ξ)} − β ξ,   0 ≤ θ ≤ π,   f(θ + π) = −f(θ)
//! ```
//!
//! s is the ratio of amplitude to Dahl's sliding length. β is not chosen but follows from the phase. It cannot be zero:
//! a loop with monotone branches has a first harmonic in phase with the displacement that only a sliding length below a
//! thousandth of the amplitude brings down to 0.9 % of π/2, a rectangle that no 15 harmonics describe. So the force
//! after breakaway is larger than at the end of the stroke.
//!
//! The series is cut to 15 odd harmonics, and the file is sampled from the cut series.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use num_complex::Complex64;

/// W*: displacement amplitude in µm.
const DISPLACEMENT: f64 = 8.0;
/// F*: magnitude of the first force harmonic in N.
const FORCE: f64 = 12.0;
/// s: amplitude over sliding length.
const SHARPNESS: f64 = 20.0;
/// Odd harmonics kept.
const HARMONICS: usize = 15;

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

/// A series over loop phase, `f(θ) = Re Σ F_k e^{ikθ}`, as pairs (k, F_k in N).
struct Series {
    terms: Vec<(f64, Complex64)>,
    /// β.
    fall: f64,
}

impl Series {
    fn reference() -> Self {
        // ψ_C(1), eq. (7).
        let phase = PI + (-FRAC_PI_2 - 7.0 / 15.0 * PI * (-4.0_f64).exp());
        let mut terms: Vec<(f64, Complex64)> =
            (0..HARMONICS).map(|i| (2 * i + 1) as f64).map(|k| (k, dahl_coefficient(k))).collect();
        // −β ξ = −β cos θ changes Re F_1 alone.
        let first = terms.first().map_or(Complex64::ZERO, |(_, c)| *c);
        let fall = first.re - first.im / phase.tan();
        if let Some((_, c)) = terms.first_mut() {
            c.re -= fall;
        }
        let scale = FORCE / terms.first().map_or(1.0, |(_, c)| c.norm());
        terms.iter_mut().for_each(|(_, c)| *c *= scale);
        Self { terms, fall }
    }

    fn force(&self, phase: f64) -> f64 {
        self.terms.iter().map(|(k, c)| (c * Complex64::cis(k * phase)).re).sum()
    }

    /// Half the distance of the branches at loop phase θ, in N.
    fn half_width(&self, phase: f64) -> f64 {
        self.terms.iter().map(|(k, c)| c.im * (k * phase).sin()).sum()
    }

    /// The law scales the half-width and nothing else that dissipates: where it is positive, every scaled loop is passive.
    fn passive(&self) -> bool {
        (1..4096).all(|j| self.half_width(PI * f64::from(j) / 4096.0) > 0.0)
    }
}

/// F_k/f_c of Dahl's loop for odd k: `(2/π) ∫_0^π f e^{−ikθ} dθ` by the midpoint rule.
fn dahl_coefficient(k: f64) -> Complex64 {
    const POINTS: u32 = 1 << 15;
    let tip = SHARPNESS.tanh();
    let sum: Complex64 = (0..POINTS)
        .map(|j| {
            let phase = PI * (f64::from(j) + 0.5) / f64::from(POINTS);
            let force = -1.0 + (1.0 + tip) * (-SHARPNESS * (1.0 - phase.cos())).exp();
            force * Complex64::cis(-k * phase)
        })
        .sum();
    sum * (2.0 / f64::from(POINTS))
}

fn text() -> Result<String> {
    let series = Series::reference();
    ensure!(series.passive(), "the reference loop creates energy");
    let mut text = format!(
        "# Synthetic friction loop, not a measurement. Written by `cargo xtask reference-loop`.\n\
         # Dahl friction, amplitude {DISPLACEMENT} um = {SHARPNESS} sliding lengths, on sliding branches that fall by {:.4} of\n\
         # the friction force per amplitude, so that the first harmonic over loop phase is {FORCE} N at 0.4914 pi:\n\
         # what eq. (7) of Hoffmann et al. (2017) says at alpha = 1. {HARMONICS} odd harmonics, {CYCLES} steady cycles.\n\
         time [s],displacement [um],force [N]\n",
        series.fall
    );
    // The record begins and ends in the middle of a loading branch, as measured ones do.
    for j in 0..=CYCLES * SAMPLES {
        let phase = TAU * (j % SAMPLES) as f64 / SAMPLES as f64 - FRAC_PI_2;
        let (w, f) = (DISPLACEMENT * phase.cos(), series.force(phase));
        writeln!(text, "{:.5},{:.9},{:.9}", j as f64 / RATE, tidy(w), tidy(f))?;
    }
    Ok(text)
}

/// Without the digits that rounding leaves behind, and without negative zeros.
fn tidy(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_harmonic_agrees_with_the_law() {
        let (k, first) = Series::reference().terms[0];
        assert_eq!(k, 1.0);
        assert!((first.norm() - 12.0).abs() < 1e-12);
        assert!((first.arg() / PI - 0.491_452_7).abs() < 1e-7, "{}", first.arg() / PI);
    }

    #[test]
    fn the_coefficients_are_integrated_to_rounding() {
        // Dahl's loop dissipates 4 (a − x_s tanh(a/x_s)) a unit of friction force; only Im F_1 does: π a Im F_1.
        let exact = 4.0 * (1.0 - SHARPNESS.tanh() / SHARPNESS) / PI;
        assert!((dahl_coefficient(1.0).im - exact).abs() < 1e-8, "{}", dahl_coefficient(1.0).im - exact);
    }

    #[test]
    fn the_cut_series_is_close_to_the_loop_it_came_from() {
        let series = Series::reference();
        let scale = series.terms[1].1.re / dahl_coefficient(3.0).re;
        for j in 1..1000 {
            let phase = PI * f64::from(j) / 1000.0;
            let xi = phase.cos();
            let branch = -1.0 + (1.0 + SHARPNESS.tanh()) * (-SHARPNESS * (1.0 - xi)).exp() - series.fall * xi;
            assert!((series.force(phase) - scale * branch).abs() < 0.06);
        }
    }

    #[test]
    fn each_branch_breaks_away_once() {
        // Falls from the tip to breakaway, rises from there on; near the end ripples of the cut series are smaller
        // than 0.05 N.
        let series = Series::reference();
        let forces: Vec<f64> = (0..=2000).map(|j| series.force(PI * f64::from(j) / 2000.0)).collect();
        let lowest = forces.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
        assert!((300..600).contains(&lowest), "{lowest}");
        assert!(forces[..lowest].windows(2).all(|pair| pair[1] < pair[0]));
        assert!(forces[lowest..].windows(2).all(|pair| pair[1] > pair[0] - 0.05));
    }

    #[test]
    fn the_branches_never_cross() {
        assert!(Series::reference().passive());
    }
}
