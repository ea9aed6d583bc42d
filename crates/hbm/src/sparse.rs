//! The dynamic stiffness of a structure that is not reduced: sparse matrices on one pattern, analysed once, factored for
//! every harmonic of every frequency.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par, c64};
use structure::{SparseDamping, SparseModel};

use crate::error::PlanError;
use crate::matrices::{Additions, balance};
use crate::rows::Rows;

/// M, D and C on the union of their patterns, with all places where rows may add springs.
#[derive(Debug)]
pub(crate) struct SparseMatrices {
    columns: Vec<usize>,
    rows: Vec<usize>,
    mass: Vec<f64>,
    damping: Vec<f64>,
    stiffness: Vec<f64>,
    symbolic: SymbolicLu<usize>,
}

/// A factorisation of one thread.
pub(crate) struct SparseFactor {
    values: Vec<c64>,
    numeric: NumericLu<usize, c64>,
    symbolic: SymbolicLu<usize>,
    factored: bool,
    /// Estimate of the smallest singular value of the balanced matrix.
    smallest: f64,
    scratch: MemBuffer,
    columns: usize,
}

/// Row and value of every entry of one column.
fn entries(matrix: &SparseColMat<usize, f64>, column: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    matrix.row_idx_of_col(column).zip(matrix.val_of_col(column).iter().copied())
}

fn check(name: &str, matrix: &SparseColMat<usize, f64>, n: usize) -> Result<(), PlanError> {
    let error = |problem: String| Err(PlanError { place: name.into(), problem });
    if (matrix.nrows(), matrix.ncols()) != (n, n) {
        return error(format!(
            "must be {n} x {n} as the mass has {n} rows, got {} x {}",
            matrix.nrows(),
            matrix.ncols()
        ));
    }
    for j in 0..n {
        if let Some((i, _)) = entries(matrix, j).find(|(_, value)| !value.is_finite()) {
            return error(format!("entry [{i}][{j}] is not a finite number"));
        }
    }
    Ok(())
}

impl SparseMatrices {
    /// Takes the matrices of `model`, and analyses their pattern.
    ///
    /// # Errors
    /// A matrix of another size or with an entry that is no number; modal damping, which needs modes.
    pub(crate) fn new(model: &SparseModel, springs: &Rows) -> Result<Self, PlanError> {
        let n = model.mass.nrows();
        check("mass", &model.mass, n)?;
        check("stiffness", &model.stiffness, n)?;
        let (own, by_mass, by_stiffness) = match &model.damping {
            SparseDamping::Matrix(damping) => {
                check("damping", damping, n)?;
                (Some(damping), 0.0, 0.0)
            }
            SparseDamping::Rayleigh { mass, stiffness } => (None, *mass, *stiffness),
            SparseDamping::ModalRatio(_) => {
                let problem =
                    "modal damping needs modes: reduce the model, or give Rayleigh damping or a matrix";
                return Err(PlanError { place: "damping".into(), problem: problem.into() });
            }
        };
        let mut beside: Vec<Vec<usize>> = vec![Vec::new(); n];
        for parts in springs.iter() {
            for &(dof, _) in parts {
                beside[dof].extend(parts.iter().map(|&(other, _)| other).filter(|other| *other != dof));
            }
        }
        let (mut columns, mut rows) = (vec![0], Vec::new());
        let (mut mass, mut damping, mut stiffness) = (Vec::new(), Vec::new(), Vec::new());
        let mut column: Vec<(usize, [f64; 3])> = Vec::new();
        for (j, beside) in beside.iter().enumerate() {
            column.clear();
            column.push((j, [0.0; 3]));
            column.extend(beside.iter().map(|&i| (i, [0.0; 3])));
            column.extend(entries(&model.mass, j).map(|(i, m)| (i, [m, by_mass * m, 0.0])));
            column.extend(entries(&model.stiffness, j).map(|(i, c)| (i, [0.0, by_stiffness * c, c])));
            column.extend(own.into_iter().flat_map(|d| entries(d, j)).map(|(i, d)| (i, [0.0, d, 0.0])));
            column.sort_by_key(|&(i, _)| i);
            for entries in column.chunk_by(|a, b| a.0 == b.0) {
                let sum = |part: usize| entries.iter().map(|(_, values)| values[part]).sum::<f64>();
                rows.extend(entries.first().map(|(i, _)| *i));
                mass.push(sum(0));
                damping.push(sum(1));
                stiffness.push(sum(2));
            }
            columns.push(rows.len());
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows);
        let symbolic = factorize_symbolic_lu(pattern, Default::default()).map_err(|_| PlanError {
            place: "model".into(),
            problem: "there is no memory for the factors of the sparse matrices; reduce the model".into(),
        })?;
        Ok(Self { columns, rows, mass, damping, stiffness, symbolic })
    }

