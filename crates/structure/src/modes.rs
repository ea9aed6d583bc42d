//! The lowest modes of a large sparse pencil (C, M): block Lanczos iteration with shift and inversion.
//!
//! With σ below all eigenvalues, C φ = λ M φ becomes (C − σM)⁻¹ M φ = θ φ with θ = 1/(λ − σ): a symmetric operator in the
//! inner product of M, whose largest eigenvalues are the lowest modes. The basis is kept M-orthonormal to rounding, and
//! blocks make repeated eigenvalues, as cyclic structures have them, come out together. How many modes there are below
//! a frequency is known from the inertia of C − λM; iteration goes on until all of them are found.
//!
//! Lanczos with blocks and inertia: Grimes, Lewis, Simon, SIAM J. Matrix Anal. Appl. 15 (1994) 228.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::factor::Factor;
use crate::pencil::Pencil;
use crate::reduction::ReductionError;

/// Columns a block. More than the usual multiplicity, and enough for matrix products.
const BLOCK: usize = 8;

/// Residual, relative to the eigenvalue θ, at which a pair counts as found.
const FOUND: f64 = 1e-9;

/// Part of a vector that is left after orthogonalisation and still counts as a direction.
const NOTHING: f64 = 1e-10;

/// Which modes are wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted {
    /// All `count` modes with λ below `limit`.
    Below { limit: f64, count: usize },
    /// The lowest so many, and what is needed to tell that they are the lowest.
    Lowest(usize),
}

/// Eigenvalues λ (ascending, squares of angular frequencies) and modes, one a column, φᵀ M φ = 1.
#[derive(Debug)]
pub(crate) struct Modes {
    pub(crate) squares: Vec<f64>,
    pub(crate) shapes: Mat<f64>,
}

/// An iteration that can go on when more modes are wanted.
pub(crate) struct Lanczos<'a> {
    pencil: &'a Pencil,
    factor: &'a Factor<'a>,
    sigma: f64,
    random: ChaCha8Rng,
    /// V: M-orthonormal columns, all without a part on massless motions.
    basis: Mat<f64>,
    /// M times the columns of V that A was not yet applied to.
    momenta: Mat<f64>,
    /// H, A V = V H: one column for each column of V that A was applied to.
    projected: Mat<f64>,
    /// Columns of V that A was applied to.
    done: usize,
    /// Columns of V.
    held: usize,
    /// No direction is left: V spans all motions with mass.
    complete: bool,
}

impl<'a> Lanczos<'a> {
    /// For C − σM positive definite, factorised.
    pub(crate) fn new(
        pencil: &'a Pencil,
        factor: &'a Factor<'a>,
        sigma: f64,
    ) -> Result<Self, ReductionError> {
        let mut lanczos = Self {
            pencil,
            factor,
            sigma,
            random: ChaCha8Rng::seed_from_u64(1994),
            basis: Mat::zeros(pencil.size(), 0),
            momenta: Mat::zeros(pencil.size(), 0),
            projected: Mat::new(),
            done: 0,
            held: 0,
            complete: false,
        };
        lanczos.widen(BLOCK)?;
        Ok(lanczos)
    }

