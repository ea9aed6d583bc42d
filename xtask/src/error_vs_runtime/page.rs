//! The page `docs/src/error-vs-runtime.md`: its words stand in `page.md`, its numbers in the measured data.

use anyhow::{Result, ensure};
use study::Convergence;
use study::work_precision::{Measurement, Method, WorkPrecisionSet};

use super::data::{Data, Origin};
use super::grid::SAMPLES;
use super::march::Way;
use super::{COMMAND, LARGEST};
use crate::estimates;
use crate::markdown::{significant, table};

/// The page's words, with `{{name}}` where numbers go.
const WORDS: &str = include_str!("page.md");

/// The page with its tables; fails when a place is left or has none.
pub(super) fn page(data: &Data) -> Result<String> {
    let mut text = WORDS.to_owned();
    let set = &data.set;
    for (name, words) in [
        ("command", COMMAND.to_owned()),
        ("machine", machine(set)),
        ("truths", truths(data)),
        ("three-digits", choice(set, 1e-3)),
        ("six-digits", choice(set, 1e-6)),
        ("nine-digits", choice(set, 1e-9)),
        ("harmonics", harmonics(data)),
        ("samples", samples(set)),
        ("adaptive", adaptive(set)),
        ("stepping", stepping(set)),
        ("march", march(data)),
        ("estimates", estimates::scene_table(&data.estimates)),
    ] {
        let place = format!("{{{{{name}}}}}");
        ensure!(text.contains(&place), "page.md has no place for {name}");
        text = text.replace(&place, words.trim_end());
    }
    ensure!(!text.contains("{{"), "page.md has a place that nothing fills");
    Ok(text)
}

fn dash() -> String {
    "—".to_owned()
}

/// Two digits of a time in a unit that keeps it short.
pub(crate) fn time(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", significant(seconds * factor, 2))
}

fn scientific(error: Option<f64>) -> String {
    error.map_or_else(dash, |error| format!("{error:.1e}"))
}

fn machine(set: &WorkPrecisionSet) -> String {
    let (machine, patience) = (&set.machine, &set.patience);
    format!(
        "{}, {} cores, {}, {}; default release build. Everything that is timed runs on one thread. A time is the median \
         of {} to {} repeats after a warm-up (no more once {} s are over; a warm-up of more than {} s is the only run).",
        machine.cpu,
        machine.cores,
        machine.os,
        machine.rustc,
        patience.least,
        patience.most,
        patience.enough,
        patience.longest
    )
}

fn truths(data: &Data) -> String {
    let row = |origin: &Origin| {
        [
            origin.scene.clone(),
            origin.points.to_string(),
            origin.truths.to_string(),
            origin.orbits.to_string(),
            origin.reference.clone(),
            format!("{:.0e}", origin.accuracy),
        ]
    };
    let rows: Vec<_> = data.origins.iter().map(row).collect();
    table(["scene", "points", "with a truth", "exact orbits", "truth", "its error below"], &rows)
}

/// The cheapest setting of the methods that `is` names whose every point has an error below `tolerance`.
fn cheapest<'a>(
    set: &'a WorkPrecisionSet,
    scene: &'a str,
    tolerance: f64,
    is: impl Fn(&Method) -> bool,
) -> Option<&'a Measurement> {
    set.of_scene(scene)
        .filter(|m| is(&m.method) && m.worst_error.is_some_and(|error| error <= tolerance))
        .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

/// What it costs to have every point of a scene below a tolerance.
fn choice(set: &WorkPrecisionSet, tolerance: f64) -> String {
    let cell = |found: Option<&Measurement>| {
        found.map_or_else(dash, |m| match m.method {
            Method::Balance { harmonics } => format!("{} (N = {harmonics})", time(m.seconds)),
            Method::Sampled { harmonics, samples } => {
                format!("{} (N = {harmonics}, {samples})", time(m.seconds))
            }
            Method::Adaptive { .. } => format!("{} (N ≈ {:.0})", time(m.seconds), m.harmonics),
            Method::Stepping { steps } => format!("{} ({steps})", time(m.seconds)),
            _ => time(m.seconds),
        })
    };
    let row = |scene: &&str| {
        let find = |is: &dyn Fn(&Method) -> bool| cell(cheapest(set, scene, tolerance, is));
        [
            (*scene).to_owned(),
            find(&|m| matches!(m, Method::Balance { .. })),
            find(&|m| matches!(m, Method::Adaptive { .. })),
            find(&|m| matches!(m, Method::Sampled { .. })),
            find(&|m| matches!(m, Method::Stepping { .. })),
            find(&|m| matches!(m, Method::Orbit | Method::OrbitFromBalance { .. })),
        ]
    };
    let rows: Vec<_> = set.scenes().iter().map(row).collect();
    table(["scene", "balance", "adaptive", "sampled (N, samples)", "time steps (a period)", "orbit"], &rows)
}

/// N that the table of errors shows.
const SHOWN: [usize; 6] = [1, 7, 31, 127, 255, 1023];
/// N + 1 between which the order is fitted.
const FITTED: (f64, f64) = (16.0, 1024.0);
/// Errors below this multiple of the truth's are not fitted.
const KNOWN: f64 = 10.0;

