//! The derivative of a loop force with Masing's memory: a local stiffness on every branch, and the influence of the
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
use crate::loop_curve::{Direction, LoopCurve, Place, stiffness};
use crate::masing::{Branch, Masing};
use crate::path::{Path, Piece, SampledPath};
use crate::tangent::{Recall, Tangent};
use crate::turning_points::TurningPoints;

/// Closer than this to a tip in phase (rad), κ (δw − δw_tip) is replaced by its limit in the velocity at the tip: the
/// errors of both forms, ε/δ and δ, are about equal here.
const AT_TIP: f64 = 1e-8;

/// |sin θ| below which a sample may be that close to a tip.
const NEAR_TIP: f64 = 1e-3;

/// Buffers for the derivatives; reused between evaluations.
#[derive(Debug, Clone)]
pub(crate) struct MasingTangent {
    /// ∂c_k/∂a: how the loop changes with its amplitude.
    pub(crate) growth: LoopCurve<f64>,
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

/// κ, g and σ S at one place of a branch.
struct Local {
    kappa: f64,
    amplitude: f64,
    ratio: f64,
}

impl MasingTangent {
    /// Empty buffers.
    pub(crate) fn new() -> Self {
        Self {
            growth: LoopCurve::new(),
            force_rows: Vec::new(),
            ratio_rows: Vec::new(),
            amplitude: Vec::new(),
            ratio: Vec::new(),
            at_tips: Vec::new(),
        }
    }

    fn local(&self, curve: &LoopCurve<f64>, branch: &Branch<f64>, here: Place<f64>, a: f64) -> Local {
        let sigma = branch.direction.sign();
        let by_place = branch.ratio * curve.stiffness(branch.direction, here) / a;
        Local {
            kappa: by_place,
            amplitude: sigma
                * (branch.ratio * self.growth.change(branch.direction, here) - by_place * here.gone),
            ratio: sigma * curve.change(branch.direction, here),
        }
    }

    /// Derivatives of f_s and λ of every branch with respect to the displacements at the turning points.
    fn rows(&mut self, period: &Period) {
        let Period { masing, path, a, count, lowest } = *period;
        self.force_rows.clear();
        self.ratio_rows.clear();
        for (index, branch) in masing.branches.iter().enumerate() {
            let own = index * count;
            self.force_rows.resize(own + count, 0.0);
            self.ratio_rows.resize(own + count, 0.0);
            if branch.main {
                let growth = match branch.direction {
                    Direction::Unloading => self.growth.upper,
                    Direction::Loading => self.growth.lower,
                };
                add(&mut self.force_rows, own, 0.5 * growth);
                add(&mut self.force_rows, own + lowest, -0.5 * growth);
                continue;
            }
            let Some(parent) = masing.branches.get(branch.parent) else { continue };
            let travelled = (path.tip(branch.start) - path.tip(parent.start)) * parent.direction.sign();
            let turn = Place::at(travelled / a);
            let local = self.local(&masing.curve, parent, turn, a);
            let theirs = branch.parent * count;
            for i in 0..count {
                let inherited = value(&self.force_rows, theirs + i);
                add(
                    &mut self.force_rows,
                    own + i,
                    inherited + local.ratio * value(&self.ratio_rows, theirs + i),
                );
            }
            add(&mut self.force_rows, own + branch.start, local.kappa);
            add(&mut self.force_rows, own + parent.start, -local.kappa);
            add(&mut self.force_rows, own, 0.5 * local.amplitude);
            add(&mut self.force_rows, own + lowest, -0.5 * local.amplitude);
            if !masing.curve.is_odd() {
                self.ratio_row(period, branch, parent, turn, own);
            }
        }
    }

    /// λ = λ_parent S_parent(p) / S(p) at the turning point where the branch starts.
    fn ratio_row(
        &mut self,
        period: &Period,
        branch: &Branch<f64>,
        parent: &Branch<f64>,
        turn: Place<f64>,
        own: usize,
    ) {
        let Period { masing, a, count, lowest, .. } = *period;
        let curve = &masing.curve;
        let (before, after) = (curve.change(parent.direction, turn), curve.change(branch.direction, turn));
        if before <= 0.0 || after <= 0.0 {
            return;
        }
        for i in 0..count {
            let inherited = value(&self.ratio_rows, branch.parent * count + i);
            add(&mut self.ratio_rows, own + i, inherited * before / after);
        }
        let by_place = curve.stiffness(parent.direction, turn) / before
            - curve.stiffness(branch.direction, turn) / after;
        let by_growth = self.growth.change(parent.direction, turn) / before
            - self.growth.change(branch.direction, turn) / after;
        let by_tip = branch.ratio * by_place * parent.direction.sign() / a;
        let by_amplitude = branch.ratio * (by_growth - by_place * turn.gone / a);
        add(&mut self.ratio_rows, own + branch.start, by_tip);
        add(&mut self.ratio_rows, own + parent.start, -by_tip);
        add(&mut self.ratio_rows, own, 0.5 * by_amplitude);
        add(&mut self.ratio_rows, own + lowest, -0.5 * by_amplitude);
    }

