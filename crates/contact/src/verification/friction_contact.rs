//! Checks of friction under a normal load: closed forms, other laws, finely sampled references, derivatives by two ways.

use super::*;
use crate::common_point::CommonPoint;
use crate::{FrictionContact, FrictionContactParameters, JointChange, JointLaw, JointMarks, JointMotion};

/// A motion of several directions with its samples.
pub(super) struct Moving {
    directions: usize,
    spectrum: Vec<Complex64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl Moving {
    /// From the spectrum of each direction, in m.
    pub(super) fn new(spectra: &[Vec<Complex64>], samples: usize) -> Self {
        let length = spectra.iter().map(Vec::len).max().unwrap();
        let padded: Vec<Vec<Complex64>> = spectra
            .iter()
            .map(|s| s.iter().copied().chain(std::iter::repeat(Complex64::ZERO)).take(length).collect())
            .collect();
        let rows: Vec<Sampled> = padded.iter().map(|s| Sampled::new(s, samples)).collect();
        Self {
            directions: spectra.len(),
            spectrum: padded.concat(),
            displacement: rows.iter().flat_map(|row| row.displacement.clone()).collect(),
            velocity: rows.iter().flat_map(|row| row.velocity.clone()).collect(),
        }
    }

    pub(super) fn motion(&self) -> JointMotion<'_> {
        JointMotion {
            directions: self.directions,
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
        }
    }

    pub(super) fn samples(&self) -> usize {
        self.displacement.len() / self.directions
    }
}

pub(super) fn forces(law: &dyn JointLaw, moving: &Moving) -> (Vec<f64>, JointMarks) {
    let mut force = vec![0.0; moving.displacement.len()];
    let mut workspace = law.workspace(moving.samples());
    let marks = law.force(&moving.motion(), &mut *workspace, &mut force).unwrap();
    (force, marks)
}

pub(super) const KT: f64 = 6e6;
pub(super) const KN: f64 = 4e6;
pub(super) const MU: f64 = 0.4;
/// Slips from 2 µm on.
pub(super) const LOAD: f64 = 30.0;

pub(super) fn contact(preload: Option<f64>, gap: Option<f64>, tangential: usize) -> FrictionContact {
    let parameters = FrictionContactParameters {
        tangential_stiffness: KT,
        normal_stiffness: KN,
        friction_coefficient: MU,
        preload,
        gap,
    };
    FrictionContact::new(parameters, tangential).unwrap()
}

pub(super) fn um(list: &[(usize, f64, f64)]) -> Vec<Complex64> {
    let highest = list.iter().map(|(k, ..)| *k).max().unwrap_or(0);
    let mut spectrum = vec![Complex64::ZERO; highest + 1];
    for &(k, re, im) in list {
        spectrum[k] = complex(re * 1e-6, im * 1e-6);
    }
    spectrum
}

/// Tangential motions, in one direction and in the other.
pub(super) fn tangential() -> Vec<[Vec<Complex64>; 2]> {
    vec![
        [um(&[(1, 4.0, 1.0)]), um(&[(1, 1.0, -2.5)])],
        [
            um(&[(0, 1.0, 0.0), (1, 3.0, 0.5), (3, 1.5, 1.9)]),
            um(&[(0, -2.0, 0.0), (1, 2.0, 1.0), (2, 0.7, -0.6)]),
        ],
        [um(&[(1, 2.1, 0.3), (2, 0.4, 0.3)]), um(&[(1, 0.4, 0.1), (2, -0.3, 0.5)])],
        [um(&[(0, 0.5, 0.0), (1, 0.9, 0.3)]), um(&[(1, 0.4, -0.7)])],
        [um(&[(0, 0.3, 0.0), (1, 2.3, 1.3), (4, 1.0, 0.2)]), um(&[(0, 0.3, 0.0)])],
    ]
}

/// Normal motions: constant load, varying, apart at times, apart twice, touching seldom.
pub(super) fn normal() -> Vec<Vec<Complex64>> {
    vec![
        um(&[]),
        um(&[(0, 0.5, 0.0), (1, 3.0, 1.0)]),
        um(&[(1, 2.0, 1.0), (2, 6.0, -5.0)]),
        um(&[(0, -2.0, 0.0), (1, -3.0, 9.0), (3, 2.0, 1.0)]),
        um(&[(0, -11.0, 0.0), (1, 5.0, 2.0), (2, 4.0, 1.0)]),
    ]
}

