//! Fourier coefficients of an orbit, keeping relative accuracy in the tail.
//!
//! Two ways lead to each coefficient, and the one with the smaller bound on its rounding error is taken.
//!
//! *Forces.* Directly, `F_k = (1/ikπ) ∮ f' e^{−ikτ} dτ` by Gauss–Legendre quadrature between events. In closed form:
//! while a set of sliders sticks, `f' = k_c β·v` and the velocity v obeys `M v'' + D v' + K v = load'`, so with the
//! transform over the stretches [a, b] of that set (partial integration)
//!
//! ```text
//! H_k v̂ = Σ_[a,b] { ∫ load' e^{−ikτ} dτ − [e^{−ikτ} (M v' + (ik M + D) v)]_a^b }
//! ```
//!
//! *Displacements.* Directly, or from the balance `W_k = H_k⁻¹ (L_k − Σ_c β_c F_{c,k})`, whose error falls with k as
//! `W_k` does.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use num_complex::Complex64;

use crate::dynamic_stiffness::{matrix, row_of_inverse};
use crate::links::{Elastic, Press};
use crate::path::{Along, Path, Piece, force, force_rate};
use crate::polynomial::value;
use crate::quadrature::gauss_legendre;
use crate::scaled::Scaled;

/// Nodes of a panel.
pub(crate) const NODES: usize = 20;
/// Largest phase kτ that a panel spans, in radians.
const PANEL: f64 = 4.0;

/// A coefficient and a bound on its error, both dimensionless.
pub(crate) type Coefficient = (Complex64, f64);

/// A stretch of the orbit with the same sliders sticking, from its begin to its end.
struct Stretch {
    ends: [(f64, Vec<f64>, Vec<f64>); 2],
}

/// All stretches with the same stiffness of every link.
struct Mode {
    stiffness: Vec<Elastic>,
    stretches: Vec<Stretch>,
}

/// Coefficients 0..=highest of φ of link `c` (rig convention), one-sided.
pub(crate) fn force_coefficients(system: &Scaled, path: &Path, c: usize, highest: usize) -> Vec<Coefficient> {
    let Some(link) = system.links.get(c) else { return Vec::new() };
    if link.smooth.is_some() {
        return direct(path, highest, |piece| force(system, piece, c));
    }
    let rate = |piece: &Piece| force_rate(system, piece, c);
    // Where a force turns there is no closed form.
    let mut out = if system.presses.iter().any(Press::is_planar) {
        vec![(Complex64::ZERO, f64::INFINITY); highest + 1]
    } else {
        closed(system, &modes(system, path), c, highest)
    };
    let peak = peak(path, &rate);
    // Beyond this order quadrature is never better.
    let last = out.iter().enumerate().rposition(|(k, entry)| entry.1 > bound(peak) / (k.max(1)) as f64);
    let by_quadrature = direct(path, last.unwrap_or(0), rate);
    for (k, (entry, (value, error))) in out.iter_mut().zip(by_quadrature).enumerate().skip(1) {
        let error = error / k as f64;
        if error < entry.1 {
            *entry = (value / Complex64::new(0.0, k as f64), error);
        }
    }
    if let (Some(mean), Some(found)) =
        (out.first_mut(), direct(path, 0, |piece| force(system, piece, c)).first())
    {
        *mean = *found;
    }
    out
}

