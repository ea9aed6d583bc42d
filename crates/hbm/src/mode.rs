//! Damped nonlinear modes: natural frequency and damping ratio against amplitude.
//!
//! The extended periodic motion concept (Krack 2015, Computers & Structures 154): the structure moves freely, and a negative damping
//! proportional to the mass makes its motion periodic,
//!
//! ```text
//! M ẅ + (D − 2ζω M) ẇ + C w = − Σ contacts,   W_1 of the reference dof = A
//! ```
//!
//! with the natural frequency ω and the ratio ζ of critical damping unknown and the amplitude A given. It holds for
//! friction as for any other law. Near a resonance that is alone, the forced response is a motion of this mode:
//! with φ = w_1/a, φᴴ M φ = 1, the modal amplitude a answers a force f like a linear oscillator,
//!
//! ```text
//! |φᴴ f|² = a² ((ω² − Ω²)² + (2ζωΩ)²)
//! ```
//!
//! so its largest amplitude is a where |φᴴ f| = 2ζω²√(1 − ζ²) a, at Ω = ω√(1 − 2ζ²).

use std::f64::consts::TAU;

use faer::c64;

use crate::error::PlanError;
use crate::free_motion::{FreeMotion, Pin, State};
use crate::problem::{ExcitationKind, Problem};
use crate::settings::Settings;
use crate::solution::{Solution, Stats, Status};

/// The linear structure from which a mode is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Origin {
    /// All contacts stuck: the mode of small amplitudes.
    #[default]
    Stuck,
    /// Without contacts: the mode of large amplitudes, where friction is a small part of the forces.
    Free,
}

/// Which mode, and over which amplitudes.
#[derive(Clone, Copy)]
pub struct ModeOptions<'a> {
    /// Counted from zero in the order of the frequencies of the structure that `origin` names.
    pub mode: usize,
    /// Where the mode is followed from.
    pub origin: Origin,
    /// The dof whose amplitude |W_1| is given.
    pub reference: usize,
    /// Smallest and largest amplitude in m; positive.
    pub amplitudes: (f64, f64),
    /// Points wanted, spread evenly over the logarithm of the amplitude; more where the mode changes fast.
    pub points: usize,
    /// Called with the amplitude of every new point; `false` stops.
    pub progress: &'a dyn Fn(f64) -> bool,
}

/// A nonlinear mode at one amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct ModePoint {
    /// |W_1| of the reference dof in m.
    pub amplitude: f64,
    /// Natural frequency in Hz.
    pub frequency: f64,
    /// Ratio of critical damping.
    pub damping_ratio: f64,
    /// a = √(w_1ᴴ M w_1) in m √kg.
    pub modal_amplitude: f64,
    /// Factor on the problem's excitation at which its response has its resonance at this amplitude; `None` where
    /// nothing excites the mode, or where its damping is negative.
    pub excitation: Option<f64>,
    /// Frequency in Hz of that resonance, ω√(1 − 2ζ²)/2π.
    pub resonance: Option<f64>,
    /// The motion at the natural frequency, W_1 of the reference dof being real.
    pub solution: Solution,
}

/// How a mode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModeEnd {
    /// All amplitudes have their point.
    Reached,
    /// No point was found to begin with.
    NoStart,
    /// The shortest step found no further point.
    Lost,
    /// The amplitude turned back for good, to the end of the range where it had begun.
    Returned,
    /// Stopped from outside.
    Stopped,
}

/// A nonlinear mode over its amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct NonlinearMode {
    /// Along the mode, from small amplitudes to large ones; in between the amplitude may turn back.
    pub points: Vec<ModePoint>,
    /// How it ended.
    pub end: ModeEnd,
    /// Harmonics of the natural frequency, one a column of every spectrum.
    pub orders: Vec<usize>,
}

/// ln A, A in m, and the motion.
type Place = (f64, State);

/// Shortest step in ln A, or in ln ω.
const SHORTEST: f64 = 1e-4;

/// Steps in ln A that must be as much shorter than the last one are none: A turns back.
const STALLED: f64 = 0.03;

/// Longest step in ln ω.
const LONGEST_TURN: f64 = 0.01;

/// So many times the points wanted are followed at most.
const MOST_POINTS: usize = 20;

/// A point farther than this from where the last two point to, in ζ or relative in ω and A, may be of another branch: where the
/// amplitude turns back along a mode, Newton's method finds whatever has a larger one.
const ASIDE: f64 = 0.03;

/// Amplitudes tried for a first point.
const STARTS: usize = 13;

