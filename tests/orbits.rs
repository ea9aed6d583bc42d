//! Exact orbits of piecewise-linear systems against printed digits, an independent computation, closed forms and a plain
//! integration in time.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use contact::{Iwan, IwanParameters, Law, Linear, LinearParameters, MagnitudeLaw, Mechanism};
use faer::{Mat, mat};
use num_complex::Complex64;
use orbit::{Contact, Event, EventKind, Load, Orbit, OrbitError, Settings, System, find};
use rand::{RngExt, SeedableRng};
use serde_json::Value;
use stickslip_tests::elastic_coulomb;
use stickslip_tests::orbit_models::{
    contact, distance_from_time_integration, load, orbit, orbit_from, two_mass, unit_masses,
};

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
        let system = if scene == "R" {
            two_mass(elastic_coulomb(6.705e6, 6.705e6 * 2.232e-6))
        } else {
            unit_masses(elastic_coulomb(6e4, 1.0))
        };
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
            assert!(worst < bound, "{scene} {hertz} Hz, {key}: {worst:e}");
        };
        compare(&w1, "w1", 1e-10);
        compare(&orbit.spectrum(1, 511), "w2", 1e-10);
        compare(&orbit.force_spectrum(0, 511), "force", 1e-10);
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

fn sliders_of(law: &dyn Law, contact: usize) -> (Vec<(usize, f64, f64)>, f64) {
    let Mechanism::Sliders { sliders, spring } = law.mechanism() else { panic!("no sliders") };
    (sliders.iter().map(|slider| (contact, slider.stiffness(), slider.slip_force())).collect(), spring)
}

/// H_k = C − (kΩ)² M + i kΩ D of two dofs, solved by hand.
fn receptance(system: &System, omega: f64, load: [Complex64; 2]) -> [Complex64; 2] {
    let h = |i: usize, j: usize| {
        Complex64::new(
            system.stiffness[(i, j)] - omega * omega * system.mass[(i, j)],
            omega * system.damping[(i, j)],
        )
    };
    let determinant = h(0, 0) * h(1, 1) - h(0, 1) * h(1, 0);
    [
        (load[0] * h(1, 1) - load[1] * h(0, 1)) / determinant,
        (load[1] * h(0, 0) - load[0] * h(1, 0)) / determinant,
    ]
}

#[test]
fn a_linear_system_has_the_closed_form_receptance() {
    let spring: Arc<dyn Law> = Arc::new(Linear::new(LinearParameters { stiffness: 3e5 }).unwrap());
    let mut system = two_mass(spring);
    system.damping = mat![[2.0, 0.0], [0.0, 0.1]];
    system.loads = vec![
        Load { dof: 1, harmonic: 1, amplitude: Complex64::new(9.0, -4.0) },
        load(0, 3, 2.0),
        Load { dof: 1, harmonic: 4, amplitude: Complex64::new(0.0, 1.0) },
        load(0, 0, 5.0),
    ];
    let mut locked = system.clone();
    locked.stiffness[(0, 0)] += 3e5;
    for hertz in [3.0, 43.0, 70.0, 500.0] {
        let orbit = orbit(&system, hertz);
        assert!(orbit.events().is_empty());
        let omega = TAU * hertz;
        let size = orbit.norm(1);
        for (k, w) in orbit.spectrum(1, 6).iter().enumerate() {
            let mut force = [Complex64::ZERO; 2];
            system
                .loads
                .iter()
                .filter(|load| load.harmonic == k)
                .for_each(|load| force[load.dof] += load.amplitude);
            let expected = receptance(&locked, k as f64 * omega, force);
            assert!((w - expected[1]).norm() < 1e-12 * size, "{hertz} Hz, k = {k}: {w} {}", expected[1]);
            let spring = -3e5 * expected[0];
            let found = orbit.force_spectrum(0, 6)[k];
            assert!((found - spring).norm() < 1e-11 * 3e5 * size, "{hertz} Hz, k = {k}: {found} {spring}");
        }
        // As a mean square, and at any instant.
        let sum: f64 = orbit.spectrum(1, 6).iter().map(|w| w.norm_sqr()).sum();
        assert!((sum.sqrt() / size - 1.0).abs() < 1e-12);
        let t = 0.3 / hertz;
        let terms = orbit.spectrum(1, 6);
        let at = |power: i32| -> f64 {
            let term = |(k, w): (usize, &Complex64)| {
                let turn = Complex64::new(0.0, k as f64 * omega);
                (w * turn.powi(power) * (turn * t).exp()).re
            };
            terms.iter().enumerate().map(term).sum()
        };
        assert!((orbit.displacement(1, t + 7.0 / hertz) - at(0)).abs() < 1e-12 * size);
        assert!((orbit.velocity(1, t) - at(1)).abs() < 1e-12 * size * 4.0 * omega);
        assert!(orbit.dissipation(0).abs() < 1e-12 * 3e5 * size * size);
    }
}

