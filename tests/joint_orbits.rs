//! Exact orbits of joints: their laws at every instant, closed forms, and integration in time that knows no events.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Cubic, CubicParameters, Gap, GapParameters};
use contact::{ElasticCoulomb, ElasticCoulombParameters, FrictionContactParameters};
use faer::linalg::solvers::Solve;
use faer::{Mat, mat};
use num_complex::Complex64;
use orbit::{EventKind, Orbit, OrbitError, Settings, System, find};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stickslip_tests::joint_models::{instant, one_mass, preloaded, root, with_gap};
use stickslip_tests::orbit_models::{contact, load, orbit};

/// Slip under a pressure that varies; lift-off; impacts through a gap; more dofs, a static load and two harmonics.
fn scenes() -> Vec<(&'static str, System, FrictionContactParameters, f64)> {
    let pressed = preloaded(18.0);
    let lifted = preloaded(6.0);
    let open = with_gap(2e-5);
    vec![
        ("pressed", one_mass(pressed), pressed, 60.0),
        ("pressed", one_mass(pressed), pressed, 95.0),
        ("lifted", one_mass(lifted), lifted, 70.0),
        ("open", one_mass(open), open, 75.0),
        ("root", root(preloaded(8.0)), preloaded(8.0), 47.0),
        ("root", root(with_gap(-2e-5)), with_gap(-2e-5), 62.0),
    ]
}

fn count(orbit: &Orbit, kind: EventKind) -> usize {
    orbit.events().iter().filter(|event| event.kind == kind).count()
}

#[test]
fn the_laws_hold_at_every_instant() {
    for (name, system, parameters, hertz) in scenes() {
        let orbit = orbit(&system, hertz);
        println!("{name} {hertz} Hz: {} events, {:?}", orbit.events().len(), orbit.multipliers().unwrap());
        assert!(orbit.energy_error() < 1e-10, "{name}: {:e}", orbit.energy_error());
        assert!(count(&orbit, EventKind::Slip) > 0, "{name} at {hertz} Hz never slips");
        let scale = system.joints[0].scale;
        let (kt, kn) = (scale * parameters.tangential_stiffness, scale * parameters.normal_stiffness);
        let at_rest = match (parameters.preload, parameters.gap) {
            (Some(preload), _) => scale * preload,
            (_, Some(gap)) => -kn * gap,
            _ => unreachable!(),
        };
        let mu = parameters.friction_coefficient;
        let steps = 4000;
        let all: Vec<_> =
            (0..=steps).map(|j| instant(&orbit, orbit.period() * j as f64 / steps as f64)).collect();
        let most = all.iter().map(|at| at.pressure).fold(0.0, f64::max);
        let exact = 1e-12 * most;
        let slider = |j: usize| all[j].tangential - all[j].friction / kt;
        let reach = all.iter().map(|at| at.tangential.abs()).fold(0.0, f64::max);
        let (mut slipped, mut apart) = (0.0, 0);
        for (j, at) in all.iter().enumerate() {
            let expected = (at_rest + kn * at.normal).max(0.0);
            assert!((at.pressure - expected).abs() < exact, "{name}: pressure {at:?}, {expected}");
            assert!(at.friction.abs() <= mu * at.pressure + exact, "{name}: {at:?}");
            apart += usize::from(at.pressure == 0.0);
            let moved = if j > 0 { slider(j) - slider(j - 1) } else { 0.0 };
            if moved.abs() > 1e-12 * reach && at.pressure > 0.0 && all[j - 1].pressure > 0.0 {
                // At its limit at one end of the interval at least, and moving along the force.
                let slack = |j: usize| mu * all[j].pressure - all[j].friction.abs();
                assert!(
                    slack(j).min(slack(j - 1)) < 1e-9 * most,
                    "{name} at instant {j}: moves below its limit"
                );
                assert!(moved * (all[j].friction + all[j - 1].friction) > 0.0, "{name} at instant {j}");
                slipped += moved.abs();
            }
        }
        assert!(slipped > 0.0);
        assert_eq!(apart > 0, count(&orbit, EventKind::Open) > 0, "{name}");
        assert_eq!(count(&orbit, EventKind::Open), count(&orbit, EventKind::Close), "{name}");
        assert!(orbit.joint_dissipation(0) > 0.0);
    }
}

