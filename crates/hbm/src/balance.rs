//! Residual of the balance: contact forces at samples (alternating frequency–time), or by their events.

use contact::{LawError, Marks, Motion};
use faer::c64;

use crate::jacobian::TangentSeries;
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
pub(crate) struct ContactBuffers {
    pub(crate) law: contact::Workspace,
    /// W_0 … W_n in m.
    pub(crate) spectrum: Vec<c64>,
    pub(crate) displacement: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    force: Vec<f64>,
    /// The force by its events, where no samples are needed.
    pub(crate) events: PieceSeries,
    marks: Option<Marks>,
    pub(crate) omega: f64,
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
    pub(crate) contacts: Vec<ContactBuffers>,
    pub(crate) joints: Vec<JointBuffers>,
    pub(crate) derivative: JointDerivative,
    pub(crate) fft: Buffers,
    /// F̂, entry `[slot][i]` over active rows.
    pub(crate) forces: Vec<c64>,
    /// What the structure feels of them, likewise.
    felt: Vec<c64>,
    /// r, likewise.
    pub(crate) residual: Vec<c64>,
    pub(crate) tangent: TangentSeries,
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
            tangent: TangentSeries::new(samples),
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
}
