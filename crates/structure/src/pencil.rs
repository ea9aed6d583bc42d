//! Stiffness and mass on one sparse pattern, so that C − σM is one analysis and many factorisations.

use faer::sparse::{SparseColMat, SymbolicSparseColMatRef};
use faer::{Mat, MatRef};

/// Right-hand sides that are multiplied at a time: a row of them fills whole vector registers.
const LANES: usize = 8;

/// Square matrices C and M with a common pattern, both triangles stored.
#[derive(Debug)]
pub(crate) struct Pencil {
    columns: Vec<usize>,
    rows: Vec<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

impl Pencil {
    /// The rows and columns `select` of both matrices, in that order; `place[dof]` is the position of a selected dof
    /// in it and `usize::MAX` for all others.
    pub(crate) fn new(
        stiffness: &SparseColMat<usize, f64>,
        mass: &SparseColMat<usize, f64>,
        select: &[usize],
        place: &[usize],
    ) -> Self {
        let mut out = Self { columns: vec![0], rows: Vec::new(), stiffness: Vec::new(), mass: Vec::new() };
        let mut column: Vec<(usize, f64, f64)> = Vec::new();
        for &dof in select {
            column.clear();
            column.extend(entries(stiffness, dof).map(|(row, value)| (place[row], value, 0.0)));
            column.extend(entries(mass, dof).map(|(row, value)| (place[row], 0.0, value)));
            column.retain(|&(row, c, m)| row != usize::MAX && (c != 0.0 || m != 0.0));
            column.sort_by_key(|&(row, ..)| row);
            let mut last = usize::MAX;
            for &(row, c, m) in &column {
                if row != last {
                    out.rows.push(row);
                    out.stiffness.push(0.0);
                    out.mass.push(0.0);
                    last = row;
                }
                if let (Some(stiffness), Some(mass)) = (out.stiffness.last_mut(), out.mass.last_mut()) {
                    *stiffness += c;
                    *mass += m;
                }
            }
            out.columns.push(out.rows.len());
        }
        out
    }

    pub(crate) fn size(&self) -> usize {
        self.columns.len() - 1
    }

    pub(crate) fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.size(), self.size(), &self.columns, None, &self.rows)
    }

    /// Values of C − σM on the pattern.
    pub(crate) fn shifted(&self, sigma: f64) -> Vec<f64> {
        self.stiffness.iter().zip(&self.mass).map(|(c, m)| c - sigma * m).collect()
    }

    /// Row, column and value of every entry of C − σM.
    pub(crate) fn triplets(&self, sigma: f64) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.size()).flat_map(move |column| {
            (self.columns[column]..self.columns[column + 1])
                .map(move |k| (self.rows[k], column, self.stiffness[k] - sigma * self.mass[k]))
        })
    }

    /// M x.
    pub(crate) fn mass_times(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        self.times(&self.mass, x)
    }

    /// (C − σM) x for the values that [`Pencil::shifted`] gave.
    pub(crate) fn times(&self, values: &[f64], x: MatRef<'_, f64>) -> Mat<f64> {
        multiply(self.size(), x, |column| {
            let range = self.columns[column]..self.columns[column + 1];
            self.rows[range.clone()].iter().copied().zip(values[range].iter().copied())
        })
    }
}

/// Row and value of every entry of one column.
pub(crate) fn entries(
    matrix: &SparseColMat<usize, f64>,
    column: usize,
) -> impl Iterator<Item = (usize, f64)> + '_ {
    matrix.row_idx_of_col(column).zip(matrix.val_of_col(column).iter().copied())
}

/// A x for a sparse square matrix.
pub(crate) fn sparse_times(matrix: &SparseColMat<usize, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    multiply(matrix.nrows(), x, |column| entries(matrix, column))
}

/// A x, where `column` gives rows and values of a column of A.
fn multiply<I: Iterator<Item = (usize, f64)>>(
    n: usize,
    x: MatRef<'_, f64>,
    column: impl Fn(usize) -> I,
) -> Mat<f64> {
    let mut out = Mat::zeros(n, x.ncols());
    let mut sums = vec![[0.0; LANES]; n];
    for first in (0..x.ncols()).step_by(LANES) {
        let lanes = LANES.min(x.ncols() - first);
        sums.fill([0.0; LANES]);
        for j in 0..n {
            let mut factor = [0.0; LANES];
            for (lane, factor) in factor.iter_mut().enumerate().take(lanes) {
                *factor = x[(j, first + lane)];
            }
            for (row, value) in column(j) {
                for (sum, factor) in sums[row].iter_mut().zip(&factor) {
                    *sum += value * factor;
                }
            }
        }
        for lane in 0..lanes {
            for (i, sum) in sums.iter().enumerate() {
                out[(i, first + lane)] = sum[lane];
            }
        }
    }
    out
}
