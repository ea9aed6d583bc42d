//! Slip in two tangential directions over a step: the Taylor series of a force that turns.
//!
//! The slider stays at the distance r = μN/k_t behind the body, `s = w − r e`, and moves along the force k_t r e alone, so that
//!
//! ```text
//! r θ' = w'·e⊥,   e' = θ' e⊥,   e⊥ = (−e_2, e_1);     the slider moves at λ = w'·e − r' > 0
//! ```
//!
//! With the step as the unit of time and coefficients by number this is a recursion of Cauchy products,
//!
//! ```text
//! r_0 θ'_m = Σ_i w'_i·e⊥_{m−i} − Σ_{i≥1} r_i θ'_{m−i},     (m+1) e_{m+1} = Σ_i θ'_i e⊥_{m−i}
//! ```
//!
//! Where the bodies have just met, r_0 = 0 and the equation is singular; of its solutions one is analytic, and that is the motion:
//! it begins along w', and order m fixes θ'_{m−1} by the factor r_1 + (w'_0·e_0)/m. Where they are about to part there
//! is none; e no longer matters then, since the force vanishes.

use crate::number::Number;
use crate::polynomial::{Polynomial, TERMS};

/// Phase σ before the bodies part within which the force does not turn any more. What it turns by goes like σ where the body is
/// fast against the edge, |w'| > |r'|, and like a lower power else: of the impulse σ³ is lost, or σ².
const LEAVING: [f64; 2] = [1e-6, 1e-9];
/// Size of the last coefficients of e that is below rounding.
const TAIL: f64 = 1e-16;
/// Radians that e may turn towards w' in a step; the recursion amplifies rounding by the exponential of this.
const MOST_TURN: f64 = 5.0;

/// How a step of slip begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    Slipping,
    /// The bodies have just met: r_0 is zero by definition.
    Met,
    /// They part at once.
    Leaving,
}

/// Coefficients over a step.
#[derive(Debug, Clone)]
pub(crate) struct Turning<T> {
    phase: Phase,
    /// r.
    reach: [T; TERMS],
    /// w'.
    rate: [[T; TERMS]; 2],
    /// e.
    direction: [[T; TERMS]; 2],
    /// θ'.
    turn: [T; TERMS],
    /// r e.
    pull: [[T; TERMS]; 2],
}

/// `Σ_{i=0}^{n} a_i b_{n−i}`.
fn product<T: Number>(a: &[T; TERMS], b: &[T; TERMS], n: usize) -> T {
    let pairs = a.iter().take(n + 1).zip(b.iter().take(n + 1).rev());
    pairs.fold(T::from(0.0), |sum, (&a, &b)| sum + a * b)
}

fn at<T: Number>(c: &[T; TERMS], j: usize) -> T {
    c.get(j).copied().unwrap_or(T::from(0.0))
}

fn put<T>(c: &mut [T; TERMS], j: usize, x: T) {
    if let Some(slot) = c.get_mut(j) {
        *slot = x;
    }
}

impl<T: Number> Turning<T> {
    /// Slip with the force along `direction`; where the bodies have just met, that follows from the motion.
    pub(crate) fn new(phase: Phase, [x, y]: [T; 2]) -> Self {
        let zero = [T::from(0.0); TERMS];
        let mut turning =
            Self { phase, reach: zero, rate: [zero; 2], direction: [zero; 2], turn: zero, pull: [zero; 2] };
        let [first, second] = &mut turning.direction;
        put(first, 0, x);
        put(second, 0, y);
        turning
    }

    /// `Σ_i w'_i·e⊥_{n−i}`.
    fn across(&self, n: usize) -> T {
        let ([w1, w2], [e1, e2]) = (&self.rate, &self.direction);
        product(w2, e1, n) - product(w1, e2, n)
    }

    /// Coefficient `j` of r e, from those of r and w', all lower ones given before. `ahead` is θ'_j where the bodies have just
    /// met and r_0 varies.
    pub(crate) fn extend(&mut self, j: usize, reach: T, [x, y]: [T; 2], ahead: f64) -> [T; 2] {
        put(&mut self.reach, j, reach);
        let [w1, w2] = &mut self.rate;
        put(w1, j, x);
        put(w2, j, y);
        match (self.phase, j) {
            (Phase::Met, 0) => self.meet(ahead),
            (Phase::Leaving, _) | (_, 0) => {}
            (Phase::Slipping, _) => {
                // r_0 θ'_{j−1}; the coefficient itself is still zero.
                let known = self.across(j - 1) - product(&self.reach, &self.turn, j - 1);
                let turn = known / at(&self.reach, 0);
                put(&mut self.turn, j - 1, turn);
                self.turn_to(j);
            }
            (Phase::Met, _) => {
                // With θ'_{j−1} still zero in e_j and in the product.
                self.turn_to(j);
                let order = T::from(j as f64);
                let known = self.across(j) - product(&self.reach, &self.turn, j) - reach_zero(self, ahead);
                let ([w1, w2], [e1, e2]) = (&self.rate, &self.direction);
                let along = at(w1, 0) * at(e1, 0) + at(w2, 0) * at(e2, 0);
                put(&mut self.turn, j - 1, known / (at(&self.reach, 1) + along / order));
                self.turn_to(j);
            }
        }
        let [e1, e2] = &self.direction;
        let pull = [product(&self.reach, e1, j), product(&self.reach, e2, j)];
        let [first, second] = &mut self.pull;
        put(first, j, pull[0]);
        put(second, j, pull[1]);
        pull
    }

