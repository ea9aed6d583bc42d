//! Studies: what is read, what is refused, and that a result depends on nothing but the study.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use serde_json::{Value, json};
use study::{Kind, Partial, Study, StudyError, StudyOptions, Table};
use tempfile::TempDir;

fn scene() -> Value {
    json!({
        "name": "blade",
        "model": { "dofs": ["w1", "w2"], "mass": [[3.98, 0], [0, 1.27]], "damping": [[24, 0], [0, 24]],
                   "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]] },
        "excitation": [{ "dof": "w2", "amplitude": 9.1 }],
        "contacts": [{ "name": "root", "between": ["w1", "ground"],
            "law": { "type": "elastic_coulomb", "stiffness": 6.705e6, "slip_force": 15 } }],
        "frequencies": { "from": 50, "to": 70, "points": 11 }
    })
}

fn study() -> Value {
    json!({
        "scene": "blade.json",
        "vary": { "/excitation/0/amplitude": { "from": 1, "to": 100, "points": 3, "spacing": "log" },
                  "/contacts/0/law/slip_force": [10, 15] },
        "harmonics": [1, 3],
        "keep": "peaks"
    })
}

fn folder(study: &Value) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("blade.json"), scene().to_string()).unwrap();
    fs::write(folder.path().join("study.json"), study.to_string()).unwrap();
    folder
}

fn read(folder: &Path) -> Result<Study, StudyError> {
    Study::from_file(&folder.join("study.json"))
}

fn with(pointer: &str, value: Value) -> Value {
    let mut study = study();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    study.pointer_mut(parent).unwrap().as_object_mut().unwrap().insert(key.into(), value);
    study
}

#[test]
fn cases_are_the_grid() {
    let folder = folder(&study());
    let study = read(folder.path()).unwrap();
    assert_eq!((study.name(), study.cases(), study.points()), ("study", 12, 11));
    assert_eq!(study.dofs(), ["w1", "w2"]);
    // The first entry (keys of these texts are sorted) is the slowest.
    let values: Vec<Vec<f64>> = (0..12).step_by(2).map(|i| study.case(i).values).collect();
    assert_eq!(
        values,
        [[10.0, 1.0], [10.0, 10.0], [10.0, 100.0], [15.0, 1.0], [15.0, 10.0], [15.0, 100.0]].map(Vec::from)
    );
    assert_eq!((0..4).map(|i| study.case(i).harmonics.to_string()).collect::<Vec<_>>(), ["1", "3", "1", "3"]);
    let scene = study.scene(11).unwrap();
    assert_eq!((scene.name(), scene.settings().harmonics), ("blade", 3));
    assert_eq!(scene.problem().unwrap().excitation[0].amplitude, 100.0);
}

#[test]
fn without_harmonics_the_scenes_own_are_used() {
    let mut study = study();
    study.as_object_mut().unwrap().remove("harmonics");
    study["vary"] = json!({});
    let folder = folder(&study);
    let study = read(folder.path()).unwrap();
    assert_eq!((study.cases(), study.case(0).harmonics.to_string()), (1, "1".to_owned()));
}

