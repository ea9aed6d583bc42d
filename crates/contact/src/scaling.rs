//! The two scaling laws of the paper: force magnitude, eq. (6), and phase, eq. (7), over the amplitude ratio α.

use std::f64::consts::{FRAC_PI_2, PI};

use serde::{Deserialize, Serialize};

use crate::error::ParameterError;

/// Force magnitude over F*, eq. (6):
///
/// ```math
/// g(\alpha) = \text{offset} + \text{slope} \cdot \ln(\alpha + \text{shift}) \tag{6}
/// ```
///
/// The paper fitted it to the *turning points* of measured loops and uses it for the first harmonic.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MagnitudeLaw {
    /// Value at α = 1 − shift.
    pub offset: f64,
    /// Growth per e-fold of α.
    pub slope: f64,
    /// Keeps the logarithm finite at α = 0; positive.
    pub shift: f64,
}

impl Default for MagnitudeLaw {
    /// The paper's numbers.
    fn default() -> Self {
        Self { offset: 0.98, slope: 0.21, shift: 0.01 }
    }
}

impl MagnitudeLaw {
    /// g(α), as g(0) + slope · ln(1 + α/shift): where g(0) is the small difference of large numbers it is rounded once, the
    /// same for every α.
    pub fn value(&self, alpha: f64) -> f64 {
        self.offset + self.slope * self.shift.ln() + self.slope * (alpha / self.shift).ln_1p()
    }

    /// dg/dα.
    pub fn derivative(&self, alpha: f64) -> f64 {
        self.slope / (alpha + self.shift)
    }

    /// Checks that g is defined and not negative over the measured range α ∈ [0, 1] (g is monotone, so its
    /// ends decide), as a friction force that drives the motion would create energy.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        ParameterError::finite("magnitude.offset", self.offset)?;
        ParameterError::finite("magnitude.slope", self.slope)?;
        ParameterError::positive("magnitude.shift", self.shift)?;
        for alpha in [0.0, 1.0] {
            let g = self.value(alpha);
            if g < 0.0 {
                return Err(ParameterError::new(
                    "magnitude",
                    format!(
                        "g(α) = offset + slope ln(α + shift) must not be negative for α in [0, 1], but g({alpha}) = {g:.4}; raise offset or shift"
                    ),
                ));
            }
        }
        Ok(())
    }
}

/// Phase of the contact force on the mass against the displacement, eq. (7):
///
/// ```math
/// \psi_C(\alpha) = \text{limit} - \text{span} \cdot \mathrm e^{-\text{decay} \cdot \alpha} \tag{7}
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PhaseLaw {
    /// ψ_C for α → ∞ in rad: −π/2 is a pure damper.
    pub limit: f64,
    /// How far ψ_C(0) lies below the limit, in rad.
    pub span: f64,
    /// Decay rate over α; positive.
    pub decay: f64,
}

impl Default for PhaseLaw {
    /// The paper's numbers: −π/2, 7π/15 and 4.
    fn default() -> Self {
        Self { limit: -FRAC_PI_2, span: 7.0 / 15.0 * PI, decay: 4.0 }
    }
}

impl PhaseLaw {
    /// ψ_C(α) in rad.
    pub fn value(&self, alpha: f64) -> f64 {
        self.limit - self.span * (-self.decay * alpha).exp()
    }

    /// dψ_C/dα in rad.
    pub fn derivative(&self, alpha: f64) -> f64 {
        self.span * self.decay * (-self.decay * alpha).exp()
    }

    /// Both at once, for one exponential.
    pub(crate) fn with_derivative(&self, alpha: f64) -> (f64, f64) {
        let lag = self.span * (-self.decay * alpha).exp();
        (self.limit - lag, self.decay * lag)
    }

    /// Checks that the phase stays in [−π, 0] (it is monotone between α = 0 and ∞, so its ends decide):
    /// outside, the contact would feed energy into the motion.
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        ParameterError::finite("phase.limit", self.limit)?;
        ParameterError::finite("phase.span", self.span)?;
        ParameterError::positive("phase.decay", self.decay)?;
        // A rounding unit of slack: −π written with 16 digits must pass.
        let slack = 4.0 * f64::EPSILON;
        for (at, psi) in [("0", self.limit - self.span), ("∞", self.limit)] {
            if !(-PI - slack..=slack).contains(&psi) {
                return Err(ParameterError::new(
                    "phase",
                    format!(
                        "must stay in [-π, 0] or the contact creates energy, but ψ_C = limit - span e^(-decay α) is {psi:.4} at α = {at}"
                    ),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_values() {
        let (g, psi) = (MagnitudeLaw::default(), PhaseLaw::default());
        assert!((g.value(0.0) - 0.01291).abs() < 5e-6);
        assert!((g.value(1.0) - 0.98209).abs() < 5e-6);
        assert!((psi.value(1.0) / PI + 0.50855).abs() < 5e-6);
        assert!((psi.value(0.0) / PI + 29.0 / 30.0).abs() < 1e-15);
        assert!((psi.value(1e9) + FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn laws_that_create_energy_are_refused() {
        let negative = MagnitudeLaw { offset: 0.9, ..Default::default() };
        assert_eq!(negative.check().unwrap_err().key, "magnitude");
        assert!(MagnitudeLaw { offset: 0.9, slope: 0.0, ..Default::default() }.check().is_ok());
        assert_eq!(
            MagnitudeLaw { shift: 0.0, ..Default::default() }.check().unwrap_err().key,
            "magnitude.shift"
        );
        assert_eq!(PhaseLaw { span: 1.6, ..Default::default() }.check().unwrap_err().key, "phase");
        assert_eq!(PhaseLaw { limit: 0.1, ..Default::default() }.check().unwrap_err().key, "phase");
        assert_eq!(
            PhaseLaw { decay: f64::NAN, ..Default::default() }.check().unwrap_err().key,
            "phase.decay"
        );
        assert!(PhaseLaw { limit: -FRAC_PI_2, span: FRAC_PI_2, decay: 1.0 }.check().is_ok());
    }
}
