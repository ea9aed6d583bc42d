//! Reduction of large structures, measured against closed forms and dense matrices.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use faer::Mat;
use faer::prelude::Solve as _;
use faer::sparse::{SparseColMat, Triplet};
use structure::{
    Damping, ModeCount, Model, Progress, Reduction, ReductionError, ReductionOptions, SparseDamping,
    SparseModel, reduce,
};

/// A structure of springs and point masses, one dof a mass.
struct Springs {
    masses: Vec<f64>,
    /// First, second (or the ground), N/m.
    springs: Vec<(usize, Option<usize>, f64)>,
}

impl Springs {
    /// `n` masses of 1 kg in a row on springs of 1e6 N/m, the first one tied to the ground.
    fn chain(n: usize) -> Self {
        let mut springs = vec![(0, None, 1e6)];
        springs.extend((1..n).map(|i| (i, Some(i - 1), 1e6)));
        Self { masses: vec![1.0; n], springs }
    }

    /// A square membrane of `n` × `n` masses of 1 kg, springs of 1e6 N/m, fixed all around.
    fn membrane(n: usize) -> Self {
        let at = |i: usize, j: usize| i * n + j;
        let mut springs = Vec::new();
        for i in 0..n {
            for j in 0..n {
                springs.push((at(i, j), (i > 0).then(|| at(i.wrapping_sub(1), j)), 1e6));
                springs.push((at(i, j), (j > 0).then(|| at(i, j.wrapping_sub(1))), 1e6));
            }
            springs.push((at(n - 1, i), None, 1e6));
            springs.push((at(i, n - 1), None, 1e6));
        }
        Self { masses: vec![1.0; n * n], springs }
    }

    fn matrices(&self) -> (SparseColMat<usize, f64>, SparseColMat<usize, f64>) {
        let n = self.masses.len();
        let mass: Vec<_> = self.masses.iter().enumerate().map(|(i, &m)| Triplet::new(i, i, m)).collect();
        let mut stiffness = Vec::new();
        for &(first, second, k) in &self.springs {
            stiffness.push(Triplet::new(first, first, k));
            if let Some(second) = second {
                stiffness.push(Triplet::new(second, second, k));
                stiffness.push(Triplet::new(first, second, -k));
                stiffness.push(Triplet::new(second, first, -k));
            }
        }
        let sparse = |triplets: &[_]| SparseColMat::try_new_from_triplets(n, n, triplets).unwrap();
        (sparse(&mass), sparse(&stiffness))
    }

    fn model(&self, damping: SparseDamping) -> SparseModel {
        let (mass, stiffness) = self.matrices();
        SparseModel { mass, damping, stiffness }
    }
}

const UNDAMPED: SparseDamping = SparseDamping::Rayleigh { mass: 0.0, stiffness: 0.0 };

fn run(model: &SparseModel, keep: &[usize], modes: ModeCount, band: (f64, f64)) -> Reduction {
    let options = ReductionOptions { modes, lowest: band.0, highest: band.1 };
    reduce(model, keep, &[], &options, &mut |_| {}).unwrap()
}

/// (C − ω²M)⁻¹ between kept dofs, from dense matrices.
fn receptance(mass: &Mat<f64>, stiffness: &Mat<f64>, keep: &[usize], hz: f64) -> Mat<f64> {
    let (n, square) = (mass.nrows(), (TAU * hz).powi(2));
    let dynamic = Mat::from_fn(n, n, |i, j| stiffness[(i, j)] - square * mass[(i, j)]);
    let loads = Mat::from_fn(n, keep.len(), |i, j| if i == keep[j] { 1.0 } else { 0.0 });
    let answer = dynamic.partial_piv_lu().solve(&loads);
    Mat::from_fn(keep.len(), keep.len(), |i, j| answer[(keep[i], j)])
}

fn error(model: &SparseModel, keep: &[usize], reduction: &Reduction, hz: f64) -> f64 {
    let full = receptance(&model.mass.to_dense(), &model.stiffness.to_dense(), keep, hz);
    let first: Vec<usize> = (0..keep.len()).collect();
    let reduced = receptance(reduction.model.mass(), reduction.model.stiffness(), &first, hz);
    (&full - &reduced).norm_l2() / full.norm_l2()
}

#[test]
fn a_chain_with_its_end_held_has_the_frequencies_of_the_closed_form() {
    // Masses 0 … n−2 between the ground and the held mass: ω_k = 2 √(k/m) sin(kπ/(2n)).
    let n = 400;
    let reduction = run(&Springs::chain(n).model(UNDAMPED), &[n - 1], ModeCount::Exactly(30), (0.0, 10.0));
    assert_eq!(reduction.modes, 30);
    for (k, hz) in reduction.fixed_frequencies.iter().enumerate() {
        let exact = 2.0 * 1e3 * ((k + 1) as f64 * PI / (2 * n) as f64).sin() / TAU;
        assert!((hz / exact - 1.0).abs() < 1e-9, "{k}: {hz} instead of {exact}");
    }
}

