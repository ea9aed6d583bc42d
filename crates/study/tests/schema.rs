//! The schema against studies: what the reader takes it takes, what it refuses for its form it refuses.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};

use boon::{Compiler, Schemas};
use serde_json::{Value, json};
use study::{SCHEMA, Study};

fn fits(study: &Value) -> bool {
    let mut schemas = Schemas::new();
    let mut compiler = Compiler::new();
    compiler.add_resource("study.json", serde_json::from_str(SCHEMA).unwrap()).unwrap();
    let schema = compiler.compile("study.json", &mut schemas).unwrap();
    schemas.validate(study, schema).is_ok()
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn is_read(study: &Value) -> bool {
    Study::from_str(&study.to_string(), &repository().join("scenes"), "study").is_ok()
}

fn base() -> Value {
    json!({
        "scene": "elastic-coulomb.json",
        "vary": { "/contacts/0/law/slip_force": { "from": 1, "to": 100, "points": 3, "spacing": "log" } },
        "frequencies": { "from": 30, "to": 130, "points": 11 },
        "harmonics": [1, { "tolerance": 1e-6, "max": 63 }],
        "keep": "peaks"
    })
}

#[test]
fn schema_and_reader_agree() {
    assert!(fits(&base()) && is_read(&base()));
    let slip_force = "/contacts/0/law/slip_force";
    for (takes, key, value) in [
        (true, "vary", json!({})),
        (true, "vary", json!({ slip_force: [1, 2.5], "comment": "one entry" })),
        (true, "vary", json!({ slip_force: { "from": 1, "to": 1, "points": 1, "comment": 0 } })),
        (false, "vary", json!({ slip_force: [] })),
        (false, "vary", json!({ slip_force: 3 })),
        (false, "vary", json!({ slip_force: ["a"] })),
        (false, "vary", json!({ slip_force: { "from": 1, "to": 2 } })),
        (false, "vary", json!({ slip_force: { "from": 1, "to": 2, "points": 0 } })),
        (false, "vary", json!({ slip_force: { "from": 1, "to": 2, "points": 2, "step": 1 } })),
        (false, "vary", json!({ slip_force: { "from": 1, "to": 2, "points": 2, "spacing": "cubic" } })),
        (false, "vary", json!({ "slip_force": [1] })),
        (false, "vary", json!([])),
        (true, "harmonics", json!(7)),
        (false, "harmonics", json!([])),
        (false, "harmonics", json!(0)),
        (false, "harmonics", json!([[1]])),
        (false, "harmonics", json!({ "tolerance": 2, "max": 3 })),
        (true, "frequencies", json!([30, 40])),
        (false, "frequencies", json!({ "from": 30, "to": 40 })),
        (true, "output", json!(["w2"])),
        (false, "output", json!([])),
        (false, "output", json!("w2")),
        (true, "keep", json!("points")),
        (false, "keep", json!("all")),
        (false, "scene", json!({})),
        (true, "name", json!("grid")),
        (false, "name", json!(3)),
        (true, "comment", json!(["anything"])),
        (true, "$schema", json!("study.schema.json")),
        (false, "kep", json!("points")),
    ] {
        let mut study = base();
        study[key] = value;
        assert_eq!((fits(&study), is_read(&study)), (takes, takes), "{study}");
    }
    for key in ["scene", "vary", "keep"] {
        let mut study = base();
        study.as_object_mut().unwrap().remove(key);
        assert_eq!((fits(&study), is_read(&study)), (false, false), "{study}");
    }
}

/// Studies of the documentation: blocks of JSON with `vary`.
#[test]
fn every_documented_study_fits() {
    let mut found = 0;
    for page in std::fs::read_dir(repository().join("docs/src")).unwrap().map(|entry| entry.unwrap().path()) {
        if page.extension().is_none_or(|extension| extension != "md") {
            continue;
        }
        let text = std::fs::read_to_string(&page).unwrap();
        for block in text.split("```json\n").skip(1).map(|rest| rest.split("```").next().unwrap()) {
            let Ok(study) = serde_json::from_str::<Value>(block) else { continue };
            if study.get("vary").is_some() {
                assert!(fits(&study), "{}: {study}", page.display());
                found += 1;
            }
        }
    }
    assert!(found > 0);
}

/// Studies that fuzzing begins with.
#[test]
fn every_study_of_the_corpus_fits() {
    for name in ["peaks", "points"] {
        let text =
            std::fs::read_to_string(repository().join(format!("fuzz/corpus/study/{name}.json"))).unwrap();
        assert!(fits(&serde_json::from_str(&text).unwrap()), "{name}");
    }
}
