//! Friction under a normal load that the motion changes, in the balance: against scalar contacts, marching in time, and itself
//! seen from other axes, instants and threads.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{FrictionContact, FrictionContactParameters};
use faer::{Mat, c64};
use hbm::{
    Contact, Direction, Excitation, ExcitationKind, Joint, LinearSolver, Plan, Problem, Settings, Solution,
    Status,
};
use stickslip_tests::{elastic_coulomb, model};

const TANGENTIAL: f64 = 3e5;
const NORMAL: f64 = 4e5;
const FRICTION: f64 = 0.4;

fn friction(preload: Option<f64>, gap: Option<f64>, tangential: usize) -> Arc<FrictionContact> {
    let parameters = FrictionContactParameters {
        tangential_stiffness: TANGENTIAL,
        normal_stiffness: NORMAL,
        friction_coefficient: FRICTION,
        preload,
        gap,
    };
    Arc::new(FrictionContact::new(parameters, tangential).unwrap())
}

fn excitation(dof: usize, harmonic: usize, amplitude: f64, phase: f64) -> Excitation {
    Excitation { dof, harmonic, amplitude, phase, kind: ExcitationKind::Force }
}

/// Mass and stiffness of two bodies with dofs x, y, z each; z is normal, and coupled to the others.
fn bodies() -> [Mat<f64>; 3] {
    let mass = Mat::from_fn(6, 6, |i, j| if i == j { [1.0, 0.6][i / 3] } else { 0.0 });
    let diagonal = [4e5, 5e5, 9e5, 1.5e5, 1.2e5, 2e5];
    let mut stiffness = Mat::from_fn(6, 6, |i, j| if i == j { diagonal[i] } else { 0.0 });
    for (i, j, coupling) in [(0, 2, 6e4), (3, 5, 3e4), (4, 5, -2e4)] {
        stiffness[(i, j)] += coupling;
        stiffness[(j, i)] += coupling;
    }
    let damping = Mat::from_fn(6, 6, |i, j| 1e-5 * stiffness[(i, j)] + 8.0 * mass[(i, j)]);
    [mass, damping, stiffness]
}

/// The bodies, pressed together by a preload or with a gap between them, along axes turned by `turn` about z.
fn two_bodies(law: Arc<FrictionContact>, turn: f64, phase: f64) -> Problem {
    let [mass, damping, stiffness] = bodies();
    let along = |parts: &[(usize, f64)]| Direction {
        parts: parts.iter().flat_map(|&(dof, a)| [(dof, a), (dof + 3, -a)]).collect(),
    };
    let (c, s) = (turn.cos(), turn.sin());
    let normal = along(&[(2, 1.0)]);
    let directions = match contact::JointLaw::directions(&*law) {
        2 => vec![along(&[(0, 1.0)]), normal],
        _ => vec![along(&[(0, c), (1, s)]), along(&[(0, -s), (1, c)]), normal],
    };
    let shifted = |dof: usize, amplitude: f64, own: f64| excitation(dof, 1, amplitude, own + phase);
    Problem {
        model: model(mass, damping, stiffness),
        excitation: vec![shifted(3, 10.0, 0.0), shifted(5, 7.0, 0.6), shifted(4, 5.0, 1.9)],
        contacts: Vec::new(),
        joints: vec![Joint { name: "j".into(), directions, law, scale: 1.0 }],
        output: (0..6).collect(),
    }
}

fn solved(problem: &Problem, settings: &Settings, hertz: f64) -> Solution {
    let plan = Plan::new(problem, settings).unwrap();
    let solution = plan.solve(hertz, &mut plan.workspace());
    assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
    solution
}

/// Relative l2 distance of the displacement spectra, harmonics turned by k·`shift`.
fn distance(solution: &Solution, reference: &Solution, shift: f64) -> f64 {
    let (mut change, mut size) = (0.0, 0.0);
    for (row, expected) in solution.displacement.iter().zip(&reference.displacement) {
        for (k, expected) in expected.iter().enumerate() {
            let own = row.get(k).copied().unwrap_or_default();
            change += (own - expected * c64::cis(k as f64 * shift)).norm_sqr();
            size += expected.norm_sqr();
        }
    }
    (change / size).sqrt()
}

