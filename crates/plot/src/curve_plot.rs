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
    /// For each point: it is known to be unstable. May be empty.
    pub unstable: Vec<bool>,
    /// The same as the points where the curve folds.
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
        let points = panel.points.iter().map(|&(x, a)| (x, Some(a)));
        let (stable, unstable) = by_stability(points.zip(marks(&panel.unstable)));
        Chart {
            heading: panel.title.clone(),
            x: x.clone(),
            y,
            curves: vec![
                Curve { name: "", points: stable, pen: pen::MAIN },
                Curve { name: "", points: unstable, pen: pen::UNSTABLE },
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

/// A curve's points; `None` interrupts it.
type Points = Vec<(f64, Option<f64>)>;

/// One mark a point, however many there are.
pub(super) fn marks(unstable: &[bool]) -> impl Iterator<Item = bool> {
    unstable.iter().copied().chain(std::iter::repeat(false))
}

/// The stable and the unstable parts of a curve; a stretch is unstable when one of its ends is.
pub(super) fn by_stability(points: impl Iterator<Item = ((f64, Option<f64>), bool)>) -> (Points, Points) {
    let (mut stable, mut unstable) = (Points::new(), Points::new());
    let mut last: Option<((f64, Option<f64>), bool)> = None;
    for (point, marked) in points {
        let dashed = marked || last.is_some_and(|(_, before)| before);
        let (drawn, other) = if dashed { (&mut unstable, &mut stable) } else { (&mut stable, &mut unstable) };
        if let Some((before, _)) = last
            && drawn.last() != Some(&before)
        {
            drawn.push(before);
        }
        drawn.push(point);
        if other.last().is_some_and(|(_, amplitude)| amplitude.is_some()) {
            other.push((point.0, None));
        }
        last = Some((point, marked));
    }
    (stable, unstable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_beside_an_unstable_point_are_dashed() {
        let points = (0..6).map(|i| (f64::from(i), Some(1.0)));
        let unstable = [false, false, true, false, false, false];
        let (solid, dashed) = by_stability(points.zip(unstable));
        let places = |points: &Points| points.iter().map(|(x, a)| a.map(|_| *x)).collect::<Vec<_>>();
        assert_eq!(places(&solid), [Some(0.0), Some(1.0), None, Some(3.0), Some(4.0), Some(5.0)]);
        assert_eq!(places(&dashed), [Some(1.0), Some(2.0), Some(3.0), None]);
    }

    #[test]
    fn an_unstable_part_is_drawn_dashed() {
        let mut plot = CurvePlot {
            title: String::new(),
            parameter: "frequency (Hz)".into(),
            panels: vec![CurvePanel {
                title: "w".into(),
                points: (1..9).map(|i| (f64::from(i), f64::from(i))).collect(),
                unstable: Vec::new(),
                folds: Vec::new(),
            }],
            quantity: "|W_1|".into(),
        };
        assert!(!draw(&plot).unwrap().contains("stroke-dasharray"));
        plot.panels[0].unstable = (1..9).map(|i| (4..6).contains(&i)).collect();
        assert!(draw(&plot).unwrap().contains("stroke-dasharray"));
    }
}
