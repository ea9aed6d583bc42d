//! `cargo xtask loop-family FILE…`: what scaling one loop makes of the harmonics of a *measured* family.
//!
//! Each record goes through the pipeline; the largest loop is scaled to the amplitudes of the others by the rule
//! c_k = (Im c_1(α)/Im F*_1) F*_k, k ≥ 2, with the family's own c_1. Beside it, for the loops in between, a `LoopFamily` of
//! the smallest and the largest alone.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use contact::{LoopFamily, Symmetry};
use hysteresis::{FitSettings, Loop, ReadOptions, Record};
use num_complex::Complex64;

/// Harmonics in the table: the first even one, and the odd ones that matter.
const HARMONICS: [usize; 4] = [2, 3, 5, 7];

/// Prints the table for the records in `files`.
pub(crate) fn print<P: AsRef<Path>>(files: &[P]) -> Result<()> {
    print!("{}", table(&loops(files)?)?);
    Ok(())
}

/// The fitted loops of `files`, by amplitude.
fn loops<P: AsRef<Path>>(files: &[P]) -> Result<Vec<Loop>> {
    let mut loops = Vec::new();
    for file in files {
        let name = || file.as_ref().display().to_string();
        let record = Record::read(file.as_ref(), &ReadOptions::default()).with_context(name)?;
        loops.push(hysteresis::fit(&record, &FitSettings::default()).with_context(name)?.hysteresis_loop);
    }
    loops.sort_by(|a, b| a.displacement_amplitude().total_cmp(&b.displacement_amplitude()));
    Ok(loops)
}

/// |Δc_k|/|c_1| in per cent, one line a loop and harmonic.
fn table(loops: &[Loop]) -> Result<String> {
    ensure!(loops.len() >= 2, "a family has two loops or more; give more records");
    let (Some(smallest), Some(largest)) = (loops.first(), loops.last()) else { return Ok(String::new()) };
    let ends = LoopFamily::new(&[smallest.clone(), largest.clone()], 0.0, Symmetry::Full)?;
    let part = |row: &[Complex64], k: usize| row.get(k).copied().unwrap_or_default();
    let mut text = String::from(
        "| amplitude | k | \\|c_k\\|/\\|c_1\\| | error of the scaled loop | error of the family of the two others |\n\
         |---|---|---|---|---|\n",
    );
    for one in &loops[..loops.len() - 1] {
        let ratio = one.first_harmonic().im / largest.first_harmonic().im;
        let between: Vec<Complex64> = ends.harmonics(one.displacement_amplitude()).map(|(c, _)| c).collect();
        let relative = |c: Complex64| 100.0 * c.norm() / one.force_amplitude();
        for k in HARMONICS {
            let own = part(one.coefficients(), k);
            let family = match std::ptr::eq(one, smallest) {
                true => "measured".to_owned(),
                false => format!("{:.1} %", relative(part(&between, k) - own)),
            };
            let _ = writeln!(
                text,
                "| {:.1} mm | {k} | {:.1} % | {:.1} % | {family} |",
                1e3 * one.displacement_amplitude(),
                relative(own),
                relative(part(largest.coefficients(), k) * ratio - own)
            );
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    #[test]
    fn the_page_has_the_table_of_the_real_damper() {
        let folder = std::env::var_os("STICKSLIP_LOOPS")
            .map_or_else(|| crate::root().join("../shared/loops"), PathBuf::from);
        let file = |tension: &str| folder.join(format!("arts-2_0.5Hz30lb-tension{tension}.csv"));
        let files = ["0.5", "1", "1.5"].map(file);
        if !files.iter().all(|file| file.exists()) {
            eprintln!("skipped: no records in {}; set STICKSLIP_LOOPS", folder.display());
            return;
        }
        let table = super::table(&super::loops(&files).unwrap()).unwrap();
        let page = std::fs::read_to_string(crate::root().join("docs/src/loop-family.md")).unwrap();
        assert!(page.contains(&table), "docs/src/loop-family.md lacks\n{table}");
    }
}
