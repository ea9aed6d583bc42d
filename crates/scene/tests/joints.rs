//! Contacts in several directions: what a scene may say, and what it is told when it says something else.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use scene::Scene;
use serde_json::{Value, json};

/// Two nodes with three dofs each, and one with two.
fn base() -> Value {
    let dofs = ["1:x", "1:y", "1:z", "2:x", "2:y", "2:z", "3:x", "3:t"];
    let diagonal = |value: f64| -> Value {
        let row = |i: usize| (0..dofs.len()).map(|j| if i == j { value } else { 0.0 }).collect::<Vec<_>>();
        json!((0..dofs.len()).map(row).collect::<Vec<_>>())
    };
    json!({
        "model": { "dofs": dofs, "mass": diagonal(1.0), "damping": diagonal(5.0), "stiffness": diagonal(1e5) },
        "excitation": [{ "dof": "1:x", "amplitude": 1.0 }],
        "contacts": [{
            "name": "shroud",
            "law": {
                "type": "friction_contact", "tangential_stiffness": 1e6, "normal_stiffness": 2e6,
                "friction_coefficient": 0.3, "preload": 20.0
            },
            "nodes": ["1", "2"],
            "axes": { "normal": [0, 0, 1] }
        }],
        "frequencies": [10.0]
    })
}

fn changed(changes: &[(&str, Value)]) -> Value {
    let mut scene = base();
    let contact = scene["contacts"][0].as_object_mut().unwrap();
    for (key, value) in changes {
        match key.strip_prefix("law.") {
            Some(key) => drop(contact["law"].as_object_mut().unwrap().insert(key.to_owned(), value.clone())),
            None => drop(contact.insert((*key).to_owned(), value.clone())),
        }
    }
    // Null takes a key away.
    contact.retain(|_, value| !value.is_null());
    contact["law"].as_object_mut().unwrap().retain(|_, value| !value.is_null());
    scene
}

fn read(scene: &Value) -> Result<Scene, String> {
    Scene::from_str(&scene.to_string(), Path::new(".")).map_err(|error| error.to_string())
}

/// Parts of every direction of every joint.
type Parts = Vec<Vec<Vec<(usize, f64)>>>;

fn parts(changes: &[(&str, Value)]) -> Parts {
    let scene = read(&changed(changes)).unwrap();
    let problem = scene.problem().unwrap();
    let of = |joint: &hbm::Joint| joint.directions.iter().map(|direction| direction.parts.clone()).collect();
    problem.joints.iter().map(of).collect()
}

const NONE: Value = Value::Null;

#[test]
fn nodes_and_axes_become_directions() {
    let pair = |a: usize, b: usize| vec![(a, 1.0), (b, -1.0)];
    let full = vec![pair(0, 3), pair(1, 4), pair(2, 5)];
    assert_eq!(parts(&[]), vec![full.clone()]);
    let one = [("axes", json!({ "normal": { "z": 2 }, "tangential": [0, 7, 0] }))];
    assert_eq!(parts(&one), [vec![pair(1, 4), pair(2, 5)]]);
    let two = json!({ "normal": [0, 0, 1], "tangential": [[1, 0, 0], { "y": 1 }] });
    assert_eq!(parts(&[("axes", two)]), vec![full]);
    // The ground does not move, nor does what is held.
    assert_eq!(
        parts(&[("nodes", json!(["2", "ground"]))]),
        [vec![vec![(3, 1.0)], vec![(4, 1.0)], vec![(5, 1.0)]]]
    );
    let mut held = base();
    held["model"]["fixed"] = json!(["2:*"]);
    let joints = read(&held).unwrap().problem().unwrap().joints.clone();
    assert_eq!(joints[0].directions[2].parts, [(2, 1.0)]);
    // Axes at an angle.
    let turned = parts(&[("axes", json!({ "normal": [0, 3, 4], "tangential": [1, 0, 0] }))]);
    assert_eq!(turned[0][1], [(1, 0.6), (2, 0.8), (4, -0.6), (5, -0.8)]);
    // Nodes that are called otherwise.
    let cylindrical = [("nodes", json!(["3", "ground"])), ("axes", json!({ "normal": { "t": -1 } }))];
    assert_eq!(parts(&cylindrical), [vec![vec![(6, -1.0)], vec![(7, -1.0)]]]);
}

