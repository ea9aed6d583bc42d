//! Contacts in several directions in the balance: against the linear structure with their stiffness, against time collocation,
//! and against each other.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{
    JointChange, JointLaw, JointMarks, JointMotion, JointWorkspace, LawError, Linear, LinearParameters,
};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use hbm::{
    Contact, ContinuationOptions, CurveEnd, Direction, Excitation, ExcitationKind, Joint, LinearSolver,
    ModeOptions, Origin, Plan, Problem, Settings, SparseDamping, SparseModel, Status, entry_curve,
    frequency_curve, nonlinear_mode,
};
use stickslip_tests::{force, model};

/// A force at every instant from the displacements then: `f(w)` and its matrix `∂f/∂w`.
trait Elastic: Send + Sync + std::fmt::Debug {
    fn directions(&self) -> usize;
    fn force(&self, w: &[f64]) -> Vec<f64>;
    fn tangent(&self, w: &[f64]) -> Vec<Vec<f64>>;
    fn length(&self) -> f64;
    fn stiffness(&self, direction: usize) -> f64;
}

#[derive(Debug)]
struct Nothing;

impl JointWorkspace for Nothing {
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

/// An elastic force as a law.
#[derive(Debug)]
struct At<E>(E);

fn instant(motion: &JointMotion, j: usize) -> Vec<f64> {
    (0..motion.directions).map(|d| motion.displacement_of(d)[j]).collect()
}

impl<E: Elastic> JointLaw for At<E> {
    fn name(&self) -> &'static str {
        "elastic"
    }
    fn directions(&self) -> usize {
        self.0.directions()
    }
    fn length(&self, _direction: usize) -> f64 {
        self.0.length()
    }
    fn stiffness(&self, direction: usize) -> f64 {
        self.0.stiffness(direction)
    }
    fn workspace(&self, _samples: usize) -> Box<dyn JointWorkspace> {
        Box::new(Nothing)
    }
    fn force(
        &self,
        motion: &JointMotion,
        _workspace: &mut dyn JointWorkspace,
        force: &mut [f64],
    ) -> Result<JointMarks, LawError> {
        let samples = motion.samples();
        for j in 0..samples {
            for (d, f) in self.0.force(&instant(motion, j)).into_iter().enumerate() {
                force[d * samples + j] = f;
            }
        }
        Ok(JointMarks { cycles: 1, ..JointMarks::default() })
    }
    fn derivative(
        &self,
        motion: &JointMotion,
        change: &JointChange,
        _workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    ) {
        let samples = motion.samples();
        for j in 0..samples {
            for (d, row) in self.0.tangent(&instant(motion, j)).into_iter().enumerate() {
                derivative[d * samples + j] = row[change.direction] * change.displacement[j];
            }
        }
    }
}

/// f = K w.
#[derive(Debug, Clone)]
struct Springs(Vec<Vec<f64>>);

impl Elastic for Springs {
    fn directions(&self) -> usize {
        self.0.len()
    }
    fn force(&self, w: &[f64]) -> Vec<f64> {
        self.0.iter().map(|row| row.iter().zip(w).map(|(k, w)| k * w).sum()).collect()
    }
    fn tangent(&self, _w: &[f64]) -> Vec<Vec<f64>> {
        self.0.clone()
    }
    fn length(&self) -> f64 {
        1e-5
    }
    fn stiffness(&self, direction: usize) -> f64 {
        self.0[direction][direction]
    }
}

/// From the potential `k w²/2 + k n²/2 + c w² n/2 + q (w² + n²)²/4`: f_t = k w + c w n + …, f_n = k n + c w²/2 + ….
#[derive(Debug, Clone)]
struct Bulging {
    k: f64,
    c: f64,
    q: f64,
}

impl Elastic for Bulging {
    fn directions(&self) -> usize {
        2
    }
    fn force(&self, w: &[f64]) -> Vec<f64> {
        let (w, n) = (w[0], w[1]);
        let around = self.k + self.q * (w * w + n * n);
        vec![around * w + self.c * w * n, around * n + 0.5 * self.c * w * w]
    }
    fn tangent(&self, w: &[f64]) -> Vec<Vec<f64>> {
        let (w, n) = (w[0], w[1]);
        let around = self.k + self.q * (w * w + n * n);
        let beside = self.c * w + 2.0 * self.q * w * n;
        vec![
            vec![around + self.c * n + 2.0 * self.q * w * w, beside],
            vec![beside, around + 2.0 * self.q * n * n],
        ]
    }
    fn length(&self) -> f64 {
        (self.k / self.q).sqrt()
    }
    fn stiffness(&self, _direction: usize) -> f64 {
        self.k
    }
}

