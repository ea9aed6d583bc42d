//! The answer at one frequency.

use std::fmt;

use contact::{ContactState, LawError};
use num_complex::Complex64;

use crate::stability::Stability;

/// How a point ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Status {
    /// The balance holds.
    Converged,
    /// Every contact with a holding force is held at w = 0; counts as solved.
    Stuck,
    /// No solution was found; the numbers of the point are not a solution.
    Failed(FailureReason),
}

impl Status {
    /// Converged or stuck.
    pub fn solved(&self) -> bool {
        !matches!(self, Self::Failed(_))
    }
}

/// Why a point has no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FailureReason {
    /// Every start and every fallback was tried; the best residual is far from zero.
    NotConverged,
    /// The dynamic stiffness of the structure without contacts is singular at this harmonic (an undamped model at a
    /// resonance, or a free rigid-body motion), and the contacts do not bound the motion.
    SingularStructure {
        /// Harmonic of Ω.
        harmonic: usize,
    },
    /// A contact law has no force for the motion.
    Law(LawError),
    /// The excitation is within what the contacts hold at some instants and beyond it at others, and no sliding
    /// solution was found.
    HoldingLimit,
}

impl fmt::Display for FailureReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConverged => write!(f, "the iteration did not converge from any start"),
            Self::SingularStructure { harmonic: 0 } => write!(
                f,
                "the stiffness is singular and no contact determines the mean displacement (free rigid-body motion); add a \
                 support"
            ),
            Self::SingularStructure { harmonic } => write!(
                f,
                "the dynamic stiffness is singular at harmonic {harmonic} (undamped resonance), and the contacts do not bound \
                 the motion; add damping, or move the frequency"
            ),
            Self::Law(error) => error.fmt(f),
            Self::HoldingLimit => write!(
                f,
                "no sliding motion was found, and the contacts cannot hold the excitation during the whole period"
            ),
        }
    }
}

/// What one contact does at a solution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactSolution {
    /// Half the range of the relative displacement, in m.
    pub amplitude: f64,
    /// Stick, slip, mixed or held.
    pub state: ContactState,
    /// Energy dissipated per period of the excitation, in J.
    pub dissipation: f64,
    /// Relative displacement first − second, one-sided amplitudes in m, one a harmonic of [`crate::Plan::orders`].
    pub displacement: Vec<Complex64>,
    /// Force on the first body, one-sided amplitudes in N, likewise.
    pub force: Vec<Complex64>,
    /// Turning points of the relative displacement in a period of the reduced problem.
    pub turning_points: usize,
    /// The amplitude left the range in which the law was measured.
    pub extrapolated: bool,
}

/// What one joint does at a solution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointSolution {
    /// Stick, slip, mixed or apart.
    pub state: ContactState,
    /// Part of the period during which the bodies are apart, 0 … 1.
    pub apart: f64,
    /// Periods that were followed until the state of the contact repeated itself.
    pub cycles: usize,
    /// Energy dissipated per period of the excitation by all directions together, in J.
    pub dissipation: f64,
    /// The motion left the range in which the law was measured.
    pub extrapolated: bool,
    /// One entry a direction, the normal one last.
    pub directions: Vec<DirectionSolution>,
}

/// One direction of a joint at a solution.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DirectionSolution {
    /// Half the range of the relative displacement, in m.
    pub amplitude: f64,
    /// Relative displacement, one-sided amplitudes in m, one a harmonic of [`crate::Plan::orders`].
    pub displacement: Vec<Complex64>,
    /// Force on the first body, one-sided amplitudes in N, likewise.
    pub force: Vec<Complex64>,
}

/// What the solution took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stats {
    /// Solutions of the first harmonic alone, where all of them are found.
    pub starts: usize,
    /// Newton steps, all attempts together.
    pub iterations: usize,
    /// Rungs of the ladder in N that were climbed.
    pub rungs: usize,
    /// Extra rungs after one failed.
    pub extra_rungs: usize,
    /// Homotopies from contacts replaced by secant stiffnesses.
    pub secant_homotopies: usize,
    /// Homotopies in the contact force.
    pub contact_homotopies: usize,
    /// Homotopies in the excitation.
    pub excitation_homotopies: usize,
    /// Homotopies in the stiffness of the contacts.
    pub stiffness_homotopies: usize,
    /// Homotopies in the damping.
    pub damping_homotopies: usize,
    /// Homotopies in the contact force along the arc, through folds.
    pub arclength_homotopies: usize,
    /// Starts from no motion.
    pub starts_at_rest: usize,
    /// Perturbed starts.
    pub perturbed_starts: usize,
    /// Detours over other frequencies.
    pub detours: usize,
}