#[test]
fn pairs_share_the_law_and_have_names_of_their_own() {
    let pairs = [
        ("nodes", NONE),
        ("node_pairs", json!([["1", "2"], ["2", "ground"]])),
        ("axes", json!([{ "normal": [0, 0, 1] }, { "normal": [0, 0, -1] }])),
    ];
    let scene = read(&changed(&pairs)).unwrap();
    assert_eq!(scene.contacts().collect::<Vec<_>>(), ["shroud[0]", "shroud[1]"]);
    let joints = &scene.problem().unwrap().joints;
    assert!(std::sync::Arc::ptr_eq(&joints[0].law, &joints[1].law));
    assert_eq!(joints[1].directions[2].parts, [(5, -1.0)]);
    let directions = json!([
        { "tangential": [["1:x", "2:x"], ["1:y", "2:y"]], "normal": ["1:z", "2:z"] },
        { "tangential": [["2:x", "ground"], ["2:y", "ground"]], "normal": ["2:z", "ground"] }
    ]);
    let by_dofs = parts(&[("nodes", NONE), ("axes", NONE), ("directions", directions)]);
    let shared = [pairs[0].clone(), pairs[1].clone(), ("axes", json!({ "normal": [0, 0, 1] }))];
    assert_eq!(by_dofs, parts(&shared));
    let one = json!({ "tangential": ["1:x", "ground"], "normal": ["1:z", "ground"] });
    assert_eq!(
        parts(&[("nodes", NONE), ("axes", NONE), ("directions", one)]),
        [vec![vec![(0, 1.0)], vec![(2, 1.0)]]]
    );
}

#[test]
fn contacts_stay_in_the_order_of_the_scene() {
    let mut scene = base();
    let friction = scene["contacts"][0].clone();
    let spring = |name: &str| json!({ "name": name, "between": ["1:x", "ground"], "law": { "type": "linear", "stiffness": 1 } });
    scene["contacts"] = json!([spring("a"), friction, spring("b")]);
    let scene = read(&scene).unwrap();
    assert_eq!(scene.contacts().collect::<Vec<_>>(), ["a", "shroud", "b"]);
}

