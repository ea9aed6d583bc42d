//! The error of a reduced structure, measured against the full one.
//!
//! At a few frequencies the full structure is solved by a sparse factorisation of C − ω²M for loads on the kept dofs
//! and for the base motions. Displacements and loads are scaled, displacement j with s_j and load j with 1/s_j where
//! s_j² = C_jj + ω²M_jj of the reduced structure at the highest frequency, so that translations and rotations can be
//! added. The error at a frequency is the largest of ‖S(x − x̂)‖/‖S x‖ over the loads, x and x̂ being the displacements
//! of the kept dofs in the full and in the reduced structure.
//!
//! With many kept dofs the loads are random combinations, so it is a sample. Frequencies lie 0.2 % to 1 % above
//! resonances, from the lowest to the highest of the band, and at its end: near a resonance its shift by the reduction
//! tells most, and off it the undamped structure can be compared. At the peak of a resonance with a damping ratio ζ
//! below that distance the error is larger, by about their quotient. Damping is left out of the comparison unless it is
//! a matrix: Rayleigh and modal damping act on no motion that the modes could miss.

use std::f64::consts::TAU;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Par, c64};
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::factor::FactorPlan;
use crate::model::Model;
use crate::pencil::{Pencil, entries, transpose_times};
use crate::reduction::{Progress, ReductionError, ReductionOptions};
use crate::sparse::{SparseDamping, SparseModel};

/// Kept dofs up to which each of them is loaded by itself.
const SINGLE: usize = 24;

/// Random loads in place of them.
const RANDOM: usize = 12;

/// Resonances that the structures are compared at.
const RESONANCES: usize = 3;

/// The answers of the full structure.
pub(crate) struct Comparison {
    /// Loads on the kept dofs, one column a load; those of the base come after them.
    loads: Mat<f64>,
    /// s_j of the kept dofs.
    scale: Vec<f64>,
    /// Whether damping is part of it.
    damped: bool,
    /// Frequency in Hz, and displacements of the kept dofs under each load.
    answers: Vec<(f64, Mat<c64>)>,
}

