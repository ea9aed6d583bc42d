//! The Newton step of many contacts by GMRES (Saad, Schultz 1986), without the whole derivative.
//!
//! A contact couples the harmonics of its own displacement (a joint those of all its directions), and the structure couples the contacts harmonic by harmonic,
//! so with T the derivative of the contact forces (one small block a contact) the product with the derivative
//!
//! ```text
//! (J v)_k = (v_k + Ĝ_k (μ (T v)_k − Ŝ_k v_k)) / (1 + |Ĝ_k|)
//! ```
//!
//! costs `slots · width²` operations, where factoring J costs `(slots · width)³`. The preconditioner leaves out what couples
//! harmonics: with κ̄_k the complex part of T at harmonic k alone, `(1 + Ĝ_k (κ̄_k − Ŝ_k))⁻¹` is one factorisation a
//! harmonic. It may be older than the derivative: that costs iterations, not accuracy.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, c64};

use crate::balance::BalanceBuffers;
use crate::dense::Lu;
use crate::jacobian::Block;
use crate::newton::Task;

/// Vectors of a basis; then GMRES starts again from what it reached.
const BASIS: usize = 60;

/// Starts of GMRES in one solve.
const STARTS: usize = 3;

/// After so many iterations the preconditioner is made anew for the next derivative.
const MANY: usize = 25;

/// Buffers of the solver for one thread, empty until it is used.
#[derive(Debug)]
pub(crate) struct Krylov {
    /// μ T in units of the balance, entry `[coupling][p][j]`.
    blocks: Vec<Block>,
    /// (row of the force, row of the motion) of each of them.
    couplings: Vec<(usize, usize)>,
    /// One a slot.
    preconditioner: Vec<Lu<c64>>,
    /// Whether the preconditioner belongs to this point and these harmonics, and to the derivative at hand.
    ready: bool,
    fresh: bool,
    /// Iterations of the last solve.
    iterations: usize,
    /// Orthonormal columns: real and imaginary parts, entry `[slot][i]`.
    basis: Mat<f64>,
    /// Upper triangle after rotations, one column an iteration.
    hessenberg: Mat<f64>,
    rotations: Vec<(f64, f64)>,
    /// The residual in the basis.
    projected: Vec<f64>,
    coefficients: Mat<f64>,
    column: Mat<f64>,
    rhs: Mat<f64>,
    solution: Mat<f64>,
    /// Motion and what the structure feels of it, entry `[slot][i]`.
    motion: Vec<c64>,
    felt: Vec<c64>,
    pull: Vec<c64>,
}

impl Krylov {
    /// Room for nothing yet.
    pub(crate) fn new() -> Self {
        Self {
            blocks: Vec::new(),
            couplings: Vec::new(),
            preconditioner: Vec::new(),
            ready: false,
            fresh: false,
            iterations: 0,
            basis: Mat::new(),
            hessenberg: Mat::new(),
            rotations: Vec::new(),
            projected: Vec::new(),
            coefficients: Mat::new(),
            column: Mat::new(),
            rhs: Mat::new(),
            solution: Mat::new(),
            motion: Vec::new(),
            felt: Vec::new(),
            pull: Vec::new(),
        }
    }

    /// Another point, or other harmonics.
    pub(crate) fn forget(&mut self) {
        (self.ready, self.fresh) = (false, false);
        self.iterations = 0;
    }

    /// Takes the derivative at the motion of the last evaluation.
    pub(crate) fn load(&mut self, task: &Task, buffers: &mut BalanceBuffers) {
        let (width, count) = (task.point.width(), task.core * task.point.width());
        task.balance.blocks(task.point, task.core, task.homotopy, buffers, &mut self.blocks);
        task.balance.couplings(width, &mut self.couplings);
        if (self.rhs.nrows(), self.pull.len()) != (2 * count, width) {
            self.basis = Mat::zeros(2 * count, BASIS + 1);
            self.hessenberg = Mat::zeros(BASIS + 1, BASIS);
            self.coefficients = Mat::zeros(BASIS, 1);
            self.column = Mat::zeros(BASIS + 1, 1);
            self.rhs = Mat::zeros(2 * count, 1);
            self.solution = Mat::zeros(2 * count, 1);
            self.pull.resize(width, c64::ZERO);
            self.motion.resize(count, c64::ZERO);
            self.felt.resize(count, c64::ZERO);
            self.projected.resize(BASIS + 1, 0.0);
        }
        self.fresh = false;
        if !self.ready || self.iterations > MANY {
            self.precondition(task);
        }
    }

