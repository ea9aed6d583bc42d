//! Forces of joints that are piecewise linear, by their events: a series of pieces for every pair of directions that the law
//! couples, and no samples.

use contact::{JointMotion, JointPiecewiseLinear, LawError, Recall};
use faer::c64;

use crate::joint_force::{JointBuffers, JointDerivative};
use crate::transform::{Buffers, Transform};

impl JointBuffers {
    /// The series of the motion in `spectrum`. Only the velocity is needed at samples.
    pub(crate) fn evaluate_events(
        &mut self,
        events: &dyn JointPiecewiseLinear,
        transform: &Transform,
        fft: &mut Buffers,
    ) -> Result<(), LawError> {
        let rows = self.velocity.chunks_exact_mut(transform.samples());
        for (velocity, spectrum) in rows.zip(self.spectrum.chunks_exact(self.harmonics)) {
            let rates = spectrum.iter().enumerate().map(|(k, w)| c64::new(-w.im, w.re) * k as f64);
            transform.to_time(rates, velocity, fft);
        }
        let motion = JointMotion {
            directions: self.directions(),
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
        };
        self.marks = events.pieces(&motion, &mut *self.law, &mut self.couplings)?;
        self.integrate();
        Ok(())
    }

    /// The series of those directions that need no samples, beside the others that were evaluated just before.
    pub(crate) fn evaluate_part(&mut self, events: &dyn JointPiecewiseLinear) -> Result<(), LawError> {
        let motion = JointMotion {
            directions: self.directions(),
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
        };
        self.marks.apart = events.pieces(&motion, &mut *self.law, &mut self.couplings)?.apart;
        self.integrate();
        Ok(())
    }

    fn integrate(&mut self) {
        for (series, coupling) in self.series.iter_mut().zip(&self.couplings) {
            series.pieces.clone_from(&coupling.pieces);
            let of = coupling.displacement * self.harmonics;
            let spectrum = &self.spectrum[of..of + self.harmonics];
            series.integrate(spectrum, self.harmonics - 1, false);
        }
    }

    /// Whether the force in a direction comes from its events.
    pub(crate) fn has_events(&self, direction: usize) -> bool {
        self.couplings.iter().any(|coupling| coupling.force == direction)
    }

    /// The force harmonics at `orders[slot]` in one direction by the series of the last evaluation, in N.
    pub(crate) fn force_by_events(&self, direction: usize, orders: &[usize], slot: usize) -> c64 {
        let spectra = |of: usize| &self.spectrum[of * self.harmonics..(of + 1) * self.harmonics];
        self.series
            .iter()
            .zip(&self.couplings)
            .filter(|(_, coupling)| coupling.force == direction)
            .map(|(series, coupling)| series.force(spectra(coupling.displacement), orders, slot))
            .sum()
    }
}

impl JointDerivative {
    /// `δF_p = ε_p [δW_j K_{p−j} + conj(δW_j) K_{p+j}] + Σ_r S_{r,p} recall_r(δw)` of every coupling, for δW_j = 1 and i.
    pub(crate) fn by_events(&mut self, own: &mut JointBuffers, orders: &[usize]) {
        let (slots, directions) = (orders.len(), own.directions());
        for (series, coupling) in own.series.iter_mut().zip(&own.couplings) {
            let at = |j: usize| ((coupling.displacement * slots + j) * directions + coupling.force) * slots;
            for (j, &order) in orders.iter().enumerate() {
                let row = &mut self.blocks[at(j)..at(j) + slots];
                for (block, &p) in row.iter_mut().zip(orders) {
                    let stiffness = series.stiffness();
                    let below = if p >= order { stiffness[p - order] } else { stiffness[order - p].conj() };
                    let above = stiffness[p + order];
                    let half = if p == 0 { 0.5 } else { 1.0 };
                    block.0 += (below + above) * half;
                    block.1 += c64::I * (below - above) * half;
                }
            }
            self.influences.clear();
            let recalls = series.memories(orders, &mut self.influences);
            for (recall, influences) in recalls.iter().zip(self.influences.chunks_exact(slots.max(1))) {
                for (j, &order) in orders.iter().enumerate() {
                    let k = order as f64;
                    let wave = match *recall {
                        Recall::Displacement { tau } => c64::cis(k * tau),
                        Recall::Velocity { tau } => c64::new(0.0, k) * c64::cis(k * tau),
                        Recall::Mean if order == 0 => c64::ONE,
                        Recall::Mean => c64::ZERO,
                    };
                    for (block, influence) in self.blocks[at(j)..at(j) + slots].iter_mut().zip(influences) {
                        block.0 += influence * wave.re;
                        block.1 -= influence * wave.im;
                    }
                }
            }
        }
    }
}
