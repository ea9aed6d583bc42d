//! The loops that contacts run through in a period of a solution: force against relative displacement.

use std::path::Path;

use anyhow::{Result, bail};

use super::axis::Axis;
use super::chart::{BOTTOM, Chart, Curve, TOP};
use super::sheet::{COLUMN, sheet};
use super::{image, pen};

/// The loop of one contact in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLoop {
    /// Name of the contact and of its direction.
    pub title: String,
    /// Relative displacement in m and force in N over a period, its end left out.
    pub points: Vec<(f64, f64)>,
}

/// Loops of one solution.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLoops {
    /// Written above all; may be empty.
    pub title: String,
    /// One a panel.
    pub loops: Vec<ContactLoop>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_contact_loops(plot: &ContactLoops, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Height of a frame in px (1/96 in).
const FRAME: f64 = 200.0;

fn draw(plot: &ContactLoops) -> Result<String> {
    let mut charts = Vec::new();
    for contact in &plot.loops {
        let x = Axis::measured("displacement", "m", contact.points.iter().map(|(w, _)| *w));
        let y = Axis::measured("force", "N", contact.points.iter().map(|(_, f)| *f));
        let (Some(x), Some(y)) = (x, y) else { bail!("nothing to plot: {} has no numbers", contact.title) };
        let closed = contact.points.iter().chain(contact.points.first());
        charts.push(Chart {
            heading: contact.title.clone(),
            x,
            y,
            curves: vec![Curve {
                name: "",
                points: closed.map(|&(w, f)| (w, Some(f))).collect(),
                pen: pen::MAIN,
            }],
            rug: Vec::new(),
            rug_name: "",
            label_x: true,
            label_y: true,
            legend: false,
            width: COLUMN,
            height: TOP + FRAME + BOTTOM,
        });
    }
    if charts.is_empty() {
        bail!("nothing to plot: there is no contact");
    }
    let columns = if charts.len() > 1 { 2 } else { 1 };
    Ok(sheet(&plot.title, columns, charts))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(count: usize) -> ContactLoops {
        let turn = |j: usize| std::f64::consts::TAU * j as f64 / 256.0;
        let point = |phase: f64| (4e-6 * phase.cos(), 9.0 * (phase + 1.2).cos() + 1.5 * (3.0 * phase).cos());
        let one = |i: usize| ContactLoop {
            title: format!("shroud[{i}] tangential"),
            points: (0..256).map(|j| point(turn(j))).collect(),
        };
        ContactLoops { title: "blade at 57 Hz".into(), loops: (0..count).map(one).collect() }
    }

    #[test]
    fn every_loop_has_its_frame() {
        let svg = draw(&example(3)).unwrap();
        assert_eq!(svg.matches(">displacement (µm)</text>").count(), 3);
        assert!(svg.contains("shroud[2] tangential"));
        assert!(draw(&example(0)).unwrap_err().to_string().contains("nothing to plot"));
        let mut still = example(1);
        still.loops[0].points = vec![(0.0, f64::NAN)];
        assert!(draw(&still).is_err());
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_contact_loops_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        write_contact_loops(&example(1), &folder.join("contact-loop.png")).unwrap();
        write_contact_loops(&example(3), &folder.join("contact-loops.png")).unwrap();
    }
}
