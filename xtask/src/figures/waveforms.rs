//! One period: the loop that the contact goes through and the motion of m1, where one harmonic is not enough.

use std::f64::consts::TAU;

use anyhow::{Context, Result};
use plot::Axis;
use scene::{Frequencies, RunOptions, Scene};

use super::figure::{Figure, Panel, Trace};
use super::pens;

/// Where N = 1 is off by tens of percent, and where the motion turns back inside a period; in Hz.
const FREQUENCIES: [f64; 2] = [55.0, 36.0];
/// Part of the second loop that is shown enlarged: phase/2π around its upper turning point and after.
const DETAIL: (f64, f64) = (0.15, 0.44);

/// A period: phase/2π, displacement of the contact in m, friction force in N.
type Period = Vec<(f64, f64, f64)>;

/// Loops on the left, motions on the right, one row a frequency and one for the detail.
pub(crate) fn figure(hysteresis: &Scene) -> Result<Figure> {
    let mut panels = Vec::new();
    for (hertz, [left, right]) in FREQUENCIES.into_iter().zip([["(a)", "(b)"], ["(c)", "(d)"]]) {
        let (one, many) = (period(hysteresis, hertz, 1)?, period(hysteresis, hertz, 31)?);
        let headings = [
            format!("{left} {hertz} Hz, friction loop (new)"),
            format!("{right} {hertz} Hz, motion of m1 (new)"),
        ];
        panels.extend(row(headings, &[("N = 1 (paper)", &one), ("N = 31", &many)], (0.0, 1.0))?);
        if Some(&hertz) == FREQUENCIES.last() {
            let inside = |(t, _, _): &&(f64, f64, f64)| (DETAIL.0..=DETAIL.1).contains(t);
            let detail: Period = many.iter().filter(inside).copied().collect();
            let headings = [
                "(e) detail of (c): reversals inside the period".to_owned(),
                "(f) the same stretch of (d)".to_owned(),
            ];
            panels.extend(row(headings, &[("N = 31", &detail)], DETAIL)?);
        }
    }
    Ok(Figure {
        name: "waveforms",
        about: "One period of the contact of scenes/hoffmann-2017.json (reconstructed parameters, synthetic loop) for \
                N = 1 and N = 31: friction force in N over w1 in m, and w1 over the period.",
        columns: 2,
        panels,
    })
}

/// Loop and motion of the same periods.
fn row(
    headings: [String; 2],
    periods: &[(&'static str, &Period)],
    (from, to): (f64, f64),
) -> Result<[Panel; 2]> {
    let pen = |name: &str| if name == "N = 31" { pens::HARMONICS[3] } else { pens::HARMONICS[0] };
    let trace =
        |(name, period): &(&'static str, &Period), shown: bool, x: fn(&(f64, f64, f64)) -> (f64, f64)| {
            let points: Vec<_> = period.iter().map(x).collect();
            Trace::line(*name, if shown { name } else { "" }, pen(name), &points)
        };
    let loops: Vec<Trace> = periods.iter().map(|p| trace(p, true, |&(_, w, f)| (w, f))).collect();
    let motions = periods.iter().map(|p| trace(p, false, |&(t, w, _)| (t, w))).collect();
    let all = |pick: fn(&(f64, f64, f64)) -> f64| {
        periods.iter().flat_map(move |(_, period)| period.iter().map(pick))
    };
    let w = Axis::measured("w1", "m", all(|p| p.1)).context("no motion")?;
    let f = Axis::measured("friction force", "N", all(|p| p.2)).context("no force")?;
    let t = Axis::tight("Ωt / 2π".into(), [from, to].into_iter()).context("no time")?;
    let [left, right] = headings;
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
    Ok([panel(left, w.clone(), f, loops, true), panel(right, t, w, motions, false)])
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
    let every = (period.len() / 512).max(1);
    let last = period.len() - 1;
    Ok(period.into_iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last).map(|(_, p)| p).collect())
}