/// The mode of `problem` over the amplitudes of `options`: the free periodic motion of
///
/// ```math
/// M \ddot w + (D - 2 \zeta \omega M) \dot w + C w = -\sum \text{contacts}
/// ```
///
/// with the frequency ω and the damping ratio ζ unknown and the amplitude given (Krack 2015, Computers & Structures 154). Its excitation matters for [`ModePoint::excitation`] alone, but
/// for a static preload, which acts.
///
/// # Errors
/// As [`Plan::new`](crate::Plan::new); or the reference dof, the mode or the amplitudes make no sense.
pub fn nonlinear_mode(
    problem: &Problem,
    settings: &Settings,
    options: &ModeOptions,
) -> Result<NonlinearMode, PlanError> {
    let mut motion = FreeMotion::new(problem, settings, options)?;
    let orders = motion.plan.orders().to_vec();
    let (low, high) = options.amplitudes;
    let range = (high / low).ln();
    let longest = range / (options.points.max(2) - 1) as f64;
    // The first amplitude at which Newton's method finds the mode from the linear one: that end of the range, if it can be.
    let first = (0..STARTS).find_map(|i| {
        let part = i as f64 / (STARTS - 1) as f64;
        let at = match options.origin {
            Origin::Stuck => low.ln() + range * part,
            Origin::Free => high.ln() - range * part,
        };
        Some((at, motion.begin(at.exp())?))
    });
    let Some(first) = first else {
        return Ok(NonlinearMode { points: Vec::new(), end: ModeEnd::NoStart, orders });
    };
    let ends = (low.ln(), high.ln());
    let (mut end, upwards) = follow(&mut motion, &first, ends, longest, options.progress);
    let mut places: Vec<Place> = Vec::new();
    if end != ModeEnd::Stopped {
        let (ended, downwards) = follow(&mut motion, &first, (ends.1, ends.0), longest, options.progress);
        end = if end == ModeEnd::Reached { ended } else { end };
        places.extend(downwards.into_iter().rev());
    }
    places.push(first);
    places.extend(upwards);
    let points = places.iter().map(|(at, state)| point(problem, &mut motion, at.exp(), state)).collect();
    Ok(NonlinearMode { points, end, orders })
}

/// Follows the mode from `first` until its amplitude is e^`to`, or again the other end of the range, e^`from`; returns the places on
/// the way. The step is one of ln A; where ln ω changes faster than ln A it is one of ln ω, so that the amplitude may turn back.
fn follow(
    motion: &mut FreeMotion,
    first: &Place,
    (from, to): (f64, f64),
    longest: f64,
    progress: &dyn Fn(f64) -> bool,
) -> (ModeEnd, Vec<Place>) {
    let mut found: Vec<Place> = Vec::new();
    let mut here = first.clone();
    let mut before: Option<Place> = None;
    let mut step = 0.25 * longest;
    let most = MOST_POINTS * (1 + ((to - from).abs() / longest) as usize);
    let (low, high) = (from.min(to), from.max(to));
    // The next place lies beyond an end of the range: that end itself comes first.
    let mut at_an_end = false;
    let mut turning = false;
    while here.0 != to {
        if found.len() > most {
            return (ModeEnd::Lost, found);
        }
        if !progress(here.0.exp()) {
            return (ModeEnd::Stopped, found);
        }
        let moved = before.as_ref().map(|before| {
            let turned = (here.1.omega / before.1.omega).ln();
            (here.0 - before.0, turned)
        });
        let (pin, part) = match moved {
            Some((_, turned)) if turning && !at_an_end => {
                let change = step.min(LONGEST_TURN) * turned.signum();
                (Pin::Frequency(here.1.omega * change.exp()), change / turned)
            }
            _ => {
                let up = moved.map_or(to > here.0, |(grown, _)| grown > 0.0);
                let end = if up { high } else { low };
                let apart = end - here.0;
                let next = if apart.abs() <= 1.001 * step { end } else { here.0 + step * apart.signum() };
                (
                    Pin::Amplitude(next.exp()),
                    moved.map_or(next - here.0, |(grown, _)| (next - here.0) / grown),
                )
            }
        };
        let (expected, guess) = guess(&here, before.as_ref(), part);
        let place = |state: State, motion: &FreeMotion| -> Option<Place> {
            let amplitude = match pin {
                Pin::Amplitude(amplitude) => amplitude,
                Pin::Frequency(_) => motion.amplitude(&state),
            };
            let grown = (amplitude.ln() - expected).abs();
            let turned = (state.omega / guess.omega - 1.0).abs();
            let aside = grown.max(turned).max((state.zeta - guess.zeta).abs());
            (aside <= ASIDE).then(|| (end_or(amplitude.ln(), low, high), state))
        };
        let next = motion.solve(pin, guess.clone()).and_then(|state| place(state, motion));
        match next {
            Some(next) if next.0 < low || next.0 > high => at_an_end = true,
            Some(next) => {
                at_an_end = false;
                let steps = next.1.steps;
                found.push(next.clone());
                let last = std::mem::replace(&mut here, next);
                let (grown, turned) = ((here.0 - last.0).abs(), (here.1.omega / last.1.omega).ln().abs());
                before = Some(last);
                // What is stepped in next changed by so much.
                turning = grown < turned;
                step = if turning { turned } else { grown };
                step = (step * if steps <= 5 { 1.5 } else { 0.8 }).min(longest);
                if here.0 == from && here.0 != to {
                    return (ModeEnd::Returned, found);
                }
            }
            None => step *= 0.3,
        }
        if let Some((grown, turned)) = moved.filter(|(grown, _)| !turning && step < STALLED * grown.abs()) {
            // The amplitude turns back right here.
            (turning, step) = (true, 0.3 * grown.abs().min(turned.abs()));
        }
        if step < SHORTEST {
            return (ModeEnd::Lost, found);
        }
    }
    (ModeEnd::Reached, found)
}

