//! The paper's numbers from the reconstructed scenes alone: files → Cramer's rule and closed formulas for everything
//! linear, a peak search of its own through the public solver for the rest.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use contact::{ElasticCoulomb, ElasticCoulombParameters, Law, MagnitudeLaw, PhaseLaw, ScaledLoop};
use faer::mat;
use hbm::{Plan, Problem, Settings, Status};
use num_complex::Complex64;
use serde_json::Value;
use stickslip_tests::{force, model, to_ground};

/// What the scene's file says.
#[derive(Debug, Clone, PartialEq)]
struct Structure {
    m: [f64; 2],
    d: f64,
    c: f64,
    excitation: f64,
}

fn read(name: &str) -> (Structure, Value) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
    let scene: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let entry = |matrix: &str, i: usize, j: usize| scene["model"][matrix][i][j].as_f64().unwrap();
    let structure = Structure {
        m: [entry("mass", 0, 0), entry("mass", 1, 1)],
        d: entry("damping", 0, 0),
        c: entry("stiffness", 1, 1),
        excitation: scene["excitation"][0]["amplitude"].as_f64().unwrap(),
    };
    // c1 = c2, one damper on both masses.
    assert_eq!(entry("stiffness", 0, 0), 2.0 * structure.c);
    assert_eq!((entry("stiffness", 0, 1), entry("damping", 1, 1)), (-structure.c, structure.d));
    assert!(scene["comment"].as_str().unwrap().contains("reconstructed"));
    (structure, scene["contacts"][0]["law"].clone())
}

impl Structure {
    /// |W_1| of both masses with a spring `k` on m1, by Cramer's rule.
    fn with_spring(&self, k: f64, hertz: f64) -> [f64; 2] {
        let omega = TAU * hertz;
        let h = |m: f64, c: f64| Complex64::new(c - omega * omega * m, omega * self.d);
        let (h11, h22) = (h(self.m[0], 2.0 * self.c + k), h(self.m[1], self.c));
        let det = h11 * h22 - self.c * self.c;
        [(self.c * self.excitation / det).norm(), (h11 * self.excitation / det).norm()]
    }

    fn problem(&self, law: Arc<dyn Law>) -> Problem {
        Problem {
            joints: Vec::new(),
            model: model(
                mat![[self.m[0], 0.0], [0.0, self.m[1]]],
                mat![[self.d, 0.0], [0.0, self.d]],
                mat![[2.0 * self.c, -self.c], [-self.c, self.c]],
            ),
            excitation: vec![force(1, self.excitation)],
            contacts: vec![to_ground(law)],
            output: vec![0, 1],
        }
    }
}

/// Place and height of the highest point of `curve`, by ever finer scans.
fn peak(mut from: f64, mut to: f64, curve: impl Fn(f64) -> f64) -> (f64, f64) {
    let outer = (from, to);
    let mut best = (from, 0.0);
    for _ in 0..8 {
        let step = (to - from) / 60.0;
        for i in 0..=60 {
            let f = from + f64::from(i) * step;
            let height = curve(f);
            if height > best.1 {
                best = (f, height);
            }
        }
        (from, to) = (best.0 - 2.0 * step, best.0 + 2.0 * step);
    }
    assert!(best.0 > outer.0 && best.0 < outer.1, "no peak between {outer:?}");
    best
}

fn solver(problem: Problem) -> impl Fn(f64, usize) -> f64 {
    let plan = Plan::new(&problem, &Settings::new(1)).unwrap();
    move |hertz, output| {
        let mut workspace = plan.workspace();
        let solution = plan.solve(hertz, &mut workspace);
        assert_eq!(solution.status, Status::Converged, "{hertz} Hz");
        solution.displacement[output][0].norm()
    }
}

/// W* = 8 µm and the assumed F* = 12 N.
fn paper_law() -> Arc<dyn Law> {
    Arc::new(ScaledLoop::ellipse(8e-6, 12.0, MagnitudeLaw::default(), PhaseLaw::default()).unwrap())
}

