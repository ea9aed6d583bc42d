//! Exact orbits with friction in two tangential directions: the law at every instant, closed forms, orbits with one direction,
//! rotations, and motion followed in time by a method that shares nothing with them.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{
    ElasticCoulomb, ElasticCoulombParameters, FrictionContact, FrictionContactParameters, Gap, GapParameters,
};
use faer::{Mat, mat};
use num_complex::Complex64;
use orbit::{EventKind, Joint, Load, Orbit, OrbitError, Settings, System, find};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stickslip_tests::joint_models::{JOINT, balanced, one_mass, planar, preloaded, with_gap};
use stickslip_tests::orbit_models::{contact, load, orbit};
use stickslip_tests::planar_truth::{Period, Planar};

/// Pressed and lifting off, with a preload and with a gap, slip all around and in parts.
fn scenes() -> Vec<(&'static str, FrictionContactParameters, f64)> {
    vec![
        ("pressed", preloaded(18.0), 60.0),
        ("loose", preloaded(12.0), 95.0),
        ("lifted", preloaded(5.0), 70.0),
        ("open", with_gap(1e-5), 75.0),
        ("interference", with_gap(-2e-5), 50.0),
    ]
}

fn count(orbit: &Orbit, kind: EventKind) -> usize {
    orbit.events().iter().filter(|event| event.kind == kind).count()
}

/// The joint at an instant: relative displacement in the plane, friction on the rig, pressure.
struct Instant {
    place: [f64; 2],
    friction: [f64; 2],
    pressure: f64,
    normal: f64,
}

