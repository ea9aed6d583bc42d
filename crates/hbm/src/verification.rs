//! The Jacobian of the balance against central differences, for every kind of problem at once.

use std::sync::Arc;

use contact::{
    ContactState, Coulomb, CoulombParameters, Cubic, CubicParameters, ElasticCoulomb,
    ElasticCoulombParameters, FrictionContact, FrictionContactParameters, JointChange, JointLaw, JointMarks,
    JointMotion, JointWorkspace, Law, LawError, MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry,
};
use faer::{Mat, c64, mat};
use hysteresis::Loop;
use num_complex::Complex64;

use crate::balance::Homotopy;
use crate::{Contact, Damping, Direction, Excitation, ExcitationKind, Joint, Model, Plan, Problem, Settings};

/// A loop with even harmonics, so that the mean and even harmonics are unknowns too.
fn uneven_law() -> Arc<dyn Law> {
    let first = Complex64::from_polar(12.0, std::f64::consts::PI + PhaseLaw::default().value(1.0));
    let harmonics = vec![
        Complex64::ZERO,
        first,
        Complex64::new(0.5, -0.3),
        Complex64::new(0.6, 2.3),
        Complex64::new(-0.2, 0.1),
    ];
    let measured = Loop::new(8e-6, harmonics).unwrap();
    let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
    Arc::new(ScaledLoop::new(&measured, 0.0, magnitude, phase, Symmetry::Full).unwrap())
}

fn problem() -> Problem {
    let jenkins = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 2e6, slip_force: 5.0 }).unwrap();
    let cubic = Cubic::new(CubicParameters { stiffness: 1e15 }).unwrap();
    let creeping = Coulomb::new(CoulombParameters { slip_force: 3.0, velocity: 0.3 }).unwrap();
    let contact =
        |first, second, law: Arc<dyn Law>, scale| Contact { name: "c".into(), first, second, law, scale };
    Problem {
        joints: Vec::new(),
        model: Model::new(
            mat![[4.0, 0.0, 0.0], [0.0, 1.3, 0.0], [0.0, 0.0, 0.8]],
            Damping::Rayleigh { mass: 5.0, stiffness: 1e-5 },
            mat![[9e5, -4e5, 0.0], [-4e5, 7e5, -2e5], [0.0, -2e5, 5e5]],
        )
        .unwrap(),
        excitation: vec![
            Excitation { dof: 1, harmonic: 1, amplitude: 9.0, phase: 0.2, kind: ExcitationKind::Force },
            Excitation { dof: 2, harmonic: 2, amplitude: 4.0, phase: -1.0, kind: ExcitationKind::Force },
            Excitation { dof: 2, harmonic: 0, amplitude: 2.0, phase: 0.0, kind: ExcitationKind::Force },
        ],
        contacts: vec![
            contact(0, None, uneven_law(), 1.0),
            contact(1, Some(0), Arc::new(jenkins), 2.0),
            contact(2, Some(1), Arc::new(cubic), 1.0),
            contact(2, None, Arc::new(creeping), 1.0),
        ],
        output: vec![0],
    }
}

/// A spring that bulges: f_t = c w n, f_n = k n + c w²/2, in N with displacements in units of `LENGTH`.
#[derive(Debug)]
struct Bulging;

const LENGTH: f64 = 2e-6;

#[derive(Debug)]
struct Nothing;

impl JointWorkspace for Nothing {
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

impl JointLaw for Bulging {
    fn name(&self) -> &'static str {
        "bulging"
    }

    fn directions(&self) -> usize {
        2
    }

    fn length(&self, direction: usize) -> f64 {
        [LENGTH, 2.0 * LENGTH][direction]
    }

    fn stiffness(&self, direction: usize) -> f64 {
        [3.0 / LENGTH, 4.0 / LENGTH][direction]
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
        let (tangential, normal) = force.split_at_mut(motion.samples());
        let motions = motion.displacement_of(0).iter().zip(motion.displacement_of(1));
        for ((t, n), (w, d)) in tangential.iter_mut().zip(normal).zip(motions) {
            let (w, d) = (w / LENGTH, d / LENGTH);
            (*t, *n) = (3.0 * w * d, 4.0 * d + 1.5 * w * w);
        }
        Ok(JointMarks::default())
    }

    fn derivative(
        &self,
        motion: &JointMotion,
        change: &JointChange,
        _workspace: &mut dyn JointWorkspace,
        derivative: &mut [f64],
    ) {
        let (tangential, normal) = derivative.split_at_mut(motion.samples());
        let motions = motion.displacement_of(0).iter().zip(motion.displacement_of(1));
        for (((t, n), (w, d)), delta) in
            tangential.iter_mut().zip(normal).zip(motions).zip(change.displacement)
        {
            let (w, d, delta) = (w / LENGTH, d / LENGTH, delta / LENGTH);
            (*t, *n) = match change.direction {
                0 => (3.0 * d * delta, 3.0 * w * delta),
                _ => (3.0 * w * delta, 4.0 * delta),
            };
        }
    }
}

