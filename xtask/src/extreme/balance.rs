//! The balance of every dof and harmonic, eq. (4), in double-double: `H_k W_k − f_k + B F_k`, and the size of its terms.

use faer::linalg::solvers::Solve as _;
use faer::{Mat, c64};
use hbm::{ExcitationKind, Model};
use num_complex::Complex64;

use super::case::Case;
use super::double_double::{Complex, DoubleDouble, TAU};

/// The linear side of a case at one harmonic of Ω.
pub(super) struct Rows<'a> {
    case: &'a Case,
    model: &'a Model,
    order: usize,
}

/// A row of the balance.
pub(super) struct Row {
    /// |H W − f + B F| in N.
    pub(super) residual: f64,
    /// Sum of the magnitudes of all terms, inertia and stiffness counted apart, in N.
    pub(super) size: f64,
}

impl<'a> Rows<'a> {
    pub(super) fn new(case: &'a Case, model: &'a Model, order: usize) -> Self {
        Self { case, model, order }
    }

    /// f_k in N.
    pub(super) fn excitation(&self) -> Vec<Complex64> {
        let n = self.model.dofs();
        let mut loads = vec![Complex64::ZERO; n];
        let omega = std::f64::consts::TAU * self.case.frequency;
        for load in self.case.loads.iter().filter(|load| load.harmonic == self.order) {
            let phase = if load.harmonic == 0 {
                Complex64::from(load.phase.cos())
            } else {
                Complex64::new(load.phase.cos(), load.phase.sin())
            };
            let amplitude = phase * load.amplitude;
            match load.kind {
                ExcitationKind::Force => loads[load.dof] += amplitude,
                ExcitationKind::Unbalance => loads[load.dof] += amplitude * (omega * omega),
                ExcitationKind::Base => {
                    for (i, f) in loads.iter_mut().enumerate() {
                        *f -= amplitude * (0..n).map(|j| self.model.mass()[(i, j)]).sum::<f64>();
                    }
                }
            }
        }
        loads
    }

    /// Row `i` for the displacements `w` of all dofs and the contact forces `drive` = B F (rig convention) on them.
    pub(super) fn row(&self, i: usize, w: &[Complex64], load: Complex64, drive: &[Complex64]) -> Row {
        let order = DoubleDouble::from(self.order as f64);
        let omega = TAU * DoubleDouble::from(self.case.frequency) * order;
        let square = omega * omega;
        let mut sum = Complex::from(-load);
        let mut size = load.norm();
        for (j, w) in w.iter().enumerate() {
            let (m, d, c) = self.entries(i, j);
            let stiff = DoubleDouble::from(c) - square * DoubleDouble::from(m);
            let h = Complex { re: stiff, im: omega * DoubleDouble::from(d) };
            sum = sum + h * Complex::from(*w);
            let o = omega.value();
            size += (c.abs() + o * o * m.abs() + o * d.abs()) * w.norm();
        }
        for force in drive {
            sum = sum + Complex::from(*force);
            size += force.norm();
        }
        Row { residual: sum.norm(), size }
    }

    fn entries(&self, i: usize, j: usize) -> (f64, f64, f64) {
        (self.model.mass()[(i, j)], self.model.damping()[(i, j)], self.model.stiffness()[(i, j)])
    }

    /// H_k in f64.
    pub(super) fn dynamic_stiffness(&self) -> Mat<c64> {
        let omega = std::f64::consts::TAU * self.case.frequency * self.order as f64;
        Mat::from_fn(self.model.dofs(), self.model.dofs(), |i, j| {
            let (m, d, c) = self.entries(i, j);
            c64::new(c - omega * omega * m, omega * d)
        })
    }

    /// Receptance G_cc and free response u⁰_c of every contact, to weigh the residual that the solver reports.
    pub(super) fn receptances(&self) -> Vec<(Complex64, Complex64)> {
        let n = self.model.dofs();
        let contacts = &self.case.contacts;
        let mut rhs = Mat::<c64>::zeros(n, contacts.len() + 1);
        for (l, contact) in contacts.iter().enumerate() {
            rhs[(contact.first, l)] += c64::ONE;
            if let Some(second) = contact.second {
                rhs[(second, l)] -= c64::ONE;
            }
        }
        for (i, f) in self.excitation().into_iter().enumerate() {
            rhs[(i, contacts.len())] = f;
        }
        let x = self.dynamic_stiffness().partial_piv_lu().solve(&rhs);
        let across = |l: usize, column: usize| {
            let contact = &contacts[l];
            x[(contact.first, column)] - contact.second.map_or(c64::ZERO, |s| x[(s, column)])
        };
        (0..contacts.len()).map(|l| (across(l, l), across(l, contacts.len()))).collect()
    }
}
