//! Turning points of a periodic displacement: every zero of its velocity, found from the spectrum so that the
//! result does not depend on how samples fall.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::error::LawError;
use crate::law::Motion;

/// A maximum or minimum of the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Phase in rad. Ascending from the first, which lies in [0, 2π); later ones may exceed 2π.
    pub tau: f64,
    /// Displacement in m.
    pub displacement: f64,
    /// d²w/dτ² in m: negative at a maximum.
    pub acceleration: f64,
}

/// The turning points of one period in order of time, beginning at the global maximum; maxima (even positions)
/// and minima (odd positions) alternate. Of several equal extremes the first instant of the period counts.
#[derive(Debug, Clone, Default)]
pub struct TurningPoints {
    points: Vec<TurningPoint>,
    lowest: usize,
}

/// w and its first three derivatives at one phase.
#[derive(Clone, Copy)]
pub(crate) struct Jet {
    pub(crate) displacement: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    jerk: f64,
}

fn jet(spectrum: &[Complex64], tau: f64) -> Jet {
    jet_of(spectrum, has_odd_only(spectrum), tau)
}

/// Whether all even harmonics are zero.
pub(crate) fn has_odd_only(spectrum: &[Complex64]) -> bool {
    spectrum.iter().step_by(2).all(|c| *c == Complex64::ZERO)
}

/// The jet of a motion of which it is known whether it has odd harmonics only.
pub(crate) fn jet_of(spectrum: &[Complex64], odd: bool, tau: f64) -> Jet {
    let turn = Complex64::cis(tau);
    let square = turn * turn;
    // Two harmonics side by side, since each power waits for the one before it: 0 and 1, or 1 and 3, and so on.
    if odd {
        let (fours, rest) = spectrum.as_chunks::<4>();
        let start = Waves { waves: [turn, turn * square], orders: [1.0, 3.0] };
        let pairs = fours.iter().map(|four| [four[1], four[3]]);
        let last = rest.get(1).copied().unwrap_or(Complex64::ZERO);
        start.sum(pairs, [last, rest.get(3).copied().unwrap_or(Complex64::ZERO)], square * square, 4.0)
    } else {
        let (pairs, rest) = spectrum.as_chunks::<2>();
        let start = Waves { waves: [Complex64::ONE, turn], orders: [0.0, 1.0] };
        let last = rest.first().copied().unwrap_or(Complex64::ZERO);
        start.sum(pairs.iter().copied(), [last, Complex64::ZERO], square, 2.0)
    }
}

/// e^{ikτ} of two orders k.
struct Waves {
    waves: [Complex64; 2],
    orders: [f64; 2],
}

impl Waves {
    /// The jet of all `pairs` of amplitudes and a last one, each `stride` orders above the one before.
    #[inline(always)]
    fn sum(
        mut self,
        pairs: impl Iterator<Item = [Complex64; 2]>,
        last: [Complex64; 2],
        step: Complex64,
        stride: f64,
    ) -> Jet {
        let (mut w, mut v, mut a, mut j) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
        for pair in pairs.chain(std::iter::once(last)) {
            for side in 0..2 {
                let (term, k) = (pair[side] * self.waves[side], self.orders[side]);
                let (re, im) = (k * term.re, k * term.im);
                w[side] += term.re;
                v[side] -= im;
                a[side] -= k * re;
                j[side] += k * k * im;
                self.waves[side] *= step;
                self.orders[side] += stride;
            }
        }
        let sum = |x: [f64; 2]| x[0] + x[1];
        Jet { displacement: sum(w), velocity: sum(v), acceleration: sum(a), jerk: sum(j) }
    }
}

/// Halley's step to a zero of a function with these value and derivatives: Newton's, corrected by the curvature.
#[inline]
pub(crate) fn halley(value: f64, slope: f64, curvature: f64) -> f64 {
    let newton = -value / slope;
    let bend = 0.5 * newton * curvature / slope;
    if bend.abs() < 0.5 { newton / (1.0 + bend) } else { newton }
}

/// Whether what steps that shrink as the third power leave after this one, step⁴/before³, is lost in rounding at phases
/// of order one.
#[inline]
pub(crate) fn settled(step: f64, before: f64) -> bool {
    step <= 2.0 * f64::EPSILON || (step < 1e-6 && step.powi(4) <= 1e-3 * f64::EPSILON * before.powi(3))
}

