//! A measured friction loop under a normal load that the motion changes.

use num_complex::Complex64;

use crate::error::{LawError, ParameterError};
use crate::joint::{JointChange, JointLaw, JointMarks, JointMotion, JointWorkspace};
use crate::law::{ContactState, DescribingFunction, Law, Motion, Workspace};
use crate::normal_contact::NormalContact;
use crate::scaled_loop::ScaledLoop;
use crate::tangent::Recall;

/// A scaled loop whose force is proportional to the instantaneous normal load N(τ), over the load N* under which the loop was
/// measured, in one tangential direction, and a unilateral normal spring:
///
/// ```text
/// f_t(τ) = F_loop(w_t)(τ) · N(τ)/N*,   f_n as in NormalContact
/// ```
///
/// The assumption is that the shape of the loop in the displacement does not change with the load. It is good for contacts that
/// mostly slip, whose force is μN. It is not what a Coulomb slider behind a spring does, whose slip displacement μN/k_t grows with
/// the load while its stiffness k_t does not: here the stiffness grows and the slip displacement stays. Nor does the loop know of
/// separation: its memory goes on while the bodies are apart.
///
/// **This law is not passive.** Under a constant load it dissipates as the loop does; but a spring whose stiffness follows the
/// load gives energy when it is stiffer on the way back to the middle than on the way out, and the friction of a loop that
/// hardly slips does not make up for that. The dissipation ∮ f_t dw of a motion is then negative, which no contact can do: the assumption does
/// not hold for this motion.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedLoop {
    scaled: ScaledLoop,
    normal: NormalContact,
    /// N* in N.
    reference: f64,
}

#[derive(Debug)]
struct Buffers {
    law: Workspace,
    /// F_loop at every sample in N.
    force: Vec<f64>,
    /// N at every sample in N, not negative.
    load: Vec<f64>,
    /// Nothing presses: there is no loop either.
    apart: bool,
}

impl JointWorkspace for Buffers {
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

impl LoadedLoop {
    /// The loop `scaled` that was measured under the load `reference` N* in N, above the spring `normal`.
    ///
    /// # Errors
    /// [`ParameterError`] when N* is not positive.
    pub fn new(scaled: ScaledLoop, normal: NormalContact, reference: f64) -> Result<Self, ParameterError> {
        ParameterError::positive("reference", reference)?;
        Ok(Self { scaled, normal, reference })
    }

    /// The loop under the load N*.
    pub fn scaled(&self) -> &ScaledLoop {
        &self.scaled
    }
}

/// The tangential motion as a scalar law sees it. Loops do not depend on the rate.
fn tangential<'a>(motion: &JointMotion<'a>) -> Motion<'a> {
    Motion {
        spectrum: motion.spectrum_of(0),
        displacement: motion.displacement_of(0),
        velocity: motion.velocity_of(0),
        odd: false,
        omega: 0.0,
    }
}

/// What a functional of the motion gives for a change of it.
fn recalled(recall: Recall, change: &JointChange) -> f64 {
    let order = change.order as f64;
    match recall {
        Recall::Displacement { tau } => (change.amplitude * Complex64::cis(order * tau)).re,
        Recall::Velocity { tau } => {
            (change.amplitude * Complex64::new(0.0, order) * Complex64::cis(order * tau)).re
        }
        Recall::Mean if change.order == 0 => change.amplitude.re,
        Recall::Mean => 0.0,
    }
}

impl JointLaw for LoadedLoop {
    fn name(&self) -> &'static str {
        "scaled_loop"
    }

    fn directions(&self) -> usize {
        2
    }

    /// W*, and N/k_n with the load N at rest.
    fn length(&self, direction: usize) -> f64 {
        if direction == 0 {
            self.scaled.reference_displacement()
        } else {
            self.normal.load_at_rest() / self.normal.stiffness()
        }
    }

    /// The secant stiffness of the loop under N* at W*: at its tips a loop is as stiff as it likes.
    fn stiffness(&self, direction: usize) -> f64 {
        if direction == 0 {
            let a = self.scaled.reference_displacement();
            self.scaled.first_harmonic(a).force.norm() / a
        } else {
            self.normal.stiffness()
        }
    }

    fn samples(&self, harmonics: usize) -> usize {
        Law::samples(&self.scaled, harmonics)
    }

    fn workspace(&self, samples: usize) -> Box<dyn JointWorkspace> {
        Box::new(Buffers {
            law: Workspace::new(samples),
            force: vec![0.0; samples],
            load: vec![0.0; samples],
            apart: true,
        })
    }

    /// The tangent of the loop is made here too, so that a derivative only multiplies.
    fn force(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        force: &mut [f64],
    ) -> Result<JointMarks, LawError> {
        let samples = motion.samples();
        let buffers = workspace.as_any_mut().downcast_mut::<Buffers>().ok_or(LawError::OtherWorkspace)?;
        let fits = motion.directions == 2 && buffers.load.len() == samples;
        if !fits || force.len() != motion.displacement.len() {
            return Err(LawError::OtherWorkspace);
        }
        if motion.displacement.iter().any(|w| !w.is_finite()) {
            return Err(LawError::NotFinite);
        }
        let (row, normal) = force.split_at_mut(samples);
        for ((f, load), &n) in normal.iter_mut().zip(&mut buffers.load).zip(motion.displacement_of(1)) {
            *load = self.normal.load(n);
            *f = self.normal.force(*load);
        }
        let apart = NormalContact::apart(&buffers.load);
        buffers.apart = buffers.load.iter().all(|load| *load <= 0.0);
        if buffers.apart {
            row.fill(0.0);
            return Ok(JointMarks { state: ContactState::Apart, apart, cycles: 1, extrapolated: false });
        }
        let scalar = tangential(motion);
        let marks = self.scaled.force(&scalar, &mut buffers.law, &mut buffers.force)?;
        self.scaled.tangent(&scalar, &mut buffers.law);
        for ((f, loop_force), load) in row.iter_mut().zip(&buffers.force).zip(&mut buffers.load) {
            *load = load.max(0.0);
            *f = loop_force * (*load / self.reference);
        }
        Ok(JointMarks { state: marks.state, apart, cycles: 1, extrapolated: marks.extrapolated })
    }

    /// δf_t = (N/N*) δF_loop + F_loop δN/N*.
    fn derivative(
        &self,
        _motion: &JointMotion,
        change: &JointChange,
        workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    ) {
        let Some(buffers) = workspace.as_any_mut().downcast_mut::<Buffers>() else {
            derivative.fill(f64::NAN);
            return;
        };
        derivative.fill(0.0);
        if buffers.apart {
            return;
        }
        let (row, normal) = derivative.split_at_mut(buffers.load.len().min(derivative.len()));
        if change.direction == 1 {
            let pressing = buffers.load.iter().zip(&buffers.force).zip(change.displacement);
            for ((f_t, f_n), ((load, loop_force), n)) in row.iter_mut().zip(normal).zip(pressing) {
                if *load > 0.0 {
                    *f_n = self.normal.stiffness() * n;
                    *f_t = loop_force * (*f_n / self.reference);
                }
            }
            return;
        }
        let tangent = &buffers.law.tangent;
        for ((f, kappa), w) in row.iter_mut().zip(&tangent.local).zip(change.displacement) {
            *f = kappa * w;
        }
        for memory in tangent.memories() {
            let by = recalled(memory.recall, change);
            for (f, influence) in row.iter_mut().zip(&memory.influence) {
                *f += influence * by;
            }
        }
        for (f, load) in row.iter_mut().zip(&buffers.load) {
            *f *= load / self.reference;
        }
    }
}
