//! Receptances as sums over the modes of the structure without contacts, where its damping leaves them uncoupled.
//!
//! With `M φ_r = μ_r (C + σM) φ_r`, `φ_rᵀ (C + σM) φ_r = 1`, and `φ_rᵀ D φ_s = 0` for r ≠ s, for contact directions B
//!
//! ```text
//! G_k = Σ_r (Bᵀφ_r)(Bᵀφ_r)ᵀ / h_r,   h_r = 1 − (σ + k²Ω²) μ_r + i kΩ φ_rᵀ D φ_r
//! ```
//!
//! which costs `modes · contacts²` at every harmonic where a factorisation costs `dofs³`. Normalised with the stiffness, the
//! lowest modes are the most accurate ones and a motion without mass is a mode like any other, μ = 0; a shift σ is needed
//! only where C is singular.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, Par, Side, c64};

use crate::condensation::Load;
use crate::rows::Rows;

/// Dofs from which modes are worth their computation.
const MODAL_FROM: usize = 48;

/// Shifts that are tried, relative to the mean of stiffness over mass.
const SHIFTS: [f64; 3] = [0.0, 1e-6, 1e-3];

/// Nearer to a resonance than this, relative to the terms of h, rounding of the modes would be seen.
const NEAR: f64 = 1e-4;

/// Coupling between two modes, relative to √(h_r h_s), that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Part of the terms of a dof's balance that may be left.
const LEFT: f64 = 1e-11;

/// Modes in a block, which are judged together.
const BLOCK: usize = 4;

/// Coupling at which damping is not modal, or the modes are none, relative to the largest entry.
const COUPLED: f64 = 1e-10;

/// The modes as contacts, outputs and excitation see them.
#[derive(Debug)]
pub(crate) struct Modal {
    shift: f64,
    /// μ_r.
    inertia: Vec<f64>,
    /// φ_rᵀ D φ_r.
    damping: Vec<f64>,
    /// Largest entries of ΦᵀCΦ, ΦᵀMΦ and ΦᵀDΦ beside the diagonal, by blocks of modes: zero but for rounding.
    coupling: Vec<[f64; 3]>,
    /// Bᵀφ_r, one row a mode.
    contacts: Mat<f64>,
    /// φ_r at the output dofs, likewise.
    outputs: Mat<f64>,
    /// φ_r, one column a mode.
    shapes: Mat<f64>,
    /// φ_rᵀ f of every slot, and the part of it that grows with Ω².
    loads: Vec<(Vec<c64>, Vec<c64>)>,
}

/// Buffers for one thread, empty until they are used.
#[derive(Debug)]
pub(crate) struct ModalBuffers {
    /// 1/h_r.
    answers: Vec<c64>,
    /// The largest magnitude in each block.
    largest: Vec<f64>,
    scaled: Mat<f64>,
    /// A motion, what is left of its balance, and the size of the terms.
    motion: Vec<c64>,
    left: [Vec<f64>; 2],
    terms: Vec<f64>,
    pub(crate) receptance: [Mat<f64>; 2],
    pub(crate) recovery: [Mat<f64>; 2],
}

impl ModalBuffers {
    pub(crate) fn new() -> Self {
        let none = || [Mat::new(), Mat::new()];
        Self {
            answers: Vec::new(),
            largest: Vec::new(),
            scaled: Mat::new(),
            motion: Vec::new(),
            left: [Vec::new(), Vec::new()],
            terms: Vec::new(),
            receptance: none(),
            recovery: none(),
        }
    }
}

