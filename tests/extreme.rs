//! Hard corners with known answers: contacts a trillion times stiffer than the structure, motions a billion times larger
//! than the slip displacement, forces exactly at a limit, resonances that nothing damps. The full table is
//! `cargo xtask extreme`.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use contact::{
    Coulomb, CoulombParameters, Cubic, CubicParameters, Law, Linear, LinearParameters, MagnitudeLaw,
    PhaseLaw, ScaledLoop,
};
use faer::mat;
use hbm::{Excitation, ExcitationKind, FailureReason, Plan, Problem, Settings, Solution, Status};
use num_complex::Complex64;
use stickslip_tests::{elastic_coulomb, force, model, to_ground};

/// One mass m = 1 kg on k = 1 N/m with damping d, excited by 1 N, with `law` to the ground.
fn oscillator(damping: f64, amplitude: f64, law: Arc<dyn Law>) -> Problem {
    Problem {
        joints: Vec::new(),
        model: model(mat![[1.0]], mat![[damping]], mat![[1.0]]),
        excitation: vec![force(0, amplitude)],
        contacts: vec![to_ground(law)],
        output: vec![0],
    }
}

/// The solution with N harmonics at Ω in rad/s.
fn solve(problem: &Problem, harmonics: usize, omega: f64) -> Solution {
    let plan = Plan::new(problem, &Settings::new(harmonics)).unwrap();
    plan.solve(omega / TAU, &mut plan.workspace())
}

fn first(solution: &Solution) -> Complex64 {
    let orders_begin_at_mean = solution.displacement[0].first().is_some_and(|w| w.im == 0.0 && w.re == 0.0);
    solution.displacement[0][usize::from(orders_begin_at_mean && solution.displacement[0].len() > 1)]
}

/// A contact that only sticks is a spring, whatever its stiffness: w = f/(k + k_t − Ω² + iΩd).
#[test]
fn sticking_contacts_of_any_stiffness_are_springs() {
    for decade in -6..=14 {
        let stiffness = 10.0_f64.powi(decade);
        for harmonics in [1, 7, 31] {
            for omega in [1e-6, 0.3, 1.0, 1.7, 1e3] {
                let exact = 1.0 / Complex64::new(1.0 + stiffness - omega * omega, 0.1 * omega);
                let law = elastic_coulomb(stiffness, 2.0 * stiffness * exact.norm());
                let solution = solve(&oscillator(0.1, 1.0, law), harmonics, omega);
                assert_eq!(solution.status, Status::Converged, "{stiffness:e} {harmonics} {omega}");
                let error = (first(&solution) - exact).norm() / exact.norm();
                assert!(error < 1e-9, "{stiffness:e} {harmonics} {omega}: {error:e}");
            }
        }
    }
}

/// Friction that is as good as rigid takes F_s times the way: with the damper, that is the work of the excitation. At a fifth of the
/// resonance the motion nearly stops twice a period, with short ways back.
#[test]
fn stiff_contacts_nearly_stopping_at_31_harmonics() {
    let (damping, slip, omega) = (0.029762068361818647, 0.2096121361537976, 0.21032851950026887);
    for decade in 8..=13 {
        let problem = oscillator(damping, 1.0, elastic_coulomb(10.0_f64.powi(decade), slip));
        let solution = solve(&problem, 31, omega);
        assert_eq!(solution.status, Status::Converged, "{decade}");
        let harmonics: Vec<(f64, Complex64)> =
            (1..).step_by(2).map(f64::from).zip(solution.displacement[0].iter().copied()).collect();
        let at = |tau: f64| harmonics.iter().map(|(k, w)| (w * Complex64::cis(k * tau)).re).sum::<f64>();
        let samples: Vec<f64> = (0..=100_000).map(|j| at(TAU * f64::from(j) / 1e5)).collect();
        let way: f64 = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let damped: f64 = harmonics.iter().map(|(k, w)| PI * damping * omega * k * k * w.norm_sqr()).sum();
        let work = -PI * harmonics[0].1.im;
        let error = (slip * way + damped) / work - 1.0;
        assert!(error.abs() < 1e-7, "{decade}: {error:e}");
    }
}

