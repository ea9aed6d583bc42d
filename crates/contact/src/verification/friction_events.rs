//! Checks of friction by its events: against samples, against scalar elastic Coulomb friction, and derivatives.

use super::friction_contact::{KN, KT, LOAD, MU, Moving, contact, forces, normal, tangential, um};
use super::*;
use crate::{Coupling, FrictionContact, JointLaw, JointMarks};

/// ∫ over a piece by Simpson's rule.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> Complex64) -> Complex64 {
    let h = (to - from) / 400.0;
    (0..=400)
        .map(|i| {
            let weight = if i == 0 || i == 400 { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            f(from + h * f64::from(i)) * (weight * h / 3.0)
        })
        .sum()
}

fn couplings(law: &FrictionContact, moving: &Moving) -> (Vec<Coupling>, JointMarks) {
    let events = law.piecewise_linear().unwrap();
    let mut couplings = events.couplings();
    let mut workspace = law.workspace(moving.samples());
    let marks = events.pieces(&moving.motion(), &mut *workspace, &mut couplings).unwrap();
    (couplings, marks)
}

fn value(spectrum: &[Complex64], tau: f64) -> f64 {
    spectrum.iter().enumerate().map(|(k, c)| (c * Complex64::cis(k as f64 * tau)).re).sum()
}

/// One-sided harmonics of both forces by their pieces.
fn by_events(law: &FrictionContact, moving: &Moving, highest: usize) -> ([Vec<Complex64>; 2], JointMarks) {
    let (couplings, marks) = couplings(law, moving);
    let mut sums = [vec![Complex64::ZERO; highest + 1], vec![Complex64::ZERO; highest + 1]];
    for coupling in &couplings {
        let w = moving.motion().spectrum_of(coupling.displacement);
        for piece in &coupling.pieces {
            assert!(piece.to >= piece.from && !piece.close);
            for (k, sum) in sums[coupling.force].iter_mut().enumerate() {
                let wave = |tau: f64| {
                    Complex64::cis(-(k as f64) * tau) * (piece.stiffness * value(w, tau) + piece.offset)
                };
                *sum += integral(piece.from, piece.to, wave) / if k == 0 { TAU } else { PI };
            }
        }
    }
    (sums, marks)
}

fn cases() -> Vec<(FrictionContact, [Vec<Complex64>; 2])> {
    let mut cases = Vec::new();
    for [x, y] in tangential() {
        for n in normal() {
            cases.push((contact(Some(LOAD), None, 1), [x.clone(), n.clone()]));
            cases.push((contact(None, Some(0.3e-6 - LOAD / KN), 1), [y.clone(), n]));
        }
    }
    cases
}

#[test]
fn events_and_samples_agree_within_the_sampling_error() {
    let samples = 1 << 12;
    for (number, (law, spectra)) in cases().iter().enumerate() {
        let (exact, marks) = by_events(law, &Moving::new(spectra, 64), 7);
        let (force, sampled) = forces(law, &Moving::new(spectra, samples));
        assert_eq!(marks.state, sampled.state, "{number}");
        assert!((marks.apart - sampled.apart).abs() < 1e-5, "{number}");
        for (direction, row) in force.chunks(samples).enumerate() {
            for (k, (a, b)) in exact[direction].iter().zip(harmonics(row, 7)).enumerate() {
                let error = (a - b).norm() / LOAD;
                assert!(error < 1e-5, "case {number} {marks:?} F_{k} of {direction}: {a} {b} {error:e}");
            }
        }
    }
}

#[test]
fn under_a_constant_load_the_pieces_are_those_of_elastic_coulomb_friction() {
    let jenkins =
        ElasticCoulomb::new(ElasticCoulombParameters { stiffness: KT, slip_force: MU * LOAD }).unwrap();
    for spectrum in motions() {
        let moving = Moving::new(&[spectrum.clone(), um(&[])], 128);
        let (exact, _) = by_events(&contact(Some(LOAD), None, 1), &moving, 7);
        let mut pieces = Vec::new();
        let mut scalar = Sampled::new(&spectrum, 128);
        scalar.odd = false;
        let events = jenkins.piecewise_linear().unwrap();
        events.pieces(&scalar.motion(), &mut Workspace::new(128), &mut pieces).unwrap();
        for (k, f) in exact[0].iter().enumerate() {
            let wave = |piece: &crate::ForcePiece| {
                integral(piece.from, piece.to, |tau| {
                    let f = piece.stiffness * value(&spectrum, tau) + piece.offset;
                    Complex64::cis(-(k as f64) * tau) * f
                })
            };
            let expected = pieces.iter().map(wave).sum::<Complex64>() / if k == 0 { TAU } else { PI };
            assert!((f - expected).norm() < 1e-8 * MU * LOAD, "{spectrum:?} F_{k}: {f} {expected}");
        }
    }
}

#[test]
fn derivatives_agree_with_central_differences() {
    for (number, (law, spectra)) in cases().iter().enumerate() {
        let moving = Moving::new(spectra, 64);
        let (couplings, marks) = couplings(law, &moving);
        for direction in 0..2 {
            for (order, change) in [
                (0, complex(1.0, 0.0)),
                (1, complex(1.0, 0.0)),
                (1, complex(0.0, 1.0)),
                (3, complex(0.6, -0.8)),
            ] {
                let h = 1e-12;
                let moved = |sign: f64| {
                    let mut spectra = spectra.clone();
                    let length = spectra[direction].len().max(order + 1);
                    spectra[direction].resize(length, Complex64::ZERO);
                    spectra[direction][order] += change * (sign * h);
                    by_events(law, &Moving::new(&spectra, 64), 4).0
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                let wave = |tau: f64| (change * Complex64::cis(order as f64 * tau)).re;
                for force in 0..2 {
                    for k in 0..=4 {
                        let mut exact = Complex64::ZERO;
                        let own = |c: &&Coupling| c.force == force && c.displacement == direction;
                        for piece in couplings.iter().filter(own).flat_map(|c| &c.pieces) {
                            let recalled = piece.memory.map_or(0.0, |(recall, by)| match recall {
                                Recall::Displacement { tau } => by * wave(tau),
                                Recall::Mean if order == 0 => by * change.re,
                                _ => 0.0,
                            });
                            exact += integral(piece.from, piece.to, |tau| {
                                Complex64::cis(-(k as f64) * tau) * (piece.stiffness * wave(tau) + recalled)
                            }) / if k == 0 { TAU } else { PI };
                        }
                        let difference = (up[force][k] - down[force][k]) / (2.0 * h);
                        let error = (difference - exact).norm() / KT;
                        assert!(
                            error < 1e-6,
                            "case {number} {marks:?} dF_{k} of {force} by W_{order} of {direction}: {difference} {exact} {error:e}"
                        );
                    }
                }
            }
        }
    }
}