/// Zero of the velocity in [left, right], where it has the signs `rising` → not: Halley's method kept inside the bracket.
fn zero_of_velocity(
    spectrum: &[Complex64],
    mut left: f64,
    mut right: f64,
    mut at: f64,
    rising: bool,
) -> TurningPoint {
    let odd = has_odd_only(spectrum);
    let mut here = jet_of(spectrum, odd, at);
    let mut before = 0.0;
    for _ in 0..60 {
        if here.velocity == 0.0 {
            break;
        }
        if (here.velocity > 0.0) == rising {
            left = at;
        } else {
            right = at;
        }
        let step = halley(here.velocity, here.acceleration, here.jerk);
        let next = at + step;
        if next > left && next < right {
            if settled(step.abs(), before) {
                // So close that the jet itself says what is there.
                let Jet { displacement, velocity, acceleration, jerk } = here;
                let rise = step * (velocity + 0.5 * step * (acceleration + step * jerk / 3.0));
                return TurningPoint {
                    tau: next,
                    displacement: displacement + rise,
                    acceleration: acceleration + step * jerk,
                };
            }
            before = step.abs();
            at = next;
        } else {
            let middle = 0.5 * (left + right);
            if (middle - at).abs() <= 2.0 * f64::EPSILON * middle.abs().max(1.0) {
                break;
            }
            before = 0.0;
            at = middle;
        }
        here = jet_of(spectrum, odd, at);
    }
    TurningPoint { tau: at, displacement: here.displacement, acceleration: here.acceleration }
}

/// Where |velocity| is smallest in [left, right] when it does not change sign there, and its value.
fn slowest(spectrum: &[Complex64], left: f64, right: f64) -> (f64, f64) {
    // Golden section on |v|: rare, short, and needs no third derivative.
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (left, right);
    let speed = |tau: f64| jet(spectrum, tau).velocity;
    let sign = speed(left).signum();
    let mut x = b - RATIO * (b - a);
    let mut y = a + RATIO * (b - a);
    let (mut vx, mut vy) = (sign * speed(x), sign * speed(y));
    for _ in 0..40 {
        if vx < 0.0 {
            return (x, sign * vx);
        }
        if vy < 0.0 {
            return (y, sign * vy);
        }
        if vx < vy {
            b = y;
            (y, vy) = (x, vx);
            x = b - RATIO * (b - a);
            vx = sign * speed(x);
        } else {
            a = x;
            (x, vx) = (y, vy);
            y = a + RATIO * (b - a);
            vy = sign * speed(y);
        }
    }
    if vx < vy { (x, sign * vx) } else { (y, sign * vy) }
}

impl TurningPoints {
    /// Finds all turning points of `motion`.
    ///
    /// Every sign change of the sampled velocity gives one; where the velocity comes close to zero between
    /// samples without changing sign there, a pair may hide, and is looked for.
    ///
    /// # Errors
    /// [`LawError::NoMotion`] when the displacement is constant, [`LawError::NotFinite`] when it is no number.
    pub fn find(&mut self, motion: &Motion) -> Result<(), LawError> {
        self.points.clear();
        self.lowest = 0;
        let samples = motion.velocity.len();
        if motion.spectrum.iter().any(|c| !c.re.is_finite() || !c.im.is_finite()) {
            return Err(LawError::NotFinite);
        }
        if samples < 4 || motion.spectrum.iter().skip(1).all(|c| *c == Complex64::ZERO) {
            return Err(LawError::NoMotion);
        }
        self.scan(motion);
        if motion.odd {
            self.mirror();
        }
        self.order(motion.odd)
    }

