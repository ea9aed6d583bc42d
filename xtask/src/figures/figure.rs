//! A figure of the page: its panels, drawn as SVG, and the numbers drawn, as CSV.

use std::fmt::Write as _;

use plot::{Axis, BOTTOM, BOTTOM_BARE, COLUMN, Chart, Curve, Pen, TOP, sheet};

/// A figure and the name of its files.
pub(crate) struct Figure {
    pub(crate) name: &'static str,
    /// What it shows and where that comes from, for the head of the CSV.
    pub(crate) about: &'static str,
    pub(crate) columns: usize,
    pub(crate) panels: Vec<Panel>,
}

/// One pair of axes.
pub(crate) struct Panel {
    pub(crate) heading: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) traces: Vec<Trace>,
    /// Stretches of x marked on the lower edge, and what they mean.
    pub(crate) rug: (&'static str, Vec<(f64, f64)>),
    /// Numbers and label below; left out where the panel underneath has the same.
    pub(crate) label_x: bool,
    pub(crate) legend: bool,
    /// Height of the frame in px.
    pub(crate) height: f64,
}

/// A curve with the label that it has in the CSV.
pub(crate) struct Trace {
    pub(crate) label: String,
    pub(crate) curve: Curve,
}

impl Trace {
    /// `name` stands in the legend; empty for none.
    pub(crate) fn new(
        label: impl Into<String>,
        name: &'static str,
        pen: Pen,
        points: Vec<(f64, Option<f64>)>,
    ) -> Self {
        Self { label: label.into(), curve: Curve { name, points, pen } }
    }

    /// Points without gaps.
    pub(crate) fn line(
        label: impl Into<String>,
        name: &'static str,
        pen: Pen,
        points: &[(f64, f64)],
    ) -> Self {
        Self::new(label, name, pen, points.iter().map(|&(x, y)| (x, Some(y))).collect())
    }

    /// Dots: no two points are joined.
    pub(crate) fn dots(
        label: impl Into<String>,
        name: &'static str,
        pen: Pen,
        points: &[(f64, f64)],
    ) -> Self {
        Self::new(label, name, pen, points.iter().flat_map(|&(x, y)| [(x, Some(y)), (x, None)]).collect())
    }
}

impl Figure {
    pub(crate) fn svg(&self) -> String {
        let charts = self.panels.iter().map(|panel| Chart {
            heading: panel.heading.clone(),
            x: panel.x.clone(),
            y: panel.y.clone(),
            curves: panel.traces.iter().map(|trace| trace.curve.clone()).collect(),
            rug: panel.rug.1.clone(),
            rug_name: panel.rug.0,
            label_x: panel.label_x,
            label_y: true,
            legend: panel.legend,
            width: COLUMN,
            height: TOP + panel.height + if panel.label_x { BOTTOM } else { BOTTOM_BARE },
        });
        sheet("", self.columns, charts.collect())
    }

    /// `panel,curve,x,y` in SI units, with six significant digits; an empty y is a gap.
    pub(crate) fn csv(&self) -> String {
        let mut text = format!("# {}\n# Written by `cargo xtask figures`.\n", self.about);
        for (panel, letter) in self.panels.iter().zip('a'..) {
            // The axes name the unit that is drawn; here everything is in SI.
            let plain = |label: &str| label.split(" (").next().unwrap_or_default().to_owned();
            let _ = writeln!(text, "# {letter}: x {}, y {}", plain(&panel.x.label), plain(&panel.y.label));
        }
        text.push_str("panel,curve,x,y\n");
        for (panel, letter) in self.panels.iter().zip('a'..) {
            for Trace { label, curve } in &panel.traces {
                let size = |f: fn(&(f64, Option<f64>)) -> f64| {
                    curve.points.iter().map(f).fold(0.0_f64, |a, b| a.max(b.abs()))
                };
                let (across, up) = (size(|p| p.0), size(|p| p.1.unwrap_or(0.0)));
                for &(x, y) in &curve.points {
                    let y = y.map_or(String::new(), |y| six(y, up));
                    let _ = writeln!(text, "{letter},{label},{},{y}", six(x, across));
                }
            }
        }
        text
    }
}

/// Six significant digits; what is a rounding error beside `size` is zero.
fn six(value: f64, size: f64) -> String {
    if value.abs() <= 1e-7 * size {
        return "0".to_owned();
    }
    let digits = format!("{value:.5e}");
    match digits.split_once('e') {
        Some((mantissa, exponent)) => {
            let exponent: i32 = exponent.parse().unwrap_or(0);
            if (-2..6).contains(&exponent) {
                // As people write it, where that is as short.
                let plain = format!("{value:.*}", (5 - exponent).max(0) as usize);
                return plain.trim_end_matches('0').trim_end_matches('.').to_owned();
            }
            let mantissa = if mantissa.contains('.') {
                mantissa.trim_end_matches('0').trim_end_matches('.')
            } else {
                mantissa
            };
            format!("{mantissa}e{exponent}")
        }
        None => digits,
    }
}
