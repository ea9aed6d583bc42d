//! Error against the number of harmonics, both logarithmic: one curve a frequency.

use std::path::Path;

use anyhow::{Result, bail};

use super::axis::Axis;
use super::chart::{BOTTOM, Chart, Curve, LEFT, RIGHT, TOP};
use super::image;
use super::labels::{self, Label};
use super::pen::{self, Pen};
use super::sheet::{COLUMN, decorated};

/// N and the error it leaves.
pub type Errors = Vec<(usize, Option<f64>)>;

/// The same on the axes.
type Points = Vec<(f64, Option<f64>)>;

/// Errors for several numbers of harmonics.
#[derive(Debug, Clone, PartialEq)]
pub struct TruncationPlot {
    /// Written above the frame; may be empty.
    pub title: String,
    /// A name and (N, error) for each frequency; `None` where the error is not known.
    pub curves: Vec<(String, Errors)>,
    /// A straight line error ~ (N + 1)^slope is drawn for comparison, with its name.
    pub slope: Option<(f64, &'static str)>,
    /// An error that is required.
    pub required: Option<f64>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_truncation(plot: &TruncationPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Height of the frame in px (1/96 in).
const FRAME: f64 = 250.0;

/// More curves than this are drawn faintly, with the worst error of all in front.
const NAMED: usize = 7;

/// Errors below this are rounding, and drawn no lower than that.
const ROUNDING: f64 = 1e-12;
const LEAST: f64 = 1e-16;

/// Curves that can be told apart in grey print too: by darkness, and dashes of the light ones.
pub(super) const PENS: [Pen; NAMED] = [
    pen::MAIN,
    Pen { color: "#c2410c", width: 1.3, dash: None, dot: None },
    Pen { color: "#2a7f62", width: 1.3, dash: Some("5 2.2"), dot: None },
    Pen { color: "#7a3b8f", width: 1.3, dash: Some("6 2 1.5 2"), dot: None },
    Pen { color: "#111111", width: 1.1, dash: Some("2 2"), dot: None },
    Pen { color: "#b07d00", width: 1.3, dash: Some("9 3"), dot: None },
    Pen { color: "#4a86c8", width: 1.3, dash: Some("3 1.5 1 1.5"), dot: None },
];
/// What is required, and how fast errors are expected to fall.
const REQUIRED: Pen = Pen { color: "#8a8a8a", width: 1.0, dash: None, dot: None };
const SLOPE: Pen = Pen { color: "#8a8a8a", width: 1.0, dash: Some("4 3"), dot: None };

fn draw(plot: &TruncationPlot) -> Result<String> {
    let drawn = |(n, error): (usize, Option<f64>)| (n as f64, error.map(|error| error.max(LEAST)));
    let mut curves: Vec<(String, Points)> = plot
        .curves
        .iter()
        .map(|(name, points)| (name.clone(), points.iter().copied().map(drawn).collect()))
        .collect();
    // Where nothing slips every number of harmonics is exact; that is no curve to look at beside others.
    let rounding =
        |(_, points): &(String, Points)| points.iter().all(|(_, error)| error.is_none_or(|e| e < ROUNDING));
    if !curves.iter().all(rounding) {
        curves.retain(|curve| !rounding(curve));
    }
    let faint = curves.len() > NAMED;
    if faint {
        let worst = ("worst".to_owned(), worst(&curves));
        curves.push(worst);
    }
    let known = || curves.iter().flat_map(|(_, points)| points).filter_map(|&(n, error)| Some((n, error?)));
    let largest = known().map(|(n, _)| n).fold(0.0, f64::max);
    let pen = |i: usize| match (faint, i + 1 == curves.len()) {
        (true, true) => pen::MAIN,
        (true, false) => pen::FAINT,
        (false, _) => PENS.get(i % NAMED).copied().unwrap_or(pen::MAIN),
    };
    let mut lines: Vec<(Curve, Option<String>)> = Vec::new();
    for (i, (name, points)) in curves.iter().enumerate() {
        let name = Some(name.clone()).filter(|_| !faint || i + 1 == curves.len());
        lines.push((Curve { name: "", points: points.clone(), pen: pen(i) }, name));
        let dots = Pen { dot: Some(if faint { 0.8 } else { 2.0 }), ..pen(i) };
        lines.push((Curve { name: "", points: points.clone(), pen: dots }, None));
    }
    if let Some((slope, name)) = plot.slope {
        let last = known().filter(|(n, _)| *n == largest).map(|(_, error)| error).fold(0.0, f64::max);
        let line = |n: f64| (n, Some(2.5 * last * ((n + 1.0) / (largest + 1.0)).powf(slope)));
        let points = [largest / 8.0, largest].map(|n| line(n.max(1.0))).to_vec();
        lines.insert(0, (Curve { name: "", points, pen: SLOPE }, Some(name.to_owned())));
    }
    let smallest = known().map(|(n, _)| n).fold(f64::INFINITY, f64::min);
    if let Some(required) = plot.required {
        let points = vec![(smallest, Some(required)), (largest, Some(required))];
        lines.insert(0, (Curve { name: "", points, pen: REQUIRED }, Some("required".into())));
    }
    let end = |curve: &Curve, name: String| {
        let (n, error) = curve.points.iter().rev().find_map(|&(n, error)| Some((n, error?)))?;
        Some(Label { text: name, at: (n, error), color: curve.pen.color })
    };
    let labels: Vec<Label> = lines.iter().filter_map(|(curve, name)| end(curve, name.clone()?)).collect();
    let all = || lines.iter().flat_map(|(curve, _)| &curve.points);
    let axes = (
        Axis::decades("harmonics N".into(), all().filter(|(_, e)| e.is_some()).map(|(n, _)| *n)),
        Axis::decades("relative error of the displacement spectrum".into(), all().filter_map(|(_, e)| *e)),
    );
    let (Some(mut x), Some(y)) = axes else { bail!("nothing to plot: no error is known") };
    // The names stand inside the frame, right of the last points.
    let frame = COLUMN - LEFT - RIGHT;
    let room = labels::room(&labels).min(0.5 * frame);
    let (from, to) = (smallest.log10(), largest.log10().max(smallest.log10() + 0.5));
    x.low = from - 0.04 * (to - from);
    x.high = x.low + (to - x.low) * frame / (frame - room);
    let chart = Chart {
        heading: plot.title.clone(),
        x,
        y,
        curves: lines.into_iter().map(|(curve, _)| curve).collect(),
        rug: Vec::new(),
        rug_name: "",
        label_x: true,
        label_y: true,
        legend: false,
        width: COLUMN,
        height: TOP + FRAME + BOTTOM,
    };
    Ok(decorated("", 1, vec![chart], &|chart, scene| labels::draw(scene, chart, &labels)))
}

/// The largest error at each N.
fn worst(curves: &[(String, Points)]) -> Points {
    let numbers = curves.first().map_or(&[][..], |(_, points)| points).iter().map(|(n, _)| *n);
    let largest = |n: f64| {
        let here = curves.iter().flat_map(|(_, points)| points).filter(|(other, _)| *other == n);
        (n, here.filter_map(|(_, error)| *error).reduce(f64::max))
    };
    numbers.map(largest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(frequencies: usize) -> TruncationPlot {
        let curve = |i: usize| {
            let error =
                |n: usize| 0.5 / (i as f64 + 1.0) * ((n + 1) as f64 / 2.0).powf(-3.5 + 0.1 * i as f64);
            let points = [1, 3, 7, 15, 31, 63].map(|n| (n, (i != 2 || n > 3).then(|| error(n)))).to_vec();
            (format!("{} Hz", 50 + 7 * i), points)
        };
        TruncationPlot {
            title: "blade".into(),
            curves: (0..frequencies).map(curve).collect(),
            slope: Some((-3.5, "(N+1)⁻³·⁵")),
            required: Some(1e-4),
        }
    }

    #[test]
    fn few_curves_are_named_and_many_have_a_worst() {
        let few = draw(&example(4)).unwrap();
        assert!(few.contains(">57 Hz</text>") && few.contains("(N+1)⁻³·⁵") && few.contains("required"));
        let many = draw(&example(30)).unwrap();
        assert!(!many.contains(">57 Hz</text>") && many.contains(">worst</text>"));
        let none = TruncationPlot { curves: Vec::new(), slope: None, required: None, title: String::new() };
        assert!(draw(&none).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_truncation_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        write_truncation(&example(5), &folder.join("truncation.png")).unwrap();
        write_truncation(&example(40), &folder.join("truncation-many.png")).unwrap();
    }
}
