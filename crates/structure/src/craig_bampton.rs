//! Craig–Bampton reduction: kept dofs b, static shapes of the inner dofs i, and modes with the kept dofs held.
//!
//! ```text
//! u = [u_b; u_i] = T [u_b; q],   T = [1 0; Ψ Φ],   Ψ = −(C_ii − σM_ii)⁻¹ (C_ib − σM_ib),   C_ii Φ = M_ii Φ Λ
//! ```
//!
//! with σ = 0 wherever C_ii is regular: then the static response of the kept dofs is exact (Craig, Bampton, AIAA J. 6
//! (1968) 1313). Mass, damping and stiffness become TᵀMT, TᵀDT and TᵀCT.

use std::f64::consts::TAU;

use faer::linalg::matmul::matmul;
use faer::sparse::SparseColMat;
use faer::{Accum, Mat, Par};

use crate::factor::{Factor, FactorPlan};
use crate::model::{Damping, Model};
use crate::modes::{Lanczos, Modes, Wanted};
use crate::pencil::{Pencil, entries, transpose_times};
use crate::receptance_error::Comparison;
use crate::reduction::{ModeCount, Progress, Reduction, ReductionError, ReductionOptions};
use crate::residual_shapes::ResidualShapes;
use crate::sparse::{SparseDamping, SparseModel};

/// Dofs of a reduced structure, as a rule: beyond, dense matrices cost more than the sparse ones did.
const LARGEST: usize = 2000;

/// Modes that the cap leaves even to a structure with many kept dofs.
const FEWEST: usize = 100;

/// Frequency up to which all modes are kept, as a multiple of the highest of the response.
const CUT: f64 = 1.5;

/// Memory that a reduction may take.
const MOST_BYTES: f64 = 16e9;

/// Strain energy of a motion, relative to what its parts add up to, that is nothing but rounding.
const NO_STIFFNESS: f64 = 1e-14;

/// Which dofs are kept and which are not.
struct Partition {
    inner: Vec<usize>,
    /// Position of a dof among the inner ones, `usize::MAX` if kept.
    place: Vec<usize>,
}

