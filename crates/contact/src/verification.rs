//! Checks that every law has to pass: closed forms, derivatives by two independent ways, energy, limits, continuity.
//! Transforms here are naive sums, so that nothing under test also judges.

use std::f64::consts::{PI, TAU};

use hysteresis::Loop;
use num_complex::{Complex, Complex64};
use num_dual::Dual64;
use proptest::prelude::*;

use crate::masing::Masing;
use crate::path::{Path, Piece, SampledPath};
use crate::{
    ContactState, Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Law, LawError, Linear,
    LinearParameters, MagnitudeLaw, Marks, Motion, PhaseLaw, Recall, ScaledLoop, Symmetry, Workspace,
};

/// A motion with its samples.
struct Sampled {
    spectrum: Vec<Complex64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    odd: bool,
}

impl Sampled {
    fn new(spectrum: &[Complex64], samples: usize) -> Self {
        let at = |j: usize, power: i32| -> f64 {
            let tau = TAU * j as f64 / samples as f64;
            spectrum
                .iter()
                .enumerate()
                .map(|(k, c)| {
                    (c * Complex64::new(0.0, k as f64).powi(power) * Complex64::cis(k as f64 * tau)).re
                })
                .sum()
        };
        Self {
            spectrum: spectrum.to_vec(),
            displacement: (0..samples).map(|j| at(j, 0)).collect(),
            velocity: (0..samples).map(|j| at(j, 1)).collect(),
            odd: spectrum.iter().step_by(2).all(|c| c.norm() == 0.0),
        }
    }

    fn motion(&self) -> Motion<'_> {
        Motion {
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
            odd: self.odd,
        }
    }
}

fn force_of(law: &dyn Law, motion: &Sampled) -> Result<(Vec<f64>, Marks), LawError> {
    let samples = motion.displacement.len();
    let mut force = vec![0.0; samples];
    let marks = law.force(&motion.motion(), &mut Workspace::new(samples), &mut force)?;
    Ok((force, marks))
}

/// One-sided harmonics 0..=highest of a sampled signal.
fn harmonics(signal: &[f64], highest: usize) -> Vec<Complex64> {
    let m = signal.len() as f64;
    (0..=highest)
        .map(|k| {
            let sum: Complex64 =
                signal.iter().enumerate().map(|(j, f)| f * Complex64::cis(-TAU * (k * j) as f64 / m)).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / m
        })
        .collect()
}

/// A loop like a Dahl model's: odd, rounded, passive.
fn odd_loop() -> Loop {
    let first = Complex64::from_polar(12.0, PI + PhaseLaw::default().value(1.0));
    Loop::new(
        8e-6,
        vec![
            Complex64::ZERO,
            first,
            Complex64::ZERO,
            Complex64::new(0.6, 2.3),
            Complex64::ZERO,
            Complex64::new(0.3, 0.8),
            Complex64::ZERO,
            Complex64::new(0.1, 0.3),
        ],
    )
    .unwrap()
}

fn uneven_loop() -> Loop {
    let mut coefficients = odd_loop().coefficients().to_vec();
    coefficients[2] = Complex64::new(0.4, 0.3);
    coefficients[4] = Complex64::new(-0.1, 0.1);
    Loop::new(8e-6, coefficients).unwrap()
}

fn scaled(measured: &Loop) -> ScaledLoop {
    ScaledLoop::new(measured, 0.0, MagnitudeLaw::default(), PhaseLaw::default(), Symmetry::Auto).unwrap()
}

fn jenkins() -> ElasticCoulomb {
    ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 6.7e6, slip_force: 15.0 }).unwrap()
}

fn laws() -> Vec<Box<dyn Law>> {
    vec![
        Box::new(scaled(&odd_loop())),
        Box::new(scaled(&uneven_loop())),
        Box::new(jenkins()),
        Box::new(Cubic::new(CubicParameters { stiffness: 1e16 }).unwrap()),
        Box::new(Linear::new(LinearParameters { stiffness: 3e5 }).unwrap()),
    ]
}

fn complex(re: f64, im: f64) -> Complex64 {
    Complex64::new(re, im)
}

