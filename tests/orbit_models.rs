//! The test models as systems for exact orbits.

use std::sync::Arc;

use contact::Law;
use faer::mat;
use num_complex::Complex64;
use orbit::{Contact, Load, Orbit, Settings, System, find};

/// `amplitude · cos(harmonic · Ωt)` on `dof`.
pub fn load(dof: usize, harmonic: usize, amplitude: f64) -> Load {
    Load { dof, harmonic, amplitude: Complex64::from(amplitude) }
}

/// A contact of scale 1.
pub fn contact(first: usize, second: Option<usize>, law: Arc<dyn Law>) -> Contact {
    Contact { name: "root".into(), first, second, law, scale: 1.0 }
}

/// The two masses of scene R with any law at w1.
pub fn two_mass(law: Arc<dyn Law>) -> System {
    System {
        mass: mat![[3.98, 0.0], [0.0, 1.27]],
        damping: mat![[24.0, 0.0], [0.0, 24.0]],
        stiffness: mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
        loads: vec![load(1, 1, 9.1)],
        contacts: vec![contact(0, None, law)],
        joints: Vec::new(),
    }
}

/// The unit masses of scene P with any law at w1.
pub fn unit_masses(law: Arc<dyn Law>) -> System {
    System {
        mass: mat![[1.0, 0.0], [0.0, 1.0]],
        damping: mat![[2.0, 0.0], [0.0, 2.0]],
        stiffness: mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]],
        loads: vec![load(1, 1, 3.0)],
        contacts: vec![contact(0, None, law)],
        joints: Vec::new(),
    }
}

/// The orbit from rest, closed and in balance of energy.
pub fn orbit(system: &System, hertz: f64) -> Orbit {
    orbit_from(system, hertz, &Settings::default())
}

/// The orbit, closed and in balance of energy.
pub fn orbit_from(system: &System, hertz: f64, settings: &Settings) -> Orbit {
    let orbit = find(system, hertz, settings).unwrap_or_else(|error| panic!("{hertz} Hz: {error}"));
    assert!(orbit.closure() < 1e-12, "{hertz} Hz: closure {:e}", orbit.closure());
    assert!(orbit.energy_error() < 1e-11, "{hertz} Hz: energy {:e}", orbit.energy_error());
    orbit
}

/// The motion integrated for one period from the orbit's state by a fourth-order Runge–Kutta method that knows
/// nothing of events: largest distance from the orbit in any displacement, relative to the largest displacement.
/// `sliders` are (contact, k_t, F_s), `springs` one a contact; unit masses, diagonal mass only.
pub fn distance_from_time_integration(
    system: &System,
    orbit: &Orbit,
    sliders: &[(usize, f64, f64)],
    springs: &[f64],
    steps: usize,
) -> f64 {
    let n = system.mass.nrows();
    let state = orbit.state();
    let (mut w, mut v, mut forces) = (state.displacement, state.velocity, state.sliders);
    let omega = std::f64::consts::TAU / orbit.period();
    let h = orbit.period() / steps as f64;
    let relative = |c: usize, w: &[f64]| {
        let contact = &system.contacts[c];
        w[contact.first] - contact.second.map_or(0.0, |second| w[second])
    };
    let updated = |forces: &[f64], from: &[f64], to: &[f64]| -> Vec<f64> {
        let slide = |(f, &(c, k, limit)): (&f64, &(usize, f64, f64))| {
            (f + k * (relative(c, to) - relative(c, from))).clamp(-limit, limit)
        };
        forces.iter().zip(sliders).map(slide).collect()
    };
    let acceleration = |t: f64, forces: &[f64], from: &[f64], w: &[f64], v: &[f64]| -> Vec<f64> {
        let mut pull: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|j| -system.stiffness[(i, j)] * w[j] - system.damping[(i, j)] * v[j]).sum())
            .collect();
        for load in &system.loads {
            pull[load.dof] += (load.amplitude * Complex64::cis(load.harmonic as f64 * omega * t)).re;
        }
        let now = updated(forces, from, w);
        let slider_forces = sliders.iter().zip(&now).map(|(&(c, ..), f)| (c, *f));
        let spring_forces = springs.iter().enumerate().map(|(c, k)| (c, k * relative(c, w)));
        for (c, f) in slider_forces.chain(spring_forces) {
            pull[system.contacts[c].first] -= f;
            if let Some(second) = system.contacts[c].second {
                pull[second] += f;
            }
        }
        (0..n).map(|i| pull[i] / system.mass[(i, i)]).collect()
    };
    let add =
        |x: &[f64], dx: &[f64], h: f64| -> Vec<f64> { x.iter().zip(dx).map(|(x, d)| x + h * d).collect() };
    let (mut worst, mut size) = (0.0_f64, 0.0_f64);
    for step in 0..steps {
        let t = step as f64 * h;
        let (v1, a1) = (v.clone(), acceleration(t, &forces, &w, &w, &v));
        let v2 = add(&v, &a1, 0.5 * h);
        let a2 = acceleration(t + 0.5 * h, &forces, &w, &add(&w, &v1, 0.5 * h), &v2);
        let v3 = add(&v, &a2, 0.5 * h);
        let a3 = acceleration(t + 0.5 * h, &forces, &w, &add(&w, &v2, 0.5 * h), &v3);
        let v4 = add(&v, &a3, h);
        let a4 = acceleration(t + h, &forces, &w, &add(&w, &v3, h), &v4);
        let before = w.clone();
        for i in 0..n {
            w[i] += h / 6.0 * (v1[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
            v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
        }
        forces = updated(&forces, &before, &w);
        for (i, w) in w.iter().enumerate() {
            worst = worst.max((w - orbit.displacement(i, t + h)).abs());
            size = size.max(w.abs());
        }
    }
    worst / size
}
