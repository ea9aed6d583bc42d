//! Whether sparse matrices are those of a structure.

use faer::Par;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::entries::transposed;
use crate::error::ModelError;
use crate::sparse::{SparseDamping, SparseModel};

/// Relative asymmetry that is taken for rounding in a file.
const SYMMETRY: f64 = 1e-9;

/// Part of the diagonal by which an eigenvalue of the mass may be negative.
const MASSLESS: f64 = 1e-13;

impl SparseModel {
    /// Checks the matrices: n × n, finite, mass and stiffness symmetric, mass positive semidefinite and not zero.
    /// Rounding in their symmetry is taken out.
    ///
    /// # Errors
    /// [`ModelError`] naming the matrix and the entry; rows and columns count from 1, as in files.
    pub fn new(
        mass: SparseColMat<usize, f64>,
        damping: SparseDamping,
        stiffness: SparseColMat<usize, f64>,
    ) -> Result<Self, ModelError> {
        let n = mass.nrows();
        for (name, matrix) in
            [("mass", Some(&mass)), ("stiffness", Some(&stiffness)), ("damping", damping.matrix())]
        {
            let Some(matrix) = matrix else { continue };
            if (matrix.nrows(), matrix.ncols()) != (n, n) {
                let size = format!("{} x {}", matrix.nrows(), matrix.ncols());
                return Err(ModelError::new(
                    name,
                    format!("must be {n} x {n} as the mass has {n} rows, got {size}"),
                ));
            }
            if let Some(entry) = matrix.triplet_iter().find(|entry| !entry.val.is_finite()) {
                let (row, column) = (entry.row + 1, entry.col + 1);
                return Err(ModelError::new(
                    name,
                    format!("row {row}, column {column} is not a finite number"),
                ));
            }
        }
        let mass = symmetric("mass", mass)?;
        let stiffness = symmetric("stiffness", stiffness)?;
        semidefinite(&mass)?;
        Ok(Self { mass, damping, stiffness })
    }

    /// Number of dofs n.
    pub fn dofs(&self) -> usize {
        self.mass.nrows()
    }

    /// Stored entries of the stiffness, both triangles.
    pub fn nonzeros(&self) -> usize {
        self.stiffness.val().len()
    }
}

impl SparseDamping {
    fn matrix(&self) -> Option<&SparseColMat<usize, f64>> {
        match self {
            Self::Matrix(matrix) => Some(matrix),
            _ => None,
        }
    }
}

/// Entries of a column: row and value.
pub(crate) fn column(matrix: &SparseColMat<usize, f64>, j: usize) -> impl Iterator<Item = (usize, f64)> {
    matrix.symbolic().row_idx_of_col_raw(j).iter().copied().zip(matrix.val_of_col(j).iter().copied())
}

/// Checks symmetry up to rounding, and makes it exact.
fn symmetric(
    name: &'static str,
    matrix: SparseColMat<usize, f64>,
) -> Result<SparseColMat<usize, f64>, ModelError> {
    let mirror = transposed(&matrix);
    let same_places = matrix.symbolic().row_idx() == mirror.symbolic().row_idx()
        && matrix.symbolic().col_ptr() == mirror.symbolic().col_ptr();
    if same_places && matrix.val() == mirror.val() {
        return Ok(matrix);
    }
    let diagonal: Vec<f64> =
        (0..matrix.ncols()).map(|i| matrix.get(i, i).copied().unwrap_or_default()).collect();
    for j in 0..matrix.ncols() {
        for (i, value) in column(&matrix, j).chain(column(&mirror, j)) {
            let other = |a: &SparseColMat<usize, f64>| a.get(i, j).copied().unwrap_or_default();
            let (here, there) = (other(&matrix), other(&mirror));
            let scale = |i: usize| diagonal.get(i).copied().unwrap_or_default();
            // Against the diagonal, so that a model with masses of very different size is judged fairly.
            let size = value.abs().max(here.abs()).max((scale(i) * scale(j)).abs().sqrt() * 1e-3);
            if (here - there).abs() > SYMMETRY * size {
                let (row, column) = (i + 1, j + 1);
                return Err(ModelError::new(
                    name,
                    format!(
                        "must be symmetric, but row {row}, column {column} is {here} and row {column}, column {row} is {there}"
                    ),
                ));
            }
        }
    }
    Ok(faer::Scale(0.5) * (&matrix + &mirror))
}

