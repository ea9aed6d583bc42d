//! The linear structure seen from its rows, the relative displacements at contacts and joints: receptances and free
//! response at one frequency, everything else condensed away.
//!
//! With `H_k = C − (kΩ)² M + i kΩ D`, eq. (4), directions B (one column a row, relative displacement u = Bᵀ w) and contact
//! forces F on the first bodies' drive (rig convention):
//!
//! ```text
//! w_k = H_k⁻¹ f_k − H_k⁻¹ B F_k,   u_k = u⁰_k − G_k F_k,   G_k = Bᵀ H_k⁻¹ B,   u⁰_k = Bᵀ H_k⁻¹ f_k
//! ```
//!
//! Where H_k is singular (an undamped resonance, a free rigid body) there is no G_k, but the balance has a solution all
//! the same when the contacts resist. Springs S are then lent to the structure at the rows and taken back from the
//! force, which changes nothing:
//!
//! ```text
//! (H_k + B S Bᵀ) w_k = f_k − B (F_k − S u_k)
//! ```
//!
//! With H_k symmetric and S = i·(positive), only a motion that moves no contact can still be singular. For the mean S is
//! real.

use std::ops::Range;

use faer::{Mat, c64};

use crate::facts::Receptances;
use crate::ground_paths::paths_to_ground;
use crate::harmonics::Harmonics;
use crate::matrices::{Additions, Factor, Matrices};
use crate::modal::{Modal, ModalBuffers};
use crate::problem::{Contact, ExcitationKind, Joint, Problem};
use crate::rows::Rows;

/// Pivots of the balanced dynamic stiffness below this fraction of the largest count as zero.
const SINGULAR: f64 = 1e-15;

/// Springs that leave a smaller fraction do not reach what is singular, or are lost in its rounding.
const STILL_SINGULAR: f64 = 1e-12;

/// Below this fraction the structure counts as singular without its contacts.
const NEARLY_SINGULAR: f64 = 1e-11;

/// Below this fraction springs are lent: the receptance would lose digits that the balance has.
const ILL_CONDITIONED: f64 = 1e-3;

/// A fraction below which everything lies.
const ALWAYS: f64 = f64::INFINITY;

/// One entry of a harmonic's excitation vector: `amplitude · Ω^power` on `dof`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Load {
    pub(crate) dof: usize,
    pub(crate) amplitude: c64,
    pub(crate) grows: bool,
}

/// The parts of a problem that do not change with frequency.
#[derive(Debug)]
pub(crate) struct Structure {
    pub(crate) matrices: Matrices,
    /// Modes that make a factorisation unnecessary at most frequencies.
    pub(crate) modal: Option<Modal>,
    pub(crate) rows: Rows,
    /// Of the law of each row in N/m; infinite where it has no stiffness of its own.
    pub(crate) row_stiffness: Vec<f64>,
    pub(crate) outputs: Vec<usize>,
    /// For each output dof that contacts tie to the ground: the contacts on the way and their signs.
    paths: Vec<Option<Vec<(usize, f64)>>>,
    /// Harmonics of Ω, one a slot.
    pub(crate) orders: Vec<usize>,
    /// Excitation of each slot.
    pub(crate) loads: Vec<Vec<Load>>,
}

/// The structure at one frequency, in SI units; buffers are reused.
#[derive(Debug)]
pub(crate) struct Condensed {
    pub(crate) rows: usize,
    pub(crate) outputs: usize,
    /// Angular frequency of the lowest harmonic in rad/s.
    pub(crate) omega: f64,
    /// G, entry `[slot][i][l]`.
    pub(crate) receptance: Vec<c64>,
    /// u⁰, entry `[slot][i]`.
    pub(crate) free: Vec<c64>,
    /// Displacement of an output dof per unit contact force, entry `[slot][o][l]`; to be subtracted.
    pub(crate) recovery: Vec<c64>,
    /// Displacement of an output dof without contact forces, entry `[slot][o]`.
    pub(crate) free_output: Vec<c64>,
    /// S in N/m, entry `[slot][l]`; zero nearly always.
    pub(crate) lent: Vec<c64>,
    /// Structural damping added to every dof, as a part of its own dynamic stiffness; for homotopies.
    pub(crate) added_damping: f64,
    /// Sums over modes are not asked: a contact at rest is infinitely stiff, and sees digits that they do not have.
    pub(crate) factored: bool,
    /// 2ζω in 1/s: this times the mass is taken off the damping, so that a free motion with that damping is periodic.
    pub(crate) self_excitation: f64,
    /// Whether the structure alone is singular, entry `[slot]`.
    pub(crate) singular: Vec<bool>,
    pub(crate) factor: Factor,
    pub(crate) modal: ModalBuffers,
    /// Right-hand sides of one block.
    pub(crate) rhs: Mat<c64>,
    pub(crate) scale: Vec<f64>,
}

