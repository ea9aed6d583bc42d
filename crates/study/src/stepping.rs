//! What one does without any of this: step through time until the motion repeats.
//!
//! Newmark's method with average acceleration (β = ¼, γ = ½: second order, no numerical damping) at fixed steps a
//! period, Newton's method in each step, and sliders followed by return mapping: a slider's spring force is moved by its
//! stiffness times the step and cut at its slip force. From rest, until two periods are alike.

use std::collections::HashMap;
use std::f64::consts::TAU;

use contact::{ElasticCoulomb, Mechanism, SmoothForce};
use faer::Mat;
use faer::linalg::solvers::Solve;
use num_complex::Complex64;
use orbit::System;
use rustfft::FftPlanner;
use thiserror::Error;

/// How time is stepped through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteppingSettings {
    /// Steps a period.
    pub steps: usize,
    /// Relative rms difference of two periods at which the motion counts as periodic.
    pub tolerance: f64,
    /// Periods after which it is given up.
    pub most_periods: usize,
}

/// One period of the motion that was reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Stepped {
    /// Displacement in m at the ends of the steps t = h, 2h, …, T; entry `[step][dof]`.
    pub displacement: Vec<Vec<f64>>,
    /// Periods that were stepped through.
    pub periods: usize,
    /// Newton steps, all time steps together.
    pub iterations: usize,
}

/// Why no periodic motion was reached.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SteppingError {
    /// The law of a contact cannot be followed in time.
    #[error("contact \"{contact}\" cannot be followed in time: {why}")]
    NoMechanism {
        /// Name of the contact.
        contact: String,
        /// Why.
        why: &'static str,
    },
    /// Not even after the most periods allowed.
    #[error("the motion does not repeat after {periods} periods")]
    NotPeriodic {
        /// Periods that were stepped through.
        periods: usize,
    },
    /// Newton's method failed in a step.
    #[error("no equilibrium in a step of period {period}")]
    NoEquilibrium {
        /// Period of the step.
        period: usize,
    },
    /// No step, or no frequency.
    #[error("needs a positive frequency and at least four steps a period")]
    NoSteps,
}

/// Newton steps in one time step.
const MOST_ITERATIONS: usize = 50;
/// Change relative to the largest displacement at which a step is in equilibrium.
const EQUILIBRIUM: f64 = 1e-12;

/// Steps through time from rest until the motion repeats.
///
/// # Errors
/// [`SteppingError`] when it does not, or when a contact cannot be followed.
pub fn step_until_periodic(
    system: &System,
    hertz: f64,
    settings: &SteppingSettings,
) -> Result<Stepped, SteppingError> {
    if !(hertz > 0.0 && hertz.is_finite()) || settings.steps < 4 {
        return Err(SteppingError::NoSteps);
    }
    let mut stepper = Stepper::new(system, hertz, settings.steps)?;
    let mut before: Vec<Vec<f64>> = Vec::new();
    for period in 1..=settings.most_periods {
        let mut now = Vec::with_capacity(settings.steps);
        for step in 1..=settings.steps {
            if !stepper.step(step) {
                return Err(SteppingError::NoEquilibrium { period });
            }
            now.push(stepper.displacement.clone());
        }
        if alike(&before, &now, settings.tolerance) {
            return Ok(Stepped { displacement: now, periods: period, iterations: stepper.iterations });
        }
        before = now;
    }
    Err(SteppingError::NotPeriodic { periods: settings.most_periods })
}

/// Whether two periods differ by less than `tolerance` in every dof, relative to the largest.
fn alike(before: &[Vec<f64>], now: &[Vec<f64>], tolerance: f64) -> bool {
    let pairs = || before.iter().flatten().zip(now.iter().flatten());
    let difference: f64 = pairs().map(|(a, b)| (a - b) * (a - b)).sum();
    let size: f64 = now.iter().flatten().map(|w| w * w).sum();
    before.len() == now.len() && difference <= tolerance * tolerance * size
}