fn directions(rows: &[&[(usize, f64)]]) -> Vec<Direction> {
    rows.iter().map(|row| Direction { parts: row.to_vec() }).collect()
}

fn excitation(dof: usize, harmonic: usize, amplitude: f64, phase: f64) -> Excitation {
    Excitation { dof, harmonic, amplitude, phase, kind: ExcitationKind::Force }
}

/// Two bodies with three dofs each; the second one is held by nothing but its joint where `held` is zero.
fn matrices(held: f64) -> [Mat<f64>; 3] {
    let mass = Mat::from_fn(6, 6, |i, j| if i == j { 1.0 + 0.3 * i as f64 } else { 0.0 });
    let stiffness = Mat::from_fn(6, 6, |i, j| match (i / 3, j / 3) {
        (0, 0) => {
            if i == j {
                3e5 + 4e4 * i as f64
            } else {
                -5e4
            }
        }
        (1, 1) if i == j => held,
        _ => 0.0,
    });
    let damping = Mat::from_fn(6, 6, |i, j| if i == j { 20.0 + i as f64 } else { 0.0 });
    [mass, damping, stiffness]
}

const COUPLED: [[f64; 3]; 3] = [[2e5, 3e4, -6e4], [3e4, 1.5e5, 2e4], [-5e4, 4e4, 3e5]];

/// Three slanting axes between the bodies.
fn axes() -> Vec<Direction> {
    directions(&[
        &[(0, 0.8), (1, 0.6), (3, -0.8), (4, -0.6)],
        &[(0, -0.6), (1, 0.8), (3, 0.6), (4, -0.8)],
        &[(2, 1.0), (5, -1.0), (0, 0.1)],
    ])
}

fn springs(held: f64) -> Problem {
    let [mass, damping, stiffness] = matrices(held);
    let law = Springs(COUPLED.map(|row| row.to_vec()).to_vec());
    Problem {
        model: model(mass, damping, stiffness),
        excitation: vec![
            excitation(0, 1, 10.0, 0.4),
            excitation(5, 2, 7.0, -1.0),
            excitation(3, 0, 4.0, 0.0),
            excitation(4, 3, 2.0, 0.0),
        ],
        contacts: vec![Contact {
            name: "spring".into(),
            first: 2,
            second: Some(4),
            law: Arc::new(Linear::new(LinearParameters { stiffness: 7e4 }).unwrap()),
            scale: 2.0,
        }],
        joints: vec![Joint { name: "j".into(), directions: axes(), law: Arc::new(At(law)), scale: 1.5 }],
        output: (0..6).collect(),
    }
}

/// What joint and contact of [`springs`] add to the stiffness.
fn added() -> Mat<f64> {
    let mut added = Mat::zeros(6, 6);
    let axes = axes();
    for (row, of_row) in COUPLED.iter().zip(&axes) {
        for (k, of_column) in row.iter().zip(&axes) {
            for &(i, a) in &of_row.parts {
                for &(j, b) in &of_column.parts {
                    added[(i, j)] += 1.5 * k * a * b;
                }
            }
        }
    }
    for (i, j, sign) in [(2, 2, 1.0), (4, 4, 1.0), (2, 4, -1.0), (4, 2, -1.0)] {
        added[(i, j)] += 1.4e5 * sign;
    }
    added
}

/// Response of harmonic k of the linear structure with that stiffness.
fn linear_response(held: f64, hertz: f64, k: usize, excitation: &[Excitation]) -> Vec<c64> {
    let [mass, damping, stiffness] = matrices(held);
    let added = added();
    let omega = k as f64 * TAU * hertz;
    let h = Mat::from_fn(6, 6, |i, j| {
        let real = stiffness[(i, j)] + added[(i, j)] - omega * omega * mass[(i, j)];
        c64::new(real, omega * damping[(i, j)])
    });
    let mut load = Mat::zeros(6, 1);
    for e in excitation.iter().filter(|e| e.harmonic == k) {
        load[(e.dof, 0)] += c64::from_polar(e.amplitude, e.phase);
    }
    h.partial_piv_lu().solve_in_place(load.as_mut());
    (0..6).map(|i| load[(i, 0)]).collect()
}