/// Stiffness of a contact in N/m where its law changes its character, or everywhere.
fn own_stiffness(contact: &Contact) -> f64 {
    let law = &contact.law;
    match (law.length(), law.nature().linear) {
        (Some(length), _) => law.secant_stiffness(length) * contact.scale,
        (None, true) => law.secant_stiffness(1.0) * contact.scale,
        (None, false) => f64::INFINITY,
    }
}

/// Stiffness of each row of a joint in N/m.
fn joint_stiffness(joint: &Joint) -> impl Iterator<Item = f64> {
    (0..joint.directions.len()).map(|direction| {
        let stiffness = joint.law.stiffness(direction) * joint.scale;
        if stiffness > 0.0 { stiffness } else { f64::INFINITY }
    })
}

impl Structure {
    pub(crate) fn new<M>(
        problem: &Problem<M>,
        matrices: Matrices,
        base_loads: &[Vec<f64>],
        harmonics: &Harmonics,
    ) -> Self {
        let mut loads = vec![Vec::new(); harmonics.orders.len()];
        for excitation in problem.excitation.iter().filter(|e| e.amplitude != 0.0) {
            let Some(slot) = harmonics.orders.iter().position(|&k| k == excitation.harmonic) else {
                continue;
            };
            let Some(loads) = loads.get_mut(slot) else { continue };
            let mut amplitude = c64::from_polar(excitation.amplitude, excitation.phase);
            if excitation.harmonic == 0 {
                amplitude.im = 0.0;
            }
            let dof = excitation.dof;
            match excitation.kind {
                ExcitationKind::Force => loads.push(Load { dof, amplitude, grows: false }),
                ExcitationKind::Unbalance => loads.push(Load { dof, amplitude, grows: true }),
                ExcitationKind::Base => {
                    let inertia = base_loads.get(dof).into_iter().flatten().enumerate();
                    let load = |(dof, inertia)| Load { dof, amplitude: -amplitude * inertia, grows: false };
                    loads.extend(inertia.map(load));
                }
            }
        }
        let rows = Rows::new(&problem.contacts, &problem.joints);
        let of_contacts = problem.contacts.iter().map(own_stiffness);
        Self {
            modal: matrices.modal(&rows, &problem.output, &loads),
            rows,
            row_stiffness: of_contacts.chain(problem.joints.iter().flat_map(joint_stiffness)).collect(),
            outputs: problem.output.clone(),
            paths: paths_to_ground(problem, matrices.dofs()),
            matrices,
            orders: harmonics.orders.clone(),
            loads,
        }
    }

    /// How receptances are found.
    pub(crate) fn receptances(&self) -> Receptances {
        match self.matrices {
            Matrices::Sparse(_) => Receptances::Sparse,
            Matrices::Dense { .. } if self.modal.is_some() => Receptances::Modes,
            Matrices::Dense { .. } => Receptances::Dense,
        }
    }

    /// Whether sums over modes may answer.
    pub(crate) fn has_modes(&self) -> bool {
        self.modal.is_some()
    }

    /// Number of dofs.
    pub(crate) fn dofs(&self) -> usize {
        self.matrices.dofs()
    }

    /// M, D and C, where they are dense.
    pub(crate) fn dense(&self) -> Option<(&Mat<f64>, &Mat<f64>, &Mat<f64>)> {
        match &self.matrices {
            Matrices::Dense { mass, damping, stiffness } => Some((mass, damping, stiffness)),
            Matrices::Sparse(_) => None,
        }
    }

    /// Contacts whose relative displacements, with these signs, add up to output dof `o`.
    pub(crate) fn path_to_ground(&self, o: usize) -> Option<&[(usize, f64)]> {
        self.paths.get(o)?.as_deref()
    }

    /// Buffers for one thread.
    pub(crate) fn condensed(&self) -> Condensed {
        let (n, rows, outputs, slots) =
            (self.matrices.dofs(), self.rows.count(), self.outputs.len(), self.orders.len());
        let block = self.matrices.block(rows + 1);
        Condensed {
            rows,
            outputs,
            omega: 0.0,
            receptance: vec![c64::ZERO; slots * rows * rows],
            free: vec![c64::ZERO; slots * rows],
            recovery: vec![c64::ZERO; slots * outputs * rows],
            free_output: vec![c64::ZERO; slots * outputs],
            lent: vec![c64::ZERO; slots * rows],
            added_damping: 0.0,
            factored: false,
            self_excitation: 0.0,
            singular: vec![false; slots],
            factor: self.matrices.factor(block),
            modal: ModalBuffers::new(),
            rhs: Mat::zeros(n, block),
            scale: vec![1.0; n],
        }
    }

