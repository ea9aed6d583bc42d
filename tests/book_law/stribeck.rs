//! Stribeck friction: sliding faster, the friction force falls from the static to the Coulomb level.

use contact::{
    ContactState, Law, LawError, Marks, Mechanism, Motion, Nature, ParameterError, SmoothForce, Tangent,
    Workspace,
};

/// f = (F_c + (F_s − F_c) e^{−(v/v_s)²}) tanh(v/v_0), with v = ẇ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stribeck {
    /// F_c in N: the force at high speed; positive.
    pub coulomb: f64,
    /// F_s in N: the force that it falls from.
    pub peak: f64,
    /// v_s in m/s: how soon it falls; positive.
    pub fall: f64,
    /// v_0 in m/s: how soon the force turns round where the velocity does; positive.
    pub turn: f64,
}

impl Stribeck {
    /// The law, its parameters checked.
    ///
    /// # Errors
    /// [`ParameterError`] naming the parameter that is not positive or not finite.
    pub fn checked(self) -> Result<Self, ParameterError> {
        let all = [("coulomb", self.coulomb), ("peak", self.peak), ("fall", self.fall), ("turn", self.turn)];
        for (key, value) in all {
            if !(value.is_finite() && value > 0.0) {
                return Err(ParameterError::new(key, format!("must be positive, got {value}")));
            }
        }
        Ok(self)
    }
}

impl SmoothForce for Stribeck {
    /// f in N.
    fn at(&self, _w: f64, v: f64) -> f64 {
        let level = self.coulomb + (self.peak - self.coulomb) * (-(v / self.fall).powi(2)).exp();
        level * (v / self.turn).tanh()
    }

    /// ∂f/∂w = 0 and ∂f/∂v.
    fn slopes(&self, _w: f64, v: f64) -> (f64, f64) {
        let excess = (self.peak - self.coulomb) * (-(v / self.fall).powi(2)).exp();
        let falling = -2.0 * v / self.fall.powi(2) * excess * (v / self.turn).tanh();
        let turning = (self.coulomb + excess) / self.turn * (v / self.turn).cosh().powi(-2);
        (0.0, falling + turning)
    }
}

impl Law for Stribeck {
    fn name(&self) -> &'static str {
        "stribeck"
    }

    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: false, linear: false, rate_dependent: true }
    }

    /// No displacement is special to this law.
    fn length(&self) -> Option<f64> {
        None
    }

    /// That of a rectangle of the larger force, its upper bound: 4 F / (π a).
    fn secant_stiffness(&self, a: f64) -> f64 {
        4.0 * self.peak.max(self.coulomb) / (std::f64::consts::PI * a)
    }

    fn force(&self, motion: &Motion, _: &mut Workspace, force: &mut [f64]) -> Result<Marks, LawError> {
        // The motion is given over the phase τ = Ωt: ẇ = Ω dw/dτ.
        for (f, &dw) in force.iter_mut().zip(motion.velocity) {
            *f = self.at(0.0, motion.omega * dw);
        }
        Ok(Marks { extrapolated: false, state: ContactState::Slip })
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        let tangent = workspace.tangent_mut();
        tangent.clear();
        // ∂f/∂(dw/dτ) = Ω ∂f/∂ẇ
        for (c, &dw) in tangent.rate_mut().iter_mut().zip(motion.velocity) {
            *c = motion.omega * self.slopes(0.0, motion.omega * dw).1;
        }
        tangent
    }

    /// The force follows the motion in time, so there are exact orbits and an exact truncation error.
    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Smooth(self)
    }

    /// Turning round takes a small part of the period.
    fn samples(&self, harmonics: usize) -> usize {
        (32 * (harmonics + 1)).max(512)
    }
}
