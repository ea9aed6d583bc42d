//! Friction in one or two tangential directions under a normal load that the motion changes, apart at times.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::friction_events::{EventBuffers, FrictionEvents, couplings};
use crate::joint::{
    Coupling, JointChange, JointLaw, JointMarks, JointMotion, JointPiecewiseLinear, JointWorkspace,
};
use crate::law::ContactState;
use crate::mechanism::JointMechanism;
use crate::normal_contact::{NormalContact, NormalContactParameters};
use crate::sliding_period::{Regime, SlidingPeriod};

/// Parameters of [`FrictionContact`]: exactly one of `preload` and `gap`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionContactParameters {
    /// k_t in N/m, the same in all tangential directions; positive.
    pub tangential_stiffness: f64,
    /// k_n in N/m; positive.
    pub normal_stiffness: f64,
    /// μ; not negative.
    pub friction_coefficient: f64,
    /// N_0 in N, not negative: the pressure of the static equilibrium that displacements are measured from.
    pub preload: Option<f64>,
    /// g in m: the approach after which the bodies touch; negative where they interfere.
    pub gap: Option<f64>,
}

/// Spring k_t in series with a Coulomb slider of limit μN, and a unilateral spring k_n in the normal direction.
///
/// ```math
/// N = \begin{cases} \max(N_0 + k_n n,\ 0) & \text{with a preload} \\ \max(k_n (n - g),\ 0) & \text{with a gap} \end{cases}
/// \qquad f = k_t (w - s), \qquad |f| \le \mu N
/// ```
///
/// The tangential force is f = k_t (w − s) with the slider s in the interval (two directions: the disc) of radius μN/k_t around
/// w; it moves only when its edge pushes it, in the direction of f. Apart there is no force and the slider follows. Of the
/// periodic states of a contact that never slips, the one is taken whose slider is nearest to the mean displacement; where it
/// slips or lifts off in every period there is only one. Between samples the displacement is taken as linear in time: sampled
/// forces carry an error of O(M⁻²). With one tangential direction the forces are known by their events too, without that error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionContact {
    tangential: usize,
    stiffness: f64,
    friction: f64,
    normal: NormalContact,
}

/// Buffers of a contact with D tangential directions.
#[derive(Debug)]
struct Buffers<const D: usize> {
    period: SlidingPeriod<D>,
    regime: Regime<D>,
    events: EventBuffers,
}

impl<const D: usize> JointWorkspace for Buffers<D> {
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

impl FrictionContact {
    /// The contact with `tangential` (1 or 2) directions of friction.
    ///
    /// # Errors
    /// [`ParameterError`] when a stiffness is not positive, the friction coefficient or the preload negative, a number not
    /// finite, not exactly one of `preload` and `gap` given, or `tangential` neither 1 nor 2.
    pub fn new(parameters: FrictionContactParameters, tangential: usize) -> Result<Self, ParameterError> {
        if !(1..=2).contains(&tangential) {
            return Err(ParameterError::new(
                "tangential",
                format!("a friction contact has one or two tangential directions, not {tangential}"),
            ));
        }
        let FrictionContactParameters { normal_stiffness, preload, gap, .. } = parameters;
        Ok(Self {
            tangential,
            stiffness: ParameterError::positive("tangential_stiffness", parameters.tangential_stiffness)?,
            friction: ParameterError::not_negative("friction_coefficient", parameters.friction_coefficient)?,
            normal: NormalContact::named(
                "normal_stiffness",
                NormalContactParameters { stiffness: normal_stiffness, preload, gap },
            )?,
        })
    }

    /// The normal direction.
    pub fn normal(&self) -> &NormalContact {
        &self.normal
    }

    /// μ / k_t: what a load means for the slider, in m/N.
    fn reach(&self) -> f64 {
        self.friction / self.stiffness
    }

    fn force_in<const D: usize>(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        force: &mut [f64],
    ) -> Result<JointMarks, LawError> {
        let samples = motion.samples();
        let buffers = workspace.as_any_mut().downcast_mut::<Buffers<D>>().ok_or(LawError::OtherWorkspace)?;
        let fits = motion.directions == D + 1 && buffers.period.samples() == samples;
        if !fits || force.len() != motion.displacement.len() {
            return Err(LawError::OtherWorkspace);
        }
        if motion.displacement.iter().any(|w| !w.is_finite()) {
            return Err(LawError::NotFinite);
        }
        let Buffers { period, regime, .. } = buffers;
        let (tangential, normal) = force.split_at_mut(D * samples);
        let approach = motion.displacement_of(D);
        period.loads.clear();
        period.loads.extend(approach.iter().map(|&n| self.normal.load(n)));
        for (f, &load) in normal.iter_mut().zip(&period.loads) {
            *f = self.normal.force(load);
        }
        let mean = |direction: usize| motion.spectrum_of(direction).first().map_or(0.0, |mean| mean.re);
        *regime = period.find(motion, self.reach(), std::array::from_fn(mean))?;
        for (direction, row) in tangential.chunks_exact_mut(samples.max(1)).enumerate() {
            for (j, (f, w)) in row.iter_mut().zip(motion.displacement_of(direction)).enumerate() {
                *f = self.stiffness * (w - period.slider(regime, j, direction).unwrap_or(*w));
            }
        }
        let apart = NormalContact::apart(&period.loads);
        let state = if period.loads.iter().all(|load| *load <= 0.0) {
            ContactState::Apart
        } else {
            period.state(regime)
        };
        Ok(JointMarks { state, apart, cycles: period.cycles, extrapolated: false })
    }

