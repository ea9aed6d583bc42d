//! Forces of joints in the balance: all directions of a joint to time, its law there, and back.
//!
//! The derivative is made of what the law answers to every harmonic of every direction: with `δf_r(τ)` the change of the force
//! in direction r by `δw_c(τ) = Re(δW e^{ijτ})`, the two-sided coefficients of `δf_r` at p are those of a block as a scalar
//! contact has one, here one for every pair of directions (r, c). A law that is piecewise linear answers by its events instead.

use contact::{Coupling, JointChange, JointMarks, JointMotion, JointWorkspace, LawError, Motion};
use faer::{Mat, c64};

use crate::balance::{Balance, BalanceBuffers, Homotopy, LADDER_STEP};
use crate::jacobian::Block;
use crate::pieces::PieceSeries;
use crate::point::Point;
use crate::problem::Joint;
use crate::rows::joint_rows;
use crate::transform::{Buffers, Transform};

/// Buffers of one joint; everything in time has an entry `[direction][j]`.
#[derive(Debug)]
pub(crate) struct JointBuffers {
    pub(crate) law: Box<dyn JointWorkspace>,
    /// Highest harmonic of the motion, and one.
    pub(crate) harmonics: usize,
    /// W_0 … W_n in m, entry `[direction][k]`.
    pub(crate) spectrum: Vec<c64>,
    pub(crate) displacement: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    force: Vec<f64>,
    /// Of a law that is evaluated by its events: what couples to what, and the series of each.
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) series: Vec<PieceSeries>,
    pub(crate) marks: JointMarks,
}

/// Buffers of the derivative, shared by all joints.
#[derive(Debug)]
pub(crate) struct JointDerivative {
    /// cos τ_j.
    cosine: Vec<f64>,
    /// δw at samples, and δf with an entry `[direction][j]`.
    change: Vec<f64>,
    answer: Vec<f64>,
    /// In N/m, entry `[c][j][r][p]`: by direction and harmonic of the motion, then of the force.
    pub(crate) blocks: Vec<Block>,
    /// Influences of the memories of a series, entry `[memory][p]` in N/m.
    pub(crate) influences: Vec<c64>,
}

impl JointDerivative {
    pub(crate) fn new(samples: usize, joints: &[Joint]) -> Self {
        let directions = joints.iter().map(|joint| joint.directions.len()).max().unwrap_or(0);
        let samples = if directions > 0 { samples } else { 0 };
        let angle = |j: usize| std::f64::consts::TAU * j as f64 / samples as f64;
        Self {
            cosine: (0..samples).map(|j| angle(j).cos()).collect(),
            change: vec![0.0; samples],
            answer: vec![0.0; directions * samples],
            blocks: Vec::new(),
            influences: Vec::new(),
        }
    }

    /// Samples of `Re(δW e^{ikτ})` for δW = 1 or δW = i.
    fn load_wave(&mut self, order: usize, imaginary: bool) {
        let samples = self.cosine.len();
        // −sin x = cos(x + π/2), and a quarter of a period is a whole number of samples.
        let first = if imaginary { samples / 4 } else { 0 };
        for (j, change) in self.change.iter_mut().enumerate() {
            *change = self.cosine[(order * j + first) % samples];
        }
    }
}

impl JointBuffers {
    pub(crate) fn new(joint: &Joint, samples: usize, highest: usize) -> Self {
        let directions = joint.directions.len();
        let in_time = || vec![0.0; directions * samples];
        let events = joint.law.piecewise_linear().or_else(|| joint.law.partly_piecewise_linear());
        let couplings = events.map_or(Vec::new(), |events| events.couplings());
        Self {
            series: couplings.iter().map(|_| PieceSeries::default()).collect(),
            couplings,
            law: joint.law.workspace(samples),
            harmonics: highest + 1,
            spectrum: vec![c64::ZERO; directions * (highest + 1)],
            displacement: in_time(),
            velocity: in_time(),
            force: in_time(),
            marks: JointMarks::default(),
        }
    }

    pub(crate) fn directions(&self) -> usize {
        self.spectrum.len() / self.harmonics
    }

    /// The motion in one direction at the last evaluation.
    pub(crate) fn motion_in(&self, direction: usize) -> Motion<'_> {
        let samples = self.displacement.len() / self.directions();
        let in_time = direction * samples..(direction + 1) * samples;
        Motion {
            spectrum: &self.spectrum[direction * self.harmonics..(direction + 1) * self.harmonics],
            displacement: &self.displacement[in_time.clone()],
            velocity: &self.velocity[in_time],
            odd: false,
            omega: 0.0,
        }
    }

    /// The force for the motion in `spectrum`.
    fn evaluate(&mut self, joint: &Joint, transform: &Transform, fft: &mut Buffers) -> Result<(), LawError> {
        let samples = transform.samples();
        let rows = self.displacement.chunks_exact_mut(samples).zip(self.velocity.chunks_exact_mut(samples));
        for ((displacement, velocity), spectrum) in rows.zip(self.spectrum.chunks_exact(self.harmonics)) {
            let spectrum = spectrum.iter().copied();
            let rates = spectrum.clone().enumerate().map(|(k, w)| c64::new(-w.im, w.re) * k as f64);
            transform.to_time(spectrum, displacement, fft);
            transform.to_time(rates, velocity, fft);
        }
        let motion = JointMotion {
            directions: joint.directions.len(),
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
        };
        self.marks = joint.law.force(&motion, &mut *self.law, &mut self.force)?;
        Ok(())
    }
}

