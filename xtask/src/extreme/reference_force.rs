//! The force harmonics that a law gives for a reported motion, evaluated independently of the solver, with a bound of what
//! rounding of the reported motion leaves undetermined.

use num_complex::Complex64;

use super::case::is_odd;
use super::closed_forms;
use super::jenkins;
use super::law::{Built, LawSpec};
use super::memory::{self, Backbone, Series};
use super::motion::Motion;

/// How the balance takes its forces; this is documented of the method, not read from its code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Evaluation {
    /// One harmonic, one contact: describing functions.
    ClosedForm,
    /// Exact integrals for piecewise linear and polynomial laws, so many samples a period for all others.
    Period { samples: usize },
}

/// F_0 … F_n in N (rig convention) and how uncertain each is.
pub(super) struct Force {
    pub(super) harmonics: Vec<Complex64>,
    pub(super) uncertainty: f64,
}

/// Relative rounding of a force that is computed from a motion given to rounding.
const ROUNDING: f64 = 1e-12;

/// The force of `built` for `motion` up to its highest harmonic; `omega` is the base frequency in rad/s.
pub(super) fn evaluate(built: &Built, motion: &Motion, evaluation: Evaluation, omega: f64) -> Force {
    match evaluation {
        Evaluation::ClosedForm => closed_form(built, motion),
        Evaluation::Period { samples } => period(built, motion, samples, omega),
    }
}

fn closed_form(built: &Built, motion: &Motion) -> Force {
    let first = motion.spectrum.get(1).copied().unwrap_or_default();
    let a = first.norm();
    let force = if a == 0.0 { Complex64::ZERO } else { first_harmonic(built, a) };
    let mut harmonics = vec![Complex64::ZERO; motion.spectrum.len()];
    if let (Some(slot), true) = (harmonics.get_mut(1), a > 0.0) {
        *slot = force * (first / a);
    }
    // The mean of a one-harmonic balance: springs alone resist it.
    if let (Some(slot), LawSpec::Linear { stiffness }) = (harmonics.get_mut(0), &built.spec) {
        *slot = Complex64::from(stiffness * motion.mean());
    }
    Force { uncertainty: ROUNDING * force.norm(), harmonics }
}

/// F_1(a) from the definition of the law.
pub(super) fn first_harmonic(built: &Built, a: f64) -> Complex64 {
    match &built.spec {
        LawSpec::ScaledLoop { displacement, series, magnitude, phase } => {
            let force = series.get(1).map_or(0.0, |c| c.norm());
            closed_forms::scaled_loop(a / displacement, force, magnitude, phase)
        }
        LawSpec::LoopFamily { .. } | LawSpec::Measured { .. } => {
            let family = built.family.as_ref();
            family.and_then(|f| f.harmonics(a).nth(1)).map_or(Complex64::ZERO, |(c, _)| c)
        }
        LawSpec::ElasticCoulomb { stiffness, slip_force } => {
            closed_forms::elastic_coulomb(a, *stiffness, slip_force / stiffness)
        }
        LawSpec::IwanSmooth { displacement, force, range } => {
            let curve = Logarithm::new(*displacement, *force, *range);
            closed_forms::masing(a, &[curve.end], |x| curve.at(x))
        }
        LawSpec::IwanPolygon { backbone } => {
            let (sliders, spring) = sliders(backbone);
            let start = Complex64::from(spring * a);
            sliders.iter().fold(start, |sum, &(k, x)| sum + closed_forms::elastic_coulomb(a, k, x))
        }
        LawSpec::Cubic { stiffness } => Complex64::from(0.75 * stiffness * a * a * a),
        LawSpec::Linear { stiffness } => Complex64::from(stiffness * a),
        LawSpec::Coulomb { .. } => Complex64::ZERO,
    }
}

/// Stiffness and slip displacement of every slider of a polygon, and the spring beside them.
fn sliders(backbone: &[[f64; 2]]) -> (Vec<(f64, f64)>, f64) {
    let mut before = [0.0, 0.0];
    let mut slopes = Vec::new();
    for &[x, f] in backbone {
        slopes.push(((f - before[1]) / (x - before[0]), before[0]));
        before = [x, f];
    }
    let elements = slopes.windows(2).map(|pair| (pair[0].0 - pair[1].0, pair[1].1)).filter(|(k, _)| *k > 0.0);
    (elements.collect(), slopes.last().map_or(0.0, |(slope, _)| *slope))
}

/// `0.21 F* [ln(x/W* + 0.01) − ln 0.01]`, straight beyond its range.
struct Logarithm {
    force: f64,
    length: f64,
    end: f64,
}

