//! Checks of friction under a normal load: closed forms, other laws, finely sampled references, derivatives by two ways.

use super::*;
use crate::{FrictionContact, FrictionContactParameters, JointChange, JointLaw, JointMarks, JointMotion};

/// A motion of several directions with its samples.
struct Moving {
    directions: usize,
    spectrum: Vec<Complex64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl Moving {
    /// From the spectrum of each direction, in m.
    fn new(spectra: &[Vec<Complex64>], samples: usize) -> Self {
        let length = spectra.iter().map(Vec::len).max().unwrap();
        let padded: Vec<Vec<Complex64>> = spectra
            .iter()
            .map(|s| s.iter().copied().chain(std::iter::repeat(Complex64::ZERO)).take(length).collect())
            .collect();
        let rows: Vec<Sampled> = padded.iter().map(|s| Sampled::new(s, samples)).collect();
        Self {
            directions: spectra.len(),
            spectrum: padded.concat(),
            displacement: rows.iter().flat_map(|row| row.displacement.clone()).collect(),
            velocity: rows.iter().flat_map(|row| row.velocity.clone()).collect(),
        }
    }

    fn motion(&self) -> JointMotion<'_> {
        JointMotion {
            directions: self.directions,
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
        }
    }

    fn samples(&self) -> usize {
        self.displacement.len() / self.directions
    }
}

fn forces(law: &dyn JointLaw, moving: &Moving) -> (Vec<f64>, JointMarks) {
    let mut force = vec![0.0; moving.displacement.len()];
    let mut workspace = law.workspace(moving.samples());
    let marks = law.force(&moving.motion(), &mut *workspace, &mut force).unwrap();
    (force, marks)
}

const KT: f64 = 6e6;
const KN: f64 = 4e6;
const MU: f64 = 0.4;
/// Slips from 2 µm on.
const LOAD: f64 = 30.0;

fn contact(preload: Option<f64>, gap: Option<f64>, tangential: usize) -> FrictionContact {
    let parameters = FrictionContactParameters {
        tangential_stiffness: KT,
        normal_stiffness: KN,
        friction_coefficient: MU,
        preload,
        gap,
    };
    FrictionContact::new(parameters, tangential).unwrap()
}

fn um(list: &[(usize, f64, f64)]) -> Vec<Complex64> {
    let highest = list.iter().map(|(k, ..)| *k).max().unwrap_or(0);
    let mut spectrum = vec![Complex64::ZERO; highest + 1];
    for &(k, re, im) in list {
        spectrum[k] = complex(re * 1e-6, im * 1e-6);
    }
    spectrum
}

/// Tangential motions, in one direction and in the other.
fn tangential() -> Vec<[Vec<Complex64>; 2]> {
    vec![
        [um(&[(1, 4.0, 1.0)]), um(&[(1, 1.0, -2.5)])],
        [
            um(&[(0, 1.0, 0.0), (1, 3.0, 0.5), (3, 1.5, 1.9)]),
            um(&[(0, -2.0, 0.0), (1, 2.0, 1.0), (2, 0.7, -0.6)]),
        ],
        [um(&[(1, 2.1, 0.3), (2, 0.4, 0.3)]), um(&[(1, 0.4, 0.1), (2, -0.3, 0.5)])],
        [um(&[(0, 0.5, 0.0), (1, 0.9, 0.3)]), um(&[(1, 0.4, -0.7)])],
        [um(&[(0, 0.3, 0.0), (1, 2.3, 1.3), (4, 1.0, 0.2)]), um(&[(0, 0.3, 0.0)])],
    ]
}

/// Normal motions: constant load, varying, apart at times, apart twice, touching seldom.
fn normal() -> Vec<Vec<Complex64>> {
    vec![
        um(&[]),
        um(&[(0, 0.5, 0.0), (1, 3.0, 1.0)]),
        um(&[(1, 2.0, 1.0), (2, 6.0, -5.0)]),
        um(&[(0, -2.0, 0.0), (1, -3.0, 9.0), (3, 2.0, 1.0)]),
        um(&[(0, -11.0, 0.0), (1, 5.0, 2.0), (2, 4.0, 1.0)]),
    ]
}

fn cases(samples: usize) -> Vec<(FrictionContact, Moving)> {
    let mut cases = Vec::new();
    for [x, y] in tangential() {
        for n in normal() {
            for (preload, gap) in [(Some(LOAD), None), (None, Some(-LOAD / KN))] {
                cases.push((contact(preload, gap, 1), Moving::new(&[x.clone(), n.clone()], samples)));
                cases.push((
                    contact(preload, gap, 2),
                    Moving::new(&[x.clone(), y.clone(), n.clone()], samples),
                ));
            }
        }
    }
    cases
}

#[test]
fn derivatives_agree_with_central_differences() {
    let samples = 128;
    let (mut largest, mut cycles) = (0.0_f64, 0);
    for (number, (law, moving)) in cases(samples).iter().enumerate() {
        let mut workspace = law.workspace(samples);
        let mut force = vec![0.0; moving.displacement.len()];
        let marks = law.force(&moving.motion(), &mut *workspace, &mut force).unwrap();
        cycles = cycles.max(marks.cycles);
        let mut derivative = vec![0.0; force.len()];
        for direction in 0..moving.directions {
            for order in 0..4 {
                for amplitude in [complex(1.0, 0.0), complex(0.0, 1.0)] {
                    if order == 0 && amplitude.im != 0.0 {
                        continue;
                    }
                    let wave: Vec<f64> = (0..samples)
                        .map(|j| (amplitude * Complex64::cis(TAU * (order * j) as f64 / samples as f64)).re)
                        .collect();
                    let change = JointChange { direction, order, amplitude, displacement: &wave };
                    law.derivative(&moving.motion(), &change, &mut *workspace, &mut derivative);
                    let h = 1e-12;
                    let moved = |sign: f64| {
                        let mut spectra: Vec<Vec<Complex64>> =
                            (0..moving.directions).map(|d| moving.motion().spectrum_of(d).to_vec()).collect();
                        spectra[direction].resize(4.max(moving.spectrum.len()), Complex64::ZERO);
                        spectra[direction][order] += amplitude * (sign * h);
                        forces(law, &Moving::new(&spectra, samples)).0
                    };
                    let (up, down) = (moved(1.0), moved(-1.0));
                    for (j, exact) in derivative.iter().enumerate() {
                        let difference = (up[j] - down[j]) / (2.0 * h);
                        let error = (difference - exact).abs() / KT;
                        largest = largest.max(error);
                        assert!(
                            error < 3e-8,
                            "case {number} ({marks:?}) direction {direction} order {order} {amplitude}, sample {j}: {difference} by differences, {exact}"
                        );
                    }
                }
            }
        }
    }
}
