//! Any text is a scene or an error with a place; a small scene can be prepared, explained and solved at a frequency.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use scene::{Frequencies, RunOptions, Scene};

/// Larger problems are solved elsewhere: here inputs are to be many.
const MOST_DOFS: usize = 6;
const MOST_HARMONICS: usize = 9;

fuzz_target!(|text: &str| {
    let scene = match Scene::from_str(text, Path::new("/nowhere")) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let small = scene.dofs().len() <= MOST_DOFS && scene.settings().harmonics <= MOST_HARMONICS;
    let few_samples = scene.settings().samples.unwrap_or(0) <= 1024;
    let Some(&hertz) = scene.frequencies().as_slice().first() else { return };
    if !(small && few_samples && scene.contacts().count() <= MOST_DOFS) {
        return;
    }
    let Ok(one) = Frequencies::one(hertz) else { return };
    let scene = scene.with_frequencies(one);
    let Ok(prepared) = scene.prepare() else { return };
    assert!(prepared.explain().iter().all(|step| !step.why.is_empty()));
    let outcome = prepared.solve(&RunOptions { threads: Some(1), ..RunOptions::default() }).outcome();
    for point in &outcome.points {
        // A number that is reported is a number.
        assert_eq!(point.displacement.is_some(), point.status != "failed");
        for (_, spectrum) in point.displacement.iter().flat_map(|named| &named.0) {
            assert!(spectrum.0.iter().all(|(_, w)| w.re.is_finite() && w.im.is_finite()));
        }
    }
});
