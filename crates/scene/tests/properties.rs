//! The reader against anything: it never panics, and what it refuses it names.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use proptest::prelude::*;
use scene::{Frequencies, Scene, SceneError};
use serde_json::{Value, json};

/// A scene with every key that can stand beside the others.
fn full() -> Value {
    json!({
        "name": "full",
        "model": {
            "dofs": ["a", "b"],
            "mass": [[1.0, 0.0], [0.0, 2.0]],
            "damping": { "rayleigh": { "mass": 1.0, "stiffness": 1e-5 } },
            "stiffness": [[3e5, -1e5], [-1e5, 1e5]]
        },
        "excitation": [
            { "dof": "b", "harmonic": 1, "amplitude": 9.0, "phase": 0.5, "kind": "force" },
            { "amplitude": 1.0, "kind": "base" }
        ],
        "contacts": [
            { "name": "root", "between": ["a", "ground"], "scale": 2.0, "law": {
                "type": "scaled_loop", "symmetric": "auto",
                "loop": { "displacement": 8e-6, "harmonics": [[1, 0.3, 12.0], [3, 0.9, 2.4]] },
                "magnitude": { "offset": 0.98, "slope": 0.21, "shift": 0.01 },
                "phase": { "limit": -std::f64::consts::FRAC_PI_2, "span": 1.4660765716752369, "decay": 4.0 } } },
            { "name": "pads", "pairs": [["a", "b"], ["b", "ground"]],
              "law": { "type": "elastic_coulomb", "stiffness": 1e6, "slip_force": 2.0 } }
        ],
        "frequencies": { "from": 20.0, "to": 200.0, "points": 3, "spacing": "log" },
        "harmonics": 3,
        "output": ["b", "a"],
        "solver": { "start": "march", "jacobian": "difference", "samples": 256 }
    })
}

/// The path of every value below `value`, as messages write it, and as a JSON pointer.
fn places(value: &Value, path: &str, pointer: &str, all: &mut Vec<(String, String)>) {
    all.push((path.to_owned(), pointer.to_owned()));
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                let below = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                places(member, &below, &format!("{pointer}/{key}"), all);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                places(item, &format!("{path}[{i}]"), &format!("{pointer}/{i}"), all);
            }
        }
        _ => {}
    }
}

fn read(scene: &Value) -> Result<Scene, SceneError> {
    Scene::from_str(&scene.to_string(), Path::new("."))
}

fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        (-3i64..6).prop_map(Value::from),
        "[a-z\u{3b1}\"\\\\]{0,4}".prop_map(Value::from),
        Just(json!("ground")),
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..3).prop_map(Value::from),
            prop::collection::btree_map("file|type|points|[a-z]{1,3}", inner, 0..3)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,60}") {
        let _ = Scene::from_str(&text, Path::new("."));
    }

    #[test]
    fn a_scene_with_a_character_changed_is_read_or_refused(at in any::<prop::sample::Index>(), c in any::<char>()) {
        let text: Vec<char> = full().to_string().chars().collect();
        let at = at.index(text.len());
        let changed: String = text.iter().enumerate().map(|(i, old)| if i == at { c } else { *old }).collect();
        let _ = Scene::from_str(&changed, Path::new("."));
    }

    #[test]
    fn any_value_anywhere_is_taken_or_named(at in any::<prop::sample::Index>(), value in any_json()) {
        let mut scene = full();
        let mut all = Vec::new();
        places(&scene, "", "", &mut all);
        let (path, pointer) = at.get(&all).clone();
        *scene.pointer_mut(&pointer).unwrap() = value;
        if let Err(error) = read(&scene) {
            let place = error.place().unwrap().to_owned();
            // What is refused lies at the changed place, in it or around it; a changed name is missed where it is used.
            let near = place.starts_with(&path) || path.starts_with(&place) || place == "scene";
            let named = pointer.contains("dofs") && (place.contains("dof") || place.contains("between")
                || place.contains("pairs") || place.contains("output") || place.starts_with("model"));
            let related = path.starts_with("model") && place.starts_with("model")
                || path.starts_with("frequencies") && place.starts_with("frequencies")
                || path.starts_with("contacts") && place.starts_with("contacts")
                || path.starts_with("excitation") && place.starts_with("excitation")
                || path.starts_with("output") && place.starts_with("output");
            prop_assert!(near || named || related, "changed {path}, got {error}");
            prop_assert!(!error.to_string().contains(" at line "), "{error}");
        }
    }

    #[test]
    fn any_short_form_is_a_range_or_refused(text in "[0-9.:,elog-]{0,20}") {
        if let Ok(frequencies) = text.parse::<Frequencies>() {
            // A list may have the static response in it.
            let allowed = |hertz: f64| hertz > 0.0 || (hertz == 0.0 && !text.contains(':'));
            prop_assert!(frequencies.as_slice().iter().all(|hertz| hertz.is_finite() && allowed(*hertz)));
        }
    }
}

#[test]
fn the_full_scene_is_read() {
    let scene = read(&full()).unwrap();
    assert_eq!(scene.contacts().collect::<Vec<_>>(), ["root", "pads[0]", "pads[1]"]);
    assert_eq!(scene.output(), ["b", "a"]);
    assert_eq!(scene.frequencies().as_slice().len(), 3);
}

#[test]
fn remarks_may_stand_in_every_object() {
    fn remark(value: &mut Value) {
        match value {
            Value::Object(members) => {
                members.values_mut().for_each(remark);
                members.insert("comment".into(), json!(["anything"]));
                members.insert("$schema".into(), json!("x"));
            }
            Value::Array(items) => items.iter_mut().for_each(remark),
            _ => {}
        }
    }
    let mut scene = full();
    remark(&mut scene);
    read(&scene).unwrap();
}

#[test]
fn an_unknown_key_in_any_object_is_refused_with_its_path() {
    let mut all = Vec::new();
    places(&full(), "", "", &mut all);
    for (path, pointer) in all {
        let mut scene = full();
        let Some(object) = scene.pointer_mut(&pointer).and_then(Value::as_object_mut) else {
            continue;
        };
        object.insert("surplus".into(), json!(1));
        let expected = if path.is_empty() { "surplus".into() } else { format!("{path}.surplus") };
        assert_eq!(read(&scene).unwrap_err().place().unwrap(), expected);
    }
}