/// Reduces `model` onto the dofs `keep` and modes.
///
/// `base_loads` are vectors M r in kg on all dofs, where M may be that of a structure whose held dofs were left out
/// since; the reduced model carries TᵀM r. Rayleigh damping stays Rayleigh damping, a matrix D becomes TᵀDT, and a modal ratio is given to every mode of the reduced
/// structure.
///
/// Modes are those with the kept dofs held, the lowest so many (checked by the inertia of C − λM). With
/// [`ModeCount::Automatic`] they are all up to 1.5 times the highest frequency, and static shapes for the inertia that
/// they leave come next to them until the error is within the tolerance, further shapes do not help, or the reduced
/// structure has about 2000 dofs; the error that is left is in the result.
///
/// # Errors
/// [`ReductionError`] for dofs, motions, options or matrices that make no sense, for an inner structure that is
/// unstable, for modes that were not found and for lack of memory.
pub fn reduce(
    model: &SparseModel,
    keep: &[usize],
    base_loads: &[Vec<f64>],
    options: &ReductionOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Reduction, ReductionError> {
    let n = model.mass.nrows();
    check(n, keep, base_loads, options)?;
    let partition = Partition::new(n, keep);
    let base = Mat::from_fn(n, base_loads.len(), |i, k| base_loads[k][i]);
    if partition.inner.is_empty() {
        let shapes = partition.shapes(keep, &[]);
        let model = project(model, &shapes, &base)?;
        return Ok(Reduction {
            model,
            modes: 0,
            fixed_frequencies: Vec::new(),
            shift: 0.0,
            error: None,
            checked_at: Vec::new(),
        });
    }

    progress(Progress::Factorising);
    let pencil = Pencil::new(&model.stiffness, &model.mass, &partition.inner, &partition.place);
    let plan = FactorPlan::new(&pencil)?;
    fits(plan.len())?;
    let (factor, shift) = definite(&pencil, &plan, options.highest)?;
    progress(Progress::ConstraintModes);
    let constraint = constraint_modes(model, keep, &partition, &factor, shift)?;
    let mut lanczos = Lanczos::new(&pencil, &factor, shift)?;

    let most = LARGEST.saturating_sub(keep.len()).max(FEWEST);
    let wanted = match options.modes {
        ModeCount::Exactly(count) => Wanted::Lowest(count),
        ModeCount::Automatic { .. } => match below(&pencil, &plan, (TAU * CUT * options.highest).powi(2))? {
            (_, count) if count > most => Wanted::Lowest(most),
            (limit, count) => Wanted::Below { limit, count },
        },
    };
    let modes = find(&pencil, &plan, &mut lanczos, wanted, progress)?;
    drop(lanczos);
    let fixed_frequencies = modes.squares.iter().map(|square| square.max(0.0).sqrt() / TAU).collect();
    let damping = match &model.damping {
        SparseDamping::Matrix(damping) => {
            Some(damping.transpose().to_col_major().map_err(|_| ReductionError::Memory)?)
        }
        _ => None,
    };
    let omega = TAU * options.highest;
    let dynamic =
        Dynamic { partition: &partition, mass: &model.mass, damping, reach: (omega * omega - shift, omega) };
    let mut comparison: Option<Comparison> = None;
    let mut residuals: Option<ResidualShapes> = None;
    let (mut smallest, mut stale) = (f64::INFINITY, 0);
    loop {
        let residual = match &residuals {
            Some(residuals) => residuals.taken(most.saturating_sub(modes.squares.len()))?,
            None => Mat::zeros(partition.inner.len(), 0),
        };
        let count = modes.squares.len() + residual.ncols();
        fits(plan.len() + n * (keep.len() + 4 * count))?;
        let shapes = partition.shapes(keep, &[&constraint, &modes.shapes, &residual]);
        let reduced = project(model, &shapes, &base)?;
        drop(shapes);
        let checked_at = if keep.is_empty() {
            Vec::new()
        } else {
            let comparison = match &mut comparison {
                Some(comparison) => comparison,
                none => none.insert(Comparison::new(model, keep, &base, &reduced, options, progress)?),
            };
            comparison.errors(&reduced)?
        };
        let error = checked_at.iter().map(|&(_, error)| error).reduce(f64::max);
        if let (ModeCount::Automatic { tolerance }, Some(error), Some(comparison)) =
            (options.modes, error, &comparison)
            && error > tolerance
            && count < most
        {
            stale = if error < 0.8 * smallest { 0 } else { stale + 1 };
            smallest = smallest.min(error);
            let residuals = match &mut residuals {
                Some(residuals) => residuals,
                none => {
                    let forces = dynamic.first(keep, &constraint, &base, &factor, comparison.scale())?;
                    none.insert(ResidualShapes::new(&pencil, &factor, forces))
                }
            };
            let forces = |shapes: &Mat<f64>| dynamic.forces(&partition.shapes(&[], &[shapes]));
            // Where little came of it, larger steps.
            let fall = tolerance / error * 0.1_f64.powi(stale);
            if stale < 4 && residuals.more(&modes, fall, &forces)? {
                continue;
            }
        }
        return Ok(Reduction { model: reduced, modes: count, fixed_frequencies, shift, error, checked_at });
    }
}

fn check(
    n: usize,
    keep: &[usize],
    base_loads: &[Vec<f64>],
    options: &ReductionOptions,
) -> Result<(), ReductionError> {
    let mut kept = vec![false; n];
    for &dof in keep {
        match kept.get_mut(dof) {
            None => return Err(ReductionError::NoSuchDof { dof, dofs: n }),
            Some(true) => return Err(ReductionError::KeptTwice { dof }),
            Some(kept) => *kept = true,
        }
    }
    let odd = |motion: &Vec<f64>| motion.len() != n || motion.iter().any(|x| !x.is_finite());
    if let Some(index) = base_loads.iter().position(odd) {
        return Err(ReductionError::BaseLoad { index, dofs: n });
    }
    let ReductionOptions { lowest, highest, modes } = *options;
    if !(lowest >= 0.0 && lowest <= highest && highest > 0.0 && highest.is_finite()) {
        let problem =
            format!("the band of the response must be positive and finite, got {lowest} Hz to {highest} Hz");
        return Err(ReductionError::Options(problem));
    }
    match modes {
        ModeCount::Automatic { tolerance } if !(tolerance > 0.0 && tolerance.is_finite()) => {
            Err(ReductionError::Options(format!("the tolerance must be positive, got {tolerance}")))
        }
        _ => Ok(()),
    }
}

/// Refuses what would not fit into memory; `numbers` of eight bytes.
fn fits(numbers: usize) -> Result<(), ReductionError> {
    let bytes = 8.0 * numbers as f64;
    if bytes > MOST_BYTES { Err(ReductionError::TooLarge { gigabytes: bytes / 1e9 }) } else { Ok(()) }
}

impl Partition {
    fn new(n: usize, keep: &[usize]) -> Self {
        let mut place = vec![0; n];
        for &dof in keep {
            place[dof] = usize::MAX;
        }
        let inner: Vec<usize> = (0..n).filter(|&dof| place[dof] == 0).collect();
        for (position, &dof) in inner.iter().enumerate() {
            place[dof] = position;
        }
        Self { inner, place }
    }

    /// T with one row a dof of the full structure; `parts` are constraint modes and modes of the inner dofs.
    fn shapes(&self, keep: &[usize], parts: &[&Mat<f64>]) -> Mat<f64> {
        let columns = parts.iter().map(|part| part.ncols()).sum::<usize>().max(keep.len());
        let mut shapes = Mat::zeros(self.place.len(), columns);
        for (column, &dof) in keep.iter().enumerate() {
            shapes[(dof, column)] = 1.0;
        }
        let mut first = 0;
        for part in parts {
            for column in 0..part.ncols() {
                for (position, &dof) in self.inner.iter().enumerate() {
                    shapes[(dof, first + column)] = part[(position, column)];
                }
            }
            first += part.ncols();
        }
        shapes
    }
}

/// Factorises C_ii − σM_ii with σ = 0, or with σ < 0 if C_ii holds the inner dofs only up to rounding.
fn definite<'a>(
    pencil: &Pencil,
    plan: &'a FactorPlan,
    highest: f64,
) -> Result<(Factor<'a>, f64), ReductionError> {
    for part in [0.0, 0.1, 1.0, 10.0] {
        let sigma = -(part * TAU * highest).powi(2);
        if let Some(factor) = plan.factorise(pencil, sigma)?
            && factor.negative() == 0
            && (part > 0.0 || held(pencil, &factor)?)
        {
            return Ok((factor, sigma));
        }
    }
    Err(ReductionError::Singular)
}

