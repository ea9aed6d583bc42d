//! The laws `iwan` and `loop_family` in scenes: their forms, what they become, and the path of every refusal.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use contact::{Law, MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry};
use hysteresis::Loop;
use num_complex::Complex64;
use scene::{Scene, SceneError};
use serde_json::{Value, json};

fn read(law: Value) -> Result<Scene, SceneError> {
    let scene = json!({
        "model": { "dofs": ["w"], "mass": [[1.0]], "damping": [[1.0]], "stiffness": [[1e5]] },
        "excitation": [{ "dof": "w", "amplitude": 1.0 }],
        "contacts": [{ "name": "root", "between": ["w", "ground"], "law": law }],
        "frequencies": [50.0]
    });
    Scene::from_str(&scene.to_string(), Path::new("."))
}

fn first_harmonic(scene: &Scene, a: f64) -> Complex64 {
    scene.problem().unwrap().contacts[0].law.describing_function().unwrap().first_harmonic(a).force
}

fn refused(law: Value, message: &str) {
    let error = read(law.clone()).unwrap_err().to_string();
    assert!(error.starts_with(message), "{law}: {error}");
}

#[test]
fn an_iwan_law_from_the_magnitude_law_or_a_backbone() {
    // C = 0.21 F*, b = 0.01 W*: Re F_1 = 4 C (√(1+r) − 1)/(√(1+r) + 1), r = a/b.
    let closed = read(json!({ "type": "iwan", "displacement": 8e-6, "force": 12.0 })).unwrap();
    let root = 101.0_f64.sqrt();
    let expected = 4.0 * 0.21 * 12.0 * (root - 1.0) / (root + 1.0);
    assert!((first_harmonic(&closed, 8e-6).re - expected).abs() < 1e-13);
    let many = json!({ "type": "iwan", "displacement": 8e-6, "force": 12.0, "sliders": 200 });
    let difference = first_harmonic(&read(many).unwrap(), 8e-6) - first_harmonic(&closed, 8e-6);
    assert!(difference.norm() > 1e-6 && difference.norm() < 2e-3, "{difference}");
    // Full slip of one element: the rectangle's 4 F_s/π (1 − x_c/a).
    let slip = read(json!({ "type": "iwan", "backbone": [[1e-6, 2.0], [2e-6, 2.0]] })).unwrap();
    let damping = first_harmonic(&slip, 5e-6).im;
    assert!((damping - 8.0 / std::f64::consts::PI * 0.8).abs() < 1e-14, "{damping}");
    assert!(!slip.problem().unwrap().contacts[0].law.nature().determines_mean);
}

#[test]
fn a_family_meets_its_loops() {
    let loops = json!([
        { "displacement": 8e-6, "harmonics": [[1, 0.3, 12.0], [3, 0.5, 2.0]] },
        { "displacement": 2e-6, "harmonics": [[1, 6.0, 3.0], [2, 0.1, 0.2], [3, 0.1, 0.4]] }
    ]);
    let scene = read(json!({ "type": "loop_family", "loops": loops })).unwrap();
    assert!((first_harmonic(&scene, 8e-6) - Complex64::new(0.3, 12.0)).norm() < 1e-14);
    assert!((first_harmonic(&scene, 2e-6) - Complex64::new(6.0, 3.0)).norm() < 1e-14);
    assert!(!scene.problem().unwrap().contacts[0].law.nature().odd);
    assert!(scene.notes().iter().any(|note| note.contains("even content")), "{:?}", scene.notes());
    let odd = read(json!({ "type": "loop_family", "loops": loops, "symmetric": true })).unwrap();
    assert!(odd.problem().unwrap().contacts[0].law.nature().odd);
}

