//! What a solution's missing harmonics would be: one Newton step with more of them.
//!
//! With two-sided amplitudes u_p of the contacts' relative displacements, |p| ≤ K, and the forces F_p that the balance left out,
//!
//! ```text
//! δu_p + G_p Σ_l (κ_{p−l} + i l c_{p−l}) δu_l = { −G_p F_p  for |p| > N
//!                                               {  0        for |p| ≤ N,      G_p = Bᵀ H_p⁻¹ B
//! ```

use faer::{Mat, c64};
use num_complex::Complex64;

use crate::dense::Lu;
use crate::plan::Plan;
use crate::solution::Solution;
use crate::stability::{Local, ROUNDING};

/// Unknowns up to which harmonics are solved for together; with more of them each is found for itself.
const MOST_UNKNOWNS: usize = 800;

/// A static stiffness with pivots in this ratio determines no mean.
const SINGULAR: f64 = 1e-12;

/// M, D and C.
type Matrices<'a> = (&'a Mat<f64>, &'a Mat<f64>, &'a Mat<f64>);

/// A solution, and its contacts along its motion.
pub(crate) struct Longer<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) matrices: Matrices<'a>,
    pub(crate) solution: &'a Solution,
    pub(crate) local: &'a [Local],
    /// Of the base frequency, in rad/s.
    pub(crate) omega: f64,
}

impl Longer<'_> {
    /// The motions of the contacts, one-sided harmonics of the base frequency, one Newton step beyond `motions`. `None` where
    /// no force was left out.
    pub(crate) fn motions(&self, motions: &[Vec<Complex64>]) -> Option<Vec<Vec<Complex64>>> {
        let contacts = self.plan.contacts.len();
        let slots = self.solution.contacts.first()?.displacement.len();
        let solved = self.plan.harmonics.reduced.get(slots.checked_sub(1)?).copied().filter(|k| *k > 0)?;
        let left_out =
            |k: usize| self.local.iter().map(|local| at(&local.force, k as i64).norm()).fold(0.0, f64::max);
        let largest = (0..=solved).map(left_out).fold(0.0, f64::max);
        let counts = |k: &usize| left_out(*k) > 10.0 * ROUNDING * largest;
        let highest = (solved + 1..=4 * solved + 4).rev().find(counts)?;
        let step = if self.plan.harmonics.odd { 2 } else { 1 };
        let mut orders: Vec<i64> = (-(highest as i64)..=highest as i64).collect();
        orders.retain(|p| step == 1 || p % 2 != 0);
        let mut receptances = Vec::new();
        orders.retain(|&p| match self.receptance(p) {
            Some(receptance) => {
                receptances.push(receptance);
                true
            }
            None => false,
        });
        let size = orders.len() * contacts;
        let together = size <= MOST_UNKNOWNS;
        let mut rhs = Mat::<c64>::zeros(size, 1);
        let mut matrix = Mat::<c64>::zeros(if together { size } else { 0 }, if together { size } else { 0 });
        for (row, (&p, receptance)) in orders.iter().zip(&receptances).enumerate() {
            for i in 0..contacts {
                let place = row * contacts + i;
                if p.unsigned_abs() as usize > solved {
                    let felt = |(c, local): (usize, &Local)| receptance[(i, c)] * at(&local.force, p);
                    rhs[(place, 0)] = -self.local.iter().enumerate().map(felt).sum::<c64>();
                }
                if !together {
                    continue;
                }
                matrix[(place, place)] += c64::ONE;
                for (column, &l) in orders.iter().enumerate() {
                    for (c, local) in self.local.iter().enumerate() {
                        let turn = c64::new(0.0, l as f64);
                        let tangent = at(&local.stiffness, p - l) + turn * at(&local.rate, p - l);
                        matrix[(place, column * contacts + c)] += receptance[(i, c)] * tangent;
                    }
                }
            }
        }
        if together {
            let mut lu = Lu::<c64>::new(size, 1);
            lu.matrix = matrix;
            lu.factor(size);
            lu.solve(rhs.as_mut());
        }
        let mut motions = motions.to_vec();
        for (row, &p) in orders.iter().enumerate().filter(|(_, p)| **p >= 0) {
            for (c, motion) in motions.iter_mut().enumerate() {
                let k = p as usize;
                let change = rhs[(row * contacts + c, 0)] * if k > 0 { 2.0 } else { 1.0 };
                motion.resize(motion.len().max(k + 1), Complex64::ZERO);
                if let Some(entry) = motion.get_mut(k) {
                    *entry += if k > 0 { change } else { c64::from(change.re) };
                }
            }
        }
        let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
        motions.iter().flatten().all(finite).then_some(motions)
    }

    /// G_p per unit of the laws' own force, m × m; `None` for a mean that the structure does not determine.
    fn receptance(&self, p: i64) -> Option<Mat<c64>> {
        let (mass, damping, stiffness) = self.matrices;
        let (n, contacts) = (mass.nrows(), &self.plan.contacts);
        let turn = p as f64 * self.omega;
        let mut lu = Lu::<c64>::new(n, contacts.len());
        lu.matrix = Mat::from_fn(n, n, |i, j| {
            c64::new(stiffness[(i, j)] - turn * turn * mass[(i, j)], turn * damping[(i, j)])
        });
        lu.factor(n);
        if p == 0 && !lu.is_regular(SINGULAR) {
            return None;
        }
        let mut shapes = Mat::<c64>::zeros(n, contacts.len());
        for (c, contact) in contacts.iter().enumerate() {
            shapes[(contact.first, c)] += c64::from(contact.scale);
            if let Some(second) = contact.second {
                shapes[(second, c)] -= c64::from(contact.scale);
            }
        }
        lu.solve(shapes.as_mut());
        Some(Mat::from_fn(contacts.len(), contacts.len(), |i, c| {
            let second = contacts[i].second.map_or(c64::ZERO, |second| shapes[(second, c)]);
            shapes[(contacts[i].first, c)] - second
        }))
    }
}

/// A two-sided coefficient of a real function; those that are not there are zero.
fn at(coefficients: &[Complex64], k: i64) -> Complex64 {
    let value = coefficients.get(k.unsigned_abs() as usize).copied().unwrap_or_default();
    if k < 0 { value.conj() } else { value }
}
