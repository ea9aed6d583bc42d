//! Stiffness and mass on one sparse pattern, so that C − σM is one analysis and many factorisations.

use faer::sparse::{SparseColMat, SymbolicSparseColMatRef};
use faer::{Mat, MatRef};

/// Right-hand sides that are multiplied at a time: a row of them fills whole vector registers.
const LANES: usize = 8;

/// Symmetric matrices C and M with a common pattern, both triangles stored.
#[derive(Debug)]
pub(crate) struct Pencil {
    columns: Vec<usize>,
    rows: Vec<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    /// M once more, without the zeros of the common pattern: it is what is multiplied most.
    only_mass: Columns,
}

/// A matrix by columns.
#[derive(Debug, Default)]
struct Columns {
    ends: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
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
        let (mut columns, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut only_mass = Columns { ends: vec![0], ..Columns::default() };
        let mut column: Vec<(usize, f64, f64)> = Vec::new();
        for &dof in select {
            column.clear();
            column.extend(entries(stiffness, dof).map(|(row, value)| (place[row], value, 0.0)));
            column.extend(entries(mass, dof).map(|(row, value)| (place[row], 0.0, value)));
            column.retain(|&(row, c, m)| row != usize::MAX && (c != 0.0 || m != 0.0));
            column.sort_by_key(|&(row, ..)| row);
            for same in column.chunk_by(|a, b| a.0 == b.0) {
                let (c, m) = same.iter().fold((0.0, 0.0), |(c, m), entry| (c + entry.1, m + entry.2));
                rows.push(same[0].0);
                values.push((c, m));
                if m != 0.0 {
                    only_mass.rows.push(same[0].0);
                    only_mass.values.push(m);
                }
            }
            columns.push(rows.len());
            only_mass.ends.push(only_mass.rows.len());
        }
        let (stiffness, mass) = values.into_iter().unzip();
        Self { columns, rows, stiffness, mass, only_mass }
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
        let Columns { ends, rows, values } = &self.only_mass;
        multiply(x, |column| {
            let range = ends[column]..ends[column + 1];
            rows[range.clone()].iter().copied().zip(values[range].iter().copied())
        })
    }

    /// (C − σM) x for the values that [`Pencil::shifted`] gave.
    pub(crate) fn times(&self, values: &[f64], x: MatRef<'_, f64>) -> Mat<f64> {
        multiply(x, |column| {
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

/// Aᵀ x for a sparse square matrix: A x, where it is symmetric.
pub(crate) fn transpose_times(matrix: &SparseColMat<usize, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    multiply(x, |column| entries(matrix, column))
}

/// Aᵀ x, where `column` gives rows and values of a column of A.
fn multiply<I: Iterator<Item = (usize, f64)>>(x: MatRef<'_, f64>, column: impl Fn(usize) -> I) -> Mat<f64> {
    let n = x.nrows();
    let mut out = Mat::zeros(n, x.ncols());
    // A few columns at a time, side by side.
    let mut lanes = vec![[0.0; LANES]; n];
    for first in (0..x.ncols()).step_by(LANES) {
        let width = LANES.min(x.ncols() - first);
        for lane in 0..width {
            for (lanes, x) in lanes.iter_mut().zip(x.col(first + lane).iter()) {
                lanes[lane] = *x;
            }
        }
        for j in 0..n {
            let mut sums = [0.0; LANES];
            for (row, value) in column(j) {
                for (sum, x) in sums.iter_mut().zip(&lanes[row]) {
                    *sum += value * x;
                }
            }
            for (lane, sum) in sums.iter().enumerate().take(width) {
                out[(j, first + lane)] = *sum;
            }
        }
    }
    out
}