fn cases(samples: usize) -> Vec<(FrictionContact, Moving)> {
    let mut cases = Vec::new();
    for [x, y] in tangential() {
        for n in normal() {
            for (preload, gap) in [(Some(LOAD), None), (None, Some(-LOAD / KN))] {
                cases.push((contact(preload, gap, 1), Moving::new(&[x.clone(), n.clone()], samples)));
                cases.push((
                    contact(preload, gap, 2),
                    Moving::new(&[x.clone(), y.clone(), n.clone()], samples),
                ));
            }
        }
    }
    cases
}

/// Every entry of the derivative against central differences, errors relative to `stiffness`.
pub(super) fn check_differences(law: &dyn JointLaw, moving: &Moving, stiffness: f64, tolerance: f64) {
    let samples = moving.samples();
    let mut workspace = law.workspace(samples);
    let mut force = vec![0.0; moving.displacement.len()];
    let marks = law.force(&moving.motion(), &mut *workspace, &mut force).unwrap();
    let mut derivative = vec![0.0; force.len()];
    for direction in 0..moving.directions {
        for order in 0..4 {
            for amplitude in [complex(1.0, 0.0), complex(0.0, 1.0)] {
                if order == 0 && amplitude.im != 0.0 {
                    continue;
                }
                let wave: Vec<f64> = (0..samples)
                    .map(|j| (amplitude * Complex64::cis(TAU * (order * j) as f64 / samples as f64)).re)
                    .collect();
                let change = JointChange { direction, order, amplitude, displacement: &wave };
                law.derivative(&moving.motion(), &change, &mut *workspace, &mut derivative);
                let h = 1e-12;
                let moved = |sign: f64| {
                    let mut spectra: Vec<Vec<Complex64>> =
                        (0..moving.directions).map(|d| moving.motion().spectrum_of(d).to_vec()).collect();
                    spectra[direction].resize(4.max(moving.spectrum.len()), Complex64::ZERO);
                    spectra[direction][order] += amplitude * (sign * h);
                    forces(law, &Moving::new(&spectra, samples)).0
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                for (j, exact) in derivative.iter().enumerate() {
                    let difference = (up[j] - down[j]) / (2.0 * h);
                    assert!(
                        (difference - exact).abs() < tolerance * stiffness,
                        "{marks:?} direction {direction} order {order} {amplitude}, sample {j}: {difference} by differences, {exact}"
                    );
                }
            }
        }
    }
}

#[test]
fn derivatives_agree_with_central_differences() {
    for (law, moving) in cases(128) {
        check_differences(&law, &moving, KT, 3e-8);
    }
}

/// Largest difference of two rows of samples, relative to the second's largest entry.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |top, x| top.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |top, (x, y)| top.max((x - y).abs())) / size
}

/// Every `stride`-th sample.
fn thinned(row: &[f64], stride: usize) -> Vec<f64> {
    row.iter().copied().step_by(stride).collect()
}

