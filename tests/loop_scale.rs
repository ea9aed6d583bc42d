//! `stickslip loop scale` from outside: its forms, its refusals, and a real damper.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use hysteresis::synthetic::{DirtyRecord, dahl_loop};
use serde_json::{Value, json};
use tempfile::TempDir;

fn scale(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .current_dir(folder)
        .args(["loop", "scale"])
        .args(arguments)
        .output()
        .unwrap()
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

fn answer(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", std::str::from_utf8(&output.stderr).unwrap());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Exit code 2 with these words, and nothing on standard output.
fn refuses(output: &Output, words: &str) {
    let message = std::str::from_utf8(&output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains(words) && output.stdout.is_empty(), "{message}");
}

const FILES: [&str; 6] = ["a.csv", "b.csv", "c.csv", "d.csv", "e.csv", "f.csv"];

/// Records of Dahl's friction at six amplitudes from 0.2 to 8 µm: a slip force that grows as eq. (6), and sliding
/// lengths that make small loops slender.
fn series() -> TempDir {
    let folder = TempDir::new().unwrap();
    let amplitudes = [0.2e-6, 0.5e-6, 1e-6, 2e-6, 4e-6, 8e-6];
    for (seed, (name, amplitude)) in (0..).zip(FILES.iter().zip(amplitudes)) {
        let alpha = amplitude / 8e-6;
        let slip_force = 12.0 * (1.0 + 0.2 * (alpha + 0.05_f64).ln());
        let sliding_length = amplitude * (0.05 + 0.4 * (-3.0 * alpha).exp());
        let truth = dahl_loop(amplitude, slip_force, slip_force / sliding_length, 15).unwrap();
        let record =
            DirtyRecord { force_noise: 0.002, seed, samples_per_cycle: 128.0, ..DirtyRecord::new(truth) };
        let text =
            record.generate().to_csv("um".parse().unwrap(), "N".parse().unwrap(), "s".parse().unwrap());
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn the_answer_has_the_form_that_was_promised() {
    let folder = series();
    let value = answer(&scale(folder.path(), &FILES));
    for (law, names) in [("magnitude", ["offset", "shift", "slope"]), ("phase", ["decay", "limit", "span"])] {
        let numbers = value[law].as_object().unwrap();
        assert_eq!(numbers.keys().map(String::as_str).collect::<Vec<_>>(), names);
        for (name, number) in numbers {
            let (estimate, error) =
                (number["value"].as_f64().unwrap(), number["std_error"].as_f64().unwrap());
            assert!(error > 0.0, "{name}: {number}");
            // Three degrees of freedom: Student's t is 3.182.
            assert!(
                (number["interval"][1].as_f64().unwrap() - estimate - 3.1824 * error).abs() < 1e-4 * error
            );
            assert_eq!(&value["law"][law][name], &number["value"]);
        }
    }
    assert!(value["residual_rms"].as_f64().unwrap() > 0.0);
    assert_eq!((&value["force"], &value["weights"]), (&json!("turning-points"), &json!("equal")));
    assert_eq!(value["reference"]["file"], "f.csv");
    assert!((value["reference"]["displacement"].as_f64().unwrap() / 8e-6 - 1.0).abs() < 1e-3);
    assert!((value["reference"]["force"].as_f64().unwrap() / 12.117 - 1.0).abs() < 0.01);
    assert_eq!((&value["passive"], &value["loops"][2]["file"]), (&json!(true), &json!("c.csv")));
    assert!((value["loops"][2]["alpha"].as_f64().unwrap() / 0.125 - 1.0).abs() < 1e-3);
    // Dahl's phase is no exponential, and the noise is too small to hide it.
    assert!(
        value["notes"]
            .as_array()
            .unwrap()
            .iter()
            .any(|note| note.as_str().unwrap().contains("times their noise"))
    );

    let mut turned = FILES;
    turned.reverse();
    let again = answer(&scale(folder.path(), &turned));
    assert_eq!((&again["magnitude"], &again["phase"]), (&value["magnitude"], &value["phase"]));
}

#[test]
fn options_reach_the_fit() {
    let folder = series();
    let with = |options: &[&str]| answer(&scale(folder.path(), &[&FILES, options].concat()));
    let usual = with(&[]);
    let first = with(&["--magnitude", "first-harmonic"]);
    assert_eq!(first["force"], "first-harmonic");
    assert!(first["magnitude"] != usual["magnitude"] && first["phase"] == usual["phase"]);
    let noise = with(&["--weights", "noise"]);
    assert!(noise["weights"] == "noise" && noise["phase"] != usual["phase"]);
    let other = with(&["--reference", "./d.csv"]);
    assert_eq!((&other["reference"]["file"], &other["loops"][3]["alpha"]), (&json!("d.csv"), &json!(1.0)));
    refuses(&scale(folder.path(), &[&FILES[..], &["--flip-force"]].concat()), "leave --flip-force out");
    let columns = ["--columns", "displacement=3,force=2", "--units", "displacement=m,force=N"];
    refuses(&scale(folder.path(), &[&FILES[..], &columns].concat()), "a.csv");
}

#[test]
fn a_scene_takes_the_law() {
    let folder = series();
    let text = scale(folder.path(), &[&FILES[..], &["--format", "text"]].concat());
    let text = stdout(&text);
    assert!(
        text.starts_with("6 loops, relative to f.csv: W* = 8.0") && text.contains("turning points"),
        "{text}"
    );
    assert!(text.contains("3 degrees of freedom") && text.contains("std. error"), "{text}");
    let snippet = &text[text.find("\"magnitude\"").unwrap()..];
    let scene = format!(
        r#"{{"model": {{"dofs": ["w"], "mass": [[1]], "damping": [[1]], "stiffness": [[1e5]]}},
             "excitation": [{{"dof": "w", "amplitude": 1}}],
             "contacts": [{{"name": "c", "between": ["w", "ground"],
                            "law": {{"type": "scaled_loop", "loop": {{"file": "f.csv"}}, {snippet}}}}}],
             "frequencies": [40], "harmonics": 1}}"#
    );
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    let check = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .current_dir(folder.path())
        .args(["check", "scene.json"])
        .output()
        .unwrap();
    assert!(check.status.success(), "{}", std::str::from_utf8(&check.stderr).unwrap());
}

#[test]
fn csv_is_one_number_a_line() {
    let folder = series();
    let output = scale(folder.path(), &[&FILES[..], &["--format", "csv"]].concat());
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines[0], "law,parameter,value,std_error,lower,upper");
    assert!(
        lines.len() == 7 && lines[3].starts_with("magnitude,shift,") && lines[4].starts_with("phase,limit,-")
    );
    assert!(lines.iter().all(|line| line.split(',').count() == 6 && !line.contains(",,")));
    let three = scale(folder.path(), &["a.csv", "c.csv", "f.csv", "--format", "csv"]);
    assert!(stdout(&three).lines().skip(1).all(|line| line.ends_with(",,,")));
}

#[test]
fn what_identifies_nothing_is_refused() {
    let folder = series();
    let refused = |arguments: &[&str], words: &str| refuses(&scale(folder.path(), arguments), words);
    refused(&["a.csv", "b.csv"], "at least three different amplitudes");
    refused(&["a.csv", "b.csv", "./a.csv"], "given twice");
    refused(&["a.csv", "b.csv", "c.csv", "--reference", "d.csv"], "must be one of the records");
    refused(&["a.csv", "b.csv", "absent.csv"], "absent.csv");
    refused(&["a.csv", "b.csv", "c.csv", "--plot", "law.pdf"], ".svg or .png");
    fs::copy(folder.path().join("a.csv"), folder.path().join("copy.csv")).unwrap();
    refused(&["a.csv", "b.csv", "copy.csv"], "at least three different amplitudes");
    assert_eq!(scale(folder.path(), &[]).status.code(), Some(2));
}

#[cfg(feature = "plot")]
#[test]
fn a_picture_is_drawn() {
    let folder = series();
    answer(&scale(folder.path(), &[&FILES[..], &["--plot", "laws.svg"]].concat()));
    let svg = fs::read_to_string(folder.path().join("laws.svg")).unwrap();
    // Six loops twice, and once in the legend.
    assert_eq!(svg.matches("<circle").count(), 13);
    assert!(svg.contains(">turning-point force / F*</text>"));
}

/// The licence of these records keeps them out of this tree.
fn real_records() -> Option<Vec<String>> {
    let folder = std::env::var_os("STICKSLIP_LOOPS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/loops"), PathBuf::from);
    if !folder.is_dir() {
        eprintln!("SKIPPED: no real records in {}; set STICKSLIP_LOOPS to their folder", folder.display());
        return None;
    }
    let named = |inches| folder.join(format!("arts-2_0.5Hz30lb-tension{inches}.csv")).display().to_string();
    Some(["0.5", "1", "1.5"].map(named).to_vec())
}

#[test]
fn three_loops_of_a_real_damper_have_no_errors_and_it_is_said() {
    let Some(files) = real_records() else { return };
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let value = answer(&scale(Path::new("."), &files));
    for law in ["magnitude", "phase"] {
        assert!(value[law].as_object().unwrap().values().all(|number| number["std_error"].is_null()));
        assert_eq!(value["quality"][law]["freedom"], 0);
    }
    let notes: Vec<&str> =
        value["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap()).collect();
    let said = |words: &str| notes.iter().any(|note| note.contains(words));
    assert!(
        said("determine the three numbers of each law exactly") && said("there are no errors"),
        "{notes:?}"
    );
    assert!(said("only 2.99 times the smallest"), "{notes:?}");
    // Its force grows faster the larger the amplitude, which (6) cannot.
    assert!(said("the shift becomes") && said("which the law cannot"), "{notes:?}");
    let magnitude = value["quality"]["magnitude"]["residual_rms"].as_f64().unwrap();
    assert!((0.015..0.03).contains(&magnitude), "{magnitude}");
    // (7) can: three points on an exponential, not tested by them.
    assert!(value["quality"]["phase"]["residual_rms"].as_f64().unwrap() < 1e-12);
    assert_eq!(value["passive"], true);
}