    /// e_0 from `r_0 θ'_0 = w'_0·e⊥_0`, r_0 being zero but for its variation.
    fn meet(&mut self, ahead: f64) {
        let [w1, w2] = [&self.rate[0], &self.rate[1]].map(|rate| at(rate, 0));
        let speed = (w1 * w1 + w2 * w2).sqrt();
        let (x, y, behind) = (w1 / speed, w2 / speed, reach_zero(self, ahead) / speed);
        let [first, second] = &mut self.direction;
        put(first, 0, x + behind * y);
        put(second, 0, y - behind * x);
    }

    /// `j e_j = Σ θ'_i e⊥_{j−1−i}`.
    fn turn_to(&mut self, j: usize) {
        let [e1, e2] = &self.direction;
        let order = T::from(j as f64);
        let next = [-product(&self.turn, e2, j - 1) / order, product(&self.turn, e1, j - 1) / order];
        let [first, second] = &mut self.direction;
        put(first, j, next[0]);
        put(second, j, next[1]);
    }

    /// e at place `s` of the step.
    pub(crate) fn direction(&self, s: f64) -> [T; 2] {
        let place = T::from(s);
        [&self.direction[0], &self.direction[1]]
            .map(|c| c.iter().rev().fold(T::from(0.0), |sum, &c| sum * place + c))
    }
}

/// r_0 θ'_j, of which the second comes from another evaluation.
fn reach_zero<T: Number>(turning: &Turning<T>, ahead: f64) -> T {
    at(&turning.reach, 0) * T::from(ahead)
}

impl Turning<f64> {
    /// The phase of slip with reach r and velocities r', w', and a length that a step should not exceed.
    pub(crate) fn judge(reach: f64, reach_rate: f64, speed: f64, met: bool) -> (Phase, f64) {
        if met {
            (Phase::Met, f64::INFINITY)
        } else if reach_rate < 0.0 && reach < -LEAVING[usize::from(speed < -reach_rate)] * reach_rate {
            (Phase::Leaving, f64::INFINITY)
        } else {
            (Phase::Slipping, MOST_TURN * reach / (speed + reach_rate.abs()).max(f64::MIN_POSITIVE))
        }
    }

    pub(crate) fn phase(&self) -> Phase {
        self.phase
    }

    /// (r_j, w'_j).
    pub(crate) fn given(&self, j: usize) -> (f64, [f64; 2]) {
        (at(&self.reach, j), [at(&self.rate[0], j), at(&self.rate[1], j)])
    }

    /// θ'_j.
    pub(crate) fn turn(&self, j: usize) -> f64 {
        at(&self.turn, j)
    }

    /// r e.
    pub(crate) fn pull(&self) -> &[Polynomial; 2] {
        &self.pull
    }

    /// λ, times the length of the step.
    pub(crate) fn slide(&self) -> Polynomial {
        let ([w1, w2], [e1, e2]) = (&self.rate, &self.direction);
        std::array::from_fn(|j| {
            product(w1, e1, j) + product(w2, e2, j) - (j + 1) as f64 * at(&self.reach, j + 1)
        })
    }

    /// The part of the step, at most 1, over which what is left out of the series is rounding.
    pub(crate) fn valid(&self) -> f64 {
        let sizes = self.direction.iter().flat_map(|e| e.iter().enumerate().skip(TERMS - 3));
        sizes
            .filter(|(_, c)| c.abs() > TAIL)
            .map(|(j, c)| (TAIL / c.abs()).powf(1.0 / j as f64))
            .fold(1.0, f64::min)
    }

    /// The same series over the part `factor` of the step.
    pub(crate) fn shorten(&mut self, factor: f64) {
        let scale = |c: &mut Polynomial, first: f64| {
            c.iter_mut().fold(first, |power, c| {
                *c *= power;
                power * factor
            });
        };
        scale(&mut self.reach, 1.0);
        self.direction.iter_mut().chain(&mut self.pull).for_each(|c| scale(c, 1.0));
        // Rates have the length of the step as a factor.
        self.rate.iter_mut().chain([&mut self.turn]).for_each(|c| scale(c, factor));
    }
}
