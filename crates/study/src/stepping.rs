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
                Mechanism::None { why } => {
                    return Err(SteppingError::NoMechanism { contact: contact.name.clone(), why });
                }
            };
            links.push(Link { first: contact.first, second: contact.second, scale: contact.scale, element });
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

    /// One step; false when Newton's method finds no equilibrium.
    fn step(&mut self, step: usize) -> bool {
        let n = self.displacement.len();
        let h = self.h;
        let load = self.load(step);
        let mut next: Vec<f64> = self.displacement.clone();
        let (m, d, c) = (&self.system.mass, &self.system.damping, &self.system.stiffness);
        let mut residual = Mat::zeros(n, 1);
        let mut velocity = vec![0.0; n];
        let mut acceleration = vec![0.0; n];
        for _ in 0..MOST_ITERATIONS {
            self.iterations += 1;
            for i in 0..n {
                let moved = next[i] - self.displacement[i];
                velocity[i] = 2.0 / h * moved - self.velocity[i];
                acceleration[i] = 4.0 / (h * h) * moved - 4.0 / h * self.velocity[i] - self.acceleration[i];
            }
            for i in 0..n {
                let inner: f64 = (0..n)
                    .map(|j| m[(i, j)] * acceleration[j] + d[(i, j)] * velocity[j] + c[(i, j)] * next[j])
                    .sum();
                residual[(i, 0)] = load[(i, 0)] - inner;
            }
            let change = self.newton(&next, &velocity, &mut residual);
            let mut largest_change = 0.0_f64;
            for (i, w) in next.iter_mut().enumerate() {
                *w += change[(i, 0)];
                largest_change = largest_change.max(change[(i, 0)].abs());
                self.largest = self.largest.max(w.abs());
            }
            if largest_change <= EQUILIBRIUM * self.largest {
                self.accept(&next);
                for i in 0..n {
                    let moved = next[i] - self.displacement[i];
                    let velocity = 2.0 / h * moved - self.velocity[i];
                    self.acceleration[i] =
                        4.0 / (h * h) * moved - 4.0 / h * self.velocity[i] - self.acceleration[i];
                    self.velocity[i] = velocity;
                }
                self.displacement = next;
                return true;
            }
        }
        false
    }

    /// Takes the contact forces off `residual` and solves for the change of displacement.
    fn newton(&mut self, next: &[f64], velocity: &[f64], residual: &mut Mat<f64>) -> Mat<f64> {
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
            return matrix(&self.links).partial_piv_lu().solve(&*residual);
        }
        if let Some(inverse) = self.inverses.get(&sticks) {
            return inverse * &*residual;
        }
        let n = residual.nrows();
        let inverse = matrix(&self.links).partial_piv_lu().solve(Mat::<f64>::identity(n, n));
        let change = &inverse * &*residual;
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
