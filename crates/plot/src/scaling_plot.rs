//! The scaling laws: force and phase of measured loops over their amplitude.

use std::f64::consts::PI;
use std::path::Path;

use anyhow::{Result, ensure};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
use super::{image, pen, sheet::sheet};

/// A law over α.
type Law<'a> = dyn Fn(f64) -> f64 + 'a;

/// Measured loops and the laws identified from them.
pub struct ScalingPlot<'a> {
    /// What the magnitudes are.
    pub force: &'static str,
    /// α and force of each loop over that of the reference.
    pub magnitudes: Vec<(f64, f64)>,
    /// α and phase of each loop in rad.
    pub phases: Vec<(f64, f64)>,
    /// g(α), eq. (6).
    pub magnitude: Box<Law<'a>>,
    /// ψ_C(α) in rad, eq. (7).
    pub phase: Box<Law<'a>>,
}

/// Draws `plot` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_scaling(plot: &ScalingPlot, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(plot)?, path)
}

/// Column width of a journal and height of a frame in px (1/96 in).
const WIDTH: f64 = 340.0;
const FRAME: f64 = 150.0;

/// Amplitudes that span more than this are drawn on a logarithmic axis.
const WIDE: f64 = 20.0;

/// Points of a law's curve.
const POINTS: u32 = 300;

fn draw(plot: &ScalingPlot) -> Result<String> {
    let alphas = || plot.magnitudes.iter().map(|(alpha, _)| *alpha).filter(|alpha| *alpha > 0.0);
    let (low, high) =
        alphas().fold((f64::INFINITY, 0.0), |(a, b), alpha| (f64::min(a, alpha), f64::max(b, alpha)));
    ensure!(low <= high && high.is_finite(), "nothing to plot: no loop has an amplitude");
    let wide = high > WIDE * low;
    let (from, to) = if wide { (0.7 * low, 1.4 * high) } else { (0.0, 1.06 * high) };
    let label = "amplitude ratio \u{3b1}".to_owned();
    let ends = [from, to].into_iter();
    let x = if wide { Axis::decades(label, ends) } else { Axis::tight(label, ends) };
    let Some(x) = x else { anyhow::bail!("nothing to plot: no amplitude is a number") };

    let abscissa = |j: u32| {
        let part = f64::from(j) / f64::from(POINTS);
        if wide { from * (to / from).powf(part) } else { from + part * (to - from) }
    };
    // Passive laws have g ≥ 0 and −π ≤ ψ ≤ 0: whole ranges, so that figures of different contacts compare.
    let strongest = plot.magnitudes.iter().map(|(_, force)| *force).fold(1.0, f64::max);
    let latest = plot.phases.iter().map(|(_, phase)| *phase / PI).fold(-0.5, f64::max);
    let forces = (0.0, 1.1 * strongest);
    let phases = (-1.0, (latest + 0.05).min(0.0));
    let chart = |label: String, (bottom, top): (f64, f64), points: &[(f64, f64)], law: &Law, lowest: bool| {
        let unit = if lowest { PI } else { 1.0 };
        let points = points.iter().map(|(alpha, value)| (*alpha, Some(value / unit))).collect();
        let inside = |value: &f64| (bottom..=top).contains(value);
        let value = |alpha| Some(law(alpha) / unit).filter(inside);
        let curve = (0..=POINTS).map(abscissa).map(|alpha| (alpha, value(alpha))).collect();
        let y = Axis::tight(label, [bottom, top].into_iter())?;
        Some(Chart {
            heading: String::new(),
            x: x.clone(),
            y,
            curves: vec![
                Curve { name: "identified law", points: curve, pen: pen::FIT },
                Curve { name: "measured loops", points, pen: pen::POINT },
            ],
            rug: Vec::new(),
            rug_name: "",
            label_x: lowest,
            label_y: true,
            legend: false,
            width: WIDTH,
            height: TOP + FRAME + if lowest { BOTTOM } else { BOTTOM_BARE },
        })
    };
    let magnitude = chart(plot.force.to_owned(), forces, &plot.magnitudes, &plot.magnitude, false);
    let phase = chart("phase \u{3c8} / \u{3c0}".to_owned(), phases, &plot.phases, &plot.phase, true);
    let (Some(magnitude), Some(phase)) = (magnitude, phase) else {
        anyhow::bail!("nothing to plot: no loop has a force");
    };
    Ok(sheet("", 1, vec![magnitude, phase]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(alphas: &[f64]) -> ScalingPlot<'static> {
        let g = |alpha: f64| 0.98 + 0.21 * (alpha + 0.01).ln();
        let psi = |alpha: f64| -0.5 * PI - 7.0 / 15.0 * PI * (-4.0 * alpha).exp();
        let noise = |alpha: f64| 0.02 * (alpha * 1234.0).sin();
        ScalingPlot {
            force: "turning-point force / F*",
            magnitudes: alphas.iter().map(|a| (*a, g(*a) + noise(*a))).collect(),
            phases: alphas.iter().map(|a| (*a, psi(*a) + noise(*a))).collect(),
            magnitude: Box::new(g),
            phase: Box::new(psi),
        }
    }

    const LOOPS: [f64; 7] = [0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0];

    #[test]
    fn loops_are_dots_and_laws_are_lines() {
        let svg = draw(&example(&LOOPS)).unwrap();
        // Seven loops twice, and once in the legend.
        assert_eq!(svg.matches("<circle").count(), 15);
        assert!(svg.contains(">measured loops</text>") && svg.contains(">identified law</text>"));
        assert!(svg.contains("amplitude ratio"));
    }

    #[test]
    fn loops_over_decades_have_a_logarithmic_axis() {
        assert!(draw(&example(&[0.01, 0.1, 1.0])).unwrap().contains("10⁻²"));
        assert!(!draw(&example(&LOOPS)).unwrap().contains("10⁻"));
    }

    #[test]
    fn no_loop_is_an_error() {
        assert!(draw(&example(&[])).unwrap_err().to_string().contains("nothing to plot"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip figures`.
    #[test]
    fn figures_of_scaling_laws_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        for name in ["scaling.svg", "scaling.png"] {
            write_scaling(&example(&LOOPS), &folder.join(name)).unwrap();
        }
        write_scaling(&example(&[0.01, 0.03, 0.1, 0.3, 1.0]), &folder.join("scaling-wide.png")).unwrap();
    }
}
