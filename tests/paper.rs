//! One harmonic is the paper: eqs (1)–(9), coded here once more, against the balance.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use contact::{MagnitudeLaw, PhaseLaw, ScaledLoop};
use faer::mat;
use hbm::{Plan, Problem, Settings, Start, Status};
use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stickslip_tests::{force, model, paper_scene, to_ground};

/// A two-mass scene of the paper by its parameters.
#[derive(Debug, Clone, Copy)]
struct Parameters {
    m: [f64; 2],
    c: [f64; 2],
    d: [f64; 2],
    excitation: f64,
    displacement: f64,
    force: f64,
}

impl Parameters {
    fn problem(&self) -> Problem {
        let law =
            ScaledLoop::ellipse(self.displacement, self.force, MagnitudeLaw::default(), PhaseLaw::default());
        let [c1, c2] = self.c;
        Problem {
            joints: Vec::new(),
            model: model(
                mat![[self.m[0], 0.0], [0.0, self.m[1]]],
                mat![[self.d[0], 0.0], [0.0, self.d[1]]],
                mat![[c1 + c2, -c2], [-c2, c2]],
            ),
            excitation: vec![force(1, self.excitation)],
            contacts: vec![to_ground(Arc::new(law.unwrap()))],
            output: vec![0, 1],
        }
    }

    /// Receptances G_11 and G_12 of eq. (4), by Cramer's rule.
    fn receptances(&self, hertz: f64) -> (Complex64, Complex64) {
        let omega = TAU * hertz;
        let h = |m: f64, d: f64, c: f64| Complex64::new(c - omega * omega * m, omega * d);
        let (h11, h22) = (h(self.m[0], self.d[0], self.c[0] + self.c[1]), h(self.m[1], self.d[1], self.c[1]));
        let det = h11 * h22 - self.c[1] * self.c[1];
        (h22 / det, self.c[1] / det)
    }

    /// −F_Contact / W_1 of eqs (6)–(9) at amplitude `a`: the secant stiffness.
    fn secant(&self, a: f64) -> Complex64 {
        let alpha = a / self.displacement;
        let magnitude = self.force * (0.98 + 0.21 * (alpha + 0.01).ln());
        let psi = -FRAC_PI_2 - 7.0 / 15.0 * PI * (-4.0 * alpha).exp();
        -magnitude * Complex64::cis(psi) / a
    }

    /// All amplitudes of w1 that satisfy eq. (4), by a fine logarithmic scan and bisection.
    fn amplitudes(&self, hertz: f64) -> Vec<f64> {
        let (g11, g12) = self.receptances(hertz);
        let free = (g12 * self.excitation).norm();
        let phi = |a: f64| (a * (1.0 + g11 * self.secant(a))).norm() - free;
        let top = (free + (g11 * self.force).norm() * 10.0).max(self.displacement) * 1e2;
        let steps = 6000;
        let at = |i: usize| top * 10.0_f64.powf(-24.0 * (1.0 - i as f64 / steps as f64));
        let mut found = Vec::new();
        for i in 0..steps {
            let (mut low, mut high) = (at(i), at(i + 1));
            if phi(low) * phi(high) > 0.0 {
                continue;
            }
            let below = phi(low) < 0.0;
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if (phi(middle) < 0.0) == below { low = middle } else { high = middle }
            }
            found.push(0.5 * (low + high));
        }
        found
    }
}

