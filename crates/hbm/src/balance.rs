//! Residual and Jacobian of the balance: contact forces at samples (alternating frequency–time), or by their events.
//!
//! The Jacobian is structured (tangent + memory): with the two-sided coefficients `K_q` of the local stiffness κ(τ)
//! and the one-sided ones `S_{r,p}` of each memory's influence,
//!
//! ```text
//! δF_p = ε_p [δW_j K_{p−j} + conj(δW_j) K_{p+j}] + Σ_r S_{r,p} recall_r(δW_j),   ε_0 = ½, ε_p = 1
//! ```
//!
//! A rate-dependent law adds `ε_p [ij δW_j C_{p−j} + conj(ij δW_j) C_{p+j}]` with the coefficients `C_q` of
//! c(τ) = ∂f/∂(dw/dτ).

use contact::{LawError, Marks, Motion, Recall};
use faer::{Mat, c64};

use crate::joint_force::{JointBuffers, JointDerivative};
use crate::pieces::PieceSeries;
use crate::point::Point;
use crate::problem::{Contact, Joint};
use crate::transform::{Buffers, Transform};

/// How far the problem is changed on the way to itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Homotopy {
    /// μ: factor on all contact forces.
    pub(crate) contact: f64,
    /// η: factor on the excitation.
    pub(crate) excitation: f64,
    /// Share of the contact forces that is replaced by secant stiffnesses (1: a linear problem).
    pub(crate) secant: f64,
    /// Laws see their displacement times this: below one they are softer, with the same slip forces.
    pub(crate) stretch: f64,
}

impl Homotopy {
    /// The problem itself.
    pub(crate) const NONE: Self = Self { contact: 1.0, excitation: 1.0, secant: 0.0, stretch: 1.0 };
}

/// A rung of a ladder has at most so many times the harmonics of the one below, and one more.
pub(crate) const LADDER_STEP: usize = 2;

/// Change of one harmonic of a contact force by the real and by the imaginary part of one harmonic of the displacement.
pub(crate) type Block = (c64, c64);

/// Up to so many harmonics the product of two spectra is faster by its definition than by transforms.
const DIRECT: usize = 24;

/// What a balance needs that does not change with frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Balance<'a> {
    pub(crate) contacts: &'a [Contact],
    pub(crate) joints: &'a [Joint],
    /// Directions of all joints together; their rows are the last ones.
    pub(crate) joint_rows: usize,
    /// Multiples of the base frequency, one a slot.
    pub(crate) orders: &'a [usize],
    pub(crate) odd: bool,
    pub(crate) transform: &'a Transform,
    /// Piecewise linear laws are evaluated by their events instead of at samples.
    pub(crate) exact: bool,
}

/// Buffers of one contact.
#[derive(Debug)]
struct ContactBuffers {
    law: contact::Workspace,
    /// W_0 … W_n in m.
    spectrum: Vec<c64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
    /// The force by its events, where no samples are needed.
    events: PieceSeries,
    marks: Option<Marks>,
    omega: f64,
}

impl ContactBuffers {
    fn motion(&self, odd: bool) -> Motion<'_> {
        Motion {
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
            odd,
            omega: self.omega,
        }
    }
}

impl BalanceBuffers {
    /// What contact `index` noticed at the last evaluation.
    pub(crate) fn marks(&self, index: usize) -> Option<Marks> {
        self.contacts.get(index).and_then(|contact| contact.marks)
    }
}

/// Buffers of a balance for one thread.
#[derive(Debug)]
pub(crate) struct BalanceBuffers {
    contacts: Vec<ContactBuffers>,
    pub(crate) joints: Vec<JointBuffers>,
    pub(crate) derivative: JointDerivative,
    pub(crate) fft: Buffers,
    /// F̂, entry `[slot][i]` over active rows.
    pub(crate) forces: Vec<c64>,
    /// What the structure feels of them, likewise.
    felt: Vec<c64>,
    /// r, likewise.
    pub(crate) residual: Vec<c64>,
    /// K_q of one contact.
    local: Vec<c64>,
    /// C_q of one contact; empty when its law does not depend on the velocity.
    rate: Vec<c64>,
    /// S_{r,p} of one contact, entry `[memory][slot]`.
    influence: Vec<c64>,
    /// Coefficients (of Re δW_j, of Im δW_j) of each recalled functional, entry `[memory][slot]`.
    recall: Vec<(f64, f64)>,
}

