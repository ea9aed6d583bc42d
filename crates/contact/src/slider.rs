//! One step of a friction slider under a changing normal load, in one or two tangential directions.
//!
//! The spring k_t is stretched by the deflection q = w − s between the body and the slider s. Slip begins where |q| reaches
//! the reach ρ = μN/k_t; while slipping, q = ρ e, and the slider moves towards the body:
//!
//! ```text
//! stick: ṡ = 0,   |q| ≤ ρ        slip: ṡ = λ e, λ ≥ 0,   hence ρ ė = ẇ − (ẇ·e) e,   λ = ẇ·e − ρ̇
//! ```
//!
//! Between two samples w and ρ are taken as linear in time; for such a step the equations have a closed solution. λ only grows
//! while slipping (e turns towards ẇ), so a step that slips does so until its end. The turning of e is that of a body dragged
//! by a rope that is reeled in or out (a tractrix): with X = Δw ln(ρ₁/ρ₀)/(ρ₁ − ρ₀) and x = |X|,
//!
//! ```text
//! e₁ = (e + [sinh x / x + (e·X)(cosh x − 1)/x²] X) / (cosh x + (e·X) sinh x / x)
//! ```
//!
//! The slider is thus the exact one of the motion that is linear between its samples: the periodic state does not depend on
//! where it was begun, two sliders never move apart from each other, and friction never gives energy.

use std::array::from_fn;

use crate::real::Real;

/// What a slider did in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grip {
    /// The bodies are apart at the end: the slider follows.
    Apart,
    /// They touched in this step, and have stuck since.
    Caught,
    /// Stuck all the step.
    Stick,
    /// Slipping at the end.
    Slip,
}

pub(crate) fn dot<T: Real, const D: usize>(a: [T; D], b: [T; D]) -> T {
    a.iter().zip(b).fold(T::from(0.0), |sum, (&x, y)| sum + x * y)
}

fn scaled<T: Real, const D: usize>(a: [T; D], factor: T) -> [T; D] {
    a.map(|x| x * factor)
}

fn sum<T: Real, const D: usize>(a: [T; D], b: [T; D]) -> [T; D] {
    from_fn(|i| a[i] + b[i])
}

/// The deflection at the end of a step that begins with deflection `q`, `slipping` or not, while the body goes the `way` Δw
/// and the reach changes `from` → `to` (negative: apart).
pub(crate) fn advance<T: Real, const D: usize>(
    q: [T; D],
    slipping: bool,
    way: [T; D],
    from: T,
    to: T,
) -> ([T; D], Grip) {
    if to.value() <= 0.0 {
        return ([T::from(0.0); D], Grip::Apart);
    }
    if from.value() <= 0.0 {
        // The slider lies under the body where they touch, at the part −from/(to − from) of the way.
        let rest = scaled(way, to / (to - from));
        let length = dot(rest, rest);
        if length.value() <= to.value() * to.value() {
            return (rest, Grip::Caught);
        }
        return (scaled(rest, to / length.sqrt()), Grip::Slip);
    }
    let trial = sum(q, way);
    if dot(trial, trial).value() <= to.value() * to.value() {
        return (trial, Grip::Stick);
    }
    if D == 1 {
        let sign = |x: T| if x.value() < 0.0 { -to } else { to };
        return (trial.map(sign), Grip::Slip);
    }
    let Some(begin) = onset(q, slipping, way, from, to) else {
        let e = scaled(q, T::from(1.0) / dot(q, q).sqrt());
        return (scaled(dragged(e, way, from, to), to), Grip::Slip);
    };
    let start = sum(q, scaled(way, begin));
    let e = scaled(start, T::from(1.0) / dot(start, start).sqrt());
    let rest = scaled(way, T::from(1.0) - begin);
    (scaled(dragged(e, rest, from + (to - from) * begin, to), to), Grip::Slip)
}

/// The part of the step that sticks before slip begins: the upward zero of
/// `|q + tΔw|² − (ρ₀ + tΔρ)² = a t² + 2 b t + c`. `None` when it slips from the beginning.
fn onset<T: Real, const D: usize>(q: [T; D], slipping: bool, way: [T; D], from: T, to: T) -> Option<T> {
    let rise = to - from;
    let a = dot(way, way) - rise * rise;
    let b = dot(q, way) - from * rise;
    if slipping && b.value() >= 0.0 {
        return None;
    }
    let c = dot(q, q) - from * from;
    let square = b * b - a * c;
    if square.value() <= 0.0 {
        return None;
    }
    let begin = if b.value() >= 0.0 { -c / (b + square.sqrt()) } else { (square.sqrt() - b) / a };
    (begin.value() >= 0.0 && begin.value() < 1.0).then_some(begin)
}

/// Direction e₁ of a deflection that had the direction `e`, dragged along `way` while slipping.
fn dragged<T: Real, const D: usize>(e: [T; D], way: [T; D], from: T, to: T) -> [T; D] {
    let turn = scaled(way, per_mean(from, to));
    let square = dot(turn, turn);
    let along = dot(e, turn);
    if square.value() < 0.01 {
        // sinh x / x, (cosh x − 1)/x² and cosh x by their series: nothing special happens at x = 0.
        let series = |coefficients: [f64; 5]| {
            coefficients.iter().rev().fold(T::from(0.0), |sum, &c| sum * square + T::from(c))
        };
        let s = series([1.0, 1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0, 1.0 / 362_880.0]);
        let c = series([0.5, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40_320.0, 1.0 / 3_628_800.0]);
        let end = sum(e, scaled(turn, s + along * c));
        return scaled(end, T::from(1.0) / (T::from(1.0) + square * c + along * s));
    }
    // The same times 2 e^{−x}, which does not overflow, with 1 + c and 1 − c without cancellation, c = e·X/x.
    let x = square.sqrt();
    let decay = (-x).exp();
    let direction = scaled(turn, T::from(1.0) / x);
    let cosine = along / x;
    let across = sum(e, scaled(direction, -cosine));
    let (one, across) = (T::from(1.0), dot(across, across));
    let (plus, minus) = if cosine.value() < 0.0 {
        (across / (one - cosine), one - cosine)
    } else {
        (one + cosine, across / (one + cosine))
    };
    let whole = plus + minus * decay * decay;
    if whole.value() == 0.0 {
        return e;
    }
    let lost = one - decay;
    let forward = lost * (one + decay) + cosine * lost * lost;
    scaled(sum(scaled(e, decay * 2.0), scaled(direction, forward)), one / whole)
}

/// One over the logarithmic mean of two reaches, ln(ρ₁/ρ₀)/(ρ₁ − ρ₀).
fn per_mean<T: Real>(from: T, to: T) -> T {
    let growth = (to - from) / from;
    let ratio = if growth.value().abs() < 0.01 {
        (1..=8).rev().fold(T::from(0.0), |sum, n| -sum * growth + T::from(1.0 / f64::from(n)))
    } else {
        growth.ln_1p() / growth
    };
    ratio / from
}
