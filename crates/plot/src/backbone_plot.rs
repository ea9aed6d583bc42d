//! A nonlinear mode: natural frequency and damping ratio over the amplitude.

use std::path::Path;

use anyhow::{Result, ensure};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
use super::{image, pen, sheet::sheet};

/// A nonlinear mode over its amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct BackbonePlot {
    /// Written above the sheet.
    pub title: String,
    /// What the amplitude is, `|W_1| of w2`.
    pub amplitude: String,
    /// Amplitude in m, frequency in Hz, damping ratio.
    pub points: Vec<(f64, f64, f64)>,
    /// Where the resonance at the scene's own excitation is expected: amplitude in m, natural frequency in Hz, damping ratio.
    pub expected: Option<(f64, f64, f64)>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_backbone(plot: &BackbonePlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Column width of a journal and height of a frame in px (1/96 in).
const WIDTH: f64 = 340.0;
const FRAME: f64 = 150.0;

fn draw(plot: &BackbonePlot) -> Result<String> {
    let BackbonePlot { points, expected, .. } = plot;
    let x = Axis::decades(format!("{} (m)", plot.amplitude), points.iter().map(|p| p.0));
    let chart = |of: &dyn Fn(&(f64, f64, f64)) -> f64, y: Option<Axis>, lowest: bool| {
        let curve = points.iter().map(|p| (p.0, Some(of(p)))).collect();
        let dot = expected.iter().map(|p| (p.0, Some(of(p)))).collect();
        Some(Chart {
            heading: String::new(),
            x: x.clone()?,
            y: y?,
            curves: vec![
                Curve { name: "", points: curve, pen: pen::MAIN },
                Curve { name: "resonance at the scene's excitation", points: dot, pen: pen::POINT },
            ],
            rug: Vec::new(),
            rug_name: "",
            label_x: lowest,
            label_y: true,
            legend: lowest && expected.is_some(),
            width: WIDTH,
            height: TOP + FRAME + if lowest { BOTTOM } else { BOTTOM_BARE },
        })
    };
    let frequency = chart(&|p| p.1, Axis::measured("frequency", "Hz", points.iter().map(|p| p.1)), false);
    // Damping is seen from none.
    let damping = Axis::tight("damping ratio (%)".into(), points.iter().map(|p| 105.0 * p.2).chain([0.0]));
    let damping = chart(&|p| 100.0 * p.2, damping, true);
    let charts: Vec<Chart> = frequency.into_iter().chain(damping).collect();
    ensure!(charts.len() == 2, "nothing to plot: the mode has no point");
    Ok(sheet(&plot.title, 1, charts))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(count: u32) -> BackbonePlot {
        let point = |i: u32| {
            let amplitude = 1e-6 * 10_f64.powf(f64::from(i) / 20.0);
            let part = 1.0 / (1.0 + amplitude / 2e-5);
            (amplitude, 43.0 + 40.0 * part, 0.01 + 0.4 * part * (1.0 - part))
        };
        BackbonePlot {
            title: "example".into(),
            amplitude: "|W_1| of w2".into(),
            points: (0..count).map(point).collect(),
            expected: (count > 40).then(|| point(40)),
        }
    }

    #[test]
    fn both_quantities_are_drawn_over_decades() {
        let svg = draw(&example(80)).unwrap();
        assert!(svg.contains("damping ratio (%)") && svg.contains("frequency (Hz)") && svg.contains("10⁻⁵"));
        // The expected resonance in both charts, and in the legend.
        assert_eq!(svg.matches("<circle").count(), 3);
    }

    #[test]
    fn no_point_is_an_error() {
        assert!(draw(&example(0)).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_backbones_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        for name in ["backbone.svg", "backbone.png"] {
            write_backbone(&example(80), &folder.join(name)).unwrap();
        }
    }
}
