//! Fig. 4: the forced response of both masses, and the same with more harmonics than the paper could use.

use anyhow::{Context, Result};
use plot::Axis;
use scene::{Frequencies, RunOptions, Scene};

use super::figure::{Figure, Panel, Trace};
use super::pens;
use crate::markdown::{signed, table};

/// (Hz, |W_1| in m); `None` where there is no solution.
type Point = (f64, Option<f64>);
type Response = Vec<Point>;

/// Numbers of harmonics that are compared; the last is the reference.
pub(crate) const HARMONICS: [usize; 4] = [1, 3, 7, 31];
const NAMES: [&str; 4] = ["N = 1 (paper)", "N = 3", "N = 7", "N = 31"];
/// Frequencies at which the table compares, in Hz.
const COMPARED: [f64; 8] = [25.0, 35.0, 43.0, 55.0, 58.0, 75.0, 108.0, 118.0];
/// Harmonics that tell how far N = 31 is from the limit.
const BEYOND: usize = 63;
const RANGE: &str = "15:200:371";

/// Fig. 4 of the paper.
pub(crate) fn paper(hysteresis: &Scene, coulomb: &Scene) -> Result<Figure> {
    let (prepared, other) = (hysteresis.prepare()?, coulomb.prepare()?);
    let (solved, other) = (prepared.solve(&RunOptions::default()), other.solve(&RunOptions::default()));
    let mut panels = Vec::new();
    let headings = ["(a) m1, blade root", "(b) m2, blade"];
    for ((one, other), heading) in
        solved.responses().responses.into_iter().zip(other.responses().responses).zip(headings)
    {
        let traces = vec![
            Trace::new("linear", "linear", pens::REFERENCE, one.linear),
            Trace::new("elastic Coulomb", "elastic Coulomb", pens::DOTTED, other.contact),
            Trace::new("hysteresis model", "hysteresis model", pens::MAIN, one.contact),
        ];
        let last = panels.len() == 1;
        panels.push(panel(
            format!("{heading} (parameters reconstructed)"),
            (0.0, 200.0),
            traces,
            last,
            !last,
            150.0,
        )?);
    }
    Ok(Figure {
        name: "fig-4-response",
        about: "Forced response, |W_1| in m over frequency in Hz, of scenes/hoffmann-2017.json and \
                scenes/hoffmann-2017-elastic-coulomb.json (reconstructed parameters), one harmonic.",
        columns: 1,
        panels,
    })
}

/// The response for each of [`HARMONICS`].
pub(crate) struct Harmonics {
    /// Of m1 and of m2.
    responses: Vec<[Response; 2]>,
    /// |W_1| of m1 in m at [`COMPARED`] with twice the harmonics.
    beyond: Vec<f64>,
    /// Where the motion of m1 turns back more than twice a period, N = 31.
    reversals: Vec<(f64, f64)>,
}

impl Harmonics {
    pub(crate) fn solve(hysteresis: &Scene) -> Result<Self> {
        let mut responses = Vec::new();
        let mut reversals: Vec<(f64, f64)> = Vec::new();
        for n in HARMONICS {
            let scene = hysteresis.clone().with_frequencies(RANGE.parse()?).with_harmonics(n)?;
            let prepared = scene.prepare()?;
            let solved = prepared.solve(&RunOptions::default());
            let [m1, m2]: [_; 2] = solved.responses().responses.try_into().ok().context("two dofs")?;
            responses.push([m1.contact, m2.contact]);
            if Some(&n) == HARMONICS.last() {
                let frequencies: Vec<f64> = solved.solutions().iter().map(|s| s.frequency).collect();
                let half = frequencies.windows(2).next().map_or(0.0, |pair| 0.5 * (pair[1] - pair[0]));
                for solution in solved.solutions() {
                    let more = solution.contacts.first().is_some_and(|c| c.turning_points > 2);
                    let (from, to) = (solution.frequency - half, solution.frequency + half);
                    match reversals.last_mut() {
                        _ if !more => {}
                        Some((_, end)) if (*end - from).abs() < 1e-9 => *end = to,
                        _ => reversals.push((from, to)),
                    }
                }
            }
        }
        let beyond =
            COMPARED.map(|hertz| amplitude(hysteresis, hertz, BEYOND)).into_iter().collect::<Result<_>>()?;
        Ok(Self { responses, beyond, reversals })
    }

