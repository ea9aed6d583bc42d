//! Checks that every law has to pass: closed forms, derivatives by two independent ways, energy, limits, continuity.
//! Transforms here are naive sums, so that nothing under test also judges.

mod family;
mod friction_contact;
mod friction_events;
mod gap;
mod iwan;
mod loaded_loop;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use hysteresis::Loop;
use num_complex::{Complex, Complex64};
use num_dual::Dual64;
use proptest::prelude::*;

use crate::path::Path;
use crate::turning_points::TurningPoints;
use crate::{
    ContactState, Coulomb, CoulombParameters, Cubic, CubicParameters, ElasticCoulomb,
    ElasticCoulombParameters, Iwan, Law, LawError, Linear, LinearParameters, LoopFamily, MagnitudeLaw, Marks,
    Motion, PhaseLaw, Recall, ScaledLoop, Symmetry, Tangent, Workspace,
};

/// A motion with its samples.
struct Sampled {
    spectrum: Vec<Complex64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    odd: bool,
}

/// rad/s; only rate-dependent laws notice.
const OMEGA: f64 = 300.0;

impl Sampled {
    fn new(spectrum: &[Complex64], samples: usize) -> Self {
        let at = |j: usize, power: i32| -> f64 {
            let tau = TAU * j as f64 / samples as f64;
            spectrum
                .iter()
                .enumerate()
                .map(|(k, c)| {
                    (c * Complex64::new(0.0, k as f64).powi(power) * Complex64::cis(k as f64 * tau)).re
                })
                .sum()
        };
        Self {
            spectrum: spectrum.to_vec(),
            displacement: (0..samples).map(|j| at(j, 0)).collect(),
            velocity: (0..samples).map(|j| at(j, 1)).collect(),
            odd: spectrum.iter().step_by(2).all(|c| c.norm() == 0.0),
        }
    }

    fn motion(&self) -> Motion<'_> {
        Motion {
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
            odd: self.odd,
            omega: OMEGA,
        }
    }
}

fn force_of(law: &dyn Law, motion: &Sampled) -> Result<(Vec<f64>, Marks), LawError> {
    let samples = motion.displacement.len();
    let mut force = vec![0.0; samples];
    let marks = law.force(&motion.motion(), &mut Workspace::new(samples), &mut force)?;
    Ok((force, marks))
}

/// One-sided harmonics 0..=highest of a sampled signal.
fn harmonics(signal: &[f64], highest: usize) -> Vec<Complex64> {
    let m = signal.len() as f64;
    (0..=highest)
        .map(|k| {
            let sum: Complex64 =
                signal.iter().enumerate().map(|(j, f)| f * Complex64::cis(-TAU * (k * j) as f64 / m)).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / m
        })
        .collect()
}

/// A loop like a Dahl model's: odd, rounded, passive.
fn odd_loop() -> Loop {
    let first = Complex64::from_polar(12.0, PI + PhaseLaw::default().value(1.0));
    Loop::new(
        8e-6,
        vec![
            Complex64::ZERO,
            first,
            Complex64::ZERO,
            Complex64::new(0.6, 2.3),
            Complex64::ZERO,
            Complex64::new(0.3, 0.8),
            Complex64::ZERO,
            Complex64::new(0.1, 0.3),
        ],
    )
    .unwrap()
}

fn uneven_loop() -> Loop {
    let mut coefficients = odd_loop().coefficients().to_vec();
    coefficients[2] = Complex64::new(0.4, 0.3);
    coefficients[4] = Complex64::new(-0.1, 0.1);
    Loop::new(8e-6, coefficients).unwrap()
}

fn scaled(measured: &Loop) -> ScaledLoop {
    ScaledLoop::new(measured, 0.0, MagnitudeLaw::default(), PhaseLaw::default(), Symmetry::Auto).unwrap()
}

fn jenkins() -> ElasticCoulomb {
    ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 6.7e6, slip_force: 15.0 }).unwrap()
}