/// Undamped, with a rigid-body motion, critically damped: no state matrix here has all its eigenvectors.
#[test]
fn defective_state_matrices_change_nothing() {
    // m ẅ + d ẇ + c w = f cos Ωt
    for (damping, stiffness) in [(0.0, 0.0), (3.0, 0.0), (2.0 * 1e3_f64.sqrt(), 1e3), (0.0, 1e3)] {
        let system = System {
            mass: mat![[1.0]],
            damping: mat![[damping]],
            stiffness: mat![[stiffness]],
            loads: vec![load(0, 1, 2.0)],
            contacts: vec![],
            joints: Vec::new(),
        };
        let omega = TAU * 4.0;
        let found = orbit(&system, 4.0).spectrum(0, 3);
        let expected = 2.0 / Complex64::new(stiffness - omega * omega, omega * damping);
        assert!((found[1] - expected).norm() < 1e-12 * expected.norm(), "{damping} {stiffness}: {found:?}");
        assert!(found[2].norm() + found[3].norm() < 1e-13 * expected.norm());
    }
}

/// Without reversals inside a half period the loop is a parallelogram: 4 F_s (A − x_c), A from the extremes.
#[test]
fn dissipation_is_the_area_of_the_parallelogram() {
    let (stiffness, slip_force) = (6e4, 1.0);
    // A single mass, undamped, without other stiffness than the slider's: its mean is anywhere.
    let free = System {
        mass: mat![[0.7]],
        damping: mat![[0.0]],
        stiffness: mat![[0.0]],
        loads: vec![load(0, 1, 3.0)],
        contacts: vec![contact(0, None, elastic_coulomb(stiffness, slip_force))],
        joints: Vec::new(),
    };
    for (system, hertz) in [(free, 30.0), (unit_masses(elastic_coulomb(stiffness, slip_force)), 40.0)] {
        let orbit = orbit(&system, hertz);
        assert_eq!(orbit.events().len(), 4);
        let (low, high) = orbit.range(0);
        let area = 4.0 * slip_force * (0.5 * (high - low) - slip_force / stiffness);
        assert!((orbit.dissipation(0) / area - 1.0).abs() < 1e-12, "{hertz} Hz");
        // And what the harmonics say, π Σ k Im(F_k conj W_k), on the mass with the opposite sign.
        let (w, f) = (orbit.spectrum(0, 800), orbit.force_spectrum(0, 800));
        let sum: f64 =
            w.iter().zip(&f).enumerate().map(|(k, (w, f))| -PI * k as f64 * (f * w.conj()).im).sum();
        assert!((sum / area - 1.0).abs() < 1e-9, "{hertz} Hz: {sum} {area}");
        // The slip force is reached and never exceeded; events lie where force and velocity say.
        for event in orbit.events() {
            let force = -orbit.contact_force(0, event.time);
            assert!((force - f64::from(event.direction) * slip_force).abs() < 1e-12);
            let fastest = TAU * hertz * high;
            match event.kind {
                EventKind::Stick => assert!(orbit.velocity(0, event.time).abs() < 1e-12 * fastest),
                EventKind::Slip => assert!(orbit.velocity(0, event.time) * f64::from(event.direction) > 0.0),
                EventKind::Open | EventKind::Close => panic!("this contact never opens"),
            }
        }
    }
}

fn iwan(sliders: usize) -> Iwan {
    let parameters =
        IwanParameters { displacement: 8e-6, force: 12.0, magnitude: MagnitudeLaw::default(), range: 10.0 };
    Iwan::from_magnitude(parameters).unwrap().discretised(sliders).unwrap()
}