fn random(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

fn random_scene(rng: &mut ChaCha8Rng) -> (Parameters, f64) {
    let m = [random(rng, 0.1, 10.0), random(rng, 0.1, 10.0)];
    let c = [random(rng, 1e4, 1e7), random(rng, 1e4, 1e7)];
    let displacement = random(rng, 1e-7, 1e-3);
    let parameters = Parameters {
        m,
        c,
        d: [random(rng, 1e-4, 0.3) * (c[0] * m[0]).sqrt(), random(rng, 1e-4, 0.3) * (c[1] * m[1]).sqrt()],
        excitation: random(rng, 1e-4, 1e4) * c[0] * displacement,
        displacement,
        force: random(rng, 1e-4, 1e6) * c[0] * displacement,
    };
    let resonance = (c[0] / m[0]).sqrt() / TAU;
    (parameters, random(rng, 0.05, 20.0) * resonance)
}

/// Random masses, stiffnesses, dampings and forces, F*/(c1 W*) from 1e-4 to 1e6: every solution is found, and is the
/// right one; stuck ones are recognised.
#[test]
fn every_solution_of_random_scenes() {
    let mut rng = ChaCha8Rng::seed_from_u64(2017);
    let (mut stuck, mut sliding, mut several) = (0, 0, 0);
    for case in 0..400 {
        let (parameters, hertz) = random_scene(&mut rng);
        let expected = parameters.amplitudes(hertz);
        let (g11, g12) = parameters.receptances(hertz);
        let limit = parameters.force * (0.98 + 0.21 * 0.01_f64.ln());
        let can_hold = (g12 * parameters.excitation).norm() <= (g11 * limit).norm();
        let mut settings = Settings::new(1);
        settings.all_solutions = true;
        let plan = Plan::new(&parameters.problem(), &settings).unwrap();
        let solution = plan.solve(hertz, &mut plan.workspace());
        let context = format!("case {case}: {parameters:?} at {hertz} Hz: {expected:?}");
        assert_eq!(solution.solutions, Some(expected.len() + usize::from(can_hold)), "{context}");
        if expected.is_empty() {
            assert_eq!(solution.status, Status::Stuck, "{context}");
            let holding = solution.contacts[0].force[0];
            let exact = -g12 * parameters.excitation / g11;
            assert!((holding - exact).norm() < 1e-12 * exact.norm(), "{context}");
            assert_eq!(solution.displacement[0][0], Complex64::ZERO, "{context}");
            stuck += 1;
            continue;
        }
        assert_eq!(solution.status, Status::Converged, "{context}");
        sliding += 1;
        several += usize::from(expected.len() > 1);
        let mut found = vec![&solution];
        found.extend(solution.others.iter().filter(|other| other.status == Status::Converged));
        for (a, one) in expected.iter().rev().zip(found) {
            let w = g12 * parameters.excitation / (1.0 + g11 * parameters.secant(*a));
            assert!((one.displacement[0][0] - w).norm() < 1e-9 * a, "{context}");
            assert!((one.contacts[0].amplitude - a).abs() < 1e-9 * a, "{context}");
        }
    }
    assert!(
        stuck > 20 && sliding > 200,
        "{stuck} stuck, {sliding} sliding, {several} with several solutions"
    );
}

/// The same balance iterated through time samples instead of solved in closed form.
#[test]
fn through_time_and_in_closed_form_alike() {
    let mut settings = Settings::new(1);
    let closed = Plan::new(&paper_scene(), &settings).unwrap();
    settings.start = Start::March;
    let sampled = Plan::new(&paper_scene(), &settings).unwrap();
    assert!(closed.facts().scalar && !sampled.facts().scalar);
    let (mut one, mut other) = (closed.workspace(), sampled.workspace());
    for hertz in (15..=200).map(f64::from) {
        let (a, b) = (closed.solve(hertz, &mut one), sampled.solve(hertz, &mut other));
        assert_eq!(b.status, Status::Converged, "{hertz} Hz");
        for (row, expected) in b.displacement.iter().zip(&a.displacement) {
            assert!((row[0] - expected[0]).norm() < 1e-12 * expected[0].norm(), "{hertz} Hz");
        }
        assert!((a.contacts[0].dissipation / b.contacts[0].dissipation - 1.0).abs() < 1e-11, "{hertz} Hz");
    }
}

/// What the paper states about its Fig. 4 and physics has to give for the reconstructed scene.
#[test]
fn the_papers_statements_hold_for_the_reconstructed_scene() {
    let plan = Plan::new(&paper_scene(), &Settings::new(1)).unwrap();
    let mut workspace = plan.workspace();
    let mut peak = |from: f64, to: f64, linear: bool| -> (f64, f64) {
        let points = (0..=4000).map(|i| from + (to - from) * f64::from(i) / 4000.0);
        let response = |hertz: f64| {
            let row = match linear {
                true => plan.linear_response(hertz, &mut workspace).unwrap(),
                false => plan.solve(hertz, &mut workspace).displacement,
            };
            (hertz, row[1][0].norm())
        };
        points.map(response).fold((0.0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
    };
    let (first, second) = (peak(30.0, 60.0, true), peak(90.0, 130.0, true));
    assert!((first.0 - 43.0).abs() < 0.5 && (second.0 - 108.0).abs() < 0.8, "{first:?} {second:?}");
    let (damped_first, damped_second) = (peak(50.0, 70.0, false), peak(90.0, 130.0, false));
    assert!((100.0 * (1.0 - damped_first.1 / first.1) - 96.0).abs() < 0.7, "{damped_first:?}");
    assert!((100.0 * (1.0 - damped_second.1 / second.1) - 72.0).abs() < 1.5, "{damped_second:?}");
    assert!((damped_first.0 - first.0 - 15.0).abs() < 0.7, "{damped_first:?}");
    assert!((damped_second.0 - second.0).abs() < 1.0, "{damped_second:?}");
}