impl Stepped {
    /// `W_0 … W_highest` of a dof in m, one-sided, at most up to a quarter of the steps; beyond, samples say nothing.
    pub fn spectrum(&self, dof: usize, highest: usize) -> Vec<Complex64> {
        let count = self.displacement.len();
        // The last sample is that of t = T, which is that of t = 0.
        let last = self.displacement.last().into_iter();
        let from_zero = last.chain(self.displacement.iter().take(count.saturating_sub(1)));
        let value = |row: &Vec<f64>| Complex64::new(row.get(dof).copied().unwrap_or(0.0), 0.0);
        let mut samples: Vec<Complex64> = from_zero.map(value).collect();
        FftPlanner::new().plan_fft_forward(count).process(&mut samples);
        let factor = |k: usize| if k == 0 { 1.0 } else { 2.0 } / count as f64;
        samples.iter().take(highest.min(count / 4) + 1).enumerate().map(|(k, w)| w * factor(k)).collect()
    }
}

/// A spring with a slider, and where it stands.
struct Slider<'a> {
    law: &'a ElasticCoulomb,
    /// Spring force in N at the end of the last step.
    force: f64,
}

/// What a contact adds to the equations.
enum Element<'a> {
    Sliders { sliders: Vec<Slider<'a>>, spring: f64 },
    Smooth(&'a dyn SmoothForce),
}

struct Link<'a> {
    first: usize,
    second: Option<usize>,
    scale: f64,
    element: Element<'a>,
}

struct Stepper<'a> {
    system: &'a System,
    links: Vec<Link<'a>>,
    /// Ωh and h.
    angle: f64,
    h: f64,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    /// Largest displacement so far.
    largest: f64,
    /// 4/h² M + 2/h D + C.
    effective: Mat<f64>,
    /// Inverse tangents by which sliders stick; laws that bend have a new one in each iteration.
    inverses: HashMap<Vec<bool>, Mat<f64>>,
    smooth: bool,
    iterations: usize,
}

impl<'a> Stepper<'a> {
    fn new(system: &'a System, hertz: f64, steps: usize) -> Result<Self, SteppingError> {
        let mut links = Vec::new();
        for contact in &system.contacts {
            let element = match contact.law.mechanism() {
                Mechanism::Sliders { sliders, spring } => {
                    let sliders = sliders.iter().map(|law| Slider { law, force: 0.0 }).collect();
                    Element::Sliders { sliders, spring }
                }
                Mechanism::Smooth(force) => Element::Smooth(force),
                Mechanism::Unilateral(_) => {
                    let why = "time stepping knows no contact that opens";
                    return Err(SteppingError::NoMechanism { contact: contact.name.clone(), why });
                }
                Mechanism::None { why } => {
                    return Err(SteppingError::NoMechanism { contact: contact.name.clone(), why });
                }
            };
            links.push(Link { first: contact.first, second: contact.second, scale: contact.scale, element });
        }
        if let Some(joint) = system.joints.first() {
            let why = "time stepping knows no contact in several directions";
            return Err(SteppingError::NoMechanism { contact: joint.name.clone(), why });
        }
        let n = system.mass.nrows();
        let h = 1.0 / (hertz * steps as f64);
        let (m, d, c) = (&system.mass, &system.damping, &system.stiffness);
        let entry = |i: usize, j: usize| 4.0 / (h * h) * m[(i, j)] + 2.0 / h * d[(i, j)] + c[(i, j)];
        let mut stepper = Self {
            system,
            smooth: links.iter().any(|link| matches!(link.element, Element::Smooth(_))),
            links,
            angle: TAU / steps as f64,
            h,
            displacement: vec![0.0; n],
            velocity: vec![0.0; n],
            acceleration: vec![0.0; n],
            largest: f64::MIN_POSITIVE,
            effective: Mat::from_fn(n, n, entry),
            inverses: HashMap::new(),
            iterations: 0,
        };
        let load = stepper.load(0);
        let start = system.mass.partial_piv_lu().solve(&load);
        stepper.acceleration = (0..n).map(|i| start[(i, 0)]).collect();
        Ok(stepper)
    }

    /// Loads at the end of step number `step` of a period.
    fn load(&self, step: usize) -> Mat<f64> {
        let mut load = Mat::zeros(self.displacement.len(), 1);
        for part in &self.system.loads {
            let wave = Complex64::cis(part.harmonic as f64 * step as f64 * self.angle);
            load[(part.dof, 0)] += (part.amplitude * wave).re;
        }
        load
    }

