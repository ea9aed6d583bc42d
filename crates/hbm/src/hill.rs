//! Floquet multipliers of a linear system with periodic coefficients by Hill's matrix, without sorting eigenvalues.
//!
//! ```text
//! y″ + (D + Σ_c b_c d_c(θ) b_cᵀ) y′ + (K + Σ_c b_c κ_c(θ) b_cᵀ) y = 0,      period 2π in θ
//! ```
//!
//! as z′ = A(θ) z with z = (y, y′/s) and A(θ) = Σ_j A_j e^{ijθ}; all A_j but A_0 have low rank. The functions
//! ψ_k = e^{ikθ} z obey a system with constant coefficients,
//!
//! ```text
//! ψ_k′ = ik ψ_k + e^{ikθ} Σ_j A_j e^{ijθ} z = ik ψ_k + Σ_j A_j ψ_{k+j},     ψ_k(θ₀) = e^{ikθ₀} z(θ₀),
//! ```
//!
//! that of Hill's matrix H. Cut off at |k| ≤ N it is solved by an exponential; z is its middle block. With W(θ₀) the blocks
//! e^{ikθ₀}·1 under each other and C what picks the middle one, the fundamental matrix is
//!
//! ```text
//! Φ(θ₁, θ₀) ≈ C e^{H(θ₁ − θ₀)} W(θ₀)
//! ```
//!
//! This is the Koopman–Hill projection of Bayer and Leine (Nonlinear Dynamics 111, 2023, in its direct form), to which the
//! period may be given in parts: Φ(2π, 0) = Φ(2π, θ_q) … Φ(θ₁, 0), each part beginning anew with exact ψ_k.
//!
//! **Error.** Expand both sides in the couplings A_j, j ≠ 0, with e^{A₀t} between them. A term of C e^{Ht} W walks from block 0
//! by steps j₁, j₂, …; with the factors e^{ik·} of the places it comes to it is exactly the term
//! e^{A₀t₀} A_{j₁}e^{ij₁τ₁} e^{A₀t₁} A_{j₂}e^{ij₂τ₂} … of the solution's own expansion. Cut off, H lacks the walks that leave
//! |k| ≤ N, and nothing else; such a walk has Σ|j_i| > N. So with ‖e^{A₀t}‖ ≤ κ and for every ρ > 1
//!
//! ```text
//! ‖error‖ ≤ κ Σ_m (κt)^m/m! Σ_{Σ|j_i| > N} Π‖A_{j_i}‖ ≤ κ ρ^{−N−1} exp(κ t Σ_{j≠0} ‖A_j‖ ρ^{|j|}),
//! ```
//!
//! since ρ^{Σ|j_i| − N − 1} ≥ 1 for every walk that is missing. With finitely many A_j the best ρ grows with N: the error falls
//! faster than exponentially. For coefficients that are analytic in a strip it falls as their own harmonics do.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, evd_real, evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use num_complex::Complex64;
use thiserror::Error;

/// A spring and damper whose stiffness and rate change periodically, in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicSpring {
    /// b: one entry a dof.
    pub direction: Vec<f64>,
    /// κ_0, κ_1, … of κ(θ) = κ_0 + 2 Re Σ_{j>0} κ_j e^{ijθ} (two-sided coefficients; κ_0 is real).
    pub stiffness: Vec<Complex64>,
    /// Likewise d_0, d_1, … of the rate; may be empty.
    pub rate: Vec<Complex64>,
}

/// A linear system of n dofs with coefficients of period 2π.
#[derive(Debug, Clone)]
pub struct Hill {
    dofs: usize,
    /// s: velocities are measured in this, so that fast dofs do not make A_0 lopsided.
    unit: f64,
    /// K/s with the means κ_0, and D with the means d_0.
    stiffness: Mat<f64>,
    damping: Mat<f64>,
    /// B, n × m.
    directions: Mat<f64>,
    /// κ_j/s for j ≥ 1, one row a direction.
    springs: Vec<Vec<Complex64>>,
    /// d_j for j ≥ 1, likewise.
    rates: Vec<Vec<Complex64>>,
    /// Bounds on ‖A_j‖ for j ≥ 1, as they act on the motion of their direction.
    couplings: Vec<f64>,
    /// Bound on ‖A(θ)‖.
    norm: f64,
}

