//! The binary from outside: results, exit codes, files that appear whole or not at all.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;

fn stickslip(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    stickslip(folder).args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
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

/// A result without its timing.
fn result(output: &Output) -> Value {
    let mut value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value.as_object_mut().unwrap().remove("timing").is_some());
    value
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn a_sweep_has_the_form_that_was_promised() {
    let folder = example("two-mass");
    let output = run(folder.path(), &["sweep", "two-mass.json", "--frequencies", "20:120:11"]);
    assert_eq!(output.status.code(), Some(0));
    let value: Value = serde_json::from_str(stdout(&output)).unwrap();
    assert_eq!(keys(&value), ["dofs", "format_version", "notes", "points", "scene", "timing", "units"]);
    assert_eq!((&value["format_version"], &value["units"]), (&json!(1), &json!("SI, Hz, rad")));
    assert_eq!((&value["scene"], &value["dofs"]), (&json!("two-mass"), &json!(["w1", "w2"])));
    assert_eq!(keys(&value["timing"]), ["setup_s", "solve_s", "threads"]);
    let points = value["points"].as_array().unwrap();
    assert_eq!(points.len(), 11);
    for (i, point) in points.iter().enumerate() {
        assert_eq!(point["frequency"], 20.0 + 10.0 * i as f64);
        let expected = [
            "contacts",
            "displacement",
            "frequency",
            "harmonics",
            "iterations",
            "residual",
            "sampling_error",
            "slaved",
            "solutions",
            "status",
            "truncation_error",
        ];
        assert_eq!(keys(point), expected);
        assert_eq!((&point["status"], &point["harmonics"]), (&json!("converged"), &json!(1)));
        assert_eq!((&point["solutions"], &point["truncation_error"]), (&json!(1), &Value::Null));
        assert!(point["residual"].as_f64().unwrap() < 1e-10);
        let contact = &point["contacts"]["root"];
        assert_eq!(
            keys(contact),
            ["amplitude", "displacement", "dissipation", "extrapolated", "force", "state", "turning_points"]
        );
        let w = point["displacement"]["w1"][0].as_array().unwrap();
        assert_eq!((w.len(), &w[0]), (3, &json!(1)));
        let amplitude = w[1].as_f64().unwrap().hypot(w[2].as_f64().unwrap());
        assert!((contact["amplitude"].as_f64().unwrap() / amplitude - 1.0).abs() < 1e-9);
        assert!(contact["dissipation"].as_f64().unwrap() > 0.0);
    }
    // One point is one line.
    assert_eq!(stdout(&output).lines().filter(|line| line.contains("\"frequency\"")).count(), 11);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = example("elastic-coulomb");
    let sweep = |threads: &str| {
        let arguments = [
            "sweep",
            "elastic-coulomb.json",
            "--harmonics",
            "7",
            "--frequencies",
            "40:120:101",
            "--threads",
            threads,
        ];
        result(&run(folder.path(), &arguments))
    };
    let one = sweep("1");
    assert_eq!(one["points"].as_array().unwrap().len(), 101);
    assert_eq!(one, sweep("2"));
    assert_eq!(one, sweep("7"));
}

#[test]
fn each_point_takes_the_harmonics_it_needs() {
    let folder = example("elastic-coulomb");
    let arguments = ["sweep", "elastic-coulomb.json", "--harmonics", "1e-3:63", "--frequencies", "44:116:13"];
    let value = result(&run(folder.path(), &arguments));
    let points = value["points"].as_array().unwrap();
    for point in points {
        let n = point["harmonics"].as_u64().unwrap();
        assert!(n == 63 || point["truncation_error"].as_f64().unwrap() <= 1e-3, "{point}");
        assert_eq!(point["sampling_error"], 0.0);
        // Spectra end where the point does.
        let spectra = [&point["displacement"]["w1"], &point["contacts"]["root"]["force"]];
        assert!(
            spectra.iter().all(|rows| rows.as_array().unwrap().last().unwrap()[0].as_u64() == Some(n)),
            "{point}"
        );
    }
    let needed = || points.iter().map(|point| point["harmonics"].as_u64().unwrap());
    assert!(needed().min() < needed().max(), "{:?}", needed().collect::<Vec<_>>());
}

#[test]
fn csv_is_long() {
    let folder = example("cubic");
    let arguments =
        ["sweep", "cubic.json", "--harmonics", "3", "--frequencies", "40:41:2", "--format", "csv"];
    let output = run(folder.path(), &arguments);
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines[0], "frequency,status,dof,harmonic,re,im");
    assert_eq!(lines.len(), 1 + 2 * 2 * 2);
    assert!(
        lines[1].starts_with("40,converged,w1,1,") && lines[2].starts_with("40,converged,w1,3,"),
        "{lines:?}"
    );
    // The numbers are those of the JSON, to the last bit.
    let json =
        result(&run(folder.path(), &["sweep", "cubic.json", "--harmonics", "3", "--frequencies", "40:41:2"]));
    let re: f64 = lines[1].split(',').nth(4).unwrap().parse().unwrap();
    assert_eq!(json["points"][0]["displacement"]["w1"][0][1].as_f64().unwrap(), re);
}

