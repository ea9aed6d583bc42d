//! The balance against linear algebra, symmetry and known nonlinear oscillators.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{
    ContactState, Cubic, CubicParameters, Law, Linear, LinearParameters, MagnitudeLaw, PhaseLaw, ScaledLoop,
};
use faer::{c64, mat, prelude::*};
use hbm::{
    Contact, Damping, Excitation, ExcitationKind, FailureReason, Jacobian, Model, Plan, Problem, Settings,
    Solution, Start, Status,
};
use num_complex::Complex64;
use stickslip_tests::{
    elastic_coulomb, force, model, paper_scene, scaled_reference_loop, scene_p_cubic, scene_r, to_ground,
    two_mass,
};

fn solve(problem: &Problem, settings: &Settings, hertz: f64) -> Solution {
    let plan = Plan::new(problem, settings).unwrap();
    plan.solve(hertz, &mut plan.workspace())
}

fn distance(a: &[Vec<Complex64>], b: &[Vec<Complex64>]) -> f64 {
    let pairs = || a.iter().flatten().zip(b.iter().flatten());
    let difference: f64 = pairs().map(|(a, b)| (a - b).norm_sqr()).sum();
    let size: f64 = pairs().map(|(a, _)| a.norm_sqr()).sum();
    (difference / size).sqrt()
}

/// Spring between the masses and to the ground, two excited harmonics, gyroscopic damping: one linear system each.
#[test]
fn linear_contacts_are_part_of_the_structure() {
    let spring =
        |k: f64| -> Arc<dyn Law> { Arc::new(Linear::new(LinearParameters { stiffness: k }).unwrap()) };
    let mass = mat![[2.0, 0.1], [0.1, 1.0]];
    let damping = mat![[3.0, 1.0], [-1.0, 2.0]];
    let stiffness = mat![[3e4, -1e4], [-1e4, 2e4]];
    let between = Contact { name: "b".into(), first: 0, second: Some(1), law: spring(7e3), scale: 2.0 };
    let problem = Problem {
        joints: Vec::new(),
        model: model(mass.clone(), damping.clone(), stiffness.clone()),
        excitation: vec![
            Excitation { dof: 0, harmonic: 1, amplitude: 3.0, phase: 0.4, kind: ExcitationKind::Force },
            Excitation { dof: 1, harmonic: 2, amplitude: 1.0, phase: 0.0, kind: ExcitationKind::Unbalance },
            Excitation { dof: 0, harmonic: 0, amplitude: 5.0, phase: 0.0, kind: ExcitationKind::Base },
        ],
        contacts: vec![to_ground(spring(5e3)), between],
        output: vec![1, 0],
    };
    let hertz = 11.0;
    let solution = solve(&problem, &Settings::new(3), hertz);
    assert_eq!((solution.status, solution.solutions), (Status::Converged, Some(1)));
    let omega = TAU * hertz;
    let coupled = mat![[3e4 + 5e3 + 14e3, -1e4 - 14e3], [-1e4 - 14e3, 2e4 + 14e3]];
    let loads = [
        (0, [c64::new(-2.1 * 5.0, 0.0), c64::new(-1.1 * 5.0, 0.0)]),
        (1, [c64::from_polar(3.0, 0.4), c64::ZERO]),
        (2, [c64::ZERO, c64::new(omega * omega, 0.0)]),
        (3, [c64::ZERO, c64::ZERO]),
    ];
    for (k, load) in loads {
        let w = k as f64 * omega;
        let h =
            Mat::from_fn(2, 2, |i, j| c64::new(coupled[(i, j)] - w * w * mass[(i, j)], w * damping[(i, j)]));
        let x = h.partial_piv_lu().solve(Mat::from_fn(2, 1, |i, _| load[i]));
        for (row, dof) in [1, 0].into_iter().enumerate() {
            let error = (solution.displacement[row][k] - x[(dof, 0)]).norm();
            assert!(error < 1e-14 * (1.0 + x[(dof, 0)].norm()), "harmonic {k}, dof {dof}: {error}");
        }
    }
}