/// The multipliers of a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Multipliers {
    /// All 2n of them, the largest first.
    pub values: Vec<Complex64>,
    /// How far each may be from the true one: the difference of two truncations, and rounding. An estimate.
    pub error: f64,
    /// N of the finer truncation.
    pub truncation: usize,
}

/// A system that has no meaning.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum HillError {
    /// Sizes that do not fit each other.
    #[error("{what} has {got} entries where the stiffness has {dofs} rows")]
    Size {
        /// Which part.
        what: &'static str,
        /// Its size.
        got: usize,
        /// What it should be.
        dofs: usize,
    },
    /// An entry that is no number.
    #[error("{what} has an entry that is not a finite number")]
    NotFinite {
        /// Which part.
        what: &'static str,
    },
    /// The eigenvalues of the fundamental matrix were not found.
    #[error("the fundamental matrix has no eigenvalues that could be computed")]
    NoEigenvalues,
}

/// Truncations are chosen for this error, by the bound above.
const AIM: f64 = 1e-14;

/// Two truncations that agree to this are enough.
const AGREED: f64 = 1e-11;

/// The highest truncation that is tried, and the arithmetic it may take (about a second or two).
const MOST: usize = 1024;
const MOST_WORK: f64 = 3e9;

/// A step of the exponential's series: ‖H‖ times its length.
const STEP: f64 = 3.0;

/// Terms of the series at most; a step of length 3 needs about 25.
const MOST_TERMS: usize = 60;

impl Hill {
    /// The system with stiffness K and damping D (n × n), and its periodic springs.
    ///
    /// # Errors
    /// [`HillError`] naming the part that does not fit or is not finite.
    pub fn new(
        stiffness: &Mat<f64>,
        damping: &Mat<f64>,
        springs: &[PeriodicSpring],
    ) -> Result<Self, HillError> {
        let n = stiffness.nrows();
        for (what, matrix) in [("the stiffness", stiffness), ("the damping", damping)] {
            for got in [matrix.nrows(), matrix.ncols()] {
                sized(what, got, n)?;
            }
            finite(what, (0..n).flat_map(|j| matrix.col(j).iter().copied()))?;
        }
        for spring in springs {
            sized("a direction", spring.direction.len(), n)?;
            finite("a direction", spring.direction.iter().copied())?;
            let coefficients = spring.stiffness.iter().chain(&spring.rate);
            finite("a periodic spring", coefficients.flat_map(|z| [z.re, z.im]))?;
        }
        let directions = Mat::from_fn(n, springs.len(), |i, c| springs[c].direction[i]);
        let mean = |of: fn(&PeriodicSpring) -> &Vec<Complex64>| {
            Mat::from_fn(n, n, |i, j| -> f64 {
                let part = |spring: &PeriodicSpring| {
                    of(spring).first().map_or(0.0, |z| z.re) * spring.direction[i] * spring.direction[j]
                };
                springs.iter().map(part).sum()
            })
        };
        let stiffness = stiffness + mean(|spring| &spring.stiffness);
        let damping = damping + mean(|spring| &spring.rate);
        let unit = norm(&stiffness).sqrt().max(1.0);
        let tail = |z: &[Complex64], by: f64| z.iter().skip(1).map(|z| z * by).collect::<Vec<_>>();
        let harmonics = springs.iter().map(|s| s.stiffness.len().max(s.rate.len())).max().unwrap_or(1).max(1);
        let mut couplings = vec![0.0; harmonics - 1];
        for spring in springs {
            let square: f64 = spring.direction.iter().map(|b| b * b).sum();
            // A spring that is mostly constant turns fast, and what its variation adds within a turn counts.
            let own = spring.stiffness.first().map_or(0.0, |z| square * z.re.abs()).sqrt().max(1.0);
            for (j, coupling) in couplings.iter_mut().enumerate() {
                let size = |z: &[Complex64]| z.get(j + 1).map_or(0.0, |z| square * z.norm());
                *coupling += size(&spring.stiffness) / own + size(&spring.rate);
            }
        }
        Ok(Self {
            dofs: n,
            unit,
            norm: unit + norm(&damping) + 2.0 * couplings.iter().sum::<f64>(),
            stiffness: stiffness * faer::Scale(1.0 / unit),
            damping,
            directions,
            springs: springs.iter().map(|s| tail(&s.stiffness, 1.0 / unit)).collect(),
            rates: springs.iter().map(|s| tail(&s.rate, 1.0)).collect(),
            couplings,
        })
    }