#[test]
fn repeated_frequencies_of_a_square_membrane_are_all_found() {
    let n = 24;
    let springs = Springs::membrane(n);
    let mut exact = Vec::new();
    for p in 1..=n {
        for q in 1..=n {
            let part = |p: usize| (p as f64 * PI / (2 * (n + 1)) as f64).sin().powi(2);
            exact.push(2.0 * 1e3 * (part(p) + part(q)).sqrt() / TAU);
        }
    }
    exact.sort_by(f64::total_cmp);
    // Nothing is kept: the modes are those of the whole membrane.
    let reduction = run(&springs.model(UNDAMPED), &[], ModeCount::Exactly(120), (0.0, 100.0));
    for (k, hz) in reduction.fixed_frequencies.iter().enumerate() {
        assert!((hz / exact[k] - 1.0).abs() < 1e-9, "{k}: {hz} instead of {}", exact[k]);
    }
    let automatic =
        run(&springs.model(UNDAMPED), &[], ModeCount::Automatic { tolerance: 1e-3 }, (0.0, 100.0));
    assert_eq!(automatic.modes, exact.iter().filter(|hz| **hz < 150.0).count());
    assert_eq!(automatic.error, None);
}

#[test]
fn with_all_modes_the_reduced_structure_is_the_full_one() {
    let model = Springs::membrane(9).model(UNDAMPED);
    let keep = [40, 3, 71];
    let reduction = run(&model, &keep, ModeCount::Exactly(1000), (0.0, 300.0));
    assert_eq!(reduction.modes, 78);
    for hz in [0.0, 70.0, 123.0, 300.0] {
        let error = error(&model, &keep, &reduction, hz);
        assert!(error < 1e-10, "{hz} Hz: {error:e}");
    }
}

#[test]
fn the_static_response_is_exact_with_any_number_of_modes() {
    let model = Springs::membrane(12).model(UNDAMPED);
    let keep = [66, 4, 130];
    for modes in [0, 1, 7] {
        let reduction = run(&model, &keep, ModeCount::Exactly(modes), (0.0, 100.0));
        let error = error(&model, &keep, &reduction, 0.0);
        assert!(error < 1e-12, "{modes} modes: {error:e}");
    }
}

#[test]
fn the_error_falls_with_the_number_of_modes_and_is_what_dense_matrices_say() {
    let model = Springs::membrane(14).model(UNDAMPED);
    let keep = [90, 17];
    let mut last = f64::INFINITY;
    for modes in [4, 12, 36, 100] {
        let reduction = run(&model, &keep, ModeCount::Exactly(modes), (20.0, 100.0));
        let estimate = reduction.error.unwrap();
        for &(hz, claimed) in &reduction.checked_at {
            let exact = error(&model, &keep, &reduction, hz);
            assert!(
                claimed > 0.3 * exact && claimed < 3.0 * exact,
                "{modes}, {hz} Hz: {claimed:e} for {exact:e}"
            );
        }
        assert!(estimate < 0.5 * last, "{modes}: {estimate:e} after {last:e}");
        last = estimate;
    }
}

#[test]
fn as_many_modes_are_added_as_the_tolerance_needs() {
    let model = Springs::membrane(20).model(UNDAMPED);
    let keep = [90, 17, 222];
    let mut modes = 0;
    for tolerance in [5e-2, 1e-2, 2e-3] {
        let reduction = run(&model, &keep, ModeCount::Automatic { tolerance }, (10.0, 80.0));
        assert!(reduction.error.unwrap() <= tolerance);
        assert!(reduction.modes >= modes && reduction.modes < 397, "{tolerance}: {}", reduction.modes);
        // Between the frequencies of the check as well.
        for hz in [12.3, 33.0, 61.7] {
            let error = error(&model, &keep, &reduction, hz);
            assert!(error <= tolerance, "{tolerance}, {hz} Hz: {error:e}");
        }
        modes = reduction.modes;
    }
    // What cannot be reached is reported, and ends with all modes.
    let reduction = run(&model, &keep, ModeCount::Automatic { tolerance: 1e-18 }, (10.0, 80.0));
    assert!(reduction.error.unwrap() > 1e-18);
}

