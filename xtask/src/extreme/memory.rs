//! Masing's memory at samples, written from the definition: branches on a stack, minor loops forgotten when they close.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::motion::{Motion, Turn};

/// The two branches of a loop, as force changes over the way p from a tip in units of the amplitude, 0 ≤ p ≤ 2.
pub(super) trait Branches {
    /// Force at the upper and at the lower tip.
    fn tips(&self) -> (f64, f64);
    /// |change| of the force on the unloading (or loading) branch; `left` is 2 − p, exact where it is small.
    fn change(&self, unloading: bool, p: f64, left: f64) -> f64;
}

/// A measured loop, `L = Re Σ c_k z^k` with z = e^{iθ} on the unit circle.
pub(super) struct Series {
    pub(super) coefficients: Vec<Complex64>,
}

impl Series {
    fn at(&self, z: Complex64) -> f64 {
        self.coefficients.iter().rev().fold(Complex64::ZERO, |sum, c| sum * z + c).re
    }
}

impl Branches for Series {
    fn tips(&self) -> (f64, f64) {
        (self.at(Complex64::ONE), self.at(-Complex64::ONE))
    }

    fn change(&self, unloading: bool, p: f64, left: f64) -> f64 {
        let cosine = if p < 1.0 { 1.0 - p } else { left - 1.0 };
        let z = Complex64::new(cosine, (p.max(0.0) * left.max(0.0)).sqrt());
        let (upper, lower) = self.tips();
        if unloading { upper - self.at(z) } else { self.at(-z) - lower }
    }
}

/// A backbone f(x) and its amplitude: branches are 2 f(x/2).
pub(super) struct Backbone<'a> {
    pub(super) force: &'a dyn Fn(f64) -> f64,
    pub(super) amplitude: f64,
}

impl Branches for Backbone<'_> {
    fn tips(&self) -> (f64, f64) {
        let tip = (self.force)(self.amplitude);
        (tip, -tip)
    }

    fn change(&self, _unloading: bool, p: f64, _left: f64) -> f64 {
        2.0 * (self.force)(0.5 * p * self.amplitude)
    }
}

/// One branch of the stack.
#[derive(Clone, Copy)]
struct Branch {
    start: Turn,
    /// Its minor loop is closed when this displacement is passed.
    target: f64,
    unloading: bool,
    force: f64,
    ratio: f64,
    main: bool,
}

/// The amplitude of the motion, half its range; zero at rest.
pub(super) fn amplitude(turns: &[Turn]) -> f64 {
    let top = turns.iter().map(|t| t.w).fold(f64::NEG_INFINITY, f64::max);
    let bottom = turns.iter().map(|t| t.w).fold(f64::INFINITY, f64::min);
    if turns.is_empty() { 0.0 } else { 0.5 * (top - bottom) }
}

