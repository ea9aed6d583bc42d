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
    /// The part of K_q that makes the force: of pieces that are not close.
    lasting: Vec<c64>,
    /// C_q, likewise.
    constant: Vec<c64>,
    /// What close pieces add to F_p, two-sided.
    close: Vec<c64>,
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
        self.close.clear();
        self.close.resize(highest + 1, c64::ZERO);
        for (piece, row) in self.pieces.iter().zip(self.integrals.chunks_exact_mut(length)) {
            integrals(piece, row);
            if piece.stiffness == 0.0 {
                add(&mut self.constant, row, piece.offset);
                continue;
            }
            add(&mut self.stiffness, row, piece.stiffness);
            if piece.close {
                add_close(&mut self.close, piece, spectrum);
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

    /// C_q in N, and what close pieces add.
    pub(crate) fn constant(&self, order: usize) -> c64 {
        let at = |row: &[c64]| row.get(order).copied().unwrap_or(c64::ZERO);
        at(&self.constant) + at(&self.close)
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
fn add_close(sum: &mut [c64], piece: &ForcePiece, spectrum: &[c64]) {
    let width = piece.to - piece.from;
    let panels = (width * (sum.len() - 1) as f64 / RESOLVED).ceil().max(1.0);
    let panel = width / panels;
    for index in 0..panels as usize {
        for (node, weight) in GAUSS {
            let delta = (index as f64 + node) * panel;
            let force = piece.start_force - piece.stiffness * drop_from(spectrum, piece.from, delta);
            let turn = c64::cis(-(piece.from + delta));
            let mut wave = c64::from(force * weight * panel / TAU);
            for entry in sum.iter_mut() {
                *entry += wave;
                wave *= turn;
            }
        }
    }
}

fn add(sum: &mut [c64], row: &[c64], factor: f64) {
    for (sum, entry) in sum.iter_mut().zip(row) {
        *sum += entry * factor;
    }
}

#[cfg(test)]
mod tests {
    use contact::{ElasticCoulomb, ElasticCoulombParameters, Motion, PiecewiseLinear, Workspace};

    use super::*;

    /// W_1, W_3 and W_5: the velocity goes through zero and back within 1e-4 of a period, twice a period.
    const TOUCHING: [c64; 6] = [
        c64::ZERO,
        c64::new(0.4776682350094381, 0.14776010037546772),
        c64::ZERO,
        c64::new(0.10360166137844408, 0.13055448493791388),
        c64::ZERO,
        c64::new(3e-10, -5e-10),
    ];

    const ORDERS: [usize; 3] = [1, 3, 5];

    /// The series of a slider of unit slip force.
    fn series(slip_displacement: f64, spectrum: &[c64]) -> PieceSeries {
        let parameters = ElasticCoulombParameters { stiffness: 1.0 / slip_displacement, slip_force: 1.0 };
        let law = ElasticCoulomb::new(parameters).unwrap();
        let velocity: Vec<f64> = (0..64)
            .map(|j| {
                let wave = |k: usize| c64::cis((k * j) as f64 * TAU / 64.0) * k as f64;
                -spectrum.iter().enumerate().map(|(k, w)| (w * wave(k)).im).sum::<f64>()
            })
            .collect();
        let motion = Motion { spectrum, displacement: &[], velocity: &velocity, odd: true, omega: 1.0 };
        let mut series = PieceSeries::default();
        law.pieces(&motion, &mut Workspace::new(64), &mut series.pieces).unwrap();
        series.integrate(spectrum, spectrum.len() - 1);
        series
    }

    /// Amplitudes of 2e11 and 3e12 slip displacements. The reference was marched from event to event with 40 digits and
    /// integrated in closed form (mpmath 1.3). With the larger slip displacement the short way back is not long enough to
    /// slip. With κ w + c the error would be 2e-9.
    #[test]
    fn short_ways_keep_their_digits() {
        let reference = [
            (
                4e-12,
                [
                    c64::new(-0.376_257_600_777_453_16, 1.216_346_657_216_218),
                    c64::new(-0.332_474_292_125_627_36, 0.263_838_429_060_792_9),
                    c64::new(-0.253_982_436_319_433_2, 0.018_013_524_196_886_394),
                ],
            ),
            (
                2e-13,
                [
                    c64::new(-0.376_210_446_189_538_57, 1.216_187_895_395_622_5),
                    c64::new(-0.332_605_165_516_396_86, 0.263_939_922_692_182_8),
                    c64::new(-0.253_817_378_648_121_1, 0.017_999_926_272_646_77),
                ],
            ),
        ];
        for (slip_displacement, expected) in reference {
            let series = series(slip_displacement, &TOUCHING);
            for (slot, expected) in expected.into_iter().enumerate() {
                let error = (series.force(&TOUCHING, &ORDERS, slot) - expected).norm();
                assert!(error < 2e-13, "x_c = {slip_displacement:e}, harmonic {}: {error:e}", ORDERS[slot]);
            }
        }
    }

    /// δF_p = ε_p [δW_j K_{p−j} + conj(δW_j) K_{p+j}] + Σ_r S_{r,p} δw(τ_r) against central differences.
    #[test]
    fn the_derivative_of_short_ways() {
        const STEP: f64 = 1e-11;
        for slip_displacement in [4e-12, 2e-13] {
            let mut here = series(slip_displacement, &TOUCHING);
            for (j, direction) in ORDERS.into_iter().flat_map(|j| [(j, c64::ONE), (j, c64::I)]) {
                let at = |step: f64| {
                    let mut moved = TOUCHING;
                    moved[j] += direction * step;
                    let series = series(slip_displacement, &moved);
                    [0, 1, 2].map(|slot| series.force(&moved, &ORDERS, slot))
                };
                let (up, down) = (at(STEP), at(-STEP));
                let mut slopes = ORDERS.map(|p| {
                    let coefficient = |q: usize| here.stiffness()[q];
                    let difference = if p >= j { coefficient(p - j) } else { coefficient(j - p).conj() };
                    direction * difference + direction.conj() * coefficient(p + j)
                });
                here.memories(&ORDERS, |recall, order, influence| {
                    let Recall::Displacement { tau } = recall else { return };
                    let slot = ORDERS.iter().position(|p| *p == order).unwrap();
                    slopes[slot] += influence * (direction * c64::cis(j as f64 * tau)).re;
                });
                for (slot, slope) in slopes.into_iter().enumerate() {
                    let expected = (up[slot] - down[slot]) / (2.0 * STEP);
                    let error = (slope - expected).norm() / expected.norm();
                    assert!(error < 1e-5, "x_c = {slip_displacement:e}, W_{j}: {slope} for {expected}");
                }
            }
        }
    }
}