    /// Condenses at Ω = 2π · `hertz` for the harmonics in `slots`.
    ///
    /// # Errors
    /// The harmonic of Ω at which the dynamic stiffness is singular.
    pub(crate) fn condense(
        &self,
        hertz: f64,
        slots: Range<usize>,
        into: &mut Condensed,
    ) -> Result<(), usize> {
        self.condense_where(hertz, slots, ILL_CONDITIONED, into)
    }

    /// As [`Structure::condense`], with springs lent only where the structure is singular: along a curve they would come and go.
    ///
    /// # Errors
    /// The harmonic of Ω at which the dynamic stiffness is singular.
    pub(crate) fn condense_alone(
        &self,
        hertz: f64,
        slots: Range<usize>,
        into: &mut Condensed,
    ) -> Result<(), usize> {
        self.condense_where(hertz, slots, NEARLY_SINGULAR, into)
    }

    /// As [`Structure::condense`], with springs as stiff as the structure lent to every row at every harmonic: nothing
    /// is singular then, and all of it is smooth in the frequency, also where the structure moves freely.
    ///
    /// # Errors
    /// The harmonic of Ω at which the dynamic stiffness is singular all the same.
    pub(crate) fn condense_sprung(
        &self,
        hertz: f64,
        slots: Range<usize>,
        into: &mut Condensed,
    ) -> Result<(), usize> {
        self.condense_where(hertz, slots, ALWAYS, into)
    }

    fn condense_where(
        &self,
        hertz: f64,
        slots: Range<usize>,
        lending: f64,
        into: &mut Condensed,
    ) -> Result<(), usize> {
        let base = std::f64::consts::TAU * hertz;
        let lowest = self.orders.iter().find(|&&order| order > 0);
        into.omega = base * lowest.map_or(1.0, |&order| order as f64);
        for (slot, &order) in self.orders.iter().enumerate().take(slots.end).skip(slots.start) {
            into.lent[slot * into.rows..(slot + 1) * into.rows].fill(c64::ZERO);
            if lending < ALWAYS && !into.factored && self.respond_by_modes(slot, base, into) {
                into.singular[slot] = false;
                continue;
            }
            self.factor(order as f64 * base, slot, into);
            into.singular[slot] = !into.factor.is_regular(NEARLY_SINGULAR);
            if !into.factor.is_regular(lending) {
                self.lend(order as f64 * base, slot, lending == ALWAYS, into);
                self.factor(order as f64 * base, slot, into);
                let still = if into.singular[slot] { STILL_SINGULAR } else { SINGULAR };
                if !into.factor.is_regular(still) {
                    return Err(order);
                }
            }
            self.respond(slot, base, into);
        }
        Ok(())
    }

    /// Factors the dynamic stiffness with the springs lent to one slot.
    pub(crate) fn factor(&self, omega: f64, slot: usize, into: &mut Condensed) {
        let Condensed { factor, scale, lent, added_damping, self_excitation, rows, .. } = into;
        let springs = &lent[slot * *rows..(slot + 1) * *rows];
        let additions = Additions {
            damping: *added_damping,
            self_excitation: *self_excitation,
            rows: &self.rows,
            springs,
        };
        self.matrices.factorise(omega, additions, scale, factor);
    }

    /// Springs at the rows of one slot, as stiff as their laws, and no stiffer than the structure itself: stiffer
    /// ones would hide what weak contacts do. With `stiff` all are like the structure.
    fn lend(&self, omega: f64, slot: usize, stiff: bool, into: &mut Condensed) {
        let size = |scale: f64| 1.0 / (scale * scale);
        for (l, (parts, own)) in self.rows.iter().zip(&self.row_stiffness).enumerate() {
            let felt = |&(dof, coefficient): &(usize, f64)| size(into.scale[dof] * coefficient);
            let structure = parts.iter().map(felt).fold(f64::INFINITY, f64::min);
            let stiffness = if stiff { structure } else { structure.min(*own) };
            into.lent[slot * into.rows + l] =
                if omega == 0.0 { c64::from(stiffness) } else { c64::new(0.0, stiffness) };
        }
    }
}