/// Velocities of [`motions`] are a few times its own.
fn coulomb() -> Coulomb {
    Coulomb::new(CoulombParameters { slip_force: 12.0, velocity: 5e-4 }).unwrap()
}

fn laws() -> Vec<Box<dyn Law>> {
    vec![
        Box::new(scaled(&odd_loop())),
        Box::new(scaled(&uneven_loop())),
        Box::new(family::odd_family()),
        Box::new(family::uneven_family()),
        Box::new(jenkins()),
        Box::new(iwan::logarithmic(10.0)),
        Box::new(iwan::logarithmic(0.2)),
        Box::new(iwan::polygon()),
        Box::new(coulomb()),
        Box::new(gap::gap(0.3e-6)),
        Box::new(Cubic::new(CubicParameters { stiffness: 1e16 }).unwrap()),
        Box::new(Linear::new(LinearParameters { stiffness: 3e5 }).unwrap()),
    ]
}

fn complex(re: f64, im: f64) -> Complex64 {
    Complex64::new(re, im)
}

/// Motions in units of 1e-6 m: plain, with sharp corners, with interior reversals, with mean and even harmonics.
fn motions() -> Vec<Vec<Complex64>> {
    let um = |list: &[(usize, f64, f64)]| {
        let highest = list.iter().map(|(k, ..)| *k).max().unwrap_or(0);
        let mut spectrum = vec![Complex64::ZERO; highest + 1];
        for &(k, re, im) in list {
            spectrum[k] = complex(re * 1e-6, im * 1e-6);
        }
        spectrum
    };
    vec![
        um(&[(1, 4.0, 1.0)]),
        um(&[(1, 4.0, 1.0), (3, 0.3, -0.2)]),
        um(&[(1, 3.0, 0.5), (3, 1.5, 1.9)]),
        um(&[(1, 1.0, 0.5), (3, 1.5, 1.9), (5, 0.8, -1.0), (7, 0.9, 0.1)]),
        um(&[(0, 1.0, 0.0), (1, 4.0, 1.0), (2, 0.5, 0.1)]),
        um(&[(0, -3.0, 0.0), (1, 2.0, 1.0), (2, 1.5, -0.7), (3, 1.1, 0.4), (5, 0.9, 1.3)]),
        um(&[(1, 1.0, -0.2)]),
        um(&[(0, 0.7, 0.0), (1, 0.9, -0.2), (2, 0.1, 0.1)]),
    ]
}

/// δf at every sample by the tangent, for a change of one harmonic.
fn predicted_samples(law: &dyn Law, motion: &Sampled, k: usize, change: Complex64) -> Vec<f64> {
    let samples = motion.displacement.len();
    let mut workspace = Workspace::new(samples);
    law.force(&motion.motion(), &mut workspace, &mut vec![0.0; samples]).unwrap();
    let tangent: &Tangent = law.tangent(&motion.motion(), &mut workspace);
    let delta = |tau: f64| (change * Complex64::cis(k as f64 * tau)).re;
    let delta_rate = |tau: f64| (change * complex(0.0, k as f64) * Complex64::cis(k as f64 * tau)).re;
    let recalled = |recall: Recall| match recall {
        Recall::Displacement { tau } => delta(tau),
        Recall::Velocity { tau } => delta_rate(tau),
        Recall::Mean if k == 0 => change.re,
        Recall::Mean => 0.0,
    };
    (0..samples)
        .map(|j| {
            let memories =
                tangent.memories().iter().map(|memory| memory.influence[j] * recalled(memory.recall));
            let tau = TAU * j as f64 / samples as f64;
            let rate = tangent.rate().map_or(0.0, |c| c[j] * delta_rate(tau));
            tangent.local[j] * delta(tau) + rate + memories.sum::<f64>()
        })
        .collect()
}

/// Change of the force spectrum by the tangent, for a change of one harmonic.
fn predicted(law: &dyn Law, motion: &Sampled, k: usize, change: Complex64, highest: usize) -> Vec<Complex64> {
    harmonics(&predicted_samples(law, motion, k, change), highest)
}

