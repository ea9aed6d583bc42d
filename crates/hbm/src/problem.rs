//! What is to be solved: model, excitation, contacts, and which dofs are wanted.

use std::sync::Arc;

use contact::{JointLaw, Law};

use structure::Model;

/// What the amplitude of an excitation means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExcitationKind {
    /// A force on one dof; amplitude in N.
    #[default]
    Force,
    /// A base acceleration; amplitude in m/s²; acts as −M·r on all dofs, whose displacements are
    /// relative to the base; r = 1 unless the model has other base motions.
    Base,
    /// A rotating unbalance on one dof; amplitude in kg m, force amplitude · Ω².
    Unbalance,
}

/// `amplitude · cos(harmonic · Ωt + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excitation {
    /// Excited dof; for [`ExcitationKind::Base`] which of [`Model::base_loads`], 0 in most models.
    pub dof: usize,
    /// Harmonic of Ω; 0 is a static load.
    pub harmonic: usize,
    /// In the unit of its kind.
    pub amplitude: f64,
    /// In rad.
    pub phase: f64,
    /// Force, base or unbalance.
    pub kind: ExcitationKind,
}

/// A contact between a dof and another or the ground. Its law acts on the relative displacement first − second.
#[derive(Debug, Clone)]
pub struct Contact {
    /// For messages and results.
    pub name: String,
    /// Dof of the first body.
    pub first: usize,
    /// Dof of the second body; `None` is the ground.
    pub second: Option<usize>,
    /// The law.
    pub law: Arc<dyn Law>,
    /// Factor on the law's force (several pads, another normal load); positive.
    pub scale: f64,
}

/// A direction of a joint: the relative displacement Σ coefficient · displacement over these dofs.
#[derive(Debug, Clone, PartialEq)]
pub struct Direction {
    /// (dof, coefficient); every dof at most once.
    pub parts: Vec<(usize, f64)>,
}

/// A contact in several directions that depend on each other: friction under a normal load that the motion changes.
#[derive(Debug, Clone)]
pub struct Joint {
    /// For messages and results.
    pub name: String,
    /// As many as the law has, the normal one last; see [`JointLaw`].
    pub directions: Vec<Direction>,
    /// The law.
    pub law: Arc<dyn JointLaw>,
    /// Factor on the law's forces; positive.
    pub scale: f64,
}

/// A mechanical model with contacts under periodic excitation.
#[derive(Debug, Clone)]
pub struct Problem<M = Model> {
    /// Mass, damping and stiffness: a [`Model`], or a [`structure::SparseModel`] that is not reduced.
    pub model: M,
    /// All excitations; they add up.
    pub excitation: Vec<Excitation>,
    /// All contacts in one direction.
    pub contacts: Vec<Contact>,
    /// All contacts in several directions.
    pub joints: Vec<Joint>,
    /// Dofs whose displacement is recovered, in this order.
    pub output: Vec<usize>,
}