impl Balance<'_> {
    /// Buffers for one thread.
    pub(crate) fn buffers(&self) -> BalanceBuffers {
        let samples = self.transform.samples();
        let highest = self.orders.last().copied().unwrap_or(0);
        let contact = |_: &Contact| ContactBuffers {
            law: contact::Workspace::new(samples),
            spectrum: vec![c64::ZERO; highest + 1],
            displacement: vec![0.0; samples],
            velocity: vec![0.0; samples],
            force: vec![0.0; samples],
            events: PieceSeries::default(),
            marks: None,
            omega: 0.0,
        };
        let entries = self.orders.len() * (self.contacts.len() + self.joint_rows);
        BalanceBuffers {
            contacts: self.contacts.iter().map(contact).collect(),
            joints: self.joints.iter().map(|joint| JointBuffers::new(joint, samples, highest)).collect(),
            derivative: JointDerivative::new(samples, self.joints),
            fft: self.transform.buffers(),
            forces: vec![c64::ZERO; entries],
            felt: vec![c64::ZERO; entries],
            residual: vec![c64::ZERO; entries],
            local: vec![c64::ZERO; samples / 2 + 1],
            rate: Vec::new(),
            influence: Vec::new(),
            recall: Vec::new(),
        }
    }

    /// Forces and residual at `unknowns` (û, entry `[slot][i]`, the first `slots` harmonics); returns the norm of the
    /// residual.
    pub(crate) fn evaluate(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        unknowns: &[c64],
        buffers: &mut BalanceBuffers,
    ) -> Result<f64, LawError> {
        let width = point.width();
        for (row, &c) in point.active[..width - self.joint_rows].iter().enumerate() {
            self.contact_force(point, slots, homotopy, (row, c), unknowns, buffers)?;
        }
        self.joint_forces(point, slots, homotopy, unknowns, buffers)?;
        for (entry, felt) in buffers.felt.iter_mut().enumerate().take(slots * width) {
            *felt = point.felt(entry, homotopy.contact * buffers.forces[entry], unknowns[entry]);
        }
        let mut sum = 0.0;
        for slot in 0..slots {
            let entries = slot * width..(slot + 1) * width;
            let (felt, pull) = (&buffers.felt[entries.clone()], &mut buffers.residual[entries.clone()]);
            point.pull(slot, felt, pull);
            for entry in entries {
                let pull = buffers.residual[entry];
                let r = unknowns[entry] + pull - homotopy.excitation * point.free[entry];
                buffers.residual[entry] = r * point.weight[entry];
                sum += buffers.residual[entry].norm_sqr();
            }
        }
        if sum.is_finite() { Ok(sum.sqrt()) } else { Err(LawError::NotFinite) }
    }

    /// Norm of the magnitudes of the residual's terms at the last evaluation: what its rounding is relative to.
    pub(crate) fn terms(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        unknowns: &[c64],
        buffers: &BalanceBuffers,
    ) -> f64 {
        let width = point.width();
        let row = |entry: usize| {
            let slot = entry / width;
            let pull: f64 = (0..width)
                .map(|l| {
                    let source = slot * width + l;
                    let force = homotopy.contact * buffers.forces[source].norm();
                    let lent = (point.lent[source] * unknowns[source]).norm();
                    point.receptance[entry * width + l].norm() * (force + lent)
                })
                .sum();
            (unknowns[entry].norm() + pull) * point.weight[entry]
        };
        (0..slots * width).map(|entry| row(entry).powi(2)).sum::<f64>().sqrt()
    }

    /// Force harmonics of active contact `row`.
    fn contact_force(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        (row, index): (usize, usize),
        unknowns: &[c64],
        buffers: &mut BalanceBuffers,
    ) -> Result<(), LawError> {
        let width = point.width();
        let Contact { law, scale, .. } = &self.contacts[index];
        let contact = &mut buffers.contacts[index];
        contact.spectrum.clear();
        contact.spectrum.resize(self.orders[..slots].last().map_or(1, |highest| highest + 1), c64::ZERO);
        contact.omega = point.omega;
        for (slot, &order) in self.orders.iter().enumerate().take(slots) {
            contact.spectrum[order] = unknowns[slot * width + row] * (point.length[row] * homotopy.stretch);
        }
        let spectrum = contact.spectrum.iter().copied();
        let velocity = spectrum.clone().enumerate().map(|(k, w)| c64::new(-w.im, w.re) * k as f64);
        self.transform.to_time(velocity, &mut contact.velocity, &mut buffers.fft);
        let events = law.piecewise_linear().filter(|_| self.exact);
        if events.is_none() {
            self.transform.to_time(spectrum, &mut contact.displacement, &mut buffers.fft);
        }
        let motion = Motion {
            spectrum: &contact.spectrum,
            displacement: &contact.displacement,
            velocity: &contact.velocity,
            odd: self.odd,
            omega: contact.omega,
        };
        let unit = scale / point.force[row];
        if let Some(events) = events {
            contact.marks = Some(events.pieces(&motion, &mut contact.law, &mut contact.events.pieces)?);
            let orders = &self.orders[..slots];
            contact.events.integrate(&contact.spectrum, orders.last().copied().unwrap_or(0), self.odd);
            if slots > DIRECT {
                self.convolve(contact, &mut buffers.fft);
                let coefficients = self.transform.to_coefficients(&contact.force, &mut buffers.fft);
                for (slot, &order) in orders.iter().enumerate() {
                    let one_sided = if order == 0 { 1.0 } else { 2.0 };
                    let constant = contact.events.constant(order);
                    buffers.forces[slot * width + row] =
                        (coefficients[order] + constant) * (one_sided * unit);
                }
            } else {
                for slot in 0..slots {
                    buffers.forces[slot * width + row] =
                        contact.events.force(&contact.spectrum, orders, slot) * unit;
                }
            }
        } else {
            contact.marks = Some(law.force(&motion, &mut contact.law, &mut contact.force)?);
            let coefficients = self.transform.to_coefficients(&contact.force, &mut buffers.fft);
            // Beyond the motion's harmonics as well: what the next rung of a ladder begins with.
            let known = self.orders.iter().enumerate().take(LADDER_STEP * slots + 1);
            for (slot, &order) in known.take_while(|(_, order)| 2 * **order < self.transform.samples()) {
                let one_sided = if order == 0 { 1.0 } else { 2.0 };
                buffers.forces[slot * width + row] = coefficients[order] * (one_sided * unit);
            }
        }
        self.blend_secant(point, slots, homotopy, row, unknowns, &mut buffers.forces);
        Ok(())
    }

    /// Replaces a share of the force in active row `row` by its secant stiffness.
    pub(crate) fn blend_secant(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        row: usize,
        unknowns: &[c64],
        forces: &mut [c64],
    ) {
        if homotopy.secant > 0.0 {
            for (slot, &order) in self.orders.iter().enumerate().take(slots) {
                let entry = slot * point.width() + row;
                let linear = point.secant_stiffness(row, order) * unknowns[entry];
                let own = forces[entry];
                forces[entry] = own + (linear - own) * homotopy.secant;
            }
        }
    }

    /// κ(τ) w(τ) at samples into `force`, with the spectrum of κ cut off where no harmonic of the motion is reached any
    /// more: there are enough samples for the product, so nothing aliases.
    fn convolve(&self, contact: &mut ContactBuffers, fft: &mut Buffers) {
        let series = contact.events.lasting_stiffness().iter().enumerate();
        let stiffness = series.map(|(q, k)| if q == 0 { *k } else { 2.0 * k });
        self.transform.to_time(stiffness, &mut contact.force, fft);
        self.transform.to_time(contact.spectrum.iter().copied(), &mut contact.displacement, fft);
        for (force, w) in contact.force.iter_mut().zip(&contact.displacement) {
            *force *= w;
        }
    }

    /// The motion of contact `index` at the last evaluation.
    pub(crate) fn motion<'b>(&self, buffers: &'b BalanceBuffers, index: usize) -> Motion<'b> {
        buffers.contacts[index].motion(self.odd)
    }

    /// Number of real unknowns: the mean has no imaginary part.
    pub(crate) fn size(&self, width: usize, slots: usize) -> usize {
        2 * slots * width - if self.orders.first() == Some(&0) && slots > 0 { width } else { 0 }
    }

    /// Position of the real part of entry `[slot][i]` among the real unknowns, and whether an imaginary part follows.
    pub(crate) fn real_index(&self, width: usize, slot: usize, row: usize) -> (usize, bool) {
        let with_mean = self.orders.first() == Some(&0);
        match (with_mean, slot) {
            (true, 0) => (row, false),
            (true, _) => (width + 2 * ((slot - 1) * width + row), true),
            (false, _) => (2 * (slot * width + row), true),
        }
    }

    /// The Jacobian at the motion of the last evaluation, in the real unknowns.
    pub(crate) fn jacobian(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        buffers: &mut BalanceBuffers,
        matrix: &mut Mat<f64>,
    ) {
        let width = point.width();
        let size = self.size(width, slots);
        matrix.as_mut().submatrix_mut(0, 0, size, size).fill(0.0);
        for (column, &c) in point.active[..width - self.joint_rows].iter().enumerate() {
            self.transform_tangent(slots, c, buffers);
            let unit = self.contacts[c].scale * point.length[column] * homotopy.stretch / point.force[column];
            for p in 0..slots {
                for j in 0..slots {
                    let mut block = self.block(buffers, slots, p, j);
                    if homotopy.secant > 0.0 {
                        block = self.toward_secant(point, homotopy.secant, column, (p, j), unit, block);
                    }
                    for row in 0..width {
                        let entry = (p * width + row) * width + column;
                        let weight = homotopy.contact * unit * point.weight[p * width + row];
                        let factor = point.receptance[entry] * weight;
                        let (r, r_complex) = self.real_index(width, p, row);
                        let (k, k_complex) = self.real_index(width, j, column);
                        // The change of r_p by Re δW_j, and by Im δW_j.
                        let by_re = factor * block.0;
                        matrix[(r, k)] = by_re.re;
                        if r_complex {
                            matrix[(r + 1, k)] = by_re.im;
                        }
                        if k_complex {
                            let by_im = factor * block.1;
                            matrix[(r, k + 1)] = by_im.re;
                            if r_complex {
                                matrix[(r + 1, k + 1)] = by_im.im;
                            }
                        }
                    }
                }
            }
        }
        self.joint_jacobian(point, slots, homotopy, buffers, matrix);
        for slot in 0..slots {
            for row in 0..width {
                let (r, is_complex) = self.real_index(width, slot, row);
                let weight = point.weight[slot * width + row];
                matrix[(r, r)] += weight;
                if is_complex {
                    matrix[(r + 1, r + 1)] += weight;
                }
                self.take_back(point, slot, row, matrix);
            }
        }
    }

    /// The derivative of the contact forces alone, dimensionless and times μ, entry `[i][p][j]`; then that of the joints.
    pub(crate) fn blocks(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        buffers: &mut BalanceBuffers,
        blocks: &mut Vec<Block>,
    ) {
        blocks.clear();
        for (row, &c) in point.active[..point.width() - self.joint_rows].iter().enumerate() {
            self.transform_tangent(slots, c, buffers);
            let unit = self.contacts[c].scale * point.length[row] * homotopy.stretch / point.force[row];
            for (p, j) in (0..slots).flat_map(|p| (0..slots).map(move |j| (p, j))) {
                let mut block = self.block(buffers, slots, p, j);
                if homotopy.secant > 0.0 {
                    block = self.toward_secant(point, homotopy.secant, row, (p, j), unit, block);
                }
                let unit = homotopy.contact * unit;
                blocks.push((block.0 * unit, block.1 * unit));
            }
        }
        self.joint_blocks(point, slots, homotopy, buffers, blocks);
    }

    /// The derivative of −Ĝ Ŝ û.
    fn take_back(&self, point: &Point, slot: usize, row: usize, matrix: &mut Mat<f64>) {
        let width = point.width();
        let (r, is_complex) = self.real_index(width, slot, row);
        for column in 0..width {
            let lent = point.lent[slot * width + column];
            if lent == c64::ZERO {
                continue;
            }
            let entry = slot * width + row;
            let slope = point.receptance[entry * width + column] * lent * point.weight[entry];
            let (k, _) = self.real_index(width, slot, column);
            matrix[(r, k)] -= slope.re;
            if is_complex {
                matrix[(r, k + 1)] += slope.im;
                matrix[(r + 1, k)] -= slope.im;
                matrix[(r + 1, k + 1)] -= slope.re;
            }
        }
    }

    /// Fourier coefficients of the tangent of contact `index`.
    fn transform_tangent(&self, slots: usize, index: usize, buffers: &mut BalanceBuffers) {
        let contact = &mut buffers.contacts[index];
        let law = &self.contacts[index].law;
        buffers.influence.clear();
        buffers.recall.clear();
        buffers.rate.clear();
        let orders = &self.orders[..slots];
        if self.exact && law.piecewise_linear().is_some() {
            let series = contact.events.stiffness();
            buffers.local[..series.len()].copy_from_slice(series);
            for &recall in contact.events.memories(orders, &mut buffers.influence) {
                recalled(recall, orders, &mut buffers.recall);
            }
            return;
        }
        let motion = Motion {
            spectrum: &contact.spectrum,
            displacement: &contact.displacement,
            velocity: &contact.velocity,
            odd: self.odd,
            omega: contact.omega,
        };
        let tangent = law.tangent(&motion, &mut contact.law);
        buffers.local.copy_from_slice(self.transform.to_coefficients(&tangent.local, &mut buffers.fft));
        if let Some(rate) = tangent.rate() {
            buffers.rate.extend_from_slice(self.transform.to_coefficients(rate, &mut buffers.fft));
        }
        for memory in tangent.memories() {
            let coefficients = self.transform.to_coefficients(&memory.influence, &mut buffers.fft);
            let one_sided = |order: usize| if order == 0 { 1.0 } else { 2.0 };
            buffers.influence.extend(orders.iter().map(|&order| coefficients[order] * one_sided(order)));
            recalled(memory.recall, orders, &mut buffers.recall);
        }
    }

    /// `block` with a share of it replaced by the secant stiffness, in the units of `block` (`unit` makes them
    /// dimensionless).
    fn toward_secant(
        &self,
        point: &Point,
        share: f64,
        row: usize,
        (p, j): (usize, usize),
        unit: f64,
        block: (c64, c64),
    ) -> (c64, c64) {
        let own = if p == j { point.secant_stiffness(row, self.orders[p]) / unit } else { c64::ZERO };
        let turned = c64::new(-own.im, own.re);
        (block.0 + (own - block.0) * share, block.1 + (turned - block.1) * share)
    }

    /// δF_p by a change of Re W_j and of Im W_j, in N/m.
    #[inline]
    fn block(&self, buffers: &BalanceBuffers, slots: usize, p: usize, j: usize) -> Block {
        let (order_p, order_j) = (self.orders[p], self.orders[j]);
        let epsilon = if order_p == 0 { 0.5 } else { 1.0 };
        let (mut by_re, mut by_im) = convolved(&buffers.local, order_p, order_j, epsilon);
        if !buffers.rate.is_empty() {
            // δ(dw/dτ) = Re ij δW_j e^{ijτ}: Re δW_j acts like Im, Im δW_j like −Re.
            let (re, im) = convolved(&buffers.rate, order_p, order_j, epsilon * order_j as f64);
            by_re += im;
            by_im -= re;
        }
        let memories = buffers.recall.len() / slots;
        for memory in 0..memories {
            let influence = buffers.influence[memory * slots + p];
            let (re, im) = buffers.recall[memory * slots + j];
            by_re += influence * re;
            by_im += influence * im;
        }
        (by_re, by_im)
    }
}

