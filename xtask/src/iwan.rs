//! `cargo xtask iwan`: how near a stack of sliders comes to the paper's laws (6) and (7).
//!
//! The target is the describing function F_1(α)/F* = g(α) e^{i (π + ψ_C(α))} at 91 values α = 0.10, 0.11 … 1.00, the
//! range of the paper's loops (0.8 µm to 8 µm). It is fitted, with non-negative weights, by Jenkins elements of 161 yield
//! displacements between 1e-4 W* and W*, a rigid slider and a spring. The norm is the root mean square over α of
//! |ΔF_1|/F* (divided by that of the target) or of |ΔF_1|/|F_1|.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Result, ensure};
use contact::{
    DescribingFunction, ElasticCoulomb, ElasticCoulombParameters, Iwan, IwanParameters, Law, MagnitudeLaw,
    PhaseLaw,
};
use num_complex::Complex64;

use crate::non_negative;
use crate::page;

const COMMAND: &str = "iwan";

/// α, F_1/F* by the paper's laws, by the Masing loop of the backbone (6), and by the best stacks.
struct Row {
    alpha: f64,
    law: Complex64,
    masing: Complex64,
    /// Fitted to |ΔF_1|/F* and to |ΔF_1|/|F_1|.
    best: [Complex64; 2],
}

fn alphas() -> impl Iterator<Item = f64> {
    (10..=100).map(|i| f64::from(i) / 100.0)
}

fn target(alpha: f64) -> Complex64 {
    Complex64::from_polar(MagnitudeLaw::default().value(alpha), PI + PhaseLaw::default().value(alpha))
}

/// Describing functions of the elements at all α: sliders of unit slip force, a rigid one, a spring.
fn elements() -> Result<Vec<Vec<Complex64>>> {
    let mut all = vec![
        alphas().map(|_| Complex64::new(0.0, 4.0 / PI)).collect(),
        alphas().map(Complex64::from).collect::<Vec<_>>(),
    ];
    for i in 0..=160 {
        let stiffness = 10.0_f64.powf(4.0 - f64::from(i) / 40.0);
        let element = ElasticCoulomb::new(ElasticCoulombParameters { stiffness, slip_force: 1.0 })?;
        all.push(alphas().map(|alpha| element.first_harmonic(alpha).force).collect());
    }
    Ok(all)
}

/// Real and imaginary parts of `values`, each multiplied with its α's weight.
fn parts(values: &[Complex64], weights: &[f64]) -> Vec<f64> {
    values.iter().zip(weights).flat_map(|(f, w)| [f.re * w, f.im * w]).collect()
}

fn fit(weight: impl Fn(Complex64) -> f64) -> Result<Vec<Complex64>> {
    let targets: Vec<Complex64> = alphas().map(target).collect();
    let weights: Vec<f64> = targets.iter().map(|f| weight(*f)).collect();
    let elements = elements()?;
    let columns: Vec<Vec<f64>> = elements.iter().map(|e| parts(e, &weights)).collect();
    let x = non_negative::least_squares(&columns, &parts(&targets, &weights));
    let sum = |i: usize| x.iter().zip(&elements).filter_map(|(x, e)| e.get(i).map(|f| f * x)).sum();
    Ok((0..targets.len()).map(sum).collect())
}

fn rows() -> Result<Vec<Row>> {
    let magnitude = MagnitudeLaw::default();
    let parameters = IwanParameters { displacement: 1.0, force: 1.0, magnitude, range: 10.0 };
    let masing = Iwan::from_magnitude(parameters)?;
    let describing = |alpha| masing.describing_function().map(|law| law.first_harmonic(alpha).force);
    let absolute = fit(|_| 1.0)?;
    let relative = fit(|f| 1.0 / f.norm())?;
    let fits = absolute.into_iter().zip(relative);
    Ok(alphas()
        .zip(fits)
        .map(|(alpha, (one, other))| Row {
            alpha,
            law: target(alpha),
            masing: describing(alpha).unwrap_or_default(),
            best: [one, other],
        })
        .collect())
}

/// Root mean squares of |ΔF_1|/F* over that of |F_1|/F*, and of |ΔF_1|/|F_1|.
fn misfits(rows: &[Row], of: impl Fn(&Row) -> Complex64) -> [f64; 2] {
    let mean = |value: &dyn Fn(&Row) -> f64| rows.iter().map(value).sum::<f64>() / rows.len() as f64;
    let absolute = mean(&|row| (of(row) - row.law).norm_sqr());
    let size = mean(&|row| row.law.norm_sqr());
    let relative = mean(&|row| (of(row) - row.law).norm_sqr() / row.law.norm_sqr());
    [(absolute / size).sqrt(), relative.sqrt()]
}

