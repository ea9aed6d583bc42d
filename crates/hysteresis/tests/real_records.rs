//! Records of a real rotary friction damper: run-up, backlash, chatter, asymmetry, US units.
//!
//! Their licence keeps them out of this tree. The folder is named by `STICKSLIP_LOOPS`, or lies beside the
//! workspace as `../shared/loops`; without it these tests say so and pass.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use hysteresis::{Fit, FitSettings, Note, ReadOptions, Record, fit};

/// The records by nominal amplitude [m], or none with a message.
fn records() -> Option<Vec<(f64, PathBuf)>> {
    let folder = std::env::var_os("STICKSLIP_LOOPS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/loops"), PathBuf::from);
    if !folder.is_dir() {
        eprintln!("SKIPPED: no real records in {}; set STICKSLIP_LOOPS to their folder", folder.display());
        return None;
    }
    let named = |inches: &str| folder.join(format!("arts-2_0.5Hz30lb-tension{inches}.csv"));
    Some(vec![(0.0127, named("0.5")), (0.0254, named("1")), (0.0381, named("1.5"))])
}

fn fitted(path: &Path) -> (Record, Fit) {
    let record = Record::read(path, &ReadOptions::default()).unwrap();
    let found = fit(&record, &FitSettings::default()).unwrap();
    (record, found)
}

/// `∮ f dw` from one upward passage of the middle to the next, by trapezoids, straight from the columns of
/// the file.
fn areas(path: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap();
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            (cells[1] * 0.0254, cells[2] * 4_448.221_615_260_5)
        })
        .collect();
    // The steady part lies between 4 s and 10 s at 1024 samples a second, one cycle 2048 samples.
    (0..3)
        .map(|cycle| {
            let start = 4096 + 2048 * cycle;
            let (mut area, part) = (0.0, &rows[start..=start + 2048]);
            for pair in part.windows(2) {
                area += 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0);
            }
            area
        })
        .collect()
}

#[test]
fn amplitude_cycles_and_period_are_those_of_the_test_plan() {
    for (nominal, path) in records().into_iter().flatten() {
        let (_, found) = fitted(&path);
        let amplitude = found.hysteresis_loop.displacement_amplitude();
        assert!((amplitude / nominal - 1.0).abs() < 0.015, "{nominal}: {amplitude}");
        assert_eq!(found.cycles, 3);
        assert!((found.period.unwrap() - 2.0).abs() < 0.01, "{:?}", found.period);
        let upper = found.turning_points.iter().filter(|p| p.upper).count();
        assert_eq!((upper, found.turning_points.len()), (3, 6));
    }
}

#[test]
fn dissipation_is_the_area_of_the_steady_cycles() {
    for (nominal, path) in records().into_iter().flatten() {
        let (_, found) = fitted(&path);
        let series = found.hysteresis_loop.dissipation();
        // Every cycle for itself, which chatters its own way; then their mean.
        let areas = areas(&path);
        for area in &areas {
            assert!((series / area - 1.0).abs() < 0.03, "{nominal}: {series} {area}");
        }
        let mean = areas.iter().sum::<f64>() / 3.0;
        assert!((series / mean - 1.0).abs() < 0.01, "{nominal}: {series} {mean}");
        assert!(
            (series / found.direct_dissipation - 1.0).abs() < 0.002,
            "{series} {}",
            found.direct_dissipation
        );
    }
}

#[test]
fn what_the_eye_sees_in_the_records_is_said() {
    for (nominal, path) in records().into_iter().flatten() {
        let (_, found) = fitted(&path);
        let says =
            |kind: fn(&Note) -> bool| assert!(found.notes.iter().any(kind), "{nominal}: {:?}", found.notes);
        says(|note| matches!(note, Note::RunUpRunDown { before, after } if *before > 2 && *after > 2));
        says(|note| matches!(note, Note::Asymmetric { .. }));
        says(|note| matches!(note, Note::Chatter { .. }));
        // The same damper has the same clearance in every record.
        says(|note| matches!(note, Note::Backlash { width } if (2e-3..4.5e-3).contains(width)));
        assert!((0.005..0.06).contains(&found.noise), "{}", found.noise);
        assert!((0.02..0.1).contains(&found.even_content), "{}", found.even_content);
        assert!(!found.is_symmetric());
    }
}

#[test]
fn cutting_a_record_to_its_steady_part_changes_little() {
    for (nominal, path) in records().into_iter().flatten() {
        let (record, whole) = fitted(&path);
        let range = whole.steady_samples.clone();
        let cut = Record::new(
            record.time.map(|t| t[range.clone()].to_vec()),
            record.displacement[range.clone()].to_vec(),
            record.force[range].to_vec(),
        )
        .unwrap();
        let part = fit(&cut, &FitSettings::default()).unwrap();
        let off = (part.hysteresis_loop.coefficients()[1] - whole.hysteresis_loop.coefficients()[1]).norm();
        assert!(off < 3.0 * whole.noise * whole.hysteresis_loop.force_amplitude(), "{nominal}: {off}");
        assert!(!part.notes.iter().any(|note| matches!(note, Note::RunUpRunDown { .. })));
    }
}

#[test]
fn the_reaction_instead_of_the_rigs_force_is_refused_and_its_sign_can_be_turned() {
    for (_, path) in records().into_iter().flatten() {
        let options: ReadOptions = serde_json::from_str(r#"{"force_sign": -1}"#).unwrap();
        let turned = Record::read(&path, &options).unwrap();
        let error = fit(&turned, &FitSettings::default()).unwrap_err();
        assert!(error.to_string().contains("--flip-force"), "{error}");
    }
}