#[test]
fn the_format_follows_the_file_and_the_flag_wins() {
    let folder = example("cubic");
    let sweep = |rest: &[&str]| {
        let output =
            run(folder.path(), &[&["sweep", "cubic.json", "--frequencies", "40:41:2"], rest].concat());
        assert_eq!((output.status.code(), stdout(&output)), (Some(0), ""), "{}", stderr(&output));
    };
    let begins = |file: &str| fs::read_to_string(folder.path().join(file)).unwrap().chars().next().unwrap();
    sweep(&["-o", "a.csv"]);
    sweep(&["-o", "a.json"]);
    sweep(&["-o", "b.csv", "--format", "json"]);
    sweep(&["-o", "plain"]);
    assert_eq!(["a.csv", "a.json", "b.csv", "plain"].map(begins), ['f', '{', '{', '{']);
}

/// A free mass: its static response does not exist.
fn free_mass(frequencies: &Value) -> String {
    json!({
        "model": { "dofs": ["w"], "mass": [[1.0]], "damping": [[1.0]], "stiffness": [[0.0]] },
        "excitation": [{ "dof": "w", "amplitude": 1.0, "harmonic": 0 }, { "dof": "w", "amplitude": 1.0 }],
        "frequencies": frequencies
    })
    .to_string()
}