#[test]
fn every_misuse_names_its_key() {
    let loop_law = |more: Value| {
        let mut law = json!({ "type": "scaled_loop", "loop": { "displacement": 8e-6, "force": 12.0 } });
        law.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        law
    };
    let normal_load = |load: Value| loop_law(json!({ "normal_load": load }));
    let cases: Vec<(Vec<(&str, Value)>, &str)> = vec![
        // Which bodies.
        (vec![("nodes", NONE)], "contacts[0]: has no bodies; write \"nodes\""),
        (vec![("axes", NONE)], "contacts[0].axes: is missing; write \"axes\": {\"normal\": [0, 0, 1]}"),
        (
            vec![("node_pairs", json!([["1", "2"]]))],
            "contacts[0].node_pairs: is one too many; keep one of \"nodes\"",
        ),
        (vec![("directions", json!({}))], "contacts[0].directions: is one too many"),
        (vec![("nodes", NONE), ("directions", json!({}))], "contacts[0].axes: belongs to \"nodes\""),
        (
            vec![("between", json!(["1:x", "ground"]))],
            "contacts[0].between: has one direction, and this law acts in several",
        ),
        (vec![("pairs", json!([["1:x", "ground"]]))], "contacts[0].pairs: has one direction"),
        (vec![("nodes", json!(["1"]))], "contacts[0].nodes: must be two nodes, or one and \"ground\""),
        (vec![("nodes", json!("1"))], "contacts[0].nodes: must be a list two nodes"),
        (vec![("nodes", json!([1, 2]))], "contacts[0].nodes[0]: must be the name of a node, \"2201\""),
        (vec![("nodes", json!(["ground", "1"]))], "contacts[0].nodes[0]: put the node first"),
        (vec![("nodes", json!(["1", "1"]))], "contacts[0].nodes[1]: a node has no contact with itself"),
        (
            vec![("nodes", json!(["1", "9"]))],
            "contacts[0].nodes[1]: there is no node \"9\" in model.dofs: no dof is called \"9:x\"",
        ),
        (vec![("nodes", json!(["1", "3"]))], "contacts[0].nodes[1]: there is no dof \"3:y\""),
        (vec![("nodes", NONE), ("node_pairs", json!([]))], "contacts[0].node_pairs: must not be empty"),
        (
            vec![
                ("nodes", NONE),
                ("node_pairs", json!([["1", "2"], ["1", "ground"]])),
                ("axes", json!([{ "normal": [1, 0, 0] }])),
            ],
            "contacts[0].axes: must be one object for all, or a list with one for each of the 2 pair(s) of nodes, got 1",
        ),
        (
            vec![
                ("nodes", NONE),
                ("node_pairs", json!([["1", "2"], ["1", "ground"]])),
                ("axes", json!([{ "normal": [1, 0, 0] }, { "normal": [1, 0, 0], "tangential": [0, 1, 0] }])),
            ],
            "contacts[0].axes: all must have the same number of tangential directions",
        ),
        // Axes; the others stand beside their reader.
        (vec![("axes", json!({ "normal": [0, 0, 0] }))], "contacts[0].axes.normal: must not be zero"),
        (
            vec![("axes", json!({ "normal": [0, 0, 1], "tangential": [1, 0, 1] }))],
            "contacts[0].axes.tangential: must be at a right angle to the normal axis, but the angle is 45°",
        ),
        (
            vec![("nodes", json!(["3", "ground"]))],
            "contacts[0].axes.normal: the dofs of these nodes have the directions x, t, not x, y, z; write numbers",
        ),
        // Directions by dofs.
        (
            vec![("nodes", NONE), ("axes", NONE), ("directions", json!({ "normal": ["1:z", "ground"] }))],
            "contacts[0].directions.tangential: is missing",
        ),
        (
            vec![("nodes", NONE), ("axes", NONE), ("directions", json!({ "tangential": ["1:z", "ground"] }))],
            "contacts[0].directions.normal: is missing",
        ),
        (
            vec![
                ("nodes", NONE),
                ("axes", NONE),
                ("directions", json!({ "tangential": ["1:z", "2:z"], "normal": ["2:z", "1:z"] })),
            ],
            "contacts[0].directions.normal: are the dofs of another direction of this contact",
        ),
        (
            vec![
                ("nodes", NONE),
                ("axes", NONE),
                (
                    "directions",
                    json!({ "tangential": [["1:x", "ground"], ["1:q", "ground"]], "normal": ["1:z", "ground"] }),
                ),
            ],
            "contacts[0].directions.tangential[1][0]: there is no dof \"1:q\"",
        ),
        // The law.
        (vec![("law.preload", NONE)], "contacts[0].law: needs \"preload\" (N"),
        (vec![("law.gap", json!(1e-6))], "contacts[0].law.gap: is one too many beside \"preload\""),
        (vec![("law.preload", json!(-1))], "contacts[0].law.preload: must not be negative, got -1"),
        (vec![("law.normal_stiffness", NONE)], "contacts[0].law.normal_stiffness: is missing"),
        (
            vec![("law.normal_stiffness", json!(0))],
            "contacts[0].law.normal_stiffness: must be positive, got 0",
        ),
        (
            vec![("law.tangential_stiffness", json!(-1))],
            "contacts[0].law.tangential_stiffness: must be positive, got -1",
        ),
        (
            vec![("law.friction_coefficient", json!(-1))],
            "contacts[0].law.friction_coefficient: must not be negative, got -1",
        ),
        (vec![("law.slip_force", json!(1))], "contacts[0].law.slip_force: unknown key"),
        (
            vec![("law.type", json!("friction_contakt"))],
            "contacts[0].law.type: there is no law \"friction_contakt\"; did you mean \"friction_contact\"?",
        ),
        (
            vec![("law", json!({ "type": "linear", "stiffness": 1 }))],
            "contacts[0].nodes: is for a law in several directions, and this one acts in one; write \"between\"",
        ),
        (vec![("law", loop_law(json!({})))], "or add \"normal_load\" to the law"),
        (
            vec![("law", normal_load(json!({ "reference": 22, "stiffness": 1e7, "gap": 0 })))],
            "contacts[0].law: a measured loop acts in one tangential direction, and this contact has two",
        ),
        (
            vec![
                ("law", normal_load(json!({ "reference": 0, "stiffness": 1e7, "gap": 0 }))),
                ("axes", json!({ "normal": [0, 0, 1], "tangential": [1, 0, 0] })),
            ],
            "contacts[0].law.normal_load.reference: must be positive, got 0",
        ),
        (
            vec![("law", normal_load(json!({ "stiffness": 1e7, "gap": 0 })))],
            "contacts[0].law.normal_load.reference: is missing",
        ),
        (
            vec![("law", normal_load(json!({ "reference": 22, "gap": 0 })))],
            "contacts[0].law.normal_load.stiffness: is missing",
        ),
        (
            vec![("law", normal_load(json!({ "reference": 22, "stiffness": 1e7 })))],
            "contacts[0].law.normal_load: needs \"preload\"",
        ),
        (
            vec![("law", normal_load(json!({ "reference": 22, "stiffness": 1e7, "gap": 0, "preload": 1 })))],
            "contacts[0].law.normal_load.gap: is one too many",
        ),
        (
            vec![
                ("law", json!({ "type": "iwan", "displacement": 8e-6, "force": 12, "normal_load": {} })),
                ("nodes", NONE),
                ("axes", NONE),
                ("between", json!(["1:x", "ground"])),
            ],
            "contacts[0].law.normal_load: unknown key",
        ),
    ];
    for (changes, message) in cases {
        let scene = changed(&changes);
        let error = read(&scene).err().unwrap_or_else(|| panic!("accepted: {scene}"));
        assert!(error.contains(message), "{error}\n  for {message}");
    }
    let mut held = base();
    held["model"]["fixed"] = json!(["1:z", "2:z"]);
    let error = read(&held).err().unwrap();
    assert!(
        error.starts_with("contacts[0].axes: the normal direction at node \"1\": model.fixed holds"),
        "{error}"
    );
}
