//! Reduction of large structures, measured against closed forms and dense matrices.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use faer::prelude::Solve as _;
use faer::sparse::{SparseColMat, Triplet};
use structure::{ModeCount, Reduction, ReductionOptions, SparseDamping, SparseModel, reduce};

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
