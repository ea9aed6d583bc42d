//! Large structures and many contacts: dense against sparse matrices, and a structure as a whole against its parts.

#[path = "shared/strip.rs"]
mod strip;

use faer::linalg::solvers::Solve;
use hbm::{LinearSolver, Plan, Receptances, Settings, Solution, SweepOptions, sweep};
use num_complex::Complex64;

/// Relative l2 distance.
fn distance<'a>(
    a: impl IntoIterator<Item = &'a Complex64>,
    b: impl IntoIterator<Item = &'a Complex64>,
) -> f64 {
    let (mut difference, mut size) = (0.0, 0.0);
    for (a, b) in a.into_iter().zip(b) {
        difference += (a - b).norm_sqr();
        size += b.norm_sqr();
    }
    (difference / size).sqrt()
}

/// Displacements of outputs and contacts.
fn motion(solution: &Solution) -> Vec<&Complex64> {
    let contacts = solution.contacts.iter().flat_map(|c| &c.displacement);
    solution.displacement.iter().flatten().chain(contacts).collect()
}

#[test]
fn sparse_matrices_respond_like_dense_ones() {
    let (dofs, count) = (60, 12);
    let output: Vec<usize> = (0..dofs).collect();
    let dense = hbm::Problem { output: output.clone(), ..strip::dense(dofs, count) };
    let sparse = hbm::Problem { output, ..strip::sparse(dofs, count) };
    let settings = Settings::new(5);
    let (dense, sparse) = (Plan::new(&dense, &settings).unwrap(), Plan::direct(&sparse, &settings).unwrap());
    let (mut one, mut other) = (dense.workspace(), sparse.workspace());
    for hertz in [11.0, 37.0, 64.0, 150.0, 420.0] {
        let (free, free_too) = (
            dense.linear_response(hertz, &mut one).unwrap(),
            sparse.linear_response(hertz, &mut other).unwrap(),
        );
        let error = distance(free_too.iter().flatten(), free.iter().flatten());
        assert!(error < 1e-12, "{hertz} Hz: {error:e}");
        let (solved, solved_too) = (dense.solve(hertz, &mut one), sparse.solve(hertz, &mut other));
        assert!(solved.status.solved() && solved_too.status == solved.status);
        let error = distance(motion(&solved_too), motion(&solved));
        assert!(error < 1e-10, "{hertz} Hz: {error:e}");
    }
}

/// A body that nothing but its contacts holds: springs are lent for its mean.
#[test]
fn a_sparse_body_may_be_free() {
    let (dofs, count) = (30, 10);
    let settings = Settings::new(4);
    let push = |excitation: &mut Vec<hbm::Excitation>| {
        let first = excitation[0];
        excitation.push(hbm::Excitation { harmonic: 2, amplitude: 0.4, ..first });
    };
    let (mut dense, mut sparse) = (strip::dense(dofs, count), strip::sparse(dofs, count));
    push(&mut dense.excitation);
    push(&mut sparse.excitation);
    // One contact holds the mean.
    let spring = contact::Linear::new(contact::LinearParameters { stiffness: 2e5 }).unwrap();
    sparse.contacts[0].law = std::sync::Arc::new(spring);
    dense.contacts.clone_from(&sparse.contacts);
    // Without the springs of the support.
    let free = |stiffness: f64, i: usize, j: usize| {
        if i == j && i < 3 { stiffness - strip::SPRING } else { stiffness }
    };
    let stiffness = dense.model.stiffness();
    let freed = faer::Mat::from_fn(dofs, dofs, |i, j| free(stiffness[(i, j)], i, j));
    let damping = hbm::Damping::Rayleigh { mass: strip::DAMPING.0, stiffness: strip::DAMPING.1 };
    dense.model = hbm::Model::new(dense.model.mass().clone(), damping, freed).unwrap();
    for i in 0..3 {
        if let Some(own) = sparse.model.stiffness.get_mut(i, i) {
            *own = free(*own, i, i);
        }
    }
    let (dense, sparse) = (Plan::new(&dense, &settings).unwrap(), Plan::direct(&sparse, &settings).unwrap());
    let (mut one, mut other) = (dense.workspace(), sparse.workspace());
    for hertz in [25.0, 80.0] {
        assert!(sparse.linear_response(hertz, &mut other).is_none(), "the mean has no receptance");
        let (solved, solved_too) = (dense.solve(hertz, &mut one), sparse.solve(hertz, &mut other));
        assert!(solved.status.solved() && solved_too.status == solved.status, "{solved:?}");
        let error = distance(motion(&solved_too), motion(&solved));
        assert!(error < 1e-9, "{hertz} Hz: {error:e}");
    }
}