#[test]
fn derivatives_agree_with_central_differences() {
    let samples = 256;
    for law in laws() {
        for spectrum in motions() {
            let motion = Sampled::new(&spectrum, samples);
            let step = if motion.odd { 2 } else { 1 };
            let first = if motion.odd { 1 } else { 0 };
            for k in (first..spectrum.len() + 2).step_by(step) {
                for direction in [complex(1.0, 0.0), complex(0.0, 1.0)] {
                    if k == 0 && direction.im != 0.0 {
                        continue;
                    }
                    // A sample that a tip passes changes from the stiff side to the soft one, an error of order h; an
                    // Iwan law's stiffness at its tips is that of sticking, here of order 1e7 N/m.
                    let (h, least) = if law.name() == "iwan" { (4e-13, 1e6) } else { (1e-11, 1e5) };
                    let moved = |sign: f64| {
                        let mut s = spectrum.clone();
                        s.resize(s.len().max(k + 1), Complex64::ZERO);
                        s[k] += direction * (sign * h);
                        harmonics(&force_of(&*law, &Sampled::new(&s, samples)).unwrap().0, 9)
                    };
                    let (up, down) = (moved(1.0), moved(-1.0));
                    let exact = predicted(&*law, &motion, k, direction, 9);
                    let scale = exact.iter().map(|c| c.norm()).fold(least, f64::max);
                    for p in 0..=9 {
                        let difference = (up[p] - down[p]) / (2.0 * h);
                        let error = (difference - exact[p]).norm() / scale;
                        assert!(
                            error < 1e-7,
                            "{} at {spectrum:?}: dF_{p}/dW_{k} {direction}: {difference} by differences, {} exact ({error:.1e})",
                            law.name(),
                            exact[p]
                        );
                    }
                }
            }
        }
    }
}

/// The path of a motion whose harmonic `k` carries an infinitesimal change.
struct DualPath<'a> {
    motion: &'a Sampled,
    tips: &'a TurningPoints,
    k: usize,
    change: Complex64,
}

impl DualPath<'_> {
    fn dual(&self, value: f64, tau: f64) -> Dual64 {
        Dual64::new(value, (self.change * Complex64::cis(self.k as f64 * tau)).re)
    }

    fn tau(&self, j: usize) -> f64 {
        TAU * j as f64 / self.motion.displacement.len() as f64
    }
}

impl Path<Dual64> for DualPath<'_> {
    fn count(&self) -> usize {
        self.tips.points().len()
    }

    fn lowest(&self) -> usize {
        self.tips.lowest()
    }

    fn tip(&self, r: usize) -> Dual64 {
        let point = self.tips.points()[r % self.count()];
        self.dual(point.displacement, point.tau)
    }

    fn first_sample(&self, r: usize) -> usize {
        let samples = self.motion.displacement.len();
        let whole = if r == self.count() { samples } else { 0 };
        whole + (self.tips.points()[r % self.count()].tau * samples as f64 / TAU).ceil() as usize
    }

    fn sample(&self, j: usize) -> Dual64 {
        self.dual(self.motion.displacement[j], self.tau(j))
    }

    fn distance(&self, j: usize, r: usize) -> Dual64 {
        let distance = self.sample(j) - self.tip(r);
        if distance.re < 0.0 { -distance } else { distance }
    }
}

fn turning_points(motion: &Sampled) -> TurningPoints {
    let mut tips = TurningPoints::default();
    tips.find(&motion.motion()).unwrap();
    tips
}