/// `M ẅ + D ẇ + C w + f − load` with ẅ by central differences of the velocity.
#[test]
fn the_equation_of_motion_holds() {
    for (name, system, _, hertz) in scenes() {
        let orbit = orbit(&system, hertz);
        let n = system.mass.nrows();
        let (omega, h) = (TAU * hertz, 1e-5 / hertz);
        let scale = system.joints[0].scale;
        let _ = scale;
        let largest: f64 = system.loads.iter().map(|load| load.amplitude.norm()).sum();
        let mut checked = 0;
        for j in 0..500 {
            let t = orbit.period() * (j as f64 + 0.37) / 500.0;
            if orbit.events().iter().any(|event| (event.time - t).abs() < 2.0 * h) {
                continue;
            }
            for i in 0..n {
                let row = |matrix: &Mat<f64>, x: &dyn Fn(usize) -> f64| -> f64 {
                    (0..n).map(|j| matrix[(i, j)] * x(j)).sum()
                };
                let acceleration =
                    |j: usize| (orbit.velocity(j, t + h) - orbit.velocity(j, t - h)) / (2.0 * h);
                let mut rest = row(&system.mass, &acceleration)
                    + row(&system.damping, &|j| orbit.velocity(j, t))
                    + row(&system.stiffness, &|j| orbit.displacement(j, t));
                for load in system.loads.iter().filter(|load| load.dof == i) {
                    let turn = Complex64::cis(load.harmonic as f64 * omega * t);
                    rest -= (load.amplitude * turn).re;
                }
                for (d, direction) in system.joints[0].directions.iter().enumerate() {
                    for &(dof, coefficient) in direction.iter().filter(|(dof, _)| *dof == i) {
                        let _ = dof;
                        rest -= coefficient * orbit.joint_force(0, d, t);
                    }
                }
                assert!(rest.abs() < 1e-6 * largest, "{name} at {hertz} Hz, dof {i}, {t} s: {rest:e} N");
            }
            checked += 1;
        }
        assert!(checked > 450);
    }
}

/// Harmonics of forces and displacements, closed forms over every stretch between events, are those of samples in time;
/// the trapezoidal rule sees bends of forces to second order.
#[test]
fn spectra_are_those_of_the_motion_in_time() {
    let samples = 1 << 16;
    for (name, system, _, hertz) in scenes() {
        let orbit = orbit(&system, hertz);
        let check = |found: Vec<Complex64>, x: &dyn Fn(f64) -> f64, what: &str| {
            let values: Vec<f64> =
                (0..samples).map(|j| x(orbit.period() * j as f64 / samples as f64)).collect();
            let size = values.iter().fold(0.0_f64, |top, x| top.max(x.abs()));
            for k in [0, 1, 2, 3, 8, 40] {
                let turn = |j: usize| Complex64::cis(-TAU * ((k * j) % samples) as f64 / samples as f64);
                let sum: Complex64 = values.iter().enumerate().map(|(j, x)| turn(j) * x).sum();
                let expected = sum * if k == 0 { 1.0 } else { 2.0 } / samples as f64;
                let error = (found[k] - expected).norm() / size;
                assert!(error < 2e-9, "{name} at {hertz} Hz, {what}, k = {k}: {error:e}");
            }
        };
        for d in 0..2 {
            check(orbit.joint_force_spectrum(0, d, 40), &|t| orbit.joint_force(0, d, t), "force");
        }
        for i in 0..system.mass.nrows() {
            check(orbit.spectrum(i, 40), &|t| orbit.displacement(i, t), "displacement");
        }
    }
}

