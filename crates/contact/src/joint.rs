//! What a contact in several directions answers: the trait [`JointLaw`] and the plain types it speaks in.
//!
//! A joint has one or two tangential directions and a normal one, **in this order, the normal last**. Its relative
//! displacement in each is first body − second body along an axis of the joint; the normal axis points from the first body to the
//! second, so that a positive normal displacement presses them together. Forces are in rig convention in every direction: the force
//! on the first body is −f, and a contact pressure N is f_n ≥ 0.

use std::fmt;

use num_complex::Complex64;

use crate::error::LawError;
use crate::events::ForcePiece;
use crate::law::ContactState;
use crate::mechanism::JointMechanism;

/// One period of the relative displacement of a joint.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<'a> {
    /// Number of directions d.
    pub directions: usize,
    /// `W_0 … W_N` in m of each direction, entry `[direction][k]`, one-sided: `w(τ) = Re Σ W_k e^{ikτ}`.
    pub spectrum: &'a [Complex64],
    /// `w(τ_j)` in m, entry `[direction][j]`, τ_j = 2πj/M.
    pub displacement: &'a [f64],
    /// `dw/dτ (τ_j)` in m, likewise.
    pub velocity: &'a [f64],
}

impl<'a> JointMotion<'a> {
    /// Samples a period.
    pub fn samples(&self) -> usize {
        self.displacement.len() / self.directions.max(1)
    }

    /// `w(τ_j)` in m of one direction; empty beyond the last.
    pub fn displacement_of(&self, direction: usize) -> &'a [f64] {
        part(self.displacement, direction, self.samples())
    }

    /// `dw/dτ (τ_j)` in m of one direction; empty beyond the last.
    pub fn velocity_of(&self, direction: usize) -> &'a [f64] {
        part(self.velocity, direction, self.samples())
    }

    /// `W_0 … W_N` in m of one direction; empty beyond the last.
    pub fn spectrum_of(&self, direction: usize) -> &'a [Complex64] {
        part(self.spectrum, direction, self.spectrum.len() / self.directions.max(1))
    }
}

fn part<T>(all: &[T], index: usize, length: usize) -> &[T] {
    all.get(index * length..(index + 1) * length).unwrap_or_default()
}

/// A small change `δw(τ) = Re(δW e^{ikτ})` of the motion in one direction.
#[derive(Debug, Clone, Copy)]
pub struct JointChange<'a> {
    /// The direction that changes.
    pub direction: usize,
    /// k.
    pub order: usize,
    /// δW in m.
    pub amplitude: Complex64,
    /// `δw(τ_j)` in m, one value a sample.
    pub displacement: &'a [f64],
}

/// What a force evaluation noticed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMarks {
    /// Stick, slip, both, or apart all the time.
    pub state: ContactState,
    /// Part of the period during which the bodies are apart, 0 … 1.
    pub apart: f64,
    /// Periods that were followed until the state of the contact repeated itself.
    pub cycles: usize,
    /// The motion left the range in which the law was measured.
    pub extrapolated: bool,
}

/// Buffers of one joint, made by its law once and reused by every evaluation; what is in them belongs to the law.
pub trait JointWorkspace: fmt::Debug + Send + Sync + std::any::Any {
    /// For the law that made it.
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any;
}

/// The law of a contact in several directions: its forces over one period of its relative displacement.
pub trait JointLaw: Send + Sync + fmt::Debug {
    /// The law's name in a scene file.
    fn name(&self) -> &'static str;

    /// Number of directions d: the tangential ones and the normal one.
    fn directions(&self) -> usize;

    /// Displacement in m of a direction at which the law changes its character. Solvers scale their unknowns with it.
    /// Zero where there is none: bodies that just touch at rest.
    fn length(&self, direction: usize) -> f64;

    /// The largest local stiffness in N/m that a motion in this direction alone can meet there; where that has no
    /// bound, the secant stiffness at [`JointLaw::length`].
    fn stiffness(&self, direction: usize) -> f64;

    /// Samples a period that the law asks for when the motion has `harmonics` harmonics.
    fn samples(&self, harmonics: usize) -> usize {
        (16 * (harmonics + 1)).max(256)
    }

    /// Buffers for motions with `samples` samples a period.
    fn workspace(&self, samples: usize) -> Box<dyn JointWorkspace>;

    /// The forces `f(τ_j)` in N (rig convention), entry `[direction][j]`, as many as `motion.displacement`.
    ///
    /// # Errors
    /// [`LawError`] when the motion has no force under this law; `force` is then meaningless.
    fn force(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        force: &mut [f64],
    ) -> Result<JointMarks, LawError>;

    /// The change `δf(τ_j)` in N of all forces, entry `[direction][j]`, that `change` of the motion brings, to first order; the
    /// motion is the one that [`JointLaw::force`] was last called with in this workspace.
    fn derivative(
        &self,
        motion: &JointMotion,
        change: &JointChange,
        workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    );

    /// The forces by their events, where they are piecewise linear in the displacements.
    fn piecewise_linear(&self) -> Option<&dyn JointPiecewiseLinear> {
        None
    }

    /// Where the forces need samples: those of some directions by their events all the same. Every direction that is a
    /// coupling's `force` is known by its couplings alone.
    fn partly_piecewise_linear(&self) -> Option<&dyn JointPiecewiseLinear> {
        None
    }

    /// What moves the joint in time, for those who integrate motions.
    fn mechanism(&self) -> JointMechanism {
        JointMechanism::None { why: "its forces at an instant depend on the whole period" }
    }
}

/// What the displacement in one direction does to the force in one direction, in pieces: the force is the sum over all pieces
/// of all couplings, with `w` of a piece the displacement in `displacement`, and its memory recalls that displacement too.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// Direction of the force.
    pub force: usize,
    /// Direction of the displacement.
    pub displacement: usize,
    /// One period of it.
    pub pieces: Vec<ForcePiece>,
}

/// A joint law whose forces are piecewise linear in the displacements; see [`crate::PiecewiseLinear`].
pub trait JointPiecewiseLinear {
    /// The couplings that there can be, without pieces.
    fn couplings(&self) -> Vec<Coupling>;

    /// The pieces of one period of `motion`, into the couplings that [`JointPiecewiseLinear::couplings`] gave. Only spectra
    /// and velocity samples of the motion are used.
    ///
    /// # Errors
    /// [`LawError`] when the motion has no force under this law.
    fn pieces(
        &self,
        motion: &JointMotion,
        workspace: &mut dyn JointWorkspace,
        couplings: &mut [Coupling],
    ) -> Result<JointMarks, LawError>;
}