/// With a normal load that does not change, friction in one direction is the scalar elastic Coulomb contact, whose force is exact.
#[test]
fn a_constant_load_is_a_scalar_contact() {
    let mass = Mat::from_fn(3, 3, |i, j| if i == j { [3.98, 1.27, 1.0][i] } else { 0.0 });
    let damping = Mat::from_fn(3, 3, |i, j| if i == j { 24.0 } else { 0.0 });
    let stiffness =
        Mat::from_fn(3, 3, |i, j| [[8.2e5, -4.1e5, 0.0], [-4.1e5, 4.1e5, 0.0], [0.0, 0.0, 3e5]][i][j]);
    let part = |dof| Direction { parts: vec![(dof, 1.0)] };
    let joint = Joint {
        name: "j".into(),
        directions: vec![part(0), part(2)],
        law: friction(Some(6.0), None, 1),
        scale: 1.5,
    };
    let mut joined = Problem {
        model: model(mass, damping, stiffness),
        excitation: vec![excitation(1, 1, 9.1, 0.0)],
        contacts: Vec::new(),
        joints: vec![joint],
        output: vec![0, 1],
    };
    let law = elastic_coulomb(TANGENTIAL, FRICTION * 6.0);
    let contact = Contact { name: "c".into(), first: 0, second: None, law, scale: 1.5 };
    let mut scalar = joined.clone();
    scalar.joints.clear();
    scalar.contacts.push(contact);
    let exact = Settings { slaving: false, ..Settings::new(7) };
    let mut sticking = 0;
    for (hertz, push) in [(30.0, 9.1), (52.0, 9.1), (75.0, 9.1), (120.0, 9.1), (20.0, 0.5), (75.0, 0.5)] {
        (joined.excitation[0].amplitude, scalar.excitation[0].amplitude) = (push, push);
        let scalar = solved(&scalar, &exact, hertz);
        let errors = [512, 4096].map(|samples| {
            let joined = solved(&joined, &Settings { samples: Some(samples), ..exact.clone() }, hertz);
            let (own, expected) = (&joined.joints[0], &scalar.contacts[0]);
            assert!((own.dissipation - expected.dissipation).abs() <= 1e-3 * expected.dissipation + 1e-15);
            assert_eq!((own.state, own.apart), (expected.state, 0.0));
            // Springs do no work, not even by rounding.
            assert!(own.state != contact::ContactState::Stick || own.dissipation == 0.0);
            let mut worst = 0.0_f64;
            for (row, expected) in joined.displacement.iter().zip(&scalar.displacement) {
                for (k, w) in row.iter().enumerate() {
                    // Odd harmonics only.
                    let known = if k % 2 == 1 { expected[k / 2] } else { c64::ZERO };
                    worst = worst.max((w - known).norm() / expected[0].norm());
                }
            }
            worst
        });
        // Between samples the displacement is taken as linear: the error falls with their square.
        let sticks = scalar.contacts[0].state == contact::ContactState::Stick;
        sticking += usize::from(sticks);
        let falls = errors[0] < 6e-5 && errors[1] < 1e-6;
        assert!(if sticks { errors[0] < 1e-11 } else { falls }, "{hertz} Hz, {push} N: {errors:?}");
    }
    assert_eq!(sticking, 2);
}

/// W_1 of every dof after periods of marching by Verlet's method with small steps from the motion of `solution`.
fn marched(problem: &Problem, solution: &Solution, preload: f64, gap: f64) -> Vec<c64> {
    const STEPS: usize = 3000;
    const PERIODS: usize = 25;
    let [mass, damping, stiffness] = bodies()
        .map(|matrix| -> [[f64; 6]; 6] { std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)])) });
    let omega = TAU * solution.frequency;
    let h = TAU / (omega * STEPS as f64);
    let start = |order: i32, tau: f64| -> [f64; 6] {
        let row = |dof: usize| solution.displacement[dof].iter().enumerate();
        let wave = |k: usize| c64::new(0.0, k as f64 * omega).powi(order) * c64::cis(k as f64 * tau);
        std::array::from_fn(|dof| row(dof).map(|(k, w)| (w * wave(k)).re).sum())
    };
    let mut load: [(f64, f64); 6] = [(0.0, 0.0); 6];
    for e in &problem.excitation {
        load[e.dof] = (e.amplitude, e.phase);
    }
    let (mut w, mut v, mut slider) = (start(0, 0.0), start(1, -0.5 * omega * h), 0.0);
    let mut first = vec![c64::ZERO; 6];
    for step in 0..PERIODS * STEPS {
        let tau = TAU * (step % STEPS) as f64 / STEPS as f64;
        if step >= (PERIODS - 1) * STEPS {
            for (first, w) in first.iter_mut().zip(w) {
                *first += c64::cis(-tau) * (2.0 * w / STEPS as f64);
            }
        }
        let (along, approach) = (w[0] - w[3], w[2] - w[5]);
        let pressure = (preload + NORMAL * (approach - gap)).max(0.0);
        let reach = FRICTION * pressure / TANGENTIAL;
        slider = f64::clamp(slider, along - reach, along + reach);
        let (rubbing, pressing) = (TANGENTIAL * (along - slider), pressure - preload);
        let contact = [rubbing, 0.0, pressing, -rubbing, 0.0, -pressing];
        let mut kick = [0.0; 6];
        for i in 0..6 {
            let mut force = load[i].0 * (tau + load[i].1).cos() - contact[i];
            for j in 0..6 {
                force -= stiffness[i][j] * w[j] + damping[i][j] * v[j];
            }
            kick[i] = h * force / mass[i][i];
        }
        for i in 0..6 {
            v[i] += kick[i];
            w[i] += h * v[i];
        }
    }
    first
}

