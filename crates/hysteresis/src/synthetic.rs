//! Synthetic loops and *dirty* records of them, whose truth is known: for tests, examples and studies.
//!
//! Everything is seeded; the same settings give the same record, bit for bit.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use num_complex::Complex64;
use rand::{Rng, RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::LoopError;
use crate::harmonics::one_sided;
use crate::hysteresis_loop::Loop;
use crate::record::Record;

/// The first `harmonics` harmonics of a loop given by its force over loop phase \[N\], θ in [0, 2π).
///
/// # Errors
/// See [`Loop::new`].
pub fn project(
    displacement_amplitude: f64,
    harmonics: usize,
    force: impl Fn(f64) -> f64,
) -> Result<Loop, LoopError> {
    let samples = (64 * (harmonics + 1)).max(4096).next_power_of_two();
    let values: Vec<f64> = (0..samples).map(|j| force(TAU * j as f64 / samples as f64)).collect();
    Loop::new(displacement_amplitude, one_sided(&values, harmonics))
}

/// The steady loop of Dahl's friction law, `df/dw = k (1 ∓ f/F_s)`: a rounded loop of slip force `F_s`
/// \[N\] and stiffness `k` \[N/m\] after a reversal, at displacement amplitude `a` \[m\]; its first
/// `harmonics` harmonics (the even ones are zero).
///
/// With `x_s = F_s/k`, the force falls from `F_s tanh(a/x_s)` towards `−F_s` as `e^{−x/x_s}` on the way `x`
/// from the upper tip, so `∮ f dw = 4 F_s (a − x_s tanh(a/x_s))`.
///
/// # Errors
/// See [`Loop::new`].
pub fn dahl_loop(
    displacement_amplitude: f64,
    slip_force: f64,
    stiffness: f64,
    harmonics: usize,
) -> Result<Loop, LoopError> {
    backlash_loop(displacement_amplitude, slip_force, stiffness, 0.0, harmonics)
}

/// The loop of [`dahl_loop`] in series with a clearance `gap` \[m\] < 2a, through which the force stays zero.
///
/// # Errors
/// See [`Loop::new`].
pub fn backlash_loop(
    displacement_amplitude: f64,
    slip_force: f64,
    stiffness: f64,
    gap: f64,
    harmonics: usize,
) -> Result<Loop, LoopError> {
    let slip_way = slip_force / stiffness;
    let top = slip_force * ((displacement_amplitude - 0.5 * gap) / slip_way).tanh();
    // Way from the tip at which −F_s + (top + F_s) e^{−x/x_s} is zero.
    let zero = slip_way * (top / slip_force).ln_1p();
    project(displacement_amplitude, harmonics, |theta| {
        let (sign, from_tip) = if theta < PI { (1.0, theta) } else { (-1.0, theta - PI) };
        let way = 2.0 * displacement_amplitude * (0.5 * from_tip).sin().powi(2);
        let free = (way - zero).clamp(0.0, gap);
        sign * (-slip_force + (top + slip_force) * (-(way - free) / slip_way).exp())
    })
}

/// The loop with one harmonic `k` ≥ 1 replaced by `coefficient` \[N\]: an even one makes it asymmetric, the
/// first makes it agree with a scaling law.
///
/// # Errors
/// See [`Loop::new`].
pub fn with_harmonic(original: &Loop, k: usize, coefficient: Complex64) -> Result<Loop, LoopError> {
    let mut coefficients = original.coefficients().to_vec();
    coefficients.resize(coefficients.len().max(k + 1), Complex64::ZERO);
    if let Some(harmonic) = coefficients.get_mut(k) {
        *harmonic = coefficient;
    }
    Loop::new(original.displacement_amplitude(), coefficients)
}

/// How the displacement moves between its turning points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Drive {
    /// Sinusoidal.
    #[default]
    Sine,
    /// With constant speed, the usual drive of slow rigs.
    Triangle,
}

/// A record as a rig would write it, with everything that makes records dirty. Each item is zero or absent in
/// [`DirtyRecord::new`] except a run-up and a run-down of two cycles around five steady ones.
///
/// The steady part follows the loop's Fourier series exactly, so the truth of a fit is the loop itself.
#[derive(Debug, Clone, PartialEq)]
pub struct DirtyRecord {
    /// The true loop.
    pub truth: Loop,
    /// Cycles a second \[Hz\].
    pub frequency: f64,
    /// Samples a cycle; need not be a whole number.
    pub samples_per_cycle: f64,
    /// Cycles in which the amplitude grows from zero.
    pub run_up: usize,
    /// Steady cycles.
    pub steady: usize,
    /// Cycles in which the amplitude falls to zero.
    pub run_down: usize,
    /// Where in the cycle the record begins, in cycles after the displacement passed its middle upwards.
    pub start: f64,
    /// Motion between turning points.
    pub drive: Drive,
    /// Standard deviation of white noise in the force relative to |F_1|.
    pub force_noise: f64,
    /// Standard deviation of white noise in the displacement relative to its amplitude.
    pub displacement_noise: f64,
    /// Offset of the displacement relative to its amplitude.
    pub displacement_offset: f64,
    /// Drift of the displacement a cycle relative to its amplitude.
    pub displacement_drift: f64,
    /// Offset of the force relative to |F_1|.
    pub force_offset: f64,
    /// Drift of the force a cycle relative to |F_1|.
    pub force_drift: f64,
    /// Amplitude of stick-slip chatter relative to |F_1|, on the second half of every branch: 40
    /// oscillations a cycle whose phase is new on every branch.
    pub chatter: f64,
    /// Largest shift of a sample's instant, in sampling steps, below 0.5.
    pub jitter: f64,
    /// Whether the record has times.
    pub with_time: bool,
    /// Seed of everything random.
    pub seed: u64,
}

