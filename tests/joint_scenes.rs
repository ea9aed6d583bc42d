//! Scenes with contacts in several directions, from their text to their results.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use num_complex::Complex64;
use scene::{ContactOutcome, JointPoint, Outcome, RunOptions, Scene};
use serde_json::{Value, json};

type Matrix = [[f64; 3]; 3];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const STIFFNESS: Matrix = [[4.0e5, 0.0, 1.0e5], [0.0, 6.0e5, 5.0e4], [1.0e5, 5.0e4, 9.0e5]];

fn friction() -> Value {
    json!({
        "type": "friction_contact", "tangential_stiffness": 3e5, "normal_stiffness": 4e5, "friction_coefficient": 0.3,
        "preload": 30.0
    })
}

fn solve(scene: &Value) -> Outcome {
    let scene = Scene::from_str(&scene.to_string(), Path::new(".")).unwrap();
    let outcome = scene.prepare().unwrap().solve(&RunOptions::default()).outcome();
    assert!(outcome.points.iter().all(|point| point.status == "converged"), "{:?}", outcome.points);
    outcome
}

fn displacement(outcome: &Outcome, point: usize, dof: usize) -> Vec<Complex64> {
    let named = outcome.points[point].displacement.as_ref().unwrap();
    named.0[dof].1.0.iter().map(|(_, w)| *w).collect()
}

fn joint<'o>(outcome: &'o Outcome, point: usize, name: &str) -> &'o JointPoint {
    let named = outcome.points[point].contacts.as_ref().unwrap();
    match &named.0.iter().find(|(own, _)| own == name).unwrap().1 {
        ContactOutcome::Several(joint) => joint,
        ContactOutcome::One(_) => panic!("{name} acts in one direction"),
    }
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// A mass on springs that rubs on the ground, its dofs along the columns of `turn`; the axes of the contact stay.
fn turned(turn: &Matrix) -> Value {
    let stiffness = times(&times(&transposed(turn), &STIFFNESS), turn);
    // Symmetric to the last digit.
    let stiffness: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (stiffness[i][j] + stiffness[j][i])));
    let in_dofs = |vector: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| (0..3).map(|k| turn[k][i] * vector[k]).sum::<f64>())
    };
    let force = |vector: [f64; 3], phase: f64| {
        let parts = in_dofs(vector).into_iter().zip(["1:x", "1:y", "1:z"]);
        parts
            .map(move |(part, dof)| json!({ "dof": dof, "amplitude": part, "phase": phase }))
            .collect::<Vec<_>>()
    };
    let excitation = [force([25.0, 0.0, 10.0], 0.0), force([0.0, 12.0, 20.0], 1.0)].concat();
    json!({
        "model": {
            "dofs": ["1:x", "1:y", "1:z"], "mass": IDENTITY, "damping": { "modal_ratio": 0.01 }, "stiffness": stiffness
        },
        "excitation": excitation,
        "contacts": [{
            "name": "rub", "nodes": ["1", "ground"], "law": friction(),
            "axes": {
                "tangential": [in_dofs([1.0, 0.0, 0.0]), in_dofs([0.0, 1.0, 0.0])], "normal": in_dofs([0.0, 0.0, 1.0])
            }
        }],
        "frequencies": [90.0, 125.0, 160.0],
        "harmonics": 5,
        "solver": { "samples": 512 }
    })
}

#[test]
fn axes_at_an_angle_are_axes_along_dofs_of_a_turned_model() {
    let (s, c) = 0.7_f64.sin_cos();
    let about_z = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
    let about_x = [[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]];
    let turn = times(&about_z, &about_x);
    let (along, angled) = (solve(&turned(&IDENTITY)), solve(&turned(&turn)));
    let mut states = Vec::new();
    for point in 0..3 {
        let size: f64 = (0..3).flat_map(|dof| displacement(&along, point, dof)).map(|w| w.norm_sqr()).sum();
        for (i, row) in turn.iter().enumerate() {
            let own = displacement(&along, point, i);
            let back =
                |k: usize| (0..3).map(|j| displacement(&angled, point, j)[k] * row[j]).sum::<Complex64>();
            let distance: f64 = own.iter().enumerate().map(|(k, w)| (back(k) - w).norm_sqr()).sum();
            assert!(distance < 1e-18 * size, "point {point}, direction {i}: {:e}", (distance / size).sqrt());
        }
        let (a, b) = (joint(&along, point, "rub"), joint(&angled, point, "rub"));
        assert!((a.dissipation / b.dissipation - 1.0).abs() < 1e-7, "{a:?} {b:?}");
        assert_eq!((a.state, a.cycles), (b.state, b.cycles));
        states.push(a.state);
    }
    assert!(states.contains(&"mixed"), "{states:?}");
}

