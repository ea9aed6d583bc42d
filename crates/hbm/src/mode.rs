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
use std::sync::Arc;

use contact::{Linear, LinearParameters};
use faer::{Mat, c64};

use crate::balance::Homotopy;
use crate::course::{stuck_springs, whole};
use crate::dense::Lu;
use crate::error::PlanError;
use crate::plan::{Plan, Workspace};
use crate::problem::{Contact, Excitation, ExcitationKind, Problem};
use crate::settings::Settings;
use crate::solution::{Solution, Status};

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
    /// Stopped from outside.
    Stopped,
}

/// A nonlinear mode over its amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct NonlinearMode {
    /// By growing amplitude.
    pub points: Vec<ModePoint>,
    /// How it ended.
    pub end: ModeEnd,
}

/// Newton steps at most.
const STEPS: usize = 30;

/// Relative residual that is asked for, and that is accepted where rounding allows no better.
const TOLERANCE: f64 = 1e-11;
const FLOOR: f64 = 1e-9;

/// Relative step of the differences in ω, and the step in ζ.
const DIFFERENCE: f64 = 1e-6;

/// Shortest step in ln A.
const SHORTEST: f64 = 1e-4;

/// Amplitudes tried for a first point.
const STARTS: usize = 13;

/// The mode of `problem` over the amplitudes of `options`. Its excitation matters for [`ModePoint::excitation`] alone, but
/// for a static preload, which acts.
///
/// # Errors
/// As [`Plan::new`]; or the reference dof, the mode or the amplitudes make no sense.
pub fn nonlinear_mode(
    problem: &Problem,
    settings: &Settings,
    options: &ModeOptions,
) -> Result<NonlinearMode, PlanError> {
    let mut tracer = Tracer::new(problem, settings, options)?;
    let (low, high) = options.amplitudes;
    let range = (high / low).ln();
    let longest = range / (options.points.max(2) - 1) as f64;
    let mut found: Vec<(f64, State)> = Vec::new();
    // The first amplitude at which Newton's method finds the mode from the linear one: that end of the range, if it can be.
    for i in 0..STARTS {
        let part = i as f64 / (STARTS - 1) as f64;
        let at = match options.origin {
            Origin::Stuck => low.ln() + range * part,
            Origin::Free => high.ln() - range * part,
        };
        if let Some(state) = tracer.begin(at.exp()) {
            found.push((at, state));
            break;
        }
    }
    let Some(first) = found.first().cloned() else {
        return Ok(NonlinearMode { points: Vec::new(), end: ModeEnd::NoStart });
    };
    let mut end = ModeEnd::Reached;
    for way in [high.ln(), low.ln()] {
        let ended = tracer.follow(&first, way, longest, options.progress, &mut found);
        end = if end == ModeEnd::Reached { ended } else { end };
        if end == ModeEnd::Stopped {
            break;
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let points = found.iter().map(|(at, state)| tracer.point(at.exp(), state)).collect();
    Ok(NonlinearMode { points, end })
}

/// The unknowns at one amplitude.
#[derive(Debug, Clone)]
struct State {
    /// û in m, entry `[slot][i]`.
    motion: Vec<c64>,
    /// ω in rad/s.
    omega: f64,
    zeta: f64,
    residual: f64,
}

struct Tracer<'p> {
    problem: &'p Problem,
    plan: Plan,
    ws: Workspace,
    /// Contact whose displacement is that of the reference dof.
    reference: usize,
    origin: Origin,
    /// ω in rad/s and ζ of the linear mode.
    linear: (f64, f64),
    lu: Lu<f64>,
    column: Mat<f64>,
}

impl<'p> Tracer<'p> {
    fn new(problem: &'p Problem, settings: &Settings, options: &ModeOptions) -> Result<Self, PlanError> {
        let error = |place: &str, problem: String| PlanError { place: place.into(), problem };
        let n = problem.model.dofs();
        let (low, high) = options.amplitudes;
        if options.reference >= n {
            return Err(error("reference", format!("the model has {n} dofs")));
        }
        if !(low > 0.0 && high > low && high.is_finite()) {
            return Err(error("amplitudes", format!("must be positive and grow, got {low} to {high}")));
        }
        let mut modes = problem.model.modes_with(&stuck_springs(problem, options.origin == Origin::Stuck));
        modes.retain(|(hertz, _)| *hertz > 0.0);
        modes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(hertz, width)) = modes.get(options.mode) else {
            return Err(error("mode", format!("there are {} modes with a frequency", modes.len())));
        };
        let mut own = problem.clone();
        own.output = (0..n).collect();
        own.excitation.retain(|e| e.harmonic == 0);
        own.excitation.push(Excitation {
            dof: options.reference,
            harmonic: 1,
            amplitude: 1.0,
            phase: 0.0,
            kind: ExcitationKind::Force,
        });
        let grounded = |c: &Contact| c.first == options.reference && c.second.is_none();
        let reference = match own.contacts.iter().position(grounded) {
            Some(contact) => contact,
            None => {
                // A spring of no stiffness: its displacement is that of the dof.
                let spring = Linear::new(LinearParameters { stiffness: 0.0 })
                    .map_err(|wrong| error("reference", wrong.to_string()))?;
                own.contacts.push(Contact {
                    name: "reference".into(),
                    first: options.reference,
                    second: None,
                    law: Arc::new(spring),
                    scale: 1.0,
                });
                own.contacts.len() - 1
            }
        };
        let plan = Plan::new(&own, &whole(settings))?;
        let ws = plan.workspace();
        let size = 2 * plan.slots() * own.contacts.len() + 2;
        Ok(Self {
            problem,
            plan,
            ws,
            reference,
            origin: options.origin,
            linear: (TAU * hertz, 0.5 * width / hertz),
            lu: Lu::new(size, 1),
            column: Mat::zeros(size, 1),
        })
    }

    fn slots(&self) -> usize {
        self.plan.slots()
    }

    /// The entry of the reference's first harmonic.
    fn pinned(&self) -> usize {
        self.plan.first_slot().unwrap_or(0) * self.ws.point.width() + self.reference
    }

    /// Makes the workspace ready at ω and ζ; whether that is possible.
    fn place(&mut self, omega: f64, zeta: f64) -> bool {
        let slots = self.slots();
        let ws = &mut self.ws;
        ws.condensed.self_excitation = 2.0 * zeta * omega;
        let sound = omega.is_finite() && omega > 0.0 && zeta.is_finite();
        if !sound || self.plan.structure.condense_sprung(omega / TAU, 0..slots, &mut ws.condensed).is_err() {
            return false;
        }
        (ws.goal, ws.ready) = (self.plan.top, slots);
        ws.point.set_again(&ws.condensed, slots);
        true
    }

    /// Nothing moves the structure but a static load.
    fn release(&mut self) {
        let width = self.ws.point.width();
        for (slot, &order) in self.plan.harmonics.reduced.iter().enumerate().take(self.plan.slots()) {
            if order > 0 {
                self.ws.point.free[slot * width..(slot + 1) * width].fill(c64::ZERO);
            }
        }
    }

    /// The mode at amplitude `amplitude` from the linear one.
    fn begin(&mut self, amplitude: f64) -> Option<State> {
        let slots = self.slots();
        let (omega, zeta) = self.linear;
        self.ws.held.fill(false);
        self.ws.condensed.self_excitation = 0.0;
        self.plan.structure.condense_sprung(omega / TAU, 0..slots, &mut self.ws.condensed).ok()?;
        (self.ws.goal, self.ws.ready) = (self.plan.top, slots);
        self.ws.point.set(&self.ws.condensed, &self.plan.contacts, slots, &self.ws.held);
        let width = self.ws.point.width();
        // The response to a force on the reference at the resonance has the shape of the mode.
        for row in 0..width {
            let contact = &self.plan.contacts[self.ws.point.active[row]];
            let unit = self.ws.point.length[row] / self.ws.point.force[row];
            let stiffness = contact.law.stiffest().unwrap_or_else(|| {
                contact.law.length().map_or(0.0, |length| contact.law.secant_stiffness(length))
            });
            let stuck = if self.origin == Origin::Stuck { stiffness * contact.scale * unit } else { 0.0 };
            self.ws.point.secant[row] = c64::from(stuck);
        }
        self.plan.solve_with_secants(slots, &mut self.ws);
        let pinned = self.pinned();
        let length = self.ws.point.length[self.reference];
        let turn = c64::from(amplitude / length) / self.ws.unknowns[pinned];
        let first = self.plan.first_slot()?;
        for entry in 0..slots * width {
            let kept = if entry / width == first { turn } else { c64::ZERO };
            self.ws.unknowns[entry] *= kept;
        }
        let start = State { motion: self.motion(), omega, zeta, residual: f64::INFINITY };
        self.solve(amplitude, start).map(|(state, _)| state)
    }

    /// û in m.
    fn motion(&self) -> Vec<c64> {
        let width = self.ws.point.width();
        let count = self.slots() * width;
        (0..count).map(|e| self.ws.unknowns[e] * self.ws.point.length[e % width]).collect()
    }

    fn load(&mut self, motion: &[c64]) {
        let width = self.ws.point.width();
        for (entry, u) in motion.iter().enumerate() {
            self.ws.unknowns[entry] = u / self.ws.point.length[entry % width];
        }
    }

    /// Residual at `state`, relative to the motion; its entries stay in the workspace.
    fn evaluate(&mut self, state: &State) -> Option<f64> {
        if !self.place(state.omega, state.zeta) {
            return None;
        }
        self.release();
        self.load(&state.motion);
        let (slots, goal) = (self.slots(), self.ws.goal);
        let Workspace { point, unknowns, balance, .. } = &mut self.ws;
        let norm = self
            .plan
            .balance(goal)
            .evaluate(point, slots, Homotopy::NONE, unknowns, &mut balance[goal])
            .ok()?;
        let count = slots * point.width();
        let size: f64 = unknowns.iter().zip(&point.weight).take(count).map(|(u, w)| (u * w).norm_sqr()).sum();
        Some(norm / size.sqrt())
    }

    /// Change of the residual with ω (relative) or ζ, by central differences; leaves the last evaluation elsewhere.
    fn slope(&mut self, state: &State, in_omega: bool) -> Option<Vec<c64>> {
        let count = state.motion.len();
        let mut sides = [Vec::new(), Vec::new()];
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            let mut beside = state.clone();
            match in_omega {
                true => beside.omega *= 1.0 + sign * DIFFERENCE,
                false => beside.zeta += sign * DIFFERENCE,
            }
            self.evaluate(&beside)?;
            // The row weights change with the receptance; a residual that is no zero must not feel that.
            let balance = &self.ws.balance[self.ws.goal];
            side.extend((0..count).map(|e| balance.residual[e] / self.ws.point.weight[e]));
        }
        let [above, below] = sides;
        Some(above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * DIFFERENCE)).collect())
    }

    /// Newton's method at amplitude `amplitude`, and how many steps it took.
    fn solve(&mut self, amplitude: f64, start: State) -> Option<(State, usize)> {
        let mut state = start;
        let mut last = f64::INFINITY;
        for step in 0..STEPS {
            let by_omega = self.slope(&state, true)?;
            let by_zeta = self.slope(&state, false)?;
            state.residual = self.evaluate(&state)?;
            let pinned = self.pinned();
            let off = state.motion[pinned] - amplitude;
            let pinned_off = off.norm() / amplitude;
            if state.residual <= TOLERANCE && pinned_off <= TOLERANCE
                || state.residual <= FLOOR && pinned_off <= FLOOR && last <= FLOOR
            {
                return Some((state, step));
            }
            let correction = self.correction(&by_omega, &by_zeta, amplitude, &state)?;
            // A step that leaves the neighbourhood is cut: ω and ζ must stay what they are.
            let (d_omega, d_zeta) = correction.1;
            let cut = (0.2 / d_omega.abs()).min(0.5 / d_zeta.abs()).min(1.0);
            let size: f64 = state.motion.iter().map(|u| u.norm_sqr()).sum::<f64>().sqrt();
            let moved: f64 = correction.0.iter().map(|u| u.norm_sqr()).sum::<f64>().sqrt();
            last = moved / size + d_omega.abs() + d_zeta.abs();
            if !last.is_finite() {
                return None;
            }
            for (u, du) in state.motion.iter_mut().zip(&correction.0) {
                *u -= du * cut;
            }
            state.omega *= 1.0 - cut * d_omega;
            state.zeta -= cut * d_zeta;
        }
        None
    }

    /// The Newton step: in m, and in (ln ω, ζ).
    fn correction(
        &mut self,
        by_omega: &[c64],
        by_zeta: &[c64],
        amplitude: f64,
        state: &State,
    ) -> Option<(Vec<c64>, (f64, f64))> {
        let (slots, goal, pinned) = (self.slots(), self.ws.goal, self.pinned());
        let balance = self.plan.balance(goal);
        let point = &self.ws.point;
        let width = point.width();
        let size = balance.size(width, slots);
        let buffers = &mut self.ws.balance[goal];
        balance.jacobian(point, slots, Homotopy::NONE, buffers, &mut self.lu.matrix);
        for border in size..size + 2 {
            for other in 0..size + 2 {
                self.lu.matrix[(border, other)] = 0.0;
            }
        }
        for entry in 0..slots * width {
            let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
            let weight = point.weight[entry];
            for (column, slope) in [(size, by_omega[entry]), (size + 1, by_zeta[entry])] {
                self.lu.matrix[(r, column)] = slope.re * weight;
                if is_complex {
                    self.lu.matrix[(r + 1, column)] = slope.im * weight;
                }
            }
            let residual = buffers.residual[entry];
            self.column[(r, 0)] = residual.re;
            if is_complex {
                self.column[(r + 1, 0)] = residual.im;
            }
        }
        let length = point.length[self.reference];
        let (r, _) = balance.real_index(width, pinned / width, pinned % width);
        let off = (state.motion[pinned] - amplitude) / length;
        for (border, (row, value)) in [(r, off.re), (r + 1, off.im)].into_iter().enumerate() {
            self.lu.matrix[(size + border, row)] = 1.0;
            self.column[(size + border, 0)] = value;
        }
        self.lu.factor(size + 2);
        self.lu.solve(self.column.as_mut().subrows_mut(0, size + 2));
        let step = |entry: usize| {
            let (r, is_complex) = balance.real_index(width, entry / width, entry % width);
            let im = if is_complex { self.column[(r + 1, 0)] } else { 0.0 };
            c64::new(self.column[(r, 0)], im) * point.length[entry % width]
        };
        Some(((0..slots * width).map(step).collect(), (self.column[(size, 0)], self.column[(size + 1, 0)])))
    }

    /// Follows the mode from `first` to amplitude e^`to`.
    fn follow(
        &mut self,
        first: &(f64, State),
        to: f64,
        longest: f64,
        progress: &dyn Fn(f64) -> bool,
        found: &mut Vec<(f64, State)>,
    ) -> ModeEnd {
        let mut here = first.clone();
        let mut before: Option<(f64, State)> = None;
        let mut step = 0.25 * longest;
        while here.0 != to {
            if !progress(here.0.exp()) {
                return ModeEnd::Stopped;
            }
            let apart = to - here.0;
            let next = if apart.abs() <= 1.001 * step { to } else { here.0 + step * apart.signum() };
            let guess = guess(&here, before.as_ref(), next);
            match self.solve(next.exp(), guess) {
                Some((state, steps)) => {
                    found.push((next, state.clone()));
                    before = Some(std::mem::replace(&mut here, (next, state)));
                    step = (step * if steps <= 5 { 1.5 } else { 0.8 }).min(longest);
                }
                None => step *= 0.3,
            }
            if step < SHORTEST {
                return ModeEnd::Lost;
            }
        }
        ModeEnd::Reached
    }

    /// A state as a user sees it.
    fn point(&mut self, amplitude: f64, state: &State) -> ModePoint {
        let residual = self.evaluate(state).unwrap_or(state.residual);
        let hertz = state.omega / TAU;
        // Without what excites the marker, recovered dofs move by contact forces alone.
        self.ws.condensed.free_output.fill(c64::ZERO);
        let mut solution = Solution::empty(hertz, self.plan.settings.harmonics);
        self.plan.report(Status::Converged, residual, &mut self.ws, &mut solution);
        let slot = self.plan.first_slot().unwrap_or(0);
        let first: Vec<c64> =
            solution.displacement.iter().map(|row| row.get(slot).copied().unwrap_or(c64::ZERO)).collect();
        let mass = self.problem.model.mass();
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
            let force = self.generalised_force(resonance, &first).norm() / modal;
            let needed = 2.0 * zeta * state.omega.powi(2) * (1.0 - zeta * zeta).sqrt() * modal;
            (force > 0.0).then(|| needed / force)
        });
        solution.displacement =
            self.problem.output.iter().filter_map(|&dof| solution.displacement.get(dof).cloned()).collect();
        solution.contacts.truncate(self.problem.contacts.len());
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
    fn generalised_force(&self, omega: f64, first: &[c64]) -> c64 {
        let excited = self.problem.excitation.iter().filter(|e| e.harmonic == 1);
        excited
            .map(|e| {
                let amplitude = c64::from_polar(e.amplitude, e.phase);
                let on = |dof: usize, size: c64| first.get(dof).map_or(c64::ZERO, |w| w.conj() * size);
                match e.kind {
                    ExcitationKind::Force => on(e.dof, amplitude),
                    ExcitationKind::Unbalance => on(e.dof, amplitude * omega * omega),
                    ExcitationKind::Base => {
                        let load = self.problem.model.base_loads().get(e.dof).into_iter().flatten();
                        load.enumerate().map(|(dof, inertia)| on(dof, -amplitude * inertia)).sum()
                    }
                }
            })
            .sum()
    }
}

/// The state at `next` by the secant through the last two, or scaled from the last.
fn guess(here: &(f64, State), before: Option<&(f64, State)>, next: f64) -> State {
    let mut state = here.1.clone();
    let grown = (next - here.0).exp();
    let Some(before) = before else {
        for u in &mut state.motion {
            *u *= grown;
        }
        return state;
    };
    // Shapes w/A, ω and ζ go on as they went from the last amplitude to this one.
    let ratio = (next - here.0) / (here.0 - before.0);
    let (now, then) = (here.0.exp(), before.0.exp());
    for (u, old) in state.motion.iter_mut().zip(&before.1.motion) {
        let shape = *u / now;
        *u = (shape + (shape - old / then) * ratio) * next.exp();
    }
    state.omega += (here.1.omega - before.1.omega) * ratio;
    state.zeta += (here.1.zeta - before.1.zeta) * ratio;
    state
}