#[test]
fn a_point_without_solution_is_marked_and_has_no_numbers() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("free.json"), free_mass(&json!([0, 10]))).unwrap();
    let output = run(folder.path(), &["sweep", "free.json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let value = result(&output);
    let point = &value["points"][0];
    assert_eq!(point["status"], "failed");
    assert!(point["reason"].as_str().unwrap().contains("singular"), "{point}");
    assert!(point["residual_history"].is_array());
    assert!(point.get("displacement").is_none() && point.get("contacts").is_none(), "{point}");
    assert!(stderr(&output).contains("note: no solution was found at"), "{}", stderr(&output));
    let output = run(folder.path(), &["sweep", "free.json", "--format", "csv"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains("\n0,failed,,,,\n"), "{}", stdout(&output));
}

#[test]
fn output_that_cannot_be_written_is_known_before_the_work() {
    let folder = example("cubic");
    for file in ["missing/out.json", "."] {
        let output = run(folder.path(), &["sweep", "cubic.json", "-o", file, "--format", "json"]);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        assert!(stderr(&output).starts_with("error: cannot write "), "{}", stderr(&output));
    }
    let output = run(folder.path(), &["sweep", "cubic.json", "--at", "40", "--waveform", "missing/w.csv"]);
    assert_eq!((output.status.code(), stdout(&output)), (Some(3), ""));
    let files: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(files.len(), 1);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
    let folder = example("cubic");
    let output = run(folder.path(), &["sweep", "cubic.json", "-o", "/dev/full", "--format", "json"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(stderr(&output).contains("cannot write /dev/full"), "{}", stderr(&output));
}

#[cfg(unix)]
#[test]
fn a_link_to_a_result_stays_a_link_and_permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    let folder = example("cubic");
    let file = folder.path().join("real.csv");
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("real.csv", folder.path().join("link.csv")).unwrap();
    let output = run(folder.path(), &["sweep", "cubic.json", "--frequencies", "40:41:2", "-o", "link.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::symlink_metadata(folder.path().join("link.csv")).unwrap().is_symlink());
    assert!(fs::read_to_string(&file).unwrap().starts_with("frequency,"));
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let folder = example("elastic-coulomb");
    for arguments in [
        &["sweep", "elastic-coulomb.json"][..],
        &["sweep", "elastic-coulomb.json", "--format", "csv"],
        &["continue", "elastic-coulomb.json", "--format", "csv"],
        &["schema"],
        &["completions", "bash"],
        &["man"],
    ] {
        let mut child = stickslip(folder.path())
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), stderr(&output)), (Some(0), ""), "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_finished_points() {
    let folder = example("elastic-coulomb");
    let arguments = [
        "sweep",
        "elastic-coulomb.json",
        "--frequencies",
        "40:120:1000000",
        "--threads",
        "1",
        "-o",
        "out.json",
    ];
    let child = stickslip(folder.path()).args(arguments).stderr(Stdio::piped()).spawn().unwrap();
    // The file beside the output appears when the work begins.
    let begun = || fs::read_dir(folder.path()).unwrap().count() > 1;
    for _ in 0..1000 {
        if begun() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    std::thread::sleep(std::time::Duration::from_millis(500));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("finished points are kept"), "{}", stderr(&output));
    let text = fs::read_to_string(folder.path().join("out.json")).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let points = value["points"].as_array().unwrap();
    assert!(!points.is_empty() && points.len() < 1_000_000, "{}", points.len());
    let note = format!("stopped after {} of 1000000 points; the others are not in the result", points.len());
    assert!(value["notes"].as_array().unwrap().contains(&json!(note)), "{}", value["notes"]);
    assert_eq!(points[0]["frequency"], 40.0);
}

#[test]
fn one_period_in_time() {
    let folder = example("elastic-coulomb");
    let arguments = ["sweep", "elastic-coulomb.json", "--at", "62", "--waveform", "motion.csv"];
    let output = run(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(result(&output)["points"].as_array().unwrap().len(), 1);
    let text = fs::read_to_string(folder.path().join("motion.csv")).unwrap();
    let mut lines = text.lines();
    let header = "time [s],w1 [m],w2 [m],root relative displacement [m],root force [N]";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let step = rows[1][0];
    assert!((step * rows.len() as f64 * 62.0 - 1.0).abs() < 1e-12);
    let most = rows.iter().map(|row| row[4].abs()).fold(0.0, f64::max);
    assert!((most - 14.96556).abs() < 1e-6, "{most}");
    for row in rows {
        assert!((row[1] - row[3]).abs() < 1e-9 * most);
    }
}

#[test]
fn all_solutions_are_listed_when_asked_for() {
    let folder = example("cubic");
    let base = ["sweep", "cubic.json", "--harmonics", "1", "--frequencies", "43:43.5:501"];
    let plain = result(&run(folder.path(), &base));
    let all = result(&run(folder.path(), &[&base[..], &["--all-solutions"]].concat()));
    let several = |point: &&Value| point["solutions"].as_u64().unwrap() > 1;
    assert!(plain["points"].as_array().unwrap().iter().all(|point| point.get("others").is_none()));
    let points = all["points"].as_array().unwrap();
    assert!(points.iter().filter(several).count() > 3);
    for point in points {
        let others = point["others"].as_array().unwrap();
        assert_eq!(others.len() as u64 + 1, point["solutions"].as_u64().unwrap());
        let amplitude = |point: &Value| point["contacts"]["spring"]["amplitude"].as_f64().unwrap();
        assert!(others.iter().all(|other| amplitude(other) <= amplitude(point)));
    }
}

#[cfg(feature = "plot")]
#[test]
fn a_picture_is_drawn() {
    let folder = example("two-mass");
    let output = run(folder.path(), &["sweep", "two-mass.json", "-o", "out.json", "--plot", "out.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::read_to_string(folder.path().join("out.svg")).unwrap().contains("<svg"));
    let output = run(folder.path(), &["loop", "fit", "loops/reference.csv", "--plot", "loop.png"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::read(folder.path().join("loop.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn explain_says_what_is_needed_and_why() {
    let folder = example("two-mass");
    let text = run(folder.path(), &["explain", "two-mass.json"]);
    assert!(stdout(&text).starts_with("two-mass needs\n"), "{}", stdout(&text));
    let steps = |arguments: &[&str]| -> Vec<(String, bool)> {
        let output = run(folder.path(), arguments);
        let value: Value = serde_json::from_slice(&output.stdout).unwrap();
        let step = |step: &Value| {
            assert_eq!(keys(step), ["used", "what", "why"]);
            (step["what"].as_str().unwrap().to_owned(), step["used"].as_bool().unwrap())
        };
        value["steps"].as_array().unwrap().iter().map(step).collect()
    };
    let used =
        |steps: &[(String, bool)], what: &str| steps.iter().find(|(name, _)| name.contains(what)).unwrap().1;
    let one = steps(&["explain", "two-mass.json", "--format", "json"]);
    assert!(!used(&one, "FFT") && !used(&one, "Newton") && !used(&one, "even harmonics"));
    let seven = steps(&["explain", "two-mass.json", "--format", "json", "--harmonics", "7"]);
    assert!(used(&seven, "FFT") && used(&seven, "Newton") && used(&seven, "ladder"));
    assert!(!used(&seven, "continuation") && !used(&seven, "each point needs"));
    assert!(used(&seven, "truncation error") && !used(&one, "truncation error"));
    let needed = steps(&["explain", "two-mass.json", "--format", "json", "--harmonics", "1e-3:7"]);
    assert!(used(&needed, "each point needs") && used(&needed, "truncation error"));
}

#[test]
fn check_says_what_it_read() {
    let folder = example("two-mass");
    let output = run(folder.path(), &["check", "two-mass.json"]);
    assert_eq!(stdout(&output), "two-mass.json: 2 dofs, 1 contact, 741 frequencies, N = 1\n");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_loop_fit_has_the_form_that_was_promised() {
    let folder = example("two-mass");
    let output = run(folder.path(), &["loop", "fit", "loops/reference.csv"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let expected = [
        "cycles",
        "displacement_amplitude",
        "dissipation",
        "even_content",
        "force_amplitude",
        "harmonics",
        "noise",
        "notes",
        "period",
        "phase",
    ];
    assert_eq!(keys(&value), expected);
    let number = |key: &str| value[key].as_f64().unwrap();
    assert!((number("displacement_amplitude") / 8e-6 - 1.0).abs() < 1e-6);
    let first = value["harmonics"][0].as_array().unwrap();
    let (re, im) = (first[1].as_f64().unwrap(), first[2].as_f64().unwrap());
    assert_eq!(first[0], 1);
    assert!((re.hypot(im) / number("force_amplitude") - 1.0).abs() < 1e-12);
    assert!((im.atan2(re) - number("phase")).abs() < 1e-12);
    let work = std::f64::consts::PI * number("displacement_amplitude") * im;
    assert!((number("dissipation") / work - 1.0).abs() < 1e-12);

    let text = run(folder.path(), &["loop", "fit", "loops/reference.csv", "--format", "text"]);
    assert!(stdout(&text).starts_with("displacement amplitude  8.0"), "{}", stdout(&text));
}

#[test]
fn init_overwrites_nothing_unless_told_to() {
    let folder = example("two-mass");
    let scene = folder.path().join("two-mass.json");
    let original = fs::read_to_string(&scene).unwrap();
    // The same files again are no conflict.
    assert_eq!(run(folder.path(), &["init"]).status.code(), Some(0));
    fs::write(&scene, "mine").unwrap();
    fs::remove_file(folder.path().join("loops/reference.csv")).unwrap();
    let output = run(folder.path(), &["init"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("--force"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&scene).unwrap(), "mine");
    assert!(!folder.path().join("loops/reference.csv").exists());
    assert_eq!(run(folder.path(), &["init", "--force"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(&scene).unwrap(), original);
    assert!(folder.path().join("loops/reference.csv").exists());
}

#[test]
fn schema_completions_manual_and_help() {
    let folder = TempDir::new().unwrap();
    let text = |arguments: &[&str]| {
        let output = run(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?} {}", stderr(&output));
        stdout(&output).to_owned()
    };
    let schema: Value = serde_json::from_str(&text(&["schema"])).unwrap();
    assert_eq!(schema["title"], "stickslip scene");
    assert_eq!(text(&["schema"]), text(&["schema", "scene"]));
    let schema: Value = serde_json::from_str(&text(&["schema", "study"])).unwrap();
    assert_eq!(schema["title"], "stickslip study");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(text(&["completions", shell]).contains("sweep"), "{shell}");
    }
    assert!(text(&["man"]).contains("stickslip"));
    assert!(text(&["man", "sweep"]).contains("waveform"));
    assert!(text(&["man", "loop", "fit"]).contains("stickslip\\-loop\\-fit \\- Fit the Fourier series"));
    for wrong in [&["man", "lop"][..], &["man", "loop", "fat"], &["man", "loop", "fit", "record"]] {
        let output = run(folder.path(), wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&output).contains(&wrong[1..].join(" ")), "{}", stderr(&output));
    }
    assert!(text(&["--help"]).contains("Exit codes:"));
    assert!(text(&["sweep", "--help"]).contains("Examples:"));
    assert!(text(&["--version"]).starts_with("stickslip "));
    // Without a command help is shown, and it is an error.
    assert_eq!(run(folder.path(), &[]).status.code(), Some(2));
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = TempDir::new().unwrap();
    let output = run(folder.path(), &["man", "--all", "pages"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut names: Vec<String> = fs::read_dir(folder.path().join("pages"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    // What the help lists, and what is below it.
    let help = run(folder.path(), &["--help"]);
    let listed = stdout(&help).lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.is_empty()).filter(|line| !line.starts_with("   "));
    let mut expected = vec!["stickslip.1".to_owned()];
    expected.extend(["fit", "scale"].map(|name| format!("stickslip-loop-{name}.1")));
    let commands = listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    expected.extend(commands.map(|name| format!("stickslip-{name}.1")));
    expected.sort();
    assert_eq!(names, expected);
}

#[test]
fn every_example_is_that_of_the_scenes() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for template in ["two-mass", "elastic-coulomb", "cubic", "hoffmann-2017"] {
        let folder = example(template);
        let name = format!("{template}.json");
        assert_eq!(fs::read(folder.path().join(&name)).unwrap(), fs::read(scenes.join(&name)).unwrap());
        let output = run(folder.path(), &["check", &name]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let folder = example("hoffmann-2017");
    assert!(run(folder.path(), &["check", "hoffmann-2017-elastic-coulomb.json"]).status.success());
}

/// The answer of `continue` as JSON.
fn curve(folder: &Path, arguments: &[&str]) -> (Option<i32>, Value) {
    let output = run(folder, &[&["continue"], arguments, &["--format", "json"]].concat());
    (output.status.code(), serde_json::from_slice(&output.stdout).unwrap())
}

fn folds(curve: &Value) -> Vec<f64> {
    let points = curve["points"].as_array().unwrap().iter();
    points.filter(|point| point["fold"] == true).map(|point| point["parameter"].as_f64().unwrap()).collect()
}

#[test]
fn a_curve_has_the_form_that_was_promised() {
    let folder = example("cubic");
    let (code, value) = curve(folder.path(), &["cubic.json"]);
    assert_eq!(code, Some(0));
    let expected = [
        "dofs",
        "end",
        "format_version",
        "notes",
        "parameter",
        "points",
        "reason",
        "scene",
        "solve_s",
        "units",
    ];
    assert_eq!(keys(&value), expected);
    assert_eq!(
        (&value["parameter"], &value["end"], &value["reason"]),
        (&json!("frequency"), &json!("reached"), &json!(""))
    );
    let [up, down] = folds(&value)[..] else { panic!("{:?}", folds(&value)) };
    assert!((up - 43.2618).abs() < 1e-4 && (down - 43.2193).abs() < 1e-4, "{up} {down}");
    let points = value["points"].as_array().unwrap();
    for (before, after) in points.iter().zip(&points[1..]) {
        assert!(before["arclength"].as_f64() < after["arclength"].as_f64());
    }
    let ends = [&points[0], &points[points.len() - 1]].map(|point| point["parameter"].as_f64().unwrap());
    assert_eq!(ends, [38.0, 48.0]);
    for dof in ["w1", "w2"] {
        let peaks = points.iter().filter(|point| point["peaks"].as_array().unwrap().contains(&json!(dof)));
        let peaks: Vec<f64> = peaks.map(|point| point["frequency"].as_f64().unwrap()).collect();
        assert!(peaks.len() == 1 && (peaks[0] - 43.243).abs() < 1e-3, "{dof}: {peaks:?}");
    }
    // The same from the other end.
    let (_, back) = curve(folder.path(), &["cubic.json", "--from", "46", "--to", "41"]);
    let folds = folds(&back);
    assert!((folds[0] - down).abs() < 1e-6 && (folds[1] - up).abs() < 1e-6, "{folds:?}");
}

#[test]
fn a_curve_as_text_csv_and_picture() {
    let folder = example("cubic");
    let text = run(folder.path(), &["continue", "cubic.json", "--format", "text"]);
    for line in
        ["from 38 Hz to 48 Hz, N = 7\n", "\nfold at 43.2618", "\nfold at 43.2192", "\npeak of w2 at 43.24"]
    {
        assert!(stdout(&text).contains(line), "{}", stdout(&text));
    }
    let output = run(folder.path(), &["continue", "cubic.json", "-o", "curve.csv"]);
    assert_eq!((output.status.code(), stdout(&output)), (Some(0), ""));
    let table = fs::read_to_string(folder.path().join("curve.csv")).unwrap();
    assert!(table.starts_with("arclength,parameter,fold,dof,harmonic,re,im\n0e0,3.8e1,0,w1,1,"));
    // Four harmonics of two dofs at two folds.
    assert_eq!(table.lines().filter(|line| line.split(',').nth(2) == Some("1")).count(), 16);
    #[cfg(feature = "plot")]
    {
        let output = run(folder.path(), &["continue", "cubic.json", "-o", "c.json", "--plot", "c.svg"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(fs::read_to_string(folder.path().join("c.svg")).unwrap().contains("<svg"));
    }
}

#[test]
fn a_curve_along_an_entry() {
    let folder = example("cubic");
    let along = ["cubic.json", "--along", "/excitation/0/amplitude"];
    let (code, value) =
        curve(folder.path(), &[&along[..], &["--at", "43.5", "--from", "0.1", "--to", "20"]].concat());
    assert_eq!((code, &value["parameter"]), (Some(0), &json!("/excitation/0/amplitude")));
    let [up, down] = folds(&value)[..] else { panic!("{:?}", folds(&value)) };
    assert!((up - 6.3158).abs() < 1e-3 && (down - 3.9170).abs() < 1e-3, "{up} {down}");
    assert!(value["points"].as_array().unwrap().iter().all(|point| point["frequency"] == 43.5));
    // With one frequency in the scene that one is meant; without --from the entry's own value.
    let (code, value) =
        curve(folder.path(), &[&along[..], &["--frequencies", "43.5", "--to", "20"]].concat());
    assert_eq!((code, &value["points"][0]["parameter"]), (Some(0), &json!(3.0)));
}

#[test]
fn a_curve_that_makes_no_sense_is_refused() {
    let folder = example("cubic");
    let at = ["--at", "43.5"];
    for (arguments, named) in [
        (&["--along", "/excitation/0/amplitud", "--to", "20"][..], "did you mean \"amplitude\"?"),
        (&["--along", "excitation/0/amplitude", "--to", "20"], "is no JSON pointer"),
        (&["--along", "/name", "--to", "20"], "only numbers can be varied"),
        (&["--along", "/excitation/0/amplitude"], "name another value with --to"),
        (&["--along", "/excitation/0/amplitude", "--to", "inf"], "must be a finite number"),
        (
            &["--along", "/excitation/0/harmonic", "--to", "3"],
            "excitation[0].harmonic: must be a whole number",
        ),
        (&["--along", "/model/mass/0/0", "--to", "-1"], "model.mass"),
        (&["--along", "/harmonics", "--to", "31"], "name an entry of the model"),
        (&["--along", "/frequencies/from", "--to", "40"], "name an entry of the model"),
    ] {
        let output =
            run(folder.path(), &[&["continue", "cubic.json", "-o", "c.json"], arguments, &at].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(named), "{arguments:?}: {}", stderr(&output));
    }
    for (arguments, named) in [
        (&["--along", "/excitation/0/amplitude", "--to", "20"][..], "name one with --at"),
        (&["--at", "43"], "--along"),
        (&["--from", "0", "--to", "10"], "--from and --to"),
        (&["--from", "nan", "--to", "10"], "must be a finite number"),
        (&["--frequencies", "60"], "--from and --to"),
        (&["--plot", "c.pdf"], "name the file .svg or .png"),
    ] {
        let output = run(folder.path(), &[&["continue", "cubic.json", "-o", "c.json"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(named), "{arguments:?}: {}", stderr(&output));
    }
    assert!(!folder.path().join("c.json").exists());
}

#[test]
fn a_curve_that_cannot_begin_has_code_1_and_says_why() {
    let folder = example("two-mass");
    let arguments = [
        "two-mass.json",
        "--along",
        "/excitation/0/amplitude",
        "--at",
        "62",
        "--from",
        "1e-3",
        "--to",
        "0.5",
    ];
    let (code, value) = curve(folder.path(), &arguments);
    assert_eq!((code, &value["end"], &value["points"]), (Some(1), &json!("rest"), &json!([])));
    assert!(value["reason"].as_str().unwrap().contains("at rest"), "{value}");
    #[cfg(feature = "plot")]
    {
        let output = run(
            folder.path(),
            &[&["continue"], &arguments[..], &["--plot", "c.svg", "-o", "c.json"]].concat(),
        );
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(folder.path().join("c.json").exists() && !folder.path().join("c.svg").exists());
    }
    // Where the loop was not measured the curve says so, as a sweep does.
    let (_, value) = curve(folder.path(), &["two-mass.json", "--from", "100", "--to", "112"]);
    assert!(value["notes"][0].as_str().unwrap().contains("the law is extrapolated there"), "{value}");
}

#[test]
fn an_orbit_is_no_table() {
    let folder = example("cubic");
    let orbit = ["orbit", "cubic.json", "--frequency", "43"];
    let output = run(folder.path(), &[&orbit[..], &["-o", "orbit.csv"]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--waveform FILE.csv"), "{}", stderr(&output));
    let output = run(folder.path(), &[&orbit[..], &["-o", "orbit.txt", "--waveform", "orbit.csv"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(read("orbit.txt").starts_with("cubic at 43 Hz") && read("orbit.csv").starts_with("time [s],"));
}

#[test]
fn a_missing_folder_is_named() {
    let folder = example("cubic");
    let output = run(folder.path(), &["sweep", "cubic.json", "-o", "nowhere/out.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("there is no folder nowhere"), "{}", stderr(&output));
}