#[test]
fn a_stack_of_sliders_moves_as_in_time() {
    let law = iwan(8);
    let (sliders, spring) = sliders_of(&law, 0);
    for hertz in [30.0, 58.0, 108.0] {
        let mut system = two_mass(Arc::new(law.clone()));
        let settled = orbit(&system, hertz);
        let distance = |steps| distance_from_time_integration(&system, &settled, &sliders, &[spring], steps);
        let (coarse, fine) = (distance(2000), distance(16000));
        assert!(fine < 2e-7 && fine < 0.1 * coarse, "{hertz} Hz: {coarse:e} {fine:e}");
        // Some sliders never slip; loads and laws are odd, and so is the orbit.
        let spectrum = settled.spectrum(0, 40);
        assert!(spectrum.iter().step_by(2).all(|w| w.norm() < 1e-14 * spectrum[1].norm()));
        assert!(settled.events().len() >= 16);
        // With a static load nothing is odd any more.
        system.loads.push(load(0, 0, 4.0));
        let shifted = orbit(&system, hertz);
        let distance = |steps| distance_from_time_integration(&system, &shifted, &sliders, &[spring], steps);
        let (coarse, fine) = (distance(2000), distance(16000));
        assert!(fine < 2e-7 && fine < 0.1 * coarse, "{hertz} Hz, shifted: {coarse:e} {fine:e}");
    }
}

fn three_masses() -> (System, Vec<(usize, f64, f64)>, Vec<f64>) {
    let stack: Arc<dyn Law> =
        Arc::new(Iwan::from_backbone(&[[2e-6, 2.0], [6e-6, 4.0], [2e-5, 5.0]]).unwrap());
    let system = System {
        mass: mat![[4.0, 0.0, 0.0], [0.0, 1.3, 0.0], [0.0, 0.0, 0.8]],
        damping: mat![[4.0, 0.0, 0.0], [0.0, 3.0, -1.0], [0.0, -1.0, 2.0]],
        stiffness: mat![[9e5, -4e5, 0.0], [-4e5, 7e5, -2e5], [0.0, -2e5, 5e5]],
        loads: vec![load(1, 1, 30.0), load(2, 2, 12.0), load(2, 0, 3.0)],
        contacts: vec![
            contact(0, None, elastic_coulomb(2e6, 4.0)),
            Contact { name: "ring".into(), first: 2, second: Some(1), law: stack.clone(), scale: 1.5 },
        ],
        joints: Vec::new(),
    };
    let (stack, spring) = sliders_of(&*stack, 1);
    let scaled = stack.into_iter().map(|(c, k, limit)| (c, 1.5 * k, 1.5 * limit));
    (system, std::iter::once((0, 2e6, 4.0)).chain(scaled).collect(), vec![0.0, 1.5 * spring])
}

#[test]
fn two_contacts_and_several_loads_move_as_in_time() {
    let (system, sliders, springs) = three_masses();
    for hertz in [20.0, 60.0, 95.0] {
        let orbit = orbit(&system, hertz);
        assert!((0..2).all(|c| orbit.events().iter().any(|event| event.contact == c)), "{hertz} Hz");
        let distance = |steps| distance_from_time_integration(&system, &orbit, &sliders, &springs, steps);
        let (coarse, fine) = (distance(2000), distance(16000));
        assert!(fine < 2e-7 && fine < 0.1 * coarse, "{hertz} Hz: {coarse:e} {fine:e}");
    }
}

