//! Results and records in the formats of other programs, from outside. What NumPy and data frames make of them is tested in
//! `crates/python/tests/test_formats.py`.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::process::{Command, Output};

use arrays::{NpzReader, NpzWriter};
use serde_json::{Value, json};
use tempfile::TempDir;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
}

/// A folder with an example.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    done(folder.path(), &["init", "two-mass"]);
    folder
}

fn numbers(folder: &Path, file: &str, name: &str) -> Vec<f64> {
    let bytes = fs::read(folder.join(file)).unwrap();
    NpzReader::open(Cursor::new(bytes)).unwrap().read(name, |array| array.values(0)).unwrap()
}

fn names(folder: &Path, file: &str) -> Vec<String> {
    NpzReader::open(Cursor::new(fs::read(folder.join(file)).unwrap())).unwrap().names()
}

fn json_of(folder: &Path, file: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(file)).unwrap()).unwrap()
}

fn floats(values: &Value, key: &str) -> Vec<f64> {
    values.as_array().unwrap().iter().map(|point| point[key].as_f64().unwrap_or(f64::NAN)).collect()
}

const SWEEP: [&str; 6] = ["sweep", "two-mass.json", "--frequencies", "20:120:9", "--harmonics", "3"];

#[test]
fn a_sweep_is_the_same_in_every_format() {
    let folder = folder();
    let sweep = |file: &str| done(folder.path(), &[&SWEEP[..], &["-o", file]].concat());
    for file in ["x.json", "x.csv", "x.npz", "x.parquet", "again.npz", "again.parquet"] {
        sweep(file);
    }
    let points = json_of(folder.path(), "x.json")["points"].clone();
    for key in ["frequency", "harmonics", "residual", "iterations"] {
        assert_eq!(numbers(folder.path(), "x.npz", key), floats(&points, key), "{key}");
    }
    assert_eq!(numbers(folder.path(), "x.npz", "converged"), [1.0; 9]);
    let amplitudes: Vec<f64> = points
        .as_array()
        .unwrap()
        .iter()
        .map(|point| point["contacts"]["root"]["amplitude"].as_f64().unwrap())
        .collect();
    assert_eq!(numbers(folder.path(), "x.npz", "contact_amplitude"), amplitudes);
    let read = |file: &str| fs::read(folder.path().join(file)).unwrap();
    assert_eq!(read("x.npz"), read("again.npz"));
    assert_eq!(read("x.parquet"), read("again.parquet"));
    let parquet = read("x.parquet");
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    // By its name or because it is asked for, to a file or into a pipe.
    done(folder.path(), &[&SWEEP[..], &["-o", "named.bin", "--format", "npz"]].concat());
    assert_eq!(read("named.bin"), read("x.npz"));
    let piped = run(folder.path(), &[&SWEEP[..], &["--format", "parquet"]].concat());
    assert_eq!(piped.stdout, parquet);
}

#[test]
fn a_failed_point_is_nan_and_not_converged() {
    let folder = folder();
    let output = run(
        folder.path(),
        &["sweep", "two-mass.json", "--frequencies", "60,1e300", "--harmonics", "3", "-o", "x.npz"],
    );
    let points = run(
        folder.path(),
        &["sweep", "two-mass.json", "--frequencies", "60,1e300", "--harmonics", "3", "--format", "json"],
    );
    assert_eq!(output.status.code(), points.status.code(), "{}", stderr(&output));
    let points: Value = serde_json::from_slice(&points.stdout).unwrap();
    let solved: Vec<f64> = points["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|point| f64::from(u8::from(point["status"] != "failed")))
        .collect();
    assert_eq!(numbers(folder.path(), "x.npz", "converged"), solved);
}

#[test]
fn tables_are_columns() {
    let folder = folder();
    fs::write(
        folder.path().join("study.json"),
        json!({
            "scene": "two-mass.json",
            "vary": { "/excitation/0/amplitude": [5, 10] },
            "frequencies": { "from": 40, "to": 110, "points": 15 },
            "harmonics": [1, 3],
            "keep": "peaks"
        })
        .to_string(),
    )
    .unwrap();
    for file in ["s.json", "s.npz", "s.parquet"] {
        done(folder.path(), &["study", "study.json", "-o", file]);
    }
    let rows = json_of(folder.path(), "s.json")["rows"].clone();
    for key in ["frequency", "harmonics"] {
        assert_eq!(numbers(folder.path(), "s.npz", key), floats(&rows, key));
    }
    let amplitudes = (numbers(folder.path(), "s.npz", "amplitude"), floats(&rows, "amplitude"));
    assert!(
        amplitudes
            .0
            .iter()
            .zip(&amplitudes.1)
            .all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
    );
    let varied: Vec<f64> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["vary"]["/excitation/0/amplitude"].as_f64().unwrap())
        .collect();
    assert_eq!(numbers(folder.path(), "s.npz", "/excitation/0/amplitude"), varied);
    let leftovers = fs::read_dir(folder.path())
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".part"));
    assert_eq!(leftovers.count(), 0);

    done(
        folder.path(),
        &["truncation", "two-mass.json", "--frequencies", "60", "--harmonics", "1,3", "-o", "t.npz"],
    );
    assert_eq!(numbers(folder.path(), "t.npz", "harmonics"), [1.0, 3.0]);
    done(folder.path(), &["init", "cubic"]);
    for file in ["c.json", "c.npz"] {
        done(
            folder.path(),
            &["continue", "cubic.json", "--harmonics", "1", "--from", "35", "--to", "50", "-o", file],
        );
    }
    let points = json_of(folder.path(), "c.json")["points"].clone();
    assert_eq!(numbers(folder.path(), "c.npz", "parameter"), floats(&points, "parameter"));
    let folds = points.as_array().unwrap().iter().map(|point| f64::from(u8::from(point["fold"] == true)));
    assert_eq!(numbers(folder.path(), "c.npz", "fold"), folds.collect::<Vec<_>>());
    assert!(names(folder.path(), "c.npz").contains(&"W".to_owned()));
}

