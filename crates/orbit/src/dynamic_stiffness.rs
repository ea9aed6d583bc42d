//! H_k = K̃ − k² M̃ + ik D̃ (+ contact stiffnesses), and rows of its inverse.

use num_complex::Complex64;

use crate::links::Elastic;
use crate::scaled::Scaled;

/// `H_k` with the given stiffness of every link, row by row.
pub(crate) fn matrix(system: &Scaled, k: usize, links: &[Elastic]) -> Vec<Complex64> {
    let (n, k) = (system.dofs, k as f64);
    let entries = system.stiffness.iter().zip(&system.mass).zip(&system.damping);
    let mut h: Vec<Complex64> = entries
        .map(|((stiffness, mass), damping)| Complex64::new(stiffness - k * k * mass, k * damping))
        .collect();
    for ((link, elastic), c) in system.links.iter().zip(links).zip(0..) {
        for (other, stiffness) in elastic.parts(c) {
            let Some(other) = system.links.get(other) else { continue };
            for &(i, beta) in &link.ends {
                for &(j, factor) in &other.ends {
                    if let Some(entry) = h.get_mut(i * n + j) {
                        *entry += stiffness * beta * factor;
                    }
                }
            }
        }
    }
    h
}

/// z with `zᵀ = weightsᵀ H⁻¹`; not finite when H is singular.
pub(crate) fn row_of_inverse(h: &[Complex64], weights: Vec<Complex64>) -> Vec<Complex64> {
    let n = weights.len();
    let mut rows: Vec<Vec<Complex64>> = weights
        .into_iter()
        .enumerate()
        .map(|(i, weight)| h.iter().skip(i).step_by(n).take(n).copied().chain([weight]).collect())
        .collect();
    let size = |row: &[Complex64], i: usize| row.get(i).map_or(0.0, |x| x.norm_sqr());
    for pivot in 0..n {
        let best = (pivot..n).max_by(|&a, &b| {
            let at = |i: usize| rows.get(i).map_or(0.0, |row| size(row, pivot));
            at(a).total_cmp(&at(b))
        });
        rows.swap(pivot, best.unwrap_or(pivot));
        let (upper, lower) = rows.split_at_mut(pivot + 1);
        let Some(first) = upper.last() else { continue };
        for row in lower {
            let factor = quotient(row.get(pivot), first.get(pivot));
            row.iter_mut().zip(first).skip(pivot).for_each(|(x, y)| *x -= factor * y);
        }
    }
    let mut z = vec![Complex64::ZERO; n];
    for (i, row) in rows.iter().enumerate().rev() {
        let known: Complex64 = row.iter().zip(&z).skip(i + 1).map(|(h, z)| h * z).sum();
        let value = quotient(row.get(n).map(|rhs| rhs - known).as_ref(), row.get(i));
        if let Some(slot) = z.get_mut(i) {
            *slot = value;
        }
    }
    z
}

fn quotient(a: Option<&Complex64>, b: Option<&Complex64>) -> Complex64 {
    a.zip(b).map_or(Complex64::ZERO, |(a, b)| a / b)
}
