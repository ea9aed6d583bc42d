//! Structures in files: every form is the same model, a beam has the frequencies of the closed form, held dofs and base
//! motions do what they should, and a reduction changes nothing that counts.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use faer::Mat;
use scene::{Along, ContinuationOptions, Outcome, RunOptions, Scene};
use serde_json::{Value, json};
use tempfile::TempDir;

fn solve(scene: &Scene) -> Outcome {
    scene.prepare().unwrap().solve(&RunOptions { threads: Some(1), ..RunOptions::default() }).outcome()
}

fn read(scene: &Value, folder: &Path) -> Scene {
    Scene::from_str(&scene.to_string(), folder).unwrap()
}

/// |W_1| of the first output dof at every point.
fn amplitudes(outcome: &Outcome) -> Vec<f64> {
    let first = |point: &scene::Point| {
        assert_eq!(point.status, "converged");
        let (_, spectrum) = &point.displacement.as_ref().unwrap().0[0];
        spectrum.0.iter().find(|(k, _)| *k == 1).unwrap().1.norm()
    };
    outcome.points.iter().map(first).collect()
}

fn close(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{a} and {b}: {:e}", (a - b).abs() / b.abs());
    }
}

/// A matrix as a Matrix Market file; `part` says which entries are written.
fn matrix_market(matrix: &Mat<f64>, symmetry: &str, part: impl Fn(usize, usize) -> bool) -> String {
    let n = matrix.nrows();
    let places = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let lines: Vec<String> = places
        .filter(|&(i, j)| part(i, j) && matrix[(i, j)] != 0.0)
        .map(|(i, j)| format!("{} {} {:e}\n", i + 1, j + 1, matrix[(i, j)]))
        .collect();
    let header = format!("%%MatrixMarket matrix coordinate real {symmetry}\n{n} {n} {}\n", lines.len());
    header + &lines.concat()
}

fn two_mass() -> Value {
    json!({
        "name": "two-mass",
        "model": {
            "dofs": ["w1", "w2"],
            "mass": [[3.98, 0.0], [0.0, 1.27]],
            "damping": [[24.0, 0.0], [0.0, 24.0]],
            "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]
        },
        "excitation": [{ "dof": "w2", "amplitude": 9.1 }, { "kind": "base", "amplitude": 0.5 }],
        "contacts": [{ "name": "root", "between": ["w1", "ground"],
            "law": { "type": "elastic_coulomb", "stiffness": 6.7e6, "slip_force": 15.0 } }],
        "frequencies": [40.0, 52.0, 57.0, 110.0],
        "harmonics": 7
    })
}

#[test]
fn every_form_of_the_same_matrices_gives_the_same_result() {
    let written = two_mass();
    let expected = solve(&read(&written, Path::new("")));
    let stiffness = Mat::from_fn(2, 2, |i, j| [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]][i][j]);
    let mass = Mat::from_fn(2, 2, |i, j| if i == j { [3.98, 1.27][i] } else { 0.0 });
    let all = |_, _| true;
    type Part = fn(usize, usize) -> bool;
    let (lower, upper): (Part, Part) = (|i, j| i >= j, |i, j| i <= j);
    for (text, notes) in [
        (matrix_market(&stiffness, "general", all), 0),
        (matrix_market(&stiffness, "symmetric", lower), 0),
        (matrix_market(&stiffness, "symmetric", upper), 1),
        (matrix_market(&stiffness, "general", lower), 1),
        (matrix_market(&stiffness, "general", upper), 1),
    ] {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("K.mtx"), &text).unwrap();
        fs::write(folder.path().join("M.mtx"), matrix_market(&mass, "symmetric", all)).unwrap();
        fs::write(folder.path().join("names.txt"), "# names\nw1\n\nw2\n").unwrap();
        let mut scene = written.clone();
        scene["model"]["mass"] = json!({ "matrix_market": "M.mtx" });
        scene["model"]["stiffness"] = json!({ "matrix_market": "K.mtx" });
        scene["model"]["dofs"] = json!({ "file": "names.txt" });
        let outcome = solve(&read(&scene, folder.path()));
        assert_eq!(outcome.points, expected.points, "{text}");
        assert_eq!((outcome.reduction, outcome.notes.len()), (None, notes), "{text}");
        // Reduced onto one dof and all modes there are: the same structure in other coordinates.
        scene["model"]["reduction"] = json!({ "modes": 1 });
        scene["output"] = json!(["w1"]);
        scene["excitation"] =
            json!([{ "dof": "w1", "amplitude": 9.1 }, { "kind": "base", "amplitude": 0.5 }]);
        let reduced = solve(&read(&scene, folder.path()));
        let facts = reduced.reduction.unwrap();
        assert_eq!((facts.dofs, facts.kept, facts.modes), (2, 1, 1));
        scene["model"]["reduction"] = json!("none");
        close(&amplitudes(&reduced), &amplitudes(&solve(&read(&scene, folder.path()))), 1e-10);
    }
}