#[test]
fn a_family_of_scaled_loops_responds_like_the_scaled_loop() {
    let measured = Loop::new(8e-6, vec![Complex64::ZERO, Complex64::new(0.32, 11.99)]).unwrap();
    let law = ScaledLoop::new(&measured, 0.0, MagnitudeLaw::default(), PhaseLaw::default(), Symmetry::Auto)
        .unwrap();
    let describing = law.describing_function().unwrap();
    let loops: Vec<Value> = (0..25)
        .map(|i| 8e-6 * 0.02 * 50.0_f64.powf(f64::from(i) / 24.0))
        .map(|a| (a, describing.first_harmonic(a).force))
        .map(|(a, f)| json!({ "displacement": a, "harmonics": [[1, f.re, f.im]] }))
        .collect();
    let response = |law: Value| {
        let scene = json!({
            "model": { "dofs": ["w"], "mass": [[4.0]], "damping": [[24.0]], "stiffness": [[8e5]] },
            "excitation": [{ "dof": "w", "amplitude": 10.0 }],
            "contacts": [{ "name": "root", "between": ["w", "ground"], "law": law }],
            "frequencies": { "from": 50, "to": 120, "points": 15 }
        });
        let outcome = Scene::from_str(&scene.to_string(), Path::new("."))
            .unwrap()
            .prepare()
            .unwrap()
            .solve(&scene::RunOptions::default())
            .outcome();
        serde_json::to_value(outcome).unwrap()
    };
    let family = response(json!({ "type": "loop_family", "loops": loops }));
    let scaled = response(
        json!({ "type": "scaled_loop", "loop": { "displacement": 8e-6, "force": measured.force_amplitude() } }),
    );
    let amplitude = |outcome: &Value, i: usize| {
        let point = &outcome["points"][i];
        assert_eq!(point["status"], "converged", "{point}");
        let first = &point["displacement"]["w"][0];
        first[1].as_f64().unwrap().hypot(first[2].as_f64().unwrap())
    };
    let mut compared = 0;
    for i in 0..15 {
        let (one, other) = (amplitude(&family, i), amplitude(&scaled, i));
        if one < 8e-6 {
            assert!((one / other - 1.0).abs() < 2e-3, "{i}: {one:e} {other:e}");
            compared += 1;
        }
    }
    assert!(compared > 5, "{compared} amplitudes within the measured range");
}

#[test]
fn every_refusal_names_its_entry() {
    let at = "contacts[0].law";
    let iwan = |more: Value| {
        let mut law = json!({ "type": "iwan", "displacement": 8e-6, "force": 12.0 });
        law.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        law
    };
    refused(json!({ "type": "iwan" }), &format!("{at}.displacement: is missing"));
    refused(iwan(json!({ "force": -1 })), &format!("{at}.force: must be positive, got -1"));
    refused(iwan(json!({ "range": 0 })), &format!("{at}.range: must be positive"));
    refused(iwan(json!({ "sliders": 2.5 })), &format!("{at}.sliders: must be a whole number"));
    refused(iwan(json!({ "magnitude": { "slope": 0 } })), &format!("{at}.magnitude.slope: must be positive"));
    refused(iwan(json!({ "backbone": [[1, 1]] })), &format!("{at}.displacement: is one too many"));
    let backbone = |points: Value| json!({ "type": "iwan", "backbone": points });
    refused(backbone(json!([[1, 1], [2, 3]])), &format!("{at}.backbone[1]: the backbone is steeper"));
    refused(backbone(json!([[1, 1], [2, 2]])), &format!("{at}.backbone: needs two points"));
    refused(backbone(json!([[1, 1], [2]])), &format!("{at}.backbone[1]: must be [x in m, f in N], got 1"));
    let family = |loops: Value| json!({ "type": "loop_family", "loops": loops });
    let series = |a: f64, im: f64| json!({ "displacement": a, "harmonics": [[1, 1.0, im]] });
    refused(family(json!([])), &format!("{at}.loops: a family needs two or more loops"));
    refused(family(json!([series(1e-6, 1.0)])), &format!("{at}.loops: a family needs two or more loops"));
    refused(
        family(json!([series(1e-6, 1.0), series(2e-6, 1.0), series(1e-6, 2.0)])),
        &format!("{at}.loops[2]: has the displacement amplitude of loops[0]"),
    );
    refused(family(json!([series(1e-6, 1.0), series(2e-6, -1.0)])), &format!("{at}.loops[1].harmonics: "));
    refused(
        family(json!([series(1e-6, 1.0), { "displacement": 2e-6, "force": 3 }])),
        &format!("{at}.loops[1]: a family needs each loop's phase"),
    );
}