impl DirtyRecord {
    /// A clean record of a loop: 0.5 Hz, 512 samples a cycle, run-up 2, steady 5 and run-down 2 cycles,
    /// sine, with time.
    #[must_use]
    pub fn new(truth: Loop) -> Self {
        Self {
            truth,
            frequency: 0.5,
            samples_per_cycle: 512.0,
            run_up: 2,
            steady: 5,
            run_down: 2,
            start: 0.0,
            drive: Drive::Sine,
            force_noise: 0.0,
            displacement_noise: 0.0,
            displacement_offset: 0.0,
            displacement_drift: 0.0,
            force_offset: 0.0,
            force_drift: 0.0,
            chatter: 0.0,
            jitter: 0.0,
            with_time: true,
            seed: 0,
        }
    }

    /// Only the steady cycles, begun at `start` (in cycles after the upward passage).
    #[must_use]
    pub fn steady_only(truth: Loop, cycles: usize, start: f64) -> Self {
        Self { run_up: 0, steady: cycles, run_down: 0, start, ..Self::new(truth) }
    }

    /// Writes the record.
    #[must_use]
    pub fn generate(&self) -> Record {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let cycles = (self.run_up + self.steady + self.run_down) as f64;
        let samples = (cycles * self.samples_per_cycle).round() as usize + 1;
        let (amplitude, force) = (self.truth.displacement_amplitude(), self.truth.force_amplitude());
        let mut chatter_phase = (i64::MIN, 0.0);
        let mut record =
            Record { time: None, displacement: Vec::new(), force: Vec::new(), lines: Vec::new() };
        let mut times = Vec::new();
        for j in 0..samples {
            let shift = if self.jitter > 0.0 { self.jitter * rng.random_range(-1.0..1.0) } else { 0.0 };
            let cycle = (j as f64 + shift) / self.samples_per_cycle; // since the beginning
            let envelope = self.envelope(cycle, cycles);
            let (xi, theta) = self.place(cycle + self.start);
            let branch = (2.0 * (cycle + self.start) - 0.5).floor() as i64;
            if branch != chatter_phase.0 {
                chatter_phase = (branch, rng.random_range(0.0..TAU));
            }
            let slides = theta % PI > FRAC_PI_2;
            let chatter = if slides { (40.0 * TAU * cycle + chatter_phase.1).sin() } else { 0.0 };
            let w = xi * envelope
                + self.displacement_offset
                + self.displacement_drift * cycle
                + self.displacement_noise * normal(&mut rng);
            // A run-up's force is plausible, not physical: a smaller loop of the same shape.
            let f = self.truth.force(theta) * envelope.powf(0.3)
                + force
                    * (self.force_offset
                        + self.force_drift * cycle
                        + self.chatter * chatter
                        + self.force_noise * normal(&mut rng));
            record.displacement.push(amplitude * w);
            record.force.push(f);
            times.push(cycle / self.frequency);
        }
        record.time = self.with_time.then_some(times);
        record
    }

    /// Amplitude at an instant, relative to the steady one.
    fn envelope(&self, cycle: f64, cycles: f64) -> f64 {
        let up = if self.run_up > 0 { cycle / self.run_up as f64 } else { 1.0 };
        let down = if self.run_down > 0 { (cycles - cycle) / self.run_down as f64 } else { 1.0 };
        up.min(down).clamp(0.0, 1.0)
    }

    /// Normalised displacement and loop phase in [0, 2π) at an instant in cycles.
    fn place(&self, cycle: f64) -> (f64, f64) {
        let since_tip = (cycle - 0.25).rem_euclid(1.0);
        match self.drive {
            Drive::Sine => ((TAU * since_tip).cos(), TAU * since_tip),
            Drive::Triangle => {
                let (way, offset) =
                    if since_tip < 0.5 { (2.0 * since_tip, 0.0) } else { (2.0 * since_tip - 1.0, PI) };
                let theta = offset + 2.0 * way.sqrt().asin();
                let xi = 1.0 - 2.0 * way;
                (if since_tip < 0.5 { xi } else { -xi }, theta)
            }
        }
    }
}

/// A normally distributed number of standard deviation 1 (Box and Muller).
pub(crate) fn normal(rng: &mut impl Rng) -> f64 {
    let radius: f64 = 1.0 - rng.random_range(0.0..1.0);
    (-2.0 * radius.ln()).sqrt() * (TAU * rng.random_range(0.0..1.0)).cos()
}