impl Balance<'_> {
    /// Force harmonics in the rows of all joints.
    pub(crate) fn joint_forces(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        unknowns: &[c64],
        buffers: &mut BalanceBuffers,
    ) -> Result<(), LawError> {
        let width = point.width();
        let highest = self.orders[..slots].last().copied().unwrap_or(0);
        let rows = joint_rows(width - self.joint_rows, self.joints);
        for ((joint, rows), own) in rows.zip(&mut buffers.joints) {
            own.harmonics = highest + 1;
            own.spectrum.clear();
            own.spectrum.resize(rows.len() * own.harmonics, c64::ZERO);
            for (direction, row) in rows.clone().enumerate() {
                let unit = point.length[row] * homotopy.stretch;
                for (slot, &order) in self.orders.iter().enumerate().take(slots) {
                    own.spectrum[direction * own.harmonics + order] = unknowns[slot * width + row] * unit;
                }
            }
            if let Some(events) = joint.law.piecewise_linear().filter(|_| self.exact) {
                own.evaluate_events(events, self.transform, &mut buffers.fft)?;
                for (direction, row) in rows.enumerate() {
                    let unit = joint.scale / point.force[row];
                    for slot in 0..slots {
                        let force = own.force_by_events(direction, &self.orders[..slots], slot);
                        buffers.forces[slot * width + row] = force * unit;
                    }
                    self.blend_secant(point, slots, homotopy, row, unknowns, &mut buffers.forces);
                }
                continue;
            }
            own.evaluate(joint, self.transform, &mut buffers.fft)?;
            if let Some(events) = joint.law.partly_piecewise_linear().filter(|_| self.exact) {
                own.evaluate_part(events)?;
            }
            let samples = self.transform.samples();
            for (direction, row) in rows.enumerate() {
                let force = &own.force[direction * samples..(direction + 1) * samples];
                let coefficients = self.transform.to_coefficients(force, &mut buffers.fft);
                let unit = joint.scale / point.force[row];
                // Beyond the motion's harmonics as well: what the next rung of a ladder begins with.
                let known = self.orders.iter().enumerate().take(LADDER_STEP * slots + 1);
                for (slot, &order) in known.take_while(|(_, order)| 2 * **order < self.transform.samples()) {
                    let one_sided = if order == 0 { 1.0 } else { 2.0 };
                    buffers.forces[slot * width + row] = coefficients[order] * (one_sided * unit);
                }
                if self.exact && own.has_events(direction) {
                    for slot in 0..slots {
                        let force = own.force_by_events(direction, &self.orders[..slots], slot);
                        buffers.forces[slot * width + row] = force * unit;
                    }
                }
                self.blend_secant(point, slots, homotopy, row, unknowns, &mut buffers.forces);
            }
        }
        Ok(())
    }

    /// Fills `blocks` with the derivative of joint `index` at the motion of the last evaluation.
    fn differentiate(&self, slots: usize, index: usize, buffers: &mut BalanceBuffers) {
        let BalanceBuffers { joints, derivative, fft, .. } = buffers;
        let (joint, own) = (&self.joints[index], &mut joints[index]);
        let (directions, samples) = (joint.directions.len(), self.transform.samples());
        let motion = JointMotion {
            directions,
            spectrum: &own.spectrum,
            displacement: &own.displacement,
            velocity: &own.velocity,
        };
        derivative.blocks.clear();
        derivative.blocks.resize((directions * slots).pow(2), (c64::ZERO, c64::ZERO));
        if self.exact && joint.law.piecewise_linear().is_some() {
            derivative.by_events(own, &self.orders[..slots]);
            return;
        }
        for direction in 0..directions {
            for (j, &order) in self.orders.iter().enumerate().take(slots) {
                for imaginary in [false, true] {
                    // The mean is real.
                    if imaginary && order == 0 {
                        continue;
                    }
                    derivative.load_wave(order, imaginary);
                    let JointDerivative { change, answer, blocks, .. } = &mut *derivative;
                    let amplitude = if imaginary { c64::I } else { c64::ONE };
                    let change = JointChange { direction, order, amplitude, displacement: change };
                    let answer = &mut answer[..directions * samples];
                    joint.law.derivative(&motion, &change, &mut *own.law, answer);
                    let first = (direction * slots + j) * directions * slots;
                    for (answer, blocks) in
                        answer.chunks_exact(samples).zip(blocks[first..].chunks_exact_mut(slots))
                    {
                        let coefficients = self.transform.to_coefficients(answer, fft);
                        for (block, &order) in blocks.iter_mut().zip(self.orders) {
                            let one_sided = if order == 0 { 1.0 } else { 2.0 };
                            let part = if imaginary { &mut block.1 } else { &mut block.0 };
                            *part = coefficients[order] * one_sided;
                        }
                    }
                }
            }
        }
        if self.exact && joint.law.partly_piecewise_linear().is_some() {
            for (index, blocks) in derivative.blocks.chunks_exact_mut(slots).enumerate() {
                if own.has_events(index % directions) {
                    blocks.fill((c64::ZERO, c64::ZERO));
                }
            }
            derivative.by_events(own, &self.orders[..slots]);
        }
    }

    /// Block δF_{r,p}/δW_{c,j} of the joint differentiated last, dimensionless and times μ; its rows begin at `first`.
    #[inline]
    fn joint_block(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        (index, first): (usize, usize),
        ((r, p), (c, j)): ((usize, usize), (usize, usize)),
        buffers: &BalanceBuffers,
    ) -> Block {
        let joint = &self.joints[index];
        let directions = joint.directions.len();
        let unit = joint.scale * point.length[first + c] * homotopy.stretch / point.force[first + r];
        let (re, im) = buffers.derivative.blocks[((c * slots + j) * directions + r) * slots + p];
        let (mut re, mut im) = (re * unit, im * unit);
        if homotopy.secant > 0.0 {
            let own = match (r, p) == (c, j) {
                true => point.secant_stiffness(first + r, self.orders[p]),
                false => c64::ZERO,
            };
            re += (own - re) * homotopy.secant;
            im += (c64::new(-own.im, own.re) - im) * homotopy.secant;
        }
        (re * homotopy.contact, im * homotopy.contact)
    }

    /// What joints add to the Jacobian: a change in one direction is felt in all of them.
    pub(crate) fn joint_jacobian(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        buffers: &mut BalanceBuffers,
        matrix: &mut Mat<f64>,
    ) {
        let width = point.width();
        for (index, (_, rows)) in joint_rows(width - self.joint_rows, self.joints).enumerate() {
            self.differentiate(slots, index, buffers);
            let (first, directions) = (rows.start, rows.len());
            let pairs = (0..slots).flat_map(|p| (0..slots).map(move |j| (p, j)));
            for ((p, j), c) in pairs.flat_map(|pair| (0..directions).map(move |c| (pair, c))) {
                for r in 0..directions {
                    let at = ((r, p), (c, j));
                    let block = self.joint_block(point, slots, homotopy, (index, first), at, buffers);
                    for row in 0..width {
                        let receptance = point.receptance[(p * width + row) * width + first + r];
                        let factor = receptance * point.weight[p * width + row];
                        let by = (factor * block.0, factor * block.1);
                        self.add(width, ((p, row), (j, first + c)), by, matrix);
                    }
                }
            }
        }
    }

    /// Adds the change of r_p by Re δW_j and by Im δW_j, entries (slot, row).
    fn add(
        &self,
        width: usize,
        ((p, row), (j, column)): ((usize, usize), (usize, usize)),
        by: Block,
        matrix: &mut Mat<f64>,
    ) {
        let (r, r_complex) = self.real_index(width, p, row);
        let (k, k_complex) = self.real_index(width, j, column);
        matrix[(r, k)] += by.0.re;
        if r_complex {
            matrix[(r + 1, k)] += by.0.im;
        }
        if k_complex {
            matrix[(r, k + 1)] += by.1.re;
            if r_complex {
                matrix[(r + 1, k + 1)] += by.1.im;
            }
        }
    }

    /// Appends the blocks of all joints, entry `[r][c][p][j]` for each of them.
    pub(crate) fn joint_blocks(
        &self,
        point: &Point,
        slots: usize,
        homotopy: Homotopy,
        buffers: &mut BalanceBuffers,
        blocks: &mut Vec<Block>,
    ) {
        for (index, (_, rows)) in joint_rows(point.width() - self.joint_rows, self.joints).enumerate() {
            self.differentiate(slots, index, buffers);
            for (r, c) in (0..rows.len()).flat_map(|r| (0..rows.len()).map(move |c| (r, c))) {
                for (p, j) in (0..slots).flat_map(|p| (0..slots).map(move |j| (p, j))) {
                    let at = ((r, p), (c, j));
                    blocks.push(self.joint_block(point, slots, homotopy, (index, rows.start), at, buffers));
                }
            }
        }
    }

    /// (row of the force, row of the motion) of every block that [`Balance::blocks`] makes, in its order.
    pub(crate) fn couplings(&self, width: usize, couplings: &mut Vec<(usize, usize)>) {
        let scalar = width - self.joint_rows;
        couplings.clear();
        couplings.extend((0..scalar).map(|row| (row, row)));
        for (_, rows) in joint_rows(scalar, self.joints) {
            couplings.extend(rows.clone().flat_map(|r| rows.clone().map(move |c| (r, c))));
        }
    }
}
