//! `stickslip report` from outside: the data of the page is that of the results, and what does not belong together is
//! refused.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use report::{Recorded, Report, ReportError, Source};
use serde_json::{Value, json};
use tempfile::TempDir;

fn scene(name: &str) -> String {
    scenes().join(name).to_str().unwrap().to_owned()
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut stickslip = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    stickslip.current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The result of a command in a new folder.
fn solved(arguments: &[&str]) -> Value {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn report(result: &Value) -> Report {
    let mut report = Report::default();
    report.add("result", Recorded::from_json(&result.to_string()).unwrap()).unwrap();
    report
}

fn data(report: &Report) -> Value {
    serde_json::from_str::<Value>(&report.json().unwrap()).unwrap()["results"][0].clone()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The periods of a result's data: points, and of each of them all its numbers.
fn periods(shown: &Value) -> Vec<(usize, Vec<f64>)> {
    let motions = &shown["motions"];
    let points = numbers(&motions["points"]);
    let letters = motions["data"].as_str().unwrap().trim_end_matches('=');
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let bits: Vec<u8> =
        letters.bytes().flat_map(|letter| (0..6).rev().map(move |i| value(letter) >> i & 1)).collect();
    let bytes: Vec<u8> =
        bits.chunks_exact(8).map(|bits| bits.iter().fold(0, |byte, bit| byte << 1 | bit)).collect();
    let floats: Vec<f64> =
        bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect();
    let each = floats.len() / points.len();
    points.iter().map(|point| *point as usize).zip(floats.chunks_exact(each).map(<[f64]>::to_vec)).collect()
}

/// One period of a scene with one contact in one direction.
struct Period<'a> {
    harmonics: Vec<&'a [f64]>,
    dofs: Vec<&'a [f64]>,
    displacement: &'a [f64],
    force: &'a [f64],
}

fn period<'a>(shown: &Value, numbers: &'a [f64]) -> Period<'a> {
    let samples = shown["motions"]["samples"].as_u64().unwrap() as usize;
    let orders = shown["motions"]["orders"].as_array().unwrap().len();
    let dofs = shown["dofs"].as_array().unwrap().len();
    assert_eq!(numbers.len(), dofs * (orders + samples) + 2 * samples);
    let (harmonics, rest) = numbers.split_at(dofs * orders);
    let (displacements, contact) = rest.split_at(dofs * samples);
    let (displacement, force) = contact.split_at(samples);
    Period {
        harmonics: harmonics.chunks_exact(orders).collect(),
        dofs: displacements.chunks_exact(samples).collect(),
        displacement,
        force,
    }
}

fn magnitude(spectrum: &Value, k: usize) -> f64 {
    let lines = spectrum.as_array().unwrap();
    let line = lines.iter().find(|line| line[0] == k);
    line.map_or(0.0, |line| line[1].as_f64().unwrap().hypot(line[2].as_f64().unwrap()))
}

fn half_range(row: &[f64]) -> f64 {
    let ends = row.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
    (ends.1 - ends.0) / 2.0
}

/// ∮ f dw by trapezoids.
fn area(displacement: &[f64], force: &[f64]) -> f64 {
    let count = displacement.len();
    let strip = |i: usize| {
        let next = (i + 1) % count;
        (force[i] + force[next]) / 2.0 * (displacement[next] - displacement[i])
    };
    (0..count).map(strip).sum()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a / b - 1.0).abs() < tolerance, "{a} and {b}");
}

