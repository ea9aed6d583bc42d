//! Large structures and many contacts: dense against sparse matrices, and a structure as a whole against its parts.

#[path = "shared/strip.rs"]
mod strip;

use hbm::{Plan, Settings, Solution};
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
