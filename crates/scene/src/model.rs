//! `model`: the names of the dofs and the matrices of the structure.

use faer::Mat;
use hbm::{Damping, Model};

use crate::error::{NOT_YET, SceneError};
use crate::read::{Node, suggestion};

pub(crate) const KEYS: [&str; 4] = ["dofs", "mass", "damping", "stiffness"];
pub(crate) const RAYLEIGH_KEYS: [&str; 2] = ["mass", "stiffness"];
pub(crate) const DAMPING_KEYS: [&str; 3] = ["rayleigh", "modal_ratio", "matrix_market"];

/// The other side of a contact that is no dof.
pub(crate) const GROUND: &str = "ground";

/// The names of a model's dofs, in the order of its matrices.
#[derive(Debug, Clone)]
pub(crate) struct Dofs(Vec<String>);

impl Dofs {
    pub(crate) fn names(&self) -> &[String] {
        &self.0
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Index of the dof that `node` names.
    pub(crate) fn index(&self, node: &Node) -> Result<usize, SceneError> {
        let name = node.text("the name of a dof")?;
        self.0.iter().position(|known| known == name).ok_or_else(|| {
            let known: Vec<&str> = self.0.iter().take(16).map(String::as_str).collect();
            node.error(format!("there is no dof {name:?} in model.dofs; {}", suggestion(name, &known)))
        })
    }

    fn read(node: &Node) -> Result<Self, SceneError> {
        if node.is_object() {
            return Err(node.error(format!("names from a file are {NOT_YET}; list them: [\"w1\", \"w2\"]")));
        }
        let mut names: Vec<String> = Vec::new();
        for item in node.some("of names, one a dof")? {
            let name = item.text("the name of a dof")?;
            if name == GROUND {
                return Err(item.error("\"ground\" is what does not move; give the dof another name"));
            }
            if names.iter().any(|known| known == name) {
                return Err(item.error(format!("there is a dof {name:?} already; names must differ")));
            }
            names.push(name.to_owned());
        }
        Ok(Self(names))
    }
}

/// Reads `model`.
pub(crate) fn read(node: &Node) -> Result<(Dofs, Model), SceneError> {
    let model = node.object("dofs, mass, damping, stiffness", &KEYS)?;
    let dofs = Dofs::read(&model.need("dofs", "[\"w1\", \"w2\"]")?)?;
    let n = dofs.len();
    let mass = matrix(&model.need("mass", "[[…], …] in kg")?, n)?;
    let damping = model.need("damping", "[[…], …] in N s/m, {\"rayleigh\": …} or {\"modal_ratio\": …}")?;
    let damping = read_damping(&damping, n)?;
    let stiffness = matrix(&model.need("stiffness", "[[…], …] in N/m")?, n)?;
    let model = Model::new(mass, damping, stiffness)
        .map_err(|error| SceneError::entry(&format!("model.{}", error.matrix), error.problem))?;
    Ok((dofs, model))
}

fn read_damping(node: &Node, n: usize) -> Result<Damping, SceneError> {
    if !node.is_object() {
        return matrix(node, n).map(Damping::Matrix);
    }
    if node.peek("matrix_market").is_some() {
        return matrix(node, n).map(Damping::Matrix);
    }
    let damping = node.object("rayleigh or modal_ratio", &DAMPING_KEYS)?;
    match (damping.get("rayleigh"), damping.get("modal_ratio")) {
        (Some(rayleigh), None) => {
            let factors = rayleigh.object("mass in 1/s and stiffness in s", &RAYLEIGH_KEYS)?;
            Ok(Damping::Rayleigh {
                mass: factors.need("mass", "1.0, in 1/s")?.not_negative()?,
                stiffness: factors.need("stiffness", "1e-5, in s")?.not_negative()?,
            })
        }
        (None, Some(ratio)) => Ok(Damping::ModalRatio(ratio.not_negative()?)),
        _ => Err(damping
            .error("write one of {\"rayleigh\": {\"mass\": a, \"stiffness\": b}} and {\"modal_ratio\": ζ}")),
    }
}

/// A dense n × n matrix, row by row.
fn matrix(node: &Node, n: usize) -> Result<Mat<f64>, SceneError> {
    if let Some(file) = node.peek("matrix_market") {
        return Err(file.error(format!("Matrix Market files are {NOT_YET}; write the matrix row by row")));
    }
    let rows = node.list("of rows")?;
    if rows.len() != n {
        return Err(node.error(format!("must have {n} rows, one a dof in model.dofs, got {}", rows.len())));
    }
    let mut matrix = Mat::zeros(n, n);
    for (i, row) in rows.iter().enumerate() {
        let numbers = row.numbers("of numbers")?;
        if numbers.len() != n {
            return Err(row.error(format!("must have {n} numbers, one a dof, got {}", numbers.len())));
        }
        for (j, number) in numbers.into_iter().enumerate() {
            matrix[(i, j)] = number;
        }
    }
    Ok(matrix)
}