/// Excitation on harmonic 3 alone is the problem of the first harmonic at three times the frequency.
#[test]
fn the_base_period_is_the_shortest() {
    for law in [elastic_coulomb(6.705e6, 14.9), scaled_reference_loop()] {
        let first = two_mass(law);
        let mut third = first.clone();
        third.excitation[0].harmonic = 3;
        let one = solve(&first, &Settings::new(5), 75.0);
        let plan = Plan::new(&third, &Settings::new(15)).unwrap();
        assert_eq!(plan.orders(), [3, 9, 15]);
        let three = plan.solve(25.0, &mut plan.workspace());
        assert!(distance(&one.displacement, &three.displacement) < 1e-13);
        assert!((three.contacts[0].dissipation / (3.0 * one.contacts[0].dissipation) - 1.0).abs() < 1e-13);
    }
}

/// Every way to the derivative gives the same solution, and both are one.
#[test]
fn finite_differences_reach_the_same_solution() {
    for problem in [scene_r(), paper_scene(), scene_p_cubic()] {
        let mut settings = Settings::new(7);
        let analytic = solve(&problem, &settings, 75.0);
        settings.jacobian = Jacobian::Difference;
        settings.tolerance = 1e-10;
        let difference = solve(&problem, &settings, 75.0);
        assert_eq!((analytic.status, difference.status), (Status::Converged, Status::Converged));
        assert!(distance(&analytic.displacement, &difference.displacement) < 1e-9);
    }
}

/// Newton's convergence is quadratic: each residual is about the square of the last one.
#[test]
fn the_analytic_derivative_converges_quadratically() {
    let mut settings = Settings::new(7);
    settings.start = Start::March;
    for problem in [paper_scene(), scene_p_cubic()] {
        let plan = Plan::new(&problem, &settings).unwrap();
        let mut workspace = plan.workspace();
        plan.solve(75.0, &mut workspace);
        let mut solution = Solution::default();
        plan.solve_next(75.3, &mut workspace, &mut solution);
        plan.solve_next(75.6, &mut workspace, &mut solution);
        let history = &solution.residual_history;
        assert!(history.len() <= 5, "{history:?}");
        let quadratic = history.windows(2).filter(|pair| pair[0] < 1e-2 && pair[1] > 1e-13);
        for pair in quadratic {
            assert!(pair[1] < 100.0 * pair[0] * pair[0], "{history:?}");
        }
    }
}

/// Two equal contacts of half the strength are one.
#[test]
fn contacts_add_up() {
    for law in [elastic_coulomb(6.705e6, 14.9), scaled_reference_loop()] {
        for hertz in [43.0, 75.0, 108.0] {
            let single = two_mass(law.clone());
            let mut double = single.clone();
            double.contacts[0].scale = 0.5;
            double.contacts.push(double.contacts[0].clone());
            let (one, two) =
                (solve(&single, &Settings::new(7), hertz), solve(&double, &Settings::new(7), hertz));
            assert_eq!(two.status, Status::Converged, "{hertz}");
            assert!(distance(&one.displacement, &two.displacement) < 1e-10, "{hertz}");
            let (halves, whole) =
                (two.contacts[0].dissipation + two.contacts[1].dissipation, one.contacts[0].dissipation);
            // An elastic Coulomb contact that sticks (43 Hz) dissipates nothing but rounding errors.
            assert!((halves - whole).abs() < 1e-10 * whole.abs() + 1e-18, "{hertz}: {halves:e} {whole:e}");
        }
    }
}

/// Energy: what the excitation puts in, damping and contacts take out, whatever N.
#[test]
fn energy_balances() {
    for (problem, damping) in [(scene_r(), 24.0), (paper_scene(), 24.0), (scene_p_cubic(), 2.0)] {
        for harmonics in [1, 3, 15] {
            let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
            let solution = plan.solve(70.0, &mut plan.workspace());
            let omega = TAU * 70.0;
            // ∮ f ẇ dt = π Im(… ): f̂ cos Ωt on w2 does π f̂ |W| sin(phase lag).
            let input = -TAU / 2.0 * problem.excitation[0].amplitude * solution.displacement[1][0].im;
            let viscous: f64 = solution
                .displacement
                .iter()
                .flat_map(|row| row.iter().zip(plan.orders()))
                .map(|(w, &k)| TAU / 2.0 * (k * k) as f64 * omega * damping * w.norm_sqr())
                .sum();
            let contact = solution.contacts[0].dissipation;
            let error = (input - viscous - contact).abs() / input;
            assert!(error < 1e-9, "N = {harmonics}: {input} in, {viscous} + {contact} out");
        }
    }
}