    pub(crate) fn dofs(&self) -> usize {
        self.columns.len() - 1
    }

    /// Buffers for one thread.
    pub(crate) fn factor(&self) -> SparseFactor {
        SparseFactor {
            values: vec![c64::ZERO; self.rows.len()],
            numeric: NumericLu::new(),
            symbolic: self.symbolic.clone(),
            factored: false,
            smallest: 0.0,
            scratch: MemBuffer::new(faer::dyn_stack::StackReq::EMPTY),
            columns: 0,
        }
    }

    /// Position and row of every entry of column `j`.
    fn column(&self, j: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        (self.columns[j]..self.columns[j + 1]).map(|place| (place, self.rows[place]))
    }

    fn place(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.columns[column]..self.columns[column + 1];
        self.rows[range.clone()].binary_search(&row).ok().map(|offset| range.start + offset)
    }

    /// See [`crate::matrices::Matrices::factorise`].
    pub(crate) fn factorise(
        &self,
        omega: f64,
        additions: Additions,
        scale: &mut [f64],
        into: &mut SparseFactor,
    ) {
        let n = self.dofs();
        for (i, scale) in scale.iter_mut().enumerate() {
            *scale = self
                .place(i, i)
                .map_or(1.0, |own| balance(omega, self.mass[own], self.damping[own], self.stiffness[own]));
        }
        for j in 0..n {
            for (place, i) in self.column(j) {
                let entry = c64::new(
                    self.stiffness[place] - omega * omega * self.mass[place],
                    omega * (self.damping[place] - additions.self_excitation * self.mass[place]),
                );
                into.values[place] = entry * (scale[i] * scale[j]);
                if i == j && omega > 0.0 {
                    into.values[place].im += additions.damping;
                }
            }
        }
        for (parts, &spring) in additions.lent() {
            for &(row, by_row) in parts {
                for &(column, by_column) in parts {
                    if let Some(place) = self.place(row, column) {
                        into.values[place] += spring * (by_row * by_column * scale[row] * scale[column]);
                    }
                }
            }
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.columns, None, &self.rows);
        into.factorise(SparseColMatRef::new(pattern, &into.values.clone()));
    }

    /// See [`crate::matrices::Matrices::slope_times`].
    pub(crate) fn slope_times(&self, k: f64, omega: f64, w: &[c64]) -> Vec<c64> {
        let mut sums = vec![c64::ZERO; w.len()];
        for (j, w) in w.iter().enumerate() {
            for (place, i) in self.column(j) {
                sums[i] += c64::new(-2.0 * k * omega * self.mass[place], k * self.damping[place]) * w;
            }
        }
        sums
    }
}

impl SparseFactor {
    fn factorise(&mut self, matrix: SparseColMatRef<'_, usize, c64>) {
        self.reserve(self.symbolic.factorize_numeric_lu_scratch::<c64>(Par::Seq, Default::default()));
        let stack = MemStack::new(&mut self.scratch);
        let factored = self.symbolic.factorize_numeric_lu(
            &mut self.numeric,
            matrix,
            Par::Seq,
            stack,
            Default::default(),
        );
        self.factored = factored.is_ok();
        self.smallest = 0.0;
        if self.factored {
            // ‖H⁻¹ b‖ for a vector without structure; the largest singular value is of order one.
            let n = matrix.nrows();
            let part = |i: usize, turn: f64| (1.0 + (i + 1) as f64 * turn).fract() - 0.5;
            let mut probe = Mat::from_fn(n, 1, |i, _| {
                c64::new(part(i, 0.618_033_988_749_895), part(i, 0.414_213_562_373_095))
            });
            let size = probe.norm_l2();
            self.solve(probe.as_mut());
            self.smallest = size / probe.norm_l2();
        }
    }

    fn reserve(&mut self, request: faer::dyn_stack::StackReq) {
        if self.scratch.len() < request.unaligned_bytes_required() {
            self.scratch = MemBuffer::new(request);
        }
    }

    /// Replaces `rhs` by the solution; by numbers that are none when the matrix is singular.
    pub(crate) fn solve(&mut self, mut rhs: MatMut<'_, c64>) {
        if !self.factored {
            rhs.fill(c64::new(f64::NAN, f64::NAN));
            return;
        }
        if rhs.ncols() > self.columns {
            self.columns = rhs.ncols();
            self.reserve(self.symbolic.solve_in_place_scratch::<c64>(self.columns, Par::Seq));
        }
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        factors.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut self.scratch));
    }

    pub(crate) fn is_regular(&self, fraction: f64) -> bool {
        self.smallest > fraction
    }
}
