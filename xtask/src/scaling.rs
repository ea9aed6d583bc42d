//! `cargo xtask scaling`: how the cost grows with dofs, contacts, harmonics and points, each with a fitted exponent.
//!
//! One question a family, everything else held: a chain of masses whose damping is Rayleigh's, elastic Coulomb contacts to the
//! ground, the frequencies of its first resonances. Writes `docs/figures/scaling.csv`, a figure and
//! `docs/src/growth.md`; `--draw` makes figure and page again from the measured data.

mod chain;
mod family;
mod figure;
mod measure;
mod page;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use study::work_precision::Machine;

use crate::error_vs_runtime::rustc;
use family::Family;
use measure::Measured;

/// What a user types.
const COMMAND: &str = "cargo xtask scaling";

/// Measures everything, and writes data, figure and page.
pub(crate) fn run(root: &Path) -> Result<()> {
    let mut measured = Vec::new();
    for family in Family::ALL {
        for &size in family.sizes() {
            let one = measure::measure(family, size)?;
            eprintln!(
                "{}: {size}: {:.3e} s a point, {:.1} iterations",
                family.name(),
                one.seconds,
                one.iterations
            );
            measured.push(one);
        }
    }
    let machine = serde_json::to_string(&Machine::here(rustc()))?;
    let rows: String = measured.iter().map(Measured::row).collect();
    fs::write(data_file(root), format!("# {machine}\n{}\n{rows}", Measured::HEAD))?;
    draw(root)
}

/// Figure and page once more from the measured data.
pub(crate) fn draw(root: &Path) -> Result<()> {
    let path = data_file(root);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let (machine, rows) = text.split_once('\n').context("no line of the machine")?;
    let machine: Machine = serde_json::from_str(machine.trim_start_matches("# "))?;
    let measured: Vec<Measured> = rows.lines().skip(1).map(Measured::read).collect::<Result<_>>()?;
    let svg = figure::figure(&measured).context("nothing was measured")?;
    for extension in ["svg", "png"] {
        plot::write(&svg, &root.join("docs/figures").join(format!("scaling.{extension}")))?;
    }
    fs::write(root.join("docs/src/growth.md"), page::page(&machine, &measured)?)?;
    Ok(())
}

fn data_file(root: &Path) -> PathBuf {
    root.join("docs/figures/scaling.csv")
}

/// Slope p of log(seconds) over log(size), by least squares over the larger half of the sizes: cost ~ size^p.
fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let largest = points.iter().map(|(size, _)| size.ln()).fold(f64::NEG_INFINITY, f64::max);
    let smallest = points.iter().map(|(size, _)| size.ln()).fold(f64::INFINITY, f64::min);
    let late = |(size, seconds): &(f64, f64)| {
        (size.ln() >= 0.5 * (smallest + largest)).then_some((size.ln(), seconds.ln()))
    };
    let points: Vec<(f64, f64)> = points.iter().filter_map(late).collect();
    let count = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let slope: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    (points.len() >= 2 && slope.is_finite()).then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_is_that_of_the_larger_half() {
        let cubic = |n: f64| (n, 1e-6 * n + 1e-9 * n.powi(3));
        let points: Vec<_> = [1.0, 10.0, 1e3, 1e4, 1e5].map(cubic).to_vec();
        assert!((exponent(&points).unwrap() - 3.0).abs() < 1e-3);
        assert_eq!(exponent(&points[..1]), None);
    }

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let one = Measured {
            family: Family::Contacts,
            size: 30,
            seconds: 1.25e-3,
            repeats: 5,
            iterations: 6.5,
            unsolved: 0,
            points: 8,
        };
        assert_eq!(Measured::read(one.row().trim_end()).unwrap(), one);
    }
}