    /// Φ(2π, 0) of (y, y′/s), 2n × 2n, by Hill's matrix cut off at |k| ≤ `truncation`, the period in `parts` (at least one).
    pub fn monodromy(&self, truncation: usize, parts: usize) -> Mat<f64> {
        let n = self.dofs;
        let parts = parts.max(1);
        let length = std::f64::consts::TAU / parts as f64;
        let steps = self.steps(truncation, parts);
        let mut lifted = Lifted::new(self, truncation);
        let mut state = Mat::<f64>::identity(2 * n, 2 * n);
        for part in 0..parts {
            lifted.lift(&state, length * part as f64);
            for _ in 0..steps {
                lifted.advance(length / steps as f64);
            }
            lifted.project(&mut state);
        }
        state
    }

    /// The multipliers: the truncation grows until two of them agree, or more would take too long.
    ///
    /// # Errors
    /// [`HillError::NoEigenvalues`].
    pub fn multipliers(&self) -> Result<Multipliers, HillError> {
        let parts = self.parts();
        let most = self.most(parts);
        let mut truncation = self.truncation(parts).min(most);
        let coarser = (truncation - truncation / 8).saturating_sub(1);
        let mut last = eigenvalues(&self.monodromy(coarser, parts))?;
        loop {
            let monodromy = self.monodromy(truncation, parts);
            let values = eigenvalues(&monodromy)?;
            let rounding = f64::EPSILON * (self.steps(truncation, parts) * parts) as f64 * norm(&monodromy);
            let error = distance(&values, &last) + 4.0 * rounding;
            if error <= AGREED.max(8.0 * rounding) || truncation >= most {
                return Ok(Multipliers { values, error, truncation });
            }
            last = values;
            truncation = (truncation + truncation / 2).min(most);
        }
    }

    /// The multipliers with a given truncation.
    pub(crate) fn multipliers_with(&self, truncation: usize) -> Result<Vec<Complex64>, HillError> {
        eigenvalues(&self.monodromy(truncation, self.parts()))
    }

    /// Steps of the series in a part of the period.
    fn steps(&self, truncation: usize, parts: usize) -> usize {
        let size = (truncation as f64 + self.norm) * std::f64::consts::TAU / parts as f64;
        (size / STEP).ceil().max(1.0) as usize
    }

    /// Into how many parts the period is best cut: more need fewer harmonics, up to a point.
    fn parts(&self) -> usize {
        let work = |parts: usize| {
            let truncation = self.truncation(parts);
            (self.steps(truncation, parts) * parts * (truncation + 1), parts)
        };
        (0..10).map(|power| work(1 << power)).min().map_or(1, |(_, parts)| parts)
    }

    /// The least N for which the bound above is [`AIM`], with κ = 1.
    fn truncation(&self, parts: usize) -> usize {
        let length = std::f64::consts::TAU / parts as f64;
        let needed = |rho: f64| {
            let sum = self.couplings.iter().rev().fold(0.0, |sum, a| (sum + 2.0 * a) * rho);
            (length * sum - AIM.ln()) / rho.ln()
        };
        let least = (1..=60).map(|i| needed((0.002 * 1.15_f64.powi(i)).exp())).fold(f64::INFINITY, f64::min);
        if self.couplings.iter().all(|a| *a == 0.0) {
            2
        } else {
            least.ceil().clamp(2.0, MOST as f64) as usize
        }
    }