/// Marching on in time stays there, with a preload and with a gap, where the bodies part and meet again.
#[test]
fn marching_in_time_agrees() {
    for (preload, gap, hertz) in
        [(Some(4.0), None, 66.0), (None, Some(1e-5), 66.0), (None, Some(-2e-5), 120.0)]
    {
        let problem = two_bodies(friction(preload, gap, 1), 0.0, 0.0);
        let solution = solved(&problem, &Settings::new(31), hertz);
        let marched = marched(&problem, &solution, preload.unwrap_or(0.0), gap.unwrap_or(0.0));
        let size = marched.iter().map(|w| w.norm()).fold(0.0, f64::max);
        for (row, expected) in solution.displacement.iter().zip(&marched) {
            let error = (row[1] - expected).norm() / size;
            assert!(error < 1e-3, "{preload:?} {gap:?}: {error:e}");
        }
        let apart = solution.joints[0].apart;
        assert!(apart > 0.05 && apart < 0.95, "{preload:?} {gap:?}: {apart}");
    }
}

/// Friction in a plane knows no axes.
#[test]
fn turned_axes_change_nothing() {
    let settings = Settings::new(5);
    for hertz in [60.0, 95.0, 130.0] {
        let straight = solved(&two_bodies(friction(Some(8.0), None, 2), 0.0, 0.0), &settings, hertz);
        for turn in [0.3, 1.1, 2.5] {
            let turned = solved(&two_bodies(friction(Some(8.0), None, 2), turn, 0.0), &settings, hertz);
            let error = distance(&turned, &straight, 0.0);
            assert!(error < 1e-9, "{hertz} Hz, turned by {turn}: {error:e}");
            let (own, expected) = (turned.joints[0].dissipation, straight.joints[0].dissipation);
            assert!((own / expected - 1.0).abs() < 1e-8);
        }
    }
}

/// A later excitation by a whole number of samples gives the same motion later, and any other delay to sampling error.
#[test]
fn a_delay_of_the_excitation_delays_the_motion() {
    let settings = Settings { samples: Some(1024), ..Settings::new(7) };
    for tangential in [1, 2] {
        let at = |phase: f64| {
            solved(&two_bodies(friction(Some(8.0), None, tangential), 0.2, phase), &settings, 95.0)
        };
        let reference = at(0.0);
        for (samples, tolerance) in [(1.0, 1e-9), (300.0, 1e-9), (700.5, 3e-5)] {
            let shift = TAU * samples / 1024.0;
            let error = distance(&at(shift), &reference, shift);
            assert!(error < tolerance, "{tangential} directions, {samples} samples: {error:e}");
        }
    }
}

/// Through the resonances every point has a solution for every N, and the same from any number of threads.
#[test]
fn every_point_of_a_sweep_is_solved() {
    let frequencies: Vec<f64> = (0..22).map(|i| 30.0 + 8.0 * i as f64).collect();
    for (preload, gap) in [(Some(10.0), None), (Some(0.0), None), (None, Some(1e-5)), (None, Some(-2e-5))] {
        let problem = two_bodies(friction(preload, gap, 1), 0.0, 0.0);
        for harmonics in [1, 3, 7, 15] {
            let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
            let sweep = |threads| {
                let options = hbm::SweepOptions { threads: Some(threads), ..Default::default() };
                hbm::sweep(&plan, &frequencies, &options).solutions
            };
            let solutions = sweep(2);
            for solution in &solutions {
                assert!(
                    solution.status.solved(),
                    "{preload:?} {gap:?}, N = {harmonics}, {} Hz",
                    solution.frequency
                );
                assert!(solution.joints[0].dissipation > -1e-9);
            }
            let parted = solutions.iter().filter(|s| s.joints[0].apart > 0.0).count();
            assert!(parted > 9, "{parted} points with lift-off");
            if harmonics == 3 {
                assert_eq!(solutions, sweep(1));
            }
        }
    }
}

