//! `cargo xtask loop-family`: what scaling one loop makes of the higher harmonics of a family.
//!
//! Two *synthetic* families, W* = 8 µm and F* = 12 N: Masing loops of the backbone F* (g(x/W*) − g(0)), and Dahl's loops
//! of slip force 10 N that slide after 1 µm. Their loops at α = 0.1 … 1 are projected on 15 harmonics. One loop, that
//! of α = 1, is scaled to each α by the rule c_k = (Im c_1(α)/Im F*_1) F*_k, k ≥ 2, with the family's own c_1(α), so
//! that only the rule for higher harmonics is judged. Beside it, `LoopFamily` of every other loop.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};
use contact::{Iwan, IwanParameters, LoopFamily, MagnitudeLaw, Symmetry};
use hysteresis::{Loop, synthetic};
use num_complex::Complex64;

use crate::page;

const COMMAND: &str = "loop-family";
const DISPLACEMENT: f64 = 8e-6;
const FORCE: f64 = 12.0;
const HARMONICS: usize = 15;
/// Every other one, from the first, is a loop of the interpolated family.
const ALPHAS: [f64; 7] = [0.1, 0.15, 0.22, 0.32, 0.46, 0.68, 1.0];

struct Row {
    family: &'static str,
    alpha: f64,
    harmonic: usize,
    own: Complex64,
    scaled: Complex64,
    interpolated: Complex64,
    /// |c_1|.
    first: f64,
    /// Whether the loop is one of the interpolated family's.
    measured: bool,
}

fn loops(make: impl Fn(f64) -> Result<Loop>) -> Result<Vec<Loop>> {
    ALPHAS.iter().map(|alpha| make(alpha * DISPLACEMENT)).collect()
}

fn masing() -> Result<Vec<Loop>> {
    let magnitude = MagnitudeLaw::default();
    let law = Iwan::from_magnitude(IwanParameters {
        displacement: DISPLACEMENT,
        force: FORCE,
        magnitude,
        range: 10.0,
    })?;
    loops(|a| {
        let top = law.backbone(a);
        let branch = |down: f64| 2.0 * law.backbone(0.5 * a * (1.0 - down)) - top;
        let force = |theta: f64| if theta.sin() >= 0.0 { -branch(theta.cos()) } else { branch(-theta.cos()) };
        Ok(synthetic::project(a, HARMONICS, force)?)
    })
}

fn dahl() -> Result<Vec<Loop>> {
    loops(|a| Ok(synthetic::dahl_loop(a, 10.0, 1e7, HARMONICS)?))
}

fn rows() -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (family, loops) in [("masing", masing()?), ("dahl", dahl()?)] {
        let reference = loops.last().context("a family has loops")?;
        let measured: Vec<Loop> = loops.iter().step_by(2).cloned().collect();
        let law = LoopFamily::new(&measured, 0.0, Symmetry::Odd)?;
        for (i, (one, alpha)) in loops.iter().zip(ALPHAS).enumerate() {
            let ratio = one.first_harmonic().im / reference.first_harmonic().im;
            let interpolated: Vec<Complex64> =
                law.harmonics(one.displacement_amplitude()).map(|(c, _)| c).collect();
            let part = |row: &[Complex64], k: usize| row.get(k).copied().unwrap_or_default();
            for harmonic in (3..=HARMONICS).step_by(2) {
                rows.push(Row {
                    family,
                    alpha,
                    harmonic,
                    own: part(one.coefficients(), harmonic),
                    scaled: part(reference.coefficients(), harmonic) * ratio,
                    interpolated: part(&interpolated, harmonic),
                    first: one.force_amplitude(),
                    measured: i.is_multiple_of(2),
                });
            }
        }
    }
    Ok(rows)
}

fn csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "family,alpha,harmonic,own_re,own_im,scaled_re,scaled_im,interpolated_re,interpolated_im,measured\n",
    );
    for row in rows {
        let _ = write!(text, "{},{:.2},{}", row.family, row.alpha, row.harmonic);
        for c in [row.own, row.scaled, row.interpolated] {
            let _ = write!(text, ",{:.5},{:.5}", c.re, c.im);
        }
        let _ = writeln!(text, ",{}", row.measured);
    }
    text
}

/// The tables of the page: |Δc_k|/|c_1| in per cent.
fn tables(rows: &[Row]) -> String {
    let mut text = String::new();
    for family in ["masing", "dahl"] {
        let _ = writeln!(
            text,
            "| α, {family} | \\|c_3\\|/\\|c_1\\| | \\|c_5\\|/\\|c_1\\| | c_3 scaled | c_5 scaled | c_7 scaled | c_3 interpolated | c_5 interpolated |"
        );
        text.push_str("|---|---|---|---|---|---|---|---|\n");
        for alpha in ALPHAS {
            let find =
                |k: usize| rows.iter().find(|r| r.family == family && r.alpha == alpha && r.harmonic == k);
            let own = |k| find(k).map_or(f64::NAN, |r| 100.0 * r.own.norm() / r.first);
            let scaled = |k| find(k).map_or(f64::NAN, |r| 100.0 * (r.scaled - r.own).norm() / r.first);
            let between = |k| match find(k) {
                Some(r) if r.measured => "measured".to_owned(),
                Some(r) => format!("{:.2} %", 100.0 * (r.interpolated - r.own).norm() / r.first),
                None => String::new(),
            };
            let _ = writeln!(
                text,
                "| {alpha:.2} | {:.1} % | {:.1} % | {:.1} % | {:.1} % | {:.1} % | {} | {} |",
                own(3),
                own(5),
                scaled(3),
                scaled(5),
                scaled(7),
                between(3),
                between(5)
            );
        }
        text.push('\n');
    }
    text
}

/// Writes `docs/figures/loop-family.csv` and prints the tables of `docs/src/loop-family.md`.
pub(crate) fn write(root: &Path) -> Result<()> {
    let rows = rows()?;
    page::write(root, COMMAND, &csv(&rows))?;
    print!("{}", tables(&rows));
    Ok(())
}

/// Fails unless the file and the page hold what [`write()`] writes and prints.
pub(crate) fn check(root: &Path) -> Result<()> {
    let rows = rows()?;
    page::check(root, COMMAND, &csv(&rows), &tables(&rows))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_page_and_the_figure_are_up_to_date() {
        super::check(&crate::root()).unwrap();
    }
}