/// Scene P with a cubic spring of 1e9 N/m³: the peak at N = 7, and three solutions between the folds.
#[test]
fn the_resonance_of_the_cubic_scene() {
    let mut settings = Settings::new(7);
    settings.all_solutions = true;
    let plan = Plan::new(&scene_p_cubic(), &settings).unwrap();
    let mut workspace = plan.workspace();
    let mut solutions = |hertz: f64| -> Vec<f64> {
        let solution = plan.solve(hertz, &mut workspace);
        assert_eq!(solution.status, Status::Converged, "{hertz}");
        let mut all = vec![solution.displacement[1][0].norm()];
        all.extend(solution.others.iter().map(|other| other.displacement[1][0].norm()));
        all
    };
    // Between the folds at 43.219 Hz and 43.262 Hz.
    assert_eq!(solutions(43.24).len(), 3);
    assert_eq!(solutions(43.20).len(), 1);
    assert_eq!(solutions(43.28).len(), 1);
    let peak = (0..=200).map(|i| solutions(43.2 + f64::from(i) * 5e-4)[0]).fold(0.0, f64::max);
    assert!((peak / 4.0177e-3 - 1.0).abs() < 2e-5, "{peak:e}");
}

#[test]
fn nothing_excited_nothing_moves() {
    for law in [elastic_coulomb(6.705e6, 14.9), scaled_reference_loop()] {
        let mut problem = two_mass(law);
        problem.excitation[0].amplitude = 0.0;
        for harmonics in [1, 7] {
            let solution = solve(&problem, &Settings::new(harmonics), 50.0);
            assert_eq!(solution.status, Status::Converged);
            assert_eq!(solution.residual, 0.0);
            assert!(solution.displacement.iter().flatten().all(|w| *w == Complex64::ZERO));
        }
    }
}

/// Within the holding force a loop contact does not move, whatever N; w2 moves as if w1 were clamped.
#[test]
fn small_excitation_is_held() {
    let mut problem = paper_scene();
    problem.excitation[0].amplitude = 0.03;
    for harmonics in [1, 7] {
        let solution = solve(&problem, &Settings::new(harmonics), 75.0);
        assert_eq!(solution.status, Status::Stuck);
        assert_eq!(solution.contacts[0].state, ContactState::Held);
        assert_eq!(solution.contacts[0].amplitude, 0.0);
        let omega = TAU * 75.0;
        let clamped = 0.03 / Complex64::new(4.1e5 - 1.27 * omega * omega, 24.0 * omega);
        assert!((solution.displacement[1][0] - clamped).norm() < 1e-13 * clamped.norm());
        // The structure pulls at the contact with c2 w2; the contact holds against it.
        let holding = -4.1e5 * clamped;
        assert!((solution.contacts[0].force[0] - holding).norm() < 1e-12 * holding.norm());
    }
}

/// One contact held, another one sliding: the held one is a support of the other's structure.
#[test]
fn one_contact_is_held_while_another_slides() {
    let mut problem = paper_scene();
    let strong = ScaledLoop::ellipse(8e-6, 12e6, MagnitudeLaw::default(), PhaseLaw::default()).unwrap();
    problem.contacts.insert(0, Contact { first: 0, name: "clamp".into(), ..to_ground(Arc::new(strong)) });
    problem.contacts[1].first = 1;
    let both = solve(&problem, &Settings::new(3), 75.0);
    assert_eq!(both.status, Status::Converged);
    assert_eq!(both.contacts[0].state, ContactState::Held);
    assert_eq!(both.contacts[1].state, ContactState::Mixed);
    // The same with w1 removed from the model.
    let mut alone = problem.clone();
    alone.model = model(mat![[1.27]], mat![[24.0]], mat![[4.1e5]]);
    alone.excitation = vec![force(0, 9.1)];
    alone.contacts.remove(0);
    alone.contacts[0].first = 0;
    alone.output = vec![0];
    let alone = solve(&alone, &Settings::new(3), 75.0);
    assert!(distance(&both.displacement[1..], &alone.displacement) < 1e-10);
}

