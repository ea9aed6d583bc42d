//! Fig. 3: loops from 0.8 to 8 µm with the scaling of their turning points, and loops predicted from the largest.
//!
//! The paper's records are not published. A synthetic rig writes files like theirs, and everything else is the
//! pipeline of any measurement: record → steady cycles → series over loop phase → law.

use std::f64::consts::{PI, TAU};

use anyhow::{Context, Result};
use contact::{Law, MagnitudeLaw, Motion, PhaseLaw, ScaledLoop, Symmetry, Workspace};
use hysteresis::synthetic::DirtyRecord;
use hysteresis::{Fit, FitSettings, ReadOptions, Record, fit};
use num_complex::Complex64;
use plot::Axis;

use super::figure::{Figure, Panel, Trace};
use super::pens;
use crate::markdown::table;
use crate::synthetic_loop::{DISPLACEMENT, Series};

/// Amplitudes in µm: the paper names the first and the last.
const AMPLITUDES: [f64; 5] = [0.8, 2.0, 4.0, 6.0, 8.0];
/// Amplitudes that Fig. 3(b) predicts, in µm.
const PREDICTED: [f64; 2] = [0.8, 4.0];

/// The family of records, read and fitted.
pub(crate) struct Loops {
    records: Vec<(Record, Fit)>,
    law: ScaledLoop,
}

impl Loops {
    pub(crate) fn measure() -> Result<Self> {
        let mut records = Vec::new();
        for (seed, micrometres) in (1..).zip(AMPLITUDES) {
            let alpha = 1e-6 * micrometres / DISPLACEMENT;
            let rig = DirtyRecord {
                frequency: 20.0,
                samples_per_cycle: 201.3,
                steady: 4,
                force_noise: 0.01,
                displacement_noise: 0.002,
                displacement_offset: 0.15,
                displacement_drift: 0.002,
                force_offset: -0.08,
                force_drift: 0.004,
                jitter: 0.05,
                seed,
                ..DirtyRecord::new(Series::at(alpha).to_loop(alpha)?)
            };
            let text = rig.generate().to_csv("um".parse()?, "N".parse()?, "s".parse()?);
            let record = Record::parse(&text, &ReadOptions::default())?;
            let fitted = fit(&record, &FitSettings::default())?;
            records.push((record, fitted));
        }
        let (_, reference) = records.last().context("no record")?;
        let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
        let law =
            ScaledLoop::new(&reference.hysteresis_loop, reference.noise, magnitude, phase, Symmetry::Auto)?;
        Ok(Self { records, law })
    }

    fn reference(&self) -> Result<&Fit> {
        self.records.last().map(|(_, fit)| fit).context("no record")
    }

    /// F* of the turning points: the reference loop's tip lies on eq. (6).
    fn tip_scale(&self) -> Result<f64> {
        Ok(self.reference()?.hysteresis_loop.force(0.0) / MagnitudeLaw::default().value(1.0))
    }

    /// Fig. 3(a).
    pub(crate) fn measured(&self) -> Result<Figure> {
        let mut traces = Vec::new();
        for ((record, fit), micrometres) in self.records.iter().zip(AMPLITUDES) {
            let first = if traces.is_empty() { "synthetic record" } else { "" };
            traces.push(Trace::line(
                format!("record {micrometres} um"),
                first,
                pens::RECORD,
                &steady(record, fit),
            ));
        }
        for ((_, fit), micrometres) in self.records.iter().zip(AMPLITUDES) {
            let first = if micrometres == AMPLITUDES[0] { "fitted Fourier series" } else { "" };
            let label = format!("series {micrometres} um");
            traces.push(Trace::line(
                label,
                first,
                pens::MAIN,
                &series(fit, fit.hysteresis_loop.coefficients()),
            ));
        }
        let scale = self.tip_scale()?;
        let curve = |sign: f64| {
            let place = move |i: i32| sign * 1.06 * f64::from(i) / 100.0;
            (0..=100).map(place).map(move |alpha| {
                (alpha * DISPLACEMENT, Some(sign * scale * MagnitudeLaw::default().value(alpha.abs())))
            })
        };
        let both = curve(-1.0).chain([(0.0, None)]).chain(curve(1.0)).collect();
        traces.push(Trace::new("eq. (6)", "eq. (6)", pens::SCALING, both));
        let tips: Vec<(f64, f64)> = (self.records.iter().map(|(_, fit)| &fit.hysteresis_loop))
            .flat_map(|l| {
                [(l.displacement_amplitude(), l.force(0.0)), (-l.displacement_amplitude(), l.force(PI))]
            })
            .collect();
        traces.push(Trace::dots("turning points", "", pens::DOT, &tips));
        Ok(Figure {
            name: "fig-3a-loops",
            about: "Synthetic rig records of 0.8 um to 8 um (not the paper's measurements), the series fitted to them, \
                    their turning points, and eq. (6) of Hoffmann et al. (2017) scaled to the 8 um loop. SI units.",
            columns: 1,
            panels: vec![panel("(a) synthetic records, 0.8 µm to 8 µm", traces)?],
        })
    }

