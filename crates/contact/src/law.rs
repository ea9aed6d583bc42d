//! What a contact law answers: the trait [`Law`] and the plain types it speaks in.

use std::fmt;

use num_complex::Complex64;

use crate::error::LawError;
use crate::events::PiecewiseLinear;
use crate::loop_curve::LoopCurve;
use crate::masing::Masing;
use crate::masing_tangent::MasingTangent;
use crate::mechanism::Mechanism;
use crate::path::Piece;
use crate::tangent::Tangent;
use crate::turning_points::TurningPoints;

/// What kind of law this is; a solver plans with it before any motion is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nature {
    /// The force of the mirrored motion is the mirrored force: an odd motion needs odd harmonics only.
    pub odd: bool,
    /// The mean force depends on the mean displacement (springs). Friction laws answer `false`: their slider
    /// follows the mean.
    pub determines_mean: bool,
    /// Force proportional to displacement: no iteration is needed for it.
    pub linear: bool,
    /// The force depends on the velocity dw/dt too, hence on [`Motion::omega`]; its tangent has [`Tangent::rate`].
    pub rate_dependent: bool,
}

/// One period of the relative displacement of a contact, in harmonics and in samples.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// `W_0 … W_N` in m, one-sided: `w(τ) = Re Σ W_k e^{ikτ}`.
    pub spectrum: &'a [Complex64],
    /// `w(τ_j)`, τ_j = 2πj/M, j = 0 … M−1, in m.
    pub displacement: &'a [f64],
    /// `dw/dτ (τ_j)` in m.
    pub velocity: &'a [f64],
    /// Only odd harmonics are present: `w(τ + π) = −w(τ)`.
    pub odd: bool,
    /// dτ/dt in rad/s: `ẇ = omega · dw/dτ`. Rate-independent laws do not look at it.
    pub omega: f64,
}

/// What the contact does over the period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactState {
    /// Elastic all the time.
    #[default]
    Stick,
    /// Slipping all the time.
    Slip,
    /// Sticking and slipping in turn, or gradually both (loop laws).
    Mixed,
    /// At rest: a set-valued law holds it.
    Held,
    /// The bodies are apart all the time.
    Apart,
}

/// What a force evaluation noticed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marks {
    /// The amplitude lies outside the range the law was measured in.
    pub extrapolated: bool,
    /// Stick, slip, or both.
    pub state: ContactState,
}

/// First force harmonic of a motion `w = a cos τ`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstHarmonic {
    /// `F_1(a)` in N, rig convention: `f = Re F_1 e^{iτ} + higher harmonics`.
    pub force: Complex64,
    /// `dF_1/da` in N/m.
    pub derivative: Complex64,
}

/// Closed form of the first force harmonic: with it the balance of one harmonic and one contact is one real equation.
pub trait DescribingFunction {
    /// `F_1(a)` and `dF_1/da` for amplitude `a` > 0 in m.
    fn first_harmonic(&self, a: f64) -> FirstHarmonic;

    /// `lim_{a→0} F_1(a)` in N. Its magnitude is the holding force of a set-valued law: at rest the contact
    /// exerts any force up to it. Zero for all other laws.
    fn at_rest(&self) -> Complex64 {
        Complex64::ZERO
    }

    /// What `|F_1|` in N does not exceed at any amplitude up to `a` in m, which may be infinite; `None` where nothing is
    /// known. The closer, the narrower a search for solutions.
    fn largest(&self, _a: f64) -> Option<f64> {
        None
    }

    /// Amplitude in m up to which the law is a spring, `F_1` proportional to `a`; `None` where it never is one.
    fn spring_up_to(&self) -> Option<f64> {
        None
    }

    /// What the contact does during harmonic motion of amplitude `a` in m.
    fn marks(&self, a: f64) -> Marks;

    /// An amplitude where `dF_1/da` jumps or `F_1` changes its character, in m.
    fn landmark(&self) -> Option<f64> {
        None
    }
}

/// Buffers of one contact, made once and reused by every evaluation; what is in them belongs to the law.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) turning_points: TurningPoints,
    /// A loop law's branches, and how they change with the amplitude.
    pub(crate) curve: LoopCurve<f64>,
    pub(crate) growth: LoopCurve<f64>,
    pub(crate) masing: Masing<f64, Complex64>,
    /// An Iwan law's branches.
    pub(crate) stack: Masing<f64, f64>,
    pub(crate) masing_tangent: MasingTangent,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) tangent: Tangent,
}

impl Workspace {
    /// Buffers for motions with `samples` samples a period.
    pub fn new(samples: usize) -> Self {
        Self {
            turning_points: TurningPoints::default(),
            curve: LoopCurve::new(),
            growth: LoopCurve::new(),
            masing: Masing::new(),
            stack: Masing::new(),
            masing_tangent: MasingTangent::new(),
            pieces: Vec::new(),
            tangent: Tangent::new(samples),
        }
    }

    /// The tangent that [`Law::tangent`] answers with, for laws of other crates to fill in.
    pub fn tangent_mut(&mut self) -> &mut Tangent {
        &mut self.tangent
    }
}

/// A contact law: the force of one contact over one period of its relative displacement.
///
/// All laws here are scalar; all but [`crate::Coulomb`] are rate-independent. Amplitudes are half peak-to-peak.
pub trait Law: Send + Sync + fmt::Debug {
    /// The law's name in a scene file.
    fn name(&self) -> &'static str;

    /// What kind of law this is.
    fn nature(&self) -> Nature;

    /// Displacement amplitude in m at which the law changes its character; `None` for a law without one (a
    /// spring). Solvers scale their unknowns with it.
    fn length(&self) -> Option<f64>;

    /// Magnitude of the secant stiffness `|F_1|/a` in N/m at the amplitude `a` in m.
    fn secant_stiffness(&self, a: f64) -> f64 {
        self.describing_function().map_or(0.0, |law| law.first_harmonic(a).force.norm() / a)
    }

    /// The largest local stiffness in N/m that any motion can meet; `None` where there is no bound. Harmonics that the
    /// structure answers much more softly than this can be found by substitution.
    fn stiffest(&self) -> Option<f64> {
        None
    }

    /// The force `f(τ_j)` in N (rig convention), written to `force` (as long as `motion.displacement`).
    ///
    /// # Errors
    /// [`LawError`] when the motion has no force under this law; `force` is then meaningless.
    fn force(&self, motion: &Motion, workspace: &mut Workspace, force: &mut [f64])
    -> Result<Marks, LawError>;

    /// The derivative of the force at the motion that [`Law::force`] was last called with in this workspace.
    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent;

    /// The closed form for one harmonic, where the law has one.
    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        None
    }

    /// The force by its events, where it is piecewise linear in the displacement.
    fn piecewise_linear(&self) -> Option<&dyn PiecewiseLinear> {
        None
    }

    /// What moves the contact in time, without harmonics.
    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::None { why: "its force at an instant depends on the whole period" }
    }

    /// Force magnitude in N that the contact can hold at rest; positive for set-valued laws only.
    fn holding_force(&self) -> f64 {
        self.describing_function().map_or(0.0, |law| law.at_rest().norm())
    }

    /// Samples a period that the law asks for when the motion has `harmonics` harmonics. The default suits forces
    /// with kinks, whose sampling error falls with the square of the number of samples.
    fn samples(&self, harmonics: usize) -> usize {
        (16 * (harmonics + 1)).max(256)
    }
}
