//! Entries of a matrix in any order, and the compressed matrix they make.

use faer::Mat;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::matrix_file::MatrixFileError;

/// Rows and columns beyond this do not fit in memory together with a factor.
pub(crate) const MOST_DOFS: usize = 5_000_000;

/// Entries beyond this do not fit in memory.
pub(crate) const MOST_ENTRIES: usize = 100_000_000;

/// Entries in the order of a file; rows and columns count from zero and lie inside the matrix.
#[derive(Debug, Clone, Default)]
pub(crate) struct Entries {
    n: usize,
    rows: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Entries {
    /// None yet of an n × n matrix.
    pub(crate) fn new(n: usize) -> Result<Self, MatrixFileError> {
        if n == 0 {
            return Err(MatrixFileError::content("the matrix is empty"));
        }
        if n > MOST_DOFS {
            return Err(MatrixFileError::content(format!(
                "the matrix has {n} rows; more than {MOST_DOFS} are refused"
            )));
        }
        Ok(Self { n, ..Self::default() })
    }

    /// Makes room for so many more.
    pub(crate) fn reserve(&mut self, count: usize) {
        let count = count.min(MOST_ENTRIES);
        self.rows.reserve(count);
        self.columns.reserve(count);
        self.values.reserve(count);
    }

    /// Adds one; what is wrong with it otherwise.
    pub(crate) fn push(&mut self, row: usize, column: usize, value: f64) -> Result<(), String> {
        if row >= self.n || column >= self.n {
            let n = self.n;
            return Err(format!(
                "the entry in row {}, column {} is outside the {n} x {n} matrix",
                row + 1,
                column + 1
            ));
        }
        if !value.is_finite() {
            return Err(format!(
                "the entry in row {}, column {} is {value}, not a finite number",
                row + 1,
                column + 1
            ));
        }
        if self.values.len() == MOST_ENTRIES {
            return Err(format!("there are more than {MOST_ENTRIES} entries; more are refused"));
        }
        // Both are below MOST_DOFS.
        self.rows.push(row as u32);
        self.columns.push(column as u32);
        self.values.push(value);
        Ok(())
    }

    /// The matrix with rows in order in each column, entries at the same place summed in the order of the file, zeros
    /// left out; and how many entries stood at a place that had one before.
    pub(crate) fn matrix(self) -> (SparseColMat<usize, f64>, usize) {
        let n = self.n;
        // Sorted by row, then stably by column: each column has its rows in order.
        let by_row = counted(n, &self.rows, 0..self.rows.len());
        let order = counted(n, &self.columns, by_row.iter().copied());
        let mut starts = vec![0_usize; n + 1];
        let mut rows: Vec<usize> = Vec::with_capacity(order.len());
        let mut values: Vec<f64> = Vec::with_capacity(order.len());
        let mut repeated = 0;
        let mut next = order.into_iter().peekable();
        for column in 0..n {
            while let Some(k) = next.next_if(|&k| at(&self.columns, k) == column) {
                let row = at(&self.rows, k);
                let mut value = self.values.get(k).copied().unwrap_or_default();
                let same = |k: &usize| at(&self.columns, *k) == column && at(&self.rows, *k) == row;
                while let Some(k) = next.next_if(same) {
                    value += self.values.get(k).copied().unwrap_or_default();
                    repeated += 1;
                }
                if value != 0.0 {
                    rows.push(row);
                    values.push(value);
                }
            }
            if let Some(end) = starts.get_mut(column + 1) {
                *end = rows.len();
            }
        }
        (SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, starts, None, rows), values), repeated)
    }
}

fn at(indices: &[u32], k: usize) -> usize {
    indices.get(k).map_or(usize::MAX, |index| *index as usize)
}

/// The items sorted by their key in `keys` below n, equal ones in the order they come.
fn counted(n: usize, keys: &[u32], items: impl Iterator<Item = usize> + Clone) -> Vec<usize> {
    let mut places = vec![0_usize; n + 1];
    for item in items.clone() {
        if let Some(count) = places.get_mut(at(keys, item) + 1) {
            *count += 1;
        }
    }
    for i in 1..places.len() {
        places[i] += places[i - 1];
    }
    let mut sorted = vec![0; keys.len()];
    for item in items {
        if let Some(place) = places.get_mut(at(keys, item)) {
            if let Some(slot) = sorted.get_mut(*place) {
                *slot = item;
            }
            *place += 1;
        }
    }
    sorted
}

/// A dense square matrix without its zeros.
pub fn compressed(matrix: &Mat<f64>) -> SparseColMat<usize, f64> {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..matrix.ncols() {
        for i in (0..matrix.nrows()).filter(|&i| matrix[(i, j)] != 0.0) {
            rows.push(i);
            values.push(matrix[(i, j)]);
        }
        starts.push(rows.len());
    }
    let (n, m) = (matrix.nrows(), matrix.ncols());
    SparseColMat::new(SymbolicSparseColMat::new_checked(n, m, starts, None, rows), values)
}

/// The transpose, again with sorted rows.
pub(crate) fn transposed(matrix: &SparseColMat<usize, f64>) -> SparseColMat<usize, f64> {
    let mut starts = vec![0_usize; matrix.nrows() + 1];
    for &row in matrix.symbolic().row_idx() {
        starts[row + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let (mut rows, mut values) = (vec![0_usize; matrix.val().len()], vec![0.0; matrix.val().len()]);
    for column in 0..matrix.ncols() {
        for (&row, &value) in
            matrix.symbolic().row_idx_of_col_raw(column).iter().zip(matrix.val_of_col(column))
        {
            let place = next[row];
            rows[place] = column;
            values[place] = value;
            next[row] += 1;
        }
    }
    let (n, m) = (matrix.ncols(), matrix.nrows());
    SparseColMat::new(SymbolicSparseColMat::new_checked(n, m, starts, None, rows), values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_sorted_and_summed() {
        let mut entries = Entries::new(3).unwrap();
        for (row, column, value) in
            [(2, 1, 1.0), (0, 1, 2.0), (2, 1, 4.0), (1, 0, -3.0), (2, 2, 5.0), (2, 2, -5.0)]
        {
            entries.push(row, column, value).unwrap();
        }
        assert!(entries.push(3, 0, 1.0).unwrap_err().contains("row 4, column 1"));
        assert!(entries.push(0, 0, f64::NAN).is_err());
        let (matrix, repeated) = entries.matrix();
        assert_eq!(repeated, 2);
        assert_eq!(matrix.symbolic().col_ptr(), [0, 1, 3, 3]);
        assert_eq!(matrix.symbolic().row_idx(), [1, 0, 2]);
        assert_eq!(matrix.val(), [-3.0, 2.0, 5.0]);
        let back = transposed(&matrix);
        assert_eq!(back.to_dense(), matrix.to_dense().transpose());
        assert_eq!(transposed(&back).val(), matrix.val());
    }
}