    /// Solves `J x = rhs` until the residual is below `tolerance` of the right-hand side, both in entries `[slot][i]`;
    /// whether it is.
    pub(crate) fn solve(
        &mut self,
        task: &Task,
        tolerance: f64,
        rhs: impl Iterator<Item = c64>,
        mut receive: impl FnMut(usize, c64),
    ) -> bool {
        let count = self.motion.len();
        for (entry, value) in rhs.take(count).enumerate() {
            (self.rhs[(2 * entry, 0)], self.rhs[(2 * entry + 1, 0)]) = (value.re, value.im);
        }
        let goal = tolerance * self.rhs.norm_l2();
        let mut solved = self.restarted(task, goal);
        if !solved && !self.fresh {
            self.precondition(task);
            solved = self.restarted(task, goal);
        }
        for entry in 0..count {
            receive(entry, c64::new(self.solution[(2 * entry, 0)], self.solution[(2 * entry + 1, 0)]));
        }
        solved
    }

    /// Factors `(1 + Ĝ_k (κ̄_k − Ŝ_k)) / (1 + |Ĝ_k|)`.
    fn precondition(&mut self, task: &Task) {
        let (point, slots, width) = (task.point, task.core, task.point.width());
        while self.preconditioner.len() < slots {
            self.preconditioner.push(Lu::new(width, 1));
        }
        for (slot, lu) in self.preconditioner.iter_mut().enumerate().take(slots) {
            lu.reserve(width);
            for column in 0..width {
                for row in 0..width {
                    lu.matrix[(row, column)] = if row == column { c64::ONE } else { c64::ZERO };
                }
            }
            for (coupling, &(from, column)) in self.couplings.iter().enumerate() {
                let (by_re, by_im) = self.blocks[(coupling * slots + slot) * slots + slot];
                // Of F ↦ A W + B conj(W) the part A.
                let mut stiffness = 0.5 * (by_re - c64::new(-by_im.im, by_im.re));
                if from == column {
                    stiffness -= point.lent[slot * width + column];
                }
                for row in 0..width {
                    let g = point.receptance[(slot * width + row) * width + from];
                    lu.matrix[(row, column)] += g * stiffness;
                }
            }
            for column in 0..width {
                for row in 0..width {
                    lu.matrix[(row, column)] *= point.weight[slot * width + row];
                }
            }
            lu.factor(width);
        }
        (self.ready, self.fresh) = (true, true);
    }

    /// GMRES until the residual norm is below `goal`, from zero.
    fn restarted(&mut self, task: &Task, goal: f64) -> bool {
        self.solution.fill(0.0);
        self.iterations = 0;
        let mut residual = self.rhs.clone();
        for start in 0..STARTS {
            if start > 0 {
                // The true residual: what the rotations say of it may be off by rounding.
                self.load_motion(Of::Solution);
                self.multiply(task);
                for (entry, felt) in self.motion.iter().enumerate() {
                    residual[(2 * entry, 0)] = self.rhs[(2 * entry, 0)] - felt.re;
                    residual[(2 * entry + 1, 0)] = self.rhs[(2 * entry + 1, 0)] - felt.im;
                }
            }
            let norm = residual.norm_l2();
            if norm <= goal {
                return true;
            }
            if !norm.is_finite() || self.cycle(task, &residual, norm, goal) {
                return norm.is_finite();
            }
        }
        false
    }

    /// One cycle of GMRES from `residual`, added to the solution; whether it met the goal.
    fn cycle(&mut self, task: &Task, residual: &Mat<f64>, norm: f64, goal: f64) -> bool {
        let size = residual.nrows();
        for r in 0..size {
            self.basis[(r, 0)] = residual[(r, 0)] / norm;
        }
        self.projected.fill(0.0);
        self.projected[0] = norm;
        self.rotations.clear();
        let mut used = 0;
        while used < BASIS && self.projected[used].abs() > goal {
            self.load_motion(Of::Basis(used));
            self.apply_preconditioner(task);
            self.multiply(task);
            self.iterations += 1;
            let length = self.orthogonalise(used);
            self.rotate(used);
            used += 1;
            if !length.is_finite() {
                return false;
            }
            if length == 0.0 {
                break;
            }
        }
        // The triangular system, and the combination of the basis.
        for r in (0..used).rev() {
            let known: f64 = (r + 1..used).map(|c| self.hessenberg[(r, c)] * self.coefficients[(c, 0)]).sum();
            self.coefficients[(r, 0)] = (self.projected[r] - known) / self.hessenberg[(r, r)];
        }
        let combined = self.basis.as_ref().subcols(0, used) * self.coefficients.as_ref().subrows(0, used);
        for (entry, motion) in self.motion.iter_mut().enumerate() {
            *motion = c64::new(combined[(2 * entry, 0)], combined[(2 * entry + 1, 0)]);
        }
        self.apply_preconditioner(task);
        for (entry, motion) in self.motion.iter().enumerate() {
            self.solution[(2 * entry, 0)] += motion.re;
            self.solution[(2 * entry + 1, 0)] += motion.im;
        }
        self.projected[used].abs() <= goal
    }