/// Whether the softest motion has more strain energy uᵀCu than rounding gives it. It comes from a few steps of inverse
/// iteration, which find a motion without stiffness at once.
fn held(pencil: &Pencil, factor: &Factor<'_>) -> Result<bool, ReductionError> {
    let n = pencil.size();
    let stiffness = pencil.shifted(0.0);
    let mut motion = Mat::from_fn(n, 1, |i, _| (1.0 + i as f64 * 0.618_033_988_749_895).fract() - 0.5);
    for _ in 0..3 {
        factor.solve(motion.as_mut())?;
        let size = motion.norm_max();
        if !(size.is_finite() && size > 0.0) {
            return Ok(false);
        }
        motion /= size;
    }
    let energy = motion.transpose() * pencil.times(&stiffness, motion.as_ref());
    let magnitudes: Vec<f64> = stiffness.iter().map(|c| c.abs()).collect();
    let motion = Mat::from_fn(n, 1, |i, _| motion[(i, 0)].abs());
    let sum = motion.transpose() * pencil.times(&magnitudes, motion.as_ref());
    Ok(energy[(0, 0)] > NO_STIFFNESS * sum[(0, 0)])
}

/// Ψ, one column a kept dof.
fn constraint_modes(
    model: &SparseModel,
    keep: &[usize],
    partition: &Partition,
    factor: &Factor<'_>,
    shift: f64,
) -> Result<Mat<f64>, ReductionError> {
    let mut shapes = Mat::zeros(partition.inner.len(), keep.len());
    for (column, &dof) in keep.iter().enumerate() {
        for (matrix, factor) in [(&model.stiffness, -1.0), (&model.mass, shift)] {
            for (row, value) in entries(matrix, dof) {
                if partition.place[row] != usize::MAX {
                    shapes[(partition.place[row], column)] += factor * value;
                }
            }
        }
    }
    factor.solve(shapes.as_mut())?;
    Ok(shapes)
}

/// What brings shapes about that the static ones miss.
struct Dynamic<'a> {
    partition: &'a Partition,
    mass: &'a SparseColMat<usize, f64>,
    /// Dᵀ, where damping is a matrix.
    damping: Option<SparseColMat<usize, f64>>,
    /// z = ω² − σ and ω.
    reach: (f64, f64),
}