#[test]
fn derivatives_agree_with_dual_numbers() {
    let samples = 256;
    let jenkins = jenkins();
    let loops = [scaled(&odd_loop()), scaled(&uneven_loop())];
    for spectrum in motions() {
        let motion = Sampled::new(&spectrum, samples);
        let tips = turning_points(&motion);
        for k in (0..spectrum.len() + 2).filter(|k| !motion.odd || k % 2 == 1) {
            for change in [complex(1.0, 0.0), complex(0.0, 1.0)] {
                if k == 0 && change.im != 0.0 {
                    continue;
                }
                let path = DualPath { motion: &motion, tips: &tips, k, change };
                let creeping = coulomb();
                let exact = predicted_samples(&creeping, &motion, k, change);
                for (j, tangent) in exact.iter().enumerate() {
                    let by = (change * complex(0.0, k as f64) * Complex64::cis(k as f64 * path.tau(j))).re;
                    let dual = creeping.friction(Dual64::new(OMEGA * motion.velocity[j], OMEGA * by));
                    assert!((dual.eps - tangent).abs() < 1e-9 * 1e6, "sample {j}: {} {tangent}", dual.eps);
                }
                let zero = Dual64::new(0.0, 0.0);
                let mut force = vec![zero; samples];
                let check = |law: &dyn Law, force: &[Dual64]| {
                    let exact = predicted_samples(law, &motion, k, change);
                    let scale = exact.iter().fold(1e5, |top: f64, s| top.max(s.abs()));
                    for (j, (dual, tangent)) in force.iter().zip(&exact).enumerate() {
                        // A sample on a tip has no dual derivative (√0); there the limit is checked by differences.
                        let at_tip = tips.points().iter().any(|tip| {
                            let delta = path.tau(j) - tip.tau;
                            (delta - TAU * (delta / TAU).round()).abs() < 1e-3
                        });
                        assert!(
                            at_tip || (dual.eps - tangent).abs() < 1e-9 * scale,
                            "{} at {spectrum:?}, sample {j}: {} dual, {tangent} tangent",
                            law.name(),
                            dual.eps
                        );
                    }
                };
                if tips.amplitude() > jenkins.slip_displacement() {
                    jenkins.trace(&path, &mut force, &mut Vec::new());
                    check(&jenkins, &force);
                }
                let a = (path.tip(0) - path.tip(tips.lowest())) * 0.5;
                let mut trace = |law: &dyn Law, coefficients: &[(Complex64, Complex64)]| {
                    let mut curve = crate::loop_curve::LoopCurve::new();
                    let dual = |(c, growth): &(Complex64, Complex64)| Complex {
                        re: Dual64::new(c.re, growth.re * a.eps),
                        im: Dual64::new(c.im, growth.im * a.eps),
                    };
                    curve.set(coefficients.iter().map(dual), law.nature().odd);
                    crate::masing::Masing::new().trace(&curve, &path, a, &mut force);
                    check(law, &force);
                };
                for law in &loops {
                    let (first, derivative) = law.first(tips.amplitude() / law.reference_displacement());
                    let growth = derivative / law.reference_displacement();
                    let both: Vec<_> = law.coefficients(first).zip(law.coefficients(growth)).collect();
                    trace(law, &both);
                }
                for law in [family::odd_family(), family::uneven_family()] {
                    trace(&law, &law.harmonics(tips.amplitude()).collect::<Vec<_>>());
                }
                let mid = (path.tip(0) + path.tip(tips.lowest())) * 0.5;
                let mean = Dual64::new(spectrum[0].re, if k == 0 { change.re } else { 0.0 });
                for law in [iwan::logarithmic(10.0), iwan::logarithmic(0.2), iwan::polygon()] {
                    let stack = crate::backbone::Stack::new(law.curve(), a, mid, mean);
                    crate::masing::Masing::new().trace(&stack, &path, a, &mut force);
                    check(&law, &force);
                }
            }
        }
    }
}

/// Eqs (6)–(9) written down again, in rig convention (the force on the mass is the negative).
fn paper(w: Complex64, displacement: f64, force: f64) -> Complex64 {
    let alpha = w.norm() / displacement;
    let magnitude = force * (0.98 + 0.21 * (alpha + 0.01).ln());
    let psi = -FRAC_PI_2 - 7.0 / 15.0 * PI * (-4.0 * alpha).exp();
    -magnitude * Complex64::cis(psi + w.arg())
}