/// Two equal halves have their events at the same instants.
#[test]
fn simultaneous_events() {
    let one = System {
        mass: mat![[1.0]],
        damping: mat![[2.0]],
        stiffness: mat![[1.9e5]],
        loads: vec![load(0, 1, 3.0)],
        contacts: vec![contact(0, None, elastic_coulomb(6e4, 1.0))],
        joints: Vec::new(),
    };
    let half = |m: f64| mat![[m, 0.0], [0.0, m]];
    let twins = System {
        mass: half(1.0),
        damping: half(2.0),
        stiffness: half(1.9e5),
        loads: vec![load(0, 1, 3.0), load(1, 1, 3.0)],
        contacts: (0..2).map(|dof| contact(dof, None, elastic_coulomb(6e4, 1.0))).collect(),
        joints: Vec::new(),
    };
    // Two sliders of the same yield displacement on one dof do as one.
    let mut shared = one.clone();
    shared.contacts = vec![
        contact(0, None, elastic_coulomb(2e4, 1.0 / 3.0)),
        contact(0, None, elastic_coulomb(4e4, 2.0 / 3.0)),
    ];
    for hertz in [50.0, 62.0, 69.0, 90.0] {
        let (single, both, split) = (orbit(&one, hertz), orbit(&twins, hertz), orbit(&shared, hertz));
        let expected = single.spectrum(0, 9);
        assert_eq!(both.events().len(), 2 * single.events().len());
        assert_eq!(split.events().len(), 2 * single.events().len());
        for found in [both.spectrum(0, 9), both.spectrum(1, 9), split.spectrum(0, 9)] {
            for (found, expected_k) in found.iter().zip(&expected) {
                assert!((found - expected_k).norm() < 1e-12 * expected[1].norm(), "{hertz} Hz");
            }
        }
    }
}

/// The same system in mm, kN and kt: 1 kN s²/mm = 1e6 kg.
#[test]
fn units_do_not_matter() {
    let (system, ..) = three_masses();
    let stack: Arc<dyn Law> =
        Arc::new(Iwan::from_backbone(&[[2e-3, 2e-3], [6e-3, 4e-3], [2e-2, 5e-3]]).unwrap());
    let mut other = system.clone();
    let times = |matrix: &Mat<f64>| Mat::from_fn(3, 3, |i, j| matrix[(i, j)] * 1e-6);
    (other.mass, other.damping, other.stiffness) =
        (times(&system.mass), times(&system.damping), times(&system.stiffness));
    other.loads.iter_mut().for_each(|load| load.amplitude *= 1e-3);
    other.contacts[0].law = elastic_coulomb(2.0, 4e-3);
    other.contacts[1].law = stack;
    for hertz in [20.0, 60.0] {
        let (metres, millimetres) = (orbit(&system, hertz), orbit(&other, hertz));
        for dof in 0..3 {
            let (a, b) = (metres.spectrum(dof, 60), millimetres.spectrum(dof, 60));
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b * 1e-3).norm() < 1e-13 * metres.norm(dof), "{hertz} Hz, dof {dof}");
            }
        }
        assert_eq!(metres.events().len(), millimetres.events().len());
    }
}

/// A thousandth of the usual damping: settling would take thousands of periods.
#[test]
fn light_damping_needs_no_patience() {
    let mut system = two_mass(elastic_coulomb(6.705e6, 6.705e6 * 2.232e-6));
    system.damping = mat![[0.024, 0.0], [0.0, 0.024]];
    for hertz in [50.0, 75.0, 100.0, 107.0, 120.0] {
        match find(&system, hertz, &Settings::default()) {
            Ok(orbit) => assert!(orbit.closure() < 1e-12 && orbit.settled_periods() <= 64, "{hertz} Hz"),
            Err(error) => assert_eq!(error, OrbitError::Stuck, "{hertz} Hz"),
        }
    }
}

/// From its own state an orbit is found at once, and it is the same whatever the start.
#[test]
fn the_start_does_not_matter_to_friction() {
    let (system, ..) = three_masses();
    let first = orbit(&system, 60.0);
    let again = orbit_from(&system, 60.0, &Settings { start: Some(first.state()), ..Settings::default() });
    assert_eq!((again.settled_periods(), again.iterations()), (0, 0));
    let mut state = first.state();
    state.velocity.iter_mut().for_each(|v| *v = 3.0 * *v + 0.01);
    state.sliders.iter_mut().for_each(|f| *f = -*f);
    let other = orbit_from(&system, 60.0, &Settings { start: Some(state), ..Settings::default() });
    let w = first.spectrum(1, 9);
    assert!(first.locked_sliders().is_empty());
    for (a, b) in w.iter().zip(&other.spectrum(1, 9)) {
        assert!((a - b).norm() < 1e-12 * w[1].norm());
    }
    let events = |orbit: &Orbit| -> Vec<(usize, usize, EventKind, i8)> {
        orbit.events().iter().map(|e: &Event| (e.contact, e.slider, e.kind, e.direction)).collect()
    };
    assert_eq!(events(&first), events(&other));
}

