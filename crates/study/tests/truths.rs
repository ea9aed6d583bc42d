//! Truths against independent digits, and every kind of excitation on its way to an orbit.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::Path;

use scene::Scene;
use serde_json::{Value, json};
use study::{Errors, Reference, Truth, Truths};

fn scene(excitation: &Value, law: &Value) -> Scene {
    let text = json!({
        "model": { "dofs": ["w1", "w2"], "mass": [[3.98, 0], [0, 1.27]], "damping": [[24, 0], [0, 24]],
                   "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]] },
        "excitation": excitation,
        "contacts": [{ "name": "root", "between": ["w1", "ground"], "law": law }],
        "frequencies": [57.0],
        "output": ["w1"]
    });
    Scene::from_str(&text.to_string(), Path::new("")).unwrap()
}

fn compare(scene: Scene, hertz: f64, n: usize) -> (Truth, Errors) {
    let scene = scene.with_harmonics(n).unwrap();
    let truth = Truths::new(&scene, n).unwrap().at(hertz).unwrap();
    let prepared = scene.prepare().unwrap();
    let plan = prepared.plan();
    let solution = plan.solve(hertz, &mut plan.workspace());
    let errors = truth.errors(plan.orders(), &solution).unwrap();
    (truth, errors)
}

#[test]
fn the_errors_of_known_scenes() {
    let force = json!([{ "dof": "w2", "amplitude": 9.1 }]);
    let jenkins = json!({ "type": "elastic_coulomb", "stiffness": 6.705e6, "slip_force": 14.96556 });
    // |W_1| of the exact orbit in m, and the l2 error of N = 1 and N = 31, from an independent program.
    for (hertz, exact, one, many) in [
        (57.0, 2.774688183e-6, 0.675, 2.55e-5),
        (62.0, 2.943539707e-6, 4.70, 1.29e-5),
        (100.0, 2.388795768e-5, 0.032, 2.9e-6),
        (112.0, 5.219603747e-6, 0.58, 5.9e-6),
    ] {
        let (truth, errors) = compare(scene(&force, &jenkins), hertz, 31);
        assert_eq!(truth.reference, Reference::Orbit);
        assert!((truth.dofs[0].spectrum[1].norm() / exact - 1.0).abs() < 2e-9, "{hertz}");
        assert!((errors.spectrum / many - 1.0).abs() < 0.03, "{hertz}: {errors:?}");
        // The reference solution of the search has found the same motion.
        assert!(truth.distance.unwrap() < 1e-5);
        let (_, errors) = compare(scene(&force, &jenkins), hertz, 1);
        assert!((errors.spectrum / one - 1.0).abs() < 0.03, "{hertz}: {errors:?}");
    }
}

#[test]
fn every_excitation_becomes_a_load() {
    let spring = json!({ "type": "linear", "stiffness": 1e5 });
    for excitation in [
        json!([{ "dof": "w2", "amplitude": 9.1, "phase": 0.7 }]),
        json!([{ "kind": "base", "amplitude": 3.0, "phase": -1.1 }]),
        json!([{ "dof": "w1", "kind": "unbalance", "amplitude": 1e-3, "phase": 2.0 }]),
        json!([{ "dof": "w1", "amplitude": 5.0, "harmonic": 0, "phase": 0.4 }, { "dof": "w2", "amplitude": 1.0, "harmonic": 2 }]),
        json!([{ "kind": "base", "amplitude": 3.0, "harmonic": 3 }, { "dof": "w1", "amplitude": 1.0, "harmonic": 2 }]),
    ] {
        let (truth, errors) = compare(scene(&excitation, &spring), 31.0, 3);
        assert_eq!(truth.reference, Reference::Orbit, "{excitation}: {:?}", truth.no_orbit);
        assert!(errors.spectrum < 1e-10 && errors.peak < 1e-9, "{excitation}: {errors:?}");
        assert_eq!(errors.dissipation, None);
    }
}

#[test]
fn a_contact_that_sticks_has_many_harmonics_instead() {
    let weak = json!([{ "dof": "w2", "amplitude": 0.1 }]);
    let jenkins = json!({ "type": "elastic_coulomb", "stiffness": 6.705e6, "slip_force": 14.96556 });
    let (truth, errors) = compare(scene(&weak, &jenkins), 57.0, 3);
    assert_eq!(truth.reference, Reference::Harmonics(127));
    assert!(truth.no_orbit.unwrap().contains("sticks"));
    assert!(errors.spectrum < 1e-12);
}
