//! Harmonics of a piecewise linear force in closed form, from the phases of its events.
//!
//! With `f(τ) = κ(τ) w(τ) + c(τ)`, κ and c constant between events, everything follows from integrals of e^{−iqτ}:
//!
//! ```text
//! I_q = (1/2π) ∫ e^{−iqτ} dτ over a piece,   K_q = Σ κ I_q,   C_q = Σ c I_q
//! F_p = ε_p [Σ_j W_j K_{p−j} + conj(W_j) K_{p+j} + 2 C_p],   ε_0 = ½, ε_p = 1
//! ```

use std::f64::consts::{PI, TAU};

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
    /// The pieces are those of half a period, and the other half mirrors them.
    half: bool,
    /// 1/(π q).
    per_order: Vec<f64>,
}

impl PieceSeries {
    /// Integrates the pieces for harmonics of the motion up to `highest`. Of an `odd` motion they are those of half a
    /// period: the other half has the same κ and −c, which doubles K_q of even q and C_q of odd q and leaves no others.
    pub(crate) fn integrate(&mut self, spectrum: &[c64], highest: usize, odd: bool) {
        let length = 2 * highest + 1;
        self.half = odd;
        self.integrals.resize(self.pieces.len() * length, c64::ZERO);
        for coefficients in [&mut self.stiffness, &mut self.lasting, &mut self.constant] {
            coefficients.clear();
            coefficients.resize(length, c64::ZERO);
        }
        self.close.clear();
        self.close.resize(highest + 1, c64::ZERO);
        self.per_order.extend((self.per_order.len()..length).map(|q| 1.0 / (PI * q as f64)));
        let halves = if odd { 2.0 } else { 1.0 };
        let (even, uneven) = if odd { (Part::Even, Part::Odd) } else { (Part::All, Part::All) };
        let any_close = self.pieces.iter().any(|piece| piece.close);
        for (piece, row) in self.pieces.iter().zip(self.integrals.chunks_exact_mut(length)) {
            if piece.stiffness == 0.0 {
                let row = &mut row[..=highest];
                integrals(piece, &self.per_order, row);
                add(&mut self.constant, row, halves * piece.offset, uneven);
                continue;
            }
            integrals(piece, &self.per_order, row);
            add(&mut self.stiffness, row, halves * piece.stiffness, even);
            if piece.close {
                add_close(&mut self.close, piece, spectrum, halves);
            } else {
                if any_close {
                    add(&mut self.lasting, row, halves * piece.stiffness, even);
                }
                add(&mut self.constant, &row[..=highest], halves * piece.offset, uneven);
            }
        }
        if !any_close {
            self.lasting.copy_from_slice(&self.stiffness);
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
        // The half that is left out has the same influence: both δw and the strength change sign.
        let halves = if self.half { 2.0 } else { 1.0 };
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
                influences.push(if order == 0 { sum } else { sum * (2.0 * halves) });
            }
        }
        &self.recalls
    }
}

/// I_q for q = 0 … as many as there is room for: ∫ e^{−iqτ} dτ = e^{−iq mid} sin(q half) · 2/q. With the half width as a
/// factor a short piece keeps its digits: at amplitudes far above the slip displacement a piece that sticks is short and
/// its stiffness large.
fn integrals(piece: &ForcePiece, per_order: &[f64], row: &mut [c64]) {
    let half = 0.5 * (piece.to - piece.from);
    let (turn, widen) = (c64::cis(-(piece.from + half)), c64::cis(half));
    // Two orders side by side: each power waits for the one before it.
    let (turns, widens) = (turn * turn, widen * widen);
    let (mut middle, mut width) = ([c64::ONE, turn], [c64::ONE, widen]);
    for (row, per_order) in row.chunks_mut(2).zip(per_order.chunks(2)) {
        for (side, (integral, per_order)) in row.iter_mut().zip(per_order).enumerate() {
            *integral = middle[side] * (width[side].im * per_order);
            middle[side] *= turns;
            width[side] *= widens;
        }
    }
    if let Some(mean) = row.first_mut() {
        *mean = c64::from(2.0 * half / TAU);
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

/// Adds `factor`/2π ∫ f e^{−ipτ} dτ over a piece that starts at a turning point.
fn add_close(sum: &mut [c64], piece: &ForcePiece, spectrum: &[c64], factor: f64) {
    let width = piece.to - piece.from;
    let panels = (width * (sum.len() - 1) as f64 / RESOLVED).ceil().max(1.0);
    let panel = width / panels;
    for index in 0..panels as usize {
        for (node, weight) in GAUSS {
            let delta = (index as f64 + node) * panel;
            let force = piece.start_force - piece.stiffness * drop_from(spectrum, piece.from, delta);
            let turn = c64::cis(-(piece.from + delta));
            let mut wave = c64::from(force * weight * panel * factor / TAU);
            for entry in sum.iter_mut() {
                *entry += wave;
                wave *= turn;
            }
        }
    }
}

/// Entries of a series.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    All,
    Even,
    Odd,
}

fn add(sum: &mut [c64], row: &[c64], factor: f64, part: Part) {
    if part == Part::All {
        for (sum, entry) in sum.iter_mut().zip(row) {
            *sum += entry * factor;
        }
        return;
    }
    let skipped = usize::from(part == Part::Odd);
    for (sum, row) in sum.chunks_mut(2).zip(row.chunks(2)) {
        if let (Some(sum), Some(entry)) = (sum.get_mut(skipped), row.get(skipped)) {
            *sum += entry * factor;
        }
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
        series.integrate(spectrum, spectrum.len() - 1, true);
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
                    c64::new(-0.376_257_600_777_453_2, 1.216_346_657_216_218),
                    c64::new(-0.332_474_292_125_627_36, 0.263_838_429_060_792_9),
                    c64::new(-0.253_982_436_319_433_2, 0.018_013_524_196_886_394),
                ],
            ),
            (
                2e-13,
                [
                    c64::new(-0.376_210_446_189_538_6, 1.216_187_895_395_622_5),
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
                let mut influences = Vec::new();
                let recalls = here.memories(&ORDERS, &mut influences);
                for (recall, influences) in recalls.iter().zip(influences.chunks(ORDERS.len())) {
                    let Recall::Displacement { tau } = recall else { continue };
                    for (slope, influence) in slopes.iter_mut().zip(influences) {
                        *slope += influence * (direction * c64::cis(j as f64 * tau)).re;
                    }
                }
                for (slot, slope) in slopes.into_iter().enumerate() {
                    let expected = (up[slot] - down[slot]) / (2.0 * STEP);
                    let error = (slope - expected).norm() / expected.norm();
                    assert!(error < 3e-5, "x_c = {slip_displacement:e}, W_{j}: {slope} for {expected}");
                }
            }
        }
    }
}
