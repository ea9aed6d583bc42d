//! A dense LU factorisation in memory that is reused: factor and solve without allocating.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::traits::ComplexField;
use faer::{Mat, MatMut, Par, Spec};

/// LU of square matrices up to the size it was made for.
pub(crate) struct Lu<T: ComplexField> {
    /// Holds the matrix before [`Lu::factor`] and its factors afterwards; the leading block of the current size is
    /// in use.
    pub(crate) matrix: Mat<T>,
    size: usize,
    forward: Vec<usize>,
    backward: Vec<usize>,
    scratch: MemBuffer,
}

impl<T: ComplexField> Lu<T> {
    /// Room for matrices up to `capacity` × `capacity` and up to `columns` right-hand sides.
    pub(crate) fn new(capacity: usize, columns: usize) -> Self {
        let scratch = factor::lu_in_place_scratch::<usize, T>(capacity, capacity, Par::Seq, Spec::default())
            .or(solve::solve_in_place_scratch::<usize, T>(capacity, columns, Par::Seq));
        Self {
            matrix: Mat::zeros(capacity, capacity),
            size: 0,
            forward: vec![0; capacity],
            backward: vec![0; capacity],
            scratch: MemBuffer::new(scratch),
        }
    }

    /// Makes room for matrices of this size; what is in `matrix` is lost when there was not enough.
    pub(crate) fn reserve(&mut self, size: usize) {
        if size > self.forward.len() {
            *self = Self::new(size, 1);
        }
    }

    /// Factors the leading `size` × `size` block of `matrix`.
    pub(crate) fn factor(&mut self, size: usize) {
        self.size = size;
        let (Some(forward), Some(backward)) = (self.forward.get_mut(..size), self.backward.get_mut(..size))
        else {
            return;
        };
        factor::lu_in_place(
            self.matrix.as_mut().submatrix_mut(0, 0, size, size),
            forward,
            backward,
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Spec::default(),
        );
    }

    /// Replaces `rhs` by the solution of the system factored last.
    pub(crate) fn solve(&mut self, rhs: MatMut<'_, T>) {
        let size = self.size;
        let (Some(forward), Some(backward)) = (self.forward.get(..size), self.backward.get(..size)) else {
            return;
        };
        let factors = self.matrix.as_ref().submatrix(0, 0, size, size);
        // The factorisation above wrote both arrays as a permutation and its inverse.
        let permutation = PermRef::new_checked(forward, backward, size);
        solve::solve_in_place(factors, factors, permutation, rhs, Par::Seq, MemStack::new(&mut self.scratch));
    }

    /// Whether the smallest pivot of the last factorisation is above this fraction of the largest.
    pub(crate) fn is_regular(&self, fraction: f64) -> bool
    where
        T: Magnitude,
    {
        self.pivot_ratio() > fraction
    }

    /// Smallest over largest pivot magnitude of the last factorisation; zero or not a number when singular.
    pub(crate) fn pivot_ratio(&self) -> f64
    where
        T: Magnitude,
    {
        let pivots = (0..self.size).map(|i| self.matrix.get(i, i).magnitude());
        let (low, high) = pivots.fold((f64::INFINITY, 0.0_f64), |(low, high), p| (low.min(p), high.max(p)));
        if self.size == 0 { 1.0 } else { low / high }
    }
}

impl<T: ComplexField> std::fmt::Debug for Lu<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Lu({})", self.size)
    }
}

/// |x| as a plain number.
pub(crate) trait Magnitude {
    fn magnitude(&self) -> f64;
}

impl Magnitude for f64 {
    fn magnitude(&self) -> f64 {
        self.abs()
    }
}

impl Magnitude for faer::c64 {
    fn magnitude(&self) -> f64 {
        self.norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::c64;

    #[test]
    fn solves_systems_of_changing_size() {
        let mut lu = Lu::<c64>::new(3, 2);
        for size in [3, 1, 2] {
            let entry = |i: usize, j: usize| c64::new(1.0 / (1 + i + 2 * j) as f64, (i as f64) - (j as f64));
            for i in 0..size {
                for j in 0..size {
                    lu.matrix[(i, j)] = entry(i, j);
                }
            }
            lu.factor(size);
            let mut x = Mat::from_fn(size, 2, |i, j| c64::new(i as f64 + 1.0, j as f64));
            let b = x.clone();
            lu.solve(x.as_mut());
            for i in 0..size {
                for j in 0..2 {
                    let product: c64 = (0..size).map(|k| entry(i, k) * x[(k, j)]).sum();
                    assert!((product - b[(i, j)]).norm() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn a_singular_matrix_shows_in_the_pivots() {
        let mut lu = Lu::<f64>::new(2, 1);
        lu.matrix = faer::mat![[1.0, 2.0], [0.5, 1.0]];
        lu.factor(2);
        assert!(lu.pivot_ratio() < 1e-15);
    }
}
