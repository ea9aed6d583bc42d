//! Every kind of bad input: exit code 2, the entry in the message, nothing written.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

/// A small scene without mistakes.
fn good() -> Value {
    json!({
        "name": "good",
        "model": {
            "dofs": ["w1", "w2"],
            "mass": [[4.0, 0.0], [0.0, 1.27]],
            "damping": [[24.0, 0.0], [0.0, 24.0]],
            "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]
        },
        "excitation": [{ "dof": "w2", "harmonic": 1, "amplitude": 9.0, "phase": 0.0 }],
        "contacts": [{ "name": "root", "between": ["w1", "ground"],
            "law": { "type": "elastic_coulomb", "stiffness": 6.7e6, "slip_force": 15.0 } }],
        "frequencies": { "from": 40.0, "to": 60.0, "points": 3 },
        "harmonics": 3,
        "output": ["w1", "w2"],
        "solver": { "start": "ladder" }
    })
}

/// `good` with the value at a JSON pointer replaced; a new key is added.
fn with(pointer: &str, value: Value) -> String {
    let mut scene = good();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match scene.pointer_mut(parent).unwrap() {
        Value::Object(members) => {
            members.insert(key.into(), value);
        }
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        _ => panic!("{pointer}"),
    }
    scene.to_string()
}

