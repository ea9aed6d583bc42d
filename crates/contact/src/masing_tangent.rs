//! The derivative of a force with Masing's memory: a local stiffness on every branch, and the influence of the
//! turning points that the branch remembers.
//!
//! On a branch from turning point s, with σ = ∓1, distance p = σ (w − w_s)/a and ratio λ,
//!
//! ```text
//! f  = f_s + σ λ S(p; a)
//! δf = δf_s + σ S δλ + κ (δw − δw_s) + g δa,   κ = λ S_p / a,   g = σ λ (S_a − S_p p / a),   δa = (δw_M − δw_m)/2
//! ```
//!
//! Turning points are stationary, so their instants need no derivative; f_s and λ are functions of earlier turning
//! points, which gives one row of derivatives a branch.

use crate::law::Motion;
use crate::masing::{Branch, Masing, Shape};
use crate::path::{Path, Piece, SampledPath, mirror};
use crate::place::{Direction, Place};
use crate::tangent::{Recall, Tangent};
use crate::turning_points::TurningPoints;

/// Closer than this to a tip in phase (rad), κ (δw − δw_tip) is replaced by its limit in the velocity at the tip: the
/// errors of both forms, ε/δ and δ, are about equal here.
const AT_TIP: f64 = 1e-8;

/// Buffers for the derivatives; reused between evaluations.
#[derive(Debug, Clone)]
pub(crate) struct MasingTangent {
    /// ∂f_s/∂w_i, one row a branch.
    force_rows: Vec<f64>,
    /// ∂λ/∂w_i, one row a branch; all zero for odd loops.
    ratio_rows: Vec<f64>,
    /// Influence of the amplitude, g(τ_j).
    amplitude: Vec<f64>,
    /// σ S(τ_j), influence of the ratio.
    ratio: Vec<f64>,
    /// Samples on a tip: (sample, turning point, influence of the velocity there).
    at_tips: Vec<(usize, usize, f64)>,
}

/// Derivatives of the change S(p; a) at one place of a branch, for λ = 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Local {
    /// S_p / a, the local stiffness.
    pub(crate) kappa: f64,
    /// S_a − S_p p / a: influence of the amplitude where the displacement is held.
    pub(crate) amplitude: f64,
    /// S itself, influence of the ratio; looked at only where the shape is not odd.
    pub(crate) change: f64,
}

/// How a shape's force changes with place and amplitude.
pub(crate) trait Growth<S: Shape<f64>> {
    /// Derivatives of the force at the tip where the main branch of this direction begins, with respect to the
    /// displacements of the upper and the lower tip.
    fn tip(&self, shape: &S, direction: Direction) -> [f64; 2];

    /// The derivatives at one place, for amplitude `a`.
    fn local(&self, shape: &S, direction: Direction, place: Place<f64>, a: f64) -> Local;

    /// Raw values at all spots, of which [`Growth::finish`] makes derivatives; `change` is empty where the shape is odd.
    fn evaluate(
        &self,
        shape: &S,
        spots: &[S::Spot],
        kappa: &mut [f64],
        amplitude: &mut [f64],
        change: &mut [f64],
    );

    /// The derivatives at a spot from its raw values; on a tip κ stays out.
    fn finish(
        &self,
        shape: &S,
        direction: Direction,
        spot: S::Spot,
        per_amplitude: f64,
        at_tip: bool,
        raw: Local,
    ) -> Local;

    /// Whether a spot is so close to a tip that κ may be infinite there.
    fn near_tip(spot: S::Spot) -> bool;

    /// dL/dθ at the tip where a branch of this direction begins, in N: what replaces an infinite κ.
    fn slope_at_tip(&self, shape: &S, direction: Direction) -> f64;
}

impl MasingTangent {
    /// Empty buffers.
    pub(crate) fn new() -> Self {
        Self {
            force_rows: Vec::new(),
            ratio_rows: Vec::new(),
            amplitude: Vec::new(),
            ratio: Vec::new(),
            at_tips: Vec::new(),
        }
    }

    /// Derivatives of f_s and λ of every branch with respect to the displacements at the turning points.
    fn rows<S: Shape<f64>, G: Growth<S>>(&mut self, period: &Period<S, G>) {
        let Period { shape, growth, masing, path, a, count, lowest } = *period;
        self.force_rows.clear();
        self.ratio_rows.clear();
        for (index, branch) in masing.branches.iter().enumerate() {
            let own = index * count;
            self.force_rows.resize(own + count, 0.0);
            self.ratio_rows.resize(own + count, 0.0);
            if branch.main {
                let [by_top, by_bottom] = growth.tip(shape, branch.direction);
                add(&mut self.force_rows, own, by_top);
                add(&mut self.force_rows, own + lowest, by_bottom);
                continue;
            }
            let Some(parent) = masing.branches.get(branch.parent) else { continue };
            let travelled = (path.tip(branch.start) - path.tip(parent.start)) * parent.direction.sign();
            let turn = Place::at(travelled / a);
            let sigma = parent.direction.sign();
            let local = growth.local(shape, parent.direction, turn, a);
            let theirs = branch.parent * count;
            for i in 0..count {
                let inherited = value(&self.force_rows, theirs + i);
                let by_ratio = sigma * local.change * value(&self.ratio_rows, theirs + i);
                add(&mut self.force_rows, own + i, inherited + by_ratio);
            }
            let (kappa, amplitude) = (parent.ratio * local.kappa, sigma * parent.ratio * local.amplitude);
            add(&mut self.force_rows, own + branch.start, kappa);
            add(&mut self.force_rows, own + parent.start, -kappa);
            add(&mut self.force_rows, own, 0.5 * amplitude);
            add(&mut self.force_rows, own + lowest, -0.5 * amplitude);
            if !shape.is_odd() {
                self.ratio_row(period, branch, parent, turn, own);
            }
        }
    }

