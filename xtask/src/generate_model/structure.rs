//! Mass and stiffness as they are written: lower triangles, column by column.

/// The lower triangle of a symmetric matrix.
#[derive(Debug, Clone, Default)]
pub(super) struct Lower {
    /// Row, column, value; sorted by column, then row.
    pub(super) entries: Vec<(usize, usize, f64)>,
}

/// A linear structure.
#[derive(Debug, Clone)]
pub(super) struct Structure {
    /// One a dof.
    pub(super) names: Vec<String>,
    /// M in kg.
    pub(super) mass: Lower,
    /// C in N/m.
    pub(super) stiffness: Lower,
}

impl Structure {
    pub(super) fn dofs(&self) -> usize {
        self.names.len()
    }
}

impl Lower {
    /// Appends an entry unless it is zero or above the diagonal.
    pub(super) fn push(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 && row >= column {
            self.entries.push((row, column, value));
        }
    }

    /// A x.
    pub(super) fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        for &(row, column, value) in &self.entries {
            product[row] += value * x[column];
            if row != column {
                product[column] += value * x[row];
            }
        }
        product
    }
}