    /// Velocity and acceleration at the end of a step to `next`, by average acceleration.
    fn rates(&self, next: &[f64], velocity: &mut [f64], acceleration: &mut [f64]) {
        let h = self.h;
        let before = self.displacement.iter().zip(&self.velocity).zip(&self.acceleration);
        let after = velocity.iter_mut().zip(acceleration).zip(next);
        for (((w, v), a), ((velocity, acceleration), next)) in before.zip(after) {
            *velocity = 2.0 / h * (next - w) - v;
            *acceleration = 4.0 / (h * h) * (next - w) - 4.0 / h * v - a;
        }
    }

    /// Load minus inertia, damping and stiffness of the structure.
    fn imbalance(&self, load: &Mat<f64>, w: &[f64], v: &[f64], a: &[f64]) -> Mat<f64> {
        let (m, d, c) = (&self.system.mass, &self.system.damping, &self.system.stiffness);
        let inner = |i: usize| -> f64 {
            let motion = w.iter().zip(v).zip(a).enumerate();
            motion.map(|(j, ((w, v), a))| m[(i, j)] * a + d[(i, j)] * v + c[(i, j)] * w).sum()
        };
        Mat::from_fn(w.len(), 1, |i, _| load[(i, 0)] - inner(i))
    }

    /// One step; false when Newton's method finds no equilibrium.
    fn step(&mut self, step: usize) -> bool {
        let load = self.load(step);
        let mut next = self.displacement.clone();
        let (mut velocity, mut acceleration) = (self.velocity.clone(), self.acceleration.clone());
        for _ in 0..MOST_ITERATIONS {
            self.iterations += 1;
            self.rates(&next, &mut velocity, &mut acceleration);
            let residual = self.imbalance(&load, &next, &velocity, &acceleration);
            let change = self.newton(&next, &velocity, residual);
            let mut largest_change = 0.0_f64;
            for (i, w) in next.iter_mut().enumerate() {
                *w += change[(i, 0)];
                largest_change = largest_change.max(change[(i, 0)].abs());
                self.largest = self.largest.max(w.abs());
            }
            if largest_change <= EQUILIBRIUM * self.largest {
                self.rates(&next, &mut velocity, &mut acceleration);
                self.accept(&next);
                (self.displacement, self.velocity, self.acceleration) = (next, velocity, acceleration);
                return true;
            }
        }
        false
    }

    /// Takes the contact forces off `residual` and solves for the change of displacement.
    fn newton(&mut self, next: &[f64], velocity: &[f64], mut residual: Mat<f64>) -> Mat<f64> {
        let mut sticks = Vec::new();
        let mut tangents = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let (w, v) = (link.of(next), link.of(velocity));
            let (force, tangent) = match &link.element {
                Element::Sliders { sliders, spring } => {
                    let moved = w - link.of(&self.displacement);
                    let (mut force, mut tangent) = (spring * w, *spring);
                    for slider in sliders {
                        let (spring_force, stuck) = slider.after(moved);
                        sticks.push(stuck);
                        force += spring_force;
                        tangent += if stuck { slider.law.stiffness() } else { 0.0 };
                    }
                    (force, tangent)
                }
                Element::Smooth(law) => {
                    let (by_w, by_v) = law.slopes(w, v);
                    (law.at(w, v), by_w + 2.0 / self.h * by_v)
                }
            };
            link.add(-force, |dof, part| residual[(dof, 0)] += part);
            tangents.push(link.scale * tangent);
        }
        let matrix = |links: &[Link<'_>]| {
            let mut matrix = self.effective.clone();
            for (link, tangent) in links.iter().zip(&tangents) {
                link.stiffen(*tangent, &mut matrix);
            }
            matrix
        };
        if self.smooth {
            return matrix(&self.links).partial_piv_lu().solve(&residual);
        }
        if let Some(inverse) = self.inverses.get(&sticks) {
            return inverse * &residual;
        }
        let n = residual.nrows();
        let inverse = matrix(&self.links).partial_piv_lu().solve(Mat::<f64>::identity(n, n));
        let change = &inverse * &residual;
        self.inverses.insert(sticks, inverse);
        change
    }

    /// Sliders move to the end of the step.
    fn accept(&mut self, next: &[f64]) {
        for link in &mut self.links {
            let moved = link.of(next) - link.of(&self.displacement);
            if let Element::Sliders { sliders, .. } = &mut link.element {
                for slider in sliders {
                    slider.force = slider.after(moved).0;
                }
            }
        }
    }
}

