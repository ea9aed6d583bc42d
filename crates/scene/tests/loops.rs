//! Loops in scenes: records with their columns, units and signs, series, and the notes they give rise to.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::{PI, TAU};
use std::fs;

use scene::{Scene, SceneError};
use serde_json::{Value, json};
use tempfile::TempDir;

/// f = 12 cos(θ + φ) + even part over a displacement of 8 µm, phase of eq. (7) at α = 1.
fn record(folder: &TempDir, name: &str, header: &str, sign: f64, even: f64, scale: f64) {
    let phase = PI * (0.5 - 7.0 / 15.0 * (-4.0f64).exp());
    let mut text = format!("{header}\n");
    for j in 0..=600 {
        let theta = TAU * f64::from(j) / 200.0;
        let force = 12.0 * (theta + phase).cos() + even * (2.0 * theta).cos();
        text += &format!("{},{}\n", 8.0 * theta.cos() * scale, sign * force);
    }
    fs::write(folder.path().join(name), text).unwrap();
}

fn read(folder: &TempDir, law: Value) -> Result<Scene, SceneError> {
    let scene = json!({
        "model": { "dofs": ["w"], "mass": [[1.0]], "damping": [[1.0]], "stiffness": [[1e5]] },
        "excitation": [{ "dof": "w", "amplitude": 1.0 }],
        "contacts": [{ "name": "root", "between": ["w", "ground"], "law": law }],
        "frequencies": [50.0]
    });
    Scene::from_str(&scene.to_string(), folder.path())
}

fn scaled(loop_: Value, symmetric: Value) -> Value {
    json!({ "type": "scaled_loop", "loop": loop_, "symmetric": symmetric })
}

/// Amplitude in m and |F_1| in N of the law, from what it does.
fn amplitudes(scene: &Scene) -> (f64, f64) {
    let law = &scene.problem().unwrap().contacts[0].law;
    let length = law.length().unwrap();
    (length, law.secant_stiffness(length) * length)
}

/// g(1) of the paper.
const G1: f64 = 0.98209;

#[test]
fn every_form_of_the_same_loop_gives_the_same_law() {
    let folder = TempDir::new().unwrap();
    record(&folder, "plain.csv", "displacement [um],force [N]", 1.0, 0.0, 1.0);
    record(&folder, "rig.csv", "x,y", -1.0, 0.0, 1e-3);
    let rig = json!({
        "file": "rig.csv", "columns": { "displacement": "x", "force": 2 },
        "units": { "displacement": "mm", "force": "N" }, "force_sign": -1
    });
    for loop_ in [
        json!({ "file": "plain.csv" }),
        json!({ "file": folder.path().join("plain.csv") }),
        rig,
        json!({ "displacement": 8e-6, "force": 12.0 }),
        json!({ "displacement": 8e-6, "harmonics": [[1, 0.0, 12.0]] }),
    ] {
        let scene = read(&folder, scaled(loop_.clone(), json!("auto"))).unwrap();
        let (displacement, force) = amplitudes(&scene);
        assert!((displacement / 8e-6 - 1.0).abs() < 1e-3, "{loop_} {displacement}");
        assert!((force / (12.0 * G1) - 1.0).abs() < 1e-3, "{loop_} {force}");
    }
}

#[test]
fn even_content_is_taken_out_or_kept_and_said() {
    let folder = TempDir::new().unwrap();
    record(&folder, "small.csv", "displacement [um],force [N]", 1.0, 0.12, 1.0);
    record(&folder, "large.csv", "displacement [um],force [N]", 1.0, 1.2, 1.0);
    let outcome = |file: &str, symmetric: Value| {
        let scene = read(&folder, scaled(json!({ "file": file }), symmetric)).unwrap();
        (scene.problem().unwrap().contacts[0].law.nature().odd, scene.notes().join("\n"))
    };
    for (file, symmetric, odd, words) in [
        ("small.csv", json!("auto"), true, "even content, 1.00 % of |F_1|, is taken out"),
        ("small.csv", json!(false), false, "is kept"),
        ("large.csv", json!("auto"), false, "even content, 10.00 % of |F_1|, is kept"),
        ("large.csv", json!(true), true, "is taken out"),
    ] {
        let (is_odd, notes) = outcome(file, symmetric);
        assert_eq!(is_odd, odd, "{file} {notes}");
        assert!(notes.contains(words) && notes.starts_with("contact \"root\": "), "{notes}");
    }
}

#[test]
fn a_loop_that_disagrees_with_the_phase_law_is_noted() {
    let folder = TempDir::new().unwrap();
    let notes = |re: f64, im: f64| {
        let law = scaled(json!({ "displacement": 8e-6, "harmonics": [[1, re, im]] }), json!("auto"));
        read(&folder, law).unwrap().notes().join("\n")
    };
    assert!(notes(12.0, 12.0).contains("phase is 0.250 π, eq. (7) gives 0.491 π"), "{}", notes(12.0, 12.0));
    assert_eq!(notes(12.0 * (0.49145 * PI).cos(), 12.0 * (0.49145 * PI).sin()), "");
}

#[test]
fn a_file_is_looked_for_beside_the_scene() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("loops")).unwrap();
    record(&folder, "loops/r.csv", "displacement [um],force [N]", 1.0, 0.0, 1.0);
    let scene = json!({
        "model": { "dofs": ["w"], "mass": [[1.0]], "damping": [[1.0]], "stiffness": [[1e5]] },
        "excitation": [], "frequencies": [50.0],
        "contacts": [{ "name": "root", "between": ["w", "ground"],
                       "law": { "type": "scaled_loop", "loop": { "file": "loops/r.csv" } } }]
    });
    let path = folder.path().join("blade.json");
    fs::write(&path, scene.to_string()).unwrap();
    assert_eq!(Scene::from_file(&path).unwrap().name(), "blade");
    let elsewhere = Scene::from_str(&scene.to_string(), "elsewhere".as_ref()).unwrap_err();
    assert_eq!(elsewhere.place(), Some("contacts[0].law.loop.file"));
}

#[test]
fn a_record_that_is_no_loop_is_refused_with_its_file() {
    let folder = TempDir::new().unwrap();
    record(&folder, "reversed.csv", "displacement [um],force [N]", -1.0, 0.0, 1.0);
    let error =
        read(&folder, scaled(json!({ "file": "reversed.csv" }), json!("auto"))).unwrap_err().to_string();
    assert!(error.starts_with("contacts[0].law.loop.file: "), "{error}");
    assert!(error.contains("reversed.csv") && error.contains("\"force_sign\": -1"), "{error}");

    record(&folder, "rig.csv", "displacement [um],force [N]", 1.0, 0.0, 1.0);
    let turned = scaled(json!({ "file": "rig.csv", "force_sign": -1 }), json!("auto"));
    let error = read(&folder, turned).unwrap_err().to_string();
    assert!(error.contains("leave \"force_sign\" out"), "{error}");
}