fn sparse(problem: &Problem, held: f64) -> Problem<SparseModel> {
    let entries = |matrix: &Mat<f64>| {
        let triplets: Vec<_> = (0..6)
            .flat_map(|i| (0..6).map(move |j| (i, j)))
            .map(|(i, j)| faer::sparse::Triplet::new(i, j, matrix[(i, j)]))
            .collect();
        faer::sparse::SparseColMat::try_new_from_triplets(6, 6, &triplets).unwrap()
    };
    let [mass, damping, stiffness] = matrices(held).each_ref().map(entries);
    Problem {
        model: SparseModel { mass, damping: SparseDamping::Matrix(damping), stiffness },
        excitation: problem.excitation.clone(),
        contacts: problem.contacts.clone(),
        joints: problem.joints.clone(),
        output: problem.output.clone(),
    }
}

/// A joint of coupled springs is a part of the linear structure: also beside a scalar contact, with a body that nothing else
/// holds, with sparse matrices, and by GMRES.
#[test]
fn coupled_springs_are_a_linear_structure() {
    for (held, solver) in
        [(2e4, LinearSolver::Dense), (0.0, LinearSolver::Dense), (2e4, LinearSolver::Krylov)]
    {
        let problem = springs(held);
        let settings = Settings { linear_solver: solver, ..Settings::new(5) };
        let plans = [
            Plan::new(&problem, &settings).unwrap(),
            Plan::direct(&sparse(&problem, held), &settings).unwrap(),
        ];
        for (plan, hertz) in plans.iter().flat_map(|plan| [13.0, 41.0, 77.7].map(|hertz| (plan, hertz))) {
            let solution = plan.solve(hertz, &mut plan.workspace());
            assert_eq!(solution.status, Status::Converged, "{hertz} Hz, held {held}");
            assert_eq!(plan.orders(), [0, 1, 2, 3, 4, 5]);
            let size = solution.displacement.iter().flatten().map(|w| w.norm()).fold(0.0, f64::max);
            for k in 0..=5 {
                let exact = linear_response(held, hertz, k, &problem.excitation);
                for (dof, exact) in exact.iter().enumerate() {
                    let error = (solution.displacement[dof][k] - exact).norm() / size;
                    // Where nothing else holds a body, springs are lent for its mean, and digits with them.
                    let tolerance = if held == 0.0 && k == 0 { 1e-10 } else { 1e-12 };
                    assert!(
                        error < tolerance,
                        "held {held}, {solver:?}, {hertz} Hz, W_{k} of {dof}: {error:e}"
                    );
                }
                for (row, axis) in COUPLED.iter().zip(&solution.joints[0].directions) {
                    let joint = &solution.joints[0].directions;
                    let force: c64 =
                        row.iter().zip(joint).map(|(k_rc, d)| d.displacement[k] * (-1.5 * k_rc)).sum();
                    assert!((axis.force[k] - force).norm() < 1e-9 * size * 3e5);
                }
            }
        }
    }
}

/// What is not conservative takes energy: ∮ Σ f dw of a matrix with a skew part, and none of a symmetric one.
#[test]
fn dissipation_is_the_work_of_all_directions() {
    let problem = springs(2e4);
    let plan = Plan::new(&problem, &Settings::new(3)).unwrap();
    let solution = plan.solve(41.0, &mut plan.workspace());
    let joint = &solution.joints[0];
    // ∮ f dw from samples of the waveform, by the trapezoidal rule (exact for trigonometric polynomials).
    let wave = plan.waveform(&solution, 256).unwrap();
    let samples = wave.phase.len();
    let mut work = 0.0;
    for (w, f) in wave.joints[0].displacement.iter().zip(&wave.joints[0].force) {
        for (j, f) in f.iter().enumerate() {
            let slope: f64 = (1..=3)
                .map(|k| {
                    let amplitude: c64 = (0..samples)
                        .map(|i| {
                            c64::cis(-((k * i) as f64) * TAU / samples as f64) * (2.0 * w[i] / samples as f64)
                        })
                        .sum();
                    (c64::new(0.0, k as f64) * amplitude * c64::cis((k * j) as f64 * TAU / samples as f64)).re
                })
                .sum();
            work -= f * slope * TAU / samples as f64;
        }
    }
    assert!(joint.dissipation.abs() > 1e-6);
    assert!((joint.dissipation - work).abs() < 1e-10 * work.abs(), "{} for {work}", joint.dissipation);
    for (direction, w) in joint.directions.iter().zip(&wave.joints[0].displacement) {
        let range = w.iter().fold((f64::MAX, f64::MIN), |(low, high), w| (low.min(*w), high.max(*w)));
        assert!((direction.amplitude / (0.5 * (range.1 - range.0)) - 1.0).abs() < 1e-3);
    }
}