    fn derivative_in<const D: usize>(
        &self,
        change: &JointChange,
        workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    ) {
        let Some(Buffers { period, regime, .. }) = workspace.as_any_mut().downcast_mut::<Buffers<D>>() else {
            derivative.fill(f64::NAN);
            return;
        };
        derivative.fill(0.0);
        let samples = period.samples();
        let (tangential, normal) = derivative.split_at_mut((D * samples).min(derivative.len()));
        let kn = self.normal.stiffness();
        if change.direction == D {
            for ((f, n), load) in normal.iter_mut().zip(change.displacement).zip(&period.loads) {
                *f = if *load > 0.0 { kn * n } else { 0.0 };
            }
        }
        let mean = if change.order == 0 { change.amplitude } else { Complex64::ZERO };
        let reach = self.reach() * kn;
        let moves = (change.direction < D).then_some(change.direction);
        period.change(regime, change.displacement, moves, reach, mean.re, |j, slider| {
            let by = change.displacement.get(j).copied().unwrap_or(0.0);
            for (direction, s) in slider.iter().enumerate() {
                let w = if moves == Some(direction) { by } else { 0.0 };
                if let Some(f) = tangential.get_mut(direction * samples + j) {
                    *f = self.stiffness * (w - s);
                }
            }
        });
    }
}

impl JointLaw for FrictionContact {
    fn name(&self) -> &'static str {
        "friction_contact"
    }

    fn directions(&self) -> usize {
        self.tangential + 1
    }

    /// μ N/k_t and N/k_n with the load N at rest; zero where there is none.
    fn length(&self, direction: usize) -> f64 {
        let load = self.normal.load_at_rest();
        if direction < self.tangential { self.reach() * load } else { load / self.normal.stiffness() }
    }

    fn stiffness(&self, direction: usize) -> f64 {
        if direction < self.tangential { self.stiffness } else { self.normal.stiffness() }
    }

    fn workspace(&self, samples: usize) -> Box<dyn JointWorkspace> {
        fn buffers<const D: usize>(samples: usize) -> Box<dyn JointWorkspace> {
            Box::new(Buffers::<D> {
                period: SlidingPeriod::new(samples),
                regime: Regime::Frictionless,
                events: EventBuffers::default(),
            })
        }
        if self.tangential == 1 { buffers::<1>(samples) } else { buffers::<2>(samples) }
    }

    fn force(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        force: &mut [f64],
    ) -> Result<JointMarks, LawError> {
        if self.tangential == 1 {
            self.force_in::<1>(motion, workspace, force)
        } else {
            self.force_in::<2>(motion, workspace, force)
        }
    }

    fn derivative(
        &self,
        _motion: &JointMotion,
        change: &JointChange,
        workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    ) {
        if self.tangential == 1 {
            self.derivative_in::<1>(change, workspace, derivative);
        } else {
            self.derivative_in::<2>(change, workspace, derivative);
        }
    }

    fn mechanism(&self) -> JointMechanism {
        JointMechanism::Friction {
            tangential_stiffness: self.stiffness,
            friction_coefficient: self.friction,
            normal: self.normal.spring(),
        }
    }

    /// In one tangential direction.
    fn piecewise_linear(&self) -> Option<&dyn JointPiecewiseLinear> {
        (self.tangential == 1).then_some(self)
    }

    /// The pressure in any case: its work, and what sampling would add to it, is far larger than that of friction where the
    /// bodies part.
    fn partly_piecewise_linear(&self) -> Option<&dyn JointPiecewiseLinear> {
        (self.tangential > 1).then_some(self)
    }
}

impl JointPiecewiseLinear for FrictionContact {
    fn couplings(&self) -> Vec<Coupling> {
        match self.tangential {
            1 => couplings(),
            normal => vec![Coupling { force: normal, displacement: normal, pieces: Vec::new() }],
        }
    }

    fn pieces(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        couplings: &mut [Coupling],
    ) -> Result<JointMarks, LawError> {
        if motion.directions != self.tangential + 1 {
            return Err(LawError::OtherWorkspace);
        }
        let Self { stiffness, friction, ref normal, .. } = *self;
        let law = FrictionEvents { stiffness, friction, normal };
        if self.tangential == 1 {
            let buffers =
                workspace.as_any_mut().downcast_mut::<Buffers<1>>().ok_or(LawError::OtherWorkspace)?;
            return law.pieces(motion, &mut buffers.events, couplings);
        }
        let buffers = workspace.as_any_mut().downcast_mut::<Buffers<2>>().ok_or(LawError::OtherWorkspace)?;
        let [normal] = couplings else { return Err(LawError::OtherWorkspace) };
        law.normal_pieces(motion, &mut buffers.events, normal)
    }
}