#[test]
fn derivatives_agree_with_dual_numbers_followed_for_many_periods() {
    use crate::slider::Grip;
    use crate::sliding_period::follow;

    /// From `start` until nothing changes any more; derivatives come along.
    fn followed<const D: usize>(
        moving: &Moving,
        (direction, wave): (usize, &[f64]),
        start: [f64; D],
        raw: impl Fn(usize) -> f64,
    ) -> Vec<[Dual64; D]> {
        let samples = moving.samples();
        let by = |d: usize, j: usize| if d == direction { wave[j] } else { 0.0 };
        let place = |j: usize| {
            let w = std::array::from_fn(|d| Dual64::new(moving.motion().displacement_of(d)[j], by(d, j)));
            (w, Dual64::new(raw(j), KN * by(D, j)) * (MU / KT))
        };
        let mut slider = start.map(Dual64::from);
        let mut slipping = false;
        let mut row = vec![slider; samples];
        for _ in 0..400 {
            for (j, kept) in row.iter_mut().enumerate() {
                let (next, grip) = follow(slider, slipping, place((j + samples - 1) % samples), place(j));
                (slider, slipping, *kept) = (next, grip == Grip::Slip, next);
            }
        }
        row
    }

    fn check<const D: usize>(law: &FrictionContact, moving: &Moving) {
        let samples = moving.samples();
        let mut workspace = law.workspace(samples);
        let mut force = vec![0.0; moving.displacement.len()];
        let marks = law.force(&moving.motion(), &mut *workspace, &mut force).unwrap();
        if marks.state == ContactState::Stick && marks.apart == 0.0 {
            return;
        }
        let mut derivative = force.clone();
        for direction in 0..=D {
            let wave: Vec<f64> =
                (0..samples).map(|j| (TAU * j as f64 / samples as f64 + 0.4).cos()).collect();
            let change =
                JointChange { direction, order: 1, amplitude: Complex64::cis(0.4), displacement: &wave };
            law.derivative(&moving.motion(), &change, &mut *workspace, &mut derivative);
            // The state does not depend on where it was begun.
            let raw = |j: usize| law.normal().load(moving.motion().displacement_of(D)[j]);
            let row = followed(moving, (direction, &wave), [3.7e-6; D], raw);
            for d in 0..D {
                for (j, slider) in row.iter().enumerate() {
                    let w = moving.motion().displacement_of(d)[j];
                    let by = if d == direction { wave[j] } else { 0.0 };
                    let f = (Dual64::new(w, by) - slider[d]) * KT;
                    assert!((f.re - force[d * samples + j]).abs() < 1e-11 * LOAD, "{marks:?} {j}");
                    let error = (f.eps - derivative[d * samples + j]).abs() / KT;
                    assert!(error < 1e-10, "{marks:?} {direction} {j}: {error:e}");
                }
            }
        }
    }

    for (law, moving) in cases(64) {
        if moving.directions == 2 { check::<1>(&law, &moving) } else { check::<2>(&law, &moving) }
    }
}

#[test]
fn a_constant_load_makes_it_elastic_coulomb_friction() {
    let jenkins =
        ElasticCoulomb::new(ElasticCoulombParameters { stiffness: KT, slip_force: MU * LOAD }).unwrap();
    for spectrum in motions() {
        let error = |samples: usize| {
            let moving = Moving::new(&[spectrum.clone(), um(&[])], samples);
            let (force, marks) = forces(&contact(Some(LOAD), None, 1), &moving);
            let (expected, other) = force_of(&jenkins, &Sampled::new(&spectrum, samples)).unwrap();
            assert_eq!((marks.state, marks.apart), (other.state, 0.0));
            assert!(force[samples..].iter().all(|f| *f == 0.0));
            difference(&force[..samples], &expected)
        };
        // A turning point falls between samples: half a step off, w'' (π/M)²/2 too low.
        let (coarse, fine) = (error(256), error(4096));
        assert!(coarse < 4e-3 && fine < 4e-3 / 256.0, "{coarse:e} {fine:e}");
    }
}

#[test]
fn a_load_that_follows_the_motion_has_a_closed_form() {
    // w = a cos τ and ρ = r + b cos τ: the slider is dragged down from a − r − b and up from −a + r − b.
    let (a, r, b) = (6e-6, MU * LOAD / KT, 0.9e-6);
    let samples = 64;
    let n = b * KT / (MU * KN);
    let moving = Moving::new(&[um(&[(1, a * 1e6, 0.0)]), um(&[(1, n * 1e6, 0.0)])], samples);
    let (force, marks) = forces(&contact(Some(LOAD), None, 1), &moving);
    assert_eq!(marks, JointMarks { state: ContactState::Mixed, apart: 0.0, cycles: 1, extrapolated: false });
    for j in 0..samples {
        let cosine = (TAU * j as f64 / samples as f64).cos();
        let (w, reach) = (a * cosine, r + b * cosine);
        let slider = if j <= samples / 2 { (a - r - b).min(w + reach) } else { (-a + r - b).max(w - reach) };
        assert!((force[j] - KT * (w - slider)).abs() < 1e-13 * MU * LOAD, "{j}");
        assert!((force[samples + j] - KN * n * cosine).abs() < 1e-13 * LOAD);
    }
}