#[test]
fn a_floating_structure_keeps_its_rigid_body_motion() {
    // A free chain of which nothing is kept: ω_k = 2 √(k/m) sin(kπ/(2n)), k = 0, 1, …
    let n = 60;
    let mut springs = Springs::chain(n);
    springs.springs.remove(0);
    let model = springs.model(UNDAMPED);
    let alone = run(&model, &[], ModeCount::Exactly(10), (0.0, 50.0));
    assert!(alone.shift < 0.0);
    assert!(alone.fixed_frequencies[0] < 1e-4, "{}", alone.fixed_frequencies[0]);
    for (k, hz) in alone.fixed_frequencies.iter().enumerate().skip(1) {
        let exact = 2.0 * 1e3 * (k as f64 * PI / (2 * n) as f64).sin() / TAU;
        assert!((hz / exact - 1.0).abs() < 1e-9, "{k}: {hz} instead of {exact}");
    }
    // Two free chains, only one of which has a kept dof: the other floats inside.
    let mut two = Springs::chain(n);
    two.springs.remove(0);
    two.springs.remove(n / 2 - 1);
    let model = two.model(UNDAMPED);
    let reduction = run(&model, &[3], ModeCount::Automatic { tolerance: 1e-3 }, (1.0, 50.0));
    assert!(reduction.shift < 0.0 && reduction.error.unwrap() < 1e-3);
    assert!(error(&model, &[3], &reduction, 23.0) < 1e-3);
    // Held by its kept dof, a free chain is not floating.
    springs.masses[0] = 2.0;
    let held = run(&springs.model(UNDAMPED), &[0], ModeCount::Exactly(3), (0.0, 50.0));
    assert_eq!(held.shift, 0.0);
}

#[test]
fn massless_dofs_have_no_modes_but_stay_in_the_response() {
    let mut springs = Springs::membrane(8);
    for dof in (0..64).filter(|dof| dof % 3 == 0) {
        springs.masses[dof] = 0.0;
    }
    let model = springs.model(UNDAMPED);
    let keep = [20, 33];
    let reduction = run(&model, &keep, ModeCount::Exactly(1000), (0.0, 100.0));
    let massive = (0..64).filter(|dof| !keep.contains(dof) && dof % 3 != 0).count();
    assert_eq!(reduction.modes, massive);
    for hz in [0.0, 77.0, 200.0] {
        assert!(error(&model, &keep, &reduction, hz) < 1e-10);
    }
}

#[test]
fn kept_dofs_come_in_their_order_and_need_no_inner_ones() {
    let springs = Springs::membrane(3);
    let (mass, stiffness) = springs.matrices();
    let keep = [8, 0, 4, 2, 1, 3, 7, 6, 5];
    let model = springs.model(SparseDamping::ModalRatio(0.01));
    let options =
        ReductionOptions { modes: ModeCount::Automatic { tolerance: 1e-3 }, lowest: 0.0, highest: 100.0 };
    let motion: Vec<f64> = (0..9).map(f64::from).collect();
    let reduction = reduce(&model, &keep, &[motion], &options, &mut |_| {}).unwrap();
    assert_eq!((reduction.modes, reduction.error), (0, None));
    let direct = Model::new(mass.to_dense(), Damping::ModalRatio(0.01), stiffness.to_dense()).unwrap();
    for (i, &row) in keep.iter().enumerate() {
        assert_eq!(reduction.model.base_loads()[0][i], row as f64);
        for (j, &column) in keep.iter().enumerate() {
            assert_eq!(reduction.model.stiffness()[(i, j)], stiffness.to_dense()[(row, column)]);
            let damping = direct.damping()[(row, column)];
            assert!((reduction.model.damping()[(i, j)] - damping).abs() < 1e-9);
        }
    }
}

/// (C − ω²M + iωD)⁻¹ f, from dense matrices.
fn response(model: &Model, loads: &[f64], hz: f64) -> Vec<faer::c64> {
    let (n, omega) = (model.dofs(), TAU * hz);
    let dynamic = Mat::from_fn(n, n, |i, j| {
        let elastic = model.stiffness()[(i, j)] - omega * omega * model.mass()[(i, j)];
        faer::c64::new(elastic, omega * model.damping()[(i, j)])
    });
    let loads = Mat::from_fn(n, 1, |i, _| faer::c64::new(loads[i], 0.0));
    dynamic.partial_piv_lu().solve(&loads).col(0).iter().copied().collect()
}

