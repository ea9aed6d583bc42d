//! Regularised Coulomb friction: a force that turns round within a small velocity instead of at once.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::law::{ContactState, Law, Marks, Motion, Nature, Workspace};
use crate::mechanism::{Mechanism, SmoothForce};
use crate::real::Real;
use crate::tangent::Tangent;

/// Parameters of [`Coulomb`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoulombParameters {
    /// F_s in N; positive.
    pub slip_force: f64,
    /// v in m/s at which the force has risen to tanh 1 = 76 % of F_s; positive.
    pub velocity: f64,
}

/// Friction without sticking:
///
/// ```math
/// f = F_s \tanh \frac{\dot w}{v}
/// ```
///
/// It creeps instead of sticking. How steep it turns is the ratio of the velocity amplitude to v: harmonics fall as
/// slowly as a rectangle's (1/k) up to about that order, geometrically beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    slip_force: f64,
    velocity: f64,
}

impl Coulomb {
    /// The law of the given slip force and velocity.
    ///
    /// # Errors
    /// [`ParameterError`] when one of them is not positive.
    pub fn new(parameters: CoulombParameters) -> Result<Self, ParameterError> {
        Ok(Self {
            slip_force: ParameterError::positive("slip_force", parameters.slip_force)?,
            velocity: ParameterError::positive("velocity", parameters.velocity)?,
        })
    }

    /// F_s in N.
    pub fn slip_force(&self) -> f64 {
        self.slip_force
    }

    /// v in m/s.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// F_s tanh(ẇ/v), with `rate` = ẇ in m/s.
    pub(crate) fn friction<T: Real>(&self, rate: T) -> T {
        (rate * (1.0 / self.velocity)).tanh() * self.slip_force
    }

    /// df/dẇ = (F_s/v) sech²(ẇ/v) in N s/m.
    fn slope(&self, rate: f64) -> f64 {
        let sech = (rate / self.velocity).cosh().recip();
        self.slip_force / self.velocity * sech * sech
    }
}

impl Law for Coulomb {
    fn name(&self) -> &'static str {
        "coulomb"
    }

    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: false, linear: false, rate_dependent: true }
    }

    fn length(&self) -> Option<f64> {
        None
    }

    /// That of the rectangle, its upper bound: 4 F_s / (π a).
    fn secant_stiffness(&self, a: f64) -> f64 {
        4.0 * self.slip_force / (PI * a)
    }

    fn force(
        &self,
        motion: &Motion,
        _workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        for (f, &dw) in force.iter_mut().zip(motion.velocity) {
            *f = self.friction(motion.omega * dw);
        }
        Ok(Marks { extrapolated: false, state: ContactState::Slip })
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        workspace.tangent.clear();
        // ∂f/∂(dw/dτ) = Ω ∂f/∂ẇ
        for (c, &dw) in workspace.tangent.rate_mut().iter_mut().zip(motion.velocity) {
            *c = motion.omega * self.slope(motion.omega * dw);
        }
        &workspace.tangent
    }

    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Smooth(self)
    }

    /// The force turns round within a phase of about v/(Ω a), which is not known here. Twice as many as for forces
    /// with kinks resolve velocity amplitudes up to some 100 v at one harmonic; steeper ones are resolved to the
    /// same degree as kinks are.
    fn samples(&self, harmonics: usize) -> usize {
        (32 * (harmonics + 1)).max(512)
    }
}

impl SmoothForce for Coulomb {
    fn at(&self, _w: f64, v: f64) -> f64 {
        self.friction(v)
    }

    fn slopes(&self, _w: f64, v: f64) -> (f64, f64) {
        (0.0, self.slope(v))
    }
}