#[test]
fn motion_along_a_line_is_friction_in_one_direction() {
    for angle in [0.0, 0.5, FRAC_PI_2, 2.4] {
        for [along, _] in tangential() {
            for n in normal() {
                let turned = |by: f64| along.iter().map(|w| w * by).collect::<Vec<_>>();
                let plane = Moving::new(&[turned(f64::cos(angle)), turned(f64::sin(angle)), n.clone()], 128);
                let line = Moving::new(&[along.clone(), n.clone()], 128);
                let (in_plane, marks) = forces(&contact(None, Some(-LOAD / KN), 2), &plane);
                let (on_line, other) = forces(&contact(None, Some(-LOAD / KN), 1), &line);
                assert_eq!((marks.state, marks.apart), (other.state, other.apart));
                for j in 0..128 {
                    let expected = [on_line[j] * angle.cos(), on_line[j] * angle.sin(), on_line[128 + j]];
                    for (d, expected) in expected.iter().enumerate() {
                        assert!((in_plane[d * 128 + j] - expected).abs() < 1e-12 * LOAD, "{angle} {j} {d}");
                    }
                }
            }
        }
    }
}

/// ∮ f·dw over the tangential directions in J, from the spectra.
pub(super) fn friction_work(moving: &Moving, force: &[f64]) -> f64 {
    let samples = moving.samples();
    (0..moving.directions - 1)
        .map(|d| {
            let spectrum = moving.motion().spectrum_of(d);
            let f = harmonics(&force[d * samples..(d + 1) * samples], spectrum.len() - 1);
            spectrum
                .iter()
                .zip(f)
                .enumerate()
                .map(|(k, (w, f))| PI * k as f64 * (f * w.conj()).im)
                .sum::<f64>()
        })
        .sum()
}

#[test]
fn circling_under_a_constant_load_has_a_closed_form() {
    // The slider circles with radius √(a² − r²), r = μN/k_t; it is dragged along the rope, hence a right angle between
    // the rope and the slider's radius: the force leads the displacement by γ, cos γ = r/a.
    let (a, r) = (5e-6, MU * LOAD / KT);
    let error = |samples: usize| {
        let moving = Moving::new(&[um(&[(1, 5.0, 0.0)]), um(&[(1, 0.0, -5.0)]), um(&[])], samples);
        let (force, marks) = forces(&contact(Some(LOAD), None, 2), &moving);
        assert_eq!((marks.state, marks.apart), (ContactState::Slip, 0.0));
        assert!(marks.cycles <= 10, "{}", marks.cycles);
        let work = TAU * (a * a - r * r).sqrt() * MU * LOAD;
        assert!((friction_work(&moving, &force) / work - 1.0).abs() < 40.0 / (samples * samples) as f64);
        let lead = (r / a).acos();
        (0..samples)
            .map(|j| {
                let expected = MU * LOAD * Complex64::cis(TAU * j as f64 / samples as f64 + lead);
                (complex(force[j], force[samples + j]) - expected).norm() / (MU * LOAD)
            })
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(64), error(1024));
    let rate = (coarse / fine).log2() / 4.0;
    assert!(coarse < 2.5e-3 && (rate - 2.0).abs() < 0.02, "{coarse:e} {fine:e} {rate}");
}

#[test]
fn the_sampled_error_falls_with_the_square_of_the_samples() {
    for tangential in [1, 2] {
        let mut errors = [0.0; 2];
        for (law, fine) in cases(1 << 13) {
            if fine.directions != tangential + 1 {
                continue;
            }
            let spectra: Vec<_> =
                (0..fine.directions).map(|d| fine.motion().spectrum_of(d).to_vec()).collect();
            let reference = forces(&law, &fine).0;
            for (samples, error) in [128, 1024].into_iter().zip(&mut errors) {
                let force = forces(&law, &Moving::new(&spectra, samples)).0;
                let expected = thinned(&reference, (1 << 13) / samples);
                *error += difference(&force[..tangential * samples], &expected[..tangential * samples]);
            }
        }
        let rate = (errors[0] / errors[1]).log2() / 3.0;
        assert!((rate - 2.0).abs() < 0.1, "{tangential}: {errors:?} {rate}");
    }
}

