//! A real damper's measured loops as the contact law: record → fit → law → response.
//!
//! The records (ARTS-Laboratory, Dataset-Friction-Damper-with-Backlash, CC BY-SA 4.0) are not part of the project;
//! they are looked for in the folder `STICKSLIP_LOOPS`, or `../shared/loops` beside the workspace.

use std::path::PathBuf;
use std::sync::Arc;

use contact::{MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry};
use faer::mat;
use hbm::{Damping, Model, Plan, Problem, Settings, Status, SweepOptions, sweep};
use hysteresis::{FitSettings, ReadOptions, Record};
use stickslip_tests::{force, to_ground};

fn record(tension: &str) -> Option<PathBuf> {
    let folder = match std::env::var_os("STICKSLIP_LOOPS") {
        Some(folder) => PathBuf::from(folder),
        None => PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/loops")),
    };
    let path = folder.join(format!("arts-2_0.5Hz30lb-tension{tension}.csv"));
    if !path.exists() {
        eprintln!(
            "skipped: {} is not there; set STICKSLIP_LOOPS to the folder of the records",
            path.display()
        );
        return None;
    }
    Some(path)
}

/// A frame of two storeys' mass with the damper at its foot: resonances at 2.0 Hz and 4.5 Hz without it.
fn frame(path: &std::path::Path) -> Problem {
    let record = Record::read(path, &ReadOptions::default()).unwrap();
    let fit = hysteresis::fit(&record, &FitSettings::default()).unwrap();
    let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
    let law = ScaledLoop::new(&fit.hysteresis_loop, fit.noise, magnitude, phase, Symmetry::Auto).unwrap();
    assert_eq!(law.is_odd(), fit.even_content < fit.noise.max(0.02), "even content decides");
    Problem {
        joints: Vec::new(),
        model: Model::new(
            mat![[2000.0, 0.0], [0.0, 800.0]],
            Damping::ModalRatio(0.01),
            mat![[9e5, -4e5], [-4e5, 4e5]],
        )
        .unwrap(),
        excitation: vec![force(1, 8000.0)],
        contacts: vec![to_ground(Arc::new(law))],
        output: vec![0, 1],
    }
}

#[test]
fn the_response_with_a_real_damper() {
    // Backlash, chatter, even harmonics, 31 of them: from below the first resonance to beyond the second.
    let frequencies: Vec<f64> = (0..=120).map(|i| 2.0 + 0.05 * f64::from(i)).collect();
    for tension in ["0.5", "1", "1.5"] {
        let Some(path) = record(tension) else { return };
        let problem = frame(&path);
        for harmonics in [1, 7, 31] {
            let plan = Plan::new(&problem, &Settings::new(harmonics)).unwrap();
            let points = sweep(&plan, &frequencies, &SweepOptions::default()).solutions;
            for point in &points {
                assert_eq!(
                    point.status,
                    Status::Converged,
                    "{tension} in, N = {harmonics}, {} Hz",
                    point.frequency
                );
                assert!(point.residual < 1e-9);
                // Energy in equals energy out in every harmonic together: the contact never feeds the motion.
                assert!(point.contacts[0].dissipation > 0.0);
            }
        }
    }
}