#[test]
fn one_harmonic_is_the_papers_law() {
    let samples = 128;
    for law in [scaled(&odd_loop()), scaled(&uneven_loop())] {
        for i in -24..=24 {
            let alpha = 10.0_f64.powf(f64::from(i) / 4.0);
            // Phases that put samples on the tips, next to them, and anywhere.
            for phase in [0.0, FRAC_PI_2, TAU / 128.0 * 5.0, 1e-9, -3e-7, 0.3, 2.0, -1.1] {
                let w = Complex64::from_polar(alpha * 8e-6, phase);
                let motion = Sampled::new(&[Complex64::ZERO, w], samples);
                let first = harmonics(&force_of(&law, &motion).unwrap().0, 1)[1];
                let expected = paper(w, 8e-6, 12.0);
                let error = (first - expected).norm() / expected.norm();
                assert!(error < 1e-12, "α = {alpha:e}, phase {phase}: {error:e}");
                let closed = law.describing_function().unwrap().first_harmonic(w.norm()).force * w / w.norm();
                let error = (closed - expected).norm() / expected.norm();
                assert!(error < 1e-13, "α = {alpha:e}, phase {phase}: closed form {error:e}");
            }
        }
    }
}

/// ∮ f dw over a period, from the spectra: π Σ k Im(F_k conj W_k).
fn work(motion: &Sampled, force: &[f64]) -> f64 {
    let f = harmonics(force, motion.spectrum.len() - 1);
    motion.spectrum.iter().zip(f).enumerate().map(|(k, (w, f))| PI * k as f64 * (f * w.conj()).im).sum()
}

#[test]
fn dissipation_is_the_area_of_the_loop() {
    let a = 5e-6;
    let motion = Sampled::new(&[Complex64::ZERO, Complex64::from_polar(a, 0.7)], 4096);
    // Loop law: π a Im c_1. Trapezoid over w of the force at the samples is a second way to the same area.
    let law = scaled(&odd_loop());
    let force = force_of(&law, &motion).unwrap().0;
    let closed = PI * a * (12.0 * law_magnitude(a / 8e-6)) * (PI + law_phase(a / 8e-6)).sin();
    assert!((work(&motion, &force) / closed - 1.0).abs() < 1e-12);
    let area: f64 = (0..4096)
        .map(|j| {
            let next = (j + 1) % 4096;
            0.5 * (force[j] + force[next]) * (motion.displacement[next] - motion.displacement[j])
        })
        .sum();
    assert!((area / closed - 1.0).abs() < 2e-5, "{area} {closed}");
    // Elastic Coulomb: the parallelogram 4 F_s (A − x_c).
    let law = jenkins();
    let force = force_of(&law, &motion).unwrap().0;
    let closed = 4.0 * law.slip_force() * (a - law.slip_displacement());
    assert!((work(&motion, &force) / closed - 1.0).abs() < 2e-6);
    // Elastic laws give everything back.
    for law in laws().iter().filter(|law| matches!(law.name(), "cubic" | "linear")) {
        let force = force_of(&**law, &motion).unwrap().0;
        let size = force.iter().fold(0.0_f64, |top, f| top.max(f.abs()));
        assert!(work(&motion, &force).abs() < 1e-13 * size * a);
    }
}

fn law_magnitude(alpha: f64) -> f64 {
    0.98 + 0.21 * (alpha + 0.01).ln()
}

fn law_phase(alpha: f64) -> f64 {
    -FRAC_PI_2 - 7.0 / 15.0 * PI * (-4.0 * alpha).exp()
}