/// Far above the slip displacement friction is a force ±F_s: for N = 1 its harmonic is 4F_s/π against the velocity.
#[test]
fn amplitudes_far_above_the_slip_displacement() {
    for decade in [2, 6, 9, 12] {
        let (slip, stiffness) = (0.1, 10.0_f64.powi(decade));
        for omega in [0.5, 1.0, 2.0] {
            let solution = solve(&oscillator(0.05, 1.0, elastic_coulomb(stiffness, slip)), 1, omega);
            assert_eq!(solution.status, Status::Converged);
            let w = first(&solution);
            let coulomb = Complex64::I * (4.0 * slip / PI) * (w / w.norm());
            let balance = w * Complex64::new(1.0 - omega * omega, 0.05 * omega) + coulomb - 1.0;
            // The elastic part is of order √(x_c/a).
            let size = 3.0 * slip * (slip / stiffness / w.norm()).sqrt();
            assert!(balance.norm() < size, "{stiffness:e} {omega}: {:e}", balance.norm());
        }
        for harmonics in [3, 7] {
            let solution = solve(&oscillator(0.05, 1.0, elastic_coulomb(stiffness, slip)), harmonics, 0.7);
            assert_eq!(solution.status, Status::Converged, "{stiffness:e} {harmonics}");
            // Dissipation of ±F_s over a path of 4a.
            let contact = &solution.contacts[0];
            let path = 4.0 * contact.amplitude * slip;
            assert!((contact.dissipation / path - 1.0).abs() < 0.05 + 2.0 * 10.0_f64.powi(-decade));
        }
    }
}

/// The extremes of an undamped motion fall on samples, with either sign.
#[test]
fn undamped_motions_slip_whatever_their_phase() {
    for omega in [0.5, 0.9, 1.1, 2.0] {
        for harmonics in [3, 7, 15] {
            let solution = solve(&oscillator(0.0, 1.0, elastic_coulomb(100.0, 0.05)), harmonics, omega);
            assert_eq!(solution.status, Status::Converged);
            let contact = &solution.contacts[0];
            assert!(contact.amplitude > 0.1 && contact.dissipation > 0.0, "{omega} {harmonics}");
        }
        // The sticking state exactly at its limit, N = 7: a spring of 3 N/m.
        if omega == 2.0 {
            continue;
        }
        let amplitude = 1.0 / (4.0 - omega * omega).abs();
        for away in [-1e-9, -1e-12, -1e-16, 0.0, 1e-16, 1e-12, 1e-9] {
            let law = elastic_coulomb(3.0, 3.0 * amplitude * (1.0 + away));
            for harmonics in [1, 7] {
                let solution = solve(&oscillator(0.0, 1.0, law.clone()), harmonics, omega);
                assert_eq!(solution.status, Status::Converged, "{omega} {away:e} {harmonics}");
                let error = (first(&solution).norm() / amplitude - 1.0).abs();
                assert!(error < 1e-6, "{omega} {away:e} {harmonics}: {error:e}");
            }
        }
    }
}

/// The paper's law with a given magnitude law, W* = F* = 1.
fn loop_law(magnitude: MagnitudeLaw) -> Arc<dyn Law> {
    Arc::new(ScaledLoop::ellipse(1.0, 1.0, magnitude, PhaseLaw::default()).unwrap())
}

/// On both sides of the holding limit, and on it, there is an answer.
#[test]
fn excitations_at_the_holding_limit() {
    let limit = MagnitudeLaw::default().value(0.0);
    for away in [-1e-3, -1e-9, -1e-13, -1e-16, 0.0, 1e-16, 1e-13, 1e-9, 1e-3] {
        for omega in [0.1, 0.9, 3.0] {
            let problem = oscillator(0.1, limit * (1.0 + away), loop_law(MagnitudeLaw::default()));
            let solution = solve(&problem, 1, omega);
            assert!(solution.status.solved(), "{away:e} {omega}: {:?}", solution.status);
            if away < -1e-10 && omega < 1.0 {
                assert_eq!(solution.status, Status::Stuck, "{away:e} {omega}");
            }
        }
    }
}

/// The same contact twice holds what one of twice the force holds.
#[test]
fn contacts_that_share_a_motion_share_the_holding_force() {
    let limit = MagnitudeLaw::default().value(0.0);
    let law = loop_law(MagnitudeLaw::default());
    let mut problem = oscillator(0.1, 1.9 * limit, law.clone());
    problem.contacts.push(to_ground(law));
    let solution = solve(&problem, 1, 0.5);
    assert_eq!(solution.status, Status::Stuck);
    let forces: Vec<f64> = solution.contacts.iter().map(|c| c.force[0].norm()).collect();
    assert!(forces.iter().all(|f| *f <= limit), "{forces:?}");
    assert!((forces.iter().sum::<f64>() / (1.9 * limit) - 1.0).abs() < 1e-12);
}