    /// The truncation beyond which the work is too much.
    fn most(&self, parts: usize) -> usize {
        let n = self.dofs as f64;
        let work = |truncation: usize| {
            let blocks = (truncation + 1) as f64;
            let springs = self.springs.len() as f64 * blocks * (self.couplings.len() as f64).min(blocks);
            let terms = 25.0 * (self.steps(truncation, parts) * parts) as f64;
            terms * 2.0 * n * (4.0 * blocks * n * (n + self.springs.len() as f64) + 8.0 * springs)
        };
        (4..=MOST).take_while(|truncation| work(*truncation) <= MOST_WORK).last().unwrap_or(4)
    }
}

/// ψ_0 … ψ_N (ψ_{−k} is the conjugate of ψ_k, as z is real) for all 2n columns, and a term of the series.
///
/// Of each dof first the real parts and then the imaginary ones are stored, block by block, so that everything is a sum of long
/// vectors.
struct Lifted<'h> {
    hill: &'h Hill,
    truncation: usize,
    /// Entries of a block: 2n.
    width: usize,
    /// y and y′/s in all blocks.
    psi: [Vec<f64>; 2],
    term: [Vec<f64>; 2],
    next: [Vec<f64>; 2],
    /// k, once an entry of block k.
    turns: Vec<f64>,
    /// bᵀ of a term, real and imaginary parts of all blocks from −N to N, with room for the reach of the couplings.
    along: [Vec<f64>; 2],
    /// What a spring makes of it.
    pull: [Vec<f64>; 2],
}

/// Up to so many dofs a few lines of arithmetic are faster than a blocked product begins.
const FEW: usize = 8;

impl<'h> Lifted<'h> {
    fn new(hill: &'h Hill, truncation: usize) -> Self {
        let (width, blocks) = (2 * hill.dofs, truncation + 1);
        let plane = || vec![0.0; blocks * width];
        let half = || vec![0.0; 2 * blocks * width * hill.dofs];
        let around = || vec![0.0; (2 * truncation + 1 + 2 * hill.couplings.len()) * width];
        Self {
            hill,
            truncation,
            width,
            psi: [half(), half()],
            term: [half(), half()],
            next: [half(), half()],
            turns: (0..blocks).flat_map(|k| std::iter::repeat_n(k as f64, width)).collect(),
            along: [around(), around()],
            pull: [plane(), plane()],
        }
    }

    /// ψ_k = e^{ikθ₀} z.
    fn lift(&mut self, state: &Mat<f64>, theta: f64) {
        let (n, plane) = (self.hill.dofs, self.turns.len());
        for (half, psi) in self.psi.iter_mut().enumerate() {
            for (i, dof) in psi.chunks_mut(2 * plane).enumerate() {
                let (re, im) = dof.split_at_mut(plane);
                let blocks = re.chunks_mut(self.width).zip(im.chunks_mut(self.width));
                for (k, (re, im)) in blocks.enumerate() {
                    let turn = Complex64::cis(k as f64 * theta);
                    for (j, (re, im)) in re.iter_mut().zip(im).enumerate() {
                        let z = state[(half * n + i, j)];
                        (*re, *im) = (turn.re * z, turn.im * z);
                    }
                }
            }
        }
    }

    /// The middle block.
    fn project(&self, state: &mut Mat<f64>) {
        let (n, plane) = (self.hill.dofs, self.turns.len());
        for (half, psi) in self.psi.iter().enumerate() {
            for (i, dof) in psi.chunks(2 * plane).enumerate() {
                for (j, entry) in dof.iter().take(self.width).enumerate() {
                    state[(half * n + i, j)] = *entry;
                }
            }
        }
    }

    /// ψ ← e^{Hh} ψ by its series.
    fn advance(&mut self, h: f64) {
        for (term, psi) in self.term.iter_mut().zip(&self.psi) {
            term.copy_from_slice(psi);
        }
        let mut before = f64::INFINITY;
        for m in 1..=MOST_TERMS {
            self.apply(h / m as f64);
            std::mem::swap(&mut self.term, &mut self.next);
            let (mut size, mut whole) = (0.0_f64, 0.0_f64);
            for (psi, term) in self.psi.iter_mut().zip(&self.term) {
                for (psi, term) in psi.iter_mut().zip(term) {
                    *psi += term;
                    size += term * term;
                    whole += *psi * *psi;
                }
            }
            let size = size.sqrt();
            if size + before <= f64::EPSILON * whole.sqrt() {
                return;
            }
            before = size;
        }
    }

