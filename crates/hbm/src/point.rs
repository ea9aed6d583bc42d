//! The balance at one frequency without dimensions: displacements in each law's own length, forces in its own force.
//!
//! ```text
//! r_k = (û_k + Ĝ_k (μ F̂_k(û) − Ŝ_k û_k) − η û⁰_k) / (1 + |Ĝ_k|) = 0
//! ```
//!
//! Ŝ is zero but where the structure is singular (see `condensation`).
//!
//! The row factor 1/(1 + |Ĝ|) makes the residual a displacement where the contact is soft against the structure and a
//! force where it is stiff, so that neither loses digits and nothing is divided by a receptance that may vanish.

use std::ops::Range;

use contact::Law;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, c64};

use crate::condensation::Condensed;
use crate::dense::{Entry, Lu};
use crate::problem::{Contact, Joint};
use crate::rows::joint_rows;

/// Dimensionless balance of the active rows at one frequency; buffers are reused.
#[derive(Debug)]
pub(crate) struct Point {
    /// Rows in the iteration, ascending; the others are contacts held at rest. Those of joints are always active.
    pub(crate) active: Vec<usize>,
    /// Ĝ, entry `[slot][i][l]` over active rows.
    pub(crate) receptance: Vec<c64>,
    /// û⁰, entry `[slot][i]`.
    pub(crate) free: Vec<c64>,
    /// Ŝ, springs lent to the structure, entry `[slot][i]`; zero nearly always.
    pub(crate) lent: Vec<c64>,
    /// 1/(1 + |Ĝ_ii|), entry `[slot][i]`.
    pub(crate) weight: Vec<f64>,
    /// Unit of displacement in m, one an active row.
    pub(crate) length: Vec<f64>,
    /// Unit of force in N, one an active row.
    pub(crate) force: Vec<f64>,
    /// Dimensionless secant stiffness of every active row, for homotopies that begin with a linear problem.
    pub(crate) secant: Vec<c64>,
    /// From this slot on, all set so far contract under substitution.
    pub(crate) contracting: usize,
    /// Largest dimensionless stiffness, one an active row; infinite for those of joints, whose directions push on each other.
    stiffest: Vec<f64>,
    /// Base angular frequency in rad/s.
    pub(crate) omega: f64,
    held: Held,
}

/// Substitution into a harmonic counts as contracting when it shrinks an error at least by this factor, whatever the
/// motion.
const CONTRACTION: f64 = 0.05;

/// From so many contacts on products with Ĝ are worth vector instructions.
const VECTORS: usize = 32;

/// What is needed to keep some contacts at rest.
#[derive(Debug)]
struct Held {
    contacts: Vec<usize>,
    lu: Lu<c64>,
    rhs: Mat<c64>,
    /// G_hh and the right-hand sides as they were, for contacts that share a motion.
    receptance: Mat<c64>,
    wanted: Mat<c64>,
}

/// Below this ratio of pivots G_hh counts as singular: contacts share a motion (the same contact twice, or a closed ring of
/// them), and how they share the force is not determined.
const SHARED: f64 = 1e-12;

/// Share of the diagonal that is added to a singular G_hh: every contact gives way a little, which shares the force equally; refined
/// so often, nothing of the give is left.
const GIVE: f64 = 1e-8;
const REFINEMENTS: usize = 3;