    /// Fills `tangent` for the period that `masing` was last traced with.
    pub(crate) fn evaluate(
        &mut self,
        masing: &Masing<f64>,
        motion: &Motion,
        tips: &TurningPoints,
        tangent: &mut Tangent,
    ) {
        let path = &SampledPath::new(motion, tips);
        let a = tips.amplitude();
        let period = &Period { masing, path, a, count: path.count(), lowest: path.lowest() };
        let samples = motion.displacement.len();
        tangent.clear();
        self.rows(period);
        self.amplitude.resize(samples, 0.0);
        self.ratio.clear();
        self.ratio.resize(samples, 0.0);
        self.at_tips.clear();
        // κ first holds dL/dθ, g first dL/da, and σ S first L of every sample.
        masing.curve.slope.evaluate(&masing.units, &mut tangent.local);
        self.growth.force.evaluate(&masing.units, &mut self.amplitude);
        if !masing.curve.is_odd() {
            masing.curve.force.evaluate(&masing.units, &mut self.ratio);
        }
        for piece in &masing.pieces {
            if let Some(branch) = masing.branches.get(piece.owner) {
                self.piece(period, branch, piece, &mut tangent.local);
            }
        }
        self.remember(period, motion.odd, tangent);
    }

    /// κ, g and σ S of the samples of one piece.
    fn piece(&mut self, period: &Period, branch: &Branch<f64>, piece: &Piece, kappa: &mut [f64]) {
        let Period { masing, path, a, .. } = *period;
        let sigma = branch.direction.sign();
        let per_amplitude = 1.0 / a;
        for j in piece.ranges(kappa.len()).into_iter().flatten() {
            let z = value(&masing.units, j);
            let gone = match branch.direction {
                Direction::Unloading => 1.0 - z.re,
                Direction::Loading => 1.0 + z.re,
            };
            // The phase is looked at only where the displacement is close to a tip's.
            let tip = if z.im.abs() < NEAR_TIP { tip_at(path, branch, j) } else { None };
            let by_place = match tip {
                None if z.im == 0.0 => 0.0,
                None => branch.ratio * stiffness(value(kappa, j), z) * per_amplitude,
                Some(tip) => {
                    self.at_tips.extend(velocity_influence(period, branch, tip).map(|s| (j, tip, s)));
                    0.0
                }
            };
            set(kappa, j, by_place);
            let growth = self.growth.change_to(branch.direction, value(&self.amplitude, j));
            set(&mut self.amplitude, j, sigma * (branch.ratio * growth - by_place * gone));
            if !masing.curve.is_odd() {
                let change = masing.curve.change_to(branch.direction, value(&self.ratio, j));
                set(&mut self.ratio, j, sigma * change);
            }
        }
    }

    /// Collects the influence of every turning point. In odd motion δw(τ + π) = −δw(τ), so opposite turning points
    /// share one memory.
    fn remember(&self, period: &Period, odd: bool, tangent: &mut Tangent) {
        let distinct = if odd { period.count / 2 } else { period.count };
        for i in 0..distinct {
            let (kappa, influence) = tangent.remember(Recall::Displacement { tau: period.path.point(i).tau });
            self.add_influence(period, i, 1.0, kappa, influence);
            if odd {
                self.add_influence(period, i + distinct, -1.0, kappa, influence);
            }
        }
        for &(j, tip, strength) in &self.at_tips {
            let (_, influence) = tangent.remember(Recall::Velocity { tau: period.path.point(tip).tau });
            set(influence, j, strength);
        }
    }

    /// Adds `sign` times the influence of turning point `tip` at every sample.
    fn add_influence(&self, period: &Period, tip: usize, sign: f64, kappa: &[f64], influence: &mut [f64]) {
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
struct Period<'a> {
    masing: &'a Masing<f64>,
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
fn velocity_influence(period: &Period, branch: &Branch<f64>, tip: usize) -> Option<f64> {
    if tip != branch.start && !branch.main {
        return None;
    }
    let from_here = if tip == branch.start { branch.direction } else { branch.direction.reversed() };
    let acceleration = period.path.point(tip).acceleration.abs();
    if acceleration == 0.0 {
        return None;
    }
    let slope = period.masing.curve.slope_at_tip(from_here);
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
