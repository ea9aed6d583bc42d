//! The paper's contact law: one measured loop, scaled in magnitude and phase to the current amplitude.
//!
//! For harmonic motion of amplitude a = α W*, the first force harmonic on the mass is, eqs (6)–(9),
//!
//! ```text
//! F_1 = F* g(α) e^{i(ψ_C(α) + arg W_1)},   g(α) = 0.98 + 0.21 ln(α + 0.01),   ψ_C(α) = −π/2 − (7/15) π e^{−4α}
//! ```
//!
//! For any other periodic motion the measured loop is followed over its *loop phase* θ, with the coefficients
//!
//! ```text
//! c_1(α) = −g(α) F* e^{iψ_C(α)},   c_k(α) = σ(α) F*_k for k ≥ 2,   σ(α) = Im c_1(α) / Im F*_1
//! ```
//!
//! in rig convention: higher harmonics come from slip, so they scale with the dissipative part, and the half-width of
//! the scaled loop is the measured one times a non-negative number. Reversals inside a period follow Masing's memory.

use std::f64::consts::PI;

use hysteresis::{EVEN_CONTENT_LIMIT, Loop};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::path::SampledPath;
use crate::scaling::{MagnitudeLaw, PhaseLaw};
use crate::tangent::Tangent;

/// Whether a loop's even harmonics are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Symmetry {
    /// The odd part when the even content is below the record's noise or 2 %, else everything.
    #[default]
    Auto,
    /// The odd part.
    Odd,
    /// Everything.
    Full,
}

impl Symmetry {
    /// Whether a loop of this even content and noise (relative to |F_1|) counts as odd.
    pub(crate) fn is_odd(self, even_content: f64, noise: f64) -> bool {
        match self {
            Self::Auto => even_content <= noise.max(EVEN_CONTENT_LIMIT),
            Self::Odd => true,
            Self::Full => even_content == 0.0,
        }
    }
}

/// A measured loop scaled to the current amplitude $`a = \alpha W^*`$, over its loop phase θ in rig convention:
///
/// ```math
/// f = \operatorname{Re} \sum_k c_k(\alpha) \,\mathrm e^{\mathrm i k \theta}, \qquad
/// c_1 = -g(\alpha) F^* \mathrm e^{\mathrm i \psi_C(\alpha)}, \qquad
/// c_k = \frac{\operatorname{Im} c_1(\alpha)}{\operatorname{Im} F^*_1} F^*_k \quad (k \ge 2) .
/// ```
///
/// For one harmonic this is eqs (6) to (9) of the paper; the force on the mass is −f.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaledLoop {
    magnitude: MagnitudeLaw,
    phase: PhaseLaw,
    /// W* in m.
    reference_displacement: f64,
    /// F* = |F*_1| in N.
    reference_force: f64,
    /// F*_k / Im F*_1, index k = 0 … K; entries 0 and 1 are zero.
    shape: Vec<Complex64>,
    odd: bool,
    /// arg F*_1 − (π + ψ_C(1)) in rad.
    phase_mismatch: f64,
    /// g(0).
    least: f64,
    /// c_1(0) in N.
    at_rest: Complex64,
}

impl ScaledLoop {
    /// The law that scales `measured`; `noise` is the record's noise relative to |F_1| (0 when unknown), which decides
    /// about even harmonics in [`Symmetry::Auto`]. The loop's mean force is left out: it has no meaning at another
    /// amplitude.
    ///
    /// # Errors
    /// [`ParameterError`] when a scaling law would create energy: g negative for α in [0, 1], or a phase outside
    /// [−π, 0].
    pub fn new(
        measured: &Loop,
        noise: f64,
        magnitude: MagnitudeLaw,
        phase: PhaseLaw,
        symmetry: Symmetry,
    ) -> Result<Self, ParameterError> {
        magnitude.check()?;
        phase.check()?;
        let odd = symmetry.is_odd(measured.even_content(), noise);
        let dissipative = measured.coefficients().get(1).map_or(0.0, |c| c.im);
        if dissipative <= 0.0 {
            return Err(ParameterError::new(
                "loop",
                "its first harmonic dissipates nothing (Im F_1 must be positive)",
            ));
        }
        let keep = |k: usize| k >= 2 && !(odd && k.is_multiple_of(2));
        let shape = measured.coefficients().iter().enumerate();
        Ok(Self {
            magnitude,
            phase,
            reference_displacement: measured.displacement_amplitude(),
            reference_force: measured.force_amplitude(),
            shape: shape.map(|(k, c)| if keep(k) { c / dissipative } else { Complex64::ZERO }).collect(),
            odd,
            phase_mismatch: measured.phase() - (PI + phase.value(1.0)),
            least: magnitude.value(0.0),
            at_rest: at_rest(measured.force_amplitude(), &magnitude, &phase),
        })
    }

