//! From scenes to results: what is recovered, how contacts are named, what zero excitation gives.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use scene::{Outcome, RunOptions, Scene};
use serde_json::{Value, json};

fn solve(scene: &Value) -> Outcome {
    let scene = Scene::from_str(&scene.to_string(), Path::new(".")).unwrap();
    let prepared = scene.prepare().unwrap();
    prepared.solve(&RunOptions::default()).outcome()
}

/// A chain of `n` equal masses, the first held by a spring.
fn chain(n: usize) -> Value {
    let row = |diagonal: f64, beside: f64, i: usize| -> Vec<f64> {
        (0..n)
            .map(|j| {
                if i == j {
                    diagonal
                } else if i.abs_diff(j) == 1 {
                    beside
                } else {
                    0.0
                }
            })
            .collect()
    };
    let matrix = |diagonal, beside| (0..n).map(|i| row(diagonal, beside, i)).collect::<Vec<_>>();
    json!({
        "name": "chain",
        "model": {
            "dofs": (0..n).map(|i| format!("w{i}")).collect::<Vec<_>>(),
            "mass": matrix(1.0, 0.0), "damping": matrix(5.0, 0.0), "stiffness": matrix(2e5, -1e5)
        },
        "excitation": [{ "dof": "w1", "amplitude": 3.0 }],
        "contacts": [{ "name": "pads", "pairs": [["w0", "ground"], ["w0", "w1"]],
                       "law": { "type": "elastic_coulomb", "stiffness": 1e5, "slip_force": 0.5 } }],
        "frequencies": [20.0, 60.0],
        "harmonics": 3
    })
}

#[test]
fn contacts_of_pairs_have_numbered_names() {
    let outcome = solve(&chain(2));
    let contacts = outcome.points[0].contacts.as_ref().unwrap();
    let names: Vec<&str> = contacts.0.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["pads[0]", "pads[1]"]);
}

#[test]
fn pairs_are_the_same_as_contacts_written_out() {
    let mut written_out = chain(2);
    let law = written_out["contacts"][0]["law"].clone();
    written_out["contacts"] = json!([
        { "name": "a", "between": ["w0", "ground"], "law": law },
        { "name": "b", "between": ["w0", "w1"], "law": law }
    ]);
    assert_eq!(solve(&chain(2)).points[0].displacement, solve(&written_out).points[0].displacement);
}

#[test]
fn large_models_recover_what_is_touched() {
    assert_eq!(solve(&chain(16)).dofs.len(), 16);
    assert_eq!(solve(&chain(17)).dofs, ["w0", "w1"]);
    let mut chosen = chain(17);
    chosen["output"] = json!(["w16", "w3"]);
    assert_eq!(solve(&chosen).dofs, ["w16", "w3"]);
}

#[test]
fn a_scale_of_two_is_two_contacts() {
    let mut twice = chain(2);
    let one = json!({ "name": "a", "between": ["w0", "ground"],
                      "law": { "type": "elastic_coulomb", "stiffness": 1e5, "slip_force": 0.5 } });
    let mut scaled = twice.clone();
    scaled["contacts"] = json!([one]);
    scaled["contacts"][0]["scale"] = json!(2.0);
    twice["contacts"] = json!([one, one]);
    twice["contacts"][1]["name"] = json!("b");
    let amplitude = |outcome: &Outcome| outcome.points[0].displacement.as_ref().unwrap().0[1].1.0[0].1;
    let (a, b) = (amplitude(&solve(&scaled)), amplitude(&solve(&twice)));
    assert!((a - b).norm() < 1e-9 * b.norm(), "{a} {b}");
}

#[test]
fn no_excitation_gives_no_response() {
    let mut scene = chain(2);
    scene["excitation"] = json!([]);
    for point in solve(&scene).points {
        assert_eq!(point.status, "converged");
        let displacement = point.displacement.unwrap();
        assert!(displacement.0.iter().all(|(_, spectrum)| spectrum.0.iter().all(|(_, w)| w.norm() == 0.0)));
    }
}

#[test]
fn the_static_amplitude_has_no_imaginary_part() {
    let mut scene = chain(2);
    scene["excitation"] =
        json!([{ "dof": "w1", "amplitude": 3.0 }, { "dof": "w1", "harmonic": 0, "amplitude": -0.2 }]);
    let outcome = serde_json::to_value(solve(&scene)).unwrap();
    let lines = outcome["points"][0]["displacement"]["w1"].as_array().unwrap();
    assert_eq!((&lines[0][0], &lines[0][2]), (&json!(0), &json!(0)));
    assert!(lines[0][1].as_f64().unwrap() < 0.0);
    assert_eq!(lines[1][0], 1);
}

#[test]
fn damping_has_three_forms() {
    let form = |damping: Value| {
        let mut scene = chain(2);
        scene["contacts"] = json!([]);
        scene["model"]["damping"] = damping;
        solve(&scene).points[1].displacement.clone().unwrap()
    };
    let matrix = form(json!([[7.0, -1.0], [-1.0, 7.0]]));
    let rayleigh = form(json!({ "rayleigh": { "mass": 5.0, "stiffness": 1e-5 } }));
    let first = |d: &scene::Named<scene::Spectrum>| d.0[1].1.0[0].1;
    assert!((first(&matrix) / first(&rayleigh) - 1.0).norm() < 1e-12);
    assert!((first(&matrix) / first(&form(json!({ "modal_ratio": 0.2 }))) - 1.0).norm() > 1e-2);
}

#[test]
fn a_point_without_a_solution_says_what_was_tried() {
    // At the undamped resonance friction alone would have to balance 10 N, but its first harmonic is at most 4/π · 1 N.
    let stiffness = std::f64::consts::TAU.powi(2);
    let text = json!({
        "model": { "dofs": ["w"], "mass": [[1.0]], "damping": [[0.0]], "stiffness": [[stiffness]] },
        "excitation": [{ "dof": "w", "amplitude": 10.0 }],
        "contacts": [{ "name": "c", "between": ["w", "ground"],
                       "law": { "type": "elastic_coulomb", "stiffness": 100.0, "slip_force": 1.0 } }],
        "frequencies": [1.0],
        "harmonics": 3
    });
    let outcome = solve(&text);
    let point = &outcome.points[0];
    assert_eq!(point.status, "failed");
    assert!(point.displacement.is_none() && point.contacts.is_none());
    assert!(point.reason.as_ref().unwrap().contains("singular at harmonic 1"), "{:?}", point.reason);
    // In the order in which they are tried; only smaller rungs are no choice below the first one.
    let tried = [
        "ladder of harmonics",
        "homotopy from secant stiffnesses",
        "homotopy in the contact stiffness",
        "homotopy in the contact force",
        "homotopy in the excitation",
        "homotopy in the damping",
        "homotopy along its arc",
        "start at rest",
        "perturbed starts",
        "detours over other frequencies",
    ];
    assert_eq!(point.tried.as_ref().unwrap(), &tried);
}