/// `ε [δW_j K_{p−j} + conj(δW_j) K_{p+j}]` for δW_j = 1 and δW_j = i.
#[inline]
fn convolved(coefficients: &[c64], p: usize, j: usize, epsilon: f64) -> (c64, c64) {
    let difference = if p >= j { coefficients[p - j] } else { coefficients[j - p].conj() };
    let sum = coefficients[p + j];
    let rotated = difference - sum;
    ((difference + sum) * epsilon, c64::new(-rotated.im, rotated.re) * epsilon)
}

/// What a functional makes of the harmonics `orders`: the coefficients of Re δW and Im δW, appended to `coefficients`.
fn recalled(recall: Recall, orders: &[usize], coefficients: &mut Vec<(f64, f64)>) {
    let tau = match recall {
        Recall::Displacement { tau } | Recall::Velocity { tau } => tau,
        Recall::Mean => {
            return coefficients.extend(orders.iter().map(|&k| (if k == 0 { 1.0 } else { 0.0 }, 0.0)));
        }
    };
    let turn = c64::cis(tau);
    let mut reached = 0;
    let mut wave = c64::ONE;
    for &order in orders {
        while reached < order {
            wave *= turn;
            reached += 1;
        }
        // Re(δW e^{ikτ}) or Re(ik δW e^{ikτ}).
        coefficients.push(match recall {
            Recall::Velocity { .. } => (-(order as f64) * wave.im, -(order as f64) * wave.re),
            _ => (wave.re, -wave.im),
        });
    }
}
