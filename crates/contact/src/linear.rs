//! The linear spring f = k w: a check on everything, and a coupling stiffness in practice.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::mechanism::Mechanism;
use crate::tangent::Tangent;

/// Parameters of [`Linear`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearParameters {
    /// k in N/m; not negative.
    pub stiffness: f64,
}

/// The spring $`f = k w`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    stiffness: f64,
}

impl Linear {
    /// The spring of the given stiffness.
    ///
    /// # Errors
    /// [`ParameterError`] when the stiffness is negative or not finite.
    pub fn new(parameters: LinearParameters) -> Result<Self, ParameterError> {
        let stiffness = ParameterError::not_negative("stiffness", parameters.stiffness)?;
        Ok(Self { stiffness })
    }
}

impl Law for Linear {
    fn name(&self) -> &'static str {
        "linear"
    }

    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: true, linear: true, rate_dependent: false }
    }

    fn length(&self) -> Option<f64> {
        None
    }

    fn stiffest(&self) -> Option<f64> {
        Some(self.stiffness)
    }

    fn force(
        &self,
        motion: &Motion,
        _workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        for (f, &w) in force.iter_mut().zip(motion.displacement) {
            *f = self.stiffness * w;
        }
        Ok(Marks { extrapolated: false, state: ContactState::Stick })
    }

    fn tangent<'w>(&self, _motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        workspace.tangent.clear();
        workspace.tangent.local.fill(self.stiffness);
        &workspace.tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Sliders { sliders: &[], spring: self.stiffness }
    }

    fn samples(&self, harmonics: usize) -> usize {
        2 * (harmonics + 1)
    }
}

impl DescribingFunction for Linear {
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        FirstHarmonic {
            force: Complex64::from(self.stiffness * a),
            derivative: Complex64::from(self.stiffness),
        }
    }

    fn marks(&self, _a: f64) -> Marks {
        Marks { extrapolated: false, state: ContactState::Stick }
    }
}
