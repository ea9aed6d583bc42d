//! The linear structure with sparse matrices, as finite-element codes write it.

use faer::sparse::SparseColMat;

/// How the damping of a sparse structure is given.
#[derive(Debug, Clone)]
pub enum SparseDamping {
    /// D itself, any square matrix, in N s/m.
    Matrix(SparseColMat<usize, f64>),
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

/// A linear structure with n dofs, both triangles of its symmetric matrices stored.
#[derive(Debug, Clone)]
pub struct SparseModel {
    /// M in kg; symmetric, positive semidefinite.
    pub mass: SparseColMat<usize, f64>,
    /// D.
    pub damping: SparseDamping,
    /// C in N/m; symmetric.
    pub stiffness: SparseColMat<usize, f64>,
}
