//! Boundary conditions: dofs that are held, and the base that moves.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::checks::column;
use crate::error::ModelError;
use crate::model::{Damping, Model};
use crate::sparse::{SparseDamping, SparseModel};

/// Sparse matrices beyond this many dofs are not made dense.
pub const MOST_DENSE_DOFS: usize = 2000;

impl SparseModel {
    /// The structure with the dofs held at zero whose flag is up; the others keep their order. Modal damping is that of
    /// the held structure.
    #[must_use]
    pub fn fixed(&self, held: &[bool]) -> Self {
        let mut numbers = Vec::with_capacity(self.dofs());
        let mut free = 0;
        for i in 0..self.dofs() {
            let number = (held.get(i) != Some(&true)).then_some(free);
            free += usize::from(number.is_some());
            numbers.push(number);
        }
        let damping = match &self.damping {
            SparseDamping::Matrix(matrix) => SparseDamping::Matrix(part(matrix, &numbers, free)),
            other => other.clone(),
        };
        Self {
            mass: part(&self.mass, &numbers, free),
            damping,
            stiffness: part(&self.stiffness, &numbers, free),
        }
    }

    /// The same structure with dense matrices.
    ///
    /// # Errors
    /// When it has too many dofs for that, or the matrices are none of a structure.
    pub fn dense(&self) -> Result<Model, ModelError> {
        let n = self.dofs();
        if n > MOST_DENSE_DOFS {
            return Err(ModelError::new(
                "reduction",
                format!(
                    "{n} dofs are too many to be made dense (at most {MOST_DENSE_DOFS}), which modal damping, orbits and \
                     curves need; let the structure be reduced"
                ),
            ));
        }
        let damping = match &self.damping {
            SparseDamping::Matrix(matrix) => Damping::Matrix(matrix.to_dense()),
            SparseDamping::Rayleigh { mass, stiffness } => {
                Damping::Rayleigh { mass: *mass, stiffness: *stiffness }
            }
            SparseDamping::ModalRatio(ratio) => Damping::ModalRatio(*ratio),
        };
        Model::new(self.mass.to_dense(), damping, self.stiffness.to_dense())
    }
}

/// A x of a square matrix, for example M r in kg: the load of a base whose unit displacement moves the dofs by r.
pub fn times(matrix: &SparseColMat<usize, f64>, vector: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; matrix.nrows()];
    for (j, x) in vector.iter().enumerate().take(matrix.ncols()) {
        for (i, a) in column(matrix, j) {
            product[i] += a * x;
        }
    }
    product
}

/// Rows and columns that have a number, under their numbers.
fn part(
    matrix: &SparseColMat<usize, f64>,
    numbers: &[Option<usize>],
    free: usize,
) -> SparseColMat<usize, f64> {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (j, _) in numbers.iter().enumerate().filter(|(_, number)| number.is_some()) {
        for (i, value) in column(matrix, j) {
            if let Some(Some(row)) = numbers.get(i) {
                rows.push(*row);
                values.push(value);
            }
        }
        starts.push(rows.len());
    }
    SparseColMat::new(SymbolicSparseColMat::new_checked(free, free, starts, None, rows), values)
}

#[cfg(test)]
mod tests {
    use faer::{Mat, mat};

    use super::*;
    use crate::parse_matrix_market;

    #[test]
    fn held_dofs_are_left_out() {
        let text =
            "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 4\n2 1 1\n2 2 5\n3 2 2\n3 3 6\n";
        let mass = parse_matrix_market(text.as_bytes(), text.len() as u64).unwrap().matrix;
        let damping = SparseDamping::Matrix(mass.clone());
        let model = SparseModel::new(mass.clone(), damping, mass).unwrap();
        assert_eq!(times(&model.mass, &[1.0, 0.0, 1.0]), [4.0, 3.0, 6.0]);
        let fixed = model.fixed(&[true, false, false]);
        let dense = fixed.dense().unwrap();
        for matrix in [dense.mass(), dense.damping(), dense.stiffness()] {
            assert_eq!(matrix, &mat![[5.0, 2.0], [2.0, 6.0]]);
        }
        let middle = model.fixed(&[false, true]).dense().unwrap();
        assert_eq!(middle.mass(), &Mat::from_fn(2, 2, |i, j| if i == j { [4.0, 6.0][i] } else { 0.0 }));
    }
}
