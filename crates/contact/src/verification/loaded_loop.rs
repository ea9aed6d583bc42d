//! Checks of a measured loop under a varying load.

use super::friction_contact::{Moving, check_differences, forces, friction_work, um};
use super::*;
use crate::{JointLaw, LoadedLoop, NormalContact, NormalContactParameters};

const LOAD: f64 = 22.0;
const KN: f64 = 4e6;

fn loaded(measured: &Loop, preload: f64) -> LoadedLoop {
    let parameters = NormalContactParameters { stiffness: KN, preload: Some(preload), gap: None };
    LoadedLoop::new(scaled(measured), NormalContact::new(parameters).unwrap(), LOAD).unwrap()
}

#[test]
fn under_the_load_of_the_measurement_it_is_the_scaled_loop() {
    for measured in [odd_loop(), uneven_loop()] {
        for spectrum in motions() {
            let moving = Moving::new(&[spectrum.clone(), vec![Complex64::ZERO]], 256);
            let (force, marks) = forces(&loaded(&measured, LOAD), &moving);
            let mut scalar = Sampled::new(moving.motion().spectrum_of(0), 256);
            scalar.odd = false;
            let (expected, other) = force_of(&scaled(&measured), &scalar).unwrap();
            assert_eq!(force[..256], expected);
            assert_eq!((marks.state, marks.extrapolated), (other.state, other.extrapolated));
        }
    }
}

#[test]
fn derivatives_agree_with_central_differences() {
    for measured in [odd_loop(), uneven_loop()] {
        for tangential in motions() {
            for normal in [um(&[(0, 0.3, 0.0), (1, 2.0, 1.0)]), um(&[(1, 2.0, 1.0), (2, 6.0, -5.0)])] {
                let moving = Moving::new(&[tangential.clone(), normal], 256);
                // A rounded loop is vertical at its tips: beside one the stiffness is of order 1e7 N/m.
                check_differences(&loaded(&measured, LOAD), &moving, 1e7, 1e-6);
            }
        }
    }
}

/// w = a cos τ, N = N_0 (1 + b sin 2τ): a spring k N/N* alone takes ∮ k w (N/N*) dw = −(π/2) k a² b N_0/N*, negative for
/// b > 0: it is stiffer on the way back to the middle. The friction of a loop that hardly slips is less.
#[test]
fn it_can_give_energy() {
    let work = |a: f64, b: f64| {
        let moving = Moving::new(&[um(&[(1, a, 0.0)]), um(&[(2, 0.0, -b * LOAD / KN * 1e6)])], 2048);
        friction_work(&moving, &forces(&loaded(&odd_loop(), LOAD), &moving).0)
    };
    let a = 0.1;
    let constant = work(a, 0.0);
    assert!(constant > 0.0);
    // Under a constant load only the first harmonic works: π a Im c_1.
    let (first, _) = scaled(&odd_loop()).first(a * 1e-6 / 8e-6);
    assert!((constant / (PI * a * 1e-6 * first.im) - 1.0).abs() < 1e-9);
    assert!(work(a, 0.9) < 0.0 && work(a, -0.9) > constant, "{} {constant}", work(a, 0.9));
    // Where it mostly slips, it dissipates.
    assert!(work(30.0, 0.9) > 0.0);
}

#[test]
fn without_motion_or_load() {
    let law = loaded(&odd_loop(), LOAD);
    let still = Moving::new(&[um(&[(0, 1.0, 0.0)]), um(&[(1, 1.0, 0.0)])], 64);
    let mut force = vec![0.0; 128];
    let answer = law.force(&still.motion(), &mut *law.workspace(64), &mut force);
    assert_eq!(answer.unwrap_err(), LawError::NoMotion);
    let away = Moving::new(&[um(&[(0, 1.0, 0.0)]), um(&[(0, -9.0, 0.0)])], 64);
    let (force, marks) = forces(&law, &away);
    assert_eq!((marks.state, marks.apart), (ContactState::Apart, 1.0));
    assert!(force[..64].iter().all(|f| *f == 0.0));
    let normal = NormalContact::new(NormalContactParameters { stiffness: KN, preload: None, gap: Some(0.0) });
    assert_eq!(LoadedLoop::new(scaled(&odd_loop()), normal.unwrap(), 0.0).unwrap_err().key, "reference");
}