/// Eigenvalues μ and eigenvectors Φ of `M φ = μ (C + σM) φ`, the latter normalised with C + σM.
fn modes(mass: &Mat<f64>, stiffness: &Mat<f64>, shift: f64) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = mass.nrows();
    // Balanced, so that dofs of any unit are alike.
    let shifted = |i: usize, j: usize| stiffness[(i, j)] + shift * mass[(i, j)];
    let scale: Vec<f64> = (0..n).map(|i| 1.0 / shifted(i, i).sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    let factor = Mat::from_fn(n, n, |i, j| shifted(i, j) * (scale[i] * scale[j])).llt(Side::Lower).ok()?;
    let mut half = Mat::from_fn(n, n, |i, j| mass[(i, j)] * (scale[i] * scale[j]));
    solve_lower_triangular_in_place(factor.L(), half.as_mut(), Par::Seq);
    let mut whole = half.transpose().to_owned();
    solve_lower_triangular_in_place(factor.L(), whole.as_mut(), Par::Seq);
    // Of a matrix far from one in size, faer's decomposition with vectors loses most digits.
    let size = whole.norm_max().max(f64::MIN_POSITIVE);
    let whole = Mat::from_fn(n, n, |i, j| 0.5 * (whole[(i, j)] + whole[(j, i)]) / size);
    let eigen = whole.self_adjoint_eigen(Side::Lower).ok()?;
    let mut shapes = eigen.U().to_owned();
    solve_upper_triangular_in_place(factor.L().transpose(), shapes.as_mut(), Par::Seq);
    for j in 0..n {
        for (i, scale) in scale.iter().enumerate() {
            shapes[(i, j)] *= scale;
        }
    }
    Some((eigen.S().column_vector().iter().map(|value| value * size).collect(), shapes))
}

/// Blocks of modes: `(first, end)`.
fn blocks(modes: usize) -> impl Iterator<Item = (usize, usize)> + Clone {
    (0..modes).step_by(BLOCK).map(move |first| (first, modes.min(first + BLOCK)))
}

/// The largest entry beside the diagonal in every pair of blocks.
fn beside_diagonal(matrix: &Mat<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let largest = |((top, bottom), (left, right)): ((usize, usize), (usize, usize))| {
        let mut largest = 0.0_f64;
        for j in left..right {
            for i in (top..bottom).filter(|&i| i != j) {
                let entry = matrix[(i, j)].abs();
                // Not a number is as bad as can be.
                largest = if entry.is_nan() { f64::INFINITY } else { largest.max(entry) };
            }
        }
        largest
    };
    blocks(n).flat_map(|rows| blocks(n).map(move |columns| (rows, columns))).map(largest).collect()
}

/// φ_rᵀ f, and the part of it that grows with Ω².
fn projected(loads: &[Load], shapes: &Mat<f64>) -> (Vec<c64>, Vec<c64>) {
    let part = |grows: bool| {
        let sum = |r: usize| {
            loads
                .iter()
                .filter(|load| load.grows == grows)
                .map(|load| load.amplitude * shapes[(load.dof, r)])
                .sum()
        };
        (0..shapes.ncols()).map(sum).collect()
    };
    (part(false), part(true))
}

impl Modal {
    /// The modes of a structure whose damping does not couple them; `None` where it does, where there are none, and where
    /// they are not worth it.
    pub(crate) fn new(
        mass: &Mat<f64>,
        damping: &Mat<f64>,
        stiffness: &Mat<f64>,
        rows: &Rows,
        outputs: &[usize],
        loads: &[Vec<Load>],
    ) -> Option<Self> {
        let n = mass.nrows();
        if n < MODAL_FROM {
            return None;
        }
        let mean =
            (0..n).map(|i| stiffness[(i, i)].abs()).sum::<f64>() / (0..n).map(|i| mass[(i, i)]).sum::<f64>();
        SHIFTS.into_iter().find_map(|shift| {
            let shift = shift * mean;
            let (_, rough) = modes(mass, stiffness, shift)?;
            let between = |shapes: &Mat<f64>, matrix: &Mat<f64>| shapes.transpose() * (matrix * shapes);
            // Once more among themselves (Rayleigh–Ritz): the factor of an ill-conditioned stiffness leaves them coupled.
            let (inertia, turned) = modes(&between(&rough, mass), &between(&rough, stiffness), shift)?;
            let shapes = &rough * &turned;
            let parts = [stiffness, mass, damping].map(|matrix| between(&shapes, matrix));
            let [stiff, heavy, damped] = parts.each_ref().map(beside_diagonal);
            for (beside, part) in [&stiff, &heavy, &damped].into_iter().zip(&parts) {
                let on = (0..n).map(|r| part[(r, r)].abs()).fold(0.0, f64::max);
                if beside.iter().any(|beside| *beside > COUPLED * on) {
                    return None;
                }
            }
            let coupling = stiff.iter().zip(&heavy).zip(&damped).map(|((c, m), d)| [*c, *m, *d]).collect();
            let across = |l: usize, r: usize| -> f64 {
                rows.parts(l).iter().map(|&(dof, coefficient)| shapes[(dof, r)] * coefficient).sum()
            };
            Some(Self {
                shift,
                damping: (0..n).map(|r| parts[2][(r, r)]).collect(),
                coupling,
                contacts: Mat::from_fn(n, rows.count(), |r, l| across(l, r)),
                outputs: Mat::from_fn(n, outputs.len(), |r, o| shapes[(outputs[o], r)]),
                loads: loads.iter().map(|loads| projected(loads, &shapes)).collect(),
                shapes,
                inertia,
            })
        })
    }

