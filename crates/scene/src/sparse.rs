//! A structure in files, or one that is to be reduced.

use std::sync::{Arc, Mutex};

use faer::sparse::SparseColMat;
use structure::{Reduction, SparseDamping, SparseModel};

use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::model::{GivenDamping, Matrices, refused};
use crate::reduction::{Key, Wish};

/// Sparse matrices, what is to become of them, and what became of them already.
#[derive(Debug)]
pub(crate) struct Sparse {
    pub(crate) dofs: Dofs,
    /// Of the dofs that move.
    pub(crate) model: SparseModel,
    /// M of all dofs, where some are held.
    mass: Option<SparseColMat<usize, f64>>,
    pub(crate) wish: Wish,
    pub(crate) notes: Vec<String>,
    /// Reductions that were made: variants of a scene often need the same.
    pub(crate) reductions: Mutex<Vec<(Key, Arc<Reduction>)>>,
}

impl Sparse {
    pub(crate) fn new(given: Matrices, wish: Wish, notes: Vec<String>) -> Result<Self, SceneError> {
        let Matrices { dofs, mass, damping, stiffness } = given;
        let damping = match damping {
            GivenDamping::Matrix(matrix) => SparseDamping::Matrix(matrix.sparse()),
            GivenDamping::Rayleigh { mass, stiffness } => SparseDamping::Rayleigh { mass, stiffness },
            // Without damping no mode is needed.
            GivenDamping::ModalRatio(0.0) => SparseDamping::Rayleigh { mass: 0.0, stiffness: 0.0 },
            GivenDamping::ModalRatio(ratio) => SparseDamping::ModalRatio(ratio),
        };
        let model = SparseModel::new(mass.sparse(), damping, stiffness.sparse()).map_err(refused)?;
        let (model, mass) = match dofs.held() {
            Some(held) => (model.fixed(&held), Some(model.mass)),
            None => (model, None),
        };
        Ok(Self { dofs, model, mass, wish, notes, reductions: Mutex::default() })
    }

    /// M r in kg on the dofs that move, for a base that moves in each of `directions`; dofs that are held move with it.
    pub(crate) fn base_loads(&self, directions: &[Option<String>]) -> Vec<Vec<f64>> {
        let mass = self.mass.as_ref().unwrap_or(&self.model.mass);
        let load = |direction: &Option<String>| {
            let motion = self.dofs.base_motion(direction.as_deref());
            self.dofs.moving(&structure::times(mass, &motion))
        };
        directions.iter().map(load).collect()
    }
}
