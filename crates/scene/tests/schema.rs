//! The schema against scenes: what the reader takes it takes, what it refuses for its form it refuses.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use boon::{Compiler, Schemas};
use scene::{SCHEMA, Scene};
use serde_json::{Value, json};

fn fits(scene: &Value) -> bool {
    let mut schemas = Schemas::new();
    let mut compiler = Compiler::new();
    compiler.add_resource("scene.json", serde_json::from_str(SCHEMA).unwrap()).unwrap();
    let schema = compiler.compile("scene.json", &mut schemas).unwrap();
    schemas.validate(scene, schema).is_ok()
}

fn examples() -> Vec<(String, Value)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|e| e == "json"));
    let read = |path: std::path::PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path.display().to_string(), serde_json::from_str(&text).unwrap())
    };
    scenes.filter(|path| !path.ends_with("scene.schema.json")).map(read).collect()
}

#[test]
fn every_example_fits_and_is_read() {
    let examples = examples();
    assert!(examples.len() >= 3);
    for (name, scene) in examples {
        assert!(fits(&scene), "{name}");
        Scene::from_file(name.as_ref()).unwrap();
    }
}

#[test]
fn schema_and_reader_agree_on_several_directions() {
    let row = |i: usize| (0..6).map(|j| if i == j { 1e5 } else { 0.0 }).collect::<Vec<_>>();
    let diagonal = json!((0..6).map(row).collect::<Vec<_>>());
    let base = json!({
        "model": { "dofs": ["1:x", "1:y", "1:z", "2:x", "2:y", "2:z"], "mass": diagonal, "damping": diagonal, "stiffness": diagonal },
        "excitation": [],
        "contacts": [],
        "frequencies": [10.0]
    });
    let rub = json!({
        "type": "friction_contact", "tangential_stiffness": 1, "normal_stiffness": 1, "friction_coefficient": 0, "gap": -1e-6
    });
    let loaded = |load: Value| json!({ "type": "scaled_loop", "loop": { "displacement": 1e-6, "force": 1 }, "normal_load": load });
    let held = loaded(json!({ "reference": 1, "stiffness": 1, "preload": 2 }));
    let line = json!({ "normal": [0, 0, 1], "tangential": [0, 1, 0] });
    let cases = [
        (true, json!({ "law": rub, "nodes": ["1", "2"], "axes": { "normal": [0, 0, 1] } })),
        (
            true,
            json!({ "law": rub, "nodes": ["1", "ground"], "axes": { "normal": { "z": -1 }, "tangential": { "x": 1 } } }),
        ),
        (true, json!({ "law": rub, "nodes": ["1", "ground"], "axes": line, "scale": 2 })),
        (
            true,
            json!({ "law": rub, "node_pairs": [["1", "2"]], "axes": [{ "normal": [0, 0, 1], "comment": "up" }] }),
        ),
        (
            true,
            json!({ "law": rub, "directions": { "tangential": ["1:x", "ground"], "normal": ["1:z", "2:z"] } }),
        ),
        (
            true,
            json!({ "law": rub, "directions": [{ "tangential": [["1:x", "ground"], ["1:y", "ground"]], "normal": ["1:z", "2:z"] }] }),
        ),
        (true, json!({ "law": held, "nodes": ["1", "2"], "axes": line })),
        (false, json!({ "law": held, "between": ["1:x", "ground"] })),
        (false, json!({ "law": loaded(json!({})), "nodes": ["1", "2"], "axes": line })),
        (
            false,
            json!({ "law": loaded(json!({ "reference": 0, "stiffness": 1, "preload": 2 })), "nodes": ["1", "2"], "axes": line }),
        ),
        (false, json!({ "law": rub, "between": ["1:x", "ground"] })),
        (false, json!({ "law": rub, "nodes": ["1", "2"] })),
        (false, json!({ "law": rub, "nodes": ["1", "2"], "axes": {} })),
        (false, json!({ "law": rub, "nodes": ["1"], "axes": line })),
        (false, json!({ "law": rub, "nodes": ["1", "2"], "axes": { "normal": [0, 1] } })),
        (false, json!({ "law": rub, "nodes": ["1", "2"], "axes": { "normal": {} } })),
        (
            false,
            json!({ "law": rub, "nodes": ["1", "2"], "axes": { "normal": [0, 0, 1], "tangential": [] } }),
        ),
        (false, json!({ "law": rub, "nodes": ["1", "2"], "node_pairs": [["1", "2"]], "axes": line })),
        (false, json!({ "law": rub, "directions": { "normal": ["1:z", "2:z"] } })),
        (
            false,
            json!({ "law": rub, "directions": { "tangential": ["1:x", "2:x"], "normal": ["1:z", "2:z"] }, "axes": line }),
        ),
        (false, json!({ "law": { "type": "linear", "stiffness": 1 }, "nodes": ["1", "2"], "axes": line })),
        (
            false,
            json!({
                "law": { "type": "linear", "stiffness": 1 },
                "directions": { "tangential": ["1:x", "2:x"], "normal": ["1:z", "2:z"] }
            }),
        ),
    ];
    for (good, mut contact) in cases {
        contact["name"] = json!("c");
        let mut scene = base.clone();
        scene["contacts"] = json!([contact]);
        assert_eq!(fits(&scene), good, "schema: {contact}");
        assert_eq!(Scene::from_str(&scene.to_string(), Path::new(".")).is_ok(), good, "reader: {contact}");
    }
    // Of the law itself both forms of the normal load, or none, are too many or too few.
    for (good, load) in [
        (true, json!({ "gap": 0 })),
        (false, json!({})),
        (false, json!({ "gap": 0, "preload": 1 })),
        (false, json!({ "preload": -1 })),
    ] {
        let mut law = rub.clone();
        law.as_object_mut().unwrap().remove("gap");
        law.as_object_mut().unwrap().extend(load.as_object().unwrap().clone());
        let mut scene = base.clone();
        scene["contacts"] = json!([{ "name": "c", "law": law, "nodes": ["1", "2"], "axes": line }]);
        assert_eq!(fits(&scene), good, "schema: {law}");
        assert_eq!(Scene::from_str(&scene.to_string(), Path::new(".")).is_ok(), good, "reader: {law}");
    }
}