    /// `next` = H · term · factor: y′ = ik y + s v,  v′ = ik v − K/s y − D v − Σ b pull.
    fn apply(&mut self, factor: f64) {
        let (n, plane) = (self.hill.dofs, self.turns.len());
        let [y, v] = &self.term;
        let [next_y, next_v] = &mut self.next;
        for (z, next) in [(y, &mut *next_y), (v, &mut *next_v)] {
            for (z, next) in z.chunks(2 * plane).zip(next.chunks_mut(2 * plane)) {
                let ((re, im), (next_re, next_im)) = (z.split_at(plane), next.split_at_mut(plane));
                for ((next, im), turn) in next_re.iter_mut().zip(im).zip(&self.turns) {
                    *next = -factor * turn * im;
                }
                for ((next, re), turn) in next_im.iter_mut().zip(re).zip(&self.turns) {
                    *next = factor * turn * re;
                }
            }
        }
        add(factor * self.hill.unit, v, next_y);
        for (matrix, z) in [(&self.hill.stiffness, y), (&self.hill.damping, v)] {
            if n > FEW {
                let next = MatMut::from_column_major_slice_mut(next_v, 2 * plane, n);
                let z = MatRef::from_column_major_slice(z, 2 * plane, n);
                matmul(next, Accum::Add, z, matrix.transpose(), -factor, Par::Seq);
                continue;
            }
            for (i, next) in next_v.chunks_mut(2 * plane).enumerate() {
                for (j, z) in z.chunks(2 * plane).enumerate() {
                    add(-factor * matrix[(i, j)], z, next);
                }
            }
        }
        if !self.hill.couplings.is_empty() {
            for spring in 0..self.hill.springs.len() {
                self.pull_of(spring, factor);
            }
        }
    }

    /// Adds what a spring's variation does to `next`.
    fn pull_of(&mut self, spring: usize, factor: f64) {
        let (hill, plane) = (self.hill, self.turns.len());
        let parts = || hill.directions.col(spring).iter().enumerate().filter(|(_, b)| **b != 0.0);
        let middle = (self.truncation + hill.couplings.len()) * self.width;
        for pull in &mut self.pull {
            pull.fill(0.0);
        }
        for (z, coefficients) in self.term.iter().zip([&hill.springs, &hill.rates]) {
            let Some(coefficients) = coefficients.get(spring).filter(|all| !all.is_empty()) else { continue };
            for (part, (along, sign)) in self.along.iter_mut().zip([1.0, -1.0]).enumerate() {
                let (below, above) = along.split_at_mut(middle);
                let above = above.get_mut(..plane).unwrap_or_default();
                above.fill(0.0);
                for (i, b) in parts() {
                    let from = (2 * i + part) * plane;
                    add(*b, z.get(from..from + plane).unwrap_or_default(), above);
                }
                // p_{−k} = conj(p_k).
                let mirrored = below.rchunks_mut(self.width).zip(above.chunks(self.width).skip(1));
                for (below, above) in mirrored {
                    for (below, above) in below.iter_mut().zip(above) {
                        *below = sign * above;
                    }
                }
            }
            for (j, a) in (1..).zip(coefficients) {
                couple(*a, &self.along, (middle, j * self.width), &mut self.pull);
            }
        }
        let next = self.next.last_mut().map_or(&mut [][..], Vec::as_mut_slice);
        for (i, b) in parts() {
            for (part, pull) in self.pull.iter().enumerate() {
                let from = (2 * i + part) * plane;
                add(-factor * b, pull, next.get_mut(from..from + plane).unwrap_or_default());
            }
        }
    }
}

/// `out` += a x.
fn add(a: f64, x: &[f64], out: &mut [f64]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += a * x;
    }
}

