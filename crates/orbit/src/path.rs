//! A followed period: pieces on which every displacement is a polynomial.

use crate::polynomial::{Polynomial, TERMS, derivative, value};
use crate::scaled::{Joint, Scaled};
use crate::settings::EventKind;

/// One step of the motion, τ ∈ [start, start + length], s = (τ − start)/length ∈ [0, 1].
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) start: f64,
    pub(crate) length: f64,
    /// Coefficients of s^j, entry `[j][dof]`.
    pub(crate) coefficients: Vec<f64>,
    /// φ = stiffness · u + constant of every contact; empty for smooth systems.
    pub(crate) elastic: Vec<(f64, f64)>,
}

/// An event by its phase.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhaseEvent {
    pub(crate) tau: f64,
    pub(crate) slider: usize,
    pub(crate) kind: EventKind,
    pub(crate) direction: i8,
}

/// All pieces and events of a passage.
#[derive(Debug, Clone, Default)]
pub(crate) struct Path {
    pub(crate) pieces: Vec<Piece>,
    pub(crate) events: Vec<PhaseEvent>,
}

impl Piece {
    /// y of `dof` as a polynomial in s.
    pub(crate) fn polynomial(&self, dof: usize, dofs: usize) -> Polynomial {
        let mut out = [0.0; TERMS];
        for (out, row) in out.iter_mut().zip(self.coefficients.chunks_exact(dofs)) {
            *out = row.get(dof).copied().unwrap_or(0.0);
        }
        out
    }

    /// u of a contact as a polynomial in s.
    pub(crate) fn relative(&self, joint: &Joint, dofs: usize) -> Polynomial {
        let mut out = [0.0; TERMS];
        for (out, row) in out.iter_mut().zip(self.coefficients.chunks_exact(dofs)) {
            *out = joint.relative(row);
        }
        out
    }

    /// The derivative of y with respect to τ, `order` times, at s.
    pub(crate) fn state(&self, s: f64, order: usize, out: &mut [f64]) {
        let dofs = out.len();
        out.fill(0.0);
        for (j, row) in self.coefficients.chunks_exact(dofs).enumerate().skip(order).rev() {
            let factor = ((j - order + 1)..=j).fold(1.0, |product, q| product * q as f64);
            for (out, c) in out.iter_mut().zip(row) {
                *out = *out * s + factor * c;
            }
        }
        let scale = self.length.powi(-(order as i32));
        out.iter_mut().for_each(|out| *out *= scale);
    }

    /// The end of the piece.
    pub(crate) fn end(&self) -> f64 {
        self.start + self.length
    }
}

impl Path {
    /// The piece at phase τ and the place in it.
    pub(crate) fn at(&self, tau: f64) -> Option<(&Piece, f64)> {
        let index = self.pieces.partition_point(|piece| piece.start <= tau).max(1) - 1;
        let piece = self.pieces.get(index)?;
        Some((piece, ((tau - piece.start) / piece.length).clamp(0.0, 1.0)))
    }
}

/// A function of the place s in a piece.
pub(crate) type Along<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// Force of contact `c` along a piece, in units of the scaled system.
pub(crate) fn force<'a>(system: &'a Scaled, piece: &Piece, c: usize) -> Along<'a> {
    let Some(joint) = system.joints.get(c) else { return Box::new(|_| 0.0) };
    let u = piece.relative(joint, system.dofs);
    if joint.smooth.is_some() {
        let (rate, length) = (derivative(&u), piece.length);
        return Box::new(move |s| system.smooth(joint, value(&u, s), value(&rate, s) / length).0);
    }
    let (stiffness, constant) = piece.elastic.get(c).copied().unwrap_or((joint.spring, 0.0));
    Box::new(move |s| stiffness * value(&u, s) + constant)
}

/// u' of a contact along a piece.
pub(crate) fn relative_velocity<'a>(system: &Scaled, piece: &Piece, c: usize) -> Along<'a> {
    let Some(joint) = system.joints.get(c) else { return Box::new(|_| 0.0) };
    let (rate, length) = (derivative(&piece.relative(joint, system.dofs)), piece.length);
    Box::new(move |s| value(&rate, s) / length)
}