fn csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "alpha,law_magnitude,law_phase_pi,masing_magnitude,masing_phase_pi,best_absolute_magnitude,best_absolute_phase_pi,best_relative_magnitude,best_relative_phase_pi\n",
    );
    for row in rows {
        let _ = write!(text, "{:.2}", row.alpha);
        for f in [row.law, row.masing, row.best[0], row.best[1]] {
            let _ = write!(text, ",{:.5},{:.5}", f.norm(), f.arg() / PI - 1.0);
        }
        text.push('\n');
    }
    text
}

/// The tables of the page.
fn tables(rows: &[Row]) -> String {
    let mut text = String::from(
        "| α | (6), (7) | Masing loop of (6) | best stack, \\|ΔF_1\\|/F* | best stack, \\|ΔF_1\\|/\\|F_1\\| |\n|---|---|---|---|---|\n",
    );
    for row in rows.iter().filter(|row| [0.1, 0.2, 0.3, 0.5, 0.7, 1.0].contains(&row.alpha)) {
        let _ = write!(text, "| {:.1} |", row.alpha);
        for f in [row.law, row.masing, row.best[0], row.best[1]] {
            let _ = write!(text, " {:.3}, {:.3} π |", f.norm(), f.arg() / PI - 1.0);
        }
        text.push('\n');
    }
    text.push_str("\n| misfit | Masing loop of (6) | best stack, \\|ΔF_1\\|/F* | best stack, \\|ΔF_1\\|/\\|F_1\\| |\n|---|---|---|---|\n");
    let all =
        [misfits(rows, |row| row.masing), misfits(rows, |row| row.best[0]), misfits(rows, |row| row.best[1])];
    for (i, name) in
        ["RMS of \\|ΔF_1\\|/F* over that of \\|F_1\\|/F*", "RMS of \\|ΔF_1\\|/\\|F_1\\|"].iter().enumerate()
    {
        let _ = write!(text, "| {name} |");
        for misfit in all {
            let _ = write!(text, " {:.1} % |", 100.0 * misfit.get(i).copied().unwrap_or(f64::NAN));
        }
        text.push('\n');
    }
    text
}

/// Writes `docs/figures/iwan.csv` and prints the tables of `docs/src/iwan.md`.
pub(crate) fn write(root: &Path) -> Result<()> {
    let rows = rows()?;
    page::write(root, COMMAND, &csv(&rows))?;
    print!("{}", tables(&rows));
    Ok(())
}

/// Fails unless the file and the page hold what [`write()`] writes and prints.
pub(crate) fn check(root: &Path) -> Result<()> {
    let rows = rows()?;
    ensure!(rows.len() == 91, "91 values of α expected");
    page::check(root, COMMAND, &csv(&rows), &tables(&rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_stack_is_17_to_19_percent_off_and_nothing_beats_it() {
        let rows = rows().unwrap();
        let absolute = misfits(&rows, |row| row.best[0])[0];
        let relative = misfits(&rows, |row| row.best[1])[1];
        assert!((0.165..0.195).contains(&absolute), "{absolute}");
        assert!((0.165..0.195).contains(&relative), "{relative}");
        let targets: Vec<Complex64> = alphas().map(target).collect();
        for weights in [
            targets.iter().map(|_| 1.0).collect::<Vec<_>>(),
            targets.iter().map(|f| 1.0 / f.norm()).collect(),
        ] {
            let columns: Vec<Vec<f64>> = elements().unwrap().iter().map(|e| parts(e, &weights)).collect();
            let target = parts(&targets, &weights);
            let x = non_negative::least_squares(&columns, &target);
            assert!(x.iter().all(|x| *x >= 0.0));
            assert!(non_negative::violation(&columns, &x, &target) < 1e-9);
        }
    }

    #[test]
    fn a_slider_keeps_much_of_its_spring_at_ten_times_its_yield_displacement() {
        let element =
            ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 10.0, slip_force: 1.0 }).unwrap();
        let first = element.first_harmonic(1.0).force;
        assert!((first - Complex64::new(0.52, 1.146)).norm() < 1e-3, "{first}");
        assert!((first.arg() / PI - 1.0 + 0.636).abs() < 5e-4);
    }

    #[test]
    fn the_page_and_the_figure_are_up_to_date() {
        check(&crate::root()).unwrap();
    }
}
