//! Static shapes for the inertia that the modes leave: what the modes above the cut would add to the kept dofs.
//!
//! With K = C_ii − σM_ii, ω the highest frequency and z = ω² − σ, the constraint modes Ψ leave the forces
//!
//! ```text
//! F₁ = z (M_ii Ψ + M_ib) S⁻¹,   X₁ = K⁻¹ F₁,   F_{j+1} = z M_ii X_j,   X_{j+1} = K⁻¹ F_{j+1}
//! ```
//!
//! with base motions M r next to them, and ω D in place of z M once more where damping is a matrix. With X₁ … X_j next to the constraint modes the reduced structure matches 2j + 1
//! powers of the square of the frequency around σ: modes far above the band need not be known one by one. In each X_j
//! the parts along the modes are taken off, and combinations are put in order of their energy γ = xᵀK x, so that few of
//! many shapes do. S scales the kept dofs as in the error, so γ compares with one.
//!
//! Second and higher static shapes: Shyu, Ma, Hulbert, Finite Elem. Anal. Des. 24 (1997) 271; powers of the square of the
//! frequency: Freund, Acta Numer. 12 (2003) 267.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::factor::Factor;
use crate::modes::{Modes, eigen};
use crate::pencil::Pencil;
use crate::reduction::ReductionError;

/// Energy of a shape that is rounding: it is made of numbers about one.
const NOTHING: f64 = 1e-20;

/// Shapes of all blocks so far, K-orthonormal and K-orthogonal to the modes.
pub(crate) struct ResidualShapes<'a> {
    pencil: &'a Pencil,
    factor: &'a Factor<'a>,
    /// One column a shape.
    shapes: Mat<f64>,
    /// K times the shapes.
    forces: Mat<f64>,
    /// Energy γ of each shape in its block.
    energies: Vec<f64>,
    /// Largest energy of the newest block; `None` before the first.
    newest: Option<f64>,
    /// Shapes above this energy are taken.
    least: f64,
    /// F of the next block, before the parts along modes and shapes are taken off.
    next: Mat<f64>,
}

impl<'a> ResidualShapes<'a> {
    /// `forces` is F₁.
    pub(crate) fn new(pencil: &'a Pencil, factor: &'a Factor<'a>, forces: Mat<f64>) -> Self {
        let none = || Mat::zeros(pencil.size(), 0);
        Self {
            pencil,
            factor,
            shapes: none(),
            forces: none(),
            energies: Vec::new(),
            newest: None,
            least: f64::INFINITY,
            next: forces,
        }
    }

    /// Takes more shapes, so that an error falls by the factor `fall` < 1: it goes with the largest energy that is left
    /// out. `forces` gives F of the next block for shapes. False when no shape is left.
    pub(crate) fn more(
        &mut self,
        modes: &Modes,
        fall: f64,
        forces: &dyn Fn(&Mat<f64>) -> Mat<f64>,
    ) -> Result<bool, ReductionError> {
        if self.newest.is_none() {
            self.extend(modes, forces)?;
        }
        let out = |energy: &&f64| **energy <= self.least;
        let Some(&left) = self.energies.iter().filter(out).max_by(|a, b| a.total_cmp(b)) else {
            return Ok(false);
        };
        self.least = 0.5 * fall * left;
        while self.newest.is_some_and(|energy| energy > self.least) {
            self.extend(modes, forces)?;
        }
        Ok(true)
    }

    /// One block more.
    fn extend(&mut self, modes: &Modes, next: &dyn Fn(&Mat<f64>) -> Mat<f64>) -> Result<(), ReductionError> {
        let mut forces = std::mem::replace(&mut self.next, Mat::zeros(self.pencil.size(), 0));
        // Twice, as rounding brings parts back.
        let momenta = self.pencil.mass_times(modes.shapes.as_ref());
        for _ in 0..2 {
            take_off(&mut forces, &modes.shapes, &momenta);
            take_off(&mut forces, &self.shapes, &self.forces);
        }
        let mut shapes = forces.clone();
        self.factor.solve(shapes.as_mut())?;
        let (values, vectors) = eigen(gram(&shapes, &forces).as_ref())?;
        let order: Vec<usize> = (0..values.len()).rev().filter(|&k| values[k] > NOTHING).collect();
        let energetic = Mat::from_fn(values.len(), order.len(), |i, k| vectors[(i, order[k])]);
        let raw = times(&shapes, &energetic);
        self.next = next(&raw);
        let unit =
            Mat::from_fn(values.len(), order.len(), |i, k| energetic[(i, k)] / values[order[k]].sqrt());
        append(&mut self.shapes, times(&shapes, &unit).as_ref());
        append(&mut self.forces, times(&forces, &unit).as_ref());
        self.energies.extend(order.iter().map(|&k| values[k]));
        self.newest = Some(order.first().map_or(0.0, |&k| values[k]));
        Ok(())
    }

    /// The shapes taken, `most` at most, as approximate modes: φᵀ M φ = 1, orthogonal in K and M.
    pub(crate) fn taken(&self, most: usize) -> Result<Mat<f64>, ReductionError> {
        let mut order: Vec<usize> =
            (0..self.energies.len()).filter(|&k| self.energies[k] > self.least).collect();
        order.sort_by(|&a, &b| self.energies[b].total_cmp(&self.energies[a]));
        order.truncate(most);
        let shapes = Mat::from_fn(self.shapes.nrows(), order.len(), |i, k| self.shapes[(i, order[k])]);
        if shapes.ncols() == 0 {
            return Ok(shapes);
        }
        let (values, vectors) = eigen(gram(&shapes, &self.pencil.mass_times(shapes.as_ref())).as_ref())?;
        let massive: Vec<usize> = (0..values.len()).rev().filter(|&k| values[k] > 0.0).collect();
        let unit = Mat::from_fn(values.len(), massive.len(), |i, k| {
            vectors[(i, massive[k])] / values[massive[k]].sqrt()
        });
        Ok(times(&shapes, &unit))
    }
}

/// F ← F − G Xᵀ F.
fn take_off(forces: &mut Mat<f64>, shapes: &Mat<f64>, along: &Mat<f64>) {
    let mut share = Mat::zeros(shapes.ncols(), forces.ncols());
    matmul(share.as_mut(), Accum::Replace, shapes.transpose(), forces.as_ref(), 1.0, Par::Seq);
    matmul(forces.as_mut(), Accum::Add, along.as_ref(), share.as_ref(), -1.0, Par::Seq);
}

fn times(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(out.as_mut(), Accum::Replace, a.as_ref(), b.as_ref(), 1.0, Par::Seq);
    out
}

/// Xᵀ Y, symmetric up to rounding, made so.
fn gram(x: &Mat<f64>, y: &Mat<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(x.ncols(), y.ncols());
    matmul(out.as_mut(), Accum::Replace, x.transpose(), y.as_ref(), 1.0, Par::Seq);
    Mat::from_fn(x.ncols(), x.ncols(), |i, j| 0.5 * (out[(i, j)] + out[(j, i)]))
}

fn append(to: &mut Mat<f64>, columns: MatRef<'_, f64>) {
    let before = to.ncols();
    to.resize_with(columns.nrows(), before + columns.ncols(), |i, j| columns[(i, j - before)]);
}
