//! Mass, damping and stiffness, dense or sparse, and the factored dynamic stiffness of one harmonic.

use faer::{Mat, MatMut, c64};

use crate::condensation::Load;
use crate::dense::Lu;
use crate::modal::Modal;
use crate::rows::Rows;
use crate::sparse::{SparseFactor, SparseMatrices};

/// M, D and C of the structure.
#[derive(Debug)]
pub(crate) enum Matrices {
    Dense { mass: Mat<f64>, damping: Mat<f64>, stiffness: Mat<f64> },
    Sparse(SparseMatrices),
}

/// What is added to the dynamic stiffness.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Additions<'a> {
    /// Structural damping, as a part of every dof's own dynamic stiffness.
    pub(crate) damping: f64,
    /// This times the mass is taken off D, in 1/s.
    pub(crate) self_excitation: f64,
    pub(crate) rows: &'a Rows,
    /// A spring at every row in N/m, most of them zero.
    pub(crate) springs: &'a [c64],
}

impl<'a> Additions<'a> {
    /// The rows with a spring.
    pub(crate) fn lent(&self) -> impl Iterator<Item = (&'a [(usize, f64)], &'a c64)> {
        self.rows.iter().zip(self.springs).filter(|(_, spring)| **spring != c64::ZERO)
    }
}

/// The dynamic stiffness of one harmonic, factored; buffers are reused.
pub(crate) enum Factor {
    Dense(Lu<c64>),
    Sparse(Box<SparseFactor>),
}

impl Matrices {
    pub(crate) fn dofs(&self) -> usize {
        match self {
            Self::Dense { mass, .. } => mass.nrows(),
            Self::Sparse(matrices) => matrices.dofs(),
        }
    }

    /// The modes of dense matrices, where damping leaves them uncoupled and they are worth it.
    pub(crate) fn modal(&self, rows: &Rows, outputs: &[usize], loads: &[Vec<Load>]) -> Option<Modal> {
        match self {
            Self::Dense { mass, damping, stiffness } => {
                Modal::new(mass, damping, stiffness, rows, outputs, loads)
            }
            Self::Sparse(_) => None,
        }
    }

    /// Buffers for one thread, for so many right-hand sides.
    pub(crate) fn factor(&self, columns: usize) -> Factor {
        match self {
            Self::Dense { mass, .. } => Factor::Dense(Lu::new(mass.nrows(), columns)),
            Self::Sparse(matrices) => Factor::Sparse(Box::new(matrices.factor())),
        }
    }

    /// Right-hand sides that are solved at a time.
    pub(crate) fn block(&self, columns: usize) -> usize {
        match self {
            Self::Dense { .. } => columns,
            // A whole block would take the memory of many factorisations.
            Self::Sparse(_) => columns.min(32),
        }
    }

    /// Factors `S (C − ω² M + i ω D + additions) S`, balanced by its diagonal with S = `scale`, so that masses and
    /// stiffnesses of very different size become comparable.
    pub(crate) fn factorise(&self, omega: f64, additions: Additions, scale: &mut [f64], into: &mut Factor) {
        match (self, into) {
            (Self::Dense { mass, damping, stiffness }, Factor::Dense(lu)) => {
                let n = mass.nrows();
                for (i, scale) in scale.iter_mut().enumerate() {
                    *scale = balance(omega, mass[(i, i)], damping[(i, i)], stiffness[(i, i)]);
                }
                for j in 0..n {
                    for i in 0..n {
                        let entry = c64::new(
                            stiffness[(i, j)] - omega * omega * mass[(i, j)],
                            omega * (damping[(i, j)] - additions.self_excitation * mass[(i, j)]),
                        );
                        lu.matrix[(i, j)] = entry * (scale[i] * scale[j]);
                    }
                }
                if additions.damping != 0.0 && omega > 0.0 {
                    for i in 0..n {
                        // The matrix is balanced: its diagonal is of order one.
                        lu.matrix[(i, i)] += c64::new(0.0, additions.damping);
                    }
                }
                for (parts, &spring) in additions.lent() {
                    for &(row, by_row) in parts {
                        for &(column, by_column) in parts {
                            let size = by_row * by_column * scale[row] * scale[column];
                            lu.matrix[(row, column)] += spring * size;
                        }
                    }
                }
                lu.factor(n);
            }
            (Self::Sparse(matrices), Factor::Sparse(factor)) => {
                matrices.factorise(omega, additions, scale, factor);
            }
            // A factor comes from its own matrices.
            _ => {}
        }
    }

    /// `∂H/∂Ω w = (−2 k ω M + i k D) w` at harmonic k, ω = kΩ.
    pub(crate) fn slope_times(&self, k: f64, omega: f64, w: &[c64]) -> Vec<c64> {
        match self {
            Self::Dense { mass, damping, .. } => {
                let n = mass.nrows();
                let slope =
                    |i: usize, j: usize| c64::new(-2.0 * k * omega * mass[(i, j)], k * damping[(i, j)]);
                (0..n).map(|i| (0..n).map(|j| slope(i, j) * w[j]).sum()).collect()
            }
            Self::Sparse(matrices) => matrices.slope_times(k, omega, w),
        }
    }
}

/// 1/√ of the size of a dof's own dynamic stiffness.
pub(crate) fn balance(omega: f64, mass: f64, damping: f64, stiffness: f64) -> f64 {
    let size = stiffness.abs() + omega * omega * mass.abs() + omega * damping.abs();
    if size > 0.0 { 1.0 / size.sqrt() } else { 1.0 }
}

impl Factor {
    /// Replaces `rhs` by the solution of the balanced system.
    pub(crate) fn solve(&mut self, rhs: MatMut<'_, c64>) {
        match self {
            Self::Dense(lu) => lu.solve(rhs),
            Self::Sparse(factor) => factor.solve(rhs),
        }
    }

    /// Whether the balanced matrix is regular by this margin: its smallest pivot against its largest where it is dense,
    /// an estimate of its smallest singular value where it is sparse.
    pub(crate) fn is_regular(&self, fraction: f64) -> bool {
        match self {
            Self::Dense(lu) => lu.is_regular(fraction),
            Self::Sparse(factor) => factor.is_regular(fraction),
        }
    }
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Dense(lu) => lu.fmt(f),
            Self::Sparse(_) => write!(f, "SparseFactor"),
        }
    }
}
