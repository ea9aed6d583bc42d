//! A free motion of given amplitude: natural frequency, damping and harmonics together, by Newton's method.
//!
//! ```text
//! r(û; ω, ζ) = 0,   û_ref,1 = A
//! ```
//!
//! with the balance's residual r without excitation. Springs as stiff as the structure are lent to it throughout: near a mode that
//! contacts hardly touch, the structure alone is all but singular.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{Linear, LinearParameters};
use faer::{Mat, c64};

use crate::balance::Homotopy;
use crate::course::{stuck_springs, whole};
use crate::dense::Lu;
use crate::error::PlanError;
use crate::mode::{ModeOptions, Origin};
use crate::plan::Plan;
use crate::problem::{Contact, Excitation, ExcitationKind, Problem};
use crate::settings::Settings;
use crate::workspace::Workspace;

/// Newton steps at most.
const STEPS: usize = 30;

/// Relative residual that is asked for, and that is accepted where rounding allows no better.
const TOLERANCE: f64 = 1e-11;
const FLOOR: f64 = 1e-9;

/// Relative step of the differences in ω, and the step in ζ.
const DIFFERENCE: f64 = 1e-6;

/// What tells one motion of a mode from its neighbours, with W_1 of the reference dof real.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pin {
    /// W_1 of the reference dof in m.
    Amplitude(f64),
    /// ω in rad/s, where the amplitude turns back along the mode.
    Frequency(f64),
}

/// The unknowns at one amplitude.
#[derive(Debug, Clone)]
pub(crate) struct State {
    /// û in m, entry `[slot][i]`.
    pub(crate) motion: Vec<c64>,
    /// ω in rad/s.
    pub(crate) omega: f64,
    pub(crate) zeta: f64,
    pub(crate) residual: f64,
    /// Newton steps it took.
    pub(crate) steps: usize,
}

/// The balance of a free motion, and its buffers.
pub(crate) struct FreeMotion {
    pub(crate) plan: Plan,
    pub(crate) ws: Workspace,
    /// Contact whose displacement is that of the reference dof.
    reference: usize,
    origin: Origin,
    /// ω in rad/s and ζ of the linear mode.
    linear: (f64, f64),
    lu: Lu<f64>,
    column: Mat<f64>,
}

impl FreeMotion {
    pub(crate) fn new(
        problem: &Problem,
        settings: &Settings,
        options: &ModeOptions,
    ) -> Result<Self, PlanError> {
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
        let size = 2 * plan.slots() * plan.rows() + 2;
        Ok(Self {
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
    pub(crate) fn begin(&mut self, amplitude: f64) -> Option<State> {
        let slots = self.slots();
        let (omega, zeta) = self.linear;
        self.ws.held.fill(false);
        self.ws.condensed.self_excitation = 0.0;
        self.plan.structure.condense_sprung(omega / TAU, 0..slots, &mut self.ws.condensed).ok()?;
        (self.ws.goal, self.ws.ready) = (self.plan.top, slots);
        self.ws.point.set(&self.ws.condensed, self.plan.laws(), slots, &self.ws.held);
        let width = self.ws.point.width();
        // The response to a force on the reference at the resonance has the shape of the mode.
        for row in 0..width - self.plan.joint_rows {
            let contact = &self.plan.contacts[self.ws.point.active[row]];
            let unit = self.ws.point.length[row] / self.ws.point.force[row];
            let stiffness = contact.law.stiffest().unwrap_or_else(|| {
                contact.law.length().map_or(0.0, |length| contact.law.secant_stiffness(length))
            });
            let stuck = if self.origin == Origin::Stuck { stiffness * contact.scale * unit } else { 0.0 };
            self.ws.point.secant[row] = c64::from(stuck);
        }
        self.plan.stick_joints(if self.origin == Origin::Stuck { 1.0 } else { 0.0 }, &mut self.ws);
        self.plan.solve_with_secants(slots, &mut self.ws);
        let pinned = self.pinned();
        let length = self.ws.point.length[self.reference];
        let turn = c64::from(amplitude / length) / self.ws.unknowns[pinned];
        let first = self.plan.first_slot()?;
        for entry in 0..slots * width {
            let kept = if entry / width == first { turn } else { c64::ZERO };
            self.ws.unknowns[entry] *= kept;
        }
        let start = State { motion: self.motion(), omega, zeta, residual: f64::INFINITY, steps: 0 };
        self.solve(Pin::Amplitude(amplitude), start)
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
    pub(crate) fn evaluate(&mut self, state: &State) -> Option<f64> {
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

    /// Amplitude in m of the reference dof's first harmonic in `state`.
    pub(crate) fn amplitude(&self, state: &State) -> f64 {
        state.motion.get(self.pinned()).map_or(0.0, |w| w.re)
    }

    /// Newton's method at what `pin` holds.
    pub(crate) fn solve(&mut self, pin: Pin, start: State) -> Option<State> {
        let mut state = start;
        let mut last = f64::INFINITY;
        for step in 0..STEPS {
            let by_omega = self.slope(&state, true)?;
            let by_zeta = self.slope(&state, false)?;
            state.residual = self.evaluate(&state)?;
            let pinned = self.pinned();
            let w = state.motion[pinned];
            let pinned_off = match pin {
                Pin::Amplitude(amplitude) => (w - amplitude).norm() / amplitude,
                Pin::Frequency(omega) => (state.omega / omega - 1.0).abs() + (w.im / w.re).abs(),
            };
            if state.residual <= TOLERANCE && pinned_off <= TOLERANCE
                || state.residual <= FLOOR && pinned_off <= FLOOR && last <= FLOOR
            {
                state.steps = step;
                return Some(state);
            }
            let correction = self.correction(&by_omega, &by_zeta, pin, &state)?;
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
        pin: Pin,
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
        let w = state.motion[pinned] / length;
        let (column, off) = match pin {
            Pin::Amplitude(amplitude) => (r, w.re - amplitude / length),
            Pin::Frequency(omega) => (size, 1.0 - omega / state.omega),
        };
        for (border, (column, off)) in [(column, off), (r + 1, w.im)].into_iter().enumerate() {
            self.lu.matrix[(size + border, column)] = 1.0;
            self.column[(size + border, 0)] = off;
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
}
