//! A periodic motion in time: displacements and contact forces over a period, and its events.

use std::path::Path;

use anyhow::{Result, bail};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
use super::sheet::{COLUMN, sheet};
use super::{image, pen};

/// One quantity over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitPanel {
    /// Name of the dof or contact.
    pub title: String,
    /// What is drawn, and its unit: `("displacement", "m")`.
    pub quantity: (&'static str, &'static str),
    /// Time over period, value.
    pub values: Vec<(f64, f64)>,
    /// Likewise where slip or stick begins.
    pub events: Vec<(f64, f64)>,
}

/// A periodic motion.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitPlot {
    /// Written above all panels; may be empty.
    pub title: String,
    /// One a dof or contact.
    pub panels: Vec<OrbitPanel>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_orbit(plot: &OrbitPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Height of a frame in px (1/96 in).
const FRAME: f64 = 110.0;

/// More panels than this stand in two columns.
const COLUMNED: usize = 4;

fn draw(plot: &OrbitPlot) -> Result<String> {
    let Some(x) = Axis::tight("time / period".into(), [0.0, 1.0].into_iter()) else {
        bail!("nothing to plot: no time");
    };
    let count = plot.panels.len();
    let columns = if count > COLUMNED { 2 } else { 1 };
    let legend = plot.panels.iter().position(|panel| !panel.events.is_empty());
    let mut charts = Vec::new();
    for (i, panel) in plot.panels.iter().enumerate() {
        let points =
            |list: &[(f64, f64)]| list.iter().map(|&(t, value)| (t, Some(value))).collect::<Vec<_>>();
        let (quantity, unit) = panel.quantity;
        let Some(y) = Axis::measured(quantity, unit, panel.values.iter().map(|(_, value)| *value)) else {
            bail!("nothing to plot: {} has no numbers", panel.title);
        };
        let lowest = i + columns >= count;
        charts.push(Chart {
            heading: panel.title.clone(),
            x: x.clone(),
            y,
            curves: vec![
                Curve { name: "exact motion", points: points(&panel.values), pen: pen::MAIN },
                Curve { name: "slip or stick begins", points: points(&panel.events), pen: EVENT },
            ],
            rug: Vec::new(),
            rug_name: "",
            label_x: lowest,
            label_y: true,
            legend: legend == Some(i),
            width: COLUMN,
            height: TOP + FRAME + if lowest { BOTTOM } else { BOTTOM_BARE },
        });
    }
    if charts.is_empty() {
        bail!("nothing to plot: no dof is reported");
    }
    Ok(sheet(&plot.title, columns, charts))
}

/// Dots of events.
const EVENT: pen::Pen = pen::Pen { color: "#d2691e", width: 1.2, dash: None, dot: Some(2.4) };

#[cfg(test)]
mod tests {
    use super::*;

    fn example(panels: usize) -> OrbitPlot {
        let value =
            |j: usize| (j as f64 / 400.0, 3e-6 * (j as f64 / 400.0 * std::f64::consts::TAU).cos().powi(3));
        let panel = |i: usize| OrbitPanel {
            title: format!("w{i}"),
            quantity: if i.is_multiple_of(2) { ("displacement", "m") } else { ("force", "N") },
            values: (0..=400).map(value).collect(),
            events: if i.is_multiple_of(2) { Vec::new() } else { [30, 170, 260].map(value).to_vec() },
        };
        OrbitPlot { title: "blade at 57 Hz".into(), panels: (0..panels).map(panel).collect() }
    }

    #[test]
    fn events_are_dots_on_the_curve() {
        let svg = draw(&example(2)).unwrap();
        // Three, and one in the legend.
        assert_eq!(svg.matches("<circle").count(), 4);
        assert!(svg.contains("time / period") && svg.contains("displacement (µm)"));
        assert!(draw(&example(0)).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_orbits_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        write_orbit(&example(3), &folder.join("orbit.png")).unwrap();
        write_orbit(&example(6), &folder.join("orbit-six.png")).unwrap();
    }
}
