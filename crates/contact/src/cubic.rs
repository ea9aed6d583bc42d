//! The cubic spring f = k₃ w³: the smooth elastic law with multiple solutions (Duffing).

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::mechanism::{Mechanism, SmoothForce};
use crate::tangent::Tangent;

/// Parameters of [`Cubic`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CubicParameters {
    /// k₃ in N/m³; positive hardens, negative softens.
    pub stiffness: f64,
}

/// The spring $`f = k_3 w^3`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic {
    stiffness: f64,
}

impl Cubic {
    /// The spring of the given cubic stiffness.
    ///
    /// # Errors
    /// [`ParameterError`] when the stiffness is not finite.
    pub fn new(parameters: CubicParameters) -> Result<Self, ParameterError> {
        Ok(Self { stiffness: ParameterError::finite("stiffness", parameters.stiffness)? })
    }
}

impl Law for Cubic {
    fn name(&self) -> &'static str {
        "cubic"
    }

    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: true, linear: false, rate_dependent: false }
    }

    fn length(&self) -> Option<f64> {
        None
    }

    fn force(
        &self,
        motion: &Motion,
        _workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        for (f, &w) in force.iter_mut().zip(motion.displacement) {
            *f = self.stiffness * w * w * w;
        }
        Ok(Marks { extrapolated: false, state: ContactState::Stick })
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        workspace.tangent.clear();
        for (kappa, &w) in workspace.tangent.local.iter_mut().zip(motion.displacement) {
            *kappa = 3.0 * self.stiffness * w * w;
        }
        &workspace.tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Smooth(self)
    }

    /// The force has three times the motion's harmonics; none of them may alias onto the motion's.
    fn samples(&self, harmonics: usize) -> usize {
        4 * (harmonics + 1)
    }
}

impl SmoothForce for Cubic {
    fn at(&self, w: f64, _v: f64) -> f64 {
        self.stiffness * w * w * w
    }

    fn slopes(&self, w: f64, _v: f64) -> (f64, f64) {
        (3.0 * self.stiffness * w * w, 0.0)
    }
}

impl DescribingFunction for Cubic {
    /// cos³ = ¾ cos + ¼ cos 3·, hence `F_1 = ¾ k₃ a³`.
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        FirstHarmonic {
            force: Complex64::from(0.75 * self.stiffness * a.powi(3)),
            derivative: Complex64::from(2.25 * self.stiffness * a * a),
        }
    }

    fn marks(&self, _a: f64) -> Marks {
        Marks { extrapolated: false, state: ContactState::Stick }
    }
}