#[test]
fn curves_and_loops_are_those_of_the_result() {
    let path = scene("hoffmann-2017.json");
    let result = solved(&["sweep", &path, "--harmonics", "7", "--frequencies", "30:120:19"]);
    let mut report = report(&result);
    let alone = data(&report);
    report.explain(&Source::from_file(path.as_ref()).unwrap()).unwrap();
    let shown = data(&report);
    let points = result["points"].as_array().unwrap();
    for (i, dof) in ["w1", "w2"].into_iter().enumerate() {
        let expected: Vec<f64> = points.iter().map(|p| magnitude(&p["displacement"][dof], 1)).collect();
        let drawn = numbers(&shown["points"]["amplitude"][i]);
        drawn.iter().zip(&expected).for_each(|(a, b)| close(*a, *b, 1e-14));
    }
    assert_eq!(numbers(&shown["points"]["parameter"]).len(), 19);
    let periods = periods(&shown);
    assert_eq!(periods.len(), 19);
    for (index, numbers) in &periods {
        let point = &points[*index];
        let Period { harmonics, dofs, displacement, force } = period(&shown, numbers);
        for (row, dof) in harmonics.iter().zip(["w1", "w2"]) {
            for (amplitude, k) in row.iter().zip([1, 3, 5, 7]) {
                close(*amplitude, magnitude(&point["displacement"][dof], k), 1e-6);
            }
        }
        // Root and ground: the contact's displacement is that of w1.
        displacement
            .iter()
            .zip(dofs[0])
            .for_each(|(a, b)| assert!((a - b).abs() <= 1e-6 * half_range(dofs[0])));
        let contact = &point["contacts"]["root"];
        // A tip falls between two of 128 instants: at most (7π/128)²/2 of the highest harmonic is lost.
        close(half_range(displacement), contact["amplitude"].as_f64().unwrap(), 5e-3);
        close(area(displacement, force), contact["dissipation"].as_f64().unwrap(), 2e-2);
    }
    // The scene adds the plan and the response without contacts, and the laws' own forces.
    assert_eq!((&alone["plan"], &alone["points"]["linear"]), (&Value::Null, &Value::Null));
    assert_eq!((&alone["motions"]["force"], &shown["motions"]["force"]), (&json!("series"), &json!("law")));
    let steps: Value =
        solved(&["explain", &path, "--harmonics", "7", "--frequencies", "30:120:19", "--format", "json"]);
    assert_eq!(shown["plan"], steps["steps"]);
    // Without contacts: (C − Ω²M + iΩD) w = f of the scene's two masses, in closed form.
    let scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let entry = |matrix: &str, i: usize, j: usize| scene["model"][matrix][i][j].as_f64().unwrap();
    let load = scene["excitation"][0]["amplitude"].as_f64().unwrap();
    for (frequency, drawn) in
        numbers(&shown["points"]["frequency"]).iter().zip(numbers(&shown["points"]["linear"][1]))
    {
        let omega = std::f64::consts::TAU * frequency;
        let h = |i: usize, j: usize| {
            let re = entry("stiffness", i, j) - omega * omega * entry("mass", i, j);
            num_complex::Complex64::new(re, omega * entry("damping", i, j))
        };
        close(drawn, (load * h(0, 0) / (h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0))).norm(), 1e-9);
    }
}

#[test]
fn loops_without_a_scene_are_the_series_of_the_result() {
    let result =
        solved(&["sweep", &scene("elastic-coulomb.json"), "--harmonics", "3", "--frequencies", "60,75"]);
    let shown = data(&report(&result));
    for (index, numbers) in periods(&shown) {
        let Period { displacement, force, .. } = period(&shown, &numbers);
        let contact = &result["points"][index]["contacts"]["root"];
        for (j, (w, f)) in displacement.iter().zip(force).enumerate() {
            let theta = std::f64::consts::TAU * j as f64 / displacement.len() as f64;
            let at = |spectrum: &Value| -> f64 {
                let lines = spectrum.as_array().unwrap().iter();
                let number = |line: &Value, i: usize| line[i].as_f64().unwrap();
                lines
                    .map(|line| {
                        let turn = number(line, 0) * theta;
                        number(line, 1) * turn.cos() - number(line, 2) * turn.sin()
                    })
                    .sum()
            };
            let size = |spectrum: &Value| magnitude(spectrum, 1);
            assert!((w - at(&contact["displacement"])).abs() < 1e-6 * size(&contact["displacement"]));
            // As a rig measures it.
            assert!((f + at(&contact["force"])).abs() < 1e-6 * size(&contact["force"]));
        }
    }
}

#[test]
fn a_result_of_another_scene_is_refused() {
    let path = scene("elastic-coulomb.json");
    let result = solved(&["sweep", &path, "--harmonics", "7", "--frequencies", "40:120:9"]);
    let scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let explain = |scene: &Value, result: &Value| {
        let folder = TempDir::new().unwrap();
        let file = folder.path().join("scene.json");
        fs::write(&file, scene.to_string()).unwrap();
        report(result).explain(&Source::from_file(&file).unwrap())
    };
    assert!(explain(&scene, &result).is_ok());
    let changed = |pointer: &str, value: Value| {
        let mut scene = scene.clone();
        *scene.pointer_mut(pointer).unwrap() = value;
        explain(&scene, &result).unwrap_err().to_string()
    };
    let number = |pointer: &str| scene.pointer(pointer).unwrap().as_f64().unwrap();
    let slip = "/contacts/0/law/slip_force";
    let words = changed(slip, json!(1.05 * number(slip)));
    assert!(words.contains("law of contact \"root\""), "{words}");
    let load = "/excitation/0/amplitude";
    let words = changed(load, json!(1.01 * number(load)));
    assert!(words.contains("model and excitation") && words.contains("Hz"), "{words}");
    let mass = "/model/mass/0/0";
    let words = changed(mass, json!(1.01 * number(mass)));
    assert!(words.contains("model and excitation"), "{words}");
    let words = changed("/output", json!(["w2"]));
    assert!(words.contains("dofs w1, w2") && words.contains("reports w2"), "{words}");
    let words = changed("/contacts/0/name", json!("tip"));
    assert!(words.contains("contacts root") && words.contains("scene has tip"), "{words}");
    let words = changed("/name", json!("else"));
    assert!(words.contains("\"else\"") && words.contains("\"elastic-coulomb\""), "{words}");
}