/// The same with two joints along slanting axes beside the contacts.
fn joined() -> Problem {
    let joint = |turn: f64, scale: f64| Joint {
        name: "j".into(),
        directions: vec![
            Direction { parts: vec![(0, turn.cos()), (1, turn.sin()), (2, -0.5)] },
            Direction { parts: vec![(0, -turn.sin()), (1, turn.cos()), (2, 0.2)] },
        ],
        law: Arc::new(Bulging),
        scale,
    };
    let parameters = FrictionContactParameters {
        tangential_stiffness: 2e6,
        normal_stiffness: 3e6,
        friction_coefficient: 0.4,
        preload: Some(8.0),
        gap: None,
    };
    let part = |dof: usize| Direction { parts: vec![(dof, 1.0)] };
    let friction = Joint {
        name: "f".into(),
        directions: vec![part(0), part(1), part(2)],
        law: Arc::new(FrictionContact::new(parameters, 2).unwrap()),
        scale: 1.0,
    };
    Problem { joints: vec![joint(0.4, 1.0), friction, joint(1.9, 0.3)], ..problem() }
}

#[test]
fn the_jacobian_agrees_with_central_differences() {
    check_jacobian(&problem());
}

#[test]
fn the_jacobian_with_joints_agrees_with_central_differences() {
    check_jacobian(&joined());
}

/// Friction in one and in two directions under loads that the motion changes, the first by its events.
fn rubbing() -> Problem {
    let parameters = |preload, gap| FrictionContactParameters {
        tangential_stiffness: 2e6,
        normal_stiffness: 3e6,
        friction_coefficient: 0.6,
        preload,
        gap,
    };
    let joint = |turn: f64, parameters, tangential: usize| Joint {
        name: "j".into(),
        directions: (0..=tangential)
            .map(|d| turn + 1.3 * d as f64)
            .map(|turn| Direction { parts: vec![(0, turn.cos()), (1, turn.sin()), (2, -0.5)] })
            .collect(),
        law: Arc::new(FrictionContact::new(parameters, tangential).unwrap()),
        scale: 0.7,
    };
    let joints = vec![
        joint(0.4, parameters(Some(8.0), None), 1),
        joint(1.0, parameters(None, Some(-3e-6)), 1),
        joint(1.9, parameters(Some(5.0), None), 2),
    ];
    Problem { joints, ..problem() }
}

#[test]
fn the_jacobian_with_friction_agrees_with_central_differences() {
    check_jacobian(&rubbing());
}

/// One friction contact in one direction, opening at times.
fn rattling() -> Problem {
    let Problem { model, joints, .. } = rubbing();
    let force = |dof, harmonic, amplitude, phase| Excitation {
        dof,
        harmonic,
        amplitude,
        phase,
        kind: ExcitationKind::Force,
    };
    Problem {
        model,
        excitation: vec![force(0, 1, 14.0, 0.2), force(1, 1, 16.0, 1.1), force(2, 2, 5.0, 0.0)],
        contacts: Vec::new(),
        joints: joints.into_iter().take(1).collect(),
        output: vec![0],
    }
}

#[test]
fn friction_by_its_events_is_what_samples_tend_to() {
    let problem = rattling();
    let solve = |samples: Option<usize>| {
        let plan = Plan::new(&problem, &Settings { samples, ..Settings::new(7) }).unwrap();
        let facts = plan.facts();
        assert_eq!((facts.joints, facts.joints_by_events), (1, usize::from(samples.is_none())));
        assert_eq!(facts.samples, samples.unwrap_or(0));
        let solution = plan.solve(60.0, &mut plan.workspace());
        assert_eq!(solution.status, crate::Status::Converged);
        let joint = &solution.joints[0];
        assert!(joint.apart > 0.02 && joint.state == ContactState::Mixed, "{joint:?}");
        assert!(joint.dissipation > 0.0);
        joint.directions.iter().flat_map(|d| d.displacement.clone()).collect::<Vec<_>>()
    };
    let exact = solve(None);
    let size: f64 = exact.iter().map(|w| w.norm_sqr()).sum();
    let error = |samples: usize| {
        let other = solve(Some(samples));
        let change: f64 = exact.iter().zip(other).map(|(a, b)| (a - b).norm_sqr()).sum();
        (change / size).sqrt()
    };
    let (coarse, fine) = (error(128), error(2048));
    let rate = (coarse / fine).log2() / 4.0;
    // With the square of the samples, up and down with how the events fall between them.
    assert!(fine < 5e-6 && rate > 1.8, "{coarse:e} {fine:e} {rate}");
}

