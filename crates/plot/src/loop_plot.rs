//! A friction loop: force against displacement.

use std::path::Path;

use anyhow::{Result, ensure};

use super::axis::Axis;
use super::chart::{BOTTOM, Chart, Curve, TOP};
use super::{image, pen, sheet};

/// A measured loop and its series.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopPlot {
    /// Written above the frame; may be empty.
    pub title: String,
    /// The averaged steady cycle: displacement in m, force in N.
    pub measured: Vec<(f64, f64)>,
    /// The Fourier series over loop phase.
    pub fitted: Vec<(f64, f64)>,
    /// The raw record, drawn faintly behind; may be empty.
    pub record: Vec<(f64, f64)>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_loop(plot: &LoopPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Column width of a journal and height of the frame in px (1/96 in).
const WIDTH: f64 = 340.0;
const FRAME: f64 = 230.0;

fn draw(plot: &LoopPlot) -> Result<String> {
    let all = || plot.record.iter().chain(&plot.measured).chain(&plot.fitted);
    let axes = (
        Axis::measured("displacement", "m", all().map(|(w, _)| *w)),
        Axis::measured("force", "N", all().map(|(_, f)| *f)),
    );
    let (Some(x), Some(y)) = axes else { anyhow::bail!("nothing to plot: the loop has no points") };
    ensure!(all().any(|(w, f)| w.is_finite() && f.is_finite()), "nothing to plot: the loop has no numbers");
    let open = |points: &[(f64, f64)]| points.iter().map(|&(w, f)| (w, Some(f))).collect::<Vec<_>>();
    let closed = |points: &[(f64, f64)]| {
        let mut cycle = open(points);
        cycle.extend(cycle.first().copied());
        cycle
    };
    let curves = vec![
        Curve { name: "record", points: open(&plot.record), pen: pen::FAINT },
        Curve { name: "averaged cycle", points: closed(&plot.measured), pen: pen::MAIN },
        Curve { name: "Fourier series", points: closed(&plot.fitted), pen: pen::FIT },
    ];
    let chart = Chart {
        heading: plot.title.clone(),
        x,
        y,
        curves,
        rug: Vec::new(),
        rug_name: "",
        label_x: true,
        label_y: true,
        legend: false,
        width: WIDTH,
        height: TOP + FRAME + BOTTOM,
    };
    Ok(sheet::sheet("", 1, vec![chart]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> LoopPlot {
        let turn = |i: usize, n: usize| std::f64::consts::TAU * i as f64 / n as f64;
        let force = |phase: f64| 12.0 * (phase + 1.45).cos() + 2.5 * (3.0 * phase + 1.3).cos();
        let point = |phase: f64| (8e-6 * phase.cos(), force(phase));
        let noise = |i: usize| 0.25 * (0.37 * (i * i % 1009) as f64).sin();
        LoopPlot {
            title: "reference.csv".into(),
            measured: (0..512).map(|i| point(turn(i, 512))).map(|(w, f)| (w, f + 0.05 * f.sin())).collect(),
            fitted: (0..512).map(|i| point(turn(i, 512))).collect(),
            record: (0..8_000)
                .map(|i| (point(turn(i, 2_000)), noise(i)))
                .map(|((w, f), e)| (w, f + e))
                .collect(),
        }
    }

    #[test]
    fn units_are_sensible() {
        let svg = draw(&example()).unwrap();
        assert!(svg.contains(">displacement (µm)</text>") && svg.contains(">force (N)</text>"));
        assert!(svg.contains(">record</text>") && svg.contains(">Fourier series</text>"));
        assert!(svg == draw(&example()).unwrap());
    }

    #[test]
    fn an_empty_loop_is_an_error() {
        let empty = LoopPlot { title: String::new(), measured: vec![], fitted: vec![], record: vec![] };
        assert!(draw(&empty).unwrap_err().to_string().contains("nothing to plot"));
    }

    #[test]
    fn a_long_record_stays_a_small_file() {
        let mut plot = example();
        let lap = |i: u32| std::f64::consts::TAU * f64::from(i) / 100_000.0;
        plot.record = (0..400_000).map(lap).map(|phase| (8e-6 * phase.cos(), 12.0 * phase.sin())).collect();
        assert!(draw(&plot).unwrap().len() < 1_000_000);
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip figures`.
    #[test]
    fn figures_of_a_loop_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        for name in ["loop.svg", "loop.png"] {
            write_loop(&example(), &folder.join(name)).unwrap();
            assert!(folder.join(name).metadata().unwrap().len() > 1000);
        }
    }
}