fn instant(orbit: &Orbit, joint: usize, t: f64) -> Instant {
    Instant {
        place: [0, 1].map(|d| orbit.joint_displacement(joint, d, t)),
        friction: [0, 1].map(|d| -orbit.joint_force(joint, d, t)),
        pressure: orbit.joint_pressure(joint, t),
        normal: orbit.joint_displacement(joint, 2, t),
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Forces by the law; the slider moves at the limit alone, and along the force.
fn check_law(name: &str, orbit: &Orbit, joint: usize, parameters: &FrictionContactParameters, scale: f64) {
    let kt = scale * parameters.tangential_stiffness;
    let kn = scale * parameters.normal_stiffness;
    let mu = parameters.friction_coefficient;
    let at_rest = parameters.preload.map_or_else(|| -kn * parameters.gap.unwrap(), |n| scale * n);
    let steps = 4000;
    let all: Vec<Instant> =
        (0..=steps).map(|j| instant(orbit, joint, orbit.period() * j as f64 / steps as f64)).collect();
    let most = all.iter().map(|at| at.pressure).fold(0.0, f64::max);
    let reach = all.iter().map(|at| length(at.place)).fold(0.0, f64::max);
    let slider = |at: &Instant| [0, 1].map(|d| at.place[d] - at.friction[d] / kt);
    for at in &all {
        let expected = (at_rest + kn * at.normal).max(0.0);
        assert!((at.pressure - expected).abs() <= 1e-12 * most, "{name}: {} {expected}", at.pressure);
        assert!(length(at.friction) <= mu * at.pressure + 1e-12 * most, "{name}");
    }
    for pair in all.windows(2) {
        let [before, after] = pair else { unreachable!() };
        let way = [0, 1].map(|d| slider(after)[d] - slider(before)[d]);
        if length(way) > 1e-11 * reach && before.pressure > 0.0 && after.pressure > 0.0 {
            let slack = |at: &Instant| mu * at.pressure - length(at.friction);
            assert!(slack(before).min(slack(after)) < 1e-9 * most, "{name}: moves below its limit");
            let force = [0, 1].map(|d| before.friction[d] + after.friction[d]);
            let (along, across) =
                (way[0] * force[0] + way[1] * force[1], way[1] * force[0] - way[0] * force[1]);
            assert!(along > 0.0, "{name}: against its force");
            // Between the directions that the force has at both ends.
            let turned = length([0, 1].map(|d| after.friction[d] - before.friction[d])) / length(force);
            assert!(
                across.abs() < along * (2.0 * turned + 1e-6) + 1e-10 * reach * length(force),
                "{name}: {across:e} {along:e}"
            );
        }
    }
}

/// `M ẅ + D ẇ + C w + f − load` with ẅ by central differences of the velocity.
fn check_motion(name: &str, system: &System, orbit: &Orbit) {
    let n = system.mass.nrows();
    let (omega, h) = (TAU / orbit.period(), 1e-5 * orbit.period());
    let largest: f64 = system.loads.iter().map(|load| load.amplitude.norm()).sum();
    let mut checked = 0;
    for j in 0..500 {
        let t = orbit.period() * (j as f64 + 0.37) / 500.0;
        if orbit.events().iter().any(|event| (event.time - t).abs() < 2.0 * h) {
            continue;
        }
        let mut rest = vec![0.0; n];
        for (i, rest) in rest.iter_mut().enumerate() {
            for j in 0..n {
                let acceleration = (orbit.velocity(j, t + h) - orbit.velocity(j, t - h)) / (2.0 * h);
                *rest += system.mass[(i, j)] * acceleration
                    + system.damping[(i, j)] * orbit.velocity(j, t)
                    + system.stiffness[(i, j)] * orbit.displacement(j, t);
            }
        }
        for load in &system.loads {
            rest[load.dof] -= (load.amplitude * Complex64::cis(load.harmonic as f64 * omega * t)).re;
        }
        for (c, contact) in system.contacts.iter().enumerate() {
            rest[contact.first] -= orbit.contact_force(c, t);
            if let Some(second) = contact.second {
                rest[second] += orbit.contact_force(c, t);
            }
        }
        for (c, joint) in system.joints.iter().enumerate() {
            for (d, direction) in joint.directions.iter().enumerate() {
                direction.iter().for_each(|&(dof, factor)| rest[dof] -= factor * orbit.joint_force(c, d, t));
            }
        }
        for rest in rest {
            assert!(rest.abs() < 1e-5 * largest, "{name} at {t} s: {rest:e} N");
        }
        checked += 1;
    }
    assert!(checked > 400, "{name}: {checked}");
}

#[test]
fn the_law_holds_at_every_instant() {
    for (name, parameters, hertz) in scenes() {
        let system = planar(parameters);
        let orbit = orbit(&system, hertz);
        println!("{name} at {hertz} Hz: {} events, closure {:e}", orbit.events().len(), orbit.closure());
        check_law(name, &orbit, 0, &parameters, 1.0);
        check_motion(name, &system, &orbit);
        assert!(count(&orbit, EventKind::Slip) > 0, "{name}");
        assert_eq!(count(&orbit, EventKind::Open), count(&orbit, EventKind::Close), "{name}");
        assert!(orbit.joint_dissipation(0) > 0.0);
    }
}

/// A rotating load on a round structure under a constant pressure: with sin β = r/A, r = μN/k_t, the force leads the displacement
/// by π/2 − β, so that `|(c − mΩ² + idΩ) A + μN (sin β + i cos β)| = F`. It slips all the time: there is no event.
#[test]
fn sliding_on_a_circle_has_a_closed_form() {
    for (preload, hertz) in [(15.0, 40.0), (15.0, 80.0), (2.0, 60.0)] {
        let mut system = planar(preloaded(preload));
        system.stiffness = mat![[2e5, 0.0, 0.0], [0.0, 2e5, 0.0], [0.0, 0.0, 4e5]];
        system.loads =
            vec![load(0, 1, 14.0), Load { dof: 1, harmonic: 1, amplitude: Complex64::new(0.0, -14.0) }];
        let omega = TAU * hertz;
        let limit = JOINT.friction_coefficient * preload;
        let reach = limit / JOINT.tangential_stiffness;
        let needed = |a: f64| {
            let sine = (reach / a).min(1.0);
            let structure = Complex64::new(2e5 - omega * omega, 200.0 * omega) * a;
            (structure + limit * Complex64::new(sine, (1.0 - sine * sine).sqrt())).norm()
        };
        let (mut low, mut high) = (reach, 1.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if needed(middle) < 14.0 { low = middle } else { high = middle }
        }
        let orbit = orbit(&system, hertz);
        assert!(orbit.events().is_empty(), "{:?}", orbit.events());
        for j in 0..50 {
            let at = instant(&orbit, 0, orbit.period() * j as f64 / 50.0);
            assert!((length(at.place) / low - 1.0).abs() < 1e-12, "{hertz} Hz: {}", length(at.place) / low);
            assert!((length(at.friction) / limit - 1.0).abs() < 1e-12);
            let lead = (at.place[0] * at.friction[1] - at.place[1] * at.friction[0]) / (low * limit);
            let cosine = (1.0 - (reach / low).powi(2)).sqrt();
            assert!((lead - cosine).abs() < 1e-12, "{hertz} Hz: {lead} {cosine}");
        }
        // μN times the slider's way 2π √(A² − r²).
        let work = limit * TAU * (low * low - reach * reach).sqrt();
        assert!((orbit.joint_dissipation(0) / work - 1.0).abs() < 1e-12);
        for dof in 0..2 {
            assert!((orbit.spectrum(dof, 3)[1].norm() / low - 1.0).abs() < 1e-12);
            assert!(orbit.spectrum(dof, 3)[3].norm() < 1e-13 * low);
        }
    }
}

/// Turns the first two dofs of three by `angle`.
fn turned(system: &System, angle: f64) -> System {
    let (sin, cos) = angle.sin_cos();
    let turn = mat![[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
    let both = |matrix: &Mat<f64>| &turn * matrix * turn.transpose();
    let loads = system.loads.iter().flat_map(|load| {
        (0..3).map(|dof| Load { dof, amplitude: load.amplitude * turn[(dof, load.dof)], ..*load })
    });
    System {
        mass: both(&system.mass),
        damping: both(&system.damping),
        stiffness: both(&system.stiffness),
        loads: loads.collect(),
        ..system.clone()
    }
}

/// Displacements of `turned` are those of `straight` turned by `angle`.
fn largest_difference(straight: &Orbit, turned: &Orbit, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let (mut worst, mut size) = (0.0_f64, 0.0_f64);
    for j in 0..300 {
        let t = straight.period() * j as f64 / 300.0;
        let w = [0, 1, 2].map(|dof| straight.displacement(dof, t));
        let expected = [cos * w[0] - sin * w[1], sin * w[0] + cos * w[1], w[2]];
        for (dof, expected) in expected.into_iter().enumerate() {
            worst = worst.max((turned.displacement(dof, t) - expected).abs());
            size = size.max(expected.abs());
        }
    }
    worst / size
}

#[test]
fn nothing_changes_when_everything_is_turned() {
    for (name, parameters, hertz) in scenes() {
        let system = planar(parameters);
        let straight = orbit(&system, hertz);
        for angle in [0.7, 2.0, -1.3] {
            let other = orbit(&turned(&system, angle), hertz);
            let error = largest_difference(&straight, &other, angle);
            println!("{name} turned by {angle}: {error:e}");
            assert!(error < 1e-11, "{name} at {hertz} Hz turned by {angle}: {error:e}");
            let pairs = straight.multipliers().unwrap().into_iter().zip(other.multipliers().unwrap());
            for (a, b) in pairs {
                assert!((a.norm() - b.norm()).abs() < 1e-8, "{name}: {a} {b}");
            }
        }
    }
}

/// Motion along a line at an angle to the axes is that of the exact orbit with one tangential direction.
#[test]
fn motion_along_a_line_is_that_of_one_direction() {
    for (parameters, hertz) in
        [(preloaded(18.0), 60.0), (preloaded(18.0), 95.0), (preloaded(6.0), 70.0), (with_gap(2e-5), 75.0)]
    {
        let line = one_mass(parameters);
        let one = orbit(&line, hertz);
        let mut plane = planar(parameters);
        plane.damping = mat![[20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 30.0]];
        plane.stiffness = mat![[2e5, 0.0, 3e4], [0.0, 3e5, 0.0], [3e4, 0.0, 4e5]];
        plane.loads = line.loads.iter().map(|load| Load { dof: 2 * load.dof, ..*load }).collect();
        for angle in [0.0, 0.4, 2.5] {
            let two = orbit(&turned(&plane, angle), hertz);
            let (sin, cos) = f64::sin_cos(angle);
            let (mut worst, mut size) = (0.0_f64, 0.0_f64);
            for j in 0..400 {
                let t = one.period() * j as f64 / 400.0;
                let (w, n) = (one.displacement(0, t), one.displacement(1, t));
                for (dof, expected) in [cos * w, sin * w, n].into_iter().enumerate() {
                    worst = worst.max((two.displacement(dof, t) - expected).abs());
                    size = size.max(expected.abs());
                }
            }
            println!("{hertz} Hz at {angle}: {:e}", worst / size);
            assert!(worst < 1e-12 * size, "{hertz} Hz at {angle}: {:e}", worst / size);
            let of = |orbit: &Orbit| -> Vec<_> {
                orbit
                    .events()
                    .iter()
                    .map(|event| (event.kind, (event.time / orbit.period() * 1e9).round()))
                    .collect()
            };
            assert_eq!(of(&one), of(&two), "{hertz} Hz at {angle}");
            assert!((one.joint_dissipation(0) / two.joint_dissipation(0) - 1.0).abs() < 1e-11);
        }
    }
}

fn distance(orbit: &Orbit, period: &Period) -> f64 {
    let steps = period.displacement.len();
    let (mut worst, mut size) = (0.0_f64, 0.0_f64);
    for (j, row) in period.displacement.iter().enumerate() {
        for (dof, w) in row.iter().enumerate() {
            let t = orbit.period() * j as f64 / steps as f64;
            worst = worst.max((w - orbit.displacement(dof, t)).abs());
            size = size.max(w.abs());
        }
    }
    worst / size
}

/// Motion followed in time at fourth order comes near the orbit as it should.
#[test]
fn motion_in_time_comes_to_the_orbit() {
    for (name, parameters, hertz) in scenes() {
        let system = planar(parameters);
        let orbit = orbit(&system, hertz);
        let errors = [128, 256, 512].map(|steps| {
            let mut truth = Planar::new(&system, &parameters, hertz);
            distance(&orbit, &truth.periodic(steps, 1e-13, 100))
        });
        println!("{name} at {hertz} Hz: {errors:?}");
        assert!(errors[2] < 1e-8, "{name}: {errors:?}");
        assert!(errors[2] < errors[0] / 60.0, "{name}: {errors:?}");
    }
}

/// Two contacts in a plane, one in a line, a slider and a stop at once.
fn mixture(preload: f64) -> (System, FrictionContactParameters) {
    let parameters = preloaded(preload);
    let law = |tangential| Arc::new(FrictionContact::new(parameters, tangential).unwrap());
    let slider = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 1e5, slip_force: 3.0 }).unwrap();
    let stop = Gap::new(GapParameters { stiffness: 2e5, gap: 2e-5 }).unwrap();
    let joint = |name: &str, directions: Vec<Vec<(usize, f64)>>, scale| Joint {
        name: name.into(),
        law: law(directions.len() - 1),
        directions,
        scale,
    };
    let system = System {
        mass: mat![[1.0, 0.1, 0.0, 0.0], [0.1, 1.2, 0.0, 0.0], [0.0, 0.0, 0.9, 0.0], [0.0, 0.0, 0.0, 1.1]],
        damping: mat![
            [60.0, 0.0, 0.0, 0.0],
            [0.0, 60.0, 0.0, -9.0],
            [0.0, 0.0, 80.0, 0.0],
            [0.0, -9.0, 0.0, 50.0]
        ],
        stiffness: mat![
            [2e5, 0.0, 3e4, 0.0],
            [0.0, 3e5, 0.0, -8e4],
            [3e4, 0.0, 4e5, 0.0],
            [0.0, -8e4, 0.0, 2e5]
        ],
        loads: vec![
            load(0, 1, 18.0),
            Load { dof: 1, harmonic: 1, amplitude: Complex64::new(9.0, -12.0) },
            Load { dof: 2, harmonic: 2, amplitude: Complex64::new(4.0, 6.0) },
            load(3, 1, 7.0),
            load(1, 0, 1.0),
        ],
        contacts: vec![contact(3, None, Arc::new(slider)), contact(3, Some(0), Arc::new(stop))],
        joints: vec![
            joint("a", vec![vec![(0, 1.0)], vec![(1, 1.0)], vec![(2, 1.0)]], 1.0),
            joint("b", vec![vec![(3, 1.0)], vec![(2, -1.0)]], 0.5),
            joint("c", vec![vec![(0, 0.6), (3, -0.6)], vec![(1, 0.8), (3, 0.5)], vec![(2, 0.7)]], 0.8),
        ],
    };
    (system, parameters)
}

#[test]
fn contacts_of_all_kinds_go_together() {
    let mut moved = [false; 5];
    for (preload, hertz) in [(12.0, 60.0), (4.0, 75.0)] {
        let (system, parameters) = mixture(preload);
        let orbit = orbit(&system, hertz);
        println!(
            "{preload} N, {hertz} Hz: {} events, {} periods",
            orbit.events().len(),
            orbit.settled_periods()
        );
        check_motion("mixture", &system, &orbit);
        check_law("a", &orbit, 0, &parameters, 1.0);
        check_law("c", &orbit, 2, &parameters, 0.8);
        orbit.events().iter().for_each(|event| moved[event.contact] = true);
    }
    assert_eq!(moved, [true; 5]);
}

/// Stiff and soft joints, preloads and gaps, light and heavy loads at random.
#[test]
fn random_joints_are_followed() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut between = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
    let (mut found, mut stuck, mut lost) = (0, 0, Vec::new());
    for scene in 0..30 {
        let parameters = FrictionContactParameters {
            tangential_stiffness: between(1e4, 1e7),
            normal_stiffness: between(1e5, 1e8),
            friction_coefficient: between(0.05, 1.5),
            preload: (scene % 2 == 0).then(|| between(0.1, 100.0)),
            gap: (scene % 2 == 1).then(|| between(1e-7, 1e-4) * if scene % 4 == 1 { 1.0 } else { -1.0 }),
        };
        let mut system = planar(parameters);
        let factor = between(0.1, 10.0);
        system.loads.iter_mut().for_each(|load| load.amplitude *= factor);
        let hertz = between(10.0, 400.0);
        match find(&system, hertz, &Settings::default()) {
            Ok(orbit) => {
                found += 1;
                assert!(orbit.energy_error() < 1e-10, "scene {scene}: {:e}", orbit.energy_error());
                check_law(&format!("scene {scene}"), &orbit, 0, &parameters, 1.0);
            }
            Err(OrbitError::Stuck) => stuck += 1,
            Err(error) => lost.push((scene, hertz, error.to_string())),
        }
    }
    println!("{found} found, {stuck} stuck, {lost:#?}");
    assert!(found > 18 && lost.is_empty(), "{found} found, {stuck} stuck, {lost:#?}");
}

/// Motion followed in time comes to its end as the largest multipliers say: its distances x from there, period by period, obey
/// `x_{k+2} = (μ₁ + μ₂) x_{k+1} − μ₁ μ₂ x_k` once the others have died out.
#[test]
fn disturbances_decay_as_the_multipliers_say() {
    for (preload, hertz) in [(18.0, 60.0), (5.0, 70.0)] {
        let parameters = preloaded(preload);
        let mut system = planar(parameters);
        system.damping = mat![[30.0, 0.0, 0.0], [0.0, 120.0, 0.0], [0.0, 0.0, 250.0]];
        let orbit = orbit(&system, hertz);
        let multipliers = orbit.multipliers().unwrap();
        println!("{preload} N: {multipliers:?}");
        let mut truth = Planar::new(&system, &parameters, hertz);
        // Every second period.
        let periods: Vec<Vec<f64>> =
            (0..60).map(|_| truth.periodic(256, 0.0, 2).displacement.concat()).collect();
        let end = periods.last().unwrap();
        let apart: Vec<Vec<f64>> =
            periods.iter().map(|row| row.iter().zip(end).map(|(a, b)| a - b).collect()).collect();
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let size = dot(end, end).sqrt();
        let small = apart.iter().position(|x| dot(x, x).sqrt() < 1e-6 * size).unwrap();
        let [a, b, c] = [0, 1, 2].map(|j| &apart[small + j][..]);
        // Least squares for c = sum · b − product · a.
        let (aa, ab, bb, ac, bc) = (dot(a, a), dot(a, b), dot(b, b), dot(a, c), dot(b, c));
        let determinant = aa * bb - ab * ab;
        let (sum, product) = ((aa * bc - ab * ac) / determinant, -(bb * ac - ab * bc) / determinant);
        let expected = [0, 1].map(|j| multipliers[j] * multipliers[j]);
        println!(
            "{preload} N: {sum} {product}, expected {} {}",
            expected[0] + expected[1],
            expected[0] * expected[1]
        );
        assert!((sum - (expected[0] + expected[1]).re).abs() < 1e-6, "{preload} N");
        assert!((product - (expected[0] * expected[1]).re).abs() < 1e-6, "{preload} N");
    }
}

/// A contact that sticks beside a slider that slips, with loads that have a mean: in a line or in a plane.
fn stuck_beside_slip(preload: f64, tangential: usize) -> System {
    let (mut system, _) = mixture(preload);
    system.contacts.truncate(1);
    system.joints.truncate(1);
    let joint = &mut system.joints[0];
    joint.law = Arc::new(FrictionContact::new(preloaded(preload), tangential).unwrap());
    if tangential == 1 {
        joint.directions.remove(1);
    }
    system.loads[3].amplitude *= 3.0;
    system.loads.extend([load(0, 0, 4.0), load(1, 0, -3.0), load(0, 2, 5.0)]);
    system
}

/// Of all places that repeat themselves the slider takes the one that the balance takes: its mean where that is within reach at every
/// instant, so that there is no mean friction, else the nearest to it. In a plane the balance knows the reach at its samples alone.
#[test]
fn a_contact_that_sticks_rests_where_the_balance_says() {
    for (tangential, preloads) in [(1, [150.0, 74.0, 66.0]), (2, [150.0, 134.0, 126.0])] {
        let mut at_edge = 0;
        for preload in preloads {
            let system = stuck_beside_slip(preload, tangential);
            let orbit = orbit(&system, 60.0);
            assert_eq!(orbit.locked_sliders(), [(1, 0)], "{preload} N");
            assert_eq!(orbit.joint_dissipation(0), 0.0);
            let friction =
                [0, 1].map(|d| if d < tangential { orbit.joint_force_spectrum(0, d, 0)[0].re } else { 0.0 });
            let problem = balanced(&system);
            let errors = [1 << 10, 1 << 13].map(|samples| {
                let settings = hbm::Settings { samples: Some(samples), ..hbm::Settings::new(31) };
                let plan = hbm::Plan::new(&problem, &settings).unwrap();
                let solution = plan.solve(60.0, &mut plan.workspace());
                let directions = &solution.joints[0].directions;
                let other = [0, 1].map(|d| if d < tangential { directions[d].force[0].re } else { 0.0 });
                length([0, 1].map(|d| friction[d] - other[d]))
            });
            println!("{tangential}, {preload} N: {friction:?}, {errors:?}");
            assert!(errors[1] < 1e-5 + 2e-4 * length(friction), "{preload} N: {errors:?}");
            if length(friction) > 1e-3 {
                at_edge += 1;
                assert!(tangential == 1 || errors[1] < 0.5 * errors[0], "{preload} N: {errors:?}");
            } else {
                assert!(length(friction) < 1e-11 && errors[1] < 1e-11, "{preload} N: {friction:?}");
            }
        }
        assert!(at_edge == 1 || at_edge == 2, "{tangential}: {at_edge}");
    }
}