/// `at`, or the end of the range that it is but for rounding.
fn end_or(at: f64, low: f64, high: f64) -> f64 {
    [low, high].into_iter().find(|end| (at - end).abs() < 1e-14 * (1.0 + end.abs())).unwrap_or(at)
}

/// A state as a user sees it.
fn point(problem: &Problem, motion: &mut FreeMotion, amplitude: f64, state: &State) -> ModePoint {
    let residual = motion.evaluate(state).unwrap_or(state.residual);
    let hertz = state.omega / TAU;
    // Without what excites the marker, recovered dofs move by contact forces alone.
    motion.ws.condensed.free_output.fill(c64::ZERO);
    let mut solution = Solution::empty(hertz, motion.plan.settings.harmonics);
    motion.ws.stats = Stats { iterations: state.steps, ..Stats::default() };
    motion.plan.report(Status::Converged, residual, &mut motion.ws, &mut solution);
    let slot = motion.plan.first_slot().unwrap_or(0);
    let first: Vec<c64> =
        solution.displacement.iter().map(|row| row.get(slot).copied().unwrap_or(c64::ZERO)).collect();
    let mass = problem.model.mass();
    let squared: f64 = (0..first.len())
        .map(|i| {
            let momentum: c64 = (0..first.len()).map(|j| first[j] * mass[(i, j)]).sum();
            (first[i].conj() * momentum).re
        })
        .sum();
    let modal = squared.sqrt();
    let zeta = state.zeta;
    let damped = zeta > 0.0 && zeta < std::f64::consts::FRAC_1_SQRT_2;
    let resonance = damped.then(|| state.omega * (1.0 - 2.0 * zeta * zeta).sqrt());
    let excitation = resonance.and_then(|resonance| {
        let force = generalised_force(problem, resonance, &first).norm() / modal;
        let needed = 2.0 * zeta * state.omega.powi(2) * (1.0 - zeta * zeta).sqrt() * modal;
        (force > 0.0).then(|| needed / force)
    });
    solution.displacement =
        problem.output.iter().filter_map(|&dof| solution.displacement.get(dof).cloned()).collect();
    solution.contacts.truncate(problem.contacts.len());
    ModePoint {
        amplitude,
        frequency: hertz,
        damping_ratio: zeta,
        modal_amplitude: modal,
        excitation,
        resonance: resonance.map(|omega| omega / TAU),
        solution,
    }
}

/// w_1ᴴ f of the problem's own excitation of the first harmonic at Ω = `omega`.
fn generalised_force(problem: &Problem, omega: f64, first: &[c64]) -> c64 {
    let excited = problem.excitation.iter().filter(|e| e.harmonic == 1);
    excited
        .map(|e| {
            let amplitude = c64::from_polar(e.amplitude, e.phase);
            let on = |dof: usize, size: c64| first.get(dof).map_or(c64::ZERO, |w| w.conj() * size);
            match e.kind {
                ExcitationKind::Force => on(e.dof, amplitude),
                ExcitationKind::Unbalance => on(e.dof, amplitude * omega * omega),
                ExcitationKind::Base => {
                    let load = problem.model.base_loads().get(e.dof).into_iter().flatten();
                    load.enumerate().map(|(dof, inertia)| on(dof, -amplitude * inertia)).sum()
                }
            }
        })
        .sum()
}

/// ln A and the state `part` times the last step farther by the secant through the last two places; from the first place on the
/// motion scaled, by `part` of ln A.
fn guess(here: &Place, before: Option<&Place>, part: f64) -> (f64, State) {
    let mut state = here.1.clone();
    let Some(before) = before else {
        for u in &mut state.motion {
            *u *= part.exp();
        }
        return (here.0 + part, state);
    };
    // Shapes w/A, ω and ζ go on as they went from the last place to this one.
    let next = here.0 + (here.0 - before.0) * part;
    let (now, then) = (here.0.exp(), before.0.exp());
    for (u, old) in state.motion.iter_mut().zip(&before.1.motion) {
        let shape = *u / now;
        *u = (shape + (shape - old / then) * part) * next.exp();
    }
    state.omega *= (here.1.omega / before.1.omega).powf(part);
    state.zeta += (here.1.zeta - before.1.zeta) * part;
    (next, state)
}
