//! What moves: matrices, loads and contacts.

use std::sync::Arc;

use contact::{JointLaw, Law};
use faer::Mat;
use num_complex::Complex64;

use crate::error::OrbitError;

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

/// A contact in several directions that depend on each other.
#[derive(Debug, Clone)]
pub struct Joint {
    /// For messages and results.
    pub name: String,
    /// Relative displacement Σ coefficient · displacement in every direction as (dof, coefficient); as many as the law
    /// has, the normal one last.
    pub directions: Vec<Vec<(usize, f64)>>,
    /// The law, of which only the mechanism is used.
    pub law: Arc<dyn JointLaw>,
    /// Factor on the law's forces; positive.
    pub scale: f64,
}

/// A structure with its loads, contacts and joints, n dofs.
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
    /// All contacts in one direction.
    pub contacts: Vec<Contact>,
    /// All contacts in several directions.
    pub joints: Vec<Joint>,
}

impl System {
    /// Sizes, numbers and dofs, before anything is computed.
    pub(crate) fn check(&self, frequency: f64) -> Result<(), OrbitError> {
        if !(frequency.is_finite() && frequency > 0.0) {
            return Err(OrbitError::Frequency { frequency });
        }
        let dofs = self.mass.nrows();
        if dofs == 0 {
            return Err(OrbitError::Empty);
        }
        for (name, matrix) in
            [("mass", &self.mass), ("damping", &self.damping), ("stiffness", &self.stiffness)]
        {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            if (rows, columns) != (dofs, dofs) {
                return Err(OrbitError::Size { matrix: name, rows, columns, dofs });
            }
            if !(0..dofs).all(|j| matrix.col(j).iter().all(|entry| entry.is_finite())) {
                return Err(OrbitError::NotFinite { what: format!("an entry of the {name} matrix") });
            }
        }
        for (index, load) in self.loads.iter().enumerate() {
            let what = format!("load {index}");
            inside(&what, load.dof, dofs)?;
            if !load.amplitude.is_finite() {
                return Err(OrbitError::NotFinite { what: format!("the amplitude of {what}") });
            }
        }
        for contact in &self.contacts {
            let what = format!("contact \"{}\"", contact.name);
            inside(&what, contact.first, dofs)?;
            inside(&what, contact.second.unwrap_or(0), dofs)?;
            if !(contact.scale.is_finite() && contact.scale > 0.0) {
                return Err(OrbitError::Scale { contact: contact.name.clone(), scale: contact.scale });
            }
        }
        self.joints.iter().try_for_each(|joint| joint.check(dofs))
    }
}

impl Joint {
    fn check(&self, dofs: usize) -> Result<(), OrbitError> {
        let (given, expected) = (self.directions.len(), self.law.directions());
        if given != expected {
            return Err(OrbitError::Directions { joint: self.name.clone(), given, expected });
        }
        let what = format!("joint \"{}\"", self.name);
        for &(dof, coefficient) in self.directions.iter().flatten() {
            inside(&what, dof, dofs)?;
            if !coefficient.is_finite() {
                return Err(OrbitError::NotFinite { what: format!("a coefficient of {what}") });
            }
        }
        if !(self.scale.is_finite() && self.scale > 0.0) {
            return Err(OrbitError::Scale { contact: self.name.clone(), scale: self.scale });
        }
        Ok(())
    }
}

fn inside(what: &str, dof: usize, dofs: usize) -> Result<(), OrbitError> {
    if dof < dofs { Ok(()) } else { Err(OrbitError::Dof { what: what.to_owned(), dof, dofs }) }
}