    /// λ = λ_parent S_parent(p) / S(p) at the turning point where the branch starts.
    fn ratio_row<S: Shape<f64>, G: Growth<S>>(
        &mut self,
        period: &Period<S, G>,
        branch: &Branch<f64>,
        parent: &Branch<f64>,
        turn: Place<f64>,
        own: usize,
    ) {
        let Period { shape, growth, a, count, lowest, .. } = *period;
        let before = growth.local(shape, parent.direction, turn, a);
        let after = growth.local(shape, branch.direction, turn, a);
        if before.change <= 0.0 || after.change <= 0.0 {
            return;
        }
        for i in 0..count {
            let inherited = value(&self.ratio_rows, branch.parent * count + i);
            add(&mut self.ratio_rows, own + i, inherited * before.change / after.change);
        }
        let by_tip = branch.ratio
            * parent.direction.sign()
            * (before.kappa / before.change - after.kappa / after.change);
        let by_amplitude = branch.ratio * (before.amplitude / before.change - after.amplitude / after.change);
        add(&mut self.ratio_rows, own + branch.start, by_tip);
        add(&mut self.ratio_rows, own + parent.start, -by_tip);
        add(&mut self.ratio_rows, own, 0.5 * by_amplitude);
        add(&mut self.ratio_rows, own + lowest, -0.5 * by_amplitude);
    }

    /// Fills `tangent` for the period that `masing` was last traced with.
    pub(crate) fn evaluate<S: Shape<f64>, G: Growth<S>>(
        &mut self,
        shape: &S,
        growth: &G,
        masing: &Masing<f64, S::Spot>,
        motion: &Motion,
        tips: &TurningPoints,
        tangent: &mut Tangent,
    ) {
        let path = &SampledPath::new(motion, tips);
        let a = tips.amplitude();
        let period = &Period { shape, growth, masing, path, a, count: path.count(), lowest: path.lowest() };
        tangent.clear();
        self.rows(period);
        self.at_tips.clear();
        let samples = tangent.local.len();
        self.amplitude.resize(samples, 0.0);
        self.ratio.resize(if shape.is_odd() { 0 } else { samples }, 0.0);
        for range in masing.walked(samples) {
            let Some(spots) = masing.spots.get(range.clone()) else { continue };
            let change = if shape.is_odd() { 0..0 } else { range.clone() };
            growth.evaluate(
                shape,
                spots,
                tangent.local.get_mut(range.clone()).unwrap_or_default(),
                self.amplitude.get_mut(range).unwrap_or_default(),
                self.ratio.get_mut(change).unwrap_or_default(),
            );
        }
        for piece in &masing.pieces {
            if let Some(branch) = masing.branches.get(piece.owner) {
                self.piece(period, branch, piece, &mut tangent.local);
            }
        }
        self.remember(period, motion.odd, tangent);
        if let Some(half) = masing.half {
            // The force changes sign from half to half, as the motion does: its stiffness does not.
            mirror(&mut tangent.local, half, |kappa| kappa);
        }
    }

    /// κ, g and σ S of the samples of one piece.
    fn piece<S: Shape<f64>, G: Growth<S>>(
        &mut self,
        period: &Period<S, G>,
        branch: &Branch<f64>,
        piece: &Piece,
        kappa: &mut [f64],
    ) {
        let Period { shape, growth, masing, a, .. } = *period;
        let sigma = branch.direction.sign();
        let per_amplitude = 1.0 / a;
        let odd = shape.is_odd();
        for j in piece.ranges(kappa.len()).into_iter().flatten() {
            let Some(&spot) = masing.spots.get(j) else { break };
            // The phase is looked at only where the displacement is close to a tip's.
            let at_tip = G::near_tip(spot) && self.on_tip(period, branch, j);
            let raw = Local {
                kappa: value(kappa, j),
                amplitude: value(&self.amplitude, j),
                change: if odd { 0.0 } else { value(&self.ratio, j) },
            };
            let local = growth.finish(shape, branch.direction, spot, per_amplitude, at_tip, raw);
            set(kappa, j, branch.ratio * local.kappa);
            set(&mut self.amplitude, j, sigma * (branch.ratio * local.amplitude));
            if !odd {
                set(&mut self.ratio, j, sigma * local.change);
            }
        }
    }