const BULGING: Bulging = Bulging { k: 2e5, c: 3e9, q: 4e13 };

/// Two masses that move in a plane, tied by the elastic joint along turned axes.
fn bulging(harmonics: usize) -> (Problem, Settings) {
    let mass = Mat::from_fn(4, 4, |i, j| if i == j { [1.0, 1.0, 0.7, 0.7][i] } else { 0.0 });
    let stiffness = Mat::from_fn(4, 4, |i, j| if i == j { [2e5, 3e5, 6e4, 5e4][i] } else { 0.0 });
    let damping = Mat::from_fn(4, 4, |i, j| if i == j { 30.0 } else { 0.0 });
    let (c, s) = (0.7_f64.cos(), 0.7_f64.sin());
    let problem = Problem {
        model: model(mass, damping, stiffness),
        excitation: vec![excitation(0, 1, 9.0, 0.0), excitation(3, 1, 5.0, 1.0), excitation(2, 0, 3.0, 0.0)],
        contacts: Vec::new(),
        joints: vec![Joint {
            name: "j".into(),
            directions: directions(&[
                &[(0, c), (1, s), (2, -c), (3, -s)],
                &[(0, -s), (1, c), (2, s), (3, -c)],
            ]),
            law: Arc::new(At(BULGING)),
            scale: 1.2,
        }],
        output: (0..4).collect(),
    };
    (problem, Settings::new(harmonics))
}

/// The periodic solution by trigonometric collocation in time: values at 2n + 1 instants, by Newton's method on all of them from
/// the motion with these harmonics.
fn collocation(problem: &Problem, hertz: f64, n: usize, start: &[Vec<c64>]) -> Vec<Vec<f64>> {
    let (points, dofs) = (2 * n + 1, 4);
    let omega = TAU * hertz;
    // d/dτ of the trigonometric interpolant.
    let slope = |i: usize, j: usize| {
        let apart = (i as f64 - j as f64) * std::f64::consts::PI / points as f64;
        if i == j { 0.0 } else { 0.5 * if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 } / apart.sin() }
    };
    let first = Mat::from_fn(points, points, slope);
    let second = &first * &first;
    let (m, d, k) = (problem.model.mass(), problem.model.damping(), problem.model.stiffness());
    let joint = &problem.joints[0];
    let mut w = Mat::from_fn(dofs * points, 1, |entry, _| {
        let (dof, tau) = (entry / points, (entry % points) as f64 * TAU / points as f64);
        start[dof].iter().enumerate().map(|(k, w)| (w * c64::cis(k as f64 * tau)).re).sum::<f64>()
    });
    for _ in 0..40 {
        let mut residual = Mat::<f64>::zeros(dofs * points, 1);
        let mut jacobian = Mat::<f64>::zeros(dofs * points, dofs * points);
        for i in 0..points {
            for e in &problem.excitation {
                let tau = e.harmonic as f64 * TAU * i as f64 / points as f64;
                residual[(e.dof * points + i, 0)] -= e.amplitude * (tau + e.phase).cos();
            }
            for (row, column) in (0..dofs).flat_map(|a| (0..dofs).map(move |b| (a, b))) {
                for j in 0..points {
                    let mut entry = omega * omega * m[(row, column)] * second[(i, j)]
                        + omega * d[(row, column)] * first[(i, j)];
                    if i == j {
                        entry += k[(row, column)];
                    }
                    jacobian[(row * points + i, column * points + j)] += entry;
                    residual[(row * points + i, 0)] += entry * w[(column * points + j, 0)];
                }
            }
            let across = |direction: &Direction| -> f64 {
                direction.parts.iter().map(|&(dof, a)| a * w[(dof * points + i, 0)]).sum()
            };
            let relative: Vec<f64> = joint.directions.iter().map(across).collect();
            let (forces, tangent) = (BULGING.force(&relative), BULGING.tangent(&relative));
            for (r, of_row) in joint.directions.iter().enumerate() {
                for &(row, a) in &of_row.parts {
                    residual[(row * points + i, 0)] += joint.scale * a * forces[r];
                    for (c, of_column) in joint.directions.iter().enumerate() {
                        for &(column, b) in &of_column.parts {
                            jacobian[(row * points + i, column * points + i)] +=
                                joint.scale * a * b * tangent[r][c];
                        }
                    }
                }
            }
        }
        jacobian.partial_piv_lu().solve_in_place(residual.as_mut());
        w = &w - &residual;
        if residual.norm_l2() < 1e-14 * w.norm_l2() {
            break;
        }
    }
    (0..dofs).map(|dof| (0..points).map(|i| w[(dof * points + i, 0)]).collect()).collect()
}