/// A chain of n unit-like masses between walls.
fn chain(masses: &[f64], springs: &[f64], damping: f64) -> [Mat<f64>; 3] {
    let n = masses.len();
    let diagonal = |factor: f64| Mat::from_fn(n, n, |i, j| if i == j { factor * masses[i] } else { 0.0 });
    let stiffness = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => springs[i] + springs[i + 1],
        1 => -springs[i.max(j)],
        _ => 0.0,
    });
    [diagonal(1.0), diagonal(damping), stiffness]
}

/// Chains of up to four masses with up to three contacts of any kind, light to moderate damping, any frequency.
#[test]
fn every_random_scene_has_its_orbit() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let (mut found, mut stuck) = (0, 0);
    for case in 0..200 {
        let mut log = |low: f64, high: f64| 10f64.powf(rng.random_range(low..high));
        let masses: Vec<f64> = (0..=case % 4).map(|_| log(-0.5, 0.5)).collect();
        let n = masses.len();
        let springs: Vec<f64> = (0..=n).map(|_| log(4.0, 6.0)).collect();
        let [mass, damping, stiffness] = chain(&masses, &springs, log(-2.0, 1.5));
        let hertz = log(0.9, 2.7);
        let forces: Vec<f64> = (0..2).map(|_| log(0.0, 2.0)).collect();
        let sliders: Vec<(f64, f64)> = (0..3).map(|_| (log(4.0, 7.0), log(-1.0, 1.0))).collect();
        let mut loads = vec![load(rng.random_range(0..n), 1, forces[0])];
        if rng.random_bool(0.5) {
            loads.push(load(rng.random_range(0..n), rng.random_range(0..5_usize), forces[1]));
        }
        let count = rng.random_range(1..=3_usize);
        let contacts = sliders.iter().take(count).map(|&(stiffness, slip_force)| {
            let first = rng.random_range(0..n);
            let second = (n > 1 && rng.random_bool(0.4)).then_some((first + 1) % n);
            let backbone = [[1e-6, 1.0], [3e-6, 2.0], [9e-6, 3.0], [2e-5, 3.5]];
            let stack = rng.random_bool(0.3).then(|| Arc::new(Iwan::from_backbone(&backbone).unwrap()));
            let law =
                stack.map_or_else(|| elastic_coulomb(stiffness, slip_force), |stack| stack as Arc<dyn Law>);
            contact(first, second, law)
        });
        let contacts = contacts.collect();
        let system = System { mass, damping, stiffness, loads, contacts, joints: Vec::new() };
        match find(&system, hertz, &Settings::default()) {
            Ok(orbit) => {
                found += 1;
                assert!(orbit.closure() < 1e-12, "case {case}: {:e}", orbit.closure());
                assert!(orbit.energy_error() < 1e-10, "case {case}: {:e}", orbit.energy_error());
                // Every slip that begins ends.
                let begun = orbit.events().iter().filter(|event| event.kind == EventKind::Slip).count();
                assert_eq!(2 * begun, orbit.events().len(), "case {case}");
            }
            Err(error) => {
                stuck += 1;
                assert_eq!(error, OrbitError::Stuck, "case {case}");
            }
        }
    }
    assert!(found > 120 && stuck > 10, "{found} {stuck}");
}

/// The contact at the far end feels nothing at first: twenty derivatives of its motion are zero at rest.
#[test]
fn a_long_chain_starts_from_rest() {
    let n = 12;
    let [mass, damping, stiffness] = chain(&vec![1.0; n], &vec![4e5; n + 1], 20.0);
    let contacts = vec![contact(0, None, elastic_coulomb(1e6, 0.3))];
    let system =
        System { mass, damping, stiffness, loads: vec![load(n - 1, 1, 30.0)], contacts, joints: Vec::new() };
    let found = orbit(&system, 10.0);
    let distance = |steps| distance_from_time_integration(&system, &found, &[(0, 1e6, 0.3)], &[0.0], steps);
    let (coarse, fine) = (distance(1000), distance(4000));
    assert!(fine < 2e-5 && fine < 0.2 * coarse, "{coarse:e} {fine:e}");
}