/// Coefficients 0..=highest of y of `dof`, one-sided.
pub(crate) fn displacement_coefficients(
    system: &Scaled,
    path: &Path,
    dof: usize,
    highest: usize,
) -> Vec<Coefficient> {
    let n = system.dofs;
    let forces: Vec<_> =
        (0..system.links.len()).map(|c| force_coefficients(system, path, c, highest)).collect();
    let position = |piece: &Piece| -> Along {
        let y = piece.polynomial(dof, n);
        Box::new(move |s| value(&y, s))
    };
    let floor = bound(peak(path, &position));
    let free = vec![Elastic::default(); system.links.len()];
    let balance = |k: usize| -> Coefficient {
        let unit = |i: usize| Complex64::from(if i == dof { 1.0 } else { 0.0 });
        let z = row_of_inverse(&matrix(system, k, &free), (0..n).map(unit).collect());
        let (mut sum, mut error) = (Complex64::ZERO, 0.0);
        let loads = system.loads.iter().filter(|load| load.harmonic == k);
        for (z, force) in loads.flat_map(|load| z.iter().zip(&load.force)) {
            sum += z * force;
            error += f64::EPSILON * (z * force).norm();
        }
        for (link, force) in system.links.iter().zip(&forces) {
            let Some((force, own)) = force.get(k) else { continue };
            for &(i, beta) in &link.ends {
                let receptance = z.get(i).map_or(Complex64::ZERO, |z| z * beta);
                sum -= receptance * force;
                error += receptance.norm() * (own + f64::EPSILON * force.norm());
            }
        }
        if sum.is_finite() { (sum, error) } else { (sum, f64::INFINITY) }
    };
    let mut out: Vec<Coefficient> =
        (0..=highest).map(|k| if k == 0 { (Complex64::ZERO, f64::INFINITY) } else { balance(k) }).collect();
    let last = out.iter().rposition(|entry| entry.1 > floor).unwrap_or(0);
    for (entry, found) in out.iter_mut().zip(direct(path, last, position)) {
        if found.1 < entry.1 {
            *entry = found;
        }
    }
    out
}

/// Error of a quadrature of values up to `peak`.
fn bound(peak: f64) -> f64 {
    2.0 * f64::EPSILON * peak
}

fn peak<'a>(path: &Path, x: &impl Fn(&Piece) -> Along<'a>) -> f64 {
    let in_piece = |piece: &Piece| {
        let x = x(piece);
        [0.0, 0.5, 1.0].map(|s| x(s).abs()).into_iter().fold(0.0, f64::max)
    };
    path.pieces.iter().map(in_piece).fold(0.0, f64::max)
}

/// `(1/π) ∮ x e^{−ikτ} dτ` (half of it for k = 0), k = 0..=highest, by quadrature.
fn direct<'a>(path: &Path, highest: usize, x: impl Fn(&Piece) -> Along<'a>) -> Vec<Coefficient> {
    let rule = gauss_legendre(NODES);
    let mut nodes = Vec::new();
    let mut peak = 0.0_f64;
    for piece in &path.pieces {
        let x = x(piece);
        let panels = (highest as f64 * piece.length / PANEL).ceil().max(1.0);
        for panel in 0..panels as usize {
            for (node, weight) in &rule {
                let s = (panel as f64 + node) / panels;
                let sample = x(s);
                peak = peak.max(sample.abs());
                let amount = sample * weight * piece.length / panels * FRAC_1_PI;
                nodes.push((piece.start + s * piece.length, Complex64::from(amount)));
            }
        }
    }
    // e^{−iτ} turns each node on from order to order.
    let turns: Vec<Complex64> = nodes.iter().map(|(tau, _)| Complex64::cis(-tau)).collect();
    let coefficient = |k: usize| {
        let sum: Complex64 = nodes.iter().map(|(_, amount)| amount).sum();
        nodes.iter_mut().zip(&turns).for_each(|((_, amount), turn)| *amount *= turn);
        (if k == 0 { Complex64::from(0.5 * sum.re) } else { sum }, bound(peak))
    };
    (0..=highest).map(coefficient).collect()
}