#[test]
fn limits_of_the_laws() {
    // α → 0: the holding force F* g(0), almost elastic.
    let law = scaled(&odd_loop());
    let rest = law.describing_function().unwrap().at_rest();
    assert!((rest.norm() / 12.0 - 0.012_914).abs() < 1e-6, "{}", rest.norm());
    assert!((rest.arg() - PI / 30.0).abs() < 1e-14);
    assert!((law.holding_force() - rest.norm()).abs() < 1e-15);
    // α → ∞: a damper, force in quadrature.
    let far = law.describing_function().unwrap().first_harmonic(8.0).force;
    assert!((far.arg() - FRAC_PI_2).abs() < 1e-14);
    // Elastic Coulomb: a spring up to x_c, then towards the rectangle's 4 F_s / π in quadrature.
    let law = jenkins();
    let describing = law.describing_function().unwrap();
    let xc = law.slip_displacement();
    let below = describing.first_harmonic(xc * (1.0 - 1e-9));
    let above = describing.first_harmonic(xc * (1.0 + 1e-9));
    assert!((below.force - above.force).norm() < 1e-8 * law.slip_force());
    assert_eq!(below.derivative, Complex64::from(law.stiffness()));
    let far = describing.first_harmonic(xc * 1e9).force;
    assert!((far - complex(0.0, 4.0 / PI * law.slip_force())).norm() < 1e-3 * law.slip_force());
    // Regularised Coulomb: slow motion sees the damper F_s/v, fast motion the rectangle 4 F_s a.
    let creeping = coulomb();
    let area = |a: f64| {
        let motion = Sampled::new(&[Complex64::ZERO, complex(a, 0.0)], 1 << 12);
        work(&motion, &force_of(&creeping, &motion).unwrap().0)
    };
    let slow = PI * creeping.slip_force() / creeping.velocity() * OMEGA * 1e-12_f64.powi(2);
    assert!((area(1e-12) / slow - 1.0).abs() < 1e-9);
    assert!((area(1e-3) / (4.0 * creeping.slip_force() * 1e-3) - 1.0).abs() < 1e-5);
    // In time, across the limit between stick and slip.
    for (a, state) in [(xc * (1.0 - 1e-9), ContactState::Stick), (xc * (1.0 + 1e-9), ContactState::Mixed)] {
        let motion = Sampled::new(&[Complex64::ZERO, complex(a, 0.0)], 64);
        let (force, marks) = force_of(&law, &motion).unwrap();
        assert_eq!(marks.state, state);
        for (f, w) in force.iter().zip(&motion.displacement) {
            assert!((f - law.stiffness() * w).abs() < 1e-8 * law.slip_force());
        }
    }
}

#[test]
fn describing_functions_are_the_first_harmonic_in_time() {
    for law in laws() {
        let Some(describing) = law.describing_function() else {
            assert!(matches!(law.name(), "coulomb" | "gap"));
            continue;
        };
        for a in [1e-7, 2e-6, 2.3e-6, 9e-6, 1e-4] {
            let motion = Sampled::new(&[Complex64::ZERO, complex(a, 0.0)], 1 << 13);
            let in_time = harmonics(&force_of(&*law, &motion).unwrap().0, 1)[1];
            let closed = describing.first_harmonic(a);
            let error = (in_time - closed.force).norm() / closed.force.norm();
            // Kinks leave an error of order M⁻², bends (at the tips of an Iwan law) one of order M⁻³.
            let tolerance = match law.name() {
                "elastic_coulomb" | "iwan" => 1e-6,
                _ => 1e-12,
            };
            assert!(error < tolerance, "{} {a}: {error:e}", law.name());
            let h = 1e-5 * a;
            let difference =
                (describing.first_harmonic(a + h).force - describing.first_harmonic(a - h).force) / (2.0 * h);
            let size = closed.derivative.norm() + closed.force.norm() / a;
            assert!((difference - closed.derivative).norm() < 1e-8 * size, "{} {a}", law.name());
        }
    }
}

#[test]
fn the_sampling_error_of_kinks_falls_with_the_square_of_the_samples() {
    let law = jenkins();
    let closed = law.describing_function().unwrap().first_harmonic(7e-6).force;
    // Averaged over alignments of the samples, which move the error up and down.
    let error = |samples: usize| -> f64 {
        (0..16)
            .map(|shift| {
                let turn = Complex64::cis(0.37 * f64::from(shift));
                let motion = Sampled::new(&[Complex64::ZERO, 7e-6 * turn], samples);
                (harmonics(&force_of(&law, &motion).unwrap().0, 1)[1] / turn - closed).norm()
            })
            .sum()
    };
    let rate = (error(64) / error(1024)).log2() / 4.0;
    assert!((rate - 2.0).abs() < 0.2, "{rate}");
}