/// Motions in units of 1e-6 m: plain, with sharp corners, with interior reversals, with mean and even harmonics.
fn motions() -> Vec<Vec<Complex64>> {
    let um = |list: &[(usize, f64, f64)]| {
        let highest = list.iter().map(|(k, ..)| *k).max().unwrap_or(0);
        let mut spectrum = vec![Complex64::ZERO; highest + 1];
        for &(k, re, im) in list {
            spectrum[k] = complex(re * 1e-6, im * 1e-6);
        }
        spectrum
    };
    vec![
        um(&[(1, 4.0, 1.0)]),
        um(&[(1, 4.0, 1.0), (3, 0.3, -0.2)]),
        um(&[(1, 3.0, 0.5), (3, 1.5, 1.9)]),
        um(&[(1, 1.0, 0.5), (3, 1.5, 1.9), (5, 0.8, -1.0), (7, 0.9, 0.1)]),
        um(&[(0, 1.0, 0.0), (1, 4.0, 1.0), (2, 0.5, 0.1)]),
        um(&[(0, -3.0, 0.0), (1, 2.0, 1.0), (2, 1.5, -0.7), (3, 1.1, 0.4), (5, 0.9, 1.3)]),
        um(&[(1, 1.0, -0.2)]),
        um(&[(0, 0.7, 0.0), (1, 0.9, -0.2), (2, 0.1, 0.1)]),
    ]
}

/// Change of the force spectrum by the tangent, for a small change of one harmonic.
fn predicted(law: &dyn Law, motion: &Sampled, k: usize, change: Complex64, highest: usize) -> Vec<Complex64> {
    let samples = motion.displacement.len();
    let mut workspace = Workspace::new(samples);
    let mut force = vec![0.0; samples];
    law.force(&motion.motion(), &mut workspace, &mut force).unwrap();
    let tangent = law.tangent(&motion.motion(), &mut workspace);
    let delta = |tau: f64| (change * Complex64::cis(k as f64 * tau)).re;
    let df: Vec<f64> = (0..samples)
        .map(|j| {
            let tau = TAU * j as f64 / samples as f64;
            let recalled: f64 = tangent
                .memories()
                .iter()
                .map(|memory| {
                    let functional = match memory.recall {
                        Recall::Displacement { tau } => delta(tau),
                        Recall::Velocity { tau } => {
                            (change * complex(0.0, k as f64) * Complex64::cis(k as f64 * tau)).re
                        }
                        Recall::Mean => {
                            if k == 0 {
                                change.re
                            } else {
                                0.0
                            }
                        }
                    };
                    memory.influence[j] * functional
                })
                .sum();
            tangent.local[j] * delta(tau) + recalled
        })
        .collect();
    harmonics(&df, highest)
}

#[test]
fn derivatives_agree_with_central_differences() {
    let samples = 256;
    for law in laws() {
        for spectrum in motions() {
            let motion = Sampled::new(&spectrum, samples);
            let step = if motion.odd { 2 } else { 1 };
            let first = if motion.odd { 1 } else { 0 };
            for k in (first..spectrum.len() + 2).step_by(step) {
                for direction in [complex(1.0, 0.0), complex(0.0, 1.0)] {
                    if k == 0 && direction.im != 0.0 {
                        continue;
                    }
                    let h = 1e-11;
                    let moved = |sign: f64| {
                        let mut s = spectrum.clone();
                        s.resize(s.len().max(k + 1), Complex64::ZERO);
                        s[k] += direction * (sign * h);
                        harmonics(&force_of(&*law, &Sampled::new(&s, samples)).unwrap().0, 9)
                    };
                    let (up, down) = (moved(1.0), moved(-1.0));
                    let exact = predicted(&*law, &motion, k, direction, 9);
                    let scale = exact.iter().map(|c| c.norm()).fold(1e5, f64::max);
                    for p in 0..=9 {
                        let difference = (up[p] - down[p]) / (2.0 * h);
                        // A kink between the two differences is seen by them, not by the tangent: one sample in 256
                        // may change sides in a friction law; smooth laws have no such excuse.
                        let error = (difference - exact[p]).norm() / scale;
                        assert!(
                            error < 1e-7,
                            "{} at {spectrum:?}: dF_{p}/dW_{k} {direction}: {difference} by differences, {} exact ({error:.1e})",
                            law.name(),
                            exact[p]
                        );
                    }
                }
            }
        }
    }
}