/// D^{-1/2} M D^{-1/2} + ε must have a Cholesky factor, D being the diagonal and ε rounding; dofs without mass are left
/// out.
fn semidefinite(mass: &SparseColMat<usize, f64>) -> Result<(), ModelError> {
    let n = mass.ncols();
    let wrong = |problem: String| Err(ModelError::new("mass", problem));
    let diagonal: Vec<f64> = (0..n).map(|i| mass.get(i, i).copied().unwrap_or_default()).collect();
    let largest = diagonal.iter().copied().fold(0.0, f64::max);
    if mass.val().iter().all(|value| *value == 0.0) {
        return wrong("is zero; at least one dof needs a mass".into());
    }
    if let Some((i, value)) = diagonal.iter().enumerate().find(|(_, value)| **value < -MASSLESS * largest) {
        return wrong(format!("must be positive semidefinite, but row {0}, column {0} is {value}", i + 1));
    }
    // Numbers of the dofs that have mass.
    let mut massive = vec![None; n];
    let mut count = 0;
    for (i, value) in diagonal.iter().enumerate() {
        if *value > 0.0 {
            massive[i] = Some(count);
            count += 1;
        }
    }
    let mut lumped = true;
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n {
        for (i, value) in column(mass, j) {
            let (Some(row), Some(_)) = (massive[i], massive[j]) else {
                if value != 0.0 && i != j {
                    let (zero, other) = if massive[i].is_none() { (i + 1, j + 1) } else { (j + 1, i + 1) };
                    return wrong(format!(
                        "must be positive semidefinite, but row {zero}, column {zero} is zero and column {other} of this \
                         row is not"
                    ));
                }
                continue;
            };
            // One triangle is enough for the factor.
            if i < j {
                continue;
            }
            lumped &= i == j;
            rows.push(row);
            let shift = if i == j { MASSLESS * count as f64 } else { 0.0 };
            values.push(value / (diagonal[i] * diagonal[j]).sqrt() + shift);
        }
        if massive[j].is_some() {
            starts.push(rows.len());
        }
    }
    if lumped {
        return Ok(());
    }
    let scaled =
        SparseColMat::new(SymbolicSparseColMat::new_checked(count, count, starts, None, rows), values);
    match definite(&scaled) {
        Ok(true) => Ok(()),
        Ok(false) => wrong(
            "must be positive semidefinite, but has a negative eigenvalue (a motion with negative kinetic energy)".into(),
        ),
        Err(why) => wrong(format!("could not be checked: {why}")),
    }
}

/// Whether a symmetric matrix, lower triangle, has a Cholesky factor.
fn definite(matrix: &SparseColMat<usize, f64>) -> Result<bool, String> {
    let symbolic = factorize_symbolic_cholesky(
        matrix.symbolic(),
        Side::Lower,
        SymmetricOrdering::Amd,
        CholeskySymbolicParams::default(),
    )
    .map_err(|error| error.to_string())?;
    let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
    let mut memory =
        MemBuffer::try_new(scratch).map_err(|_| "its factor does not fit in memory".to_owned())?;
    let mut factor = Vec::new();
    factor
        .try_reserve_exact(symbolic.len_val())
        .map_err(|_| "its factor does not fit in memory".to_owned())?;
    factor.resize(symbolic.len_val(), 0.0);
    let outcome = symbolic.factorize_numeric_llt(
        &mut factor,
        matrix.as_ref(),
        Side::Lower,
        Default::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    );
    Ok(outcome.is_ok())
}

#[cfg(test)]
mod tests {
    use faer::{Mat, mat};

    use super::*;

    fn sparse(matrix: Mat<f64>) -> SparseColMat<usize, f64> {
        let mut entries = crate::entries::Entries::new(matrix.nrows()).unwrap();
        for j in 0..matrix.ncols() {
            for i in 0..matrix.nrows() {
                entries.push(i, j, matrix[(i, j)]).unwrap();
            }
        }
        entries.matrix().0
    }

    fn error(mass: Mat<f64>, stiffness: Mat<f64>) -> ModelError {
        SparseModel::new(sparse(mass), SparseDamping::ModalRatio(0.0), sparse(stiffness)).unwrap_err()
    }

    #[test]
    fn masses_that_are_none_are_named() {
        let c = Mat::<f64>::identity(3, 3);
        let refused = |mass: Mat<f64>, words: &str| {
            let error = error(mass, c.clone());
            assert!(error.matrix == "mass" && error.problem.contains(words), "{error}");
        };
        refused(Mat::zeros(3, 3), "is zero");
        refused(mat![[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], "row 2, column 2 is -1");
        refused(
            mat![[1.0, 0.1, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 1.0]],
            "row 2, column 2 is zero and column 1",
        );
        refused(mat![[1.0, 0.9, 0.9], [0.9, 1.0, -0.9], [0.9, -0.9, 1.0]], "negative eigenvalue");
        refused(
            mat![[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            "row 2, column 1 is 0 and row 1, column 2 is 0.5",
        );
        refused(mat![[1.0, 0.5, 0.0], [0.4, 1.0, 0.0], [0.0, 0.0, 1.0]], "row 2, column 1 is 0.4");
        assert_eq!(
            error(c.clone(), mat![[1.0, 0.5, 0.0], [0.4, 1.0, 0.0], [0.0, 0.0, 1.0]]).matrix,
            "stiffness"
        );
        assert!(error(Mat::identity(2, 2), c).problem.contains("must be 2 x 2"));
    }

    #[test]
    fn masses_of_any_size_pass() {
        let c = || sparse(Mat::identity(3, 3));
        for mass in [
            mat![[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e-9]],
            // Singular: a rigid bar between two dofs.
            mat![[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            mat![[1.0, 0.5e-6, 0.0], [0.5e-6, 1e-12, 0.0], [0.0, 0.0, 1e12]],
        ] {
            SparseModel::new(sparse(mass), SparseDamping::ModalRatio(0.0), c()).unwrap();
        }
        let rounded = mat![[1.0, 0.5, 0.0], [0.5 + 1e-12, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let model = SparseModel::new(sparse(rounded), SparseDamping::ModalRatio(0.0), c()).unwrap();
        assert_eq!(model.mass.get(0, 1), model.mass.get(1, 0));
    }
}