/// With modal damping there is nothing to factor.
#[test]
fn modal_damping_of_a_sparse_structure_is_refused() {
    let mut sparse = strip::sparse(30, 2);
    sparse.model.damping = hbm::SparseDamping::ModalRatio(0.01);
    let error = Plan::direct(&sparse, &Settings::new(3)).unwrap_err();
    assert!(error.place == "damping" && error.problem.contains("reduce"), "{error}");
}

/// The whole derivative factored, and GMRES: the same steps, so the same solutions.
#[test]
fn gmres_solves_what_a_factorisation_solves() {
    for (dofs, count, harmonics, excitation) in [(90, 30, 7, 1.0), (90, 30, 5, 5.0), (60, 60, 3, 5.0)] {
        let mut problem = strip::dense(dofs, count);
        problem.excitation.iter_mut().for_each(|e| e.amplitude *= excitation);
        if harmonics == 5 {
            // Even harmonics and a mean, and springs in between.
            problem.excitation[1].harmonic = 2;
            for contact in problem.contacts.iter_mut().step_by(4) {
                let cubic = contact::CubicParameters { stiffness: 1e13 };
                contact.law = std::sync::Arc::new(contact::Cubic::new(cubic).unwrap());
            }
        }
        let plan = |linear_solver| {
            let settings = Settings { linear_solver, ..Settings::new(harmonics) };
            Plan::new(&problem, &settings).unwrap()
        };
        let (dense, krylov) = (plan(LinearSolver::Dense), plan(LinearSolver::Krylov));
        assert!(krylov.facts().krylov && !dense.facts().krylov);
        let (mut one, mut other) = (dense.workspace(), krylov.workspace());
        let mut hard = 0;
        for hertz in strip::frequencies(6) {
            let (factored, iterated) = (dense.solve(hertz, &mut one), krylov.solve(hertz, &mut other));
            assert!(
                factored.status.solved() && iterated.status == factored.status,
                "{hertz} Hz: {factored:?}"
            );
            let error = distance(motion(&iterated), motion(&factored));
            assert!(error < 1e-9, "{dofs} dofs, {hertz} Hz: {error:e}");
            hard += usize::from(iterated.stats.iterations >= 2 * factored.stats.iterations + 10);
        }
        // Fallbacks would hide a solver that never converges. Steps by GMRES have no natural test, so that one point in a
        // row may need them where a factorisation does not.
        assert!(hard <= 1, "{hard} points");
    }
}

/// 64 oscillators beside each other answer as one of them alone, whose first harmonic has all its solutions found.
#[test]
fn uncoupled_oscillators_answer_as_one() {
    let alone = strip::single(1);
    let together = strip::single(64);
    let settings = Settings::new(7);
    let (alone, together) = (Plan::new(&alone, &settings).unwrap(), Plan::new(&together, &settings).unwrap());
    assert!(alone.facts().scalar_start && together.facts().krylov);
    assert_eq!(together.facts().receptances, Receptances::Modes);
    let (mut one, mut all) = (alone.workspace(), together.workspace());
    for hertz in [20.0, 60.0, 71.0, 90.0, 140.0] {
        let (truth, solution) = (alone.solve(hertz, &mut one), together.solve(hertz, &mut all));
        assert!(truth.status.solved() && solution.status == truth.status);
        for contact in &solution.contacts {
            let error = distance(&contact.displacement, &truth.contacts[0].displacement);
            assert!(error < 1e-10, "{hertz} Hz: {error:e}");
        }
    }
}