#[test]
fn schema_and_reader_agree() {
    let base = json!({
        "model": { "dofs": ["a"], "mass": [[1.0]], "damping": [[1.0]], "stiffness": [[1e5]] },
        "excitation": [{ "dof": "a", "amplitude": 1.0 }],
        "contacts": [{ "name": "c", "between": ["a", "ground"], "law": { "type": "linear", "stiffness": 1.0 } }],
        "frequencies": [10.0]
    });
    let law = |law: Value| ("/contacts/0/law", law);
    let series = |a: f64| json!({ "displacement": a, "harmonics": [[1, 1, 2], [3, 0, 0.1]] });
    let cases = [
        (true, "/excitation", json!([])),
        (true, "/contacts", json!([])),
        (true, "/frequencies", json!([0, 1])),
        (false, "/frequencies", json!([])),
        (false, "/frequencies", json!([-1])),
        (true, "/frequencies", json!({ "from": 1, "to": 2, "points": 2, "spacing": "log" })),
        (true, "/frequencies", json!({ "from": 1, "to": 2, "step": 0.5 })),
        (false, "/frequencies", json!({ "from": 1, "to": 2, "step": 0.5, "points": 2 })),
        (false, "/frequencies", json!({ "from": 0, "to": 2, "points": 2 })),
        (false, "/frequencies", json!({ "from": 1, "to": 2, "points": 2.5 })),
        (true, "/model/damping", json!({ "rayleigh": { "mass": 1.0, "stiffness": 0.0 } })),
        (true, "/model/damping", json!({ "modal_ratio": 0.01 })),
        (false, "/model/damping", json!({ "modal_ratio": -0.01 })),
        (true, "/model/damping", json!({ "matrix_market": "single.mtx" })),
        (true, "/model/mass", json!({ "npy": "single.npy" })),
        (true, "/model/mass", json!({ "npz": "single.npz", "entry": "K" })),
        (false, "/model/mass", json!({ "npz": "single.npz", "array": "K" })),
        (false, "/model/mass", json!({ "npy": "" })),
        (false, "/model/mass", json!({ "csv": "one.csv" })),
        (true, "/model/dofs", json!({ "file": "single.txt" })),
        (false, "/model/dofs", json!({ "names": "single.txt" })),
        (true, "/model/fixed", json!([])),
        (true, "/model/reduction", json!("auto")),
        (true, "/model/reduction", json!("none")),
        (false, "/model/reduction", json!("craig-bampton")),
        (true, "/model/reduction", json!({ "modes": 3 })),
        (true, "/model/reduction", json!({ "tolerance": 1e-6 })),
        (false, "/model/reduction", json!({ "tolerance": 0 })),
        (false, "/model/reduction", json!({ "modes": 3, "tolerance": 1e-6 })),
        (false, "/model/reduction", json!({})),
        (false, "/excitation/0", json!({ "dof": "a", "amplitude": 1, "direction": "x" })),
        (false, "/model/dofs", json!(["ground"])),
        (false, "/model/mass", json!([["1"]])),
        (true, "/harmonics", json!({ "tolerance": 1e-6, "max": 63 })),
        (false, "/harmonics", json!({ "tolerance": 1, "max": 63 })),
        (false, "/harmonics", json!({ "tolerance": 1e-6, "max": 0 })),
        (false, "/harmonics", json!({ "max": 63 })),
        (false, "/harmonics", json!(1.5)),
        (true, "/solver", json!({ "estimate": true, "samples": 256 })),
        (false, "/solver", json!({ "estimate": 1 })),
        (true, "/excitation/0", json!({ "kind": "base", "amplitude": 1 })),
        (false, "/excitation/0", json!({ "kind": "base", "amplitude": 1, "dof": "a" })),
        (false, "/excitation/0", json!({ "amplitude": 1 })),
        (false, "/excitation/0", json!({ "dof": "a", "amplitude": 1, "harmonic": -1 })),
        (
            true,
            "/contacts/0",
            json!({ "name": "c", "pairs": [["a", "ground"]], "law": { "type": "cubic", "stiffness": -1 } }),
        ),
        (false, "/contacts/0", json!({ "name": "c", "law": { "type": "cubic", "stiffness": 1 } })),
    ];
    let laws = [
        (true, law(json!({ "type": "scaled_loop", "loop": { "displacement": 1e-6, "force": 1 } }))),
        (
            true,
            law(
                json!({ "type": "scaled_loop", "symmetric": false, "loop": { "displacement": 1e-6, "harmonics": [[1, 0, 1]] } }),
            ),
        ),
        (
            false,
            law(
                json!({ "type": "scaled_loop", "symmetric": "odd", "loop": { "displacement": 1e-6, "force": 1 } }),
            ),
        ),
        (false, law(json!({ "type": "scaled_loop", "loop": { "displacement": 1e-6 } }))),
        (
            false,
            law(json!({ "type": "scaled_loop", "loop": { "displacement": 1e-6, "harmonics": [[1, 0]] } })),
        ),
        (true, law(json!({ "type": "elastic_coulomb", "stiffness": 1, "slip_force": 1 }))),
        (false, law(json!({ "type": "elastic_coulomb", "stiffness": 1, "slip_force": 0 }))),
        (false, law(json!({ "type": "elastic_coulomb", "stiffness": 1 }))),
        (true, law(json!({ "type": "coulomb", "slip_force": 1, "velocity": 1e-3 }))),
        (false, law(json!({ "type": "coulomb", "slip_force": 1, "velocity": 0 }))),
        (false, law(json!({ "type": "coulomb", "slip_force": 1 }))),
        (true, law(json!({ "type": "iwan", "displacement": 8e-6, "force": 12, "range": 1, "sliders": 20 }))),
        (true, law(json!({ "type": "iwan", "backbone": [[0, 0], [1e-6, 1], [2e-6, 1.5]] }))),
        (false, law(json!({ "type": "iwan" }))),
        (false, law(json!({ "type": "iwan", "displacement": 8e-6 }))),
        (false, law(json!({ "type": "iwan", "displacement": 8e-6, "force": 12, "sliders": 0 }))),
        (false, law(json!({ "type": "iwan", "backbone": [[1, 1], [2, 1]], "range": 1 }))),
        (false, law(json!({ "type": "iwan", "backbone": [[1, 1], [2]] }))),
        (true, law(json!({ "type": "loop_family", "loops": [series(1e-6), series(2e-6)] }))),
        (false, law(json!({ "type": "loop_family", "loops": [series(1e-6)] }))),
        (
            false,
            law(json!({ "type": "loop_family", "loops": [series(1e-6), { "displacement": 1, "force": 1 }] })),
        ),
        (false, law(json!({ "stiffness": 1 }))),
        (true, law(json!({ "type": "gap", "stiffness": 1, "gap": -1e-6 }))),
        (false, law(json!({ "type": "gap", "stiffness": 1 }))),
        (false, law(json!({ "type": "gap", "stiffness": 0, "gap": 0 }))),
    ];
    let laws = laws.into_iter().map(|(good, (place, value))| (good, place, value));
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/matrices");
    for (good, place, value) in cases.into_iter().chain(laws) {
        let mut scene = base.clone();
        let (parent, key) = place.rsplit_once('/').unwrap();
        match scene.pointer_mut(parent).unwrap() {
            Value::Object(members) => {
                members.insert(key.into(), value.clone());
            }
            items => items[key.parse::<usize>().unwrap()] = value.clone(),
        }
        assert_eq!(fits(&scene), good, "schema: {place} {value}");
        assert_eq!(Scene::from_str(&scene.to_string(), &files).is_ok(), good, "reader: {place} {value}");
    }
}
