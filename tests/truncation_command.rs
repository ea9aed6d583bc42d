//! `stickslip truncation` and `stickslip orbit` from outside.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// A folder with an example in it.
fn example(template: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &["init", template]);
    assert!(output.status.success(), "{}", stderr(&output));
    folder
}

fn answer(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(output)))
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn a_truncation_has_the_form_that_was_promised() {
    let folder = example("two-mass");
    let output = run(
        folder.path(),
        &["truncation", "two-mass.json", "--harmonics", "7,1,15", "--frequencies", "75,108"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let value = answer(&output);
    assert_eq!(keys(&value), ["dofs", "harmonics", "notes", "rates", "reference", "rows", "scene"]);
    // A measured loop has no orbit.
    assert_eq!((&value["reference"], &value["harmonics"]), (&json!("harmonics:127"), &json!([1, 7, 15])));
    let rows = value["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let expected = [
            "error",
            "error_dissipation",
            "error_first",
            "error_peak",
            "estimate",
            "frequency",
            "harmonics",
            "seconds",
            "status",
        ];
        assert_eq!(keys(row), expected);
        assert!(row["error"].as_f64().unwrap() > 0.0 && row["seconds"].as_f64().unwrap() > 0.0);
    }
    // 3.8 % and 1.6 % of |W_1| with one harmonic.
    assert!(
        rows[0]["error_first"].as_f64().unwrap() > 0.01 && rows[3]["error_first"].as_f64().unwrap() > 0.005
    );
    assert_eq!(keys(&value["rates"][0]), ["error", "error_first", "frequency"]);
}

#[test]
fn a_tolerance_that_is_missed_is_exit_code_one() {
    let folder = example("two-mass");
    let require = |tolerance: &str| {
        run(
            folder.path(),
            &[
                "truncation",
                "two-mass.json",
                "--harmonics",
                "1,7",
                "--frequencies",
                "75,108",
                "--require",
                tolerance,
            ],
        )
    };
    assert_eq!(require("0.5").status.code(), Some(0));
    let missed = require("1e-12");
    assert_eq!(missed.status.code(), Some(1));
    assert!(stderr(&missed).contains("missed: N = 7 has an error of "), "{}", stderr(&missed));
    assert!(stderr(&missed).contains("at 75 Hz, 1e-12 is required"), "{}", stderr(&missed));
    // The answer is written all the same.
    assert_eq!(answer(&missed)["rows"].as_array().unwrap().len(), 4);
}

#[test]
fn forms_of_a_truncation() {
    let folder = example("two-mass");
    let base = ["truncation", "two-mass.json", "--harmonics", "1,3", "--frequencies", "75"];
    let with = |more: &[&str]| run(folder.path(), &[&base[..], more].concat());
    let text = with(&["--format", "text"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.starts_with("two-mass: relative errors against N = 127, the worst of w1, w2\n"), "{text}");
    let output = with(&["-o", "error.csv", "--plot", "error.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let csv = fs::read_to_string(folder.path().join("error.csv")).unwrap();
    assert_eq!(csv.lines().count(), 3);
    assert!(
        csv.starts_with("frequency,harmonics,status,error,") && csv.contains("\n75,1,converged,"),
        "{csv}"
    );
    assert!(fs::read_to_string(folder.path().join("error.svg")).unwrap().contains("75 Hz"));
    // Many frequencies are summed up.
    let many = run(
        folder.path(),
        &[
            "truncation",
            "two-mass.json",
            "--harmonics",
            "1,3",
            "--frequencies",
            "70:110:20",
            "--format",
            "text",
        ],
    );
    let many = String::from_utf8(many.stdout).unwrap();
    assert!(many.contains("worst error") && many.lines().count() < 10, "{many}");
}

#[test]
fn harmonics_below_the_excitation_are_skipped() {
    let folder = example("two-mass");
    let path = folder.path().join("two-mass.json");
    let mut scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    scene["excitation"][0]["harmonic"] = json!(3);
    fs::write(&path, scene.to_string()).unwrap();
    let base = ["truncation", "two-mass.json", "--frequencies", "25", "--harmonics"];
    let some = run(folder.path(), &[&base[..], &["1,3,9"]].concat());
    assert_eq!(some.status.code(), Some(0), "{}", stderr(&some));
    assert_eq!(answer(&some)["harmonics"], json!([3, 9]));
    assert!(stderr(&some).contains("note: N = 1 skipped: harmonic 3 is excited"), "{}", stderr(&some));
    let none = run(folder.path(), &[&base[..], &["1,2"]].concat());
    assert_eq!(none.status.code(), Some(2));
    assert!(stderr(&none).contains("excited harmonic 3"), "{}", stderr(&none));
}

#[test]
fn friction_is_measured_against_the_exact_orbit() {
    let folder = example("elastic-coulomb");
    // At 40 Hz all sliders stick: no events, no orbit.
    let arguments = ["truncation", "elastic-coulomb.json", "--harmonics", "1,31", "--frequencies", "40,57"];
    let output = run(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let value = answer(&output);
    assert_eq!(value["reference"], "orbit");
    let rows = value["rows"].as_array().unwrap();
    assert_eq!((&rows[0]["reference"], &rows[2]["reference"]), (&json!("harmonics:127"), &Value::Null));
    assert!((rows[2]["error"].as_f64().unwrap() / 0.675 - 1.0).abs() < 0.03, "{}", rows[2]);
    assert!((rows[3]["error"].as_f64().unwrap() / 2.55e-5 - 1.0).abs() < 0.03, "{}", rows[3]);
    assert!(
        stderr(&output).contains("no orbit was found at 40 Hz (every slider sticks"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn an_orbit_has_spectrum_events_and_waveform() {
    let folder = example("elastic-coulomb");
    let base = ["orbit", "elastic-coulomb.json", "--frequency", "62"];
    let with = |more: &[&str]| run(folder.path(), &[&base[..], more].concat());
    let output = with(&["--harmonics", "5", "--waveform", "orbit.csv", "--plot", "orbit.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let value = answer(&output);
    let expected = [
        "amplitude",
        "closure",
        "contacts",
        "displacement",
        "energy_error",
        "events",
        "format_version",
        "frequency",
        "period",
        "scene",
        "units",
    ];
    assert_eq!(keys(&value), expected);
    assert!(value["closure"].as_f64().unwrap() < 1e-11 && value["energy_error"].as_f64().unwrap() < 1e-9);
    let spectrum = value["displacement"]["w1"].as_array().unwrap();
    assert_eq!(spectrum.len(), 6);
    let first = spectrum[1][1].as_f64().unwrap().hypot(spectrum[1][2].as_f64().unwrap());
    assert!((first / 2.943539707e-6 - 1.0).abs() < 1e-8);
    let events = value["events"].as_array().unwrap();
    assert_eq!(events.len(), 8);
    assert_eq!(keys(&events[0]), ["begins", "contact", "direction", "slider", "time"]);
    assert_eq!(events[0]["contact"], "root");
    assert_eq!(keys(&value["contacts"]["root"]), ["dissipation", "force"]);
    let csv = fs::read_to_string(folder.path().join("orbit.csv")).unwrap();
    let header = "time [s],w1 [m],w1 velocity [m/s],w2 [m],w2 velocity [m/s],root force [N]\n";
    assert!(csv.starts_with(header), "{}", csv.lines().next().unwrap());
    assert_eq!(csv.lines().count(), 2049);
    assert!(fs::read_to_string(folder.path().join("orbit.svg")).unwrap().contains("time / period"));
    let text = with(&["--format", "text"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.starts_with("elastic-coulomb at 62 Hz: the exact periodic motion\n"), "{text}");
    assert!(text.contains("8 events in a period") && text.contains("slip begins (−)"), "{text}");
    // Nothing to follow is no mistake of the scene.
    let stuck =
        run(folder.path(), &["orbit", "elastic-coulomb.json", "--frequency", "40", "-o", "none.json"]);
    assert_eq!(stuck.status.code(), Some(1), "{}", stderr(&stuck));
    assert!(stderr(&stuck).contains("no orbit at 40 Hz: every slider sticks"), "{}", stderr(&stuck));
    assert!(!folder.path().join("none.json").exists());
}

#[test]
fn what_cannot_be_asked_for() {
    let folder = example("two-mass");
    let refused = |arguments: &[&str], message: &str| {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(message), "{arguments:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
    };
    refused(
        &["truncation", "two-mass.json", "--harmonics", "0"],
        "--harmonics: must be a whole number from 1",
    );
    refused(&["truncation", "two-mass.json", "--harmonics", "1,x"], "--harmonics");
    refused(&["truncation", "two-mass.json", "--require", "-1"], "--require");
    refused(&["truncation", "two-mass.json", "-o", "two-mass.json"], "named twice");
    refused(&["truncation", "two-mass.json", "-o", "x.pdf"], "no format is called .pdf");
    refused(&["truncation", "missing.json"], "cannot read missing.json");
    refused(&["orbit", "two-mass.json"], "--frequency");
    refused(&["orbit", "two-mass.json", "--frequency", "0"], "positive number of Hz");
    refused(&["orbit", "two-mass.json", "--frequency", "57"], "no exact orbit of contact");
}
