//! The derivative of a contact force: local stiffness and damping, and the memory of a few instants.

/// A linear functional of the motion that the force remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recall {
    /// `δw(τ)`: the displacement at phase τ (a turning point).
    Displacement {
        /// Phase in radians.
        tau: f64,
    },
    /// `δ(dw/dτ)(τ)`: the velocity at phase τ.
    Velocity {
        /// Phase in radians.
        tau: f64,
    },
    /// `δW_0`: the mean displacement.
    Mean,
}

/// One remembered functional and its influence on the force at every sample.
#[derive(Debug, Clone)]
pub struct Recalled {
    /// What is remembered.
    pub recall: Recall,
    /// `s(τ_j)` in N/m, one value a sample.
    pub influence: Vec<f64>,
}

/// The derivative of a sampled force,
/// `δf(τ_j) = κ(τ_j) δw(τ_j) + c(τ_j) δ(dw/dτ)(τ_j) + Σ_r s_r(τ_j) · recall_r(δw)`.
#[derive(Debug, Clone)]
pub struct Tangent {
    /// Local stiffness κ(τ_j) in N/m, one value a sample.
    pub local: Vec<f64>,
    /// c(τ_j) in N/m, filled when `rate_dependent`.
    rate: Vec<f64>,
    rate_dependent: bool,
    /// Slots for memories; only the first `active` are in use, so that their buffers survive.
    slots: Vec<Recalled>,
    active: usize,
}

impl Tangent {
    /// A zero tangent for `samples` samples a period.
    pub fn new(samples: usize) -> Self {
        Self {
            local: vec![0.0; samples],
            rate: Vec::new(),
            rate_dependent: false,
            slots: Vec::new(),
            active: 0,
        }
    }

    /// Forgets everything: κ = 0 at every sample, no influence of the velocity, no memory.
    pub fn clear(&mut self) {
        self.local.fill(0.0);
        self.rate_dependent = false;
        self.active = 0;
    }

    /// c(τ_j) = ∂f/∂(dw/dτ) in N/m, one value a sample; `None` when the force does not depend on the velocity.
    pub fn rate(&self) -> Option<&[f64]> {
        self.rate_dependent.then_some(&self.rate)
    }

    /// c(τ_j) to be filled in; only the first call allocates.
    pub fn rate_mut(&mut self) -> &mut [f64] {
        self.rate_dependent = true;
        self.rate.resize(self.local.len(), 0.0);
        &mut self.rate
    }

    /// The memories in use.
    pub fn memories(&self) -> &[Recalled] {
        self.slots.get(..self.active).unwrap_or_default()
    }

    /// Adds a memory without influence so far; returns the local stiffness and the new memory's influence to be
    /// filled in. Buffers are kept between evaluations: only the first one with this many memories allocates.
    pub fn remember(&mut self, recall: Recall) -> (&[f64], &mut [f64]) {
        let samples = self.local.len();
        if self.active == self.slots.len() {
            self.slots.push(Recalled { recall, influence: vec![0.0; samples] });
        }
        let Some(slot) = self.slots.get_mut(self.active) else { return (&self.local, &mut []) };
        self.active += 1;
        slot.recall = recall;
        slot.influence.fill(0.0);
        (&self.local, &mut slot.influence)
    }
}
