//! Figures of the measured data.

use std::path::Path;

use anyhow::{Context, Result};
use plot::{Axis, BOTTOM, BOTTOM_BARE, COLUMN, Chart, Curve, Pen, TOP, sheet};
use study::work_precision::{Measurement, Method, WorkPrecisionSet};

use super::data::Data;

/// Height of a frame in px.
const FRAME: f64 = 150.0;
/// Errors below this are rounding; nothing is drawn there.
const ROUNDING: f64 = 1e-13;

const BALANCE: Pen = Pen { color: "#12397a", width: 1.6, dash: None, dot: None };
const NEWTON: Pen = Pen { color: "#5b8db8", width: 1.1, dash: Some("1.5 2"), dot: None };
const ADAPTIVE: Pen = Pen { color: "#c2410c", width: 1.4, dash: Some("5 2.2"), dot: None };
const STEPPING: Pen = Pen { color: "#4d7c0f", width: 1.3, dash: Some("6 2 1.5 2"), dot: None };
const ORBIT: Pen = Pen { color: "#000000", width: 1.0, dash: None, dot: Some(3.2) };
/// An orbit is drawn where it counts as closed.
const CLOSED: f64 = 1e-12;
/// 64, 256, 1024, 4096 samples.
const SAMPLED: [(usize, &str, Pen); 4] = [
    (64, "64 samples", Pen { color: "#c9c9c9", width: 1.1, dash: None, dot: None }),
    (256, "256 samples", Pen { color: "#a3a3a3", width: 1.1, dash: None, dot: None }),
    (1024, "1024 samples", Pen { color: "#7a7a7a", width: 1.1, dash: None, dot: None }),
    (4096, "4096 samples", Pen { color: "#4a4a4a", width: 1.1, dash: None, dot: None }),
];
const SLOPE: Pen = Pen { color: "#c2410c", width: 1.0, dash: Some("2 2"), dot: None };

/// The line of slope −3.5 runs below the curve by this factor.
const BELOW: f64 = 0.4;

/// Scenes whose error over N is drawn.
const OVER_HARMONICS: [&str; 6] =
    ["scene-r", "scene-p", "many-contacts", "stiff-contact", "iwan", "hoffmann-2017"];

/// Left out of the sheet over time: scene-r says the same, and twelve panels fill it.
const ALIKE: &str = "hoffmann-2017-elastic-coulomb";

/// Writes both figures as SVG and PNG.
pub(super) fn write(root: &Path, data: &Data) -> Result<()> {
    for (name, svg) in [
        ("error-vs-runtime", over_time(&data.set).context("no measurement can be drawn")?),
        ("error-vs-harmonics", over_harmonics(data).context("no measurement can be drawn")?),
    ] {
        for extension in ["svg", "png"] {
            plot::write(&svg, &root.join("docs/figures").join(format!("{name}.{extension}")))?;
        }
    }
    Ok(())
}

/// Error that is drawn: the median of the points.
fn error(measurement: &Measurement) -> Option<f64> {
    match measurement.method {
        Method::Orbit | Method::OrbitFromBalance { .. } => measurement.median_error.map(|e| e.max(CLOSED)),
        _ => measurement.median_error.filter(|error| *error > ROUNDING),
    }
}

/// A line through the settings of a method and a dot at each.
fn series(name: &'static str, pen: Pen, points: Vec<(f64, Option<f64>)>) -> [Curve; 2] {
    let dots = points.iter().flat_map(|&(x, y)| [(x, y), (x, None)]).collect();
    let small = Pen { dot: Some(1.5), ..pen };
    match pen.dot {
        Some(_) => [Curve { name: "", points: Vec::new(), pen }, Curve { name, points: dots, pen }],
        None => [Curve { name, points, pen }, Curve { name: "", points: dots, pen: small }],
    }
}

