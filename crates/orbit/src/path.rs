//! A followed period: pieces on which every displacement is a polynomial.

use crate::links::{Elastic, Link};
use crate::polynomial::{Polynomial, TERMS, derivative, value};
use crate::scaled::Scaled;
use crate::settings::EventKind;

/// One step of the motion, τ ∈ [start, start + length], s = (τ − start)/length ∈ [0, 1].
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) start: f64,
    pub(crate) length: f64,
    /// Coefficients of s^j, entry `[j][dof]`.
    pub(crate) coefficients: Vec<f64>,
    /// Of every link; empty for smooth systems.
    pub(crate) elastic: Vec<Elastic>,
    /// Forces that turn: link and φ as a polynomial in s.
    pub(crate) turning: Vec<(usize, Polynomial)>,
}

/// Something that has events, by its number in the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Element {
    Slider(usize),
    Press(usize),
}

/// An event by its phase.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhaseEvent {
    pub(crate) tau: f64,
    /// What changes.
    pub(crate) element: Element,
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

    /// u of a link as a polynomial in s.
    pub(crate) fn relative(&self, link: &Link, dofs: usize) -> Polynomial {
        let mut out = [0.0; TERMS];
        for (out, row) in out.iter_mut().zip(self.coefficients.chunks_exact(dofs)) {
            *out = link.relative(row);
        }
        out
    }

    /// φ of a link whose force turns.
    fn turning(&self, link: usize) -> Option<Polynomial> {
        self.turning.iter().find(|(own, _)| *own == link).map(|(_, force)| *force)
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

/// Force of link `c` along a piece, in units of the scaled system.
pub(crate) fn force<'a>(system: &'a Scaled, piece: &Piece, c: usize) -> Along<'a> {
    let Some(link) = system.links.get(c) else { return Box::new(|_| 0.0) };
    if link.smooth.is_some() {
        let u = piece.relative(link, system.dofs);
        let (rate, length) = (derivative(&u), piece.length);
        return Box::new(move |s| system.smooth(link, value(&u, s), value(&rate, s) / length).0);
    }
    if let Some(force) = piece.turning(c) {
        return Box::new(move |s| value(&force, s));
    }
    let constant = piece.elastic.get(c).map_or(0.0, |elastic| elastic.constant);
    let parts = parts(system, piece, c);
    Box::new(move |s| parts.iter().map(|(k, u)| k * value(u, s)).sum::<f64>() + constant)
}

/// φ' of a link without a smooth law along a piece.
pub(crate) fn force_rate<'a>(system: &Scaled, piece: &Piece, c: usize) -> Along<'a> {
    let length = piece.length;
    if let Some(force) = piece.turning(c) {
        let rate = derivative(&force);
        return Box::new(move |s| value(&rate, s) / length);
    }
    let parts = parts(system, piece, c).map(|(k, u)| (k, derivative(&u)));
    Box::new(move |s| parts.iter().map(|(k, rate)| k * (value(rate, s) / length)).sum())
}

/// The displacements that act on link `c`, its own first, with their stiffnesses.
fn parts(system: &Scaled, piece: &Piece, c: usize) -> [(f64, Polynomial); 2] {
    let spring =
        || Elastic { stiffness: system.links.get(c).map_or(0.0, |link| link.spring), ..Elastic::default() };
    let mut parts = piece.elastic.get(c).copied().unwrap_or_else(spring).parts(c);
    std::array::from_fn(|_| {
        let part = parts
            .next()
            .and_then(|(link, k)| Some((k, piece.relative(system.links.get(link)?, system.dofs))));
        part.unwrap_or((0.0, [0.0; TERMS]))
    })
}

/// u' of a link along a piece.
pub(crate) fn relative_velocity<'a>(system: &Scaled, piece: &Piece, c: usize) -> Along<'a> {
    let Some(link) = system.links.get(c) else { return Box::new(|_| 0.0) };
    let (rate, length) = (derivative(&piece.relative(link, system.dofs)), piece.length);
    Box::new(move |s| value(&rate, s) / length)
}
