//! Sparse factorisation of a symmetric matrix, definite or not, with its inertia.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, Mat, MatMut, Par, Side};

use crate::pencil::Pencil;
use crate::reduction::ReductionError;

/// Right-hand sides that are solved at a time.
const BLOCK: usize = 32;

/// Backward error of a solve above which a factorisation counts as failed.
const BACKWARD: f64 = 1e-9;

/// What all factorisations of one pattern share: a fill-reducing order (AMD) and the pattern of the factor.
#[derive(Debug)]
pub(crate) struct FactorPlan {
    symbolic: SymbolicCholesky<usize>,
}

/// P (C − σM) Pᵀ = L B Lᵀ with blocks of size one and two in B, pivoted inside the supernodes.
pub(crate) struct Factor<'a> {
    plan: &'a FactorPlan,
    values: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl FactorPlan {
    pub(crate) fn new(pencil: &Pencil) -> Result<Self, ReductionError> {
        let parameters = CholeskySymbolicParams {
            // Pivoting needs supernodes.
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let order = SymmetricOrdering::Amd;
        let symbolic = factorize_symbolic_cholesky(pencil.pattern(), Side::Lower, order, parameters)
            .map_err(|_| ReductionError::Memory)?;
        Ok(Self { symbolic })
    }

    /// Numbers in a factor.
    pub(crate) fn len(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factorises C − σM. `None` when no factorisation was found that solves accurately: the matrix is singular to
    /// rounding, or σ unlucky.
    pub(crate) fn factorise(
        &self,
        pencil: &Pencil,
        sigma: f64,
    ) -> Result<Option<Factor<'_>>, ReductionError> {
        let n = pencil.size();
        let shifted = pencil.shifted(sigma);
        let memory = |_| ReductionError::Memory;
        let mut values = Vec::new();
        values.try_reserve_exact(self.len()).map_err(|_| ReductionError::Memory)?;
        values.resize(self.len(), 0.0);
        let (mut subdiagonal, mut forward, mut inverse) = (vec![0.0; n], vec![0; n], vec![0; n]);
        let scratch =
            self.symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        let mut scratch = MemBuffer::try_new(scratch).map_err(memory)?;
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut values,
            &mut subdiagonal,
            &mut forward,
            &mut inverse,
            SparseColMatRef::new(pencil.pattern(), &shifted),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut scratch),
            Default::default(),
        );
        drop(scratch);
        let factor = Factor { plan: self, values, subdiagonal, forward, inverse };
        Ok(factor.accurate(pencil, &shifted)?.then_some(factor))
    }
}

impl Factor<'_> {
    /// x ← (C − σM)⁻¹ x.
    pub(crate) fn solve(&self, mut x: MatMut<'_, f64>) -> Result<(), ReductionError> {
        let n = self.forward.len();
        let permutation = PermRef::new_checked(&self.forward, &self.inverse, n);
        let factor = IntranodeLbltRef::new(&self.plan.symbolic, &self.values, &self.subdiagonal, permutation);
        let width = BLOCK.min(x.ncols().max(1));
        let scratch = self.plan.symbolic.solve_in_place_scratch::<f64>(width, Par::Seq);
        let mut scratch = MemBuffer::try_new(scratch).map_err(|_| ReductionError::Memory)?;
        let columns = x.ncols();
        for first in (0..columns).step_by(width) {
            let block = x.as_mut().subcols_mut(first, width.min(columns - first));
            factor.solve_in_place_with_conj(Conj::No, block, Par::Seq, MemStack::new(&mut scratch));
        }
        Ok(())
    }

    /// Negative eigenvalues of C − σM: by Sylvester's law the number of eigenvalues of (C, M) below σ, as long as M is
    /// positive semidefinite.
    pub(crate) fn negative(&self) -> usize {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.plan.symbolic.raw() else { return 0 };
        let mut count = 0;
        for s in 0..symbolic.n_supernodes() {
            let (first, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
            let start = symbolic.col_ptr_for_val()[s];
            let height = (symbolic.col_ptr_for_val()[s + 1] - start) / (end - first);
            let diagonal = |k: usize| self.values[start + k * height + k];
            let mut k = 0;
            while k < end - first {
                let beside = self.subdiagonal[first + k];
                if beside == 0.0 {
                    count += usize::from(diagonal(k) < 0.0);
                    k += 1;
                } else {
                    // A block of two: indefinite, or both eigenvalues have the sign of its diagonal.
                    let determinant = diagonal(k) * diagonal(k + 1) - beside * beside;
                    count += if determinant < 0.0 { 1 } else { 2 * usize::from(diagonal(k) < 0.0) };
                    k += 2;
                }
            }
        }
        count
    }

    /// Whether a solve leaves no more than rounding: pivots are sought inside supernodes only, so this has to be asked.
    fn accurate(&self, pencil: &Pencil, shifted: &[f64]) -> Result<bool, ReductionError> {
        let n = self.forward.len();
        // Any vector without structure.
        let right = Mat::from_fn(n, 1, |i, _| (1.0 + i as f64 * 0.618_033_988_749_895).fract() - 0.5);
        let mut x = right.clone();
        self.solve(x.as_mut())?;
        let residual = &right - pencil.times(shifted, x.as_ref());
        let magnitudes: Vec<f64> = shifted.iter().map(|value| value.abs()).collect();
        let size = pencil.times(&magnitudes, Mat::from_fn(n, 1, |i, _| x[(i, 0)].abs()).as_ref());
        // Componentwise, so that dofs of any unit are judged alike.
        Ok((0..n).all(|i| residual[(i, 0)].abs() <= BACKWARD * (size[(i, 0)] + right[(i, 0)].abs())))
    }
}