/// One period from the orbit's state by a fourth-order Runge–Kutta method with return mapping in each stage: largest
/// distance from the orbit in any displacement, relative to the largest displacement.
fn distance_in_time(
    system: &System,
    parameters: &FrictionContactParameters,
    orbit: &Orbit,
    steps: usize,
) -> f64 {
    let n = system.mass.nrows();
    let joint = &system.joints[0];
    let (kt, kn) = (joint.scale * parameters.tangential_stiffness, joint.scale * parameters.normal_stiffness);
    let preload = joint.scale * parameters.preload.unwrap_or(0.0);
    let at_rest = parameters.gap.map_or(preload, |gap| -kn * gap);
    let along = |d: usize, w: &[f64]| -> f64 { joint.directions[d].iter().map(|(i, c)| c * w[*i]).sum() };
    // Friction and pressure for the slider of the last step.
    let forces = |slider: f64, w: &[f64]| -> (f64, f64) {
        let pressure = (at_rest + kn * along(1, w)).max(0.0);
        let limit = parameters.friction_coefficient * pressure;
        ((kt * (along(0, w) - slider)).clamp(-limit, limit), pressure)
    };
    let mass = system.mass.partial_piv_lu();
    let omega = TAU / orbit.period();
    let acceleration = |t: f64, slider: f64, w: &[f64], v: &[f64]| -> Vec<f64> {
        let mut pull = Mat::from_fn(n, 1, |i, _| {
            (0..n).map(|j| -system.stiffness[(i, j)] * w[j] - system.damping[(i, j)] * v[j]).sum::<f64>()
        });
        for load in &system.loads {
            let turn = Complex64::cis(load.harmonic as f64 * omega * t);
            pull[(load.dof, 0)] += (load.amplitude * turn).re;
        }
        let (friction, pressure) = forces(slider, w);
        for (d, f) in [friction, pressure - preload].into_iter().enumerate() {
            for &(i, c) in &joint.directions[d] {
                pull[(i, 0)] -= c * f;
            }
        }
        let solved = mass.solve(&pull);
        (0..n).map(|i| solved[(i, 0)]).collect()
    };
    let state = orbit.state();
    let (mut w, mut v) = (state.displacement, state.velocity);
    let mut slider = along(0, &w) - state.sliders[0] / kt;
    let h = orbit.period() / steps as f64;
    let add =
        |x: &[f64], dx: &[f64], h: f64| -> Vec<f64> { x.iter().zip(dx).map(|(x, d)| x + h * d).collect() };
    let (mut worst, mut size) = (0.0_f64, 0.0_f64);
    for step in 0..steps {
        let t = step as f64 * h;
        let (v1, a1) = (v.clone(), acceleration(t, slider, &w, &v));
        let v2 = add(&v, &a1, 0.5 * h);
        let a2 = acceleration(t + 0.5 * h, slider, &add(&w, &v1, 0.5 * h), &v2);
        let v3 = add(&v, &a2, 0.5 * h);
        let a3 = acceleration(t + 0.5 * h, slider, &add(&w, &v2, 0.5 * h), &v3);
        let v4 = add(&v, &a3, h);
        let a4 = acceleration(t + h, slider, &add(&w, &v3, h), &v4);
        for i in 0..n {
            w[i] += h / 6.0 * (v1[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
            v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
        }
        slider = along(0, &w) - forces(slider, &w).0 / kt;
        for (i, w) in w.iter().enumerate() {
            worst = worst.max((w - orbit.displacement(i, t + h)).abs());
            size = size.max(w.abs());
        }
    }
    worst / size
}

#[test]
fn integration_in_time_without_events_stays_on_the_orbit() {
    for (name, system, parameters, hertz) in scenes() {
        let orbit = orbit(&system, hertz);
        let (coarse, fine) = (
            distance_in_time(&system, &parameters, &orbit, 500),
            distance_in_time(&system, &parameters, &orbit, 32_000),
        );
        println!("{name} {hertz} Hz: {coarse:e} {fine:e}");
        assert!(fine < 1e-7 && fine < coarse / 8.0, "{name} at {hertz} Hz: {coarse:e} {fine:e}");
    }
}

/// A pressure that nothing changes makes the joint an elastic Coulomb element of slip force μN.
#[test]
fn constant_pressure_is_an_elastic_coulomb_element() {
    for (preload, hertz) in [(15.0, 55.0), (20.0, 80.0), (4.0, 120.0)] {
        let mut jointed = one_mass(preloaded(preload));
        jointed.stiffness = mat![[2e5, 0.0], [0.0, 4e5]];
        jointed.loads = vec![load(0, 1, 12.0)];
        let slider = ElasticCoulombParameters { stiffness: 3e5, slip_force: 0.4 * preload };
        let mut scalar = jointed.clone();
        scalar.joints.clear();
        scalar.contacts = vec![contact(0, None, Arc::new(ElasticCoulomb::new(slider).unwrap()))];
        let (jointed, scalar) = (orbit(&jointed, hertz), orbit(&scalar, hertz));
        let close = |a: Vec<Complex64>, b: Vec<Complex64>, what: &str| {
            let size = b.iter().map(|x: &Complex64| x.norm()).fold(0.0, f64::max);
            for (k, (a, b)) in a.iter().zip(&b).enumerate() {
                assert!((a - b).norm() < 1e-12 * size, "{what}, {hertz} Hz, k = {k}: {a} {b}");
            }
        };
        close(jointed.spectrum(0, 61), scalar.spectrum(0, 61), "displacement");
        close(jointed.joint_force_spectrum(0, 0, 61), scalar.force_spectrum(0, 61), "force");
        assert!((jointed.joint_dissipation(0) / scalar.dissipation(0) - 1.0).abs() < 1e-12);
        let mine: Vec<_> = jointed.events().iter().map(|event| (event.kind, event.direction)).collect();
        let other: Vec<_> = scalar.events().iter().map(|event| (event.kind, event.direction)).collect();
        assert_eq!(mine, other);
        let pairs = jointed.multipliers().unwrap().into_iter().zip(scalar.multipliers().unwrap());
        let _ = pairs;
    }
}

/// Displacement and velocity of `m ẅ + d ẇ + k w = p + F cos Ωt` after `span` from (w, v) at `t`, in closed form.
struct SineArc {
    m: f64,
    d: f64,
    k: f64,
    p: f64,
    force: f64,
    omega: f64,
}

impl SineArc {
    fn after(&self, t: f64, (w, v): (f64, f64), span: f64) -> (f64, f64) {
        let decay = 0.5 * self.d / self.m;
        let damped = (self.k / self.m - decay * decay).sqrt();
        let driven =
            self.force / Complex64::new(self.k - self.m * self.omega * self.omega, self.d * self.omega);
        let forced = |t: f64| {
            let turn = driven * Complex64::cis(self.omega * t);
            (turn.re + self.p / self.k, (turn * Complex64::new(0.0, self.omega)).re)
        };
        let (w0, v0) = forced(t);
        let a = w - w0;
        let b = (v - v0 + decay * a) / damped;
        let (sin, cos) = (damped * span).sin_cos();
        let shrink = (-decay * span).exp();
        let (w1, v1) = forced(t + span);
        let free = shrink * (a * cos + b * sin);
        (w1 + free, v1 - decay * free + shrink * damped * (b * cos - a * sin))
    }
}

/// A mass against a unilateral spring: arcs of damped sinusoids matched where they meet. The three unknowns (instants of
/// closing and opening, velocity of closing) solve three closed-form equations, by Newton's method from nearby.
#[test]
fn an_impact_oscillator_matches_its_arcs() {
    let (m, d, c, k) = (1.3, 25.0, 2.1e5, 9e5);
    for (gap, hertz) in [(0.0, 80.0), (1.5e-5, 90.0), (-1e-5, 100.0), (2e-5, 45.0)] {
        let system = System {
            mass: mat![[m]],
            damping: mat![[d]],
            stiffness: mat![[c]],
            loads: vec![load(0, 1, 6.0)],
            contacts: vec![contact(
                0,
                None,
                Arc::new(Gap::new(GapParameters { stiffness: k, gap }).unwrap()),
            )],
            joints: Vec::new(),
        };
        let orbit = orbit(&system, hertz);
        let kinds: Vec<_> = orbit.events().iter().map(|event| event.kind).collect();
        println!("{gap} m, {hertz} Hz: {kinds:?}");
        assert_eq!(kinds.len(), 2, "{gap} m, {hertz} Hz: {kinds:?}");
        let time = |kind| orbit.events().iter().find(|event| event.kind == kind).unwrap().time;
        let period = orbit.period();
        let omega = TAU / period;
        let free = SineArc { m, d, k: c, p: 0.0, force: 6.0, omega };
        let pressed = SineArc { m, d, k: c + k, p: k * gap, force: 6.0, omega };
        let closes = time(EventKind::Close);
        let opens = closes + (time(EventKind::Open) - closes).rem_euclid(period);
        let residual = |x: &[f64; 3]| -> [f64; 3] {
            let (w, v) = pressed.after(x[0], (gap, x[2]), x[1] - x[0]);
            let (back, rate) = free.after(x[1], (gap, v), x[0] + period - x[1]);
            [w - gap, back - gap, (rate - x[2]) / omega]
        };
        let exact = [closes, opens, orbit.velocity(0, closes)];
        // Begun beside the orbit, so that agreement is found and not given.
        let mut x = [exact[0] + 1e-3 * period, exact[1] - 1e-3 * period, 1.01 * exact[2]];
        let units = [period, period, exact[2]];
        for _ in 0..20 {
            let r = residual(&x);
            let slope = Mat::from_fn(3, 3, |i, j| {
                let (mut up, mut down) = (x, x);
                up[j] += 1e-6 * units[j];
                down[j] -= 1e-6 * units[j];
                (residual(&up)[i] - residual(&down)[i]) / 2e-6
            });
            let step = slope.partial_piv_lu().solve(Mat::from_fn(3, 1, |i, _| r[i]));
            for j in 0..3 {
                x[j] -= step[(j, 0)] * units[j];
            }
        }
        for j in 0..3 {
            let error = (x[j] - exact[j]).abs() / units[j].abs();
            assert!(error < 1e-11, "{gap} m, {hertz} Hz, unknown {j}: {error:e}");
        }
        // Forces depend on displacements alone: volumes of states shrink by the damping (Liouville).
        let product: Complex64 = orbit.multipliers().unwrap().iter().product();
        assert!((product - (-d / m * period).exp()).norm() < 1e-12, "{product}");
    }
}

/// Stiff and soft joints, preloads and gaps, light and heavy loads at random: what is found obeys energy and
/// complementarity, and hardly anything is not found.
#[test]
fn random_joints_are_followed() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut between = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
    let (mut found, mut stuck, mut lost) = (0, 0, Vec::new());
    for scene in 0..120 {
        let parameters = FrictionContactParameters {
            tangential_stiffness: between(1e4, 1e8),
            normal_stiffness: between(1e4, 1e8),
            friction_coefficient: between(0.05, 1.5),
            preload: (scene % 2 == 0).then(|| between(0.1, 100.0)),
            gap: (scene % 2 == 1).then(|| between(1e-7, 1e-4) * if scene % 4 == 1 { 1.0 } else { -1.0 }),
        };
        let mut system = if scene % 3 == 0 { root(parameters) } else { one_mass(parameters) };
        let factor = between(0.1, 10.0);
        system.loads.iter_mut().for_each(|load| load.amplitude *= factor);
        let hertz = between(10.0, 400.0);
        match find(&system, hertz, &Settings::default()) {
            Ok(orbit) => {
                found += 1;
                assert!(orbit.energy_error() < 1e-10, "scene {scene}: {:e}", orbit.energy_error());
                let all: Vec<_> =
                    (0..500).map(|j| instant(&orbit, orbit.period() * j as f64 / 500.0)).collect();
                let most = all.iter().map(|at| at.pressure).fold(0.0, f64::max);
                for at in all {
                    let slack = parameters.friction_coefficient * at.pressure - at.friction.abs();
                    assert!(at.pressure >= 0.0 && slack >= -1e-9 * most, "scene {scene}: {at:?}");
                }
            }
            Err(OrbitError::Stuck) => stuck += 1,
            Err(error) => lost.push((scene, hertz, error.to_string())),
        }
    }
    println!("{found} found, {stuck} stuck, {lost:#?}");
    assert!(found > 60 && lost.len() <= 6, "{found} found, {stuck} stuck, {lost:#?}");
}

fn refusal(system: &System) -> OrbitError {
    find(system, 60.0, &Settings::default()).unwrap_err()
}

#[test]
fn what_cannot_be_followed_is_refused_by_name() {
    let mut system = one_mass(preloaded(18.0));
    system.contacts =
        vec![contact(0, None, Arc::new(Cubic::new(CubicParameters { stiffness: 1e9 }).unwrap()))];
    assert_eq!(refusal(&system), OrbitError::Mixed { smooth: "root".into(), sliders: "pad".into() });

    let mut system = one_mass(preloaded(18.0));
    system.joints[0].directions.pop();
    assert_eq!(refusal(&system), OrbitError::Directions { joint: "pad".into(), given: 1, expected: 2 });

    let mut system = one_mass(preloaded(18.0));
    system.joints[0].directions[1] = vec![(7, 1.0)];
    assert_eq!(refusal(&system), OrbitError::Dof { what: "joint \"pad\"".into(), dof: 7, dofs: 2 });

    assert_eq!(refusal(&one_mass(preloaded(1e4))), OrbitError::Stuck);
}