#[test]
fn turning_in_time_and_in_the_plane_turns_the_force() {
    let samples = 128;
    for [x, y] in tangential() {
        for n in normal() {
            let law = contact(Some(LOAD), None, 2);
            let all = [x.clone(), y.clone(), n.clone()];
            let (force, marks) = forces(&law, &Moving::new(&all, samples));
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * LOAD, "{a} {b} {marks:?}");
            let later = all.map(|s| {
                let turn = |(k, w): (usize, &Complex64)| w * Complex64::cis(TAU * (k * 37) as f64 / 128.0);
                s.iter().enumerate().map(turn).collect()
            });
            let (shifted, _) = forces(&law, &Moving::new(&later, samples));
            for (row, other) in shifted.chunks(samples).zip(force.chunks(samples)) {
                (0..samples).for_each(|j| close(row[j], other[(j + 37) % samples]));
            }
            let (sin, cos) = 0.7_f64.sin_cos();
            let length = x.len().max(y.len());
            let at = |s: &[Complex64], k: usize| s.get(k).copied().unwrap_or_default();
            let turned = [
                (0..length).map(|k| at(&x, k) * cos - at(&y, k) * sin).collect(),
                (0..length).map(|k| at(&x, k) * sin + at(&y, k) * cos).collect(),
                n.clone(),
            ];
            let (rotated, _) = forces(&law, &Moving::new(&turned, samples));
            for j in 0..samples {
                let (fx, fy) = (force[j], force[samples + j]);
                close(rotated[j], fx * cos - fy * sin);
                close(rotated[samples + j], fx * sin + fy * cos);
                close(rotated[2 * samples + j], force[2 * samples + j]);
            }
        }
    }
}

#[test]
fn lifting_off_is_marked() {
    // N_0 + k_n b cos τ is negative for arccos(N_0/(k_n b))/π of the period.
    let b = 10e-6;
    let moving = Moving::new(&[um(&[(1, 3.0, 0.0)]), um(&[(1, 10.0, 0.0)])], 1024);
    let (force, marks) = forces(&contact(Some(LOAD), None, 1), &moving);
    let apart = (LOAD / (KN * b)).acos() / PI;
    assert!((marks.apart - apart).abs() < 1e-5, "{} {apart}", marks.apart);
    for j in 0..1024 {
        if force[1024 + j] == -LOAD {
            assert_eq!(force[j], 0.0);
        }
    }
    let away = Moving::new(&[um(&[(1, 3.0, 0.0)]), um(&[(0, -8.0, 0.0)])], 64);
    let (force, marks) = forces(&contact(None, Some(0.0), 1), &away);
    assert!(force.iter().all(|f| *f == 0.0));
    assert_eq!((marks.state, marks.apart), (ContactState::Apart, 1.0));
    // No friction: the normal direction alone.
    let parameters = FrictionContactParameters {
        tangential_stiffness: KT,
        normal_stiffness: KN,
        friction_coefficient: 0.0,
        preload: Some(LOAD),
        gap: None,
    };
    let (force, marks) = forces(&FrictionContact::new(parameters, 1).unwrap(), &moving);
    assert_eq!(marks.state, ContactState::Slip);
    assert!(force[..1024].iter().all(|f| *f == 0.0) && force[1024..].iter().any(|f| *f == -LOAD));
}

#[test]
fn parameters_are_checked_by_name() {
    let good = FrictionContactParameters {
        tangential_stiffness: KT,
        normal_stiffness: KN,
        friction_coefficient: MU,
        preload: Some(LOAD),
        gap: None,
    };
    let key = |parameters| FrictionContact::new(parameters, 2).unwrap_err().key.into_owned();
    assert_eq!(key(FrictionContactParameters { tangential_stiffness: 0.0, ..good }), "tangential_stiffness");
    assert_eq!(key(FrictionContactParameters { normal_stiffness: -1.0, ..good }), "normal_stiffness");
    assert_eq!(key(FrictionContactParameters { friction_coefficient: -0.1, ..good }), "friction_coefficient");
    assert_eq!(key(FrictionContactParameters { preload: Some(-1.0), ..good }), "preload");
    assert_eq!(key(FrictionContactParameters { preload: None, ..good }), "preload");
    assert_eq!(key(FrictionContactParameters { gap: Some(0.0), ..good }), "gap");
    assert_eq!(key(FrictionContactParameters { preload: None, gap: Some(f64::NAN), ..good }), "gap");
    assert_eq!(FrictionContact::new(good, 3).unwrap_err().key, "tangential");
    let other = contact(Some(LOAD), None, 1).workspace(64);
    let moving = Moving::new(&[um(&[(1, 3.0, 0.0)]), um(&[]), um(&[])], 64);
    let mut force = vec![0.0; 192];
    for mut workspace in [other, contact(Some(LOAD), None, 2).workspace(128)] {
        let answer = contact(Some(LOAD), None, 2).force(&moving.motion(), &mut *workspace, &mut force);
        assert_eq!(answer.unwrap_err(), LawError::OtherWorkspace);
    }
}