impl Slider<'_> {
    /// Spring force after a displacement by `moved`, and whether it still sticks.
    fn after(&self, moved: f64) -> (f64, bool) {
        let limit = self.law.slip_force();
        let trial = self.force + self.law.stiffness() * moved;
        (trial.clamp(-limit, limit), trial.abs() < limit)
    }
}

impl Link<'_> {
    /// First minus second.
    fn of(&self, values: &[f64]) -> f64 {
        let at = |dof: usize| values.get(dof).copied().unwrap_or(0.0);
        at(self.first) - self.second.map_or(0.0, at)
    }

    fn add(&self, force: f64, mut add: impl FnMut(usize, f64)) {
        add(self.first, self.scale * force);
        if let Some(second) = self.second {
            add(second, -self.scale * force);
        }
    }

    fn stiffen(&self, tangent: f64, matrix: &mut Mat<f64>) {
        matrix[(self.first, self.first)] += tangent;
        if let Some(second) = self.second {
            matrix[(second, second)] += tangent;
            matrix[(self.first, second)] -= tangent;
            matrix[(second, self.first)] -= tangent;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use scene::Scene;

    use super::*;
    use crate::system::system;

    fn r(law: &str) -> Scene {
        let text = r#"{
            "model": {"dofs": ["w1", "w2"], "mass": [[3.98, 0], [0, 1.27]], "damping": [[24, 0], [0, 24]],
                      "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]},
            "excitation": [{"dof": "w2", "amplitude": 9.1}],
            "contacts": [{"name": "root", "between": ["w1", "ground"], "law": LAW}],
            "frequencies": [75.0]}"#;
        Scene::from_str(&text.replace("LAW", law), Path::new("")).unwrap()
    }

    fn first_harmonic(law: &str, steps: usize) -> Complex64 {
        let settings = SteppingSettings { steps, tolerance: 1e-7, most_periods: 1000 };
        step_until_periodic(&system(r(law).problem().unwrap(), 75.0), 75.0, &settings).unwrap().spectrum(0, 1)
            [1]
    }

    /// Of w1 in m, from two independent computations of the exact orbit.
    const EXACT: Complex64 = Complex64::new(-1.540169485087242e-5, -1.2575632418826357e-5);

    #[test]
    fn steps_approach_the_exact_orbit_with_second_order() {
        let law = r#"{"type": "elastic_coulomb", "stiffness": 6.705e6, "slip_force": 14.96556}"#;
        let error = |steps| (first_harmonic(law, steps) / EXACT - 1.0).norm();
        let [coarse, fine] = [error(64), error(512)];
        assert!(fine < 2e-4, "{fine:e}");
        let order = (coarse / fine).log2() / 3.0;
        assert!((1.7..2.4).contains(&order), "{order}: {coarse:e} {fine:e}");
    }

    #[test]
    fn without_friction_it_is_the_linear_response() {
        // (C − Ω²M + iΩD) W = f̂
        let omega = TAU * 75.0;
        let entry = |stiffness: f64, mass: f64| {
            Complex64::new(stiffness - omega * omega * mass, omega * if mass > 0.0 { 24.0 } else { 0.0 })
        };
        let (a, b, d) = (entry(8.2e5 + 1e5, 3.98), entry(-4.1e5, 0.0), entry(4.1e5, 1.27));
        let exact = -b * 9.1 / (a * d - b * b);
        let law = r#"{"type": "linear", "stiffness": 1e5}"#;
        let error = (first_harmonic(law, 512) / exact - 1.0).norm();
        assert!(error < 2e-4, "{error:e}");
    }

    #[test]
    fn what_cannot_be_followed_says_so() {
        let scene = r(r#"{"type": "scaled_loop", "loop": {"displacement": 8e-6, "force": 12}}"#);
        let system = system(scene.problem().unwrap(), 75.0);
        let settings = SteppingSettings { steps: 64, tolerance: 1e-7, most_periods: 10 };
        let error = step_until_periodic(&system, 75.0, &settings).unwrap_err();
        assert!(error.to_string().contains("root"), "{error}");
        assert_eq!(step_until_periodic(&system, 0.0, &settings), Err(SteppingError::NoSteps));
    }
}
