//! `stickslip peaks` from outside.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn run(command: &str, arguments: &[&str]) -> Output {
    let mut stickslip = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    stickslip.current_dir(scenes()).arg(command).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

const SLIP: [&str; 8] = [
    "hoffmann-2017-elastic-coulomb.json",
    "--vary",
    "/contacts/0/law/slip_force",
    "--from",
    "5",
    "--to",
    "50",
    "--log",
];

fn slip(more: &[&str]) -> Output {
    run("peaks", &[&SLIP, more].concat())
}

/// The highest point of the response at the optimum, by another command, is the peak; beside it the response is higher.
#[test]
fn an_optimum_is_what_sweeps_show() {
    let found = json(&slip(&["--harmonics", "1,3", "--points", "7"]));
    assert_eq!((&found["dof"], &found["harmonic"]), (&"w2".into(), &1.into()));
    let curves = found["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 2);
    for (curve, harmonics) in curves.iter().zip(["1", "3"]) {
        let optimum = &curve["optimum"];
        assert_eq!((&optimum["kind"], &optimum["status"]), (&"crossing".into(), &"surveyed".into()));
        let [first, second] = [0, 1].map(|i| &optimum["peaks"][i]);
        let [amplitude, other] = [first, second].map(|peak| peak["amplitude"].as_f64().unwrap());
        assert!((amplitude / other - 1.0).abs() < 1e-6);
        let folder = tempfile::tempdir().unwrap();
        let highest = |value: f64, hertz: f64| {
            let scene = std::fs::read_to_string(scenes().join(SLIP[0])).unwrap();
            let mut scene: Value = serde_json::from_str(&scene).unwrap();
            scene["contacts"][0]["law"]["slip_force"] = value.into();
            let path = folder.path().join("scene.json");
            std::fs::write(&path, scene.to_string()).unwrap();
            let range = format!("{}:{}:401", hertz - 1e-2, hertz + 1e-2);
            let path = path.to_str().unwrap();
            let sweep = json(&run("sweep", &[path, "--harmonics", harmonics, "--frequencies", &range]));
            let size = |point: &Value| {
                let first = &point["displacement"]["w2"][0];
                first[1].as_f64().unwrap().hypot(first[2].as_f64().unwrap())
            };
            sweep["points"].as_array().unwrap().iter().map(size).fold(0.0, f64::max)
        };
        let best = optimum["parameter"].as_f64().unwrap();
        for (peak, higher) in [(first, 1.001), (second, 0.999), (first, 0.999), (second, 1.001)] {
            let hertz = peak["frequency"].as_f64().unwrap();
            assert!((highest(best, hertz) / amplitude - 1.0).abs() < 1e-6);
            // On each side one of the two peaks is higher.
            let beside =
                [first, second].map(|peak| highest(best * higher, peak["frequency"].as_f64().unwrap()));
            assert!(beside[0].max(beside[1]) > amplitude);
        }
    }
}

#[test]
fn the_forms_of_the_answer_agree() {
    let more = ["--harmonics", "1", "--points", "5"];
    let found = json(&slip(&more));
    let points = found["curves"][0]["points"].as_array().unwrap();
    let csv = slip(&[&more[..], &["--format", "csv"]].concat());
    let mut rows = csv::Reader::from_reader(csv.stdout.as_slice());
    let rows: Vec<csv::StringRecord> = rows.records().collect::<Result<_, _>>().unwrap();
    let peaks = points.iter().flat_map(|p| p["peaks"].as_array().unwrap().iter().map(move |peak| (p, peak)));
    for (row, (point, peak)) in rows.iter().zip(peaks.clone()) {
        assert_eq!(row[1].parse::<f64>().unwrap(), point["parameter"].as_f64().unwrap());
        assert_eq!(row[5].parse::<f64>().unwrap(), peak["amplitude"].as_f64().unwrap());
        let root = &peak["contacts"]["root"]["dissipation"];
        assert_eq!(row[6].parse::<f64>().unwrap(), root.as_f64().unwrap());
    }
    assert_eq!(rows.len(), peaks.count());
    let words = slip(&[&more[..], &["--format", "text"]].concat());
    assert!(text(&words.stdout).contains("optimum: 16.61736"), "{}", text(&words.stdout));
    assert!(text(&words.stdout).contains(" N, where two peaks are equally high"));
}

/// Beyond 14.3 N the peak lies above the scene's frequencies: that is said, and there is no number.
#[test]
fn a_peak_that_leaves_the_range_is_not_invented() {
    let vary = ["cubic.json", "--vary", "/excitation/0/amplitude", "--from", "10", "--to", "20"];
    let found = json(&run("peaks", &[&vary[..], &["--points", "5"]].concat()));
    let points = found["curves"][0]["points"].as_array().unwrap();
    let last = &points[points.len() - 1];
    assert_eq!((&last["status"], last["peaks"].as_array().unwrap().len()), (&"higher at end".into(), 0));
    assert!(last["higher"][0].as_f64().unwrap() == 48.0);
    assert!(found["notes"].to_string().contains("higher at an end of the frequencies"));
}

#[test]
fn wrong_words_are_answered() {
    let vary = |pointer: &'static str, from: &'static str, to: &'static str| {
        ["cubic.json", "--vary", pointer, "--from", from, "--to", to]
    };
    for (arguments, words) in [
        (
            &vary("/excitation/0/amplitude", "3", "1")[..],
            "--vary /excitation/0/amplitude: its range must grow, got 3 to 1",
        ),
        (&vary("/excitation/0/amplitud", "1", "3")[..], "has no entry"),
        (&vary("/excitation/0/dof", "1", "3")[..], "only numbers can be varied"),
        (&vary("/harmonics", "1", "3")[..], "peaks are no curve over it"),
        (&[SLIP[0], SLIP[1], SLIP[2], "--from", "-1", "--to", "3"][..], "/contacts/0/law/slip_force = -1"),
        (&[&vary("/excitation/0/amplitude", "0", "1")[..], &["--log"]].concat(), "begins above zero, got 0"),
        (&[&vary("/excitation/0/amplitude", "1", "3")[..], &["--dof", "w3"]].concat(), "no dof \"w3\""),
        (&[&vary("/excitation/0/amplitude", "1", "3")[..], &["--frequencies", "57"]].concat(), "range"),
    ] {
        let output = run("peaks", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}