/// Errors fall with N and with the samples, and estimates tell their size.
#[test]
fn errors_fall_with_harmonics_and_samples() {
    let problem = two_bodies(friction(Some(10.0), None, 1), 0.0, 0.0);
    for hertz in [66.0, 90.0, 140.0] {
        let with = |harmonics: usize, samples: usize| Settings {
            samples: Some(samples),
            slaving: false,
            ..Settings::new(harmonics)
        };
        let reference = solved(&problem, &with(63, 4096), hertz);
        let errors: Vec<f64> = [3, 7, 15, 31]
            .map(|n| distance(&solved(&problem, &with(n, 4096), hertz), &reference, 0.0))
            .to_vec();
        assert!(errors.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{hertz} Hz: {errors:?}");
        // Two bends of the force and the mass behind them: (N + 1)^-3.5 or nearly so.
        assert!(errors[3] < 0.02 * errors[0] && errors[3] < 1e-3, "{hertz} Hz: {errors:?}");
        let fine = solved(&problem, &with(7, 8192), hertz);
        let coarse: Vec<f64> =
            [128, 512, 2048].map(|m| distance(&solved(&problem, &with(7, m), hertz), &fine, 0.0)).to_vec();
        assert!(coarse[2] < 0.05 * coarse[0], "{hertz} Hz: {coarse:?}");
        // By events there is nothing to sample.
        let exact = solved(&problem, &Settings { estimate: true, ..Settings::new(7) }, hertz);
        assert_eq!(exact.sampling_error, Some(0.0));
        assert!(distance(&exact, &fine, 0.0) < 1e-6);
        let estimated = solved(&problem, &Settings { estimate: true, ..with(7, 256) }, hertz);
        let (estimate, error) = (estimated.truncation_error.unwrap(), errors[1]);
        assert!(estimate > 0.5 * error && estimate < 50.0 * error, "{hertz} Hz: {estimate:e} for {error:e}");
        let adaptive = Settings { truncation: Some(3e-3), ..Settings::new(31) };
        let adapted = solved(&problem, &adaptive, hertz);
        assert!(adapted.harmonics < 31 && adapted.truncation_error.unwrap() <= 3e-3);
        assert!(distance(&adapted, &reference, 0.0) < 3e-3, "{hertz} Hz, N = {}", adapted.harmonics);
        let (estimate, error) = (estimated.sampling_error.unwrap(), distance(&estimated, &fine, 0.0));
        assert!(estimate > 0.3 * error && estimate < 100.0 * error, "{hertz} Hz: {estimate:e} for {error:e}");
    }
}

/// Twenty joints side by side between two rows of masses: by GMRES and by a factorisation alike.
#[test]
fn many_joints() {
    let n = 20;
    let dofs = 4 * n;
    // x and z of the masses of both rows.
    let at = |row: usize, i: usize, axis: usize| (row * n + i) * 2 + axis;
    let mass = Mat::from_fn(dofs, dofs, |i, j| if i == j { 0.5 } else { 0.0 });
    let mut stiffness = Mat::from_fn(dofs, dofs, |i, j| if i == j { 6e4 } else { 0.0 });
    for (row, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        for i in 1..n {
            let (a, b) = (at(row, i - 1, axis), at(row, i, axis));
            for (r, c, k) in [(a, a, 2e5), (b, b, 2e5), (a, b, -2e5), (b, a, -2e5)] {
                stiffness[(r, c)] += k;
            }
        }
    }
    let damping = Mat::from_fn(dofs, dofs, |i, j| 2e-5 * stiffness[(i, j)] + 10.0 * mass[(i, j)]);
    let joints = (0..n).map(|i| {
        let direction = |axis| Direction { parts: vec![(at(0, i, axis), 1.0), (at(1, i, axis), -1.0)] };
        Joint {
            name: format!("joint {i}"),
            directions: vec![direction(0), direction(1)],
            law: friction(Some(4.0), None, 1),
            scale: 1.0,
        }
    });
    let entries = |matrix: &Mat<f64>| {
        let all = (0..dofs).flat_map(|i| (0..dofs).map(move |j| (i, j)));
        let filled = all.filter(|&(i, j)| matrix[(i, j)] != 0.0);
        let triplets: Vec<_> =
            filled.map(|(i, j)| faer::sparse::Triplet::new(i, j, matrix[(i, j)])).collect();
        faer::sparse::SparseColMat::try_new_from_triplets(dofs, dofs, &triplets).unwrap()
    };
    let whole = hbm::SparseModel {
        mass: entries(&mass),
        damping: hbm::SparseDamping::Matrix(entries(&damping)),
        stiffness: entries(&stiffness),
    };
    let problem = Problem {
        model: model(mass, damping, stiffness),
        excitation: vec![excitation(at(1, 3, 0), 1, 60.0, 0.0), excitation(at(1, 12, 1), 1, 40.0, 1.0)],
        contacts: Vec::new(),
        joints: joints.collect(),
        output: vec![0, 3, at(1, 12, 1)],
    };
    let settings = |linear_solver| Settings { linear_solver, ..Settings::new(3) };
    let plan = Plan::new(&problem, &settings(LinearSolver::Auto)).unwrap();
    assert!(plan.facts().krylov && plan.facts().joints == 20);
    assert_eq!(plan.facts().receptances, hbm::Receptances::Modes);
    let sparse = Problem {
        model: whole,
        excitation: problem.excitation.clone(),
        contacts: Vec::new(),
        joints: problem.joints.clone(),
        output: problem.output.clone(),
    };
    for hertz in [60.0, 64.0] {
        let solution = plan.solve(hertz, &mut plan.workspace());
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        let dense = solved(&problem, &settings(LinearSolver::Dense), hertz);
        assert!(distance(&solution, &dense, 0.0) < 1e-8);
        // Not by modes either.
        let direct = Plan::direct(&sparse, &settings(LinearSolver::Auto)).unwrap();
        let direct = direct.solve(hertz, &mut direct.workspace());
        assert!(distance(&solution, &direct, 0.0) < 1e-8);
        let moving = |s: &&hbm::JointSolution| s.state != contact::ContactState::Stick;
        assert!(solution.joints.iter().filter(moving).count() > 5);
    }
}

/// Excited by its second harmonic alone, a point at half the frequency is the same motion twice a period.
#[test]
fn a_shorter_period_is_found() {
    let problem = two_bodies(friction(Some(4.0), None, 1), 0.0, 0.0);
    let mut doubled = problem.clone();
    for excitation in &mut doubled.excitation {
        excitation.harmonic = 2;
    }
    let (plan, twice) =
        (Plan::new(&problem, &Settings::new(5)).unwrap(), Plan::new(&doubled, &Settings::new(10)).unwrap());
    assert_eq!(twice.orders(), [0, 2, 4, 6, 8, 10]);
    let once = plan.solve(66.0, &mut plan.workspace());
    let solution = twice.solve(33.0, &mut twice.workspace());
    assert_eq!(solution.displacement, once.displacement);
    let (own, expected) = (&solution.joints[0], &once.joints[0]);
    assert_eq!((&own.directions, own.apart), (&expected.directions, expected.apart));
    assert!((own.dissipation / expected.dissipation - 2.0).abs() < 1e-14 && own.dissipation > 1e-6);
    // The law's own force at every instant: never a pull, and no friction without pressure.
    let wave = twice.waveform(&solution, 512).unwrap();
    let [along, normal] = &wave.joints[0].force[..] else { panic!("two directions") };
    for (j, (f, n)) in along.iter().zip(normal).enumerate() {
        let pressure = 4.0 - n;
        assert!(pressure >= -1e-12 && f.abs() <= FRICTION * pressure + 1e-9, "{j}: {f} under {pressure}");
        assert!((f - along[(j + along.len() / 2) % along.len()]).abs() < 1e-12);
    }
}

/// Without any excitation a preloaded joint rests; bodies that interfere are pushed apart, as far as the stiffness of all says.
#[test]
fn what_rests_and_what_pushes() {
    let mut rests = two_bodies(friction(Some(8.0), None, 2), 0.0, 0.0);
    rests.excitation.clear();
    let solution = solved(&rests, &Settings::new(3), 50.0);
    assert!(solution.displacement.iter().flatten().all(|w| *w == c64::ZERO));
    let zero = |d: &hbm::DirectionSolution| d.amplitude == 0.0 && d.force.iter().all(|f| f.norm() == 0.0);
    assert!(solution.joints[0].directions.iter().all(zero));

    let interference = 3e-5;
    let mut pushed = two_bodies(friction(None, Some(-interference), 1), 0.0, 0.0);
    pushed.excitation.clear();
    // Frictionless in the end: (C + B k_n Bᵀ) w = −B k_n · interference.
    let [_, _, mut stiffness] = bodies();
    for (i, j, sign) in [(2, 2, 1.0), (5, 5, 1.0), (2, 5, -1.0), (5, 2, -1.0)] {
        stiffness[(i, j)] += sign * NORMAL;
    }
    let mut exact = Mat::zeros(6, 1);
    (exact[(2, 0)], exact[(5, 0)]) = (-NORMAL * interference, NORMAL * interference);
    faer::linalg::solvers::Solve::solve_in_place(&stiffness.partial_piv_lu(), exact.as_mut());
    let solution = solved(&pushed, &Settings::new(3), 50.0);
    for (dof, row) in solution.displacement.iter().enumerate() {
        assert_eq!(row.len(), 1, "nothing moves but the mean");
        assert!(
            (row[0].re - exact[(dof, 0)]).abs() < 1e-12 * interference,
            "{dof}: {} for {}",
            row[0],
            exact[(dof, 0)]
        );
    }
    // A joint that slides its bodies elsewhere by a static load as well.
    pushed.excitation.push(excitation(3, 0, 5.0, 0.0));
    let solution = solved(&pushed, &Settings::new(3), 50.0);
    let [along, normal] = &solution.joints[0].directions[..] else { panic!("two directions") };
    assert!(along.force[0].norm() < 1e-12 && normal.force[0].re < 0.0);
}

/// Once buffers have grown, a point allocates nothing.
#[test]
fn no_allocation_per_point() {
    for tangential in [1, 2] {
        let problem = two_bodies(friction(Some(10.0), None, tangential), 0.0, 0.0);
        let plan = Plan::new(&problem, &Settings::new(7)).unwrap();
        let mut workspace = plan.workspace();
        let mut solution = Solution::default();
        let mut all = || {
            for hertz in [40.0, 60.0, 64.0, 150.0] {
                plan.solve_into(hertz, &mut workspace, &mut solution);
                assert_eq!(solution.stats.secant_homotopies, 0, "{hertz} Hz: not an easy point");
            }
        };
        all();
        let counted = allocation_counter::measure(all);
        assert_eq!(counted.count_total, 0);
    }
}

/// At small amplitudes the nonlinear mode is that of the stuck structure; with more it is softer and damped.
#[test]
fn a_mode_begins_stuck() {
    let [mass, _, mut stiffness] = bodies();
    let undamped = model(mass.clone(), Mat::zeros(6, 6), stiffness.clone());
    for (axis, k) in [(0, TANGENTIAL), (2, NORMAL)] {
        for (i, j, sign) in [(0, 0, 1.0), (3, 3, 1.0), (0, 3, -1.0), (3, 0, -1.0)] {
            stiffness[(i + axis, j + axis)] += sign * k;
        }
    }
    let stuck = model(mass, Mat::zeros(6, 6), stiffness).natural_frequencies();
    let mut problem = two_bodies(friction(Some(10.0), None, 1), 0.0, 0.0);
    problem.model = undamped;
    let options = hbm::ModeOptions {
        mode: 1,
        origin: hbm::Origin::Stuck,
        reference: 3,
        amplitudes: (1e-7, 3e-4),
        points: 12,
        progress: &|_| true,
    };
    let mode = hbm::nonlinear_mode(&problem, &Settings::new(5), &options).unwrap();
    assert_eq!(mode.end, hbm::ModeEnd::Reached);
    let (first, last) = (mode.points.first().unwrap(), mode.points.last().unwrap());
    assert!((first.frequency / stuck[1] - 1.0).abs() < 1e-9, "{} for {}", first.frequency, stuck[1]);
    assert!(first.damping_ratio.abs() < 1e-9);
    assert!(
        last.frequency < 0.99 * stuck[1] && last.damping_ratio > 0.005,
        "{} Hz, {}",
        last.frequency,
        last.damping_ratio
    );
}