impl Held {
    /// Replaces the first `columns` of `rhs` by `G_hh⁻¹ rhs`, `G_hh` in `receptance`; of many solutions the smallest.
    fn solve(&mut self, columns: usize) {
        let n = self.contacts.len();
        let largest = (0..n).map(|r| self.receptance[(r, r)].magnitude()).fold(0.0, f64::max);
        for c in 0..n {
            for r in 0..n {
                self.lu.matrix[(r, c)] = self.receptance[(r, c)];
            }
        }
        self.lu.factor(n);
        if self.lu.is_regular(SHARED) || largest == 0.0 {
            return self.lu.solve(self.rhs.as_mut().submatrix_mut(0, 0, n, columns));
        }
        // The diagonal of a passive structure points into one half plane; so does what is added to it.
        for c in 0..n {
            for r in 0..n {
                self.lu.matrix[(r, c)] = self.receptance[(r, c)];
            }
            self.lu.matrix[(c, c)] += self.receptance[(c, c)] * GIVE;
        }
        self.lu.factor(n);
        for c in 0..columns {
            for r in 0..n {
                self.wanted[(r, c)] = self.rhs[(r, c)];
            }
        }
        self.lu.solve(self.rhs.as_mut().submatrix_mut(0, 0, n, columns));
        for _ in 0..REFINEMENTS {
            for c in 0..columns {
                let mut missing = vec![c64::ZERO; n];
                for (r, missing) in missing.iter_mut().enumerate() {
                    let got: c64 = (0..n).map(|l| self.receptance[(r, l)] * self.rhs[(l, c)]).sum();
                    *missing = self.wanted[(r, c)] - got;
                }
                let mut correction = Mat::from_fn(n, 1, |r, _| missing[r]);
                self.lu.solve(correction.as_mut());
                for r in 0..n {
                    self.rhs[(r, c)] += correction[(r, 0)];
                }
            }
        }
    }
}

impl Point {
    pub(crate) fn new(rows: usize, slots: usize) -> Self {
        Self {
            active: Vec::with_capacity(rows),
            receptance: vec![c64::ZERO; slots * rows * rows],
            free: vec![c64::ZERO; slots * rows],
            lent: vec![c64::ZERO; slots * rows],
            weight: vec![1.0; slots * rows],
            length: vec![1.0; rows],
            force: vec![1.0; rows],
            secant: vec![c64::ZERO; rows],
            contracting: 0,
            stiffest: vec![f64::INFINITY; rows],
            omega: 0.0,
            held: Held {
                contacts: Vec::with_capacity(rows),
                lu: Lu::new(rows, rows + 1),
                rhs: Mat::zeros(rows, rows + 1),
                receptance: Mat::zeros(rows, rows),
                wanted: Mat::zeros(rows, rows + 1),
            },
        }
    }

    /// Secant stiffness of active row `row` at harmonic `order`; the mean sees its elastic part only.
    pub(crate) fn secant_stiffness(&self, row: usize, order: usize) -> c64 {
        let stiffness = self.secant[row];
        if order == 0 { c64::from(stiffness.re) } else { stiffness }
    }

    /// `1/(1 + Ĝ K̂)`: how far a harmonic follows what drives it where the contact answers with the secant stiffness
    /// K̂ = F̂_1/û_1 of the harmonic in slot `first`; one where that is not known, and where it would follow farther.
    pub(crate) fn yields(&self, entry: usize, first: Option<usize>, forces: &[c64], unknowns: &[c64]) -> c64 {
        let width = self.width();
        let Some(reference) = first.map(|slot| slot * width + entry % width) else { return c64::ONE };
        let stiffness = forces[reference] / unknowns[reference];
        let resistance = 1.0 + self.receptance[entry * width + entry % width] * stiffness;
        if resistance.is_finite() && resistance.norm_sqr() > 1.0 { resistance.inv() } else { c64::ONE }
    }

    /// Dimensionless stiffness of a row of `joint` where it sticks.
    pub(crate) fn stuck(&self, joint: &Joint, direction: usize, row: usize) -> f64 {
        joint.law.stiffness(direction) * joint.scale * self.length[row] / self.force[row]
    }

    /// Number of active rows.
    pub(crate) fn width(&self) -> usize {
        self.active.len()
    }

    /// The balance of `condensed`, with the contacts marked in `held` kept at zero displacement:
    /// `G' = G − G_fh G_hh⁻¹ G_hf`, `u⁰' = u⁰ − G_fh G_hh⁻¹ u⁰_h`.
    pub(crate) fn set(
        &mut self,
        condensed: &Condensed,
        (contacts, joints): (&[Contact], &[Joint]),
        slots: usize,
        held: &[bool],
    ) {
        let all = condensed.rows;
        self.omega = condensed.omega;
        let is_held = |c: usize| held.get(c).copied().unwrap_or(false);
        self.active.clear();
        self.active.extend((0..all).filter(|&c| !is_held(c)));
        self.held.contacts.clear();
        self.held.contacts.extend((0..all).filter(|&c| is_held(c)));
        for slot in 0..slots {
            self.reduce(condensed, slot);
        }
        self.choose_units(contacts, joints, slots);
        self.contracting = 0;
        self.scale(0..slots);
    }