    pub(crate) fn figure(&self) -> Result<Figure> {
        let range = (15.0, 200.0);
        let traces = |mass: usize| -> Vec<Trace> {
            let each = self.responses.iter().zip(NAMES).zip(pens::HARMONICS);
            each.map(|((response, name), pen)| Trace::new(name, name, pen, response[mass].clone())).collect()
        };
        let differences = (self.responses.iter().zip(NAMES).zip(pens::HARMONICS).take(3))
            .map(|((response, name), pen)| {
                let difference = |(one, other): (&Point, &Point)| {
                    (one.0, one.1.zip(other.1).map(|(a, b)| 100.0 * (a / b - 1.0).abs()))
                };
                let exact = &self.responses[HARMONICS.len() - 1][0];
                Trace::new(name, "", pen, response[0].iter().zip(exact).map(difference).collect())
            })
            .collect();
        let mut panels = vec![
            panel("(a) m1, blade root (new: multi-harmonic)".into(), range, traces(0), false, true, 150.0)?,
            panel("(b) m2, blade".into(), range, traces(1), false, false, 150.0)?,
            panel("(c) m1, difference from N = 31".into(), range, differences, true, true, 110.0)?,
        ];
        if let Some(last) = panels.last_mut() {
            last.y = Axis::decades("difference (%)".into(), [1e-3, 1e3].into_iter()).context("an axis")?;
            clip(&mut last.traces, 1e-3);
            last.rug = ("interior reversals", self.reversals.clone());
        }
        Ok(Figure {
            name: "harmonics",
            about: "Forced response, |W_1| in m over frequency in Hz, of scenes/hoffmann-2017.json (reconstructed \
                    parameters, synthetic loop) for N = 1, 3, 7 and 31 harmonics; difference from N = 31 in %.",
            columns: 1,
            panels,
        })
    }

    /// |W_1| of both masses for N = 1 against N = 31.
    pub(crate) fn table(&self) -> String {
        let at = |n: usize, mass: usize, hertz: f64| {
            let response = self.responses.get(n).map(|pair| &pair[mass]);
            let point = response.and_then(|r| r.iter().find(|(f, _)| (f - hertz).abs() < 1e-9));
            point.and_then(|(_, amplitude)| *amplitude).unwrap_or(f64::NAN)
        };
        let off = |n: usize, mass: usize, hertz: f64| {
            format!(
                "{} %",
                signed(100.0 * (at(n, mass, hertz) / at(HARMONICS.len() - 1, mass, hertz) - 1.0), 1)
            )
        };
        let row = |(hertz, beyond): (f64, &f64)| {
            let last = at(HARMONICS.len() - 1, 0, hertz) / beyond - 1.0;
            [
                format!("{hertz} Hz"),
                format!("{:.3} µm", 1e6 * at(HARMONICS.len() - 1, 0, hertz)),
                off(0, 0, hertz),
                off(1, 0, hertz),
                off(2, 0, hertz),
                format!("{} %", signed(100.0 * last, 2)),
                off(0, 1, hertz),
            ]
        };
        let head =
            ["", "m1, N = 31", "m1, N = 1", "m1, N = 3", "m1, N = 7", "m1, 31 against 63", "m2, N = 1"];
        table(head, &COMPARED.into_iter().zip(&self.beyond).map(row).collect::<Vec<_>>())
    }
}

/// |W_1| of the first output in m.
fn amplitude(scene: &Scene, hertz: f64, n: usize) -> Result<f64> {
    let scene = scene.clone().with_frequencies(Frequencies::one(hertz)?).with_harmonics(n)?;
    let prepared = scene.prepare()?;
    let responses = prepared.solve(&RunOptions::default()).responses().responses;
    let point = responses.first().and_then(|response| response.contact.first());
    point
        .and_then(|(_, amplitude)| *amplitude)
        .with_context(|| format!("{hertz} Hz with N = {n} was not solved"))
}

/// Leaves out what lies below the frame.
fn clip(traces: &mut [Trace], lowest: f64) {
    for trace in traces {
        trace.curve.points.iter_mut().for_each(|(_, y)| *y = y.filter(|y| *y >= lowest));
    }
}

fn panel(
    heading: String,
    (from, to): (f64, f64),
    traces: Vec<Trace>,
    label_x: bool,
    legend: bool,
    height: f64,
) -> Result<Panel> {
    let amplitudes = traces.iter().flat_map(|trace| trace.curve.points.iter().filter_map(|(_, y)| *y));
    Ok(Panel {
        heading,
        x: Axis::tight("frequency (Hz)".into(), [from, to].into_iter()).context("no frequency")?,
        y: Axis::decades("|W₁| (m)".into(), amplitudes).context("no amplitude")?,
        traces,
        rug: ("", Vec::new()),
        label_x,
        legend,
        height,
    })
}
