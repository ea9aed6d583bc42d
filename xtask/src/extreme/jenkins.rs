//! Spring and slider in series, marched from event to event over two periods, and the Fourier integrals of its force.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::motion::{Motion, Turn, gauss};

/// The force harmonics F_0 … F_n in N (rig convention) of an element of stiffness `k` and slip displacement `x`.
///
/// The slider starts at the mean. On a monotone way the force follows the spring up to its limit, so at the next turning point it
/// is a clamp; after one period the state is periodic.
pub(super) fn force_harmonics(motion: &Motion, k: f64, x: f64, highest: usize) -> Vec<Complex64> {
    let mut harmonics = vec![Complex64::ZERO; highest + 1];
    let turns = motion.turns();
    let Some(last) = turns.last() else { return harmonics };
    // The state is the force at a turning point: a place of the slider would round away where x is far below w.
    let limit = k * x;
    let mut before = Turn { tau: last.tau - TAU, ..*last };
    let mut force = (k * (before.w - motion.mean())).clamp(-limit, limit);
    for _ in 0..2 {
        for turn in &turns {
            force = (force + k * (turn.w - before.w)).clamp(-limit, limit);
            before = *turn;
        }
    }
    before = Turn { tau: last.tau - TAU, ..*last };
    for turn in &turns {
        // Rising or falling to this turning point, the element slips where its force reaches ±k x.
        let sign = if turn.maximum { 1.0 } else { -1.0 };
        let (from, start) = (before.tau, force);
        let reached = start + k * (turn.w - before.w);
        let slips = reached * sign > limit;
        let onset =
            if slips { crossing(motion, &before, turn, (sign * limit - start) / k) } else { turn.tau };
        integrate(from, onset, motion, &mut harmonics, |tau| start + k * way(motion, &before, tau));
        integrate(onset, turn.tau, motion, &mut harmonics, |_| sign * limit);
        force = reached.clamp(-limit, limit);
        before = *turn;
    }
    if let Some(mean) = harmonics.first_mut() {
        *mean *= 0.5;
    }
    harmonics
}

/// `w(τ) − w` from a turning point on, without cancellation near it.
fn way(motion: &Motion, from: &Turn, tau: f64) -> f64 {
    let delta = tau - from.tau;
    if delta < 0.02 { -motion.drop(from, delta) } else { motion.at(tau).0 - from.w }
}

/// The instant between two turning points at which the displacement has gone so far.
fn crossing(motion: &Motion, from: &Turn, to: &Turn, rise: f64) -> f64 {
    let (mut low, mut high) = (from.tau, to.tau);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (way(motion, from, middle) < rise) == (rise > 0.0) {
            low = middle;
        } else {
            high = middle;
        }
        if high - low < 1e-16 {
            break;
        }
    }
    0.5 * (low + high)
}

/// Adds `(1/π) ∫ f e^{−ipτ} dτ` to every harmonic p.
fn integrate(from: f64, to: f64, motion: &Motion, harmonics: &mut [Complex64], f: impl Fn(f64) -> f64) {
    if to <= from {
        return;
    }
    // A wave turns by three radians in a panel at most: sixteen nodes leave nothing to be seen.
    let waves = (motion.highest() + harmonics.len()) as f64;
    let panels = ((to - from) * waves / 3.0).ceil().max(1.0);
    let width = (to - from) / panels;
    for panel in 0..panels as usize {
        let start = from + panel as f64 * width;
        for (node, weight) in gauss_rule() {
            let tau = start + node * width;
            let value = f(tau) * weight * width / PI;
            let turn = Complex64::cis(-tau);
            let mut wave = Complex64::ONE;
            for (p, harmonic) in harmonics.iter_mut().enumerate() {
                wave = match p {
                    0 => Complex64::ONE,
                    p if p.is_multiple_of(16) => Complex64::cis(-(p as f64) * tau),
                    _ => wave * turn,
                };
                *harmonic += wave * value;
            }
        }
    }
}

fn gauss_rule() -> &'static [(f64, f64); 16] {
    static RULE: std::sync::OnceLock<[(f64, f64); 16]> = std::sync::OnceLock::new();
    RULE.get_or_init(gauss)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_describing_function() {
        // a = 4 x: θ* = arccos(1 − 1/2) = π/3.
        let motion = Motion { spectrum: vec![Complex64::ZERO, Complex64::from(4.0)] };
        let f = force_harmonics(&motion, 3.0, 1.0, 3);
        let theta = PI / 3.0;
        let expected = Complex64::new(
            4.0 * 3.0 / PI * (theta - 0.5 * (2.0 * theta).sin()),
            4.0 * 3.0 / PI * (1.0 - 0.25),
        );
        assert!((f[1] - expected).norm() < 1e-13, "{} {expected}", f[1]);
        assert!(f[0].norm() < 1e-14 && f[2].norm() < 1e-14);
    }

    #[test]
    fn sticking_is_a_spring_around_the_mean() {
        let motion = Motion { spectrum: vec![Complex64::from(7.0), Complex64::new(0.3, -0.4)] };
        let f = force_harmonics(&motion, 2.0, 1.0, 1);
        assert!(f[0].norm() < 1e-13 && (f[1] - Complex64::new(0.6, -0.8)).norm() < 1e-13);
    }
}