fn harmonics(data: &Data) -> String {
    let row = |scene: &&str| {
        let balance = |m: &&Measurement| matches!(m.method, Method::Balance { .. });
        let measured: Vec<&Measurement> = data.set.of_scene(scene).filter(balance).collect();
        let at = |n: usize| measured.iter().find(|m| m.method == Method::Balance { harmonics: n });
        let mut cells = vec![(*scene).to_owned()];
        cells.extend(SHOWN.map(|n| {
            at(n).map_or_else(dash, |m| {
                format!("{} / {}", scientific(m.median_error), scientific(m.worst_error))
            })
        }));
        let floor = data.origin(scene).map_or(0.0, |origin| KNOWN * origin.accuracy);
        let point = |m: &&Measurement| match m.method {
            Method::Balance { harmonics } => {
                Some((harmonics as f64 + 1.0, m.median_error.filter(|error| *error > floor)?))
            }
            _ => None,
        };
        let convergence = Convergence { points: measured.iter().filter_map(point).collect() };
        let order = convergence.rate(FITTED.0, FITTED.1);
        cells.push(order.map_or_else(dash, |order| significant(order.order, 3)));
        <[String; 8]>::try_from(cells).unwrap_or_default()
    };
    let rows: Vec<_> = data.set.scenes().iter().map(row).collect();
    table(["scene", "N = 1", "7", "31", "127", "255", "1023", "order"], &rows)
}

/// The smallest median error that a number of samples reaches, beside that of events at the same N.
fn samples(set: &WorkPrecisionSet) -> String {
    let row = |scene: &&str| {
        let floor = |samples: usize| {
            let sampled =
                |m: &&Measurement| matches!(m.method, Method::Sampled { samples: s, .. } if s == samples);
            let errors = set.of_scene(scene).filter(sampled).filter_map(|m| m.median_error);
            errors.min_by(f64::total_cmp)
        };
        let balance = set.of_scene(scene).find(|m| m.method == Method::Balance { harmonics: LARGEST });
        let mut cells = vec![(*scene).to_owned()];
        cells.extend(SAMPLES.map(|samples| scientific(floor(samples))));
        cells.push(scientific(balance.and_then(|m| m.median_error)));
        <[String; 7]>::try_from(cells).unwrap_or_default()
    };
    let rows: Vec<_> = set.scenes().iter().map(row).collect();
    table(["scene", "64 samples", "128", "256", "1024", "4096", "balance, N = 127"], &rows)
}

/// Tolerances that the table shows.
const TOLERANCES: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];

fn adaptive(set: &WorkPrecisionSet) -> String {
    let row = |scene: &&str| {
        let mut cells = vec![(*scene).to_owned()];
        cells.extend(TOLERANCES.map(|wanted| {
            let is = |m: &&Measurement| matches!(m.method, Method::Adaptive { tolerance, .. } if tolerance == wanted);
            set.of_scene(scene).find(is).map_or_else(dash, |m| {
                format!("{}, N ≈ {:.0}, {}", scientific(m.worst_error), m.harmonics, time(m.seconds))
            })
        }));
        <[String; 5]>::try_from(cells).unwrap_or_default()
    };
    let rows: Vec<_> = set.scenes().iter().map(row).collect();
    table(["scene", "1e-2", "1e-4", "1e-6", "1e-8"], &rows)
}

fn stepping(set: &WorkPrecisionSet) -> String {
    let row = |scene: &&str| {
        let steps =
            |wanted: usize| set.of_scene(scene).find(|m| m.method == Method::Stepping { steps: wanted });
        let cell = |m: Option<&Measurement>| {
            m.map_or_else(dash, |m| format!("{}, {}", scientific(m.median_error), time(m.seconds)))
        };
        let periods = steps(256).map_or_else(dash, |m| format!("{:.0}", m.periods));
        [
            (*scene).to_owned(),
            periods,
            cell(steps(64)),
            cell(steps(256)),
            cell(steps(1024)),
            cell(steps(4096)),
        ]
    };
    let all = set.scenes();
    let stepped = |scene: &&&str| set.of_scene(scene).any(|m| matches!(m.method, Method::Stepping { .. }));
    let rows: Vec<_> = all.iter().filter(stepped).map(row).collect();
    table(["scene", "periods until it repeats", "64 steps a period", "256", "1024", "4096"], &rows)
}

fn march(data: &Data) -> String {
    let mut rows = Vec::new();
    for own in data.marches.iter().filter(|march| march.way == Way::Independent) {
        let other = |way: Way| {
            data.marches.iter().find(|m| (&m.scene, m.harmonics, m.way) == (&own.scene, own.harmonics, way))
        };
        let cell = |march: Option<&super::march::March>| {
            march.map_or_else(dash, |m| format!("{:.1}, {}", m.iterations, time(m.seconds)))
        };
        let same = other(Way::March).map_or_else(dash, |m| format!("{:.1} %", 100.0 * m.same));
        rows.push([
            own.scene.clone(),
            own.harmonics.to_string(),
            cell(Some(own)),
            cell(other(Way::March)),
            cell(other(Way::MarchDifference)),
            same,
        ]);
    }
    table(["scene", "N", "independent points", "march", "march, differences", "same solution"], &rows)
}