    /// The balance of `condensed` in the units set before, no contact held.
    pub(crate) fn set_again(&mut self, condensed: &Condensed, slots: usize) {
        self.omega = condensed.omega;
        for slot in 0..slots {
            self.reduce(condensed, slot);
        }
        self.contracting = 0;
        self.scale(0..slots);
    }

    /// Adds the harmonics in `slots`, which nothing excites, to those of [`Point::set`].
    pub(crate) fn add(&mut self, condensed: &Condensed, slots: Range<usize>) {
        for slot in slots.clone() {
            self.reduce(condensed, slot);
        }
        self.scale(slots);
    }

    /// Physical receptance and free response of the active rows of one slot.
    fn reduce(&mut self, condensed: &Condensed, slot: usize) {
        let (all, width) = (condensed.rows, self.active.len());
        let held = self.held.contacts.len();
        let g = |i: usize, l: usize| condensed.receptance[(slot * all + i) * all + l];
        let free = |i: usize| condensed.free[slot * all + i];
        if held > 0 {
            for (r, &h) in self.held.contacts.iter().enumerate() {
                for (c, &other) in self.held.contacts.iter().enumerate() {
                    self.held.receptance[(r, c)] = g(h, other);
                }
                for (c, &other) in self.active.iter().enumerate() {
                    self.held.rhs[(r, c)] = g(h, other);
                }
                self.held.rhs[(r, width)] = free(h);
            }
            self.held.solve(width + 1);
        }
        let through = |i: usize, column: usize| -> c64 {
            self.held.contacts.iter().enumerate().map(|(r, &h)| g(i, h) * self.held.rhs[(r, column)]).sum()
        };
        for (row, &i) in self.active.iter().enumerate() {
            for (column, &l) in self.active.iter().enumerate() {
                self.receptance[(slot * width + row) * width + column] = g(i, l) - through(i, column);
            }
            self.free[slot * width + row] = free(i) - through(i, width);
            self.lent[slot * width + row] = condensed.lent[slot * all + i];
        }
    }

    /// Units of length and force.
    fn choose_units(&mut self, contacts: &[Contact], joints: &[Joint], slots: usize) {
        let width = self.width();
        for (row, &c) in self.active.iter().enumerate().take_while(|(_, c)| **c < contacts.len()) {
            let size: f64 = (0..slots).map(|s| self.free[s * width + row].magnitude()).fold(0.0, f64::max);
            let Contact { law, scale, .. } = &contacts[c];
            let length = law.length().unwrap_or(if size > 0.0 { size } else { 1.0 });
            let force = law.secant_stiffness(length) * length * scale;
            self.length[row] = length;
            self.force[row] = if force > 0.0 { force } else { 1.0 };
            let bound = law.stiffest().unwrap_or(f64::INFINITY);
            self.stiffest[row] = bound * scale * length / self.force[row];
        }
        let held = self.held.contacts.len();
        for (joint, rows) in joint_rows(contacts.len() - held, joints) {
            let moved =
                |row: usize| (0..slots).map(|s| self.free[s * width + row].magnitude()).fold(0.0, f64::max);
            let farthest = rows.clone().map(moved).fold(0.0, f64::max);
            for (direction, row) in rows.enumerate() {
                // Bodies that just touch, or slide without friction, have no length of their own.
                let own = joint.law.length(direction);
                let length = [own, moved(row), farthest].into_iter().find(|x| *x > 0.0).unwrap_or(1.0);
                let force = joint.law.stiffness(direction) * length * joint.scale;
                self.length[row] = length;
                self.force[row] = if force > 0.0 { force } else { 1.0 };
                self.stiffest[row] = f64::INFINITY;
            }
        }
    }

