//! Jacobian of the balance.
//!
//! It is structured (tangent + memory): with the two-sided coefficients `K_q` of the local stiffness κ(τ)
//! and the one-sided ones `S_{r,p}` of each memory's influence,
//!
//! ```text
//! δF_p = ε_p [δW_j K_{p−j} + conj(δW_j) K_{p+j}] + Σ_r S_{r,p} recall_r(δW_j),   ε_0 = ½, ε_p = 1
//! ```
//!
//! A rate-dependent law adds `ε_p [ij δW_j C_{p−j} + conj(ij δW_j) C_{p+j}]` with the coefficients `C_q` of
//! c(τ) = ∂f/∂(dw/dτ).

use contact::{Motion, Recall};
use faer::{Mat, c64};

use crate::balance::{Balance, BalanceBuffers, Homotopy};
use crate::point::Point;

/// Change of one harmonic of a contact force by the real and by the imaginary part of one harmonic of the displacement.
pub(crate) type Block = (c64, c64);

/// Fourier coefficients of the tangent of one contact.
#[derive(Debug)]
pub(crate) struct TangentSeries {
    /// K_q of one contact.
    local: Vec<c64>,
    /// C_q of one contact; empty when its law does not depend on the velocity.
    rate: Vec<c64>,
    /// S_{r,p} of one contact, entry `[memory][slot]`.
    influence: Vec<c64>,
    /// Coefficients (of Re δW_j, of Im δW_j) of each recalled functional, entry `[memory][slot]`.
    recall: Vec<(f64, f64)>,
}

impl TangentSeries {
    /// For spectra of so many samples.
    pub(crate) fn new(samples: usize) -> Self {
        Self {
            local: vec![c64::ZERO; samples / 2 + 1],
            rate: Vec::new(),
            influence: Vec::new(),
            recall: Vec::new(),
        }
    }

    /// δF_p by a change of Re W_j and of Im W_j, in N/m.
    #[inline]
    fn block(&self, orders: &[usize], p: usize, j: usize) -> Block {
        let (order_p, order_j) = (orders[p], orders[j]);
        let slots = orders.len();
        let epsilon = if order_p == 0 { 0.5 } else { 1.0 };
        let (mut by_re, mut by_im) = convolved(&self.local, order_p, order_j, epsilon);
        if !self.rate.is_empty() {
            // δ(dw/dτ) = Re ij δW_j e^{ijτ}: Re δW_j acts like Im, Im δW_j like −Re.
            let (re, im) = convolved(&self.rate, order_p, order_j, epsilon * order_j as f64);
            by_re += im;
            by_im -= re;
        }
        let memories = self.recall.len() / slots;
        for memory in 0..memories {
            let influence = self.influence[memory * slots + p];
            let (re, im) = self.recall[memory * slots + j];
            by_re += influence * re;
            by_im += influence * im;
        }
        (by_re, by_im)
    }
}

impl Balance<'_> {
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
                    let mut block = buffers.tangent.block(&self.orders[..slots], p, j);
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
                let mut block = buffers.tangent.block(&self.orders[..slots], p, j);
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
        let BalanceBuffers { contacts, tangent: series, fft, .. } = buffers;
        let contact = &mut contacts[index];
        let law = &self.contacts[index].law;
        series.influence.clear();
        series.recall.clear();
        series.rate.clear();
        let orders = &self.orders[..slots];
        if self.exact && law.piecewise_linear().is_some() {
            let stiffness = contact.events.stiffness();
            series.local[..stiffness.len()].copy_from_slice(stiffness);
            for &recall in contact.events.memories(orders, &mut series.influence) {
                recalled(recall, orders, &mut series.recall);
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
        series.local.copy_from_slice(self.transform.to_coefficients(&tangent.local, fft));
        if let Some(rate) = tangent.rate() {
            series.rate.extend_from_slice(self.transform.to_coefficients(rate, fft));
        }
        for memory in tangent.memories() {
            let coefficients = self.transform.to_coefficients(&memory.influence, fft);
            let one_sided = |order: usize| if order == 0 { 1.0 } else { 2.0 };
            series.influence.extend(orders.iter().map(|&order| coefficients[order] * one_sided(order)));
            recalled(memory.recall, orders, &mut series.recall);
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