    /// Goes on until the wanted modes are found; `progress` hears how many are.
    pub(crate) fn modes(
        &mut self,
        wanted: Wanted,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Modes, ReductionError> {
        let (Wanted::Below { count, .. } | Wanted::Lowest(count)) = wanted;
        let most = (4 * count + 40 * BLOCK).min(self.pencil.size());
        let mut look = (2 * count + 2 * BLOCK).min(most);
        loop {
            while self.done < look && !self.complete {
                self.step()?;
            }
            let Ritz { thetas, vectors, residuals } = self.ritz()?;
            let squares: Vec<f64> = thetas.iter().map(|theta| self.sigma + 1.0 / theta).collect();
            let found =
                residuals.iter().zip(&thetas).take_while(|(rest, theta)| **rest <= FOUND * **theta).count();
            let enough = match wanted {
                Wanted::Lowest(count) => found >= count || self.complete,
                Wanted::Below { limit, count } => {
                    let below = squares.iter().take_while(|square| **square < limit).count();
                    if found >= below && below < count {
                        // All there seems to be, but not all there is: directions that the start knows nothing of.
                        self.widen(BLOCK)?;
                    }
                    if found.min(below) > count {
                        return Err(ReductionError::Modes { found: below, of: count });
                    }
                    found.min(below) == count
                }
            };
            progress(found.min(count));
            if enough {
                let count = count.min(squares.len());
                let mut shapes = Mat::zeros(self.pencil.size(), count);
                let basis = self.basis.subcols(0, self.done);
                matmul(shapes.as_mut(), Accum::Replace, basis, vectors.subcols(0, count), 1.0, Par::Seq);
                return Ok(Modes { squares: squares[..count].to_vec(), shapes });
            }
            if self.complete || self.done >= most {
                return Err(ReductionError::Modes { found: found.min(count), of: count });
            }
            look = (self.done + self.done / 8 + BLOCK).min(most);
        }
    }

    /// One block: A times the newest columns.
    fn step(&mut self) -> Result<(), ReductionError> {
        let (first, end) = (self.done, self.held);
        let mut images = std::mem::replace(&mut self.momenta, Mat::zeros(self.pencil.size(), 0));
        self.factor.solve(images.as_mut())?;
        self.done = end;
        let (inside, corner) = self.append(images)?;
        let size = self.basis.ncols();
        self.projected.resize_with(size, size, |_, _| 0.0);
        self.projected.as_mut().submatrix_mut(0, first, end, end - first).copy_from(&inside);
        self.projected.as_mut().submatrix_mut(end, first, corner.nrows(), end - first).copy_from(&corner);
        self.complete = self.held == self.done;
        Ok(())
    }

    /// Random columns more.
    fn widen(&mut self, columns: usize) -> Result<(), ReductionError> {
        let columns = columns.min(self.pencil.size() - self.held);
        let fresh = self.fresh(columns)?;
        self.append(fresh)?;
        self.complete = self.held == self.done;
        Ok(())
    }

    /// Random columns in the range of A.
    fn fresh(&mut self, columns: usize) -> Result<Mat<f64>, ReductionError> {
        let x = Mat::from_fn(self.pencil.size(), columns, |_, _| self.random.random_range(-1.0..1.0));
        let mut x = self.pencil.mass_times(x.as_ref());
        self.factor.solve(x.as_mut())?;
        Ok(x)
    }

    /// Splits `block` = V · inside + W · corner with [V, W] M-orthonormal, and appends W to V. Columns of the block in
    /// the span of all others give random columns of W, and none when nothing is left.
    fn append(&mut self, mut block: Mat<f64>) -> Result<(Mat<f64>, Mat<f64>), ReductionError> {
        let (held, width) = (self.held, block.ncols());
        let mut inside = Mat::<f64>::zeros(held, width);
        let mut corner = Mat::<f64>::identity(width, width);
        let mut replaced = 0;
        let mut momenta = self.pencil.mass_times(block.as_ref());
        loop {
            let before: Vec<f64> = (0..block.ncols()).map(|c| inner(&block, &momenta, c, c).sqrt()).collect();
            let basis = self.basis.subcols(0, held);
            let mut share = Mat::<f64>::zeros(held, block.ncols());
            matmul(share.as_mut(), Accum::Replace, basis.transpose(), momenta.as_ref(), 1.0, Par::Seq);
            matmul(block.as_mut(), Accum::Add, basis, share.as_ref(), -1.0, Par::Seq);
            inside += &share * &corner;
            momenta = self.pencil.mass_times(block.as_ref());
            let (triangle, lost) = normalise(&mut block, &mut momenta, &before);
            corner = &triangle * &corner;
            if lost.is_empty() {
                // Once more until there was nothing to take away.
                let rest = (0..triangle.ncols()).map(|c| (triangle[(c, c)] - before[c]).abs() / before[c]);
                if rest.fold(share.norm_max(), f64::max) < 1e-10 {
                    break;
                }
                continue;
            }
            replaced += 1;
            if replaced <= 2 && held + block.ncols() <= self.pencil.size() {
                let fresh = self.fresh(lost.len())?;
                for (k, &c) in lost.iter().enumerate() {
                    block.col_mut(c).copy_from(fresh.col(k));
                    corner.row_mut(c).fill(0.0);
                }
            } else {
                let kept: Vec<usize> = (0..block.ncols()).filter(|c| !lost.contains(c)).collect();
                block = Mat::from_fn(block.nrows(), kept.len(), |i, c| block[(i, kept[c])]);
                corner = Mat::from_fn(kept.len(), width, |r, c| corner[(kept[r], c)]);
            }
            momenta = self.pencil.mass_times(block.as_ref());
        }
        self.held = held + block.ncols();
        if self.held > self.basis.ncols() {
            let room = (2 * self.basis.ncols()).max(self.held);
            self.basis.resize_with(self.pencil.size(), room, |_, _| 0.0);
        }
        self.basis.as_mut().subcols_mut(held, block.ncols()).copy_from(&block);
        let before = self.momenta.ncols();
        self.momenta.resize_with(self.pencil.size(), before + block.ncols(), |i, c| momenta[(i, c - before)]);
        Ok((inside, corner))
    }

    /// What V knows of the modes.
    fn ritz(&self) -> Result<Ritz, ReductionError> {
        let m = self.done;
        let h = &self.projected;
        let symmetric = Mat::from_fn(m, m, |i, j| 0.5 * (h[(i, j)] + h[(j, i)]));
        let (values, vectors) = eigen(symmetric.as_ref())?;
        let order: Vec<usize> = (0..m).rev().filter(|&k| values[k] > 0.0).collect();
        let vectors = Mat::from_fn(m, order.len(), |i, k| vectors[(i, order[k])]);
        let outside = h.as_ref().submatrix(m, 0, self.held - m, m);
        let rest = outside * &vectors;
        let residuals = (0..order.len()).map(|k| rest.col(k).norm_l2()).collect();
        let thetas = order.iter().map(|&k| values[k]).collect();
        Ok(Ritz { thetas, vectors, residuals })
    }
}

/// Approximate eigenvalues θ of A, descending and positive, with vectors in terms of V and residuals in the norm of M.
struct Ritz {
    thetas: Vec<f64>,
    vectors: Mat<f64>,
    residuals: Vec<f64>,
}

/// xᵢᵀ M yⱼ from x and M y.
fn inner(x: &Mat<f64>, momenta: &Mat<f64>, i: usize, j: usize) -> f64 {
    x.col(i).transpose() * momenta.col(j)
}

/// Gram–Schmidt within a block, in the inner product of M: block ← W with block = W · triangle, and M times it. Columns of which less
/// than [`NOTHING`] of their norm `before` is left are listed, and zero in W.
fn normalise(block: &mut Mat<f64>, momenta: &mut Mat<f64>, before: &[f64]) -> (Mat<f64>, Vec<usize>) {
    let width = block.ncols();
    let mut triangle = Mat::zeros(width, width);
    let mut lost = Vec::new();
    for c in 0..width {
        for q in 0..c {
            let share = inner(block, momenta, q, c);
            triangle[(q, c)] = share;
            for matrix in [&mut *block, &mut *momenta] {
                for i in 0..matrix.nrows() {
                    matrix[(i, c)] -= share * matrix[(i, q)];
                }
            }
        }
        let norm = inner(block, momenta, c, c).max(0.0).sqrt();
        let factor = if norm > NOTHING * before[c] { 1.0 / norm } else { 0.0 };
        if factor == 0.0 {
            lost.push(c);
        } else {
            triangle[(c, c)] = norm;
        }
        for matrix in [&mut *block, &mut *momenta] {
            for i in 0..matrix.nrows() {
                matrix[(i, c)] *= factor;
            }
        }
    }
    (triangle, lost)
}

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix.
pub(crate) fn eigen(matrix: MatRef<'_, f64>) -> Result<(Vec<f64>, Mat<f64>), ReductionError> {
    let n = matrix.nrows();
    let mut values = Diag::<f64>::zeros(n);
    let mut vectors = Mat::zeros(n, n);
    // The decomposition neglects what is small against one, not against the matrix.
    let size = matrix.norm_max().max(f64::MIN_POSITIVE);
    let scaled = Mat::from_fn(n, n, |i, j| matrix[(i, j)] / size);
    let scratch = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut scratch = MemBuffer::try_new(scratch).map_err(|_| ReductionError::Memory)?;
    let stack = MemStack::new(&mut scratch);
    let (into, vectors_into) = (values.as_mut(), Some(vectors.as_mut()));
    self_adjoint_evd(scaled.as_ref(), into, vectors_into, Par::Seq, stack, Default::default())
        .map_err(|_| ReductionError::Modes { found: 0, of: n })?;
    Ok((values.column_vector().iter().map(|value| value * size).collect(), vectors))
}