/// Largest change of the first force harmonics when the motion changes from `from` to `to`.
fn jump(law: &dyn Law, from: &[Complex64], to: &[Complex64]) -> f64 {
    let force =
        |spectrum: &[Complex64]| harmonics(&force_of(law, &Sampled::new(spectrum, 512)).unwrap().0, 9);
    force(from).iter().zip(force(to)).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn the_force_is_continuous_where_extremes_tie() {
    // Two equal maxima in a period; which of them is the global one changes with the sign of a small term.
    let base = |small: f64| {
        vec![
            Complex64::ZERO,
            complex(4e-6, 0.0),
            Complex64::ZERO,
            complex(-3e-6, 0.0),
            Complex64::ZERO,
            complex(0.0, small),
        ]
    };
    let odd = scaled(&odd_loop());
    let (family, uneven) = (family::odd_family(), family::uneven_family());
    let stacks = (iwan::logarithmic(10.0), iwan::polygon());
    for law in [&odd as &dyn Law, &scaled(&uneven_loop()), &jenkins(), &family, &uneven, &stacks.0, &stacks.1]
    {
        let plus = Sampled::new(&base(1e-15), 512);
        assert!(turning_points(&plus).points().len() >= 6, "no interior reversals: the tie means nothing");
        // The change of the force vanishes with the change of motion; as its root, since a rounded loop is vertical at
        // its tips. (A rule without memory jumps by about F* = 12 N whatever the change.)
        for small in [1e-11, 1e-13, 1e-15] {
            let change = jump(law, &base(small), &base(-small));
            assert!(change < 50.0 * (small / 4e-6).sqrt(), "{}: {change} at {small}", law.name());
        }
    }
}

#[test]
fn the_force_is_continuous_where_turning_points_appear() {
    // cos τ + b cos 3τ: an inflection at its zeros becomes a pair of turning points when b passes −1/3 … in sin form:
    // w' = −sin τ − 3 b sin 3τ has further zeros once b > 1/3 at τ = π/2.
    let wave = |b: f64| vec![Complex64::ZERO, complex(4e-6, 0.0), Complex64::ZERO, complex(4e-6 * b, 0.0)];
    let count = |b: f64| turning_points(&Sampled::new(&wave(b), 512)).points().len();
    assert_eq!((count(1.0 / 3.0 - 1e-6), count(1.0 / 3.0 + 1e-6)), (2, 6));
    let (family, uneven) = (family::odd_family(), family::uneven_family());
    let stacks = (iwan::logarithmic(10.0), iwan::polygon());
    for law in [
        &scaled(&odd_loop()) as &dyn Law,
        &scaled(&uneven_loop()),
        &jenkins(),
        &family,
        &uneven,
        &stacks.0,
        &stacks.1,
    ] {
        for size in [1e-6, 1e-8] {
            let change = jump(law, &wave(1.0 / 3.0 - size), &wave(1.0 / 3.0 + size));
            assert!(change < 12.0 * 30.0 * size, "{}: {change} at {size}", law.name());
        }
    }
}

#[test]
fn a_minor_loop_closes_and_is_forgotten() {
    // With minor loops the force still reaches the tips' values, and dissipation stays positive.
    let law = scaled(&odd_loop());
    let spectrum = &motions()[3];
    let motion = Sampled::new(spectrum, 4096);
    let tips = turning_points(&motion);
    assert!(tips.points().len() > 4);
    let (force, _) = force_of(&law, &motion).unwrap();
    let alpha = tips.amplitude() / 8e-6;
    let (first, _) = law.first(alpha);
    let top: f64 = law.coefficients(first).map(|c| c.re).sum();
    let peak = force.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
    // Samples miss the tip by at most half a step.
    let at_tip = force[(tips.points()[0].tau / TAU * 4096.0).round() as usize % 4096];
    assert!((at_tip - top).abs() < 0.05 * top.abs(), "{at_tip} {top}");
    assert!(peak < 1.5 * 12.0);
    assert!(work(&motion, &force) > 0.0);
}

#[test]
fn nothing_moves() {
    for law in laws() {
        let still = Sampled::new(&[complex(1e-6, 0.0), Complex64::ZERO], 64);
        let answer = force_of(&*law, &still);
        match law.name() {
            "scaled_loop" => assert_eq!(answer.unwrap_err(), LawError::NoMotion),
            "elastic_coulomb" | "loop_family" | "coulomb" => {
                assert!(answer.unwrap().0.iter().all(|f| *f == 0.0))
            }
            _ => assert!(answer.unwrap().0.iter().all(|f| *f > 0.0)),
        }
    }
    let broken = Sampled::new(&[Complex64::ZERO, complex(f64::NAN, 0.0)], 64);
    assert_eq!(force_of(&jenkins(), &broken).unwrap_err(), LawError::NotFinite);
}

#[test]
fn a_falling_magnitude_law_is_refused_where_it_turns_negative() {
    let falling = MagnitudeLaw { offset: 1.0, slope: -0.2, shift: 1.0 };
    let law = ScaledLoop::ellipse(8e-6, 12.0, falling, PhaseLaw::default()).unwrap();
    let motion = |alpha: f64| Sampled::new(&[Complex64::ZERO, complex(alpha * 8e-6, 0.0)], 64);
    assert!(force_of(&law, &motion(100.0)).is_ok());
    assert!(matches!(force_of(&law, &motion(1000.0)).unwrap_err(), LawError::NegativeMagnitude { .. }));
}

#[test]
fn extrapolation_is_flagged_beyond_the_measured_amplitude() {
    let law = scaled(&odd_loop());
    let marks = |a: f64| force_of(&law, &Sampled::new(&[Complex64::ZERO, complex(a, 0.0)], 64)).unwrap().1;
    assert!(!marks(8e-6).extrapolated);
    assert!(marks(8.01e-6).extrapolated);
}

proptest! {
    /// Turning points come from the spectrum: neither the number of samples nor their alignment matters.
    #[test]
    fn turning_points_do_not_depend_on_samples(
        parts in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 5),
        shift in 0.0..TAU,
    ) {
        let spectrum: Vec<Complex64> = std::iter::once(Complex64::ZERO)
            .chain(parts.iter().enumerate().map(|(i, &(re, im))| complex(re, im) / (i + 1) as f64))
            .collect();
        let shifted: Vec<Complex64> =
            spectrum.iter().enumerate().map(|(k, c)| c * Complex64::cis(k as f64 * shift)).collect();
        let reference = turning_points(&Sampled::new(&spectrum, 1024));
        let moved = turning_points(&Sampled::new(&shifted, 96));
        prop_assert!((reference.amplitude() - moved.amplitude()).abs() < 1e-13);
        prop_assert_eq!(reference.points().len(), moved.points().len());
        for (a, b) in reference.points().iter().zip(moved.points()) {
            prop_assert!((a.displacement - b.displacement).abs() < 1e-13);
            prop_assert!(a.acceleration * b.acceleration > 0.0 || a.acceleration.abs() < 1e-6);
        }
    }

    /// Friction never creates energy, and turning the motion in time turns the force with it.
    #[test]
    fn friction_dissipates_whatever_the_motion(
        parts in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 4),
        size in -8.0..-4.0_f64,
    ) {
        let size = 10.0_f64.powf(size);
        let spectrum: Vec<Complex64> = std::iter::once(Complex64::ZERO)
            .chain(parts.iter().enumerate().map(|(i, &(re, im))| complex(re, im) * (size / (i + 1) as f64)))
            .collect();
        let motion = Sampled::new(&spectrum, 2048);
        let (stack, family) = (iwan::logarithmic(10.0), family::odd_family());
        for law in [&scaled(&odd_loop()) as &dyn Law, &jenkins(), &coulomb(), &stack, &family] {
            let (force, _) = force_of(law, &motion).unwrap();
            let peak = force.iter().fold(0.0_f64, |top, f| top.max(f.abs()));
            prop_assert!(work(&motion, &force) > -1e-6 * peak * size, "{}", law.name());
        }
    }
}
