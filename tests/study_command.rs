//! `stickslip study` from outside.
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

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// A folder with an example and a study of it.
fn folder(study: &Value) -> TempDir {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &["init", "two-mass"]);
    assert!(output.status.success(), "{}", stderr(&output));
    fs::write(folder.path().join("study.json"), study.to_string()).unwrap();
    folder
}

fn study() -> Value {
    json!({
        "scene": "two-mass.json",
        "vary": { "/contacts/0/law/symmetric": [] , "/excitation/0/amplitude": { "from": 5, "to": 20, "points": 4 },
                  "/model/stiffness/0/0": [8.0e5, 8.2e5, 8.4e5] },
        "frequencies": { "from": 40, "to": 110, "points": 15 },
        "harmonics": [1, 3],
        "keep": "peaks"
    })
}

/// The study without its wrong entry.
fn good() -> Value {
    let mut study = study();
    study["vary"].as_object_mut().unwrap().remove("/contacts/0/law/symmetric");
    study
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn a_study_has_the_form_that_was_promised() {
    let folder = folder(&good());
    let output = run(folder.path(), &["study", "study.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let expected = ["cases", "complete", "dofs", "format_version", "keep", "rows", "study", "units", "vary"];
    assert_eq!(keys(&value), expected);
    assert_eq!(
        (&value["cases"], &value["complete"], &value["keep"]),
        (&json!(24), &json!(true), &json!("peaks"))
    );
    let row = &value["rows"][0];
    let expected = [
        "amplitude",
        "case",
        "dissipation",
        "dof",
        "failed",
        "first",
        "frequency",
        "harmonics",
        "peak",
        "truncation_error",
        "vary",
    ];
    assert_eq!(keys(row), expected);
    assert_eq!(row["vary"], json!({ "/excitation/0/amplitude": 5.0, "/model/stiffness/0/0": 8.0e5 }));
    assert_eq!((&row["peak"], &row["dof"], &row["harmonics"]), (&json!("highest"), &json!("w1"), &json!(1)));
    // The highest point is that of a sweep of the same scene.
    let path = folder.path().join("two-mass.json");
    let mut scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    scene["excitation"][0]["amplitude"] = json!(5);
    scene["model"]["stiffness"][0][0] = json!(8.0e5);
    fs::write(folder.path().join("one.json"), scene.to_string()).unwrap();
    let sweep = run(folder.path(), &["sweep", "one.json", "--frequencies", "40:110:15"]);
    let sweep: Value = serde_json::from_slice(&sweep.stdout).unwrap();
    let at = sweep["points"]
        .as_array()
        .unwrap()
        .iter()
        .find(|point| point["frequency"] == row["frequency"])
        .unwrap();
    let w = |i: usize| at["displacement"]["w1"][0][i].as_f64().unwrap();
    assert_eq!(row["first"].as_f64().unwrap(), w(1).hypot(w(2)));
    assert_eq!(row["dissipation"], at["contacts"]["root"]["dissipation"]);
}

#[test]
fn an_interrupted_study_goes_on_and_threads_change_nothing() {
    let folder = folder(&good());
    let path = |name: &str| folder.path().join(name);
    let whole = run(folder.path(), &["study", "study.json", "-o", "one.csv", "--threads", "1"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    assert!(!path("one.csv.part").exists());
    // Make what an interruption leaves: some cases, and half a line.
    let two = run(folder.path(), &["study", "study.json", "-o", "two.csv", "--threads", "2"]);
    assert_eq!(two.status.code(), Some(0));
    assert_eq!(fs::read(path("one.csv")).unwrap(), fs::read(path("two.csv")).unwrap());

    let dry = run(folder.path(), &["study", "study.json", "--dry-run"]);
    assert!(
        stdout(&dry).starts_with("study: 24 cases of 15 frequencies, 360 points to solve\n"),
        "{}",
        stdout(&dry)
    );

    // A run that stopped in its first line, and one of another study.
    fs::write(path("three.csv.part"), "{\"stickslip_study\":1,\"fingerp").unwrap();
    let three = run(folder.path(), &["study", "study.json", "-o", "three.csv"]);
    assert_eq!(three.status.code(), Some(0), "{}", stderr(&three));
    assert_eq!(fs::read(path("one.csv")).unwrap(), fs::read(path("three.csv")).unwrap());
    fs::write(
        path("four.csv.part"),
        "{\"stickslip_study\":1,\"fingerprint\":\"0123456789abcdef\",\"cases\":24}\n",
    )
    .unwrap();
    let four = run(folder.path(), &["study", "study.json", "-o", "four.csv"]);
    assert_eq!(four.status.code(), Some(2));
    assert!(stderr(&four).contains("four.csv.part holds cases of another study"), "{}", stderr(&four));
    assert!(!path("four.csv").exists());
    let four = run(folder.path(), &["study", "study.json", "-o", "four.csv", "--restart"]);
    assert_eq!(four.status.code(), Some(0), "{}", stderr(&four));
    assert_eq!(fs::read(path("one.csv")).unwrap(), fs::read(path("four.csv")).unwrap());
}

#[cfg(unix)]
#[test]
fn what_is_finished_when_it_is_stopped_is_kept() {
    let mut long = good();
    long["vary"]["/excitation/0/amplitude"]["points"] = json!(60);
    long["harmonics"] = json!([3]);
    let folder = folder(&long);
    let part = folder.path().join("out.csv.part");
    let mut child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .current_dir(folder.path())
        .args(["study", "study.json", "-o", "out.csv", "--threads", "1"])
        .spawn()
        .unwrap();
    // Two cases and the header, then Ctrl-C.
    let lines = || fs::read_to_string(&part).map_or(0, |text| text.lines().count());
    while lines() < 3 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let stopped = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let code = child.wait().unwrap().code();
    // A machine that was faster than the signal has finished.
    if stopped.success() && code == Some(130) {
        assert!(!folder.path().join("out.csv").exists() && lines() >= 3);
        let again = run(folder.path(), &["study", "study.json", "-o", "out.csv"]);
        assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
        assert!(stderr(&again).contains("of 180 cases are finished already"), "{}", stderr(&again));
    }
    let fresh = run(folder.path(), &["study", "study.json", "-o", "fresh.csv"]);
    assert_eq!(fresh.status.code(), Some(0), "{}", stderr(&fresh));
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("out.csv"), bytes("fresh.csv"));
}

#[test]
fn pictures_of_one_and_two_entries() {
    let folder = folder(&good());
    let two =
        run(folder.path(), &["study", "study.json", "-o", "out.csv", "--plot", "heat.svg", "--dof", "w2"]);
    assert_eq!(two.status.code(), Some(0), "{}", stderr(&two));
    assert!(stderr(&two).contains("the picture shows N = 3"), "{}", stderr(&two));
    let svg = fs::read_to_string(folder.path().join("heat.svg")).unwrap();
    assert!(svg.contains("peak of w2") && svg.contains("/model/stiffness/0/0"));
    let mut one = good();
    one["vary"].as_object_mut().unwrap().remove("/model/stiffness/0/0");
    fs::write(folder.path().join("one.json"), one.to_string()).unwrap();
    let arguments = [
        "study",
        "one.json",
        "-o",
        "one.csv",
        "--plot",
        "one.svg",
        "--quantity",
        "dissipation",
        "--dof",
        "w2",
    ];
    let output = run(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let svg = fs::read_to_string(folder.path().join("one.svg")).unwrap();
    assert!(svg.contains("N = 3") && svg.contains("dissipation at peak, w2"));
}

#[test]
fn what_cannot_be_studied() {
    let folder = folder(&study());
    fs::write(folder.path().join("good.json"), good().to_string()).unwrap();
    let refused = |arguments: &[&str], message: &str| {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(message), "{arguments:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
    };
    refused(
        &["study", "study.json", "-o", "out.csv"],
        "study.json: vary./contacts/0/law/symmetric: must not be empty",
    );
    refused(&["study", "missing.json"], "cannot read missing.json");
    for (pointer, message) in
        [("/harmonics", "write \"harmonics\": [1, 3, 7]"), ("/frequencies/from", "would change nothing")]
    {
        let mut study = good();
        study["vary"] = json!({ pointer: [1, 3] });
        fs::write(folder.path().join("idle.json"), study.to_string()).unwrap();
        refused(&["study", "idle.json"], &format!("idle.json: vary.{pointer}"));
        refused(&["study", "idle.json"], message);
    }
    refused(&["study", "good.json", "--restart"], "--output");
    refused(&["study", "good.json", "--quantity", "first"], "--plot");
    refused(
        &["study", "good.json", "--plot", "x.svg", "--dof", "w3"],
        "--dof: there is no output dof \"w3\"",
    );
    refused(&["study", "good.json", "-o", "good.json"], "named twice");
    refused(&["study", "good.json", "-o", "./two-mass.json", "--format", "json"], "named twice");
    refused(&["study", "good.json", "-o", "loops/reference.csv"], "named twice");
    refused(&["study", "good.json", "-o", "x.txt"], "no format is called .txt");
    assert!(!folder.path().join("out.csv.part").exists());
}

#[test]
fn parts_put_together_are_the_whole() {
    let folder = folder(&good());
    let at = |arguments: &[&str]| run(folder.path(), arguments);
    let whole = at(&["study", "study.json", "-o", "whole.csv"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    for i in 1..=3 {
        let shard = format!("{i}/3");
        let output = at(&["study", "study.json", "--shard", &shard, "-o", &format!("part{i}")]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    // In any order, with a part twice.
    let merged = at(&["merge", "study.json", "part3", "part1", "part2", "part1", "-o", "merged.csv"]);
    assert_eq!(merged.status.code(), Some(0), "{}", stderr(&merged));
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("merged.csv"), read("whole.csv"));
    // Once more it is there already, and stays as it is.
    let before = read("part2");
    let again = at(&["study", "study.json", "--shard", "2/3", "-o", "part2"]);
    assert_eq!(again.status.code(), Some(0));
    assert!(stderr(&again).contains("part 2/3 is finished already"), "{}", stderr(&again));
    assert_eq!(read("part2"), before);
    // A part that was stopped in the middle of a line goes on, and ends as the same file but for the order of its lines.
    let text = String::from_utf8(before).unwrap();
    let cut = text.lines().take(3).map(str::len).sum::<usize>() + 3 + 5;
    fs::remove_file(folder.path().join("part2")).unwrap();
    fs::write(folder.path().join("part2.part"), &text[..cut]).unwrap();
    let lacking = at(&["merge", "study.json", "part1", "part2.part", "part3"]);
    assert_eq!(lacking.status.code(), Some(1));
    assert!(stderr(&lacking).contains("6 of 24 cases are in none of the parts"), "{}", stderr(&lacking));
    assert!(lacking.stdout.is_empty());
    let goes_on = at(&["study", "study.json", "--shard", "2/3", "-o", "part2"]);
    assert!(stderr(&goes_on).contains("2 of 8 cases are finished already"), "{}", stderr(&goes_on));
    let merged = at(&["merge", "study.json", "part1", "part2", "part3", "-o", "again.csv"]);
    assert_eq!(merged.status.code(), Some(0), "{}", stderr(&merged));
    assert_eq!(read("again.csv"), read("whole.csv"));
}

#[test]
fn parts_of_another_study_are_refused() {
    let folder = folder(&good());
    let at = |arguments: &[&str]| run(folder.path(), arguments);
    assert!(at(&["study", "study.json", "--shard", "1/4", "-o", "part"]).status.success());
    let mut other = good();
    other["harmonics"] = json!([1, 5]);
    fs::write(folder.path().join("study.json"), other.to_string()).unwrap();
    for arguments in
        [&["merge", "study.json", "part"][..], &["study", "study.json", "--shard", "1/4", "-o", "part"]]
    {
        let output = at(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("part holds no cases of this study"), "{}", stderr(&output));
    }
    for (arguments, says) in [
        (&["study", "study.json", "--shard", "5/4", "-o", "x"][..], "second of eight"),
        (&["study", "study.json", "--shard", "1/4"], "--output"),
        (&["merge", "study.json"], "PART"),
    ] {
        let output = at(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(says), "{}", stderr(&output));
    }
}