fn over_time(set: &WorkPrecisionSet) -> Option<String> {
    let errors = || set.measurements.iter().filter_map(error);
    let x = Axis::decades("time a point (s)".to_owned(), set.measurements.iter().map(|m| m.seconds))?;
    let y = Axis::decades("relative error".to_owned(), errors())?;
    let scenes: Vec<&str> = set.scenes().into_iter().filter(|scene| *scene != ALIKE).collect();
    let count = scenes.len();
    let panel = |(i, scene): (usize, &str)| {
        let drawn = |name: &'static str, pen: Pen, is: &dyn Fn(&Method) -> bool| {
            let chosen = set.of_scene(scene).filter(|m| is(&m.method));
            series(name, pen, chosen.map(|m| (m.seconds, error(m))).collect())
        };
        let mut curves: Vec<Curve> = Vec::new();
        for (samples, name, pen) in SAMPLED {
            let is = |m: &Method| matches!(m, Method::Sampled { samples: s, .. } if *s == samples);
            curves.extend(drawn(name, pen, &is));
        }
        curves.extend(drawn("time steps", STEPPING, &|m| matches!(m, Method::Stepping { .. })));
        curves.extend(drawn("no tail", NEWTON, &|m| matches!(m, Method::WithoutTail { .. })));
        curves.extend(drawn("adaptive", ADAPTIVE, &|m| matches!(m, Method::Adaptive { .. })));
        curves.extend(drawn("balance", BALANCE, &|m| matches!(m, Method::Balance { .. })));
        let orbit = |m: &Method| matches!(m, Method::OrbitFromBalance { .. });
        curves.extend(drawn("orbit", ORBIT, &orbit));
        // Numbers below the last panel of each column.
        chart(scene.to_owned(), x.clone(), y.clone(), curves, i + 3 >= count)
    };
    Some(sheet("", 3, scenes.into_iter().enumerate().map(panel).collect()))
}

fn over_harmonics(data: &Data) -> Option<String> {
    let set = &data.set;
    let harmonics = |m: &Measurement| match m.method {
        Method::Balance { harmonics } | Method::Sampled { harmonics, .. } => Some(harmonics as f64 + 1.0),
        _ => None,
    };
    let drawn: Vec<&Measurement> = OVER_HARMONICS
        .iter()
        .flat_map(|scene| set.of_scene(scene))
        .filter(|m| harmonics(m).is_some())
        .collect();
    let x = Axis::decades("N + 1".to_owned(), drawn.iter().filter_map(|m| harmonics(m)))?;
    let errors = drawn.iter().filter_map(|m| error(m)).flat_map(|error| [error, BELOW * error]);
    let y = Axis::decades("relative error".to_owned(), errors)?;
    let scenes: Vec<&str> = OVER_HARMONICS.into_iter().filter(|s| set.of_scene(s).next().is_some()).collect();
    let count = scenes.len();
    let panel = |(i, scene): (usize, &str)| {
        let chosen = |is: &dyn Fn(&Method) -> bool| -> Vec<(f64, Option<f64>)> {
            let some = set.of_scene(scene).filter(|m| is(&m.method));
            some.filter_map(|m| Some((harmonics(m)?, error(m)))).collect()
        };
        let mut curves: Vec<Curve> = Vec::new();
        for (samples, name, pen) in SAMPLED {
            let is = |m: &Method| matches!(m, Method::Sampled { samples: s, .. } if *s == samples);
            curves.extend(series(name, pen, chosen(&is)));
        }
        let balance = chosen(&|m| matches!(m, Method::Balance { .. }));
        let stick_slip = data.origin(scene).is_some_and(|origin| origin.orbits > 0);
        if let Some(&(from, Some(error))) = balance.iter().find(|(n, _)| stick_slip && *n >= 16.0) {
            let last = balance.iter().map(|(n, _)| *n).fold(from, f64::max);
            let line = |n: f64| (n, Some(BELOW * error * (n / from).powf(-3.5)));
            curves.push(Curve { name: "slope −3.5", points: vec![line(from), line(last)], pen: SLOPE });
        }
        curves.extend(series("balance", BALANCE, balance));
        chart(scene.to_owned(), x.clone(), y.clone(), curves, i + 3 >= count)
    };
    Some(sheet("", 3, scenes.into_iter().enumerate().map(panel).collect()))
}

fn chart(heading: String, x: Axis, y: Axis, curves: Vec<Curve>, label_x: bool) -> Chart {
    Chart {
        heading,
        x,
        y,
        curves,
        rug: Vec::new(),
        rug_name: "",
        label_x,
        label_y: true,
        legend: false,
        width: COLUMN,
        height: TOP + FRAME + if label_x { BOTTOM } else { BOTTOM_BARE },
    }
}