proptest! {
    #[test]
    fn friction_under_a_varying_load_never_gives_energy(
        parts in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 12),
        size in -7.0..-4.5_f64,
        approach in -6.5..-4.5_f64,
    ) {
        let spectrum = |parts: &[(f64, f64)], size: f64| -> Vec<Complex64> {
            let size = 10.0_f64.powf(size);
            std::iter::once(Complex64::ZERO)
                .chain(parts.iter().enumerate().map(|(i, &(re, im))| complex(re, im) * (size / (i + 1) as f64)))
                .collect()
        };
        let spectra = [spectrum(&parts[..4], size), spectrum(&parts[4..8], size), spectrum(&parts[8..], approach)];
        let moving = Moving::new(&spectra, 1024);
        let (force, _) = forces(&contact(Some(LOAD), None, 2), &moving);
        let peak = force[..2048].iter().fold(0.0_f64, |top, f| top.max(f.abs()));
        prop_assert!(friction_work(&moving, &force) > -1e-4 * peak * 10.0_f64.powf(size));
    }
}

proptest! {
    /// Nearest: the way from the start is a sum of the pulls of the discs on whose edge the point lies. None: even the
    /// point that comes closest to all discs, found by subgradient steps, misses one.
    #[test]
    fn a_resting_slider_is_nearest_to_its_start(
        discs in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 0.6..2.0_f64), 1..12),
        start in (-3.0..3.0_f64, -3.0..3.0_f64),
    ) {
        let disc = |j: usize| ([discs[j].0, discs[j].1], discs[j].2);
        let start = [start.0, start.1];
        let missed = |point: [f64; 2], j: usize| (discs[j].0 - point[0]).hypot(discs[j].1 - point[1]) - discs[j].2;
        match CommonPoint::nearest(start, discs.len(), disc, 1e-12) {
            Some(rest) => {
                let way = complex(rest.point[0] - start[0], rest.point[1] - start[1]);
                for j in 0..discs.len() {
                    prop_assert!(missed(rest.point, j) <= 1e-12);
                }
                let pull = |j: usize| complex(discs[j].0 - rest.point[0], discs[j].1 - rest.point[1]);
                let edges: Vec<Complex64> = rest.edges.iter().flatten().map(|&j| pull(j)).collect();
                for j in rest.edges.iter().flatten() {
                    prop_assert!(missed(rest.point, *j).abs() <= 1e-12);
                }
                let cross = |a: Complex64, b: Complex64| a.re * b.im - a.im * b.re;
                match edges[..] {
                    [] => prop_assert_eq!(way.norm(), 0.0),
                    [pull] => {
                        prop_assert!(cross(way, pull).abs() < 1e-12 && (way * pull.conj()).re > 0.0);
                    }
                    _ => {
                        let area = cross(edges[0], edges[1]);
                        prop_assert!(cross(way, edges[1]) / area > -1e-9 && cross(edges[0], way) / area > -1e-9);
                    }
                }
            }
            None => {
                let worst = |point: [f64; 2]| {
                    (0..discs.len()).map(|j| (missed(point, j), j)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
                };
                let (mut point, mut least) = ([0.0; 2], f64::INFINITY);
                for step in 1..4000 {
                    let (by, j) = worst(point);
                    least = least.min(by);
                    let pull = complex(discs[j].0 - point[0], discs[j].1 - point[1]);
                    let move_by = pull / pull.norm() / f64::from(step);
                    point = [point[0] + move_by.re, point[1] + move_by.im];
                }
                prop_assert!(least > 0.0, "{least}");
            }
        }
    }
}