/// A magnitude law that falls below zero creates energy there: no answer, whatever the harmonics.
#[test]
fn a_negative_magnitude_is_no_answer() {
    let falling = MagnitudeLaw { offset: 0.01, slope: -0.2, shift: 0.01 };
    for harmonics in [1, 3] {
        let solution = solve(&oscillator(0.1, 100.0, loop_law(falling)), harmonics, 0.5);
        assert!(!solution.status.solved(), "{harmonics}: {:?}", solution.status);
        if let (1, Status::Failed(reason)) = (harmonics, solution.status) {
            assert!(matches!(reason, FailureReason::Law(_)), "{reason:?}");
        }
    }
}

/// At an undamped resonance friction bounds the motion below 4F_s/π and not above.
#[test]
fn undamped_resonances() {
    let law = || elastic_coulomb(50.0, 1.0);
    for harmonics in [1, 5] {
        let below = solve(&oscillator(0.0, 1.2, law()), harmonics, 1.0);
        assert_eq!(below.status, Status::Converged, "{harmonics}");
        let balance = below.contacts[0].force[0].norm() - 1.2;
        assert!(balance.abs() < 1e-9, "{harmonics}: {balance:e}");
        // Above, the motion grows until it meets the rounding of Ω.
        let above = solve(&oscillator(0.0, 1.3, law()), harmonics, 1.0);
        let expected = FailureReason::SingularStructure { harmonic: 1 };
        let refused = above.status == Status::Failed(expected);
        assert!(refused || above.contacts[0].amplitude > 1e9, "{harmonics}: {:?}", above.status);
    }
    let spring = Arc::new(Linear::new(LinearParameters { stiffness: 1e-6 }).unwrap());
    let solution = solve(&oscillator(0.0, 1.0, spring), 1, 1.0);
    assert!((first(&solution).norm() * 1e-6 - 1.0).abs() < 1e-9);
}

/// At an undamped resonance steep friction cancels the excitation f = p F_s at every instant, tanh(ẇ/v) = p cos τ: the velocity
/// has the first harmonic v (p + p³/4 + …). Any larger motion is far beyond the flank of the tanh.
#[test]
fn steep_friction_at_an_undamped_resonance() {
    for decade in [-3, -5, -7, -9] {
        let (p, velocity) = (0.01, 10.0_f64.powi(decade));
        let law = Arc::new(Coulomb::new(CoulombParameters { slip_force: 1.0, velocity }).unwrap());
        let solution = solve(&oscillator(0.0, p, law), 3, 1.0);
        assert_eq!(solution.status, Status::Converged, "{decade}");
        let error = first(&solution).norm() / (velocity * (p + p * p * p / 4.0)) - 1.0;
        assert!(error.abs() < p.powi(4), "{decade}: {error:e}");
    }
}

/// ¾ k₃ a³ = f at an undamped resonance.
#[test]
fn a_cubic_spring_at_an_undamped_resonance() {
    for decade in [-9, 0, 9, 18] {
        let stiffness = 10.0_f64.powi(decade);
        let law = Arc::new(Cubic::new(CubicParameters { stiffness }).unwrap());
        let solution = solve(&oscillator(0.0, 1.0, law), 1, 1.0);
        assert_eq!(solution.status, Status::Converged);
        let a = first(&solution).norm();
        assert!((0.75 * stiffness * a.powi(3) - 1.0).abs() < 1e-9, "{decade}");
    }
}

/// A static load that nothing supports is refused for what it is, with one harmonic as with more.
#[test]
fn a_free_body_under_a_static_load() {
    for harmonics in [1, 3] {
        let mut problem = oscillator(0.1, 1.0, elastic_coulomb(10.0, 0.1));
        problem.model = model(mat![[1.0]], mat![[0.1]], mat![[0.0]]);
        let load =
            Excitation { dof: 0, harmonic: 0, amplitude: 1.0, phase: 0.0, kind: ExcitationKind::Force };
        problem.excitation.push(load);
        let solution = solve(&problem, harmonics, 1.0);
        let expected = FailureReason::SingularStructure { harmonic: 0 };
        assert_eq!(solution.status, Status::Failed(expected), "{harmonics}");
    }
}

/// No excitation, no motion.
#[test]
fn nothing_moves_without_excitation() {
    let laws = [elastic_coulomb(1e12, 1e-9), loop_law(MagnitudeLaw::default())];
    for law in laws {
        for harmonics in [1, 7] {
            let solution = solve(&oscillator(0.0, 0.0, law.clone()), harmonics, 1.0);
            assert_eq!(solution.status, Status::Converged);
            assert!(solution.displacement[0].iter().all(|w| *w == Complex64::ZERO));
        }
    }
}
