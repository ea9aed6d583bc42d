//! Any text is a study of a scene or an error with a place; every case of a study is a scene or an error.

#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use study::Study;

/// A folder with `x.json`, the scene that studies vary.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("stickslip-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        std::fs::write(folder.join("x.json"), include_str!("../corpus/scene/elastic-coulomb.json"))
            .expect("a file in it");
        folder
    })
}

fuzz_target!(|text: &str| {
    match Study::from_str(text, folder(), "fuzz") {
        Ok(study) => {
            for index in 0..study.cases().min(3) {
                if let Err(error) = study.scene(index) {
                    assert!(!error.to_string().is_empty());
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
