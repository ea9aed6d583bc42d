//! Friction in two tangential directions followed in time without harmonics: the truth where no closed form exists.
//!
//! While the contact slips the direction θ of its force is a state: with r = μN/k_t the slider stands at
//! `s = w − r e(θ)` and moves along the force alone, so that
//!
//! ```text
//! θ' = (ẇ · e⊥)/r,     ẇ · e > ṙ  as long as it slips
//! ```
//!
//! The classical fourth-order Runge–Kutta method takes steps that end at events: no step spans two kinds of motion, and
//! its order is kept. It is repeated until the motion is periodic.

use std::f64::consts::TAU;

use contact::FrictionContactParameters;
use faer::linalg::solvers::DenseSolveCore;
use num_complex::Complex64;
use orbit::System;

/// What the contact does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Apart,
    /// The slider rests there.
    Stick([f64; 2]),
    /// The last state is θ.
    Slip,
}

/// One joint, its normal direction last, on a structure.
pub struct Planar<'a> {
    system: &'a System,
    inverse: faer::Mat<f64>,
    omega: f64,
    kt: f64,
    kn: f64,
    mu: f64,
    at_rest: f64,
    preload: f64,
    mode: Mode,
    /// While it slips, θ is that of the velocity.
    aligned: bool,
    /// (w, ẇ, θ).
    x: Vec<f64>,
    t: f64,
    /// Events that were passed.
    pub events: usize,
}

/// A period: instants and displacements, equidistant from t = 0.
pub struct Period {
    /// Entry `[instant][dof]` in m.
    pub displacement: Vec<Vec<f64>>,
    /// Largest difference from the period before, relative to the largest displacement.
    pub closure: f64,
    /// Periods that were followed.
    pub periods: usize,
}

impl<'a> Planar<'a> {
    /// At rest at t = 0; `parameters` are those of the law of the system's only joint, of scale 1.
    pub fn new(system: &'a System, parameters: &FrictionContactParameters, hertz: f64) -> Self {
        let n = system.mass.nrows();
        let kn = parameters.normal_stiffness;
        let preload = parameters.preload.unwrap_or(0.0);
        let mut planar = Self {
            system,
            inverse: system.mass.partial_piv_lu().inverse(),
            omega: TAU * hertz,
            kt: parameters.tangential_stiffness,
            kn,
            mu: parameters.friction_coefficient,
            at_rest: parameters.gap.map_or(preload, |gap| -kn * gap),
            preload,
            mode: Mode::Apart,
            aligned: false,
            x: vec![0.0; 2 * n + 1],
            t: 0.0,
            events: 0,
        };
        if planar.at_rest > 0.0 {
            planar.mode = Mode::Stick([0.0; 2]);
        }
        planar
    }

    fn along(&self, direction: usize, x: &[f64]) -> f64 {
        self.system.joints[0].directions[direction].iter().map(|&(dof, c)| c * x[dof]).sum()
    }

    /// Tangential displacement (or velocity, from the second half of the state).
    fn tangential(&self, x: &[f64]) -> [f64; 2] {
        [self.along(0, x), self.along(1, x)]
    }

    /// N before it is cut.
    fn pressure(&self, x: &[f64]) -> f64 {
        self.at_rest + self.kn * self.along(2, x)
    }

    fn force(&self, x: &[f64]) -> [f64; 3] {
        let n = self.pressure(x);
        match self.mode {
            Mode::Apart => [0.0, 0.0, -self.preload],
            Mode::Stick(s) => {
                let w = self.tangential(x);
                [self.kt * (w[0] - s[0]), self.kt * (w[1] - s[1]), n - self.preload]
            }
            Mode::Slip => {
                let (sin, cos) = x[x.len() - 1].sin_cos();
                [self.mu * n * cos, self.mu * n * sin, n - self.preload]
            }
        }
    }