impl Comparison {
    /// Chooses loads and frequencies with the help of a first reduced structure, and solves the full one. `base` has
    /// M r of the full structure.
    pub(crate) fn new(
        model: &SparseModel,
        keep: &[usize],
        base: &Mat<f64>,
        reduced: &Model,
        options: &ReductionOptions,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self, ReductionError> {
        let n = model.mass.nrows();
        let highest = (TAU * options.highest).powi(2);
        let scale: Vec<f64> = (0..keep.len())
            .map(|j| (reduced.stiffness()[(j, j)].abs() + highest * reduced.mass()[(j, j)].abs()).sqrt())
            .map(|scale| if scale > 0.0 { scale } else { 1.0 })
            .collect();
        let loads = if keep.len() <= SINGLE {
            Mat::from_fn(keep.len(), keep.len(), |i, j| if i == j { scale[i] } else { 0.0 })
        } else {
            let mut random = ChaCha8Rng::seed_from_u64(1968);
            Mat::from_fn(keep.len(), RANDOM, |i, _| scale[i] * random.random_range(-1.0..1.0))
        };
        let mut all = Mat::zeros(n, loads.ncols() + base.ncols());
        for j in 0..loads.ncols() {
            for (i, &dof) in keep.iter().enumerate() {
                all[(dof, j)] = loads[(i, j)];
            }
        }
        all.as_mut().subcols_mut(loads.ncols(), base.ncols()).copy_from(base);

        let dofs: Vec<usize> = (0..n).collect();
        let pencil = Pencil::new(&model.stiffness, &model.mass, &dofs, &dofs);
        let plan = FactorPlan::new(&pencil)?;
        let damping = match &model.damping {
            SparseDamping::Matrix(damping) => {
                Some(damping.transpose().to_col_major().map_err(|_| ReductionError::Memory)?)
            }
            _ => None,
        };
        let frequencies = frequencies(&reduced.natural_frequencies(), options);
        let of = frequencies.len();
        let mut answers = Vec::new();
        for (done, hz) in frequencies.into_iter().enumerate() {
            progress(Progress::Checking { done, of });
            if let Some(full) = respond(&pencil, &plan, damping.as_ref(), hz, &all)? {
                answers.push((hz, Mat::from_fn(keep.len(), all.ncols(), |i, j| full[(keep[i], j)])));
            }
        }
        Ok(Self { loads, scale, damped: damping.is_some(), answers })
    }

    /// s_j of the kept dofs.
    pub(crate) fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// Frequency in Hz and error of a reduced structure.
    pub(crate) fn errors(&self, reduced: &Model) -> Result<Vec<(f64, f64)>, ReductionError> {
        let base = reduced.base_loads();
        let (kept, given) = (self.loads.nrows(), self.loads.ncols());
        let loads = Mat::from_fn(reduced.dofs(), given + base.len(), |i, j| match j.checked_sub(given) {
            Some(motion) => base[motion][i],
            None if i < kept => self.loads[(i, j)],
            None => 0.0,
        });
        let error = |full: &Mat<c64>, answer: &Mat<c64>| {
            let of = |j: usize| {
                let norm = |of: &dyn Fn(usize) -> c64| {
                    (0..kept).map(|i| (of(i) * self.scale[i]).norm_sqr()).sum::<f64>().sqrt()
                };
                let size = norm(&|i| full[(i, j)]);
                let off = norm(&|i| full[(i, j)] - answer[(i, j)]);
                if size > 0.0 { off / size } else { off }
            };
            // NaN must not get lost.
            (0..full.ncols()).map(of).fold(0.0, |top: f64, e| if e <= top { top } else { e })
        };
        self.answers
            .iter()
            .map(|(hz, full)| Ok((*hz, error(full, &dense(reduced, self.damped, *hz, &loads)?))))
            .collect()
    }
}

/// Frequencies in Hz, ascending: near resonances of the band, and at its end, never on a resonance.
fn frequencies(resonances: &[f64], options: &ReductionOptions) -> Vec<f64> {
    let inside: Vec<f64> = resonances
        .iter()
        .copied()
        .filter(|hz| *hz >= options.lowest.max(1e-4 * options.highest) && *hz <= 0.98 * options.highest)
        .collect();
    let last = inside.len().saturating_sub(1);
    let mut chosen: Vec<usize> = (0..RESONANCES).map(|k| k * last / (RESONANCES - 1)).collect();
    chosen.dedup();
    let mut out: Vec<f64> = chosen
        .into_iter()
        .filter_map(|k| inside.get(k))
        .map(|hz| away(resonances, 1.002 * hz, 1.01 * hz))
        .collect();
    out.push(away(resonances, 0.99 * options.highest, options.highest));
    out
}

/// The frequency between two others that is farthest from all resonances.
fn away(resonances: &[f64], from: f64, to: f64) -> f64 {
    let mut edges = vec![from];
    edges.extend(resonances.iter().copied().filter(|hz| *hz > from && *hz < to));
    edges.push(to);
    let gap = |pair: &[f64]| pair[1] - pair[0];
    let widest = edges.windows(2).max_by(|a, b| gap(a).total_cmp(&gap(b)));
    widest.map_or(to, |pair| 0.5 * (pair[0] + pair[1]))
}

/// (C − ω²M + iωD)⁻¹ F of the full structure, with Dᵀ as `damping`; `None` where C − ω²M is singular to rounding.
fn respond(
    pencil: &Pencil,
    plan: &FactorPlan,
    damping: Option<&SparseColMat<usize, f64>>,
    hz: f64,
    loads: &Mat<f64>,
) -> Result<Option<Mat<c64>>, ReductionError> {
    let omega = TAU * hz;
    let Some(factor) = plan.factorise(pencil, omega * omega)? else { return Ok(None) };
    let mut undamped = loads.clone();
    factor.solve(undamped.as_mut())?;
    let (n, columns) = (loads.nrows(), loads.ncols());
    let Some(damping) = damping else {
        return Ok(Some(Mat::from_fn(n, columns, |i, j| c64::new(undamped[(i, j)], 0.0))));
    };
    // u = u₀ − (C − ω²M)⁻¹ iωD u, in real and imaginary part: converges where damping is light.
    let mut real = undamped.clone();
    let mut imaginary = Mat::<f64>::zeros(n, columns);
    for _ in 0..40 {
        let mut to_real = transpose_times(damping, imaginary.as_ref());
        let mut to_imaginary = transpose_times(damping, real.as_ref());
        factor.solve(to_real.as_mut())?;
        factor.solve(to_imaginary.as_mut())?;
        let next_real = Mat::from_fn(n, columns, |i, j| undamped[(i, j)] + omega * to_real[(i, j)]);
        let next_imaginary = Mat::from_fn(n, columns, |i, j| -omega * to_imaginary[(i, j)]);
        let change = (&next_real - &real).norm_l2().hypot((&next_imaginary - &imaginary).norm_l2());
        let size = next_real.norm_l2().hypot(next_imaginary.norm_l2());
        (real, imaginary) = (next_real, next_imaginary);
        if change <= 1e-13 * size {
            return Ok(Some(Mat::from_fn(n, columns, |i, j| c64::new(real[(i, j)], imaginary[(i, j)]))));
        }
        if !size.is_finite() || size > 1e6 * undamped.norm_l2() {
            break;
        }
    }
    direct(pencil, damping, omega, loads).map(Some)
}

/// The same by a factorisation of the complex matrix: slow, but for any damping.
fn direct(
    pencil: &Pencil,
    damping: &SparseColMat<usize, f64>,
    omega: f64,
    loads: &Mat<f64>,
) -> Result<Mat<c64>, ReductionError> {
    use faer::linalg::solvers::SolveCore as _;
    let n = pencil.size();
    let mut triplets: Vec<Triplet<usize, usize, c64>> = pencil
        .triplets(omega * omega)
        .map(|(row, column, value)| Triplet::new(row, column, c64::new(value, 0.0)))
        .collect();
    for column in 0..n {
        triplets.extend(
            entries(damping, column)
                .map(|(row, value)| Triplet::new(column, row, c64::new(0.0, omega * value))),
        );
    }
    let matrix = SparseColMat::try_new_from_triplets(n, n, &triplets).map_err(|_| ReductionError::Memory)?;
    let lu = matrix.sp_lu().map_err(|_| ReductionError::Memory)?;
    let mut out = Mat::from_fn(n, loads.ncols(), |i, j| c64::new(loads[(i, j)], 0.0));
    lu.solve_in_place_with_conj(Conj::No, out.as_mut());
    Ok(out)
}

/// (C − ω²M + iωD)⁻¹ F of a reduced structure.
fn dense(model: &Model, damped: bool, hz: f64, loads: &Mat<f64>) -> Result<Mat<c64>, ReductionError> {
    let (n, omega) = (model.dofs(), TAU * hz);
    let mut matrix = Mat::from_fn(n, n, |i, j| {
        let damping = if damped { omega * model.damping()[(i, j)] } else { 0.0 };
        c64::new(model.stiffness()[(i, j)] - omega * omega * model.mass()[(i, j)], damping)
    });
    let mut out = Mat::from_fn(n, loads.ncols(), |i, j| c64::new(loads[(i, j)], 0.0));
    let scratch = factor::lu_in_place_scratch::<usize, c64>(n, n, Par::Seq, Default::default())
        .or(solve::solve_in_place_scratch::<usize, c64>(n, loads.ncols(), Par::Seq));
    let mut scratch = MemBuffer::try_new(scratch).map_err(|_| ReductionError::Memory)?;
    let stack = MemStack::new(&mut scratch);
    let (mut forward, mut inverse) = (vec![0_usize; n], vec![0_usize; n]);
    let (_, permutation) =
        factor::lu_in_place(matrix.as_mut(), &mut forward, &mut inverse, Par::Seq, stack, Default::default());
    solve::solve_in_place_with_conj(
        matrix.as_ref(),
        matrix.as_ref(),
        permutation,
        Conj::No,
        out.as_mut(),
        Par::Seq,
        stack,
    );
    Ok(out)
}