impl Logarithm {
    fn new(displacement: f64, force: f64, range: f64) -> Self {
        Self { force: 0.21 * force, length: 0.01 * displacement, end: range * displacement }
    }

    fn at(&self, x: f64) -> f64 {
        let curve = self.force * (x.min(self.end) / self.length).ln_1p();
        curve + (x - self.end).max(0.0) * self.force / (self.end + self.length)
    }
}

/// The force of a period; uncertain by what changes with the last digits of the motion.
fn period(built: &Built, motion: &Motion, samples: usize, omega: f64) -> Force {
    let mut force = exactly(built, motion, samples, omega);
    // In several patterns of signs: a steep force may be blind to one of them.
    for pattern in 0..8 {
        let sign = if pattern % 2 == 0 { 1.0 } else { -1.0 };
        let nudge = |(k, w): (usize, &Complex64)| {
            let way = if (k >> (pattern / 2)) % 2 == 0 { sign } else { -sign };
            w * Complex64::new(1.0 + 4.0 * way * f64::EPSILON, 4.0 * sign * f64::EPSILON)
        };
        let mut spectrum: Vec<Complex64> = motion.spectrum.iter().enumerate().map(nudge).collect();
        spectrum[0].im = 0.0;
        let other = exactly(built, &Motion { spectrum }, samples, omega);
        let pairs = force.harmonics.iter().zip(&other.harmonics);
        let change = pairs.map(|(one, other)| (one - other).norm()).fold(0.0, f64::max);
        force.uncertainty = force.uncertainty.max(other.uncertainty + 2.0 * change);
    }
    force
}

fn exactly(built: &Built, motion: &Motion, samples: usize, omega: f64) -> Force {
    let highest = motion.highest();
    match &built.spec {
        LawSpec::Linear { stiffness } => {
            // It is sampled like any other force.
            let uncertainty = 0.01 * ROUNDING * stiffness * (motion.size() + motion.mean().abs());
            Force { harmonics: motion.spectrum.iter().map(|w| w * *stiffness).collect(), uncertainty }
        }
        LawSpec::Cubic { stiffness } => cubic(motion, *stiffness),
        LawSpec::ElasticCoulomb { stiffness, slip_force } => {
            let x = slip_force / stiffness;
            Force {
                harmonics: jenkins::force_harmonics(motion, *stiffness, x, highest),
                uncertainty: stick_uncertainty(motion, *stiffness, x),
            }
        }
        LawSpec::Coulomb { slip_force, velocity } => coulomb(motion, *slip_force, omega / velocity, samples),
        _ => remembered(built, motion, samples),
    }
}

/// An element that sticks feels the rounding of the displacement as force, for the share of the period that it sticks.
fn stick_uncertainty(motion: &Motion, k: f64, x: f64) -> f64 {
    let size = motion.size();
    let share = if size > x { (x / size).sqrt() } else { 1.0 };
    let slips = if size > x { k * x } else { k * size };
    ROUNDING * slips + 16.0 * f64::EPSILON * k * (size * share + motion.mean().abs())
}

/// `k₃ w³` by convolution of the two-sided spectrum.
fn cubic(motion: &Motion, k: f64) -> Force {
    let n = motion.highest() as isize;
    let two_sided = |row: &[Complex64], q: isize| -> Complex64 {
        let value = row.get(q.unsigned_abs()).copied().unwrap_or_default();
        if q < 0 { value.conj() } else { value }
    };
    let half: Vec<Complex64> =
        motion.spectrum.iter().enumerate().map(|(k, w)| if k == 0 { *w } else { 0.5 * w }).collect();
    let product = |a: &[Complex64], b: &[Complex64], to: isize| -> Vec<Complex64> {
        let (la, lb) = (a.len() as isize - 1, b.len() as isize - 1);
        (0..=to)
            .map(|q| {
                let range = (q - lb).max(-la)..=(q + lb).min(la);
                range.map(|j| two_sided(a, j) * two_sided(b, q - j)).sum()
            })
            .collect()
    };
    let square = product(&half, &half, 2 * n);
    let cube = product(&square, &half, n);
    let harmonics = cube.iter().enumerate().map(|(q, f)| f * (if q == 0 { k } else { 2.0 * k })).collect();
    let size = motion.size() + motion.mean().abs();
    Force { harmonics, uncertainty: 0.01 * ROUNDING * k.abs() * size.powi(3) }
}