#[test]
fn mistakes_name_the_entry() {
    for (study, message) in [
        (with("/vary", json!([])), "vary: must be an object"),
        (with("/vary", json!({ "excitation": [1] })), "vary.excitation: is no JSON pointer"),
        (
            with("/vary", json!({ "/excitation/0/amplitud": [1] })),
            "vary./excitation/0/amplitud: \"/excitation/0\" has no entry \"amplitud\"; did you mean \"amplitude\"?",
        ),
        (with("/vary", json!({ "/excitations/0": [1] })), "vary./excitations/0: the scene has no entry"),
        (
            with("/vary", json!({ "/excitation/1/amplitude": [1] })),
            "vary./excitation/1/amplitude: \"/excitation\" is a list whose items are called 0 to 0, got \"1\"",
        ),
        (
            with("/vary", json!({ "/contacts/0/law": [1] })),
            "vary./contacts/0/law: is an object in the scene; only numbers can be varied",
        ),
        (
            with("/vary", json!({ "/name/0": [1] })),
            "vary./name/0: \"/name\" is the text \"blade\", there is nothing in it",
        ),
        (
            with("/vary", json!({ "/contacts/0/law/slip_force": [1, -1] })),
            "with /contacts/0/law/slip_force = -1, harmonics = 1: contacts[0].law.slip_force: must be",
        ),
        (
            with("/vary", json!({ "/excitation/0/amplitude": [] })),
            "vary./excitation/0/amplitude: must not be empty",
        ),
        (
            with("/vary", json!({ "/excitation/0/amplitude": 1 })),
            "vary./excitation/0/amplitude: must be a list",
        ),
        (
            with(
                "/vary",
                json!({ "/excitation/0/amplitude": { "from": 0, "to": 1, "points": 3, "spacing": "log" } }),
            ),
            "vary./excitation/0/amplitude.to: logarithmic spacing",
        ),
        (
            with("/vary", json!({ "/excitation/0/amplitude": { "from": 1, "to": 2, "points": 1 } })),
            "vary./excitation/0/amplitude.points: one point cannot",
        ),
        (
            with(
                "/vary",
                json!({ "/excitation/0/amplitude": { "from": 1, "to": 2, "points": 1000000 },
                                  "/contacts/0/law/slip_force": { "from": 1, "to": 2, "points": 1000 } }),
            ),
            "vary: makes 2000000000 cases with the harmonics, more than 10000000",
        ),
        (with("/keep", json!("all")), "keep: must be \"points\" or \"peaks\""),
        (with("/kep", json!("points")), "kep: unknown key; did you mean \"keep\"?"),
        (with("/harmonics", json!([1, 0])), "harmonics[1]: must be a whole number"),
        (with("/harmonics", json!([])), "harmonics: must not be empty"),
        (with("/output", json!(["w3"])), "output: there is no dof \"w3\" in model.dofs; did you mean"),
        (with("/scene", json!("missing.json")), "scene: cannot read "),
        (with("/frequencies", json!([-1])), "frequencies[0]: must not be negative"),
    ] {
        let folder = folder(&study);
        let error = read(folder.path()).unwrap_err().to_string();
        assert!(error.contains(message), "{error}\n{message}");
    }
    let points = with("/keep", json!("points"));
    let mut many = points.clone();
    many["frequencies"] = json!({ "from": 1, "to": 2, "points": 1000000 });
    let error = read(folder(&many).path()).unwrap_err().to_string();
    assert!(error.starts_with("keep: 12 cases with 1000000 points"), "{error}");
}

