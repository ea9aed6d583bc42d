//! The scene library: every scene is read, has its fixed points, and is solved at each of them with seven harmonics.

use std::fs;
use std::path::Path;

use scene::{RunOptions, Scene};

#[test]
fn every_point_is_solved() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/library");
    let page = fs::read_to_string(folder.join("README.md")).unwrap();
    let (mut scenes, mut points) = (0, 0);
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        scenes += 1;
        let scene = Scene::from_file(&file).unwrap();
        assert_eq!(Some(scene.name()), file.file_stem().and_then(|stem| stem.to_str()));
        assert_eq!(scene.settings().harmonics, 7, "{}", scene.name());
        // Its page says how many points it has.
        let row = format!("| `{}` | {} |", scene.name(), scene.frequencies().as_slice().len());
        assert!(page.contains(&row), "{row}");
        let prepared = scene.prepare().unwrap();
        let solved = prepared.solve(&RunOptions::default());
        assert!((10..=24).contains(&solved.solutions().len()), "{}", scene.name());
        for solution in solved.solutions() {
            assert!(solution.status.solved(), "{}, {} Hz", scene.name(), solution.frequency);
            points += 1;
        }
    }
    assert_eq!((scenes, points), (13, 191));
}
