//! The highest peak of a response over a parameter: amplitude and frequency, the optimum marked.

use std::path::Path;

use anyhow::{Result, ensure};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, LEFT, RIGHT, TOP};
use super::labels::{self, Label};
use super::sheet::decorated;
use super::truncation_plot::PENS;
use super::{image, pen};

/// The highest peak over a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakPlot {
    /// Written above the sheet.
    pub title: String,
    /// What varies.
    pub parameter: String,
    /// Over its logarithm.
    pub logarithmic: bool,
    /// What the amplitude is, `peak of |W_1| of w2`.
    pub quantity: String,
    /// One a number of harmonics.
    pub curves: Vec<PeakPlotCurve>,
}

/// One curve of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakPlotCurve {
    /// `N = 7`.
    pub name: String,
    /// Parameter and its highest peak, `None` where it is not known.
    pub points: Vec<(f64, Option<HighestPeak>)>,
    /// The same where it is lowest.
    pub optimum: Option<(f64, HighestPeak)>,
}

/// The highest peak of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HighestPeak {
    /// Which of several peaks it is: frequencies leave a gap where another one becomes the highest.
    pub branch: usize,
    /// In Hz.
    pub frequency: f64,
    /// In m.
    pub amplitude: f64,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_peaks(plot: &PeakPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Column width of a journal and heights of the frames in px (1/96 in).
const WIDTH: f64 = 340.0;
const AMPLITUDE: f64 = 190.0;
const FREQUENCY: f64 = 110.0;

fn draw(plot: &PeakPlot) -> Result<String> {
    let parameters = || plot.curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.0));
    let x = match plot.logarithmic {
        true => Axis::decades(plot.parameter.clone(), parameters()),
        false => Axis::counted(&plot.parameter, parameters()),
    };
    let labels = names(plot);
    let x = x.map(|mut x| {
        let frame = WIDTH - LEFT - RIGHT;
        let largest = parameters().filter_map(|value| x.place(value)).fold(f64::NEG_INFINITY, f64::max);
        let room = labels::room(&labels).min(0.5 * frame);
        if !labels.is_empty() {
            x.high = x.high.max(x.low + (largest - x.low) * frame / (frame - room));
        }
        x
    });
    let chart = |of: &dyn Fn(&HighestPeak) -> f64, y: Option<Axis>, height: f64, lowest: bool| {
        let pens = PENS.iter().cycle();
        let lines = plot.curves.iter().zip(pens).map(|(curve, pen)| Curve {
            name: "",
            points: line(&curve.points, of, lowest),
            pen: *pen,
        });
        let dots = plot.curves.iter().enumerate().map(|(i, curve)| Curve {
            name: if i == 0 && curve.optimum.is_some() { "optimum" } else { "" },
            points: curve.optimum.iter().map(|(x, peak)| (*x, Some(of(peak)))).collect(),
            pen: pen::POINT,
        });
        Some(Chart {
            heading: String::new(),
            x: x.clone()?,
            y: y?,
            curves: lines.chain(dots).collect(),
            rug: Vec::new(),
            rug_name: "",
            label_x: lowest,
            label_y: true,
            legend: !lowest && plot.curves.iter().any(|curve| curve.optimum.is_some()),
            width: WIDTH,
            height: TOP + height + if lowest { BOTTOM } else { BOTTOM_BARE },
        })
    };
    let peaks = || plot.curves.iter().flat_map(|curve| curve.points.iter().filter_map(|point| point.1));
    let amplitude = Axis::measured(&plot.quantity, "m", peaks().map(|peak| peak.amplitude).chain([0.0]));
    let frequency = Axis::measured("frequency", "Hz", peaks().map(|peak| peak.frequency));
    ensure!(peaks().next().is_some(), "nothing to plot: no peak is known");
    let charts = [
        chart(&|peak| peak.amplitude, amplitude, AMPLITUDE, false),
        chart(&|peak| peak.frequency, frequency, FREQUENCY, true),
    ];
    let charts: Vec<Chart> = charts.into_iter().flatten().collect();
    ensure!(charts.len() == 2, "nothing to plot: no peak is known");
    // Beside the amplitudes; the frequencies below have the same pens.
    let name = |chart: &Chart, scene: &mut _| {
        if !chart.label_x {
            labels::draw(scene, chart, &labels);
        }
    };
    Ok(decorated(&plot.title, 1, charts, &|chart, scene| name(chart, scene)))
}

/// The line of one quantity; frequencies leave a gap where another peak becomes the highest.
fn line(
    points: &[(f64, Option<HighestPeak>)],
    of: &dyn Fn(&HighestPeak) -> f64,
    gaps: bool,
) -> Vec<(f64, Option<f64>)> {
    let mut line = Vec::new();
    let mut before = None;
    for (x, peak) in points {
        let branch = peak.map(|peak| peak.branch);
        if gaps && before.is_some() && branch.is_some() && before != branch {
            line.push((*x, None));
        }
        before = branch;
        line.push((*x, peak.as_ref().map(of)));
    }
    line
}

/// The name of every curve at its end, where there are several.
fn names(plot: &PeakPlot) -> Vec<Label> {
    let last = |curve: &PeakPlotCurve| {
        curve.points.iter().rev().find_map(|(x, peak)| Some((*x, peak.as_ref()?.amplitude)))
    };
    let label = |(curve, pen): (&PeakPlotCurve, &pen::Pen)| {
        Some(Label { text: curve.name.clone(), at: last(curve)?, color: pen.color })
    };
    match plot.curves.len() {
        0 | 1 => Vec::new(),
        _ => plot.curves.iter().zip(PENS.iter().cycle()).filter_map(label).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(curves: usize) -> PeakPlot {
        let curve = |n: usize| {
            let peak = |x: f64| HighestPeak {
                branch: usize::from(x > 8.0),
                frequency: 40.0 + 20.0 * x / (x + 10.0),
                amplitude: (2.0 + (x / 12.0).ln().powi(2)) / n as f64 * 1e-4,
            };
            let points = (0..40).map(|i| 1.1_f64.powi(i)).map(|x| (x, (x < 35.0).then(|| peak(x)))).collect();
            PeakPlotCurve { name: format!("N = {n}"), points, optimum: Some((12.0, peak(12.0))) }
        };
        PeakPlot {
            title: "example".into(),
            parameter: "/contacts/0/law/slip_force".into(),
            logarithmic: true,
            quantity: "peak of |W_1| of w2".into(),
            curves: (1..=curves).map(curve).collect(),
        }
    }

    #[test]
    fn the_optimum_is_marked_in_both_charts() {
        let svg = draw(&example(1)).unwrap();
        assert!(svg.contains("frequency (Hz)") && svg.contains("optimum") && !svg.contains("N = 1"));
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(draw(&example(3)).unwrap().contains("N = 3"));
    }

    #[test]
    fn no_peak_is_an_error() {
        assert!(draw(&example(0)).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_peaks_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        for name in ["peaks.svg", "peaks.png"] {
            write_peaks(&example(3), &folder.join(name)).unwrap();
        }
    }
}
