//! What moves: matrices, loads and contacts.

use std::sync::Arc;

use contact::Law;
use faer::Mat;
use num_complex::Complex64;

/// `Re(amplitude · e^{i · harmonic · Ωt})` in N on one dof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Loaded dof.
    pub dof: usize,
    /// Harmonic of Ω; 0 is a static load.
    pub harmonic: usize,
    /// In N, at the frequency that is asked for.
    pub amplitude: Complex64,
}

/// A contact between a dof and another or the ground; its law acts on the relative displacement first − second.
#[derive(Debug, Clone)]
pub struct Contact {
    /// For messages and results.
    pub name: String,
    /// Dof of the first body.
    pub first: usize,
    /// Dof of the second body; `None` is the ground.
    pub second: Option<usize>,
    /// The law, of which only the mechanism is used.
    pub law: Arc<dyn Law>,
    /// Factor on the law's force; positive.
    pub scale: f64,
}

/// A structure with its loads and contacts, n dofs.
#[derive(Debug, Clone)]
pub struct System {
    /// M, n × n, in kg; regular.
    pub mass: Mat<f64>,
    /// D, n × n, in N s/m.
    pub damping: Mat<f64>,
    /// C, n × n, in N/m.
    pub stiffness: Mat<f64>,
    /// All loads; they add up.
    pub loads: Vec<Load>,
    /// All contacts.
    pub contacts: Vec<Contact>,
}