/// What would not fit into memory is refused when it is planned, not met while it is solved.
#[test]
fn sizes_beyond_memory_are_refused() {
    let one = scene_r();
    assert!(Plan::new(&one, &Settings::new(4095)).is_ok());
    let mut many = one.clone();
    let contact = many.contacts[0].clone();
    many.contacts = (0..40).map(|i| Contact { name: format!("root[{i}]"), ..contact.clone() }).collect();
    assert!(Plan::new(&many, &Settings::new(7)).is_ok());
    assert!(Plan::new(&many, &Settings::new(511)).is_ok());
    let error = Plan::new(&many, &Settings::new(2047)).unwrap_err();
    assert_eq!(error.place, "harmonics");
    assert!(
        error.problem.contains("2047 harmonics at 40 contacts") && error.problem.contains("GB"),
        "{error}"
    );
}

/// An undamped mass on a spring, exactly at its resonance, with any law.
fn at_resonance(law: Arc<dyn Law>) -> (Problem, f64) {
    let problem = Problem {
        joints: Vec::new(),
        model: Model::new(mat![[1.0]], Damping::Matrix(mat![[0.0]]), mat![[4.0]]).unwrap(),
        excitation: vec![force(0, 1.0)],
        contacts: vec![to_ground(law)],
        output: vec![0],
    };
    (problem, 2.0 / TAU)
}

/// There the structure has no receptance, and the contact alone balances the excitation: F_1 = f̂.
#[test]
fn a_contact_bounds_an_undamped_resonance() {
    let cubic = Arc::new(Cubic::new(CubicParameters { stiffness: 2.0 }).unwrap());
    let linear = Arc::new(Linear::new(LinearParameters { stiffness: 5.0 }).unwrap());
    let friction = elastic_coulomb(3.0, 1.2);
    let laws: [Arc<dyn Law>; 3] = [cubic, linear, friction];
    for law in laws {
        let first = |a: f64| law.describing_function().unwrap().first_harmonic(a).force;
        let (problem, hertz) = at_resonance(law.clone());
        let one = solve(&problem, &Settings::new(1), hertz);
        assert_eq!(one.status, Status::Converged, "{}", law.name());
        let w = one.displacement[0][0];
        assert!((first(w.norm()) * w / w.norm() - 1.0).norm() < 1e-12, "{}: {w}", law.name());
        // With more harmonics the first force harmonic is still f̂, and H_k W_k = −F_k above it.
        let more = solve(&problem, &Settings::new(15), hertz);
        assert_eq!(more.status, Status::Converged, "{}", law.name());
        let contact = &more.contacts[0];
        assert!((contact.force[0] + 1.0).norm() < 1e-10, "{}: {:?}", law.name(), contact.force);
        for (slot, w) in contact.displacement.iter().enumerate().skip(1) {
            let k = (2 * slot + 1) as f64;
            assert!((w * (4.0 - 4.0 * k * k) - contact.force[slot]).norm() < 1e-10);
        }
    }
}

/// Friction of slip force F_s takes 4 F_s/π at most out of the first harmonic; and nothing out of a mode that does not
/// move it.
#[test]
fn an_unbounded_resonance_is_named() {
    let (problem, hertz) = at_resonance(elastic_coulomb(1.0, 0.7));
    let unbounded = Status::Failed(FailureReason::SingularStructure { harmonic: 1 });
    for harmonics in [1, 3] {
        let solution = solve(&problem, &Settings::new(harmonics), hertz);
        assert_eq!(solution.status, unbounded);
        assert!(solution.displacement.is_empty());
    }
    let mut apart = at_resonance(elastic_coulomb(1.0, 10.0)).0;
    apart.model = Model::new(
        mat![[1.0, 0.0], [0.0, 1.0]],
        Damping::Matrix(Mat::zeros(2, 2)),
        mat![[9.0, 0.0], [0.0, 4.0]],
    )
    .unwrap();
    apart.excitation = vec![force(0, 1.0), force(1, 1.0)];
    assert_eq!(solve(&apart, &Settings::new(3), hertz).status, unbounded);
}