/// The forces of a law in time, of a motion given by its odd harmonics, with nothing of the balance: the element followed
/// through two periods in small steps.
fn jenkins(stiffness: f64, slip_force: f64, displacement: &[Complex64], samples: usize) -> Vec<f64> {
    let at = |j: usize| -> f64 {
        let tau = std::f64::consts::TAU * j as f64 / samples as f64;
        displacement.iter().enumerate().map(|(s, w)| (w * Complex64::cis((2 * s + 1) as f64 * tau)).re).sum()
    };
    let (mut force, mut before) = (0.0_f64, at(0));
    let mut forces = vec![0.0; samples];
    for j in 1..=2 * samples {
        let now = at(j);
        force = (force + stiffness * (now - before)).clamp(-slip_force, slip_force);
        before = now;
        forces[j % samples] = force;
    }
    forces
}

/// A strip with 100 contacts: the motion of every dof, from sparse solves with forces followed in time, is the motion that was
/// found.
#[test]
fn a_hundred_contacts_balance() {
    let (dofs, count, hertz, samples) = (150, 100, 37.0, 4096);
    let mut problem = strip::dense(dofs, count);
    problem.excitation.iter_mut().for_each(|e| e.amplitude *= 3.0);
    let plan = Plan::new(&problem, &Settings::new(7)).unwrap();
    assert!(plan.facts().krylov && plan.orders() == [1, 3, 5, 7]);
    let solution = plan.solve(hertz, &mut plan.workspace());
    assert!(solution.status.solved());
    let slipping = solution.contacts.iter().filter(|c| c.state == contact::ContactState::Mixed).count();
    assert!((20..80).contains(&slipping), "{slipping}");
    let omega = std::f64::consts::TAU * hertz;
    for (slot, &k) in plan.orders().iter().enumerate() {
        // H_k w = f − B F, assembled from the springs of the strip.
        let mut load = faer::Mat::<Complex64>::zeros(dofs, 1);
        for e in problem.excitation.iter().filter(|e| e.harmonic == k) {
            load[(e.dof, 0)] += Complex64::from_polar(e.amplitude, e.phase);
        }
        for (l, contact) in problem.contacts.iter().enumerate() {
            let (stiffness, slip_force) = strip::law(l);
            let forces = jenkins(stiffness, slip_force, &solution.contacts[l].displacement, samples);
            let wave = |j: usize| Complex64::cis(-((k * j) as f64) * std::f64::consts::TAU / samples as f64);
            let force: Complex64 =
                forces.iter().enumerate().map(|(j, f)| wave(j) * (f * 2.0 / samples as f64)).sum();
            load[(contact.first, 0)] -= force;
            if let Some(second) = contact.second {
                load[(second, 0)] += force;
            }
        }
        let w = strip::dynamic_stiffness(dofs, k as f64 * omega).sp_lu().unwrap().solve(&load);
        for (l, contact) in problem.contacts.iter().enumerate() {
            let u = w[(contact.first, 0)] - contact.second.map_or(Complex64::ZERO, |second| w[(second, 0)]);
            let found = solution.contacts[l].displacement[slot];
            let size = solution.contacts[l].displacement[0].norm();
            // What 4096 steps a period leave of the force.
            assert!((u - found).norm() < 2e-5 * size, "k = {k}, contact {l}: {u} for {found}");
        }
    }
}

#[test]
fn threads_do_not_matter_to_many_contacts() {
    let plan = Plan::new(&strip::dense(90, 40), &Settings::new(5)).unwrap();
    assert!(plan.facts().krylov);
    let frequencies = strip::frequencies(9);
    let on = |threads| {
        sweep(&plan, &frequencies, &SweepOptions { threads: Some(threads), ..Default::default() }).solutions
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
    // Nor does the order of the points.
    let mut workspace = plan.workspace();
    for (hertz, known) in frequencies.iter().zip(&one).rev() {
        assert_eq!(plan.solve(*hertz, &mut workspace), *known, "{hertz} Hz");
    }
}