    /// Takes the dimensions off, and sets the row factors.
    fn scale(&mut self, slots: Range<usize>) {
        let width = self.width();
        for slot in slots {
            for row in 0..width {
                for column in 0..width {
                    self.receptance[(slot * width + row) * width + column] *=
                        self.force[column] / self.length[row];
                }
                self.free[slot * width + row] /= self.length[row];
                self.lent[slot * width + row] *= self.length[row] / self.force[row];
                let own = self.receptance[(slot * width + row) * width + row].magnitude();
                self.weight[slot * width + row] = 1.0 / (1.0 + own);
                let pull = |column: usize| {
                    let stiffness = self.stiffest[column] + self.lent[slot * width + column].magnitude();
                    self.receptance[(slot * width + row) * width + column].magnitude() * stiffness
                };
                let factor: f64 = (0..width).map(pull).sum();
                if factor.is_nan() || factor > CONTRACTION {
                    self.contracting = slot + 1;
                }
            }
        }
    }

    /// `Ĝ_k felt` of one slot.
    pub(crate) fn pull(&self, slot: usize, felt: &[c64], into: &mut [c64]) {
        let width = self.width();
        let receptance = &self.receptance[slot * width * width..(slot + 1) * width * width];
        if width >= VECTORS {
            let receptance = MatRef::from_row_major_slice(receptance, width, width);
            let felt = MatRef::from_column_major_slice(felt, width, 1);
            let into = MatMut::from_column_major_slice_mut(into, width, 1);
            return matmul(into, Accum::Replace, receptance, felt, c64::ONE, Par::Seq);
        }
        for (row, into) in receptance.chunks_exact(width.max(1)).zip(into) {
            *into = row.iter().zip(felt).map(|(g, felt)| g * felt).sum();
        }
    }

    /// Norm of the weighted excitation, to which residuals are relative.
    pub(crate) fn excitation_norm(&self, slots: usize) -> f64 {
        let count = slots * self.width();
        let rows = self.free.iter().zip(&self.weight).take(count);
        rows.map(|(free, weight)| (free * weight).norm_sqr()).sum::<f64>().sqrt()
    }

    /// What the structure feels of the contact force `force` at the displacement `unknown` beside the springs it was
    /// lent: `F̂ − Ŝ û`.
    #[inline]
    pub(crate) fn felt(&self, entry: usize, force: c64, unknown: c64) -> c64 {
        force - self.lent[entry] * unknown
    }

    /// Harmonic `slot` of the forces in N that keep the held contacts at rest, `G_hh⁻¹ (u⁰_h − G_hf F_f)`, given the
    /// dimensionless forces and displacements `[slot][i]` of the active rows; one value a held contact, in order.
    pub(crate) fn holding_forces(
        &mut self,
        condensed: &Condensed,
        slot: usize,
        active_forces: &[c64],
        unknowns: &[c64],
        mut receive: impl FnMut(usize, c64),
    ) {
        let (all, width) = (condensed.rows, self.active.len());
        let g = |i: usize, l: usize| condensed.receptance[(slot * all + i) * all + l];
        for (r, &h) in self.held.contacts.iter().enumerate() {
            for (c, &other) in self.held.contacts.iter().enumerate() {
                self.held.receptance[(r, c)] = g(h, other);
            }
            let pull: c64 = self
                .active
                .iter()
                .enumerate()
                .map(|(c, &l)| {
                    let entry = slot * width + c;
                    g(h, l) * self.felt(entry, active_forces[entry], unknowns[entry]) * self.force[c]
                })
                .sum();
            self.held.rhs[(r, 0)] = condensed.free[slot * all + h] - pull;
        }
        self.held.solve(1);
        for (r, &h) in self.held.contacts.iter().enumerate() {
            receive(h, self.held.rhs[(r, 0)]);
        }
    }
}

/// The linear law's dimensionless stiffness, or the secant stiffness of any law with a describing function at the
/// dimensionless amplitude `a`; zero for others.
pub(crate) fn secant(law: &dyn Law, scale: f64, a: f64, length: f64, force: f64) -> c64 {
    let Some(describing) = law.describing_function() else { return c64::ZERO };
    let amplitude = a.max(1e-12) * length;
    describing.first_harmonic(amplitude).force * (scale * length / (force * amplitude))
}