    /// Whether sample `j` sits on a tip; if so, notes the influence of the velocity there.
    #[cold]
    fn on_tip<S: Shape<f64>, G: Growth<S>>(
        &mut self,
        period: &Period<S, G>,
        branch: &Branch<f64>,
        j: usize,
    ) -> bool {
        let Some(tip) = tip_at(period.path, branch, j) else { return false };
        self.at_tips.extend(velocity_influence(period, branch, tip).map(|s| (j, tip, s)));
        true
    }

    /// Collects the influence of every turning point. In odd motion δw(τ + π) = −δw(τ), so opposite turning points
    /// share one memory.
    fn remember<S: Shape<f64>, G>(&self, period: &Period<S, G>, odd: bool, tangent: &mut Tangent) {
        let distinct = if odd { period.count / 2 } else { period.count };
        for i in 0..distinct {
            let (kappa, influence) = tangent.remember(Recall::Displacement { tau: period.path.point(i).tau });
            self.add_influence(period, i, 1.0, kappa, influence);
            if odd {
                self.add_influence(period, i + distinct, -1.0, kappa, influence);
            }
            if let Some(half) = period.masing.half {
                mirror(influence, half, |s| -s);
            }
        }
        for &(j, tip, strength) in &self.at_tips {
            let (_, influence) = tangent.remember(Recall::Velocity { tau: period.path.point(tip).tau });
            set(influence, j, strength);
            if period.masing.half.is_some() {
                let half = influence.len() / 2;
                set(influence, if j < half { j + half } else { j - half }, -strength);
            }
        }
    }

    /// Adds `sign` times the influence of turning point `tip` at every sample.
    fn add_influence<S: Shape<f64>, G>(
        &self,
        period: &Period<S, G>,
        tip: usize,
        sign: f64,
        kappa: &[f64],
        influence: &mut [f64],
    ) {
        let samples = influence.len();
        let by_amplitude = match tip {
            0 => 0.5,
            r if r == period.lowest => -0.5,
            _ => 0.0,
        };
        for piece in &period.masing.pieces {
            let Some(branch) = period.masing.branches.get(piece.owner) else { continue };
            let inherited = value(&self.force_rows, piece.owner * period.count + tip);
            let by_ratio = value(&self.ratio_rows, piece.owner * period.count + tip);
            let by_kappa = if branch.start == tip { -1.0 } else { 0.0 };
            if inherited == 0.0 && by_ratio == 0.0 && by_kappa == 0.0 && by_amplitude == 0.0 {
                continue;
            }
            for j in piece.ranges(samples).into_iter().flatten() {
                let s = inherited
                    + by_kappa * value(kappa, j)
                    + by_amplitude * value(&self.amplitude, j)
                    + by_ratio * value(&self.ratio, j);
                add(influence, j, sign * s);
            }
        }
    }
}

/// One traced period, for reading.
struct Period<'a, S: Shape<f64>, G> {
    shape: &'a S,
    growth: &'a G,
    masing: &'a Masing<f64, S::Spot>,
    path: &'a SampledPath<'a>,
    a: f64,
    count: usize,
    lowest: usize,
}

/// The turning point that sample `j` sits on, if it does; for samples close to one.
#[inline]
fn tip_at(path: &SampledPath, branch: &Branch<f64>, j: usize) -> Option<usize> {
    if path.phase_after(j, branch.start).abs() < AT_TIP {
        return Some(branch.start);
    }
    (path.phase_after(j, branch.target).abs() < AT_TIP).then_some(branch.target)
}

/// Influence of the velocity at turning point `tip` on the force there: `δf = ∓ λ L_θ δẇ / √(a |ẅ|)`, minus at an upper
/// one. `None` where the branch has no rounded end.
fn velocity_influence<S: Shape<f64>, G: Growth<S>>(
    period: &Period<S, G>,
    branch: &Branch<f64>,
    tip: usize,
) -> Option<f64> {
    if tip != branch.start && !branch.main {
        return None;
    }
    let from_here = if tip == branch.start { branch.direction } else { branch.direction.reversed() };
    let acceleration = period.path.point(tip).acceleration.abs();
    if acceleration == 0.0 {
        return None;
    }
    let slope = period.growth.slope_at_tip(period.shape, from_here);
    Some(from_here.sign() * branch.ratio * slope / (period.a * acceleration).sqrt())
}

#[inline(always)]
fn value<T: Copy + Default>(row: &[T], i: usize) -> T {
    row.get(i).copied().unwrap_or_default()
}

fn add(row: &mut [f64], i: usize, x: f64) {
    if let Some(slot) = row.get_mut(i) {
        *slot += x;
    }
}

fn set(row: &mut [f64], i: usize, x: f64) {
    if let Some(slot) = row.get_mut(i) {
        *slot = x;
    }
}