#[test]
fn curves_along_an_entry_and_modes_fit_their_scenes() {
    let path = scene("cubic.json");
    let pointer = "/excitation/0/amplitude";
    for arguments in [
        &[
            "continue", &path, "--along", pointer, "--at", "43.3", "--from", "1", "--to", "4", "--format",
            "json",
        ][..],
        &["continue", &path, "--from", "42", "--to", "44", "--format", "json"],
        &["backbone", &path, "--amplitudes", "1e-4:1e-2", "--points", "10", "--format", "json"],
    ] {
        let mut report = report(&solved(arguments));
        report.explain(&Source::from_file(path.as_ref()).unwrap()).unwrap();
        let shown = data(&report);
        let count = shown["points"]["parameter"].as_array().unwrap().len();
        assert_eq!(shown["motions"]["points"].as_array().unwrap().len(), count, "{arguments:?}");
        // The spring of the scene: f = 1e9 w³.
        for (_, numbers) in periods(&shown) {
            let Period { displacement, force, .. } = period(&shown, &numbers);
            let most = 1e9 * half_range(displacement).powi(3);
            displacement
                .iter()
                .zip(force)
                .for_each(|(w, f)| assert!((f - 1e9 * w.powi(3)).abs() < 1e-5 * most));
        }
    }
}

#[test]
fn what_is_no_result_is_named() {
    let words = |text: &str| Recorded::from_json(text).unwrap_err().to_string();
    assert!(words("{").starts_with("not a result of stickslip"));
    assert!(words("{\"rows\": [], \"reference\": \"orbit\"}").contains("stickslip truncation"));
    assert!(words("{\"format_version\": 1, \"curves\": []}").contains("stickslip peaks"));
    assert!(words(&fs::read_to_string(scene("cubic.json")).unwrap()).contains("solve it first"));
    assert!(words("{\"format_version\": 2, \"points\": []}").contains("format_version 2"));
    let empty = json!({ "format_version": 1, "scene": "s", "dofs": [], "points": [] });
    let empty = Recorded::from_json(&empty.to_string()).unwrap();
    assert!(matches!(Report::default().add("a", empty), Err(ReportError::Empty(_))));
    assert!(matches!(Report::default().json(), Err(ReportError::Nothing)));
    // Curves over an excitation and over the frequency have no common axis.
    let line =
        json!({ "frequency": 1.0, "status": "failed", "harmonics": 1, "iterations": 0, "residual": null });
    let curve = |parameter: &str| {
        let curve = json!({ "format_version": 1, "scene": "s", "dofs": [], "parameter": parameter, "points": [line] });
        Recorded::from_json(&curve.to_string()).unwrap()
    };
    let mut report = Report::default();
    report.add("a", curve("frequency")).unwrap();
    let refused = report.add("b", curve("/excitation/0/amplitude")).unwrap_err().to_string();
    assert!(refused.contains("one axis"), "{refused}");
}

#[test]
fn the_command_writes_a_page_or_says_why_not() {
    let folder = TempDir::new().unwrap();
    let path = scene("two-mass.json");
    assert!(
        run(folder.path(), &["sweep", &path, "--frequencies", "20:120:11", "-o", "r.json"]).status.success()
    );
    let page = folder.path().join("report.html");
    let output = run(folder.path(), &["report", "r.json", "--scene", &path, "-o", "report.html"]);
    if report::page().is_none() {
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("cargo xtask report-page"));
        assert!(!page.exists());
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let html = fs::read_to_string(&page).unwrap();
    assert!(html.contains("<title>two-mass</title>") && html.contains("Apache License"));
    for (arguments, words) in [
        (&["report", "none.json", "-o", "x.html"][..], "cannot read none.json"),
        (&["report", &path, "-o", "x.html"], "solve it first"),
        (&["report", "r.json", "-o", "r.json"], "named twice"),
        (
            &["report", "r.json", "--scene", &scene("cubic.json"), "-o", "x.html"],
            "the scene is called \"cubic\"",
        ),
    ] {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
        assert!(!folder.path().join("x.html").exists());
    }
}
