//! Four panels, one a quantity: time a point (or a sweep) over it.

use plot::{Axis, BOTTOM, COLUMN, Chart, Curve, Pen, TOP, sheet};

use super::exponent;
use super::family::Family;
use super::measure::Measured;

const FRAME: f64 = 150.0;
const LINE: Pen = Pen { color: "#12397a", width: 1.4, dash: None, dot: None };
const DOT: Pen = Pen { color: "#12397a", width: 1.0, dash: None, dot: Some(2.0) };
const SECOND: Pen = Pen { color: "#c2410c", width: 1.4, dash: Some("5 2.2"), dot: None };
const SECOND_DOT: Pen = Pen { color: "#c2410c", width: 1.0, dash: None, dot: Some(2.0) };

/// What is drawn of a family: (size, seconds).
pub(super) fn points(measured: &[Measured], family: Family) -> Vec<(f64, f64)> {
    let whole = matches!(family, Family::Points | Family::PointsOnTwoThreads);
    // A harmonic balance of N harmonics has N + 1 of them.
    let more = usize::from(family == Family::Harmonics);
    measured
        .iter()
        .filter(|m| m.family == family)
        .map(|m| ((m.size + more) as f64, m.seconds * if whole { m.points as f64 } else { 1.0 }))
        .collect()
}

pub(super) fn figure(measured: &[Measured]) -> Option<String> {
    let panel = |families: &[(Family, &'static str, Pen, Pen)], x: &str, y: &str| -> Option<Chart> {
        let drawn: Vec<Vec<(f64, f64)>> = families.iter().map(|f| points(measured, f.0)).collect();
        let all = || drawn.iter().flatten();
        let mut curves = Vec::new();
        for ((_, name, line, dot), points) in families.iter().zip(&drawn) {
            let line_points = points.iter().map(|&(x, y)| (x, Some(y))).collect();
            curves.push(Curve { name, points: line_points, pen: *line });
            let dots = points.iter().flat_map(|&(x, y)| [(x, Some(y)), (x, None)]).collect();
            curves.push(Curve { name: "", points: dots, pen: *dot });
        }
        let slope = exponent(drawn.first()?)?;
        Some(Chart {
            heading: format!("exponent {slope:.2}"),
            x: Axis::decades(x.to_owned(), all().map(|p| p.0))?,
            y: Axis::decades(y.to_owned(), all().map(|p| p.1))?,
            legend: families.len() > 1,
            curves,
            rug: Vec::new(),
            rug_name: "",
            label_x: true,
            label_y: true,
            width: COLUMN,
            height: TOP + FRAME + BOTTOM,
        })
    };
    let time = "time a point (s)";
    let charts = vec![
        panel(&[(Family::Dofs, "", LINE, DOT)], "dofs", time)?,
        panel(&[(Family::Contacts, "", LINE, DOT)], "contacts", time)?,
        panel(&[(Family::Harmonics, "", LINE, DOT)], "N + 1", time)?,
        panel(
            &[
                (Family::Points, "one thread", LINE, DOT),
                (Family::PointsOnTwoThreads, "two threads", SECOND, SECOND_DOT),
            ],
            "points",
            "time of a sweep (s)",
        )?,
    ];
    Some(sheet("", 2, charts))
}
