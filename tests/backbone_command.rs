//! `stickslip backbone` from outside.
#![allow(clippy::unwrap_used, clippy::panic)]

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

#[test]
fn a_mode_has_the_form_that_the_book_says() {
    let output = run("backbone", &["cubic.json", "--amplitudes", "1e-5:1e-2", "--points", "20"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mode: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&mode["mode"], &mode["origin"], &mode["dof"]), (&1.into(), &"stuck".into(), &"w2".into()));
    let points = mode["points"].as_array().unwrap();
    let amplitudes: Vec<f64> = points.iter().map(|p| p["amplitude"].as_f64().unwrap()).collect();
    assert!(amplitudes.len() >= 20 && amplitudes.is_sorted());
    assert!((amplitudes[0] / 1e-5 - 1.0).abs() < 1e-12);
    for point in points {
        let harmonics = point["displacement"]["w2"].as_array().unwrap();
        assert!(
            (harmonics[0][1].as_f64().unwrap() / point["amplitude"].as_f64().unwrap() - 1.0).abs() < 1e-9
        );
    }
    // The resonance of the scene's own excitation is a peak of its response curve, which hardly any damping widens.
    let curve: Value = serde_json::from_slice(&run("continue", &["cubic.json"]).stdout).unwrap();
    let size = |point: &Value| {
        let first = &point["displacement"]["w2"][0];
        first[1].as_f64().unwrap().hypot(first[2].as_f64().unwrap())
    };
    let highest = curve["points"].as_array().unwrap().iter().map(size).fold(0.0, f64::max);
    let expected = mode["expected"]["amplitude"].as_f64().unwrap();
    assert!((expected / highest - 1.0).abs() < 1e-3, "{expected} and {highest}");
}

#[test]
fn wrong_words_are_answered() {
    for (arguments, words) in [
        (&["elastic-coulomb.json", "--mode", "3"][..], "there are 2 modes"),
        (&["elastic-coulomb.json", "--dof", "w3"][..], "there is no dof \"w3\""),
        (&["elastic-coulomb.json", "--amplitudes", "1e-3:1e-6"][..], "two growing positive numbers"),
        (&["cubic.json"][..], "--amplitudes"),
    ] {
        let output = run("backbone", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}