/// `good` without one key.
fn without(pointer: &str) -> String {
    let mut scene = good();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    scene.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(key).unwrap();
    scene.to_string()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Runs `stickslip` in a folder and returns exit code, standard output and standard error.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let output = command.current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

const SWEEP: [&str; 6] = ["sweep", "scene.json", "-o", "out.json", "--plot", "out.svg"];

/// The scene is refused by every command that reads it, with these words, and nothing is written.
fn refused(scene: &str, words: &str) {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    for arguments in [&SWEEP[..], &["check", "scene.json"], &["explain", "scene.json"]] {
        let (code, stdout, stderr) = run(folder.path(), arguments);
        assert_eq!(code, 2, "{arguments:?}\n{scene}\n{stderr}");
        assert_eq!(stdout, "");
        assert!(stderr.starts_with("error: scene.json: "), "{stderr}");
        assert!(stderr.contains(words), "{scene}\nexpected: {words}\ngot: {stderr}");
        assert_eq!(files(folder.path()), ["scene.json"], "{words}");
    }
}

#[test]
fn the_good_scene_is_accepted() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.json"), good().to_string()).unwrap();
    let (code, _, stderr) = run(folder.path(), &["check", "scene.json"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
}

#[test]
fn text_that_is_no_scene() {
    refused("", "line 1, column 0: not valid JSON");
    refused("[]", "scene: must be an object");
    refused("{\"model\": {\"mass\": [[1.0,]]}}", "line 1, column 26 (in model.mass[0]");
    refused(&format!("{} garbage", good()), "something follows");
    refused(
        &good().to_string().replace("\"name\":\"good\"", "\"name\":\"a\",\"name\":\"b\""),
        "name: given twice",
    );
    refused(
        &good().to_string().replace("6700000.0", "1e999"),
        "contacts[0].law.stiffness: the number is too large",
    );
    refused(&good().to_string().replace("6700000.0", "NaN"), "(in contacts[0].law.stiffness)");
}

#[test]
fn unknown_and_missing_keys() {
    refused(&with("/contactss", json!([])), "contactss: unknown key; did you mean \"contacts\"?");
    refused(&with("/model/damp", json!(1)), "model.damp: unknown key");
    refused(&with("/excitation/0/amplitud", json!(1)), "excitation[0].amplitud: unknown key");
    refused(&with("/contacts/0/law/slipforce", json!(1)), "contacts[0].law.slipforce: unknown key");
    refused(&with("/frequencies/start", json!(1)), "frequencies.start: unknown key");
    refused(&with("/solver/method", json!("x")), "solver.method: unknown key");
    for pointer in [
        "/model",
        "/excitation",
        "/frequencies",
        "/model/dofs",
        "/model/mass",
        "/model/damping",
        "/model/stiffness",
        "/excitation/0/dof",
        "/excitation/0/amplitude",
        "/contacts/0/name",
        "/contacts/0/between",
        "/contacts/0/law",
        "/contacts/0/law/type",
        "/contacts/0/law/stiffness",
        "/contacts/0/law/slip_force",
        "/frequencies/from",
        "/frequencies/to",
    ] {
        let place = pointer[1..].replace("/0", "[0]").replace('/', ".");
        refused(&without(pointer), &format!("{place}: is missing"));
    }
    refused(&without("/frequencies/points"), "frequencies: needs \"points\"");
}

#[test]
fn matrices() {
    refused(&with("/model/mass", json!([[4.0, 0.0]])), "model.mass: must have 2 rows");
    refused(&with("/model/mass", json!([[4.0, 0.0], [1.0]])), "model.mass[1]: must have 2 numbers");
    refused(&with("/model/stiffness/0/1", json!("x")), "model.stiffness[0][1]: must be a number");
    refused(&with("/model/stiffness/0/1", json!(1.0)), "model.stiffness: must be symmetric");
    refused(&with("/model/mass/0/1", json!(0.5)), "model.mass: must be symmetric");
    refused(&with("/model/mass/0/0", json!(-4.0)), "model.mass: ");
    refused(
        &with("/model/damping", json!({"rayleigh": {"mass": 1.0}})),
        "model.damping.rayleigh.stiffness: is missing",
    );
    refused(
        &with("/model/damping", json!({"modal_ratio": -0.1})),
        "model.damping.modal_ratio: must not be negative",
    );
    refused(&with("/model/damping", json!({})), "model.damping: write one of");
    refused(&with("/model/dofs", json!(["w1", "w1"])), "model.dofs[1]: there is a dof \"w1\" already");
    refused(&with("/model/dofs", json!(["w1", "ground"])), "model.dofs[1]: \"ground\" is what does not move");
    refused(&with("/model/dofs", json!([])), "model.dofs: must not be empty");
}

#[test]
fn excitation() {
    refused(&with("/excitation/0/dof", json!("w3")), "excitation[0].dof: there is no dof \"w3\"");
    refused(&with("/excitation/0/harmonic", json!(4)), "excitation[0].harmonic: ");
    refused(&with("/excitation/0/harmonic", json!(-1)), "excitation[0].harmonic: must be a whole number");
    refused(&with("/excitation/0/harmonic", json!(1.5)), "excitation[0].harmonic: must be a whole number");
    refused(&with("/excitation/0/kind", json!("push")), "excitation[0].kind: must be \"force\" or \"base\"");
    refused(
        &with("/excitation/0/kind", json!("base")),
        "excitation[0].dof: a base acceleration acts on every dof",
    );
    refused(&with("/excitation/0/amplitude", json!(null)), "excitation[0].amplitude: must be a number");
    refused(&with("/excitation", json!({})), "excitation: must be a list");
}

#[test]
fn contacts() {
    refused(&with("/contacts/0/between", json!(["w1"])), "contacts[0].between: must be two dofs");
    refused(
        &with("/contacts/0/between", json!(["w1", "w1"])),
        "contacts[0].between[1]: a dof has no contact with itself",
    );
    refused(
        &with("/contacts/0/between", json!(["ground", "w1"])),
        "contacts[0].between[0]: put the dof first",
    );
    refused(
        &with("/contacts/0/between", json!(["w1", "w"])),
        "contacts[0].between[1]: there is no dof \"w\"",
    );
    refused(&with("/contacts/0/pairs", json!([["w1", "ground"]])), "contacts[0].pairs: is one too many");
    refused(&with("/contacts/0/scale", json!(0)), "contacts[0].scale: must be positive, got 0");
    refused(&with("/contacts/0/name", json!("")), "contacts[0].name: must be a name");
    let mut scene = good();
    let twin = scene["contacts"][0].clone();
    scene["contacts"].as_array_mut().unwrap().push(twin);
    refused(&scene.to_string(), "contacts[1].name: there is a contact \"root\" already");
}

#[test]
fn laws() {
    let law = |law: Value| with("/contacts/0/law", law);
    let scaled = |loop_: Value| law(json!({ "type": "scaled_loop", "loop": loop_ }));
    refused(
        &with("/contacts/0/law/slip_force", json!(-1)),
        "contacts[0].law.slip_force: must be positive, got -1",
    );
    refused(
        &with("/contacts/0/law/stiffness", json!(0)),
        "contacts[0].law.stiffness: must be positive, got 0",
    );
    refused(
        &law(json!({ "type": "linear", "stiffness": -1 })),
        "contacts[0].law.stiffness: must not be negative",
    );
    refused(&law(json!({ "type": "elastic_colomb" })), "did you mean \"elastic_coulomb\"?");
    refused(
        &law(json!({ "type": "magic" })),
        "contacts[0].law.type: there is no law \"magic\"; known are scaled_loop",
    );
    refused(&law(json!("linear")), "contacts[0].law: must be an object");
    refused(
        &law(json!({ "type": "coulomb", "slip_force": 10, "velocity": 0 })),
        "contacts[0].law.velocity: must be positive, got 0",
    );
    refused(&scaled(json!({ "displacement": 8e-6 })), "contacts[0].law.loop: needs \"force\"");
    refused(
        &scaled(json!({ "displacement": -1, "force": 1 })),
        "contacts[0].law.loop.displacement: must be positive",
    );
    refused(
        &scaled(json!({ "displacement": 1, "force": 0 })),
        "contacts[0].law.loop.force: must be positive",
    );
    refused(
        &scaled(json!({ "displacement": 1, "harmonics": [[1, 0]] })),
        "contacts[0].law.loop.harmonics[0]: must be",
    );
    refused(
        &scaled(json!({ "displacement": 1, "harmonics": [[1, 0, 1], [1, 0, 1]] })),
        "contacts[0].law.loop.harmonics[1][0]: harmonic 1 is given twice",
    );
    refused(
        &scaled(json!({ "displacement": 1, "harmonics": [[3, 0, 1]] })),
        "contacts[0].law.loop.harmonics: harmonic 1",
    );
    refused(
        &scaled(json!({ "displacement": 1, "harmonics": [[1, 1, -1]] })),
        "contacts[0].law.loop.harmonics: ",
    );
    refused(&scaled(json!({ "file": "missing.csv" })), "contacts[0].law.loop.file: cannot read ");
    refused(&scaled(json!({ "file": "scene.json" })), "contacts[0].law.loop.file: ");
    refused(&scaled(json!({ "file": "x.csv", "force": 1 })), "contacts[0].law.loop.force: is one too many");
    refused(
        &scaled(json!({ "displacement": 1, "force": 1, "units": {} })),
        "contacts[0].law.loop.units: belongs to a \"file\"",
    );
    refused(
        &scaled(json!({ "file": "x.csv", "units": { "force": "stone" } })),
        "contacts[0].law.loop.units.force: ",
    );
    refused(
        &scaled(json!({ "file": "x.csv", "columns": { "force": 0 } })),
        "contacts[0].law.loop.columns.force: ",
    );
    refused(&scaled(json!({ "file": "x.csv", "force_sign": 2 })), "contacts[0].law.loop.force_sign: ");
    let with_key = |key: &str, value: Value| {
        let mut scaled = json!({ "type": "scaled_loop", "loop": { "displacement": 8e-6, "force": 12 } });
        scaled[key] = value;
        law(scaled)
    };
    refused(
        &with_key("symmetric", json!("odd")),
        "contacts[0].law.symmetric: must be \"auto\", true or false",
    );
    refused(&with_key("magnitude", json!({ "offset": 0.5 })), "contacts[0].law.magnitude: ");
    refused(
        &with_key("magnitude", json!({ "shift": 0 })),
        "contacts[0].law.magnitude.shift: must be positive",
    );
    refused(&with_key("phase", json!({ "limit": 0.1 })), "contacts[0].law.phase: must stay in [-π, 0]");
    refused(&with_key("phase", json!({ "decay": -1 })), "contacts[0].law.phase.decay: must be positive");
    refused(&with_key("phase", json!({ "end": 1 })), "contacts[0].law.phase.end: unknown key");
}

#[test]
fn frequencies_harmonics_output_solver() {
    refused(&with("/frequencies/from", json!(0)), "frequencies.from: must be positive, got 0");
    refused(&with("/frequencies/points", json!(1e12)), "frequencies.points: must be a whole number");
    refused(&with("/frequencies/step", json!(1)), "frequencies.step: is one too many");
    refused(&with("/frequencies", json!([1, -1])), "frequencies[1]: must not be negative");
    refused(
        &with("/frequencies", json!({ "from": 1, "to": 2, "step": 1e-12 })),
        "frequencies.step: makes more than",
    );
    refused(&with("/harmonics", json!(0)), "harmonics: must be a whole number");
    refused(&with("/harmonics", json!(1e9)), "harmonics: must be a whole number");
    refused(&with("/harmonics", json!("7")), "harmonics: must be a number");
    refused(&with("/output", json!(["w3"])), "output[0]: there is no dof \"w3\"");
    refused(&with("/output", json!(["w1", "w1"])), "output[1]: is in the list already");
    refused(&with("/output", json!([])), "output: must not be empty");
    refused(&with("/solver/start", json!("guess")), "solver.start: must be \"ladder\" or \"march\"");
    refused(&with("/solver/jacobian", json!(1)), "solver.jacobian: must be");
    refused(&with("/solver/samples", json!(-4)), "solver.samples: must be a whole number");
    refused(&with("/solver/estimate", json!("yes")), "solver.estimate: must be true or false");
    refused(
        &with("/harmonics", json!({ "tolerance": 0, "max": 63 })),
        "harmonics.tolerance: must be positive",
    );
    refused(
        &with("/harmonics", json!({ "tolerance": 2, "max": 63 })),
        "harmonics.tolerance: is a relative error",
    );
    refused(
        &with("/harmonics", json!({ "tolerance": 1e-6, "max": 0 })),
        "harmonics.max: must be a whole number",
    );
    refused(&with("/harmonics", json!({ "tolerance": 1e-6 })), "harmonics.max: is missing");
    refused(&with("/harmonics", json!({ "tol": 1e-6, "max": 63 })), "harmonics.tol: unknown key");
}

#[test]
fn files_of_matrices_and_names() {
    refused(
        &with("/model/mass", json!({ "matrix_market": "M.mtx" })),
        "model.mass.matrix_market: M.mtx: cannot be read",
    );
    refused(&with("/model/damping", json!({ "npy": "D.npy" })), "model.damping.npy: D.npy: cannot be read");
    refused(&with("/model/mass", json!({ "npz": "." })), "model.mass.npz: .: ");
    refused(
        &with("/model/mass", json!({ "matrix_market": "scene.json" })),
        "model.mass.matrix_market: scene.json: line 1: ",
    );
    refused(&with("/model/mass", json!({ "npy": "scene.json" })), "does not begin with");
    refused(&with("/model/mass", json!({ "npz": "scene.json" })), "no .npz archive");
    refused(&with("/model/mass", json!({ "npz": "M.npz", "name": "M" })), "model.mass.name: unknown key");
    refused(&with("/model/mass", json!({ "csv": "M.csv" })), "model.mass.csv: unknown key");
    refused(&with("/model/dofs", json!({ "file": "names.txt" })), "model.dofs.file: cannot read names.txt");
    refused(
        &with("/model/dofs", json!({ "file": "." })),
        "model.dofs.file: cannot read .: it is no file of names",
    );
    refused(&with("/model/dofs", json!("names.txt")), "model.dofs: must be names, one a dof: a list, or ");
    refused(&with("/model/fixed", json!(["w3"])), "model.fixed[0]: there is no dof \"w3\" in model.dofs");
    refused(&with("/model/fixed", json!(["x*"])), "model.fixed[0]: no dof in model.dofs fits \"x*\"");
    refused(&with("/model/fixed", json!("*")), "model.fixed: holds every dof");
    refused(&with("/model/fixed", json!(["w2"])), "excitation[0].dof: dof \"w2\" is held by model.fixed");
    refused(&with("/model/fixed", json!(7)), "model.fixed: must be names of held dofs and patterns");
    refused(&with("/model/reduction", json!("guyan")), "model.reduction: must be \"auto\", \"none\"");
    refused(
        &with("/model/reduction", json!({ "modes": -1 })),
        "model.reduction.modes: must be a whole number",
    );
    refused(
        &with("/model/reduction", json!({ "tolerance": 1 })),
        "model.reduction.tolerance: is a relative error",
    );
    refused(&with("/model/reduction", json!({})), "model.reduction: write one of");
    refused(
        &with("/excitation/0/direction", json!("x")),
        "excitation[0].direction: belongs to a base acceleration",
    );
    refused(
        &with("/excitation/0", json!({ "kind": "base", "amplitude": 1, "direction": "x" })),
        "excitation[0].direction: no dof has a name that ends in \":x\"",
    );
}

/// The scene with its matrices in files is refused by `check` with these words.
fn refused_with(change: impl Fn(&mut Value), files: &[(&str, &str)], words: &str) {
    let folder = TempDir::new().unwrap();
    let mut scene = good();
    scene["model"]["mass"] = json!({ "matrix_market": "M.mtx" });
    scene["model"]["stiffness"] = json!({ "matrix_market": "K.mtx" });
    change(&mut scene);
    let real = "%%MatrixMarket matrix coordinate real symmetric\n";
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("scene.json", &scene.to_string());
    write("M.mtx", &format!("{real}2 2 2\n1 1 4\n2 2 1.27\n"));
    write("K.mtx", &format!("{real}2 2 3\n1 1 8.2e5\n2 1 -4.1e5\n2 2 4.1e5\n"));
    for (name, text) in files {
        write(name, &text.replace("REAL\n", real));
    }
    let (code, _, stderr) = run(folder.path(), &["check", "scene.json"]);
    if words.is_empty() {
        assert_eq!((code, stderr.as_str()), (0, ""));
        return;
    }
    assert_eq!(code, 2, "{words}: {stderr}");
    assert!(
        stderr.starts_with("error: scene.json: ") && stderr.contains(words),
        "expected: {words}\ngot: {stderr}"
    );
}

#[test]
fn what_is_wrong_in_a_file_is_told_with_its_line_or_entry() {
    let same = |_: &mut Value| ();
    refused_with(same, &[], "");
    refused_with(
        same,
        &[("M.mtx", "REAL\n2 2 2\n1 1 4\n2 2 x\n")],
        "model.mass.matrix_market: M.mtx: line 4: \"x\" is no number",
    );
    refused_with(same, &[("M.mtx", "REAL\n3 3 1\n1 1 4\n")], "M.mtx is 3 x 3, but model.dofs has 2 names");
    refused_with(
        |scene| drop(scene["model"].as_object_mut().unwrap().remove("dofs")),
        &[("K.mtx", "REAL\n3 3 1\n1 1 4\n")],
        "K.mtx is 3 x 3, but model.dofs has 2 names",
    );
    refused_with(same, &[("M.mtx", "REAL\n2 2 0\n")], "model.mass: is zero");
    refused_with(
        same,
        &[("M.mtx", "REAL\n2 2 2\n1 1 4\n2 2 -1\n")],
        "model.mass: must be positive semidefinite, but row 2",
    );
    refused_with(
        same,
        &[("M.mtx", "REAL\n2 2 3\n1 1 1\n2 1 2\n2 2 1\n")],
        "model.mass: must be positive semidefinite, but has",
    );
    refused_with(
        same,
        &[("K.mtx", "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n")],
        "model.stiffness: must be symmetric, but row 2, column 1 is 2",
    );
    refused_with(
        same,
        &[("K.mtx", "REAL\n2 2 999999999999\n1 1 1\n")],
        "model.stiffness.matrix_market: K.mtx: line 2: promises 999999999999 entries",
    );
    let names = |scene: &mut Value| scene["model"]["dofs"] = json!({ "file": "names.txt" });
    refused_with(names, &[("names.txt", "w1\nw2\n")], "");
    refused_with(
        names,
        &[("names.txt", "# node, direction\n1 x\n1 x\n")],
        "model.dofs.file: line 3: there is a dof \"1:x\" already",
    );
    refused_with(
        names,
        &[("names.txt", "1 x 3\n")],
        "model.dofs.file: names.txt, line 1: must be a name, or node and direction",
    );
    refused_with(names, &[("names.txt", "\n")], "model.dofs.file: names.txt has no names in it");
    refused_with(names, &[("names.txt", "w1\n")], "M.mtx is 2 x 2, but model.dofs has 1 names");
    let fixed = |scene: &mut Value| scene["model"]["fixed"] = json!({ "file": "fixed.txt" });
    refused_with(fixed, &[("fixed.txt", "w3\n")], "model.fixed.file: line 1: there is no dof \"w3\"");
}

/// Arguments are refused with these words, and nothing is written.
fn refused_arguments(arguments: &[&str], words: &str) {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.json"), good().to_string()).unwrap();
    fs::write(folder.path().join("record.csv"), "displacement,force\n1,2\n").unwrap();
    let (code, stdout, stderr) = run(folder.path(), arguments);
    assert_eq!(code, 2, "{arguments:?} {stderr}");
    assert_eq!(stdout, "", "{arguments:?}");
    assert!(stderr.contains(words), "{arguments:?}\nexpected: {words}\ngot: {stderr}");
    assert_eq!(files(folder.path()), ["record.csv", "scene.json"]);
}

#[test]
fn arguments() {
    refused_arguments(&["sweep", "missing.json"], "cannot read missing.json");
    refused_arguments(&["check", "."], "cannot read .");
    refused_arguments(&["sweep"], "<SCENE>");
    refused_arguments(&["swep", "scene.json"], "'sweep'");
    refused_arguments(
        &["sweep", "scene.json", "--harmonics", "0"],
        "--harmonics: must be a whole number from 1",
    );
    refused_arguments(&["sweep", "scene.json", "--harmonics", "x"], "--harmonics");
    refused_arguments(&["sweep", "scene.json", "--harmonics", "1e-6:"], "TOLERANCE:MAX");
    refused_arguments(&["sweep", "scene.json", "--harmonics", "2:63"], "--harmonics: the tolerance is");
    refused_arguments(&["sweep", "scene.json", "--frequencies", "1:2"], "FROM:TO:POINTS");
    refused_arguments(&["sweep", "scene.json", "--frequencies", "0:2:3"], "no positive frequency");
    refused_arguments(&["sweep", "scene.json", "--frequencies", "1:2:3:cubic"], "FROM:TO:POINTS");
    refused_arguments(&["sweep", "scene.json", "--threads", "0"], "--threads");
    refused_arguments(
        &["sweep", "scene.json", "--format", "xml"],
        "[possible values: json, csv, npz, parquet]",
    );
    refused_arguments(&["sweep", "scene.json", "-o", "out.xlsx"], "no format is called .xlsx");
    refused_arguments(&["sweep", "scene.json", "-o", "./scene.json"], "./scene.json is named twice");
    refused_arguments(
        &["sweep", "scene.json", "-o", "x.csv", "--at", "5", "--waveform", "x.csv"],
        "x.csv is named twice",
    );
    refused_arguments(&["sweep", "scene.json", "--at", "50"], "--waveform");
    refused_arguments(&["sweep", "scene.json", "--waveform", "w.csv"], "--at");
    refused_arguments(
        &["sweep", "scene.json", "--at", "0", "--waveform", "w.csv"],
        "--at: at 0 Hz nothing moves",
    );
    refused_arguments(
        &["sweep", "scene.json", "--at", "-5", "--waveform", "w.csv"],
        "--at: a frequency must be",
    );
    refused_arguments(
        &["sweep", "scene.json", "--at", "nan", "--waveform", "w.csv"],
        "--at: a frequency must be",
    );
    refused_arguments(
        &["sweep", "scene.json", "--at", "5", "--waveform", "w.csv", "--frequencies", "1:2:3"],
        "--frequencies",
    );
    refused_arguments(&["sweep", "scene.json", "--plot", "out.pdf"], "--plot");
    refused_arguments(&["explain", "scene.json", "--format", "csv"], "[possible values: text, json]");
    refused_arguments(&["init", "three-mass"], "two-mass");
    refused_arguments(&["completions", "cmd"], "[possible values: bash");
    refused_arguments(&["man", "walk"], "there is no command \"walk\"");
    refused_arguments(&["loop", "fit", "missing.csv"], "cannot read missing.csv");
    refused_arguments(&["loop", "fit", "record.csv"], "has no unit");
    refused_arguments(&["loop", "fit", "record.csv", "--units", "displacement=um,force=N"], "record.csv: ");
    refused_arguments(&["loop", "fit", "record.csv", "--units", "force=stone"], "stone");
    refused_arguments(&["loop", "fit", "record.csv", "--columns", "farce=1"], "farce");
}

#[test]
fn bytes_that_are_no_text() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.json"), b"\xff\xfe{}").unwrap();
    let (code, _, stderr) = run(folder.path(), &["check", "scene.json"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("cannot read scene.json: ") && stderr.contains("UTF-8"), "{stderr}");
}

#[test]
fn overrides_are_checked_like_the_scene() {
    let mut scene = good();
    scene["excitation"][0]["harmonic"] = json!(3);
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let (code, _, stderr) =
        run(folder.path(), &["sweep", "scene.json", "--harmonics", "1", "-o", "out.json"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("excitation[0].harmonic"), "{stderr}");
    assert_eq!(files(folder.path()), ["scene.json"]);
}

#[test]
fn a_force_against_the_motion_suggests_the_flag() {
    let folder = TempDir::new().unwrap();
    let mut record = String::from("displacement [um],force [N]\n");
    for j in 0..=300 {
        let theta = std::f64::consts::TAU * f64::from(j) / 100.0;
        record += &format!("{},{}\n", 8.0 * theta.cos(), 12.0 * theta.sin());
    }
    fs::write(folder.path().join("record.csv"), &record).unwrap();
    let (code, _, stderr) = run(folder.path(), &["loop", "fit", "record.csv"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("--flip-force"), "{stderr}");
    let (code, stdout, _) = run(folder.path(), &["loop", "fit", "record.csv", "--flip-force"]);
    assert_eq!(code, 0);
    assert!(stdout.contains("\"dissipation\": 0.0003"), "{stdout}");
    fs::write(
        folder.path().join("record.csv"),
        record
            .replace("force [N]", "force [kN]")
            .replace(",", ",-")
            .replace(",-force", ",force")
            .replace("--", ""),
    )
    .unwrap();
    let (code, _, stderr) = run(folder.path(), &["loop", "fit", "record.csv", "--flip-force"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("leave --flip-force out"), "{stderr}");
}