/// Harmonics of a nonlinear elastic joint are those of a collocation in time, which knows nothing of harmonics.
#[test]
fn a_nonlinear_joint_is_what_collocation_finds() {
    let (problem, settings) = bulging(20);
    let plan = Plan::new(&problem, &settings).unwrap();
    for hertz in [20.0, 35.0, 61.0] {
        let solution = plan.solve(hertz, &mut plan.workspace());
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz: {:?}", solution.stats);
        let exact = collocation(&problem, hertz, 30, &solution.displacement);
        for (dof, values) in exact.iter().enumerate() {
            let points = values.len() as f64;
            let size = solution.displacement[dof].iter().map(|w| w.norm()).fold(0.0, f64::max);
            for (k, w) in solution.displacement[dof].iter().enumerate() {
                let one_sided = if k == 0 { 1.0 } else { 2.0 };
                let turned =
                    values.iter().enumerate().map(|(i, w)| c64::cis(-((k * i) as f64) * TAU / points) * *w);
                let expected = turned.sum::<c64>() * (one_sided / points);
                let error = (w - expected).norm() / size;
                assert!(error < 1e-9, "{hertz} Hz, W_{k} of {dof}: {error:e}");
            }
        }
        // The joint matters, and its coupling makes even harmonics of an odd excitation.
        let joint = &solution.joints[0].directions;
        assert!(joint[1].displacement[2].norm() > 1e-3 * joint[1].displacement[1].norm());
        assert!(
            solution.joints[0].dissipation.abs() < 1e-12,
            "elastic: {:e}",
            solution.joints[0].dissipation
        );
    }
}

/// The ways to solve a step do not matter: GMRES, differences, threads, estimates.
#[test]
fn a_joint_is_solved_in_every_way() {
    let (problem, settings) = bulging(9);
    let plan = Plan::new(&problem, &settings).unwrap();
    let reference = plan.solve(35.0, &mut plan.workspace());
    let facts = plan.facts();
    assert_eq!((facts.joints, facts.odd, facts.linear, facts.scalar), (1, false, false, false));
    assert_eq!(facts.unknowns, 2 * 19);
    assert!(facts.samples >= 256 && facts.tail_after.is_none());
    for other in [
        Settings { linear_solver: LinearSolver::Krylov, ..settings.clone() },
        Settings { jacobian: hbm::Jacobian::Difference, ..settings.clone() },
        Settings { start: hbm::Start::March, ..settings.clone() },
        Settings { estimate: true, ..settings.clone() },
    ] {
        let plan = Plan::new(&problem, &other).unwrap();
        let solution = plan.solve(35.0, &mut plan.workspace());
        assert!(solution.status.solved());
        for (a, b) in solution.displacement.iter().flatten().zip(reference.displacement.iter().flatten()) {
            assert!((a - b).norm() < 1e-9 * reference.displacement[0][1].norm(), "{other:?}");
        }
        if other.estimate {
            let (truncation, sampling) =
                (solution.truncation_error.unwrap(), solution.sampling_error.unwrap());
            assert!(
                truncation > 1e-9 && truncation < 1e-2 && sampling < 1e-10,
                "{truncation:e} {sampling:e}"
            );
        }
    }
    let frequencies: Vec<f64> = (0..24).map(|i| 15.0 + 2.0 * i as f64).collect();
    let sweep = |threads| {
        let options = hbm::SweepOptions { threads: Some(threads), ..Default::default() };
        hbm::sweep(&plan, &frequencies, &options).solutions
    };
    let one = sweep(1);
    assert!(one.iter().all(|s| s.status.solved()));
    assert_eq!(one, sweep(3));
}