#[track_caller]
fn near(value: f64, stated: f64, tolerance: f64) {
    assert!((value - stated).abs() <= tolerance, "{value}, not {stated} ± {tolerance}");
}

#[test]
fn resonances_and_reductions_are_those_of_fig_4() {
    let (structure, law) = read("hoffmann-2017.json");
    assert_eq!(law["type"], "scaled_loop");
    let linear = |f: f64| structure.with_spring(0.0, f)[1];
    let (first, second) = (peak(30.0, 60.0, linear), peak(90.0, 130.0, linear));
    near(first.0, 43.0, 0.5);
    near(second.0, 108.0, 0.7);

    let response = solver(structure.problem(paper_law()));
    let (damped_first, damped_second) =
        (peak(50.0, 70.0, |f| response(f, 1)), peak(95.0, 125.0, |f| response(f, 1)));
    near(100.0 * (1.0 - damped_first.1 / first.1), 96.0, 0.5);
    near(100.0 * (1.0 - damped_second.1 / second.1), 72.0, 1.0);
    near(damped_first.0, 58.0, 0.7);
    assert!((damped_second.0 - second.0).abs() < 1.0, "{damped_second:?} {second:?}");
}

#[test]
fn undamped_resonances_solve_the_characteristic_equation() {
    let (structure, _) = read("hoffmann-2017.json");
    let ([m1, m2], c) = (structure.m, structure.c);
    // m1 m2 λ² − (c m1 + 2 c m2) λ + c² = 0, λ = ω².
    let (half, product) = (0.5 * c * (m1 + 2.0 * m2) / (m1 * m2), c * c / (m1 * m2));
    let root = (half * half - product).sqrt();
    near((half - root).sqrt() / TAU, 43.0, 0.5);
    near((half + root).sqrt() / TAU, 108.0, 0.7);
}

#[test]
fn elastic_coulomb_is_tuned_to_the_static_response_and_bends_where_stated() {
    let (structure, law) = read("hoffmann-2017-elastic-coulomb.json");
    assert_eq!(structure, read("hoffmann-2017.json").0);
    let (stiffness, slip_force) = (law["stiffness"].as_f64().unwrap(), law["slip_force"].as_f64().unwrap());

    // Static: (1/c2 + 1/(c1 + k_t)) f̂ while the contact sticks, against the law's by the solver.
    let static_blade = structure.excitation * (1.0 / structure.c + 1.0 / (structure.c + stiffness));
    let response = solver(structure.problem(paper_law()));
    near(response(1e-3, 1) / static_blade, 1.0, 0.005);

    // Slip where |w1| of the sticking system passes x_c: lowest and highest such frequency.
    let slips = |f: f64| structure.with_spring(stiffness, f)[0] > slip_force / stiffness;
    let places: Vec<f64> = (1..=20_000).map(|i| 0.01 * f64::from(i)).collect();
    let first = places.iter().copied().find(|f| slips(*f)).unwrap();
    let last = places.iter().copied().filter(|f| *f < 160.0).rfind(|f| slips(*f)).unwrap();
    near(first, 55.0, 1.0);
    near(last, 118.0, 1.5);

    // And the balance itself: on the sticking branch outside, off it inside.
    let parameters = ElasticCoulombParameters { stiffness, slip_force };
    let response = solver(structure.problem(Arc::new(ElasticCoulomb::new(parameters).unwrap())));
    let off = |f: f64| (response(f, 0) / structure.with_spring(stiffness, f)[0] - 1.0).abs();
    for f in [first - 0.5, last + 0.5] {
        assert!(off(f) < 1e-9, "{f} Hz: {}", off(f));
    }
    for f in [first + 1.0, last - 1.0] {
        assert!(off(f) > 1e-4, "{f} Hz: {}", off(f));
    }
}
