//! Iwan's law and families of loops in the balance: against their elements one by one, and without allocation.

use std::sync::Arc;

use contact::{
    Iwan, IwanParameters, Law, Linear, LinearParameters, LoopFamily, MagnitudeLaw, Motion, Symmetry,
    Workspace,
};
use hbm::{Contact, Excitation, ExcitationKind, Plan, Problem, Settings, Solution, Status};
use hysteresis::synthetic;
use num_complex::Complex64;
use stickslip_tests::{to_ground, two_mass};

fn solve(problem: &Problem, harmonics: usize, hertz: f64) -> Solution {
    let plan = Plan::new(problem, &Settings::new(harmonics)).unwrap();
    let solution = plan.solve(hertz, &mut plan.workspace());
    assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
    solution
}

fn distance(a: &[Vec<Complex64>], b: &[Vec<Complex64>]) -> f64 {
    let pairs = || a.iter().flatten().zip(b.iter().flatten());
    let difference: f64 = pairs().map(|(a, b)| (a - b).norm_sqr()).sum();
    let size: f64 = pairs().map(|(a, _)| a.norm_sqr()).sum();
    (difference / size).sqrt()
}

/// W* = 8 µm, F* = 12 N.
fn closed_form() -> Iwan {
    let magnitude = MagnitudeLaw::default();
    Iwan::from_magnitude(IwanParameters { displacement: 8e-6, force: 12.0, magnitude, range: 10.0 }).unwrap()
}

/// The elements and the spring of a stack as contacts of their own.
fn one_by_one(stack: &Iwan) -> Vec<Contact> {
    let spring = Linear::new(LinearParameters { stiffness: stack.spring() }).unwrap();
    let elements = stack.sliders().unwrap().iter().map(|element| Arc::new(*element) as Arc<dyn Law>);
    elements
        .chain([Arc::new(spring) as Arc<dyn Law>])
        .enumerate()
        .map(|(i, law)| Contact { name: format!("element {i}"), ..to_ground(law) })
        .collect()
}

#[test]
fn a_stack_answers_like_its_elements_side_by_side() {
    // Both at the same samples: by itself the element is evaluated by its events. (At one harmonic the stack has its
    // closed form.)
    let solve = |problem: &Problem, harmonics: usize, hertz: f64| {
        let mut settings = Settings::new(harmonics);
        settings.samples = Some(256);
        let plan = Plan::new(problem, &settings).unwrap();
        plan.solve(hertz, &mut plan.workspace())
    };
    let stack = closed_form().discretised(6).unwrap();
    let preload = Excitation { dof: 1, harmonic: 0, amplitude: 4.0, phase: 0.0, kind: ExcitationKind::Force };
    for (preloaded, harmonics) in [(false, 3), (false, 7), (true, 4)] {
        let mut together = two_mass(Arc::new(stack.clone()));
        if preloaded {
            together.excitation.push(preload);
        }
        let apart = Problem { contacts: one_by_one(&stack), ..together.clone() };
        for hertz in [40.0, 57.0, 75.0, 108.0, 130.0] {
            let (one, other) = (solve(&together, harmonics, hertz), solve(&apart, harmonics, hertz));
            let difference = distance(&one.displacement, &other.displacement);
            assert!(difference < 1e-8, "N = {harmonics}, {hertz} Hz: {difference:e}");
        }
    }
}

#[test]
fn the_response_converges_with_the_number_of_sliders() {
    let (law, hertz) = (closed_form(), [57.0, 62.0, 75.0, 100.0, 108.0]);
    let exact = two_mass(Arc::new(law.clone()));
    let error = |count: usize| -> f64 {
        let coarse = two_mass(Arc::new(law.discretised(count).unwrap()));
        hertz
            .iter()
            .map(|&hertz| {
                let (one, other) = (solve(&coarse, 5, hertz), solve(&exact, 5, hertz));
                distance(&one.displacement, &other.displacement)
            })
            .sum()
    };
    let rate = (error(10) / error(160)).log2() / 4.0;
    assert!((rate - 2.0).abs() < 0.25, "{rate}");
}

#[test]
fn evaluation_allocates_nothing_after_the_first() {
    let loops = [1e-6, 3e-6, 8e-6].map(|a| synthetic::dahl_loop(a, 10.0, 1e7, 15).unwrap());
    let laws: [Arc<dyn Law>; 3] = [
        Arc::new(closed_form()),
        Arc::new(closed_form().discretised(40).unwrap()),
        Arc::new(LoopFamily::new(&loops, 0.0, Symmetry::Auto).unwrap()),
    ];
    let spectrum = [0.2, 3.0, 0.4, 1.9].map(|w| Complex64::from_polar(1e-6 * w, 7.0 * w - 1.4));
    let spectrum = [Complex64::from(2e-7), spectrum[1], spectrum[2], spectrum[3]];
    let samples = 256;
    let at = |j: usize, power: i32| -> f64 {
        let tau = std::f64::consts::TAU * j as f64 / samples as f64;
        let term = |(k, c): (usize, &Complex64)| {
            (c * Complex64::new(0.0, k as f64).powi(power) * Complex64::cis(k as f64 * tau)).re
        };
        spectrum.iter().enumerate().map(term).sum()
    };
    let displacement: Vec<f64> = (0..samples).map(|j| at(j, 0)).collect();
    let velocity: Vec<f64> = (0..samples).map(|j| at(j, 1)).collect();
    let motion = Motion {
        spectrum: &spectrum,
        displacement: &displacement,
        velocity: &velocity,
        odd: false,
        omega: 0.0,
    };
    let mut force = vec![0.0; samples];
    for law in laws {
        let mut workspace = Workspace::new(samples);
        let mut evaluate = || {
            law.force(&motion, &mut workspace, &mut force).unwrap();
            assert!(law.tangent(&motion, &mut workspace).memories().len() > 2);
        };
        evaluate();
        let counted = allocation_counter::measure(evaluate);
        assert_eq!(counted.count_total, 0, "{}", law.name());
    }
}
