//! Gauss collocation for y'' = a: the tableau of a step of order 2 · [`STAGES`], with nodes on [0, 1].
//!
//! The acceleration is a polynomial through its values at the Gauss nodes. All integrals of it are taken through its
//! Legendre coefficients, which keeps them accurate to rounding.

use crate::quadrature::gauss_legendre;

/// Nodes of a step.
pub(crate) const STAGES: usize = 12;

/// One row of numbers a stage.
pub(crate) type Row = [f64; STAGES];

/// What a step needs of its nodes.
#[derive(Debug, Clone)]
pub(crate) struct Tableau {
    pub(crate) nodes: Row,
    pub(crate) weights: Row,
    /// `∫_0^{c_i} ℓ_j`: velocity at node i from accelerations.
    pub(crate) once: [Row; STAGES],
    /// `∫_0^{c_i} (c_i − s) ℓ_j(s) ds`: displacement.
    pub(crate) twice: [Row; STAGES],
    /// Legendre coefficient q from accelerations.
    pub(crate) legendre: [Row; STAGES],
    /// P_q(2s − 1) in powers of s.
    pub(crate) powers: [Row; STAGES],
}

impl Tableau {
    pub(crate) fn new() -> Self {
        let (mut nodes, mut weights) = ([0.0; STAGES], [0.0; STAGES]);
        for ((node, weight), (c, w)) in nodes.iter_mut().zip(&mut weights).zip(gauss_legendre(STAGES)) {
            (*node, *weight) = (c, w);
        }
        let mut legendre = [[0.0; STAGES]; STAGES];
        for (j, (c, w)) in nodes.iter().zip(&weights).enumerate() {
            let p = values(*c);
            for (q, (row, p)) in legendre.iter_mut().zip(p).enumerate() {
                if let Some(slot) = row.get_mut(j) {
                    *slot = (2 * q + 1) as f64 * w * p;
                }
            }
        }
        let (mut once, mut twice) = ([[0.0; STAGES]; STAGES], [[0.0; STAGES]; STAGES]);
        for ((c, once), twice) in nodes.iter().zip(&mut once).zip(&mut twice) {
            let (first, second) = integrals(*c);
            for ((row, first), second) in legendre.iter().zip(first).zip(second) {
                for ((once, twice), coefficient) in once.iter_mut().zip(twice.iter_mut()).zip(row) {
                    *once += coefficient * first;
                    *twice += coefficient * second;
                }
            }
        }
        Self { nodes, weights, once, twice, legendre, powers: powers() }
    }
}

/// P_0 … P_{STAGES+1} at 2s − 1.
fn values(s: f64) -> [f64; STAGES + 2] {
    let x = 2.0 * s - 1.0;
    let mut p = [1.0; STAGES + 2];
    let (mut before, mut last) = (1.0, x);
    for (q, slot) in p.iter_mut().enumerate().skip(1) {
        *slot = last;
        let q = q as f64;
        (before, last) = (last, ((2.0 * q + 1.0) * x * last - q * before) / (q + 1.0));
    }
    p
}

/// `∫_0^s P_q` and its integral, q < STAGES: `∫ P_q = (P_{q+1} − P_{q−1}) / (2 (2q+1))`.
fn integrals(s: f64) -> (Row, Row) {
    let p = values(s);
    let mut first = [s; STAGES + 1];
    for (slot, (q, around)) in first.iter_mut().skip(1).zip(p.windows(3).enumerate()) {
        if let [below, _, above] = around {
            *slot = (above - below) / (2.0 * (2 * q + 3) as f64);
        }
    }
    let (mut once, mut twice) = ([0.0; STAGES], [0.5 * s * s; STAGES]);
    for (slot, first) in once.iter_mut().zip(&first) {
        *slot = *first;
    }
    for (slot, (q, around)) in twice.iter_mut().skip(1).zip(first.windows(3).enumerate()) {
        if let [below, _, above] = around {
            *slot = (above - below) / (2.0 * (2 * q + 3) as f64);
        }
    }
    (once, twice)
}

/// P_q(2s − 1) in powers of s, by the recurrence.
fn powers() -> [Row; STAGES] {
    let mut out = [[0.0; STAGES]; STAGES];
    let (mut before, mut last) = ([0.0; STAGES], [0.0; STAGES]);
    if let Some(one) = last.first_mut() {
        *one = 1.0;
    }
    for (q, slot) in out.iter_mut().enumerate() {
        *slot = last;
        let q = q as f64;
        // (q+1) P_{q+1} = (2q+1)(2s − 1) P_q − q P_{q−1}
        let mut next = [0.0; STAGES];
        let shifted = std::iter::once(0.0).chain(last.iter().copied());
        for (((next, last), shifted), before) in next.iter_mut().zip(&last).zip(shifted).zip(&before) {
            *next = ((2.0 * q + 1.0) * (2.0 * shifted - last) - q * before) / (q + 1.0);
        }
        (before, last) = (last, next);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y'' = s^p has y' = s^{p+1}/(p+1) and y = s^{p+2}/((p+1)(p+2)) at every node.
    #[test]
    fn powers_are_integrated_exactly() {
        let tableau = Tableau::new();
        for p in 0..STAGES {
            let a = tableau.nodes.map(|c| c.powi(p as i32));
            let sum = |row: &Row| -> f64 { row.iter().zip(&a).map(|(x, a)| x * a).sum() };
            for (i, c) in tableau.nodes.iter().enumerate() {
                let q = p as f64;
                assert!((sum(&tableau.once[i]) - c.powf(q + 1.0) / (q + 1.0)).abs() < 1e-15);
                let displacement = c.powf(q + 2.0) / ((q + 1.0) * (q + 2.0));
                assert!((sum(&tableau.twice[i]) - displacement).abs() < 1e-15);
            }
            // Back from Legendre coefficients to powers.
            let s: f64 = 0.3;
            let value: f64 = (0..STAGES)
                .map(|q| {
                    let powers: f64 =
                        tableau.powers[q].iter().enumerate().map(|(j, c)| c * s.powi(j as i32)).sum();
                    sum(&tableau.legendre[q]) * powers
                })
                .sum();
            assert!((value - s.powi(p as i32)).abs() < 1e-12);
        }
    }
}
