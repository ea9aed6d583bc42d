//! The normal direction of a contact: a spring that presses and never pulls.

use serde::{Deserialize, Serialize};

use crate::error::ParameterError;
use crate::mechanism::UnilateralSpring;

/// Parameters of [`NormalContact`]: exactly one of `preload` and `gap`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalContactParameters {
    /// k_n in N/m; positive.
    pub stiffness: f64,
    /// N_0 in N, not negative: the pressure of the static equilibrium that displacements are measured from.
    pub preload: Option<f64>,
    /// g in m: the approach after which the bodies touch; negative where they interfere.
    pub gap: Option<f64>,
}

/// What the contact does when nothing moves.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rest {
    Preload(f64),
    Gap(f64),
}

/// Unilateral linear spring between two bodies that approach each other by n:
///
/// ```text
/// N = max(k_n (n − g), 0),   f_n = N          with a gap g
/// N = max(N_0 + k_n n, 0),   f_n = N − N_0    with a preload N_0
/// ```
///
/// N_0 belongs to the equilibrium that displacements are measured from, so only its change is a force of the balance; the
/// interference of a negative gap acts on the structure in full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalContact {
    stiffness: f64,
    rest: Rest,
}

impl NormalContact {
    /// The spring of these parameters.
    ///
    /// # Errors
    /// [`ParameterError`] when the stiffness is not positive, the preload negative, a number not finite, or not exactly one
    /// of `preload` and `gap` is given.
    pub fn new(parameters: NormalContactParameters) -> Result<Self, ParameterError> {
        Self::named("stiffness", parameters)
    }

    /// The same where the stiffness has another name in the scene file.
    pub(crate) fn named(
        key: &'static str,
        parameters: NormalContactParameters,
    ) -> Result<Self, ParameterError> {
        let stiffness = ParameterError::positive(key, parameters.stiffness)?;
        let rest = match (parameters.preload, parameters.gap) {
            (Some(preload), None) => Rest::Preload(ParameterError::not_negative("preload", preload)?),
            (None, Some(gap)) => Rest::Gap(ParameterError::finite("gap", gap)?),
            (Some(_), Some(_)) => {
                return Err(ParameterError::new("gap", "give preload or gap, not both"));
            }
            (None, None) => return Err(ParameterError::new("preload", "give preload or gap")),
        };
        Ok(Self { stiffness, rest })
    }

    /// k_n in N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Magnitude of the pressure, or of the pull that is missing for one, in N when nothing moves; zero where the
    /// bodies just touch.
    pub fn load_at_rest(&self) -> f64 {
        match self.rest {
            Rest::Preload(preload) => preload,
            Rest::Gap(gap) => (self.stiffness * gap).abs(),
        }
    }

    /// N in N where it is positive; where it is not, the bodies are apart and N = 0. Linear in the approach `n` in m.
    pub fn load(&self, n: f64) -> f64 {
        match self.rest {
            Rest::Preload(preload) => preload + self.stiffness * n,
            Rest::Gap(gap) => self.stiffness * (n - gap),
        }
    }

    /// The approach in m at which the bodies touch.
    pub(crate) fn touching_at(&self) -> f64 {
        match self.rest {
            Rest::Preload(preload) => -preload / self.stiffness,
            Rest::Gap(gap) => gap,
        }
    }

    /// The part of N in N that the equilibrium balances: f_n is the rest.
    pub(crate) fn balanced(&self) -> f64 {
        match self.rest {
            Rest::Preload(preload) => preload,
            Rest::Gap(_) => 0.0,
        }
    }

    /// The same for those who integrate motions.
    pub fn spring(&self) -> UnilateralSpring {
        let (pressure_at_zero, balanced) = match self.rest {
            Rest::Preload(preload) => (preload, preload),
            Rest::Gap(gap) => (-self.stiffness * gap, 0.0),
        };
        UnilateralSpring { stiffness: self.stiffness, pressure_at_zero, balanced }
    }

    /// f_n in N for the load that [`NormalContact::load`] gave.
    pub(crate) fn force(&self, load: f64) -> f64 {
        load.max(0.0) - self.balanced()
    }

    /// Part of the period without contact, for the loads at its samples, linear between them.
    pub(crate) fn apart(loads: &[f64]) -> f64 {
        let next = loads.iter().cycle().skip(1);
        let part = |(&from, &to): (&f64, &f64)| match (from <= 0.0, to <= 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => from / (from - to),
            (false, true) => to / (to - from),
        };
        loads.iter().zip(next).map(part).sum::<f64>() / loads.len().max(1) as f64
    }
}