    /// Whether the sum over modes answered last solves the equations of motion under `forces` (dof, N): of every dof's balance
    /// no more than a rounded part is left, also where hardly anything moves.
    pub(crate) fn solves(
        &self,
        omega: f64,
        [mass, damping, stiffness]: [&Mat<f64>; 3],
        forces: impl Iterator<Item = (usize, c64)> + Clone,
        into: &mut ModalBuffers,
    ) -> bool {
        let n = self.shapes.nrows();
        let ModalBuffers { answers, motion, left, terms, .. } = into;
        let [left_re, left_im] = left;
        motion.clear();
        motion.resize(n, c64::ZERO);
        for buffer in [&mut *left_re, &mut *left_im, &mut *terms] {
            buffer.clear();
            buffer.resize(n, 0.0);
        }
        for (r, answer) in answers.iter().enumerate() {
            let force: c64 = forces.clone().map(|(dof, force)| force * self.shapes[(dof, r)]).sum();
            let amplitude = answer * force;
            for (w, shape) in motion.iter_mut().zip(self.shapes.col(r).iter()) {
                *w += amplitude * shape;
            }
        }
        for (dof, force) in forces {
            left_re[dof] -= force.re;
            left_im[dof] -= force.im;
            terms[dof] += force.norm();
        }
        let square = omega * omega;
        for (j, w) in motion.iter().enumerate() {
            let size = w.norm();
            let [c, m, d] = [stiffness, mass, damping].map(|matrix| matrix.col_as_slice(j));
            let columns = c.iter().zip(m).zip(d);
            let rows = left_re.iter_mut().zip(left_im.iter_mut()).zip(terms.iter_mut());
            for (((re, im), terms), ((c, m), d)) in rows.zip(columns) {
                let (at_rest, losing) = (c - square * m, omega * d);
                *re += at_rest * w.re - losing * w.im;
                *im += at_rest * w.im + losing * w.re;
                *terms += (c.abs() + square * m.abs() + losing.abs()) * size;
            }
        }
        let left = left_re.iter().zip(left_im.iter());
        left.zip(terms.iter()).all(|((re, im), terms)| re.hypot(*im) <= LEFT * terms)
    }