/// Euler-Bernoulli beam of `elements` elements along its length: displacement w and rotation r of every node.
struct Beam {
    elements: usize,
    length: f64,
    stiffness: f64,
    line_mass: f64,
}

const BEAM: Beam = Beam { elements: 24, length: 0.8, stiffness: 120.0, line_mass: 1.6 };

impl Beam {
    /// Cubic shape functions: stiffness and consistent mass of all nodes, the clamped one included.
    fn matrices(&self) -> (Mat<f64>, Mat<f64>) {
        let h = self.length / self.elements as f64;
        let k = self.stiffness / h.powi(3);
        let m = self.line_mass * h / 420.0;
        let stiffness = [
            [12.0, 6.0 * h, -12.0, 6.0 * h],
            [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
            [-12.0, -6.0 * h, 12.0, -6.0 * h],
            [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
        ];
        let mass = [
            [156.0, 22.0 * h, 54.0, -13.0 * h],
            [22.0 * h, 4.0 * h * h, 13.0 * h, -3.0 * h * h],
            [54.0, 13.0 * h, 156.0, -22.0 * h],
            [-13.0 * h, -3.0 * h * h, -22.0 * h, 4.0 * h * h],
        ];
        let n = 2 * (self.elements + 1);
        let (mut all_stiffness, mut all_mass) = (Mat::zeros(n, n), Mat::zeros(n, n));
        for element in 0..self.elements {
            for i in 0..4 {
                for j in 0..4 {
                    all_stiffness[(2 * element + i, 2 * element + j)] += k * stiffness[i][j];
                    all_mass[(2 * element + i, 2 * element + j)] += m * mass[i][j];
                }
            }
        }
        (all_stiffness, all_mass)
    }

    /// Files and a scene: node 1 clamped, a force at the free end, a contact in the middle.
    fn write(&self, folder: &Path) -> Value {
        let (stiffness, mass) = self.matrices();
        let lower = |i, j| i >= j;
        fs::write(folder.join("K.mtx"), matrix_market(&stiffness, "symmetric", lower)).unwrap();
        fs::write(folder.join("M.mtx"), matrix_market(&mass, "symmetric", lower)).unwrap();
        let names = (1..=self.elements + 1).map(|node| format!("{node}, w\n{node}, r\n"));
        fs::write(folder.join("names.txt"), names.collect::<String>()).unwrap();
        json!({
            "name": "beam",
            "model": {
                "dofs": { "file": "names.txt" }, "fixed": "1:*",
                "mass": { "matrix_market": "M.mtx" }, "stiffness": { "matrix_market": "K.mtx" },
                "damping": { "rayleigh": { "mass": 0.5, "stiffness": 1e-5 } }
            },
            "excitation": [{ "dof": self.tip(), "amplitude": 1.0 }],
            "contacts": [{ "name": "middle", "between": [format!("{}:w", self.elements / 2 + 1), "ground"],
                "law": { "type": "elastic_coulomb", "stiffness": 2e4, "slip_force": 0.2 } }],
            "frequencies": [5.0, 14.0, 45.0],
            "harmonics": 5,
            "output": [self.tip()]
        })
    }

    fn tip(&self) -> String {
        format!("{}:w", self.elements + 1)
    }

    /// (βL)² √(EI/(μ L⁴))/2π in Hz of the clamped beam.
    fn natural_frequency(&self, root: f64) -> f64 {
        root * root * (self.stiffness / (self.line_mass * self.length.powi(4))).sqrt() / TAU
    }
}

/// Roots βL of cos βL cosh βL = −1.
const ROOTS: [f64; 3] = [1.875_104_068_711_961, 4.694_091_132_974_174, 7.854_757_438_237_613];

#[test]
fn a_clamped_beam_has_the_frequencies_of_the_closed_form() {
    let folder = TempDir::new().unwrap();
    let mut scene = BEAM.write(folder.path());
    scene["frequencies"] = json!([5.0, 200.0]);
    for reduction in [json!("none"), json!({ "tolerance": 1e-7 })] {
        scene["model"]["reduction"] = reduction.clone();
        let read = read(&scene, folder.path());
        assert_eq!(read.dofs().len(), 48);
        let found = read.problem().unwrap().model.natural_frequencies();
        for root in ROOTS {
            let expected = BEAM.natural_frequency(root);
            let nearest = found.iter().map(|f| (f - expected).abs()).fold(f64::INFINITY, f64::min) / expected;
            // Cubic elements of length h: (βh)⁴/1440 and higher orders. Rounding: the highest of the frequencies is 10⁴
            // times the lowest, and its square counts.
            let elements = (root / BEAM.elements as f64).powi(4) / 1440.0;
            assert!(nearest < 1.1 * elements + 1e-6, "{reduction} {expected}: off by {nearest:e}");
        }
    }
}

#[test]
fn a_reduced_structure_answers_as_the_full_one() {
    let folder = TempDir::new().unwrap();
    let mut scene = BEAM.write(folder.path());
    scene["model"]["reduction"] = json!({ "tolerance": 1e-4 });
    let reduced = solve(&read(&scene, folder.path()));
    let facts = reduced.reduction.unwrap();
    assert_eq!((facts.dofs, facts.kept), (48, 2));
    assert!(facts.modes < 46 && facts.error.unwrap() <= 1e-4, "{facts:?}");
    scene["model"]["reduction"] = json!("none");
    let full = solve(&read(&scene, folder.path()));
    assert_eq!(full.reduction, None);
    close(&amplitudes(&reduced), &amplitudes(&full), 3e-4);
    let state = |outcome: &Outcome| -> Vec<&str> {
        outcome.points.iter().map(|point| point.contacts.as_ref().unwrap().0[0].1.state()).collect()
    };
    assert_eq!(state(&reduced), state(&full));
    assert!(state(&full).contains(&"mixed"));
}

#[test]
fn a_base_moves_in_its_direction_and_takes_the_clamp_along() {
    // Static deflection of a clamped beam under its own inertia: w(L) = −a μ L⁴/(8 EI). The consistent mass between the
    // clamped node and its neighbour counts; the rotations do not move with the base.
    let folder = TempDir::new().unwrap();
    let mut scene = BEAM.write(folder.path());
    scene["contacts"] = json!([]);
    scene["frequencies"] = json!([0.0]);
    scene["harmonics"] = json!(1);
    scene["excitation"] = json!([{ "kind": "base", "amplitude": 9.81, "direction": "w" }]);
    let expected = 9.81 * BEAM.line_mass * BEAM.length.powi(4) / (8.0 * BEAM.stiffness);
    for reduction in [json!("none"), json!({ "tolerance": 1e-8 })] {
        scene["model"]["reduction"] = reduction;
        let found = amplitudes(&solve(&read(&scene, folder.path())));
        close(&found, &[expected], 1e-7);
    }
    scene["excitation"] = json!([{ "kind": "base", "amplitude": 9.81 }]);
    let alike = read(&scene, folder.path());
    assert!(alike.notes()[0].contains("the base moves every dof alike"), "{:?}", alike.notes());
    assert!((amplitudes(&solve(&alike))[0] / expected - 1.0).abs() > 1e-5);
}

#[test]
fn held_dofs_are_as_good_as_none() {
    let mut scene = two_mass();
    scene["model"]["dofs"] = json!(["a:x", "a:y", "b:x"]);
    scene["model"]["mass"] = json!([[3.98, 0.1, 0.0], [0.1, 2.0, 0.2], [0.0, 0.2, 1.27]]);
    scene["model"]["stiffness"] = json!([[8.2e5, 1e5, -4.1e5], [1e5, 7e5, 2e5], [-4.1e5, 2e5, 4.1e5]]);
    scene["model"]["damping"] = json!({ "modal_ratio": 0.01 });
    scene["model"]["fixed"] = json!(["*:y"]);
    scene["excitation"] = json!([{ "dof": "b:x", "amplitude": 9.1 }]);
    scene["contacts"][0]["between"] = json!(["a:x", "ground"]);
    let held = read(&scene, Path::new(""));
    assert_eq!(held.dofs(), ["a:x", "b:x"]);
    let mut small = two_mass();
    small["model"]["damping"] = json!({ "modal_ratio": 0.01 });
    small["excitation"] = json!([{ "dof": "w2", "amplitude": 9.1 }]);
    assert_eq!(amplitudes(&solve(&held)), amplitudes(&solve(&read(&small, Path::new("")))));
    // The base takes the held dof along: its inertia acts on the others.
    scene["excitation"] = json!([{ "kind": "base", "amplitude": 2.0, "direction": "y" }]);
    let loads = read(&scene, Path::new("")).problem().unwrap().model.base_loads().to_vec();
    assert_eq!(loads, [[0.1, 0.2]]);
}

#[test]
fn curves_and_variants_work_on_a_reduced_structure() {
    let folder = TempDir::new().unwrap();
    let mut scene = BEAM.write(folder.path());
    scene["model"]["reduction"] = json!({ "tolerance": 1e-7 });
    let file = folder.path().join("scene.json");
    fs::write(&file, scene.to_string()).unwrap();
    let scene = Scene::from_file(&file).unwrap();
    let options = ContinuationOptions::default();
    let curve = scene.curve(Along::Frequency, (5.0, 14.0), None, &options).unwrap();
    assert_eq!(curve.end, "reached");
    let ends =
        [&curve.points[0], curve.points.last().unwrap()].map(|point| curve.amplitude(0, point).unwrap());
    let points = amplitudes(&solve(&scene));
    close(&ends, &points[..2], 1e-5);
    let variants = scene::Variants::from_file(&file).unwrap();
    let pointer = "/contacts/0/law/slip_force";
    let along = Along::Entry { pointer, frequency: 14.0 };
    let curve = scene.curve(along, (0.2, 0.3), Some(&variants), &options).unwrap();
    assert_eq!((curve.end, curve.reduction.unwrap().kept), ("reached", 2));
    close(&[curve.amplitude(0, &curve.points[0]).unwrap()], &points[1..2], 1e-5);
}

#[test]
fn a_long_rod_is_reduced_without_being_asked() {
    // Linear elements with consistent mass of a rod, one end held: the discrete equations have the closed form
    // ω² = 6 c² (1 − cos κh)/(h² (2 + cos κh)), κ = (2 k − 1) π/(2 L), with c² = EA/μ.
    let (elements, length, stiffness, line_mass) = (400, 2.0, 5e6, 0.8);
    let (h, n) = (length / elements as f64, elements + 1);
    let ends = |i: usize| if i == 0 || i == elements { 0.5 } else { 1.0 };
    let tridiagonal = |diagonal: f64, beside: f64| {
        Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => diagonal * ends(i),
            1 => beside,
            _ => 0.0,
        })
    };
    let folder = TempDir::new().unwrap();
    let write = |name: &str, matrix: Mat<f64>| {
        fs::write(folder.path().join(name), matrix_market(&matrix, "symmetric", |i, j| i >= j)).unwrap();
    };
    write("K.mtx", tridiagonal(2.0 * stiffness / h, -stiffness / h));
    write("M.mtx", tridiagonal(4.0 * line_mass * h / 6.0, line_mass * h / 6.0));
    let scene = json!({
        "model": { "mass": { "matrix_market": "M.mtx" }, "stiffness": { "matrix_market": "K.mtx" },
            "damping": { "modal_ratio": 0.001 }, "fixed": ["1"] },
        "excitation": [{ "dof": "401", "amplitude": 1.0 }],
        "contacts": [{ "name": "c", "between": ["200", "ground"], "law": { "type": "linear", "stiffness": 0.0 } }],
        "frequencies": [100.0, 2000.0]
    });
    let scene = read(&scene, folder.path());
    let facts = scene.prepare().unwrap().reduction().unwrap();
    assert_eq!((facts.dofs, facts.kept), (400, 2));
    assert!(facts.modes < 398 && facts.error.unwrap() <= 1e-4, "{facts:?}");
    let found = scene.problem().unwrap().model.natural_frequencies();
    for (k, found) in (1..=3).zip(found) {
        let cos = ((2 * k - 1) as f64 * 0.5 * std::f64::consts::PI / length * h).cos();
        let square = 6.0 * stiffness / line_mass * (1.0 - cos) / (h * h * (2.0 + cos));
        let expected = square.sqrt() / TAU;
        // The response is resonant with 1/(2 · 0.001): it shows an error of the frequency a thousandfold.
        assert!((found - expected).abs() < 1e-6 * expected, "{found} {expected}");
    }
    let other = scene.with_harmonics(15).unwrap();
    let more = other.prepare().unwrap().reduction().unwrap();
    assert!(more.modes > facts.modes, "{more:?} {facts:?}");
    // Settled, it stays what it was.
    let settled = other.settled().unwrap().with_harmonics(1).unwrap();
    assert_eq!(settled.prepare().unwrap().reduction(), Some(more));
}
