//! The lowest natural frequencies, by subspace iteration with a sparse Cholesky factor.

use anyhow::{Context, Result, anyhow};
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use super::plan::Pair;
use super::structure::{Lower, Structure};

/// Change of the frequencies asked for at which the iteration ends, and how long it may take.
const CLOSED: f64 = 1e-7;
const MOST: usize = 60;

/// The lowest `count` natural frequencies in Hz of those modes that `start`, forces column by column, does not leave out;
/// springs of `stiffness` at `contacts` included. More columns than `count` make it quicker.
pub(super) fn lowest(
    structure: &Structure,
    contacts: &[Pair],
    stiffness: f64,
    start: Mat<f64>,
    count: usize,
) -> Result<Vec<f64>> {
    let matrix = with_springs(&structure.stiffness, contacts, stiffness, structure.dofs())?;
    let factor = matrix.sp_cholesky(Side::Lower).map_err(|error| anyhow!("stiffness: {error:?}"))?;
    let mut vectors = factor.solve(&start);
    let mut known = vec![0.0; count];
    for _ in 0..MOST {
        let loads = product(&structure.mass, &vectors);
        vectors = factor.solve(&loads);
        // Rayleigh–Ritz: Xᵀ C X = Xᵀ M X_old, as C X = M X_old.
        let stiff = symmetric(&(vectors.transpose() * &loads));
        let mass = symmetric(&(vectors.transpose() * product(&structure.mass, &vectors)));
        let half = mass.llt(Side::Lower).map_err(|error| anyhow!("vectors became dependent: {error:?}"))?;
        let lower = half.L();
        let invert = |matrix: &Mat<f64>| {
            let mut inverted = matrix.clone();
            lower.solve_lower_triangular_in_place(inverted.as_mut());
            inverted
        };
        let reduced = invert(&invert(&stiff).transpose().to_owned());
        let modes = symmetric(&reduced)
            .self_adjoint_eigen(Side::Lower)
            .map_err(|error| anyhow!("natural frequencies: {error:?}"))?;
        let mut shapes = modes.U().to_owned();
        lower.transpose().solve_upper_triangular_in_place(shapes.as_mut());
        vectors = &vectors * shapes;
        let values = modes.S();
        let squares = values.column_vector().iter().take(count);
        let found: Vec<f64> = squares.map(|square| square.sqrt() / std::f64::consts::TAU).collect();
        let close = found.iter().zip(&known).all(|(new, old)| (new - old).abs() <= CLOSED * new);
        known = found;
        if close {
            break;
        }
    }
    Ok(known)
}

fn with_springs(
    stiffness: &Lower,
    contacts: &[Pair],
    spring: f64,
    n: usize,
) -> Result<SparseColMat<usize, f64>> {
    let mut entries: Vec<_> = stiffness.entries.iter().map(|&(i, j, k)| Triplet::new(i, j, k)).collect();
    for &(first, second) in contacts {
        entries.push(Triplet::new(first, first, spring));
        if let Some(second) = second {
            entries.push(Triplet::new(second, second, spring));
            entries.push(Triplet::new(first.max(second), first.min(second), -spring));
        }
    }
    SparseColMat::try_new_from_triplets(n, n, &entries).context("stiffness")
}

fn product(matrix: &Lower, vectors: &Mat<f64>) -> Mat<f64> {
    let mut product = Mat::zeros(vectors.nrows(), vectors.ncols());
    for j in 0..vectors.ncols() {
        let column: Vec<f64> = vectors.col(j).iter().copied().collect();
        for (i, value) in matrix.times(&column).into_iter().enumerate() {
            product[(i, j)] = value;
        }
    }
    product
}

fn symmetric(matrix: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]))
}