    /// Fig. 3(b).
    pub(crate) fn predicted(&self) -> Result<Figure> {
        let mut traces = Vec::new();
        for ((_, fit), micrometres) in self.records.iter().zip(AMPLITUDES) {
            if PREDICTED.contains(&micrometres) {
                let name = if traces.is_empty() { "synthetic record" } else { "" };
                let cycle = series(fit, fit.hysteresis_loop.coefficients());
                traces.push(Trace::line(format!("record {micrometres} um"), name, pens::BEHIND, &cycle));
            }
        }
        for micrometres in PREDICTED {
            let a = 1e-6 * micrometres;
            let first =
                self.law.describing_function().map(|law| law.first_harmonic(a).force).unwrap_or_default();
            let ellipse = |theta: f64| (a * theta.cos(), (first * Complex64::cis(theta)).re);
            let ellipse: Vec<_> = turn(180).map(ellipse).collect();
            let name =
                if micrometres == PREDICTED[0] { ("monoharmonic", "predicted from 8 µm") } else { ("", "") };
            traces.push(Trace::line(
                format!("monoharmonic {micrometres} um"),
                name.0,
                pens::ONE_HARMONIC,
                &ellipse,
            ));
            let loop_ = self.predict(a)?;
            traces.push(Trace::line(format!("predicted {micrometres} um"), name.1, pens::PREDICTED, &loop_));
        }
        Ok(Figure {
            name: "fig-3b-predicted",
            about: "Loops of 0.8 um and 4 um predicted by eqs (5)-(9) of Hoffmann et al. (2017) from the synthetic 8 um \
                    record, their first harmonics, and the synthetic records of these amplitudes. SI units.",
            columns: 1,
            panels: vec![panel("(b) from the synthetic 8 µm record", traces)?],
        })
    }

    /// The loop that the law gives harmonic motion of amplitude `a` in m.
    fn predict(&self, a: f64) -> Result<Vec<(f64, f64)>> {
        const SAMPLES: usize = 512;
        let phases: Vec<f64> = (0..SAMPLES).map(|j| TAU * j as f64 / SAMPLES as f64).collect();
        let displacement: Vec<f64> = phases.iter().map(|t| a * t.cos()).collect();
        let velocity: Vec<f64> = phases.iter().map(|t| -a * t.sin()).collect();
        let spectrum = [Complex64::ZERO, Complex64::new(a, 0.0)];
        let motion = Motion {
            spectrum: &spectrum,
            displacement: &displacement,
            velocity: &velocity,
            odd: true,
            omega: 0.0,
        };
        let mut force = vec![0.0; SAMPLES];
        self.law.force(&motion, &mut Workspace::new(SAMPLES), &mut force)?;
        let mut points: Vec<_> = displacement.into_iter().zip(force).collect();
        points.extend(points.first().copied());
        Ok(points)
    }

    /// What each record gave, against the laws.
    pub(crate) fn table(&self) -> Result<String> {
        let scale = self.tip_scale()?;
        let row = |(_, fit): &(Record, Fit)| {
            let measured = &fit.hysteresis_loop;
            let alpha = measured.displacement_amplitude() / DISPLACEMENT;
            let (g, psi) = (MagnitudeLaw::default().value(alpha), PI + PhaseLaw::default().value(alpha));
            [
                format!("{:.3} µm", 1e6 * measured.displacement_amplitude()),
                format!("{:.3} N", measured.force(0.0)),
                format!("{:.3} N", scale * g),
                format!("{:.4} π", measured.phase() / PI),
                format!("{:.4} π", psi / PI),
                format!("{:.2} N", measured.force_amplitude()),
                format!("{:.2} N", self.law.reference_force() * g),
                format!("{:.1} %", 100.0 * fit.noise),
            ]
        };
        let head = [
            "amplitude found",
            "force at the turning point",
            "eq. (6)",
            "phase of F₁",
            "eq. (7)",
            "magnitude of F₁",
            "F* g(α)",
            "scatter",
        ];
        Ok(table(head, &self.records.iter().map(row).collect::<Vec<_>>()))
    }
}

fn panel(heading: &str, traces: Vec<Trace>) -> Result<Panel> {
    let points = || traces.iter().flat_map(|trace| &trace.curve.points);
    let x = Axis::measured("relative displacement", "m", points().map(|p| p.0));
    let y = Axis::measured("friction force", "N", points().filter_map(|p| p.1));
    Ok(Panel {
        heading: heading.to_owned(),
        x: x.context("no loop")?,
        y: y.context("no loop")?,
        traces,
        rug: ("", Vec::new()),
        label_x: true,
        legend: true,
        height: 230.0,
    })
}

/// The record's steady part without its offsets.
fn steady(record: &Record, fit: &Fit) -> Vec<(f64, f64)> {
    let points = record.displacement.iter().zip(&record.force);
    let (from, to) = (fit.steady_samples.start, fit.steady_samples.end);
    let points = points.skip(from).take(to - from);
    points.map(|(w, f)| (w - fit.displacement_mean, f - fit.force_mean)).collect()
}

/// The fitted series once around.
fn series(fit: &Fit, coefficients: &[Complex64]) -> Vec<(f64, f64)> {
    let force = |theta: f64| -> f64 {
        (0_u32..).zip(coefficients).map(|(k, c)| (c * Complex64::cis(f64::from(k) * theta)).re).sum()
    };
    turn(360)
        .map(|theta| (fit.hysteresis_loop.displacement_amplitude() * theta.cos(), force(theta)))
        .collect()
}

/// Once around, both ends included.
fn turn(steps: u32) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |i| TAU * f64::from(i) / f64::from(steps))
}