#[test]
fn damping_and_base_motions_are_reduced_with_the_structure() {
    let springs = Springs::membrane(10);
    let n = springs.masses.len();
    // A gyroscopic and a strong local damper: not symmetric, not light, and inside.
    let dampers = |strength: f64| {
        let matrix =
            [(44, 44, strength), (12, 13, 30.0), (13, 12, -30.0)].map(|(i, j, d)| Triplet::new(i, j, d));
        SparseDamping::Matrix(SparseColMat::try_new_from_triplets(n, n, &matrix).unwrap())
    };
    let motion: Vec<f64> = (0..n).map(|i| 1.0 + (i % 10) as f64).collect();
    let keep = [37, 81];
    for (damping, tolerance) in [
        (SparseDamping::Rayleigh { mass: 3.0, stiffness: 1e-5 }, 1e-3),
        (SparseDamping::ModalRatio(0.003), 1e-3),
        (dampers(5.0), 1e-3),
        (dampers(5e4), 1e-3),
    ] {
        let model = springs.model(damping.clone());
        let dense = match damping {
            SparseDamping::Matrix(matrix) => Damping::Matrix(matrix.to_dense()),
            SparseDamping::Rayleigh { mass, stiffness } => Damping::Rayleigh { mass, stiffness },
            SparseDamping::ModalRatio(ratio) => Damping::ModalRatio(ratio),
        };
        let full = Model::new(model.mass.to_dense(), dense, model.stiffness.to_dense()).unwrap();
        let options =
            ReductionOptions { modes: ModeCount::Automatic { tolerance }, lowest: 20.0, highest: 90.0 };
        let reduction = reduce(&model, &keep, std::slice::from_ref(&motion), &options, &mut |_| {}).unwrap();
        assert!(reduction.error.unwrap() <= tolerance, "{:?}", reduction.error);
        for hz in [31.0, 58.0, 88.0] {
            // Masses of 1 kg: M r = r.
            let exact = response(&full, &motion, hz);
            let reduced = response(&reduction.model, &reduction.model.base_loads()[0], hz);
            let norm = |of: &dyn Fn(usize, usize) -> faer::c64| {
                keep.iter().enumerate().map(|(i, &dof)| of(i, dof).norm_sqr()).sum::<f64>().sqrt()
            };
            let error = norm(&|i, dof| exact[dof] - reduced[i]) / norm(&|_, dof| exact[dof]);
            assert!(error < 2.0 * tolerance, "{hz} Hz: {error:e}");
        }
    }
}

#[test]
fn misuse_is_named() {
    let model = Springs::membrane(5).model(UNDAMPED);
    let good = ReductionOptions { modes: ModeCount::Exactly(3), lowest: 0.0, highest: 10.0 };
    let fails = |keep: &[usize], motions: &[Vec<f64>], options: ReductionOptions| {
        reduce(&model, keep, motions, &options, &mut |_| {}).unwrap_err()
    };
    assert_eq!(fails(&[3, 25], &[], good), ReductionError::NoSuchDof { dof: 25, dofs: 25 });
    assert_eq!(fails(&[3, 7, 3], &[], good), ReductionError::KeptTwice { dof: 3 });
    let motions = [vec![1.0; 25], vec![1.0; 24]];
    assert_eq!(fails(&[3], &motions, good), ReductionError::BaseLoad { index: 1, dofs: 25 });
    for (lowest, highest) in [(0.0, 0.0), (20.0, 10.0), (-1.0, 10.0), (0.0, f64::NAN), (0.0, f64::INFINITY)] {
        let error = fails(&[3], &[], ReductionOptions { lowest, highest, ..good });
        assert!(matches!(error, ReductionError::Options(_)), "{error}");
    }
    let none = ReductionOptions { modes: ModeCount::Automatic { tolerance: 0.0 }, ..good };
    assert!(matches!(fails(&[3], &[], none), ReductionError::Options(_)));
    // A spring of negative stiffness inside, stronger than what holds its mass.
    let mut unstable = Springs::membrane(5);
    unstable.springs.push((12, None, -1e9));
    let error = reduce(&unstable.model(UNDAMPED), &[3], &[], &good, &mut |_| {}).unwrap_err();
    assert_eq!(error, ReductionError::Singular);
}

#[test]
fn progress_tells_what_is_done() {
    let model = Springs::membrane(12).model(UNDAMPED);
    let options =
        ReductionOptions { modes: ModeCount::Automatic { tolerance: 1e-3 }, lowest: 0.0, highest: 60.0 };
    let mut heard = Vec::new();
    let reduction = reduce(&model, &[5, 66], &[], &options, &mut |step| heard.push(step)).unwrap();
    assert_eq!(heard.first(), Some(&Progress::Factorising));
    assert!(heard.contains(&Progress::ConstraintModes));
    let modes = reduction.fixed_frequencies.len();
    assert!(modes <= reduction.modes && heard.contains(&Progress::Modes { found: modes, of: modes }));
    assert!(heard.contains(&Progress::Checking { done: 0, of: reduction.checked_at.len() }));
}