/// A curve goes through the points of a sweep, in frequency and in an entry, and a mode of coupled springs is a mode of the
/// linear structure.
#[test]
fn curves_and_modes_know_joints() {
    let (mut problem, settings) = bulging(5);
    for excitation in &mut problem.excitation {
        excitation.amplitude *= 0.2;
    }
    let plan = Plan::new(&problem, &settings).unwrap();
    let mut ws = plan.workspace();
    let curve = frequency_curve(&problem, &settings, (70.0, 110.0), &ContinuationOptions::default()).unwrap();
    assert_eq!(curve.end, CurveEnd::Reached);
    for point in curve.points.iter().step_by(9) {
        let alone = plan.solve(point.parameter, &mut ws);
        assert!(!alone.differs(&point.solution, 1e-8), "{} Hz", point.parameter);
    }
    let scaled = |scale: f64| {
        let mut problem = problem.clone();
        problem.joints[0].scale = scale;
        Some(problem)
    };
    let options = ContinuationOptions::default();
    let curve = entry_curve(&scaled, 80.0, &settings, (1.2, 3.0), &options).unwrap();
    assert_eq!(curve.end, CurveEnd::Reached);
    let last = curve.points.last().unwrap();
    let plan = Plan::new(&scaled(3.0).unwrap(), &settings).unwrap();
    assert!(!plan.solve(80.0, &mut plan.workspace()).differs(&last.solution, 1e-8));

    let mut linear = springs(2e4);
    linear.excitation = vec![force(0, 1.0)];
    let symmetric = |r: usize, c: usize| 0.5 * (COUPLED[r][c] + COUPLED[c][r]);
    let law = Springs((0..3).map(|r| (0..3).map(|c| symmetric(r, c)).collect()).collect());
    linear.joints[0].law = Arc::new(At(law));
    let [mass, _, stiffness] = matrices(2e4);
    let added = added();
    let stiffness = Mat::from_fn(6, 6, |i, j| stiffness[(i, j)] + 0.5 * (added[(i, j)] + added[(j, i)]));
    let exact = model(mass, Mat::zeros(6, 6), stiffness).natural_frequencies();
    let options = ModeOptions {
        mode: 0,
        origin: Origin::Stuck,
        reference: 0,
        amplitudes: (1e-6, 1e-5),
        points: 3,
        progress: &|_| true,
    };
    linear.model = {
        let [mass, _, stiffness] = matrices(2e4);
        model(mass, Mat::zeros(6, 6), stiffness)
    };
    let mode = nonlinear_mode(&linear, &Settings::new(3), &options).unwrap();
    assert!(!mode.points.is_empty());
    for point in &mode.points {
        assert!((point.frequency / exact[0] - 1.0).abs() < 1e-9, "{} for {}", point.frequency, exact[0]);
        assert!(point.damping_ratio.abs() < 1e-9);
        assert_eq!(point.solution.joints.len(), 1);
    }
}

trait Differs {
    fn differs(&self, other: &Self, tolerance: f64) -> bool;
}

impl Differs for hbm::Solution {
    /// Relative distance of the displacement spectra.
    fn differs(&self, other: &Self, tolerance: f64) -> bool {
        let pairs = || self.displacement.iter().flatten().zip(other.displacement.iter().flatten());
        let change: f64 = pairs().map(|(a, b)| (a - b).norm_sqr()).sum();
        let size: f64 = pairs().map(|(a, _)| a.norm_sqr()).sum();
        change.is_nan() || change.sqrt() > tolerance * size.sqrt() || size == 0.0
    }
}

/// A joint that does not fit the model or its law is refused by name.
#[test]
fn misfits_are_named() {
    let place = |change: &dyn Fn(&mut Joint)| {
        let mut problem = springs(1e4);
        change(&mut problem.joints[0]);
        Plan::new(&problem, &Settings::new(3)).unwrap_err().place
    };
    assert_eq!(place(&|joint| drop(joint.directions.pop())), "joints[0].directions");
    assert_eq!(place(&|joint| joint.directions[1].parts[0].0 = 6), "joints[0].directions[1]");
    assert_eq!(place(&|joint| joint.directions[2].parts.clear()), "joints[0].directions[2]");
    assert_eq!(place(&|joint| joint.directions[0].parts[1].0 = 0), "joints[0].directions[0]");
    assert_eq!(place(&|joint| joint.directions[0].parts[1].1 = f64::NAN), "joints[0].directions[0]");
    assert_eq!(place(&|joint| joint.scale = -1.0), "joints[0].scale");
    assert_eq!(
        place(&|joint| joint.law = Arc::new(At(Springs(vec![vec![-1.0; 3]; 3])))),
        "joints[0].directions[0]"
    );
}