    /// Receptance (lower triangle) and recovery at the angular frequency `omega`, real and imaginary parts; whether the modes
    /// say what they are.
    pub(crate) fn respond(&self, omega: f64, into: &mut ModalBuffers) -> bool {
        let (modes, contacts, outputs) = (self.inertia.len(), self.contacts.ncols(), self.outputs.ncols());
        into.answers.clear();
        for (&inertia, &damping) in self.inertia.iter().zip(&self.damping) {
            let (moving, losing) = ((self.shift + omega * omega) * inertia, omega * damping);
            let h = c64::new(1.0 - moving, losing);
            if h.norm() < NEAR * (1.0 + moving.abs() + losing.abs()) {
                return false;
            }
            into.answers.push(1.0 / h);
        }
        into.largest.clear();
        let largest = |(first, end)| into.answers[first..end].iter().map(|a| a.norm()).fold(0.0, f64::max);
        into.largest.extend(blocks(modes).map(largest));
        let pairs = into.largest.iter().flat_map(|a| into.largest.iter().map(move |b| a * b));
        let coupled = |([stiff, heavy, damped], answers): (&[f64; 3], f64)| {
            (stiff + omega * omega * heavy + omega * damped).powi(2) * answers > ROUNDING * ROUNDING
        };
        if self.coupling.iter().zip(pairs).any(coupled) {
            return false;
        }
        if into.scaled.ncols() != contacts || into.scaled.nrows() != modes {
            into.scaled = Mat::zeros(modes, contacts);
            into.receptance = [Mat::zeros(contacts, contacts), Mat::zeros(contacts, contacts)];
            into.recovery = [Mat::zeros(outputs, contacts), Mat::zeros(outputs, contacts)];
        }
        let parts: [fn(&c64) -> f64; 2] = [|z| z.re, |z| z.im];
        for (part, of) in parts.into_iter().enumerate() {
            for l in 0..contacts {
                for (r, answer) in into.answers.iter().enumerate() {
                    into.scaled[(r, l)] = of(answer) * self.contacts[(r, l)];
                }
            }
            triangular::matmul(
                into.receptance[part].as_mut(),
                BlockStructure::TriangularLower,
                Accum::Replace,
                self.contacts.transpose(),
                BlockStructure::Rectangular,
                into.scaled.as_ref(),
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
            let recovery = into.recovery[part].as_mut();
            matmul(recovery, Accum::Replace, self.outputs.transpose(), into.scaled.as_ref(), 1.0, Par::Seq);
        }
        true
    }

    /// Response to the excitation of `slot` at the contacts and at the outputs.
    pub(crate) fn free(
        &self,
        slot: usize,
        base: f64,
        buffers: &ModalBuffers,
        contacts: &mut [c64],
        outputs: &mut [c64],
    ) {
        contacts.fill(c64::ZERO);
        outputs.fill(c64::ZERO);
        let Some((steady, growing)) = self.loads.get(slot) else { return };
        let loads = steady.iter().zip(growing);
        for (r, (answer, (steady, growing))) in buffers.answers.iter().zip(loads).enumerate() {
            let amplitude = answer * (steady + growing * (base * base));
            if amplitude == c64::ZERO {
                continue;
            }
            for (l, contact) in contacts.iter_mut().enumerate() {
                *contact += amplitude * self.contacts[(r, l)];
            }
            for (o, output) in outputs.iter_mut().enumerate() {
                *output += amplitude * self.outputs[(r, o)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of 60 masses, both ends held, that a mass-proportional and a stiffness-proportional part damp.
    fn chain(held: f64) -> [Mat<f64>; 3] {
        let n = 60;
        let mass = Mat::from_fn(n, n, |i, j| if i == j { 0.5 + 0.3 * (i as f64).sin() } else { 0.0 });
        let stiffness = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 if i == 0 || i == n - 1 => 1e6 + held,
            0 => 2e6,
            1 => -1e6,
            _ => 0.0,
        });
        let damping = Mat::from_fn(n, n, |i, j| 3.0 * mass[(i, j)] + 2e-5 * stiffness[(i, j)]);
        [mass, damping, stiffness]
    }

    fn modal([mass, damping, stiffness]: &[Mat<f64>; 3]) -> Option<Modal> {
        let rows = Rows::of(&[&[(7, 1.0)], &[(30, 1.0), (33, -1.0)], &[(59, 1.0)]]);
        Modal::new(mass, damping, stiffness, &rows, &[12], &[])
    }

    /// Largest relative error of receptance and recovery against a dense solve, over frequencies.
    fn error(matrices: &[Mat<f64>; 3], modal: &Modal, frequencies: &[f64]) -> f64 {
        let [mass, damping, stiffness] = matrices;
        let n = mass.nrows();
        let directions = Mat::from_fn(n, 3, |i, l| {
            let entry = |dof: usize| if i == dof { 1.0 } else { 0.0 };
            c64::from([entry(7), entry(30) - entry(33), entry(59)][l])
        });
        let mut buffers = ModalBuffers::new();
        let mut worst = 0.0_f64;
        for hertz in frequencies {
            let omega = std::f64::consts::TAU * hertz;
            assert!(modal.respond(omega, &mut buffers), "{hertz} Hz");
            let h = Mat::from_fn(n, n, |i, j| {
                c64::new(stiffness[(i, j)] - omega * omega * mass[(i, j)], omega * damping[(i, j)])
            });
            let solved = faer::linalg::solvers::Solve::solve(&h.partial_piv_lu(), &directions);
            let exact = directions.transpose() * &solved;
            for l in 0..3 {
                for i in l..3 {
                    let entry = c64::new(buffers.receptance[0][(i, l)], buffers.receptance[1][(i, l)]);
                    worst = worst.max((entry - exact[(i, l)]).norm() / exact.norm_max());
                }
                let entry = c64::new(buffers.recovery[0][(0, l)], buffers.recovery[1][(0, l)]);
                worst = worst.max((entry - solved[(12, l)]).norm() / solved.norm_max());
            }
        }
        worst
    }

    #[test]
    fn receptances_are_those_of_a_factorisation() {
        let chain = chain(1e6);
        let modal = modal(&chain).unwrap();
        let error = error(&chain, &modal, &[0.0, 3.0, 13.0, 40.0, 111.0, 320.0, 900.0]);
        assert!(error < 2e-12, "{error:e}");
    }

    #[test]
    fn a_dof_without_mass_is_a_mode_without_inertia() {
        let mut chain = chain(1e6);
        for massless in [7, 20] {
            let lost = chain[0][(massless, massless)];
            chain[0][(massless, massless)] = 0.0;
            chain[1][(massless, massless)] -= 3.0 * lost;
        }
        let modal = modal(&chain).unwrap();
        assert!(modal.shift == 0.0 && modal.inertia.iter().filter(|m| m.abs() < 1e-16).count() == 2);
        let error = error(&chain, &modal, &[0.0, 13.0, 320.0]);
        assert!(error < 2e-12, "{error:e}");
    }

    #[test]
    fn a_free_structure_has_modes_by_a_shift() {
        let chain = chain(0.0);
        let modal = modal(&chain).unwrap();
        assert!(modal.shift > 0.0);
        let error = error(&chain, &modal, &[13.0, 40.0, 320.0]);
        assert!(error < 1e-10, "{error:e}");
        assert!(!modal.respond(0.0, &mut ModalBuffers::new()), "the free motion has no receptance");
    }

    #[test]
    fn what_couples_modes_has_none() {
        let mut damper = chain(1e6);
        damper[1][(4, 4)] += 10.0;
        assert!(modal(&damper).is_none());
        let mut turning = chain(1e6);
        (turning[1][(4, 5)], turning[1][(5, 4)]) = (turning[1][(4, 5)] + 1.0, turning[1][(5, 4)] - 1.0);
        assert!(modal(&turning).is_none());
    }

    #[test]
    fn an_undamped_resonance_is_left_to_a_factorisation() {
        let mut chain = chain(1e6);
        chain[1] = Mat::zeros(60, 60);
        let modal = modal(&chain).unwrap();
        let resonance = 1.0 / modal.inertia.iter().copied().fold(0.0, f64::max).sqrt();
        let mut buffers = ModalBuffers::new();
        assert!(!modal.respond(resonance * (1.0 + 1e-6), &mut buffers));
        assert!(modal.respond(resonance * 1.01, &mut buffers));
    }
}
