//! `model`: the dofs and the matrices of the structure.

use faer::Mat;
use hbm::{Damping, Model};

use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::matrix::{self, Matrix};
use crate::read::{Node, Object};
use crate::records::Records;
use crate::reduction::Wish;
use crate::sparse::Sparse;
use crate::structure::Structure;

pub(crate) const KEYS: [&str; 6] = ["dofs", "mass", "damping", "stiffness", "fixed", "reduction"];
pub(crate) const RAYLEIGH_KEYS: [&str; 2] = ["mass", "stiffness"];
const DAMPING_KEYS: [&str; 2] = ["rayleigh", "modal_ratio"];

/// What `model` says, before it is known whether it is solved as it is or reduced.
pub(crate) struct Matrices {
    pub(crate) dofs: Dofs,
    pub(crate) mass: Matrix,
    pub(crate) damping: GivenDamping,
    pub(crate) stiffness: Matrix,
}

pub(crate) enum GivenDamping {
    Matrix(Matrix),
    Rayleigh { mass: f64, stiffness: f64 },
    ModalRatio(f64),
}

/// Reads `model`.
pub(crate) fn read(node: &Node, records: &Records) -> Result<Structure, SceneError> {
    let model = node.object("dofs, mass, damping, stiffness, fixed, reduction", &KEYS)?;
    let wish = Wish::read(model.get("reduction"))?;
    let in_file = |key: &&str| model.get(key).is_some_and(|node| matrix::is_file(&node));
    if wish.is_reduced() || ["mass", "damping", "stiffness"].iter().any(in_file) {
        let read = || {
            let mut notes = Vec::new();
            Sparse::new(matrices(&model, records, &mut notes)?, wish, notes)
        };
        return records.structure(node.json(), read).map(Structure::Sparse);
    }
    let given = matrices(&model, records, &mut Vec::new())?;
    Structure::dense(given)
}

fn matrices(model: &Object, records: &Records, notes: &mut Vec<String>) -> Result<Matrices, SceneError> {
    let dofs = model.get("dofs").map(|dofs| Dofs::read(&dofs, records)).transpose()?;
    let n = dofs.as_ref().map(Dofs::len);
    let form = "[[…], …] in kg, or {\"matrix_market\": \"M.mtx\"}";
    let mass = matrix::read(&model.need("mass", form)?, n, records, notes)?;
    let dofs = match dofs {
        Some(dofs) => dofs,
        // Names of small matrices are a matter of course, and forgotten ones an error.
        None if mass.is_dense() => {
            return Err(model
                .need("dofs", "[\"w1\", \"w2\"]")
                .err()
                .unwrap_or_else(|| model.error("has no dofs")));
        }
        None => Dofs::counted(mass.size()),
    };
    let n = Some(dofs.len());
    let form = "[[…], …] in N s/m, {\"rayleigh\": …} or {\"modal_ratio\": …}";
    let damping = read_damping(&model.need("damping", form)?, n, records, notes)?;
    let form = "[[…], …] in N/m, or {\"matrix_market\": \"K.mtx\"}";
    let stiffness = matrix::read(&model.need("stiffness", form)?, n, records, notes)?;
    let dofs = match model.get("fixed") {
        Some(fixed) => dofs.hold(&fixed, records)?,
        None => dofs,
    };
    Ok(Matrices { dofs, mass, damping, stiffness })
}

fn read_damping(
    node: &Node,
    n: Option<usize>,
    records: &Records,
    notes: &mut Vec<String>,
) -> Result<GivenDamping, SceneError> {
    if !node.is_object() || matrix::is_file(node) {
        return matrix::read(node, n, records, notes).map(GivenDamping::Matrix);
    }
    let damping = node.object("rayleigh or modal_ratio, or a file with a matrix", &DAMPING_KEYS)?;
    match (damping.get("rayleigh"), damping.get("modal_ratio")) {
        (Some(rayleigh), None) => {
            let factors = rayleigh.object("mass in 1/s and stiffness in s", &RAYLEIGH_KEYS)?;
            Ok(GivenDamping::Rayleigh {
                mass: factors.need("mass", "1.0, in 1/s")?.not_negative()?,
                stiffness: factors.need("stiffness", "1e-5, in s")?.not_negative()?,
            })
        }
        (None, Some(ratio)) => Ok(GivenDamping::ModalRatio(ratio.not_negative()?)),
        _ => Err(damping
            .error("write one of {\"rayleigh\": {\"mass\": a, \"stiffness\": b}} and {\"modal_ratio\": ζ}")),
    }
}

/// An error of the matrices under the entry it is about.
pub(crate) fn refused(error: structure::ModelError) -> SceneError {
    SceneError::entry(&format!("model.{}", error.matrix), error.problem)
}

/// The model of matrices that are all written in the scene, without those dofs that are held.
pub(crate) fn dense(given: Matrices) -> Result<(Dofs, Model, Option<Mat<f64>>), SceneError> {
    let Matrices { dofs, mass, damping, stiffness } = given;
    let held = dofs.held();
    let free: Vec<usize> = match &held {
        Some(held) => (0..held.len()).filter(|i| held.get(*i) == Some(&false)).collect(),
        None => (0..dofs.len()).collect(),
    };
    let written = |matrix: Matrix| match matrix {
        Matrix::Dense(matrix) => matrix,
        Matrix::Sparse(matrix) => matrix.to_dense(),
    };
    let part = |matrix: &Mat<f64>| Mat::from_fn(free.len(), free.len(), |i, j| matrix[(free[i], free[j])]);
    let mass = written(mass);
    let damping = match damping {
        GivenDamping::Matrix(matrix) => Damping::Matrix(part(&written(matrix))),
        GivenDamping::Rayleigh { mass, stiffness } => Damping::Rayleigh { mass, stiffness },
        GivenDamping::ModalRatio(ratio) => Damping::ModalRatio(ratio),
    };
    let model = Model::new(part(&mass), damping, part(&written(stiffness))).map_err(refused)?;
    Ok((dofs, model, held.map(|_| mass)))
}