/// The closed form.
fn closed(system: &Scaled, modes: &[Mode], c: usize, highest: usize) -> Vec<Coefficient> {
    let coefficient = |k: usize| -> Coefficient {
        if k == 0 {
            return (Complex64::ZERO, 0.0);
        }
        let (mut sum, mut error) = (Complex64::ZERO, 0.0);
        for mode in modes {
            // φ' = weights · v.
            let mut weights = vec![Complex64::ZERO; system.dofs];
            for (other, stiffness) in mode.stiffness.get(c).iter().flat_map(|elastic| elastic.parts(c)) {
                for &(i, factor) in system.links.get(other).iter().flat_map(|link| &link.ends) {
                    if let Some(entry) = weights.get_mut(i) {
                        *entry += stiffness * factor;
                    }
                }
            }
            if weights.iter().all(|weight| weight.norm() == 0.0) {
                continue;
            }
            let z = row_of_inverse(&matrix(system, k, &mode.stiffness), weights);
            for (z, (part, size)) in z.iter().zip(right_hand_side(system, mode, k)) {
                sum += z * part;
                error += f64::EPSILON * z.norm() * size;
            }
        }
        let sum = sum / Complex64::new(0.0, PI * k as f64);
        if sum.is_finite() { (sum, error / (PI * k as f64)) } else { (sum, f64::INFINITY) }
    };
    (0..=highest).map(coefficient).collect()
}

/// The right-hand side of `H_k v̂`, with the sum of the magnitudes of its terms.
fn right_hand_side(system: &Scaled, mode: &Mode, k: usize) -> Vec<(Complex64, f64)> {
    let n = system.dofs;
    let order = k as f64;
    let mut out = vec![(Complex64::ZERO, 0.0); n];
    let mut add = |i: usize, x: Complex64| {
        if let Some((sum, size)) = out.get_mut(i) {
            *sum += x;
            *size += x.norm();
        }
    };
    for Stretch { ends: [begin, end] } in &mode.stretches {
        for load in system.loads.iter().filter(|load| load.harmonic > 0) {
            let h = load.harmonic as f64;
            let (with, against) = (wave(h - order, begin.0, end.0), wave(-h - order, begin.0, end.0));
            for (i, force) in load.force.iter().enumerate() {
                add(i, Complex64::new(0.0, 0.5 * h) * (force * with - force.conj() * against));
            }
        }
        for ((tau, v, a), sign) in [(begin, 1.0), (end, -1.0)] {
            let turn = Complex64::cis(-order * tau) * sign;
            for i in 0..n {
                let row = |matrix: &[f64], x: &[f64]| -> f64 {
                    matrix.iter().skip(i * n).zip(x).map(|(m, x)| m * x).sum()
                };
                let inertia = Complex64::new(row(&system.mass, a), order * row(&system.mass, v));
                add(i, turn * (inertia + row(&system.damping, v)));
            }
        }
    }
    out
}

/// `∫_a^b e^{imτ} dτ`.
fn wave(m: f64, a: f64, b: f64) -> Complex64 {
    let half = 0.5 * (b - a);
    let length = if m == 0.0 { 2.0 * half } else { 2.0 * (m * half).sin() / m };
    Complex64::cis(m * 0.5 * (a + b)) * length
}

/// The orbit's stretches by the stiffness of their links.
fn modes(system: &Scaled, path: &Path) -> Vec<Mode> {
    let at = |piece: &Piece, s: f64| {
        let (mut v, mut a) = (vec![0.0; system.dofs], vec![0.0; system.dofs]);
        piece.state(s, 1, &mut v);
        piece.state(s, 2, &mut a);
        (if s == 0.0 { piece.start } else { piece.end() }, v, a)
    };
    let stiffness = |piece: &Piece| -> Vec<Elastic> {
        piece.elastic.iter().map(|elastic| Elastic { constant: 0.0, ..*elastic }).collect()
    };
    let mut modes: Vec<Mode> = Vec::new();
    for run in path.pieces.chunk_by(|a, b| stiffness(a) == stiffness(b)) {
        let (Some(first), Some(last)) = (run.first(), run.last()) else { continue };
        let mut end = at(last, 1.0);
        if (end.0 - TAU).abs() < 1e-14 {
            end.0 = TAU;
        }
        let stretch = Stretch { ends: [at(first, 0.0), end] };
        let own = stiffness(first);
        match modes.iter_mut().find(|mode| mode.stiffness == own) {
            Some(mode) => mode.stretches.push(stretch),
            None => modes.push(Mode { stiffness: own, stretches: vec![stretch] }),
        }
    }
    modes
}
