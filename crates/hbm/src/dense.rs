//! A dense LU factorisation in memory that is reused: factor and solve without allocating.

use std::ops::{Add, Mul, Sub};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::traits::ComplexField;
use faer::{Mat, MatMut, Par, Spec};

/// Up to this size a few lines of arithmetic are faster than a blocked algorithm begins.
const TINY: usize = 4;

/// LU of square matrices up to the size it was made for.
pub(crate) struct Lu<T: Entry> {
    /// Holds the matrix before [`Lu::factor`] and its factors afterwards; the leading block of the current size is
    /// in use.
    pub(crate) matrix: Mat<T>,
    size: usize,
    forward: Vec<usize>,
    backward: Vec<usize>,
    scratch: MemBuffer,
}

impl<T: Entry> Lu<T> {
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
        match size {
            0 => return,
            1 => return tiny::factor::<T, 1>(&mut self.matrix, forward),
            2 => return tiny::factor::<T, 2>(&mut self.matrix, forward),
            3 => return tiny::factor::<T, 3>(&mut self.matrix, forward),
            TINY => return tiny::factor::<T, TINY>(&mut self.matrix, forward),
            _ => {}
        }
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
    pub(crate) fn solve(&mut self, mut rhs: MatMut<'_, T>) {
        let size = self.size;
        let (Some(forward), Some(backward)) = (self.forward.get(..size), self.backward.get(..size)) else {
            return;
        };
        match size {
            0 => return,
            1 => return tiny::solve::<T, 1>(&self.matrix, forward, &mut rhs),
            2 => return tiny::solve::<T, 2>(&self.matrix, forward, &mut rhs),
            3 => return tiny::solve::<T, 3>(&self.matrix, forward, &mut rhs),
            TINY => return tiny::solve::<T, TINY>(&self.matrix, forward, &mut rhs),
            _ => {}
        }
        let factors = self.matrix.as_ref().submatrix(0, 0, size, size);
        // The factorisation above wrote both arrays as a permutation and its inverse.
        let permutation = PermRef::new_checked(forward, backward, size);
        solve::solve_in_place(factors, factors, permutation, rhs, Par::Seq, MemStack::new(&mut self.scratch));
    }

    /// Whether the smallest pivot of the last factorisation is above this fraction of the largest.
    pub(crate) fn is_regular(&self, fraction: f64) -> bool {
        self.pivot_ratio() > fraction
    }

    /// Smallest over largest pivot magnitude of the last factorisation; zero or not a number when singular.
    pub(crate) fn pivot_ratio(&self) -> f64 {
        let pivots = (0..self.size).map(|i| self.matrix[(i, i)].magnitude());
        let (low, high) = pivots.fold((f64::INFINITY, 0.0_f64), |(low, high), p| (low.min(p), high.max(p)));
        if self.size == 0 { 1.0 } else { low / high }
    }
}

impl<T: Entry> std::fmt::Debug for Lu<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Lu({})", self.size)
    }
}

/// What an elimination needs of its numbers.
pub(crate) trait Entry:
    ComplexField + Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// |x|.
    fn magnitude(self) -> f64;
    /// A size that tells larger from smaller, within a factor of two of |x|.
    fn size(self) -> f64;
    /// 1/x.
    fn inverse(self) -> Self;
}

impl Entry for f64 {
    #[inline]
    fn magnitude(self) -> f64 {
        self.abs()
    }

    #[inline]
    fn size(self) -> f64 {
        self.abs()
    }

    #[inline]
    fn inverse(self) -> Self {
        1.0 / self
    }
}

impl Entry for faer::c64 {
    #[inline]
    fn magnitude(self) -> f64 {
        let square = self.norm_sqr();
        if (1e-280..1e280).contains(&square) { square.sqrt() } else { self.norm() }
    }

    #[inline]
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }

    #[inline]
    fn inverse(self) -> Self {
        let square = self.norm_sqr();
        if (1e-280..1e280).contains(&square) {
            return self.conj() * (1.0 / square);
        }
        // One step of scaling where the square leaves the range of numbers.
        let scaled = self * (1.0 / self.size());
        scaled.conj() * (1.0 / scaled.norm_sqr() / self.size())
    }
}

/// Gaussian elimination with partial pivoting of N × N matrices.
mod tiny {
    use super::{Entry, Mat, MatMut};

    /// Replaces the leading block by its factors, L without its unit diagonal; row k was exchanged with `pivots[k]`.
    pub(super) fn factor<T: Entry, const N: usize>(matrix: &mut Mat<T>, pivots: &mut [usize]) {
        let mut a: [[T; N]; N] = std::array::from_fn(|j| std::array::from_fn(|i| matrix[(i, j)]));
        for k in 0..N {
            let mut pivot = k;
            for i in k + 1..N {
                if a[k][i].size() > a[k][pivot].size() {
                    pivot = i;
                }
            }
            pivots[k] = pivot;
            if pivot != k {
                for column in &mut a {
                    column.swap(k, pivot);
                }
            }
            let inverse = a[k][k].inverse();
            for entry in &mut a[k][k + 1..] {
                *entry *= inverse;
            }
            let (done, rest) = a.split_at_mut(k + 1);
            for column in rest {
                let top = column[k];
                for (entry, factor) in column[k + 1..].iter_mut().zip(&done[k][k + 1..]) {
                    *entry -= *factor * top;
                }
            }
        }
        for (j, column) in a.iter().enumerate() {
            for (i, entry) in column.iter().enumerate() {
                matrix[(i, j)] = *entry;
            }
        }
    }

    /// Replaces the columns of `rhs` by the solutions.
    pub(super) fn solve<T: Entry, const N: usize>(
        matrix: &Mat<T>,
        pivots: &[usize],
        rhs: &mut MatMut<'_, T>,
    ) {
        let a: [[T; N]; N] = std::array::from_fn(|j| std::array::from_fn(|i| matrix[(i, j)]));
        let inverses: [T; N] = std::array::from_fn(|k| a[k][k].inverse());
        for column in 0..rhs.ncols() {
            let mut x: [T; N] = std::array::from_fn(|i| rhs[(i, column)]);
            for (k, &pivot) in pivots.iter().enumerate() {
                x.swap(k, pivot);
            }
            for k in 0..N {
                let top = x[k];
                for (x, factor) in x[k + 1..].iter_mut().zip(&a[k][k + 1..]) {
                    *x -= *factor * top;
                }
            }
            for k in (0..N).rev() {
                x[k] *= inverses[k];
                let bottom = x[k];
                for (x, factor) in x[..k].iter_mut().zip(&a[k][..k]) {
                    *x -= *factor * bottom;
                }
            }
            for (i, x) in x.into_iter().enumerate() {
                rhs[(i, column)] = x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::c64;

    #[test]
    fn solves_systems_of_changing_size() {
        let mut lu = Lu::<c64>::new(5, 2);
        for size in [3, 1, 2, 4, 5] {
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