/// `F_s tanh(ẇ/v)` at samples.
fn coulomb(motion: &Motion, force: f64, steepness: f64, samples: usize) -> Force {
    let size: f64 = motion.spectrum.iter().enumerate().map(|(k, w)| k as f64 * w.norm()).sum();
    let mut uncertainty = 0.0;
    let values: Vec<f64> = (0..samples)
        .map(|j| {
            let rate = motion.at(std::f64::consts::TAU * j as f64 / samples as f64).1 * steepness;
            let slope = rate.cosh().recip().powi(2);
            // A sample in the flank feels the rounding of the velocity.
            let blur = 32.0 * f64::EPSILON * size * steepness;
            uncertainty += force * (slope * blur).min(2.0).max(if rate.abs() < blur { 2.0 } else { 0.0 });
            force * rate.tanh()
        })
        .collect();
    Force {
        harmonics: memory::transform(&values, motion.highest()),
        uncertainty: ROUNDING * force + 2.0 * uncertainty / samples as f64,
    }
}

/// Loops and stacks with memory, at samples.
fn remembered(built: &Built, motion: &Motion, samples: usize) -> Force {
    let highest = motion.highest();
    let turns = motion.turns();
    let a = memory::amplitude(&turns);
    let nothing = Force { harmonics: vec![Complex64::ZERO; highest + 1], uncertainty: 0.0 };
    if a == 0.0 {
        let spring = match &built.spec {
            LawSpec::IwanPolygon { backbone } => sliders(backbone).1,
            _ => 0.0,
        };
        return Force { harmonics: motion.spectrum.iter().map(|w| w * spring).collect(), ..nothing };
    }
    // The mean is large where the amplitude is small: what rounding leaves of the latter.
    let blur = 1.0 + 1e-3 * (motion.mean().abs() + motion.size()) / a;
    let finish = |values: Vec<f64>, spring: f64| {
        let size = values.iter().fold(0.0_f64, |top, f| top.max(f.abs()));
        let mut harmonics = memory::transform(&values, highest);
        if let Some(mean) = harmonics.first_mut() {
            *mean += spring * motion.mean();
        }
        Force {
            harmonics,
            uncertainty: 10.0 * ROUNDING * blur * size + ROUNDING * spring * motion.mean().abs(),
        }
    };
    match &built.spec {
        LawSpec::ScaledLoop { displacement, series, magnitude, phase } => {
            let force = series.get(1).map_or(0.0, |c| c.norm());
            let first = closed_forms::scaled_loop(a / displacement, force, magnitude, phase);
            let sigma = first.im / series.get(1).map_or(1.0, |c| c.im);
            let odd = is_odd(&*built.law);
            let coefficient = |(k, c): (usize, &Complex64)| match k {
                0 => Complex64::ZERO,
                1 => first,
                _ if odd && k.is_multiple_of(2) => Complex64::ZERO,
                _ => c * sigma,
            };
            let coefficients = series.iter().enumerate().map(coefficient).collect();
            finish(memory::force(motion, &turns, &Series { coefficients }, samples), 0.0)
        }
        LawSpec::LoopFamily { .. } => {
            let Some(family) = built.family.as_ref() else { return nothing };
            let coefficients = family.harmonics(a).map(|(c, _)| c).collect();
            finish(memory::force(motion, &turns, &Series { coefficients }, samples), 0.0)
        }
        LawSpec::IwanSmooth { displacement, force, range } => {
            let curve = Logarithm::new(*displacement, *force, *range);
            let backbone = |x: f64| curve.at(x);
            let shape = Backbone { force: &backbone, amplitude: a };
            finish(memory::force(motion, &turns, &shape, samples), 0.0)
        }
        LawSpec::IwanPolygon { backbone } => {
            let (sliders, spring) = sliders(backbone);
            let mut sum = vec![0.0; samples];
            for (k, x) in sliders {
                for (f, part) in sum.iter_mut().zip(element(motion, &turns, k, x, samples)) {
                    *f += part;
                }
            }
            for (j, f) in sum.iter_mut().enumerate() {
                let w = motion.at(std::f64::consts::TAU * j as f64 / samples as f64).0;
                *f += spring * (w - motion.mean());
            }
            finish(sum, spring)
        }
        _ => nothing,
    }
}

/// One spring and slider at samples, marched over two periods from the mean.
fn element(motion: &Motion, turns: &[super::motion::Turn], k: f64, x: f64, samples: usize) -> Vec<f64> {
    let mut slider = motion.mean();
    for _ in 0..2 {
        for turn in turns {
            slider = slider.clamp(turn.w - x, turn.w + x);
        }
    }
    let mut next = 0;
    (0..samples)
        .map(|j| {
            let tau = std::f64::consts::TAU * j as f64 / samples as f64;
            while let Some(turn) = turns.get(next).filter(|turn| turn.tau <= tau) {
                slider = slider.clamp(turn.w - x, turn.w + x);
                next += 1;
            }
            let w = motion.at(tau).0;
            (k * (w - slider)).clamp(-k * x, k * x)
        })
        .collect()
}