    /// Turning points between the samples of a period, of the first half of it when the motion is odd, and their
    /// successors.
    fn scan(&mut self, motion: &Motion) {
        let v = motion.velocity;
        let samples = v.len();
        let count = if motion.odd { samples / 2 } else { samples };
        let step = TAU / samples as f64;
        let at = |j: usize| v.get(if j < samples { j } else { j - samples }).copied().unwrap_or(0.0);
        // A zero sample counts as a positive one, so that every change of sign lies in exactly one interval.
        for j in 0..count {
            let around = j.checked_sub(1).and_then(|first| v.get(first..first + 4));
            let [behind, here, next, ahead] = match around {
                Some(&[behind, here, next, ahead]) => [behind, here, next, ahead],
                _ => [at(if j == 0 { samples - 1 } else { j - 1 }), at(j), at(j + 1), at(j + 2)],
            };
            let (left, right) = (j as f64 * step, (j + 1) as f64 * step);
            let rising = here >= 0.0;
            // Half a period on, an odd velocity has the other sign, also where both samples are zero to rounding.
            let goes_on_rising = if motion.odd && j + 1 == count { at(0) < 0.0 } else { next >= 0.0 };
            if rising != goes_on_rising {
                let part = here / (here - next);
                let guess = left + step * if part >= 0.0 { part.min(1.0) } else { 0.5 };
                self.points.push(zero_of_velocity(motion.spectrum, left, right, guess, rising));
                continue;
            }
            // Same sign at both ends: |v| has a minimum inside only if it falls on entering and rises on leaving.
            let sign = if rising { 1.0 } else { -1.0 };
            let (before, after) = (sign * behind, sign * ahead);
            let (low, high) = (sign * here, sign * next);
            // A convex |v| cannot fall further inside than it fell over the interval before, nor rise by more than
            // it rises over the one after.
            if before - low > low && after - high > high {
                let (tau, velocity) = slowest(motion.spectrum, left, right);
                if velocity * sign < 0.0 {
                    self.points.push(zero_of_velocity(
                        motion.spectrum,
                        left,
                        tau,
                        0.5 * (left + tau),
                        rising,
                    ));
                    self.points.push(zero_of_velocity(
                        motion.spectrum,
                        tau,
                        right,
                        0.5 * (tau + right),
                        !rising,
                    ));
                }
            }
        }
    }

    /// Completes the half period [0, π) by w(τ + π) = −w(τ).
    fn mirror(&mut self) {
        for i in 0..self.points.len() {
            if let Some(&p) = self.points.get(i) {
                self.points.push(TurningPoint {
                    tau: p.tau + PI,
                    displacement: -p.displacement,
                    acceleration: -p.acceleration,
                });
            }
        }
    }

    /// Puts the first global maximum first and notes the first global minimum after it.
    fn order(&mut self, odd: bool) -> Result<(), LawError> {
        let points = &mut self.points;
        let top = points.iter().map(|p| p.displacement).fold(f64::NEG_INFINITY, f64::max);
        let bottom = points.iter().map(|p| p.displacement).fold(f64::INFINITY, f64::min);
        if points.len() < 2 || top <= bottom {
            return Err(LawError::NoMotion);
        }
        let first = points.iter().position(|p| p.displacement == top).unwrap_or(0);
        points.rotate_left(first);
        let start = points.first().map_or(0.0, |p| p.tau);
        for p in points.iter_mut().filter(|p| p.tau < start) {
            p.tau += TAU;
        }
        self.lowest = if odd {
            // Half a period after the maximum, whichever of several equal minima comes first.
            points.len() / 2
        } else {
            points.iter().position(|p| p.displacement == bottom).unwrap_or(1)
        };
        Ok(())
    }

    /// The points in order of time, the global maximum first.
    pub fn points(&self) -> &[TurningPoint] {
        &self.points
    }

    /// Position of the global minimum in [`TurningPoints::points`].
    pub fn lowest(&self) -> usize {
        self.lowest
    }

    /// Half the range of the displacement in m; zero without motion.
    pub fn amplitude(&self) -> f64 {
        match (self.points.first(), self.points.get(self.lowest)) {
            (Some(top), Some(bottom)) => 0.5 * (top.displacement - bottom.displacement),
            _ => 0.0,
        }
    }
}

/// `w(τ_r) − w(τ_r + δ)` in m at a turning point τ_r, without cancellation for small δ: the first-order term
/// `w'(τ_r) δ = 0` is left out analytically.
pub fn drop_from(spectrum: &[Complex64], tau: f64, delta: f64) -> f64 {
    let step = Complex64::cis(tau);
    let mut wave = Complex64::ONE;
    let mut drop = 0.0;
    let mut angle = 0.0_f64;
    for amplitude in spectrum {
        let half = (0.5 * angle).sin();
        let term = amplitude * wave;
        // Re[W e^{ikτ} (2 sin²(kδ/2) − i (sin kδ − kδ))]
        drop += term.re * 2.0 * half * half - term.im * angle_minus_sine(angle);
        wave *= step;
        angle += delta;
    }
    drop
}

/// x − sin x without cancellation.
pub(crate) fn angle_minus_sine(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return x - x.sin();
    }
    let y = x * x;
    x * y / 6.0
        * (1.0 - y / 20.0 * (1.0 - y / 42.0 * (1.0 - y / 72.0 * (1.0 - y / 110.0 * (1.0 - y / 156.0)))))
}