#[test]
fn other_extensions_are_refused_with_those_that_there_are() {
    let folder = folder();
    let output = run(folder.path(), &["sweep", "two-mass.json", "-o", "x.xlsx"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains(".npz or .parquet"), "{}", stderr(&output));
}

/// Five cycles of a loop.
fn motion() -> (Vec<f64>, Vec<f64>) {
    let tau = |k: u32| f64::from(k) * 2.0 * std::f64::consts::PI / 200.0;
    (0..1001).map(|k| (8e-6 * tau(k).cos(), 12.0 * (tau(k) + 0.8).cos())).unzip()
}

#[test]
fn a_loop_in_arrays_is_the_loop_in_text() {
    let folder = folder();
    let (d, f) = motion();
    let lines: Vec<String> = d.iter().zip(&f).map(|(d, f)| format!("{d:e},{f:e}")).collect();
    fs::write(folder.path().join("r.csv"), format!("displacement [m],force [N]\n{}\n", lines.join("\n")))
        .unwrap();
    let mut bytes = Vec::new();
    let mut archive = NpzWriter::new(&mut bytes);
    let rows = d.iter().zip(&f).flat_map(|(d, f)| [*d, *f]);
    archive.numbers("rig", &[d.len(), 2], rows).unwrap();
    archive.numbers("rate", &[], [200.0]).unwrap();
    archive.finish().unwrap();
    fs::write(folder.path().join("r.npz"), bytes).unwrap();

    let text = run(folder.path(), &["loop", "fit", "r.csv", "--format", "json"]);
    let units = ["--units", "displacement=m,force=N", "--format", "json"];
    for option in ["--columns", "--variables"] {
        let columns = ["loop", "fit", "r.npz", option, "displacement=rig:1,force=rig:2"];
        let arrays = run(folder.path(), &[&columns[..], &units].concat());
        assert_eq!(arrays.status.code(), Some(0), "{}", stderr(&arrays));
        assert_eq!(arrays.stdout, text.stdout);
    }
    let refused = run(folder.path(), &["loop", "fit", "r.npz"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("r.npz") && stderr(&refused).contains("--columns displacement=rig:1"));

    // In a scene.
    let mut scene = json_of(folder.path(), "two-mass.json");
    scene["contacts"][0]["law"]["loop"] = json!({ "file": "r.csv" });
    fs::write(folder.path().join("text.json"), scene.to_string()).unwrap();
    scene["contacts"][0]["law"]["loop"] = json!({
        "file": "r.npz", "columns": { "displacement": "rig:1", "force": "rig:2" },
        "units": { "displacement": "m", "force": "N" }
    });
    fs::write(folder.path().join("arrays.json"), scene.to_string()).unwrap();
    let sweep = |scene: &str| {
        run(folder.path(), &["sweep", scene, "--frequencies", "40:80:5", "--format", "csv"]).stdout
    };
    assert_eq!(sweep("arrays.json"), sweep("text.json"));
    assert!(!sweep("arrays.json").is_empty());
}