fn check_jacobian(problem: &Problem) {
    let plan = Plan::new(problem, &Settings::new(4)).unwrap();
    let mut ws = plan.workspace();
    plan.structure.condense(70.0, 0..plan.slots(), &mut ws.condensed).unwrap();
    let slots = plan.slots();
    ws.point.set(&ws.condensed, plan.laws(), slots, &[false; 4]);
    let rung = plan.rungs.len() - 1;
    let balance = plan.balance(rung);
    let buffers = &mut ws.balance[rung];
    let width = ws.point.width();
    let size = balance.size(width, slots);
    let rows = 4 + problem.joints.iter().map(|joint| joint.directions.len()).sum::<usize>();
    assert_eq!((slots, size), (5, 2 * rows * 5 - rows));
    let secants = [c64::new(0.7, 0.2), c64::new(1.3, 0.0), c64::new(0.2, 0.9), c64::ZERO];
    for (row, secant) in ws.point.secant.iter_mut().enumerate() {
        *secant = secants[row % 4];
    }
    for homotopy in [Homotopy::NONE, Homotopy { contact: 0.3, excitation: 2.0, secant: 0.4, stretch: 0.7 }] {
        // A motion that slips, with reversals; the mean is real.
        let mut unknowns: Vec<c64> = (0..slots * width)
            .map(|i| c64::from_polar(2.0 / (1 + i / width) as f64, 1.0 + 1.7 * i as f64))
            .collect();
        unknowns.iter_mut().take(width).for_each(|mean| mean.im = 0.0);
        let mut matrix = Mat::zeros(size, size);
        balance.evaluate(&ws.point, slots, homotopy, &unknowns, buffers).unwrap();
        balance.jacobian(&ws.point, slots, homotopy, buffers, &mut matrix);
        let scale = matrix.norm_max();
        let h = 1e-6;
        for entry in 0..slots * width {
            let (column, is_complex) = balance.real_index(width, entry / width, entry % width);
            for part in 0..if is_complex { 2 } else { 1 } {
                let mut residual = |step: f64| -> Vec<c64> {
                    let mut moved = unknowns.clone();
                    moved[entry] += if part == 0 { c64::new(step, 0.0) } else { c64::new(0.0, step) };
                    balance.evaluate(&ws.point, slots, homotopy, &moved, buffers).unwrap();
                    buffers.residual.clone()
                };
                let (up, down) = (residual(h), residual(-h));
                for row in 0..slots * width {
                    let (r, row_complex) = balance.real_index(width, row / width, row % width);
                    let slope = (up[row] - down[row]) / (2.0 * h);
                    assert!(
                        (slope.re - matrix[(r, column + part)]).abs() < 1e-7 * scale,
                        "row {row}, entry {entry}"
                    );
                    if row_complex {
                        let error = (slope.im - matrix[(r + 1, column + part)]).abs();
                        assert!(error < 1e-7 * scale, "row {row}, entry {entry}: {error:e}");
                    }
                }
            }
        }
    }
}

/// Without friction a contact with two tangential directions is one with a single direction, all of whose forces are known by their
/// events: its pressure is not sampled either.
#[test]
fn pressure_is_not_sampled_whatever_friction_is() {
    let Problem { model, excitation, .. } = rattling();
    let solve = |tangential: usize| {
        let parameters = FrictionContactParameters {
            tangential_stiffness: 2e6,
            normal_stiffness: 3e6,
            friction_coefficient: 0.0,
            preload: Some(8.0),
            gap: None,
        };
        let tangent = |turn: f64| Direction { parts: vec![(0, turn.cos()), (1, turn.sin())] };
        let normal = Direction { parts: vec![(0, 0.3), (1, -0.8), (2, -0.5)] };
        let directions = (0..tangential).map(|d| tangent(0.7 * d as f64)).chain([normal]).collect();
        let law = Arc::new(FrictionContact::new(parameters, tangential).unwrap());
        let joint = Joint { name: "j".into(), directions, law, scale: 0.7 };
        let problem = Problem {
            model: model.clone(),
            excitation: excitation.clone(),
            contacts: Vec::new(),
            joints: vec![joint],
            output: vec![0, 1, 2],
        };
        let plan = Plan::new(&problem, &Settings::new(7)).unwrap();
        let solution = plan.solve(60.0, &mut plan.workspace());
        assert_eq!(solution.status, crate::Status::Converged);
        assert!(solution.joints[0].apart > 0.02, "{:?}", solution.joints[0]);
        (solution.joints[0].apart, solution.displacement)
    };
    let ((known_apart, known), (apart, found)) = (solve(1), solve(2));
    assert!((apart - known_apart).abs() < 1e-9, "{apart} instead of {known_apart}");
    let size = known.iter().flatten().map(|w| w.norm()).fold(0.0, f64::max);
    for (found, known) in found.iter().flatten().zip(known.iter().flatten()) {
        assert!((found - known).norm() < 1e-9 * size, "{found} instead of {known}");
    }
}