impl Dynamic<'_> {
    /// z M u of the inner dofs, and ω D u next to it; u has one row a dof of the full structure.
    fn forces(&self, motions: &Mat<f64>) -> Mat<f64> {
        let (columns, (z, omega)) = (motions.ncols(), self.reach);
        let inertia = transpose_times(self.mass, motions.as_ref());
        let damping = self.damping.as_ref().map(|damping| transpose_times(damping, motions.as_ref()));
        let all = columns + damping.as_ref().map_or(0, |damping| damping.ncols());
        Mat::from_fn(self.partition.inner.len(), all, |i, j| {
            let dof = self.partition.inner[i];
            match &damping {
                Some(damping) if j >= columns => omega * damping[(dof, j - columns)],
                _ => z * inertia[(dof, j)],
            }
        })
    }

    /// F₁ of the residual shapes: forces of the kept dofs' static shapes, and the base loads, each of unit energy.
    fn first(
        &self,
        keep: &[usize],
        constraint: &Mat<f64>,
        base: &Mat<f64>,
        factor: &Factor<'_>,
        scale: &[f64],
    ) -> Result<Mat<f64>, ReductionError> {
        let mut motions = self.partition.shapes(keep, &[constraint]);
        for (j, scale) in scale.iter().enumerate() {
            let mut motion = motions.as_mut().col_mut(j);
            motion /= *scale;
        }
        let mut loads =
            Mat::from_fn(self.partition.inner.len(), base.ncols(), |i, j| base[(self.partition.inner[i], j)]);
        let mut shapes = loads.clone();
        factor.solve(shapes.as_mut())?;
        for j in 0..loads.ncols() {
            let energy = loads.col(j).transpose() * shapes.col(j);
            if energy > 0.0 {
                let mut load = loads.as_mut().col_mut(j);
                load /= energy.sqrt();
            }
        }
        let mut forces = self.forces(&motions);
        let before = forces.ncols();
        forces.resize_with(loads.nrows(), before + loads.ncols(), |i, j| loads[(i, j - before)]);
        Ok(forces)
    }
}

/// The number of eigenvalues below `limit`, which moves a little if it hits one.
fn below(pencil: &Pencil, plan: &FactorPlan, limit: f64) -> Result<(f64, usize), ReductionError> {
    for step in 0..6 {
        let limit = limit * (1.0 + 1e-3 * f64::from(step));
        if let Some(factor) = plan.factorise(pencil, limit)? {
            return Ok((limit, factor.negative()));
        }
    }
    Err(ReductionError::Singular)
}

/// The wanted modes, with none left out: if the inertia knows of more, the iteration goes on until it has them.
fn find(
    pencil: &Pencil,
    plan: &FactorPlan,
    lanczos: &mut Lanczos<'_>,
    wanted: Wanted,
    progress: &mut dyn FnMut(Progress),
) -> Result<Modes, ReductionError> {
    let (Wanted::Below { count: of, .. } | Wanted::Lowest(of)) = wanted;
    let mut progress = |found| progress(Progress::Modes { found, of });
    loop {
        let modes = lanczos.modes(wanted, &mut progress)?;
        let (Wanted::Lowest(_), Some(&last)) = (wanted, modes.squares.last()) else { return Ok(modes) };
        // Between the last and what lies clearly below it: of a multiple eigenvalue at the end any mode will do.
        let clearly = |square: &f64| last - square > 1e-4 * last.abs();
        let Some(found) = modes.squares.iter().rposition(clearly) else { return Ok(modes) };
        let (limit, count) = below(pencil, plan, 0.5 * (modes.squares[found] + last))?;
        if count == found + 1 {
            return Ok(modes);
        }
        lanczos.modes(Wanted::Below { limit, count }, &mut progress)?;
    }
}

/// TᵀMT, TᵀDT, TᵀCT, and Tᵀ times the base loads.
fn project(model: &SparseModel, shapes: &Mat<f64>, base: &Mat<f64>) -> Result<Model, ReductionError> {
    let damping = match &model.damping {
        SparseDamping::Matrix(damping) => Damping::Matrix(congruent(damping, shapes).transpose().to_owned()),
        &SparseDamping::Rayleigh { mass, stiffness } => Damping::Rayleigh { mass, stiffness },
        &SparseDamping::ModalRatio(ratio) => Damping::ModalRatio(ratio),
    };
    let (mass, stiffness) = (congruent(&model.mass, shapes), congruent(&model.stiffness, shapes));
    let loads = shapes.transpose() * base;
    let loads = (0..loads.ncols()).map(|k| loads.col(k).iter().copied().collect()).collect();
    Ok(Model::new(symmetric(mass), damping, symmetric(stiffness))?.with_base_loads(loads)?)
}

/// Tᵀ Aᵀ T, a few columns at a time.
fn congruent(matrix: &SparseColMat<usize, f64>, shapes: &Mat<f64>) -> Mat<f64> {
    const COLUMNS: usize = 64;
    let size = shapes.ncols();
    let mut out = Mat::zeros(size, size);
    for first in (0..size).step_by(COLUMNS) {
        let columns = COLUMNS.min(size - first);
        let part = transpose_times(matrix, shapes.as_ref().subcols(first, columns));
        let out = out.as_mut().subcols_mut(first, columns);
        matmul(out, Accum::Replace, shapes.transpose(), part.as_ref(), 1.0, Par::Seq);
    }
    out
}

/// Takes off what rounding adds.
fn symmetric(matrix: Mat<f64>) -> Mat<f64> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]))
}
