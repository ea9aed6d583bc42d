//! A solution in time: one period of displacements and contact forces.

use std::f64::consts::TAU;

use contact::{ContactState, JointMotion, LawError, Motion};
use num_complex::Complex64;

use crate::plan::Plan;
use crate::solution::{ContactSolution, JointSolution, Solution, Waveform, WaveformContact, WaveformJoint};
use crate::transform::Transform;

impl Plan {
    /// One period of `solution` at `samples` equidistant instants or a few more (a multiple of the reduced period,
    /// and enough for its harmonics); `None` when the point failed.
    pub fn waveform(&self, solution: &Solution, samples: usize) -> Option<Waveform> {
        if !solution.status.solved() {
            return None;
        }
        let repeats = self.harmonics.fundamental;
        let least = samples.div_ceil(repeats).max(4 * (self.harmonics.asked + 1));
        let transform = Transform::new(least + least % 2);
        let total = transform.samples() * repeats;
        let in_time = |slots: &[Complex64]| repeat(&self.sampled(&transform, slots, 0), repeats);
        let omega = TAU * solution.frequency * repeats as f64;
        let contacts = self.contacts.iter().zip(&solution.contacts);
        Some(Waveform {
            phase: (0..total).map(|j| TAU * j as f64 / total as f64).collect(),
            displacement: solution.displacement.iter().map(|row| in_time(row)).collect(),
            contacts: contacts
                .map(|(contact, report)| WaveformContact {
                    displacement: in_time(&report.displacement),
                    force: match self.law_force(&transform, omega, contact, report) {
                        Some(force) => repeat(&force, repeats),
                        None => in_time(&report.force),
                    },
                })
                .collect(),
            joints: (self.joints.iter().zip(&solution.joints))
                .map(|(joint, report)| self.joint_waveform(&transform, repeats, joint, report))
                .collect(),
        })
    }

    /// Displacements and the law's own forces; the series of the forces where the law has none at these instants.
    fn joint_waveform(
        &self,
        transform: &Transform,
        repeats: usize,
        joint: &crate::Joint,
        report: &JointSolution,
    ) -> WaveformJoint {
        let samples = transform.samples();
        let rows = || report.directions.iter().map(|direction| &direction.displacement);
        let in_time =
            |order: i32| -> Vec<f64> { rows().flat_map(|row| self.sampled(transform, row, order)).collect() };
        let motion = JointMotion {
            directions: report.directions.len(),
            spectrum: &rows().flat_map(|row| self.dense(row, 0)).collect::<Vec<_>>(),
            displacement: &in_time(0),
            velocity: &in_time(1),
        };
        let mut force = vec![0.0; motion.displacement.len()];
        let mut workspace = joint.law.workspace(samples);
        match joint.law.force(&motion, &mut *workspace, &mut force) {
            Ok(_) => force.iter_mut().for_each(|f| *f *= -joint.scale),
            Err(_) => {
                let series = report.directions.iter().flat_map(|d| self.sampled(transform, &d.force, 0));
                force = series.collect();
            }
        }
        let repeated =
            |signal: &[f64]| signal.chunks_exact(samples).map(|row| repeat(row, repeats)).collect();
        WaveformJoint { displacement: repeated(motion.displacement), force: repeated(&force) }
    }

    /// Harmonics of the base frequency 0..=n from the plan's slots, differentiated `order` times.
    pub(crate) fn dense(&self, slots: &[Complex64], order: i32) -> Vec<Complex64> {
        let mut spectrum = vec![Complex64::ZERO; self.harmonics.asked + 1];
        for (&k, &amplitude) in self.harmonics.reduced.iter().zip(slots) {
            if let Some(entry) = spectrum.get_mut(k) {
                *entry = amplitude * Complex64::new(0.0, k as f64).powi(order);
            }
        }
        spectrum
    }

    fn sampled(&self, transform: &Transform, slots: &[Complex64], order: i32) -> Vec<f64> {
        let mut samples = vec![0.0; transform.samples()];
        transform.to_time(self.dense(slots, order).into_iter(), &mut samples, &mut transform.buffers());
        samples
    }

    /// The law's own force on the first body over a base period; `None` at rest, where it is the holding force.
    fn law_force(
        &self,
        transform: &Transform,
        omega: f64,
        contact: &crate::Contact,
        report: &ContactSolution,
    ) -> Option<Vec<f64>> {
        if report.state == ContactState::Held {
            return None;
        }
        let motion = Motion {
            spectrum: &self.dense(&report.displacement, 0),
            displacement: &self.sampled(transform, &report.displacement, 0),
            velocity: &self.sampled(transform, &report.displacement, 1),
            odd: self.harmonics.odd,
            omega,
        };
        let mut force = vec![0.0; transform.samples()];
        let mut workspace = contact::Workspace::new(transform.samples());
        let evaluated: Result<_, LawError> = contact.law.force(&motion, &mut workspace, &mut force);
        evaluated.ok()?;
        Some(force.iter().map(|f| -f * contact.scale).collect())
    }
}

fn repeat(signal: &[f64], times: usize) -> Vec<f64> {
    signal.iter().copied().cycle().take(signal.len() * times).collect()
}