/// The force at `samples` equidistant instants of the period.
pub(super) fn force(motion: &Motion, turns: &[Turn], shape: &impl Branches, samples: usize) -> Vec<f64> {
    let mut force = vec![0.0; samples];
    let a = amplitude(turns);
    let by_height = |i: &usize, j: &usize| turns[*i].w.total_cmp(&turns[*j].w);
    let Some(highest) = (0..turns.len()).rev().max_by(by_height) else { return force };
    // In an odd motion the minimum stands opposite: of equal ones the nearest to it.
    let opposite = (turns[highest].tau + 0.5 * TAU).rem_euclid(TAU);
    let away = |i: &usize| {
        let d = (turns[*i].tau - opposite).abs();
        d.min(TAU - d)
    };
    let bottom = turns.iter().map(|t| t.w).fold(f64::INFINITY, f64::min);
    let lowest = (0..turns.len())
        .filter(|i| turns[*i].w <= bottom + 1e-13 * a)
        .min_by(|i, j| away(i).total_cmp(&away(j)))
        .unwrap_or(0);
    let (top, base) = (turns[highest], turns[lowest]);
    let main = |from: Turn, to: Turn, unloading: bool, force: f64| Branch {
        start: from,
        target: to.w,
        unloading,
        force,
        ratio: 1.0,
        main: true,
    };
    let value = |branch: &Branch, tau: f64, w: f64| -> f64 {
        let sign = if branch.unloading { 1.0 } else { -1.0 };
        let mut p = (branch.start.w - w) * sign / a;
        let mut left = 2.0 - p;
        if p < 0.1 {
            p = motion.drop(&branch.start, wrapped(tau - branch.start.tau)) * sign / a;
            left = 2.0 - p;
        } else if branch.main && left < 0.1 {
            let end = if branch.unloading { &base } else { &top };
            left = -motion.drop(end, wrapped(tau - end.tau)) * sign / a;
            p = 2.0 - left;
        }
        branch.force - sign * branch.ratio * shape.change(branch.unloading, p.max(0.0), left)
    };
    let mut stack: Vec<Branch> = Vec::new();
    for step in 0..turns.len() {
        let index = (highest + step) % turns.len();
        let here = turns[index];
        let next = turns[(index + 1) % turns.len()];
        let (upper, lower) = shape.tips();
        if index == highest {
            stack = vec![main(top, base, true, upper)];
        } else if index == lowest {
            stack = vec![main(base, top, false, lower)];
        } else if let Some(&parent) = stack.last() {
            let at_turn = value(&parent, here.tau, here.w);
            let p = (parent.start.w - here.w).abs() / a;
            let own = shape.change(!parent.unloading, p, 2.0 - p);
            // It ends at the force where the interrupted branch began.
            let ratio = if own > 0.0 { (at_turn - parent.force).abs() / own } else { parent.ratio };
            stack.push(Branch {
                start: here,
                target: parent.start.w,
                unloading: !parent.unloading,
                force: at_turn,
                ratio,
                main: false,
            });
        }
        let end = if next.tau > here.tau { next.tau } else { next.tau + TAU };
        let spacing = TAU / samples as f64;
        let first = (here.tau / spacing).ceil() as usize;
        for j in first.. {
            let tau = j as f64 * spacing;
            if tau >= end {
                break;
            }
            let w = motion.at(tau).0;
            close(&mut stack, w);
            if let (Some(branch), Some(slot)) = (stack.last(), force.get_mut(j % samples)) {
                *slot = value(branch, tau, w);
            }
        }
        close(&mut stack, next.w);
    }
    force
}

/// Forgets closed minor loops: each is two branches, the lowest of the stack never closes.
fn close(stack: &mut Vec<Branch>, w: f64) {
    while let (true, Some(branch)) = (stack.len() > 2, stack.last()) {
        let beyond = if branch.unloading { branch.target - w } else { w - branch.target };
        if beyond <= 0.0 {
            return;
        }
        stack.truncate(stack.len() - 2);
    }
}

fn wrapped(delta: f64) -> f64 {
    delta - TAU * (delta / TAU).round()
}

/// F_0 … F_n of samples.
pub(super) fn transform(samples: &[f64], highest: usize) -> Vec<Complex64> {
    let m = samples.len();
    let turns: Vec<Complex64> = (0..m).map(|j| Complex64::cis(-TAU * j as f64 / m as f64)).collect();
    (0..=highest)
        .map(|p| {
            let sum: Complex64 = samples.iter().enumerate().map(|(j, f)| turns[j * p % m] * f).sum();
            sum * (if p == 0 { 1.0 } else { 2.0 } / m as f64)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_runs_through_the_series() {
        let coefficients =
            vec![Complex64::ZERO, Complex64::new(1.0, 2.0), Complex64::ZERO, Complex64::new(-0.2, 0.1)];
        let spectrum = vec![Complex64::ZERO, Complex64::from_polar(3.0, 0.7)];
        let motion = Motion { spectrum };
        let samples = force(&motion, &motion.turns(), &Series { coefficients: coefficients.clone() }, 64);
        let harmonics = transform(&samples, 3);
        for k in [1, 3] {
            let expected = coefficients[k] * Complex64::cis(0.7 * k as f64);
            assert!((harmonics[k] - expected).norm() < 1e-13, "{k}: {} {expected}", harmonics[k]);
        }
    }

    #[test]
    fn a_backbone_with_one_slider_is_a_jenkins_element() {
        let spectrum = [(0.0, 0.0), (2.0, 0.0), (0.0, 0.0), (0.9, 0.8), (0.0, 0.0), (0.4, -0.5)];
        let motion = Motion { spectrum: spectrum.map(|(re, im)| Complex64::new(re, im)).to_vec() };
        let turns = motion.turns();
        assert!(turns.len() > 2);
        let backbone = |x: f64| x.min(0.5) * 3.0;
        let shape = Backbone { force: &backbone, amplitude: amplitude(&turns) };
        let harmonics = transform(&force(&motion, &turns, &shape, 1 << 14), 5);
        let exact = super::super::jenkins::force_harmonics(&motion, 3.0, 0.5, 5);
        for k in 0..=5 {
            assert!((harmonics[k] - exact[k]).norm() < 1e-6, "{k}: {} {}", harmonics[k], exact[k]);
        }
    }
}