#[test]
fn threads_change_nothing_and_values_are_those_of_a_sweep() {
    let folder = folder(&with("/keep", json!("points")));
    let study = read(folder.path()).unwrap();
    let run = |threads| {
        study.run(Vec::new(), StudyOptions { threads: Some(threads), ..Default::default() }).unwrap()
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
    assert_eq!(one.len(), 12);
    for finished in [&one[0], &one[7]] {
        let scene = study.scene(finished.case).unwrap();
        let prepared = scene.prepare().unwrap();
        let solved = prepared.solve(&scene::RunOptions::default());
        let column = prepared.plan().orders().iter().position(|order| *order == 1).unwrap();
        for (solution, entries) in solved.solutions().iter().zip(finished.entries.chunks(2)) {
            for (row, entry) in solution.displacement.iter().zip(entries) {
                assert_eq!((entry.frequency, entry.kind), (solution.frequency, Kind::Converged));
                assert_eq!(entry.first, Some(row[column].norm()));
                assert_eq!(entry.dissipation, Some(solution.contacts[0].dissipation));
            }
        }
    }
}

#[test]
fn peaks_are_the_maxima_of_the_points() {
    let points_folder = folder(&with("/keep", json!("points")));
    let points = read(points_folder.path()).unwrap().run(Vec::new(), StudyOptions::default()).unwrap();
    let peaks_folder = folder(&study());
    let peaks = read(peaks_folder.path()).unwrap().run(Vec::new(), StudyOptions::default()).unwrap();
    for (points, peaks) in points.iter().zip(&peaks) {
        for dof in 0..2 {
            let largest =
                points.entries.iter().filter(|entry| entry.dof == dof).filter_map(|entry| entry.amplitude);
            let highest =
                peaks.entries.iter().find(|entry| entry.dof == dof && entry.kind == Kind::Highest).unwrap();
            assert_eq!(highest.amplitude, largest.reduce(f64::max));
            let locals = peaks.entries.iter().filter(|entry| entry.dof == dof && entry.kind == Kind::Local);
            assert!(locals.clone().all(|local| local.amplitude <= highest.amplitude));
        }
    }
}

#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    let folder = folder(&study());
    let study = read(folder.path()).unwrap();
    let output = folder.path().join("out.csv");
    let csv = |cases: &[study::FinishedCase]| {
        let mut text = Vec::new();
        Table { study: &study, cases }.write_csv(&mut text).unwrap();
        text
    };
    let whole = study.run(Vec::new(), StudyOptions::default()).unwrap();

    let (mut partial, known) = Partial::open(&study, &output, false).unwrap();
    assert!(known.is_empty());
    whole.iter().skip(3).take(5).for_each(|case| partial.keep(case).unwrap());
    let path = partial.path().to_owned();
    drop(partial);
    // Half a line at the end, as after a loss of power.
    let mut bytes = fs::read(&path).unwrap();
    bytes.truncate(bytes.len() - 10);
    fs::write(&path, &bytes).unwrap();

    let (mut partial, known) = Partial::open(&study, &output, false).unwrap();
    assert_eq!(known, whole[3..7]);
    let second = Partial::open(&study, &output, true).unwrap_err();
    assert!(matches!(second, StudyError::Busy { .. }), "{second}");
    let mut seen = Vec::new();
    let mut keeper = |case: &study::FinishedCase| {
        seen.push(case.case);
        partial.keep(case)
    };
    let options = StudyOptions { threads: Some(2), keeper: Some(&mut keeper), ..Default::default() };
    let resumed = study.run(known, options).unwrap();
    seen.sort();
    assert_eq!(seen, [0, 1, 2, 7, 8, 9, 10, 11]);
    assert_eq!(csv(&resumed), csv(&whole));
    drop(partial);
    let (partial, known) = Partial::open(&study, &output, false).unwrap();
    assert_eq!(known, whole);
    partial.remove();
    assert!(!path.exists());
}

#[test]
fn another_study_is_not_continued() {
    let folder = folder(&study());
    let output = folder.path().join("out.csv");
    let first = read(folder.path()).unwrap();
    let (mut partial, _) = Partial::open(&first, &output, false).unwrap();
    partial.keep(&first.run(Vec::new(), StudyOptions::default()).unwrap()[0]).unwrap();
    drop(partial);
    // The scene changes in a number that the study does not vary.
    let mut changed = scene();
    changed["model"]["damping"][0][0] = json!(25);
    fs::write(folder.path().join("blade.json"), changed.to_string()).unwrap();
    let second = read(folder.path()).unwrap();
    assert_ne!(first.fingerprint(), second.fingerprint());
    let error = Partial::open(&second, &output, false).unwrap_err().to_string();
    assert!(
        error.contains("out.csv.part holds cases of another study") && error.contains("--restart"),
        "{error}"
    );
    let (anew, known) = Partial::open(&second, &output, true).unwrap();
    assert!(known.is_empty());
    drop(anew);
    // A file that is no study's is never overwritten.
    fs::write(folder.path().join("out.csv.part"), "precious").unwrap();
    assert!(matches!(Partial::open(&second, &output, false), Err(StudyError::OtherStudy { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ranges_reach_both_ends(from in 0.1_f64..10.0, factor in 1.1_f64..100.0, points in 2_usize..40, log: bool) {
        let to = from * factor;
        let spacing = if log { "log" } else { "linear" };
        let range = json!({ "from": from, "to": to, "points": points, "spacing": spacing });
        let folder = folder(&with("/vary", json!({ "/excitation/0/amplitude": range })));
        let study = read(folder.path()).unwrap();
        let values = &study.axes()[0].values;
        prop_assert_eq!((values.len(), values[0], values[points - 1]), (points, from, to));
        prop_assert!(values.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC{0,200}", key in "[a-z/0-9]{0,30}", value in -1e9_f64..1e9) {
        let _ = Study::from_str(&text, Path::new("/nowhere"), "study");
        let folder = folder(&with("/vary", json!({ key: [value] })));
        let _ = read(folder.path());
    }
}