#[test]
fn pairs_of_nodes_are_pairs_of_dofs() {
    // Two masses that rub on each other, the second one on the ground as well.
    let diagonal = |values: [f64; 6]| -> Value {
        json!(
            (0..6)
                .map(|i| (0..6).map(|j| if i == j { values[i] } else { 0.0 }).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        )
    };
    let scene = |more: Value| {
        let mut contact = json!({ "name": "rub", "law": friction(), "scale": 0.5 });
        contact.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        json!({
            "model": {
                "dofs": ["1:x", "1:y", "1:z", "2:x", "2:y", "2:z"],
                "mass": diagonal([1.0, 1.0, 1.0, 0.5, 0.5, 0.5]),
                "damping": { "modal_ratio": 0.01 },
                "stiffness": diagonal([4e5, 5e5, 6e5, 3e5, 2e5, 4e5])
            },
            "excitation": [{ "dof": "1:x", "amplitude": 20.0 }, { "dof": "2:z", "amplitude": 20.0, "phase": 0.5 }],
            "contacts": [contact],
            "frequencies": [80.0, 110.0],
            "harmonics": 3
        })
    };
    let nodes = solve(&scene(json!({
        "node_pairs": [["1", "2"], ["2", "ground"]],
        "axes": { "normal": [0, 0, 2], "tangential": [[1, 0, 0], [0, 3, 0]] }
    })));
    let dofs = solve(&scene(json!({ "directions": [
        { "tangential": [["1:x", "2:x"], ["1:y", "2:y"]], "normal": ["1:z", "2:z"] },
        { "tangential": [["2:x", "ground"], ["2:y", "ground"]], "normal": ["2:z", "ground"] }
    ] })));
    assert_eq!(nodes.points, dofs.points);
    assert!(joint(&nodes, 0, "rub[1]").dissipation > 0.0, "{:?}", nodes.points[0].contacts);
}

/// A mass with two dofs that do not know of each other, so that the normal load stays what it is.
fn steady(contact: &Value) -> Value {
    json!({
        "model": {
            "dofs": ["t", "n"], "mass": [[1.0, 0.0], [0.0, 1.0]], "damping": [[10.0, 0.0], [0.0, 10.0]],
            "stiffness": [[2e5, 0.0], [0.0, 3e5]]
        },
        "excitation": [{ "dof": "t", "amplitude": 15.0 }],
        "contacts": [contact],
        "frequencies": [60.0, 75.0, 90.0],
        "harmonics": 9,
        "output": ["t"]
    })
}

fn distance(a: &Outcome, b: &Outcome, point: usize) -> f64 {
    // Odd laws have odd harmonics only; the others are zero.
    let spectrum = |outcome: &Outcome| {
        let mut dense = vec![Complex64::ZERO; 16];
        let named = outcome.points[point].displacement.as_ref().unwrap();
        named.0[0].1.0.iter().for_each(|(k, w)| dense[*k] = *w);
        dense
    };
    let (a, b) = (spectrum(a), spectrum(b));
    let error: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (error / a.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}

#[test]
fn under_a_steady_load_friction_is_elastic_coulomb() {
    let directions = json!({ "tangential": ["t", "ground"], "normal": ["n", "ground"] });
    let mut several = steady(&json!({ "name": "c", "law": friction(), "directions": directions }));
    several["solver"] = json!({ "samples": 4096 });
    let several = solve(&several);
    let law = json!({ "type": "elastic_coulomb", "stiffness": 3e5, "slip_force": 9.0 });
    let one = solve(&steady(&json!({ "name": "c", "law": law, "between": ["t", "ground"] })));
    for point in 0..3 {
        let error = distance(&one, &several, point);
        // One law is evaluated by its events, the other at samples: O(M⁻²), 2.8e-4 with 256 of them.
        assert!(error < 3e-6, "{error:e}");
        let ContactOutcome::One(contact) = &one.points[point].contacts.as_ref().unwrap().0[0].1 else {
            panic!()
        };
        let joint = joint(&several, point, "c");
        assert_eq!(joint.state, contact.state);
        assert!((joint.dissipation - contact.dissipation).abs() <= 1e-3 * contact.dissipation);
    }
}

#[test]
fn under_its_own_load_a_loaded_loop_is_the_measured_one() {
    let law = |more: Value| {
        let mut law = json!({
            "type": "scaled_loop", "loop": { "displacement": 3e-5, "harmonics": [[1, 0.4, 8.0], [3, 0.5, 1.5]] }
        });
        law.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        law
    };
    let loaded = law(json!({ "normal_load": { "reference": 20.0, "stiffness": 1e6, "preload": 20.0 } }));
    let directions = json!({ "tangential": ["t", "ground"], "normal": ["n", "ground"] });
    let several = solve(&steady(&json!({ "name": "c", "law": loaded, "directions": directions })));
    let one = solve(&steady(&json!({ "name": "c", "law": law(json!({})), "between": ["t", "ground"] })));
    for point in 0..3 {
        let error = distance(&one, &several, point);
        assert!(error < 1e-6, "{error:e}");
    }
}

#[test]
fn a_stop_is_a_spring_where_it_is_always_met() {
    // Interference far beyond the motion: a linear spring and a static load.
    let stop = json!({ "type": "gap", "stiffness": 1e5, "gap": -1e-2 });
    let stop = solve(&steady(&json!({ "name": "c", "law": stop, "between": ["t", "ground"] })));
    let spring = json!({ "type": "linear", "stiffness": 1e5 });
    let spring = solve(&steady(&json!({ "name": "c", "law": spring, "between": ["t", "ground"] })));
    for point in 0..3 {
        let (a, b) = (displacement(&stop, point, 0), displacement(&spring, point, 0));
        // (k + k_c) w₀ = −k_c · 0.01 m: it is pushed away.
        assert!((a[0].re + 1e5 * 1e-2 / 3e5).abs() < 1e-12, "{}", a[0]);
        let first = b.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
        assert!((a[1] - first).norm() < 1e-9 * first.norm(), "{} {first}", a[1]);
    }
}

#[test]
fn results_have_every_field() {
    let mut scene = turned(&IDENTITY);
    let spring = json!({ "name": "spring", "between": ["1:x", "ground"], "law": { "type": "linear", "stiffness": 1.0 } });
    let pad = json!({
        "name": "pad", "nodes": ["1", "ground"], "law": friction(),
        "axes": { "tangential": [1, 0, 0], "normal": [0, 1, 0] }
    });
    let contacts = scene["contacts"].as_array_mut().unwrap();
    contacts.insert(0, pad);
    contacts.insert(1, spring);
    let solved = solve(&scene);
    let names = solved.points[0].contacts.as_ref().unwrap().0.iter().map(|(name, _)| name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["pad", "spring", "rub"]);
    let outcome = serde_json::to_value(solved).unwrap();
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    for point in outcome["points"].as_array().unwrap() {
        assert_eq!(keys(&point["contacts"]).len(), 3);
        let rub = &point["contacts"]["rub"];
        let mut found = keys(rub);
        found.sort();
        assert_eq!(found, ["apart", "cycles", "directions", "dissipation", "extrapolated", "state"]);
        assert!((0.0..=1.0).contains(&rub["apart"].as_f64().unwrap()));
        assert!(rub["cycles"].as_u64().unwrap() >= 1);
        let mut names = keys(&rub["directions"]);
        names.sort();
        assert_eq!(names, ["normal", "tangential1", "tangential2"]);
        assert_eq!(keys(&point["contacts"]["pad"]["directions"]).len(), 2);
        assert!(point["contacts"]["pad"]["directions"]["tangential"].is_object());
        for direction in names {
            let direction = &rub["directions"][direction];
            assert!(direction["amplitude"].as_f64().unwrap() > 0.0);
            // The mean and five harmonics, even ones among them.
            for key in ["displacement", "force"] {
                let orders: Vec<u64> =
                    direction[key].as_array().unwrap().iter().map(|line| line[0].as_u64().unwrap()).collect();
                assert_eq!(orders, [0, 1, 2, 3, 4, 5]);
            }
        }
        // The work of the forces over a period is what is dissipated: Σ π k Im(F W*) with the force on the first body.
        let number = |value: &Value, i: usize| value[i].as_f64().unwrap();
        let mut work = 0.0;
        for direction in ["tangential1", "tangential2", "normal"].map(|name| &rub["directions"][name]) {
            let (w, f) =
                (direction["displacement"].as_array().unwrap(), direction["force"].as_array().unwrap());
            for (k, (w, f)) in w.iter().zip(f).enumerate() {
                let (w, f) =
                    (Complex64::new(number(w, 1), number(w, 2)), Complex64::new(number(f, 1), number(f, 2)));
                work += std::f64::consts::PI * k as f64 * (f * w.conj()).im;
            }
        }
        let dissipation = rub["dissipation"].as_f64().unwrap();
        assert!((work + dissipation).abs() <= 1e-6 * dissipation.abs() + 1e-15, "{work:e} {dissipation:e}");
    }
    let scene = Scene::from_str(&scene.to_string(), Path::new(".")).unwrap();
    assert_eq!(scene.contacts().collect::<Vec<_>>(), ["pad", "spring", "rub"]);
    let steps = scene.prepare().unwrap().explain();
    let step = |what: &str| steps.iter().find(|step| step.what == what).unwrap();
    assert!(
        step("contacts in several directions").why.starts_with("1 with one tangential direction, 1 with two")
    );
    assert!(step("contacts in several directions").why.contains("512 instants"));
    assert!(step("even harmonics and the mean").used);
}

#[test]
fn a_reduced_structure_answers_like_the_whole_one() {
    // A bar of nodes with three dofs each, its end rubbing on the ground under an angle.
    let nodes = 24;
    let n = 3 * nodes;
    let mut stiffness = vec![vec![0.0; n]; n];
    let mut mass = vec![vec![0.0; n]; n];
    for node in 0..nodes {
        for (direction, spring) in [6e7, 2e7, 4e7].into_iter().enumerate() {
            let i = 3 * node + direction;
            mass[i][i] = 0.05;
            stiffness[i][i] += spring;
            if node > 0 {
                stiffness[i - 3][i - 3] += spring;
                stiffness[i][i - 3] -= spring;
                stiffness[i - 3][i] -= spring;
            }
        }
    }
    let names = (0..n).map(|i| format!("{}:{}", i / 3 + 1, ["x", "y", "z"][i % 3])).collect::<Vec<_>>();
    let end = format!("{nodes}");
    let scene = |reduction: Value| {
        json!({
            "model": {
                "dofs": names, "mass": mass, "stiffness": stiffness,
                "damping": { "rayleigh": { "mass": 10.0, "stiffness": 1e-6 } }, "reduction": reduction
            },
            "excitation": [
                { "dof": "12:x", "amplitude": 60.0 }, { "dof": "12:y", "amplitude": 60.0, "phase": 0.6 },
                { "dof": "12:z", "amplitude": 60.0, "phase": 1.2 }
            ],
            "contacts": [{
                "name": "end", "nodes": [end, "ground"], "axes": { "normal": [0, 0.6, 0.8] },
                "law": {
                    "type": "friction_contact", "tangential_stiffness": 2e6, "normal_stiffness": 3e6,
                    "friction_coefficient": 0.4, "preload": 30.0
                }
            }],
            "frequencies": [200.0, 290.0, 330.0],
            "harmonics": 5,
            "output": ["12:x", "12:y", "12:z"]
        })
    };
    let (whole, reduced) = (solve(&scene(json!("none"))), solve(&scene(json!({ "tolerance": 1e-6 }))));
    let facts = reduced.reduction.unwrap();
    assert_eq!((facts.dofs, facts.kept), (n, 6));
    assert!(whole.reduction.is_none() && facts.modes < 40, "{facts:?}");
    for point in 0..3 {
        let rows =
            |outcome: &Outcome| (0..3).flat_map(|dof| displacement(outcome, point, dof)).collect::<Vec<_>>();
        let (a, b) = (rows(&whole), rows(&reduced));
        let error: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).norm_sqr()).sum();
        let error = (error / a.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt();
        println!("point {point}: {error:e}, reported {:?}", facts.error);
        assert!(error < facts.error.unwrap().max(1e-8), "{error:e} of {facts:?}");
        assert_eq!(joint(&whole, point, "end").state, joint(&reduced, point, "end").state);
    }
    assert!((0..3).any(|point| joint(&whole, point, "end").state == "mixed"));
}
