//! The response as a curve that may fold over: amplitude against frequency or another parameter, one panel a dof.

use std::path::Path;

use anyhow::{Result, bail};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
use super::response::subscripted;
use super::sheet::COLUMN;
use super::{image, pen, sheet};

/// One dof along the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePanel {
    /// The dof's name.
    pub title: String,
    /// Parameter and amplitude in m, in the order of the curve.
    pub points: Vec<(f64, f64)>,
    /// The same where the curve folds.
    pub folds: Vec<(f64, f64)>,
}

/// A response curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePlot {
    /// Written above all panels; may be empty.
    pub title: String,
    /// What runs along the abscissa, with its unit where it has one.
    pub parameter: String,
    /// One a dof.
    pub panels: Vec<CurvePanel>,
    /// What the amplitudes are, for example "|W_1|".
    pub quantity: String,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_curve(plot: &CurvePlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Height of a frame in px (1/96 in).
const FRAME: f64 = 160.0;

fn draw(plot: &CurvePlot) -> Result<String> {
    let parameters = plot.panels.iter().flat_map(|panel| &panel.points).map(|(x, _)| *x);
    let Some(x) = Axis::tight(plot.parameter.clone(), parameters) else {
        bail!("nothing to plot: the curve has no point");
    };
    let count = plot.panels.len();
    let charts = plot.panels.iter().enumerate().map(|(i, panel)| {
        let lowest = i + 1 == count;
        let label = format!("{} (m)", subscripted(&plot.quantity));
        let y = Axis::decades(label, panel.points.iter().map(|(_, a)| *a)).unwrap_or_else(|| x.clone());
        // A point between two gaps is a dot.
        let dots = panel.folds.iter().flat_map(|&(x, a)| [(x, None), (x, Some(a)), (x, None)]);
        Chart {
            heading: panel.title.clone(),
            x: x.clone(),
            y,
            curves: vec![
                Curve {
                    name: "",
                    points: panel.points.iter().map(|&(x, a)| (x, Some(a))).collect(),
                    pen: pen::MAIN,
                },
                Curve { name: "", points: dots.collect(), pen: pen::MAIN },
            ],
            rug: Vec::new(),
            rug_name: "",
            label_x: lowest,
            label_y: true,
            legend: false,
            width: COLUMN,
            height: TOP + FRAME + if lowest { BOTTOM } else { BOTTOM_BARE },
        }
    });
    Ok(sheet::sheet(&plot.title, 1, charts.collect()))
}
