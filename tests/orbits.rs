//! Exact orbits against printed digits, an independent computation, closed forms and harmonic balance.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Cubic, CubicParameters, Law};
use faer::{Mat, mat};
use num_complex::Complex64;
use orbit::{Contact, EventKind, Load, Orbit, OrbitError, Settings, System, find};
use serde_json::Value;
use stickslip_tests::elastic_coulomb;

fn load(dof: usize, harmonic: usize, amplitude: f64) -> Load {
    Load { dof, harmonic, amplitude: Complex64::from(amplitude) }
}

fn contact(first: usize, second: Option<usize>, law: Arc<dyn Law>) -> Contact {
    Contact { name: "root".into(), first, second, law, scale: 1.0 }
}

fn scene_r() -> System {
    System {
        mass: mat![[3.98, 0.0], [0.0, 1.27]],
        damping: mat![[24.0, 0.0], [0.0, 24.0]],
        stiffness: mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
        loads: vec![load(1, 1, 9.1)],
        contacts: vec![contact(0, None, elastic_coulomb(6.705e6, 6.705e6 * 2.232e-6))],
    }
}

fn scene_p(law: Arc<dyn Law>) -> System {
    System {
        mass: mat![[1.0, 0.0], [0.0, 1.0]],
        damping: mat![[2.0, 0.0], [0.0, 2.0]],
        stiffness: mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]],
        loads: vec![load(1, 1, 3.0)],
        contacts: vec![contact(0, None, law)],
    }
}

fn orbit(system: &System, hertz: f64) -> Orbit {
    let orbit =
        find(system, hertz, &Settings::default()).unwrap_or_else(|error| panic!("{hertz} Hz: {error}"));
    assert!(orbit.closure() < 1e-12, "{hertz} Hz: closure {:e}", orbit.closure());
    assert!(orbit.energy_error() < 1e-11, "{hertz} Hz: energy {:e}", orbit.energy_error());
    orbit
}

#[test]
fn stick_slip_orbits_are_those_of_the_reference() {
    let printed = [
        ("R", 57.0, 2.774688183e-6),
        ("R", 62.0, 2.943539707e-6),
        ("R", 75.0, 1.988362982e-5),
        ("R", 100.0, 2.388795768e-5),
        ("R", 108.0, 2.781522903e-5),
        ("R", 112.0, 5.219603747e-6),
        ("P", 40.0, 1.166768192e-4),
        ("P", 55.0, 3.591562365e-5),
        ("P", 60.0, 2.509777370e-5),
        ("P", 108.0, 1.945075923e-5),
        ("P", 118.0, 3.460092910e-5),
    ];
    let data: Value = serde_json::from_str(include_str!("reference/exact_orbits.json")).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    for (scene, hertz, amplitude) in printed {
        let system = if scene == "R" { scene_r() } else { scene_p(elastic_coulomb(6e4, 1.0)) };
        let orbit = orbit(&system, hertz);
        let w1 = orbit.spectrum(0, 511);
        assert!((w1[1].norm() / amplitude - 1.0).abs() < 1e-9, "{scene} {hertz} Hz: {:e}", w1[1].norm());
        let points = data[scene]["points"].as_array().unwrap();
        let point = points.iter().find(|point| number(&point["hertz"]) == hertz).unwrap();
        let compare = |found: &[Complex64], key: &str, bound: f64| {
            let mut worst = 0.0_f64;
            for row in point[key].as_array().unwrap() {
                let k = row[0].as_u64().unwrap() as usize;
                let exact = Complex64::new(number(&row[1]), number(&row[2]));
                worst = worst.max((found[k] - exact).norm() / exact.norm());
            }
            println!("{scene} {hertz} {key} {worst:e}");
            assert!(worst < bound, "{scene} {hertz} Hz, {key}: {worst:e}");
        };
        compare(&w1, "w1", 1e-10);
        compare(&orbit.spectrum(1, 511), "w2", 1e-10);
        compare(&orbit.force_spectrum(0, 511), "force", 1e-10);
        println!(
            "{} {} {:e} {:e}",
            orbit.iterations(),
            orbit.settled_periods(),
            orbit.closure(),
            orbit.energy_error()
        );
        let times: Vec<f64> = orbit.events().iter().map(|event| event.time * hertz).collect();
        let mut expected: Vec<f64> = point["event_times"]
            .as_array()
            .unwrap()
            .iter()
            .map(|t| (number(t) * hertz).rem_euclid(1.0))
            .collect();
        expected.sort_by(f64::total_cmp);
        assert_eq!(times.len(), expected.len(), "{scene} {hertz} Hz: {:?}", orbit.events());
        for (found, expected) in times.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{scene} {hertz} Hz: {found} {expected}");
        }
        assert!((orbit.dissipation(0) / number(&point["dissipation"]) - 1.0).abs() < 1e-11);
    }
}

fn cubic(stiffness: f64) -> Arc<dyn Law> {
    Arc::new(Cubic::new(CubicParameters { stiffness }).unwrap())
}

#[test]
fn tmp_time() {
    let mut worst: Vec<(u128, f64, usize, usize)> = Vec::new();
    let system = scene_r();
    let t0 = std::time::Instant::now();
    let mut n = 0;
    for i in 0..371 {
        let hertz = 15.0 + 0.5 * i as f64;
        let t = std::time::Instant::now();
        match find(&system, hertz, &Settings::default()) {
            Ok(orbit) => {
                worst.push((t.elapsed().as_micros(), hertz, orbit.iterations(), orbit.settled_periods()))
            }
            Err(e) => {
                n += 1;
                if !matches!(e, OrbitError::Stuck) {
                    println!("{hertz} {e} {:?}", t.elapsed())
                }
            }
        }
    }
    println!("{n} refused, mean {:?}", t0.elapsed() / 371);
    worst.sort_by(|a, b| b.partial_cmp(a).unwrap());
    println!("{:?}", &worst[..10]);
    println!("median {:?}", &worst[worst.len() / 2]);
    let t = std::time::Instant::now();
    let orbit = find(&system, 75.0, &Settings::default()).unwrap();
    println!("{:?} events {}", t.elapsed(), orbit.events().len());
    let settings = Settings { start: Some(orbit.state()), ..Settings::default() };
    let t = std::time::Instant::now();
    let orbit = find(&system, 75.0, &settings).unwrap();
    println!("again {:?} {}", t.elapsed(), orbit.iterations());
    let t = std::time::Instant::now();
    orbit.spectrum(0, 511);
    println!("spectrum {:?}", t.elapsed());
}