    fn rate(&self, t: f64, x: &[f64]) -> Vec<f64> {
        let n = self.system.mass.nrows();
        let (w, v) = x.split_at(n);
        let mut pull: Vec<f64> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| -self.system.stiffness[(i, j)] * w[j] - self.system.damping[(i, j)] * v[j])
                    .sum()
            })
            .collect();
        for load in &self.system.loads {
            pull[load.dof] += (load.amplitude * Complex64::cis(load.harmonic as f64 * self.omega * t)).re;
        }
        for (direction, f) in self.system.joints[0].directions.iter().zip(self.force(x)) {
            for &(dof, c) in direction {
                pull[dof] -= c * f;
            }
        }
        let mut rate = v[..n].to_vec();
        rate.extend((0..n).map(|i| (0..n).map(|j| self.inverse[(i, j)] * pull[j]).sum::<f64>()));
        rate.push(if self.mode == Mode::Slip && !self.aligned {
            let (sin, cos) = x[2 * n].sin_cos();
            let u = self.tangential(v);
            (u[1] * cos - u[0] * sin) * self.kt / (self.mu * self.pressure(x))
        } else {
            0.0
        });
        rate
    }

    fn step(&self, h: f64) -> Vec<f64> {
        let add =
            |dx: &[f64], h: f64| -> Vec<f64> { self.x.iter().zip(dx).map(|(x, d)| x + h * d).collect() };
        let k1 = self.rate(self.t, &self.x);
        let k2 = self.rate(self.t + 0.5 * h, &add(&k1, 0.5 * h));
        let k3 = self.rate(self.t + 0.5 * h, &add(&k2, 0.5 * h));
        let k4 = self.rate(self.t + h, &add(&k3, h));
        let slopes = k1.iter().zip(&k2).zip(k3.iter().zip(&k4));
        let mean: Vec<f64> = slopes.map(|((a, b), (c, d))| (a + 2.0 * b + 2.0 * c + d) / 6.0).collect();
        add(&mean, h)
    }

    /// Positive as long as the mode may go on.
    fn margin(&self, x: &[f64]) -> f64 {
        let n = self.system.mass.nrows();
        let pressure = self.pressure(x);
        match self.mode {
            Mode::Apart => -pressure,
            Mode::Stick(_) => {
                let f = self.force(x);
                self.mu * pressure - f[0].hypot(f[1])
            }
            Mode::Slip => {
                let (sin, cos) = x[2 * n].sin_cos();
                let u = self.tangential(&x[n..]);
                let slides = self.kt * (u[0] * cos + u[1] * sin) - self.mu * self.kn * self.along(2, &x[n..]);
                // Either margin ends the slip; their units differ, their signs do not.
                slides.min(pressure)
            }
        }
    }

    fn change(&mut self) {
        self.events += 1;
        let n = self.system.mass.nrows();
        let (w, f) = (self.tangential(&self.x), self.force(&self.x));
        let spring = [f[0] / self.kt, f[1] / self.kt];
        match self.mode {
            Mode::Slip if self.pressure(&self.x) <= 1e-9 * self.largest() / self.omega => {
                self.mode = Mode::Apart;
            }
            Mode::Slip => self.mode = Mode::Stick([w[0] - spring[0], w[1] - spring[1]]),
            Mode::Stick(_) => {
                self.x[2 * n] = f[1].atan2(f[0]);
                self.mode = Mode::Slip;
            }
            Mode::Apart => {
                let u = self.tangential(&self.x[n..]);
                let grip = self.mu * self.kn * self.along(2, &self.x[n..]);
                if self.kt * u[0].hypot(u[1]) < grip {
                    self.mode = Mode::Stick(w);
                } else {
                    self.x[2 * n] = u[1].atan2(u[0]);
                    self.mode = Mode::Slip;
                }
            }
        }
    }

    /// θ follows the velocity within a distance r/|ẇ|, which is short where the contact begins and ceases to press; where it
    /// is nothing beside `h`, θ is that of the velocity. Returns the longest step.
    fn prepare(&mut self, h: f64) -> f64 {
        let n = self.system.mass.nrows();
        let u = self.tangential(&self.x[n..]);
        let reach = self.mu * self.pressure(&self.x) / self.kt / u[0].hypot(u[1]);
        self.aligned = self.mode == Mode::Slip && reach < 1e-3 * h;
        match self.mode {
            Mode::Slip if self.aligned => {
                self.x[2 * n] = u[1].atan2(u[0]);
                1e-3 * h
            }
            Mode::Slip => (0.3 * reach).min(h),
            _ => h,
        }
    }

    /// Size of the margin.
    fn largest(&self) -> f64 {
        let n = self.system.mass.nrows();
        match self.mode {
            Mode::Slip => self.kt * self.x[n..2 * n].iter().fold(0.0_f64, |top, v| top.max(v.abs())),
            _ => self.kt * self.x[..n].iter().fold(0.0_f64, |top, w| top.max(w.abs())),
        }
    }

    /// Goes on by `h`, ending steps at events.
    fn go(&mut self, h: f64) {
        let end = self.t + h;
        for _ in 0..1000 {
            let left = end - self.t;
            if left <= 1e-12 * h {
                break;
            }
            let rest = self.prepare(h).min(left);
            let to = self.step(rest);
            // Where a motion has just begun its margin is zero but for rounding.
            if self.margin(&to) >= -1e-13 * self.largest() {
                (self.x, self.t) = (to, self.t + rest);
                continue;
            }
            // Bisection to rounding.
            let (mut low, mut high) = (0.0, rest);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.margin(&self.step(middle)) >= 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            self.x = self.step(high);
            self.t += high;
            self.change();
        }
        self.t = end;
    }

    /// Follows the motion until two periods agree to `closure`, at most `most` periods.
    pub fn periodic(&mut self, steps: usize, closure: f64, most: usize) -> Period {
        let n = self.system.mass.nrows();
        let h = TAU / self.omega / steps as f64;
        let mut before: Vec<Vec<f64>> = Vec::new();
        for periods in 1..=most {
            let mut now = Vec::with_capacity(steps);
            // Phases, not growing times, so that every period has the same instants.
            self.t = 0.0;
            self.events = 0;
            for _ in 0..steps {
                now.push(self.x[..n].to_vec());
                self.go(h);
            }
            let size = now.iter().flatten().fold(0.0_f64, |top, w| top.max(w.abs()));
            let pairs = before.iter().flatten().zip(now.iter().flatten());
            let distance = pairs.fold(0.0_f64, |top, (a, b)| top.max((a - b).abs())) / size;
            if periods > 1 && (distance < closure || periods == most) {
                return Period { displacement: now, closure: distance, periods };
            }
            before = now;
        }
        Period { displacement: before, closure: f64::INFINITY, periods: most }
    }
}

impl Period {
    /// `W_0 … W_highest` of a dof in m, one-sided.
    pub fn spectrum(&self, dof: usize, highest: usize) -> Vec<Complex64> {
        let count = self.displacement.len();
        let coefficient = |k: usize| {
            let turn = |j: usize| Complex64::cis(-TAU * ((k * j) % count) as f64 / count as f64);
            let sum: Complex64 = self.displacement.iter().enumerate().map(|(j, w)| turn(j) * w[dof]).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / count as f64
        };
        (0..=highest).map(coefficient).collect()
    }
}