    /// Makes column `used + 1` of the basis from the product in `motion` (Gram–Schmidt, twice); its length before.
    fn orthogonalise(&mut self, used: usize) -> f64 {
        let (known, mut rest) = self.basis.as_mut().split_at_col_mut(used + 1);
        let known = known.as_ref();
        let mut new = rest.as_mut().subcols_mut(0, 1);
        for (entry, motion) in self.motion.iter().enumerate() {
            (new[(2 * entry, 0)], new[(2 * entry + 1, 0)]) = (motion.re, motion.im);
        }
        for r in 0..=used + 1 {
            self.hessenberg[(r, used)] = 0.0;
        }
        let mut parts = self.column.as_mut().subrows_mut(0, used + 1);
        for _ in 0..2 {
            matmul(parts.as_mut(), Accum::Replace, known.transpose(), new.as_ref(), 1.0, Par::Seq);
            matmul(new.as_mut(), Accum::Add, known, parts.as_ref(), -1.0, Par::Seq);
            for r in 0..=used {
                self.hessenberg[(r, used)] += parts[(r, 0)];
            }
        }
        let length = new.norm_l2();
        self.hessenberg[(used + 1, used)] = length;
        if length > 0.0 {
            for r in 0..new.nrows() {
                new[(r, 0)] /= length;
            }
        }
        length
    }

    /// Turns column `used` of the Hessenberg matrix into one of an upper triangle.
    fn rotate(&mut self, used: usize) {
        for (r, &(cos, sin)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (self.hessenberg[(r, used)], self.hessenberg[(r + 1, used)]);
            self.hessenberg[(r, used)] = cos * upper + sin * lower;
            self.hessenberg[(r + 1, used)] = cos * lower - sin * upper;
        }
        let (upper, lower) = (self.hessenberg[(used, used)], self.hessenberg[(used + 1, used)]);
        let size = upper.hypot(lower);
        let (cos, sin) = if size > 0.0 { (upper / size, lower / size) } else { (1.0, 0.0) };
        self.hessenberg[(used, used)] = size;
        self.rotations.push((cos, sin));
        let projected = self.projected[used];
        self.projected[used] = cos * projected;
        self.projected[used + 1] = -sin * projected;
    }

    fn load_motion(&mut self, of: Of) {
        let (source, column) = match of {
            Of::Basis(column) => (&self.basis, column),
            Of::Solution => (&self.solution, 0),
        };
        for (entry, motion) in self.motion.iter_mut().enumerate() {
            *motion = c64::new(source[(2 * entry, column)], source[(2 * entry + 1, column)]);
        }
    }

    /// Replaces the motion by what the preconditioner makes of it.
    fn apply_preconditioner(&mut self, task: &Task) {
        let width = task.point.width();
        for (lu, motion) in self.preconditioner.iter_mut().zip(self.motion.chunks_exact_mut(width.max(1))) {
            lu.solve(faer::MatMut::from_column_major_slice_mut(motion, width, 1));
        }
    }

    /// Replaces the motion v by J v.
    fn multiply(&mut self, task: &Task) {
        let (point, slots, width) = (task.point, task.core, task.point.width());
        for (entry, felt) in self.felt.iter_mut().enumerate() {
            *felt = -point.lent[entry] * self.motion[entry];
        }
        for (coupling, &(into, column)) in self.couplings.iter().enumerate() {
            for p in 0..slots {
                let row = &self.blocks[(coupling * slots + p) * slots..][..slots];
                let force: c64 = row
                    .iter()
                    .enumerate()
                    .map(|(j, (by_re, by_im))| {
                        let motion = self.motion[j * width + column];
                        by_re * motion.re + by_im * motion.im
                    })
                    .sum();
                self.felt[p * width + into] += force;
            }
        }
        for slot in 0..slots {
            let entries = slot * width..(slot + 1) * width;
            point.pull(slot, &self.felt[entries.clone()], &mut self.pull);
            for (pull, entry) in self.pull.iter().zip(entries) {
                self.motion[entry] = (self.motion[entry] + pull) * point.weight[entry];
            }
        }
    }
}

/// What a motion is taken from.
enum Of {
    Basis(usize),
    Solution,
}