/// A body that only its contact holds: at rest under a static load on the spring, undetermined on a slider.
#[test]
fn a_free_body_is_held_by_its_contact() {
    let free = |law: Arc<dyn Law>, harmonics: usize| {
        let problem = Problem {
            joints: Vec::new(),
            model: Model::new(mat![[2.0]], Damping::Matrix(mat![[1.0]]), mat![[0.0]]).unwrap(),
            excitation: vec![Excitation { harmonic: 0, ..force(0, 3.0) }, force(0, 1.0)],
            contacts: vec![to_ground(law)],
            output: vec![0],
        };
        solve(&problem, &Settings::new(harmonics), 1.0 / TAU)
    };
    let held = free(Arc::new(Linear::new(LinearParameters { stiffness: 6.0 }).unwrap()), 3);
    assert_eq!(held.status, Status::Converged);
    assert!((held.displacement[0][0] - 0.5).norm() < 1e-13);
    // (6 − 2 + i) W_1 = 1.
    assert!((held.displacement[0][1] - 1.0 / Complex64::new(4.0, 1.0)).norm() < 1e-13);
    let slides = free(elastic_coulomb(6.0, 1.0), 3);
    assert_eq!(slides.status, Status::Failed(FailureReason::SingularStructure { harmonic: 0 }));
}

/// A static load on a spring that hardens: the root of k w + k₃ w³ = F. A friction slider gives in to it.
#[test]
fn static_loads() {
    let one = |law: Arc<dyn Law>| Problem {
        joints: Vec::new(),
        model: Model::new(mat![[1.0]], Damping::Matrix(mat![[1.0]]), mat![[100.0]]).unwrap(),
        excitation: vec![Excitation {
            dof: 0,
            harmonic: 0,
            amplitude: 30.0,
            phase: 0.0,
            kind: ExcitationKind::Force,
        }],
        contacts: vec![to_ground(law)],
        output: vec![0],
    };
    let cubic = contact::Cubic::new(contact::CubicParameters { stiffness: 2000.0 }).unwrap();
    let solution = solve(&one(Arc::new(cubic)), &Settings::new(3), 1.0);
    assert_eq!(solution.status, Status::Converged);
    let w = solution.displacement[0][0].re;
    assert!((100.0 * w + 2000.0 * w.powi(3) - 30.0).abs() < 1e-10);
    let solution = solve(&one(elastic_coulomb(500.0, 1.0)), &Settings::new(3), 1.0);
    assert!((solution.displacement[0][0].re - 0.3).abs() < 1e-13);
}

/// The waveform is the solution: its harmonics are those of the result, its force is the law's.
#[test]
fn waveforms_carry_the_harmonics() {
    let plan = Plan::new(&scene_r(), &Settings::new(15)).unwrap();
    let solution = plan.solve(75.0, &mut plan.workspace());
    let wave = plan.waveform(&solution, 2048).unwrap();
    let samples = wave.phase.len();
    assert!(samples >= 2048);
    for (slot, &k) in plan.orders().iter().enumerate() {
        let harmonic = |signal: &[f64]| -> Complex64 {
            let sum: Complex64 = signal
                .iter()
                .zip(&wave.phase)
                .map(|(x, phase)| x * Complex64::cis(-(k as f64) * phase))
                .sum();
            sum * (2.0 / samples as f64)
        };
        let (w, f) = (harmonic(&wave.displacement[1]), harmonic(&wave.contacts[0].force));
        assert!((w - solution.displacement[1][slot]).norm() < 1e-16);
        // The solution's force comes from fewer samples of a force with kinks.
        assert!(
            (f - solution.contacts[0].force[slot]).norm() < 1e-2,
            "{k}: {f} {}",
            solution.contacts[0].force[slot]
        );
    }
    let peak = wave.contacts[0].force.iter().fold(0.0_f64, |top, f| top.max(f.abs()));
    assert!((peak - 6.705e6 * 2.232e-6).abs() < 1e-9);
}

/// A contact that could hold the vibration, but not together with a static load: no number is made up.
#[test]
fn a_held_contact_must_hold_at_every_instant() {
    let mut problem = paper_scene();
    problem.excitation[0].amplitude = 0.03;
    let mut preload = problem.excitation[0];
    (preload.harmonic, preload.amplitude) = (0, 1.0);
    problem.excitation.push(preload);
    for harmonics in [1, 3] {
        let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
        let mut workspace = plan.workspace();
        let mut solution = Solution::default();
        // Memory of a solved point must not shine through.
        let free = Plan::new(&paper_scene(), &Settings::new(harmonics)).unwrap();
        free.solve_into(75.0, &mut free.workspace(), &mut solution);
        plan.solve_into(75.0, &mut workspace, &mut solution);
        assert_eq!(solution.status, Status::Failed(FailureReason::HoldingLimit), "N = {harmonics}");
        assert!(solution.displacement.is_empty() && solution.contacts.is_empty());
    }
}
