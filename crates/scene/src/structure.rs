//! The structure of a scene: as it is written, or large and sparse.

use std::sync::Arc;

use faer::Mat;
use hbm::Model;

use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::model::{self, Matrices};
use crate::sparse::Sparse;

/// Mass, damping and stiffness with the names of their dofs.
#[derive(Debug, Clone)]
pub(crate) enum Structure {
    /// Matrices written in the scene.
    Dense {
        dofs: Dofs,
        model: Box<Model>,
        /// M of all dofs, where some are held.
        mass: Option<Mat<f64>>,
    },
    /// Matrices from files, or to be reduced; shared by all variants of a scene.
    Sparse(Arc<Sparse>),
}

impl Structure {
    pub(crate) fn dense(given: Matrices) -> Result<Self, SceneError> {
        let (dofs, model, mass) = model::dense(given)?;
        Ok(Self::Dense { dofs, model: Box::new(model), mass })
    }

    pub(crate) fn dofs(&self) -> &Dofs {
        match self {
            Self::Dense { dofs, .. } => dofs,
            Self::Sparse(sparse) => &sparse.dofs,
        }
    }

    /// What was noticed in its files.
    pub(crate) fn notes(&self) -> &[String] {
        match self {
            Self::Dense { .. } => &[],
            Self::Sparse(sparse) => &sparse.notes,
        }
    }
}

/// The model of matrices written in the scene, its base moving in `directions`; dofs that are held move with it.
pub(crate) fn with_base(
    model: &Model,
    dofs: &Dofs,
    mass: Option<&Mat<f64>>,
    directions: &[Option<String>],
) -> Result<Model, SceneError> {
    let usual = directions.iter().all(Option::is_none);
    if usual && mass.is_none() || directions.is_empty() {
        return Ok(model.clone());
    }
    let mass = mass.unwrap_or(model.mass());
    let load = |direction: &Option<String>| {
        let motion = dofs.base_motion(direction.as_deref());
        let inertia = |i: usize| (0..mass.ncols()).zip(&motion).map(|(j, r)| mass[(i, j)] * r).sum();
        dofs.moving(&(0..mass.nrows()).map(inertia).collect::<Vec<f64>>())
    };
    model.clone().with_base_loads(directions.iter().map(load).collect()).map_err(model::refused)
}
