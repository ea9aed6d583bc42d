//! Harmonics of a piecewise linear force in closed form, from the phases of its events.
//!
//! With `f(τ) = κ(τ) w(τ) + c(τ)`, κ and c constant between events, everything follows from integrals of e^{−iqτ}:
//!
//! ```text
//! I_q = (1/2π) ∫ e^{−iqτ} dτ over a piece,   K_q = Σ κ I_q,   C_q = Σ c I_q
//! F_p = ε_p [Σ_j W_j K_{p−j} + conj(W_j) K_{p+j} + 2 C_p],   ε_0 = ½, ε_p = 1
//! ```

use std::f64::consts::TAU;

use contact::{ForcePiece, Recall, drop_from};
use faer::c64;

/// The force of one contact by its events; buffers are reused.
#[derive(Debug, Default)]
pub(crate) struct PieceSeries {
    pub(crate) pieces: Vec<ForcePiece>,
    /// I_q, one row a piece.
    integrals: Vec<c64>,
    /// K_q.
    stiffness: Vec<c64>,
    /// The part of K_q that makes the force: of pieces that are not brief.
    lasting: Vec<c64>,
    /// C_q, likewise.
    constant: Vec<c64>,
    /// What brief pieces add to F_p, two-sided.
    brief: Vec<c64>,
    /// The distinct functionals that the pieces remember.
    recalls: Vec<Recall>,
}

impl PieceSeries {
    /// Integrates the pieces for harmonics of the motion up to `highest`.
    pub(crate) fn integrate(&mut self, spectrum: &[c64], highest: usize) {
        let length = 2 * highest + 1;
        self.integrals.resize(self.pieces.len() * length, c64::ZERO);
        for coefficients in [&mut self.stiffness, &mut self.lasting, &mut self.constant] {
            coefficients.clear();
            coefficients.resize(length, c64::ZERO);
        }
        self.brief.clear();
        self.brief.resize(highest + 1, c64::ZERO);
        for (piece, row) in self.pieces.iter().zip(self.integrals.chunks_exact_mut(length)) {
            integrals(piece, row);
            if piece.stiffness == 0.0 {
                add(&mut self.constant, row, piece.offset);
                continue;
            }
            add(&mut self.stiffness, row, piece.stiffness);
            let width = piece.to - piece.from;
            if width < BRIEF && width * (highest as f64) < RESOLVED {
                add_brief(&mut self.brief, piece, spectrum);
            } else {
                add(&mut self.lasting, row, piece.stiffness);
                add(&mut self.constant, row, piece.offset);
            }
        }
    }

    /// The stiffness whose product with the motion, with [`PieceSeries::constant`], is the force, in N/m.
    pub(crate) fn lasting_stiffness(&self) -> &[c64] {
        &self.lasting
    }

    /// K_q, q = 0 … twice the highest harmonic, in N/m.
    pub(crate) fn stiffness(&self) -> &[c64] {
        &self.stiffness
    }

    /// C_q in N, and what brief pieces add.
    pub(crate) fn constant(&self, order: usize) -> c64 {
        let at = |row: &[c64]| row.get(order).copied().unwrap_or(c64::ZERO);
        at(&self.constant) + at(&self.brief)
    }

    /// F_p in N for p = `orders[slot]`, of the motion with spectrum W (index: order).
    pub(crate) fn force(&self, spectrum: &[c64], orders: &[usize], slot: usize) -> c64 {
        let p = orders[slot];
        let mut sum = 2.0 * self.constant(p);
        for &j in orders {
            let difference = if p >= j { self.lasting[p - j] } else { self.lasting[j - p].conj() };
            sum += spectrum[j] * difference + spectrum[j].conj() * self.lasting[p + j];
        }
        if p == 0 { 0.5 * sum } else { sum }
    }

    /// The distinct memories; appends the one-sided influence of each at `orders` in N/m to `influences`.
    pub(crate) fn memories(&mut self, orders: &[usize], influences: &mut Vec<c64>) -> &[Recall] {
        let length = self.stiffness.len();
        self.recalls.clear();
        for (recall, _) in self.pieces.iter().filter_map(|piece| piece.memory) {
            if !self.recalls.contains(&recall) {
                self.recalls.push(recall);
            }
        }
        for &recall in &self.recalls {
            for &order in orders {
                let rows = self.pieces.iter().zip(self.integrals.chunks_exact(length));
                let sum: c64 = rows
                    .filter_map(|(piece, row)| {
                        let (own, strength) = piece.memory?;
                        (own == recall).then(|| row[order] * strength)
                    })
                    .sum();
                influences.push(if order == 0 { sum } else { 2.0 * sum });
            }
        }
        &self.recalls
    }
}

/// I_q for q = 0 … as many as there is room for: ∫ e^{−iqτ} dτ = e^{−iq mid} sin(q half) · 2/q. With the half width as a
/// factor a short piece keeps its digits: at amplitudes far above the slip displacement a piece that sticks is short and
/// its stiffness large.
fn integrals(piece: &ForcePiece, row: &mut [c64]) {
    let half = 0.5 * (piece.to - piece.from);
    let (turn, widen) = (c64::cis(-(piece.from + half)), c64::cis(half));
    let (mut middle, mut width) = (turn, widen);
    for (q, integral) in row.iter_mut().enumerate() {
        if q == 0 {
            *integral = c64::from(2.0 * half / TAU);
            continue;
        }
        *integral = middle * (width.im * 2.0 / (q as f64 * TAU));
        middle *= turn;
        width *= widen;
    }
}

/// Pieces shorter than this, in rad, are integrated by quadrature: at amplitudes so far above the slip displacement κ w and c
/// would cancel.
const BRIEF: f64 = 1e-4;

/// Up to this many radians of the highest wave the quadrature is exact to rounding.
const RESOLVED: f64 = 0.5;

/// Nodes on (0, 1) and weights of the Gauss–Legendre rule with five points.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Adds (1/2π) ∫ f e^{−ipτ} dτ over a piece that starts at a turning point.
fn add_brief(sum: &mut [c64], piece: &ForcePiece, spectrum: &[c64]) {
    let width = piece.to - piece.from;
    for (node, weight) in GAUSS {
        let delta = node * width;
        let force = piece.start_force - piece.stiffness * drop_from(spectrum, piece.from, delta);
        let turn = c64::cis(-(piece.from + delta));
        let mut wave = c64::from(force * weight * width / TAU);
        for entry in sum.iter_mut() {
            *entry += wave;
            wave *= turn;
        }
    }
}

fn add(sum: &mut [c64], row: &[c64], factor: f64) {
    for (sum, entry) in sum.iter_mut().zip(row) {
        *sum += entry * factor;
    }
}