    /// The law of a loop of which only displacement amplitude W* (m) and first force harmonic F* (N) are known: an
    /// ellipse with the phase of eq. (7).
    ///
    /// # Errors
    /// [`ParameterError`] as in [`ScaledLoop::new`], and when an amplitude is not positive.
    pub fn ellipse(
        displacement: f64,
        force: f64,
        magnitude: MagnitudeLaw,
        phase: PhaseLaw,
    ) -> Result<Self, ParameterError> {
        ParameterError::positive("loop.displacement", displacement)?;
        ParameterError::positive("loop.force", force)?;
        magnitude.check()?;
        phase.check()?;
        Ok(Self {
            magnitude,
            phase,
            reference_displacement: displacement,
            reference_force: force,
            shape: vec![Complex64::ZERO; 2],
            odd: true,
            phase_mismatch: 0.0,
            least: magnitude.value(0.0),
            at_rest: at_rest(force, &magnitude, &phase),
        })
    }

    /// W* in m: displacement amplitude of the measured loop.
    pub fn reference_displacement(&self) -> f64 {
        self.reference_displacement
    }

    /// F* in N: magnitude of the measured loop's first force harmonic.
    pub fn reference_force(&self) -> f64 {
        self.reference_force
    }

    /// The measured loop's phase minus what eq. (7) says at α = 1, in rad. The law wins.
    pub fn phase_mismatch(&self) -> f64 {
        self.phase_mismatch
    }

    /// Whether the law is odd: the measured loop is, or its even harmonics were left out.
    pub fn is_odd(&self) -> bool {
        self.odd
    }

    /// g(α), without a logarithm that is always the same.
    fn magnitude(&self, alpha: f64) -> f64 {
        self.least + self.magnitude.slope * (alpha / self.magnitude.shift).ln_1p()
    }

    /// c_1(α) in N and dc_1/dα.
    pub(crate) fn first(&self, alpha: f64) -> (Complex64, Complex64) {
        let g = self.magnitude(alpha);
        let (phase, slope) = self.phase.with_derivative(alpha);
        let unit = Complex64::from_polar(self.reference_force, PI + phase);
        let derivative = Complex64::new(self.magnitude.derivative(alpha), g * slope);
        (unit * g, unit * derivative)
    }

    /// Coefficients c_k with the given c_1; the same for derivatives, as σ is linear in c_1.
    pub(crate) fn coefficients(&self, first: Complex64) -> impl Iterator<Item = Complex64> + Clone {
        self.shape.iter().enumerate().map(move |(k, shape)| if k == 1 { first } else { shape * first.im })
    }
}

/// c_1(0) in N.
fn at_rest(force: f64, magnitude: &MagnitudeLaw, phase: &PhaseLaw) -> Complex64 {
    Complex64::from_polar(force, PI + phase.value(0.0)) * magnitude.value(0.0)
}

impl Law for ScaledLoop {
    fn name(&self) -> &'static str {
        "scaled_loop"
    }

    fn nature(&self) -> Nature {
        Nature { odd: self.odd, determines_mean: false, linear: false, rate_dependent: false }
    }

    fn length(&self) -> Option<f64> {
        Some(self.reference_displacement)
    }

    fn force(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        let Workspace { turning_points: tips, masing, curve, growth, .. } = workspace;
        tips.find(motion)?;
        let a = tips.amplitude();
        let alpha = a / self.reference_displacement;
        if self.magnitude(alpha) < 0.0 {
            return Err(LawError::NegativeMagnitude { alpha });
        }
        let (first, derivative) = self.first(alpha);
        curve.set(self.coefficients(first), self.odd);
        growth.set(self.coefficients(derivative / self.reference_displacement), self.odd);
        masing.trace(curve, &SampledPath::new(motion, tips), a, force);
        Ok(self.marks(a))
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        let Workspace { turning_points, curve, growth, masing, masing_tangent, tangent, .. } = workspace;
        masing_tangent.evaluate(curve, growth, masing, motion, turning_points, tangent);
        tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    /// No harmonic of the loop may alias onto one of the motion.
    fn samples(&self, harmonics: usize) -> usize {
        (16 * (harmonics + 1)).max(256).max(4 * (self.shape.len() + harmonics))
    }
}

impl DescribingFunction for ScaledLoop {
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        let (force, derivative) = self.first(a / self.reference_displacement);
        FirstHarmonic { force, derivative: derivative / self.reference_displacement }
    }

    fn at_rest(&self) -> Complex64 {
        self.at_rest
    }

    /// g is monotone.
    fn largest(&self, a: f64) -> Option<f64> {
        let g = self.magnitude(a / self.reference_displacement);
        Some(self.reference_force * self.least.abs().max(g.abs()))
    }

    fn marks(&self, a: f64) -> Marks {
        let extrapolated = a > self.reference_displacement * (1.0 + 1e-9);
        Marks { extrapolated, state: ContactState::Mixed }
    }

    fn landmark(&self) -> Option<f64> {
        // Where ln(α + shift) bends.
        Some(self.magnitude.shift * self.reference_displacement)
    }
}
