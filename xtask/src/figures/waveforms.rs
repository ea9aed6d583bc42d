//! One period: the loop that the contact goes through and the motion of m1, where one harmonic is not enough.

use std::f64::consts::TAU;

use anyhow::{Context, Result};
use plot::Axis;
use scene::{Frequencies, RunOptions, Scene};

use super::figure::{Figure, Panel, Trace};
use super::pens;

/// Where N = 1 is off by tens of percent, and where the motion turns back inside a period; in Hz.
const FREQUENCIES: [f64; 2] = [55.0, 30.0];
const HARMONICS: [(usize, &str); 2] = [(1, "N = 1"), (31, "N = 31")];

/// A period: phase/2π, displacement of the contact in m, friction force in N.
type Period = Vec<(f64, f64, f64)>;

/// Loops on the left, motions on the right.
pub(crate) fn figure(hysteresis: &Scene) -> Result<Figure> {
    let mut panels = Vec::new();
    for (hertz, letters) in FREQUENCIES.into_iter().zip([["(a)", "(b)"], ["(c)", "(d)"]]) {
        let mut loops = Vec::new();
        let mut motions = Vec::new();
        for (n, name) in HARMONICS {
            let pen = if n == 1 { pens::HARMONICS[0] } else { pens::HARMONICS[3] };
            let period = period(hysteresis, hertz, n)?;
            let points: Vec<_> = period.iter().map(|&(_, w, f)| (w, f)).collect();
            loops.push(Trace::line(name, name, pen, &points));
            let points: Vec<_> = period.iter().map(|&(t, w, _)| (t, w)).collect();
            motions.push(Trace::line(name, "", pen, &points));
        }
        let all = |traces: &[Trace], pick: fn(&(f64, Option<f64>)) -> f64| -> Vec<f64> {
            traces.iter().flat_map(|trace| trace.curve.points.iter().map(pick)).collect()
        };
        let w = Axis::measured("w1", "m", all(&loops, |p| p.0).into_iter()).context("no motion")?;
        let f = Axis::measured("friction force", "N", all(&loops, |p| p.1.unwrap_or(0.0)).into_iter());
        let t = Axis::tight("Ωt / 2π".into(), [0.0, 1.0].into_iter()).context("no time")?;
        let panel = |heading: String, x: Axis, y: Axis, traces: Vec<Trace>, legend: bool| Panel {
            heading,
            x,
            y,
            traces,
            rug: ("", Vec::new()),
            label_x: true,
            legend,
            height: 160.0,
        };
        let [left, right] = letters;
        panels.push(panel(format!("{left} {hertz} Hz, loop (new)"), w.clone(), f.context("no force")?, loops, true));
        panels.push(panel(format!("{right} {hertz} Hz, motion of m1"), t, w, motions, false));
    }
    Ok(Figure {
        name: "waveforms",
        about: "One period of the contact of scenes/hoffmann-2017.json (reconstructed parameters, synthetic loop) for \
                N = 1 and N = 31: friction force in N over w1 in m, and w1 over the period.",
        columns: 2,
        panels,
    })
}

fn period(scene: &Scene, hertz: f64, n: usize) -> Result<Period> {
    let scene = scene.clone().with_frequencies(Frequencies::one(hertz)?).with_harmonics(n)?;
    let prepared = scene.prepare()?;
    let solved = prepared.solve(&RunOptions::default());
    let motion = solved.motion().context("the point was not solved")?;
    let contact = motion.waveform.contacts.first().context("no contact")?;
    let samples = motion.waveform.phase.iter().zip(&contact.displacement).zip(&contact.force);
    // The force that moves the contact: that on the mass is its opposite.
    let mut period: Period = samples.map(|((phase, w), f)| (phase / TAU, *w, -f)).collect();
    let end = period.first().map(|&(_, w, f)| (1.0, w, f));
    period.extend(end);
    let every = (period.len() / 500).max(1);
    let last = period.len() - 1;
    Ok(period.into_iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last).map(|(_, p)| p).collect())
}
