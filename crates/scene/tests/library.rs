//! The scene library: every scene is read, has its fixed points, and is solved at each of them with seven harmonics.

use std::fs;
use std::path::{Path, PathBuf};

use scene::{RunOptions, Scene};

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/library");
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    files
}

#[test]
fn every_point_is_solved() {
    let files = files();
    assert_eq!(files.len(), 13);
    let mut points = 0;
    for file in files {
        let scene = Scene::from_file(&file).unwrap();
        assert_eq!(Some(scene.name()), file.file_stem().and_then(|stem| stem.to_str()));
        assert_eq!(scene.settings().harmonics, 7, "{}", scene.name());
        let prepared = scene.prepare().unwrap();
        let solved = prepared.solve(&RunOptions::default());
        assert!((10..=24).contains(&solved.solutions().len()), "{}", scene.name());
        for solution in solved.solutions() {
            assert!(solution.status.solved(), "{}, {} Hz", scene.name(), solution.frequency);
            points += 1;
        }
    }
    assert_eq!(points, 191);
}

#[test]
fn its_page_names_every_scene_and_its_points() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/library");
    let page = fs::read_to_string(folder.join("README.md")).unwrap();
    for file in files() {
        let scene = Scene::from_file(&file).unwrap();
        let row = format!("| `{}` | {} |", scene.name(), scene.frequencies().as_slice().len());
        assert!(page.contains(&row), "{row}");
    }
}
