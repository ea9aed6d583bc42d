//! What exact orbits refuse, and how they say it.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Cubic, CubicParameters, Iwan, IwanParameters, Law, MagnitudeLaw};
use faer::{Mat, mat};
use num_complex::Complex64;
use orbit::{OrbitError, Settings, State, System, find};
use stickslip_tests::orbit_models::{contact, load, two_mass, unit_masses};
use stickslip_tests::{elastic_coulomb, scaled_reference_loop};

fn refusal(system: &System, hertz: f64, settings: &Settings) -> (OrbitError, String) {
    let error = find(system, hertz, settings).expect_err("an orbit");
    let text = error.to_string();
    (error, text)
}

fn scene() -> System {
    unit_masses(elastic_coulomb(6e4, 1.0))
}

fn cubic(stiffness: f64) -> Arc<dyn Law> {
    Arc::new(Cubic::new(CubicParameters { stiffness }).unwrap())
}

#[test]
fn laws_without_a_mechanism() {
    let parameters =
        IwanParameters { displacement: 8e-6, force: 12.0, magnitude: MagnitudeLaw::default(), range: 10.0 };
    let iwan: Arc<dyn Law> = Arc::new(Iwan::from_magnitude(parameters).unwrap());
    for (law, word) in [(iwan, "sliders"), (scaled_reference_loop(), "whole period")] {
        let (error, text) = refusal(&two_mass(law), 60.0, &Settings::default());
        assert!(matches!(error, OrbitError::NoMechanism { .. }));
        assert!(text.contains("\"root\"") && text.contains(word), "{text}");
    }
    let mut mixed = scene();
    mixed.contacts.push(contact(1, None, cubic(1e8)));
    assert!(matches!(refusal(&mixed, 60.0, &Settings::default()).0, OrbitError::Mixed { .. }));
}

#[test]
fn nothing_to_follow() {
    let default = Settings::default();
    let mut still = scene();
    still.loads.clear();
    assert_eq!(refusal(&still, 60.0, &default).0, OrbitError::NoExcitation);
    still.loads = vec![load(0, 0, 5.0), load(0, 1, 0.0)];
    assert_eq!(refusal(&still, 60.0, &default).0, OrbitError::NoExcitation);
    // A contact that sticks all period, with and without a mean.
    let mut stuck = scene();
    stuck.loads = vec![load(1, 1, 0.01)];
    let (error, text) = refusal(&stuck, 60.0, &default);
    assert_eq!(error, OrbitError::Stuck);
    assert!(text.contains("mean") && text.contains("history"), "{text}");
    stuck.loads.push(load(0, 0, 0.5));
    assert_eq!(refusal(&stuck, 60.0, &default).0, OrbitError::Stuck);
}

#[test]
fn unbounded_motion() {
    let resonance = 9e4_f64.sqrt() / TAU;
    let undamped = |stiffness: f64, damping: f64| System {
        mass: mat![[1.0]],
        damping: mat![[damping]],
        stiffness: mat![[stiffness]],
        loads: vec![load(0, 1, 1.0)],
        contacts: vec![],
        joints: Vec::new(),
    };
    let settings = Settings { settling_periods: 20, ..Settings::default() };
    let (error, text) = refusal(&undamped(9e4, 0.0), resonance, &settings);
    assert!(matches!(error, OrbitError::NotClosed { .. }), "{text}");
    assert!(text.contains("does not close"), "{text}");
    // Slightly beside it there is an orbit.
    assert!(find(&undamped(9e4, 0.0), resonance * 1.001, &settings).is_ok());
    // A slider cannot hold back a resonance that feeds it more than it takes.
    let mut slipping = undamped(9e4, 0.0);
    slipping.contacts.push(contact(0, None, elastic_coulomb(1e3, 0.1)));
    assert!(find(&slipping, resonance, &settings).is_err());
    // A softening spring lets go.
    let mut softening = undamped(9e4, 1.0);
    softening.loads = vec![load(0, 1, 50.0)];
    softening.contacts.push(contact(0, None, cubic(-1e12)));
    let settings = Settings { settling_periods: 40, ..Settings::default() };
    let (error, text) = refusal(&softening, 0.9 * resonance, &settings);
    assert!(matches!(error, OrbitError::Unbounded | OrbitError::NotClosed { .. }), "{text}");
}

#[test]
fn wrong_input() {
    let default = Settings::default();
    for hertz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refusal(&scene(), hertz, &default).0, OrbitError::Frequency { .. }), "{hertz}");
    }
    let says = |change: &dyn Fn(&mut System), words: &str| {
        let mut system = scene();
        change(&mut system);
        let (error, text) = refusal(&system, 60.0, &default);
        assert!(text.contains(words), "{error:?}: {text}");
    };
    says(&|s| s.damping = Mat::zeros(2, 3), "damping matrix is 2 × 3");
    says(&|s| s.stiffness = Mat::zeros(1, 1), "stiffness matrix is 1 × 1");
    says(&|s| s.mass = Mat::zeros(0, 0), "no dofs");
    says(&|s| s.stiffness[(1, 0)] = f64::NAN, "stiffness matrix is not finite");
    says(&|s| s.mass[(0, 0)] = 0.0, "mass matrix is singular");
    says(&|s| s.mass = mat![[1.0, 1.0], [1.0, 1.0]], "mass matrix is singular");
    says(&|s| s.mass[(1, 1)] = -1.0, "mass matrix is singular");
    says(&|s| s.loads[0].dof = 2, "load 0 is at dof 2");
    says(&|s| s.loads[0].amplitude = Complex64::new(f64::NAN, 0.0), "load 0");
    says(&|s| s.contacts[0].first = 7, "contact \"root\" is at dof 7");
    says(&|s| s.contacts[0].second = Some(2), "contact \"root\" is at dof 2");
    says(&|s| s.contacts[0].scale = 0.0, "scale of contact \"root\"");
    let start = |displacement: usize, velocity: usize, sliders: usize| {
        let state = State {
            displacement: vec![0.0; displacement],
            velocity: vec![0.0; velocity],
            sliders: vec![0.0; sliders],
        };
        refusal(&scene(), 60.0, &Settings { start: Some(state), ..Settings::default() }).1
    };
    assert!(start(1, 2, 1).contains("1 displacements"));
    assert!(start(2, 3, 1).contains("3 velocities"));
    assert!(start(2, 2, 0).contains("0 sliders"));
    let state = State { displacement: vec![f64::NAN, 0.0], velocity: vec![0.0; 2], sliders: vec![0.0] };
    let settings = Settings { start: Some(state), ..Settings::default() };
    assert!(matches!(refusal(&scene(), 60.0, &settings).0, OrbitError::NotFinite { .. }));
}