/// `out_k` += a p_{k+j} + conj(a) p_{k−j} for all k from 0 on, in real and imaginary parts; p_0 begins at `middle`, p_{k±j} lies
/// `reach` entries from p_k.
fn couple(a: Complex64, p: &[Vec<f64>; 2], (middle, reach): (usize, usize), out: &mut [Vec<f64>; 2]) {
    let [out_re, out_im] = out;
    let after = p.each_ref().map(|p| p.get(middle + reach..).unwrap_or_default());
    let before = p.each_ref().map(|p| p.get(middle - reach..).unwrap_or_default());
    let pairs = after[0].iter().zip(after[1]).zip(before[0].iter().zip(before[1]));
    for ((re, im), ((after_re, after_im), (before_re, before_im))) in
        out_re.iter_mut().zip(out_im.iter_mut()).zip(pairs)
    {
        *re += a.re * (after_re + before_re) - a.im * (after_im - before_im);
        *im += a.re * (after_im + before_im) + a.im * (after_re - before_re);
    }
}

/// Eigenvalues of a real matrix, the largest first; conjugate pairs stay together.
fn eigenvalues(matrix: &Mat<f64>) -> Result<Vec<Complex64>, HillError> {
    let n = matrix.nrows();
    let none = ComputeEigenvectors::No;
    let mut memory = MemBuffer::new(evd_scratch::<f64>(n, none, none, Par::Seq, faer::Spec::default()));
    let (mut re, mut im) = (Diag::<f64>::zeros(n), Diag::<f64>::zeros(n));
    if (0..n).any(|j| matrix.col(j).iter().any(|x| !x.is_finite())) {
        return Err(HillError::NoEigenvalues);
    }
    evd_real(
        matrix.as_ref(),
        re.as_mut(),
        im.as_mut(),
        None,
        None,
        Par::Seq,
        MemStack::new(&mut memory),
        faer::Spec::default(),
    )
    .map_err(|_| HillError::NoEigenvalues)?;
    let pairs = re.column_vector().iter().zip(im.column_vector().iter());
    let mut values: Vec<Complex64> = pairs.map(|(re, im)| Complex64::new(*re, *im)).collect();
    sort(&mut values);
    Ok(values)
}

/// The largest first; magnitudes that agree but for rounding are ordered by their real parts, conjugates side by side.
pub(crate) fn sort(values: &mut [Complex64]) {
    let key = |z: &Complex64| [-z.norm(), -z.re].map(|x| (x * 1e9).round());
    values.sort_by(|a, b| {
        let ([size_a, real_a], [size_b, real_b]) = (key(a), key(b));
        size_a.total_cmp(&size_b).then(real_a.total_cmp(&real_b)).then(b.im.total_cmp(&a.im))
    });
}

/// The largest distance from one of `values` to the nearest of `others`, each used once.
pub(crate) fn distance(values: &[Complex64], others: &[Complex64]) -> f64 {
    let mut left = others.to_vec();
    let mut worst = 0.0_f64;
    for value in values {
        let nearest =
            (0..left.len()).min_by(|&a, &b| (left[a] - value).norm().total_cmp(&(left[b] - value).norm()));
        if let Some(nearest) = nearest {
            worst = worst.max((left.swap_remove(nearest) - value).norm());
        }
    }
    worst
}

/// √(‖A‖₁ ‖A‖_∞), no less than ‖A‖₂.
fn norm(matrix: &Mat<f64>) -> f64 {
    let columns = (0..matrix.ncols()).map(|j| matrix.col(j).iter().map(|x| x.abs()).sum::<f64>());
    let rows = (0..matrix.nrows()).map(|i| matrix.row(i).iter().map(|x| x.abs()).sum::<f64>());
    (columns.fold(0.0, f64::max) * rows.fold(0.0, f64::max)).sqrt()
}

fn sized(what: &'static str, got: usize, dofs: usize) -> Result<(), HillError> {
    if got == dofs { Ok(()) } else { Err(HillError::Size { what, got, dofs }) }
}

fn finite(what: &'static str, mut entries: impl Iterator<Item = f64>) -> Result<(), HillError> {
    if entries.all(f64::is_finite) { Ok(()) } else { Err(HillError::NotFinite { what }) }
}
