//! A quantity over one parameter, a curve a number of harmonics.

use std::path::Path;

use anyhow::{Result, bail};

use super::axis::Axis;
use super::chart::{BOTTOM, Chart, Curve, LEFT, RIGHT, TOP};
use super::heat_map::Parameter;
use super::labels::{self, Label};
use super::sheet::{COLUMN, decorated};
use super::truncation_plot::PENS;
use super::{image, pen};

/// A quantity over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterPlot {
    /// Abscissa.
    pub x: Parameter,
    /// What is drawn and its unit, `("peak of w2", "m")`.
    pub quantity: (String, &'static str),
    /// A name and one value each of `x`; `None` where it is not known.
    pub curves: Vec<(String, Vec<Option<f64>>)>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_parameter(plot: &ParameterPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Height of the frame in px (1/96 in).
const FRAME: f64 = 200.0;

fn draw(plot: &ParameterPlot) -> Result<String> {
    let (quantity, unit) = &plot.quantity;
    let values = || plot.x.values.iter().copied();
    let logarithmic = plot.x.logarithmic && values().all(|value| value > 0.0);
    let x = if logarithmic {
        Axis::decades(plot.x.label.clone(), values())
    } else {
        Axis::counted(&plot.x.label, values())
    };
    let known = plot.curves.iter().flat_map(|(_, curve)| curve).filter_map(|value| *value);
    let (Some(mut x), Some(y)) = (x, Axis::measured(quantity, unit, known)) else {
        bail!("nothing to plot: no case has a value");
    };
    let mut labels = Vec::new();
    let mut curves = Vec::new();
    for (i, (name, curve)) in plot.curves.iter().enumerate() {
        let pen = PENS.get(i % PENS.len()).copied().unwrap_or(pen::MAIN);
        let points: Vec<(f64, Option<f64>)> = values().zip(curve.iter().copied()).collect();
        let last =
            points.iter().copied().filter_map(|(x, y)| Some((x, y?))).max_by(|a, b| a.0.total_cmp(&b.0));
        if let (Some(at), true) = (last, plot.curves.len() > 1) {
            labels.push(Label { text: name.clone(), at, color: pen.color });
        }
        curves.push(Curve { name: "", points, pen });
    }
    if !labels.is_empty() {
        let frame = COLUMN - LEFT - RIGHT;
        let room = labels::room(&labels).min(0.5 * frame);
        let largest = values().filter_map(|value| x.place(value)).fold(f64::NEG_INFINITY, f64::max);
        x.high = x.low + (largest - x.low) * frame / (frame - room);
    }
    let chart = Chart {
        heading: String::new(),
        x,
        y,
        curves,
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

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> ParameterPlot {
        let x: Vec<f64> = (0..30).map(|i| 10f64.powf(f64::from(i) / 15.0)).collect();
        let curve = |n: f64| x.iter().map(|x| Some(3e-5 * (x.ln() - 2.0).powi(2) / n + 1e-5)).collect();
        let curves = [1.0, 3.0, 7.0].map(|n| (format!("N = {n}"), curve(n))).to_vec();
        let x =
            Parameter { label: "/contacts/0/law/slip_force".into(), values: x.clone(), logarithmic: true };
        ParameterPlot { x, quantity: ("peak of w2".into(), "m"), curves }
    }

    #[test]
    fn curves_are_named_when_there_are_several() {
        assert!(draw(&example()).unwrap().contains(">N = 7</text>"));
        let mut one = example();
        one.curves.truncate(1);
        assert!(!draw(&one).unwrap().contains(">N = 1</text>"));
        one.curves.clear();
        assert!(draw(&one).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_parameters_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        write_parameter(&example(), &folder.join("parameter.png")).unwrap();
    }
}