/// The answer at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// In Hz.
    pub frequency: f64,
    /// How it ended.
    pub status: Status,
    /// N of this solution.
    pub harmonics: usize,
    /// How many of its harmonics were found by substitution instead of Newton's method (the slaved tail).
    pub slaved: usize,
    /// Estimate of the relative l2 error of the displacement spectrum from having stopped at N, the worst of the output
    /// dofs; `None` where none was made.
    pub truncation_error: Option<f64>,
    /// Estimate of the same error from sampling the contact forces; `None` where none was made, 0 without samples.
    pub sampling_error: Option<f64>,
    /// Residual relative to the excitation, at the solution.
    pub residual: f64,
    /// Relative residuals of the last attempt, first to last.
    pub residual_history: Vec<f64>,
    /// How many solutions exist, where that is known (one harmonic, one contact).
    pub solutions: Option<usize>,
    /// One-sided amplitudes in m: one row per output dof, one column per harmonic of [`crate::Plan::orders`]. Empty
    /// when the point failed.
    pub displacement: Vec<Vec<Complex64>>,
    /// One entry a contact. Empty when the point failed.
    pub contacts: Vec<ContactSolution>,
    /// One entry a joint. Empty when the point failed.
    pub joints: Vec<JointSolution>,
    /// Floquet multipliers, where they were asked for and Hill's method has them; [`crate::Plan::stability`] says why not.
    pub stability: Option<Stability>,
    /// What it took.
    pub stats: Stats,
    /// The other solutions, where asked for.
    pub others: Vec<Solution>,
}

impl Default for Solution {
    /// Nothing solved yet.
    fn default() -> Self {
        Self::empty(0.0, 0)
    }
}

impl Solution {
    /// A point that is not solved yet.
    pub(crate) fn empty(frequency: f64, harmonics: usize) -> Self {
        Self {
            frequency,
            status: Status::Failed(FailureReason::NotConverged),
            harmonics,
            slaved: 0,
            truncation_error: None,
            sampling_error: None,
            residual: f64::INFINITY,
            residual_history: Vec::new(),
            solutions: None,
            displacement: Vec::new(),
            contacts: Vec::new(),
            joints: Vec::new(),
            stability: None,
            stats: Stats::default(),
            others: Vec::new(),
        }
    }

    /// Forgets the answer; rows keep their memory.
    pub(crate) fn clear(&mut self, frequency: f64, harmonics: usize) {
        self.frequency = frequency;
        self.harmonics = harmonics;
        self.slaved = 0;
        (self.truncation_error, self.sampling_error) = (None, None);
        self.status = Status::Failed(FailureReason::NotConverged);
        self.residual = f64::INFINITY;
        self.residual_history.clear();
        self.solutions = None;
        self.stability = None;
        self.stats = Stats::default();
        self.others.clear();
    }

    /// The point has no solution, so it has no numbers either.
    pub(crate) fn fail(&mut self, reason: FailureReason) {
        self.status = Status::Failed(reason);
        self.residual = f64::INFINITY;
        self.displacement.clear();
        self.contacts.clear();
        self.joints.clear();
    }

    /// Whether every number is one: where rounding leaves nothing there is no solution.
    pub(crate) fn is_finite(&self) -> bool {
        let contacts = self.contacts.iter().flat_map(|c| c.displacement.iter().chain(&c.force));
        let directions = self.joints.iter().flat_map(|joint| &joint.directions);
        let joints = directions.flat_map(|d| d.displacement.iter().chain(&d.force));
        self.displacement
            .iter()
            .flatten()
            .chain(contacts)
            .chain(joints)
            .all(|z| z.re.is_finite() && z.im.is_finite())
    }

    /// Whether `other` is another motion of contacts and joints, beyond the error of the iteration.
    pub(crate) fn differs_from(&self, other: &Self) -> bool {
        let motions = |solution: &'_ Self| -> Vec<Complex64> {
            let contacts = solution.contacts.iter().flat_map(|c| &c.displacement);
            let joints = solution.joints.iter().flat_map(|j| &j.directions).flat_map(|d| &d.displacement);
            contacts.chain(joints).copied().collect()
        };
        let (own, others) = (motions(self), motions(other));
        let entries = || own.iter().zip(&others);
        let distance: f64 = entries().map(|(a, b)| (a - b).norm_sqr()).sum();
        let size: f64 = entries().map(|(a, b)| a.norm_sqr() + b.norm_sqr()).sum();
        distance > 1e-12 * size
    }
}

/// One period of a solution in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform {
    /// Phase Ωt in rad of each instant: equidistant from 0 over one period of the excitation, its end left out.
    pub phase: Vec<f64>,
    /// Displacement in m, one row per output dof.
    pub displacement: Vec<Vec<f64>>,
    /// One entry a contact.
    pub contacts: Vec<WaveformContact>,
    /// One entry a joint.
    pub joints: Vec<WaveformJoint>,
}

/// One contact over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveformContact {
    /// Relative displacement first − second in m.
    pub displacement: Vec<f64>,
    /// Force on the first body in N, as the law gives it at every instant (not its truncated series).
    pub force: Vec<f64>,
}

/// One joint over a period; entries `[direction][instant]`, the normal direction last.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveformJoint {
    /// Relative displacement in m.
    pub displacement: Vec<Vec<f64>>,
    /// Force on the first body in N, as the law gives it at every instant (not its truncated series).
    pub force: Vec<Vec<f64>>,
}
