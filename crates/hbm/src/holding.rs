//! At rest: contacts with a set-valued law that hold w = 0.
//!
//! A law whose force does not vanish with the amplitude holds any force up to `F* g(0)` at rest. All contacts with such
//! a law are tried at rest first; those whose holding force would exceed the limit at some instant are released, the
//! balance of the others is solved, and so on. The holding force is `G_hh⁻¹ (u⁰_h − G_hf F_f)` harmonic by harmonic, and
//! has to stay inside the limit for all t.

use contact::{Motion, TurningPoints};
use faer::c64;

use crate::plan::{Plan, Rung};
use crate::solution::{Solution, Status};
use crate::workspace::Workspace;

/// Rounding of a holding force, relative to its limit: without it a contact exactly at its limit could neither rest nor
/// slide.
pub(crate) const HOLDING_SLACK: f64 = 1e-13;

impl Plan {
    /// Looks for a solution with contacts at rest; reports it and answers `true` when there is one.
    pub(crate) fn try_holding(&self, ws: &mut Workspace, solution: &mut Solution) -> bool {
        for (held, contact) in ws.held.iter_mut().zip(&self.contacts) {
            *held = contact.law.holding_force() > 0.0;
        }
        let candidates = ws.held.iter().filter(|held| **held).count();
        if candidates > 0 && self.structure.has_modes() {
            ws.condensed.factored = true;
            if self.structure.condense(solution.frequency, 0..ws.ready, &mut ws.condensed).is_err() {
                return false;
            }
        }
        for _ in 0..candidates {
            if self.settings.truncation.is_some() && ws.held.iter().any(|held| !held) {
                // No estimate looks beyond a contact at rest: as many harmonics as there may be.
                if self.reach(self.rungs[self.top].slots, solution.frequency, ws).is_err() {
                    break;
                }
                ws.goal = self.top;
            }
            ws.point.set(&ws.condensed, self.laws(), ws.ready, &ws.held);
            let Some(residual) = self.solve_around_held(solution.frequency, ws) else { break };
            self.holding_forces(ws);
            let released = self.release_overloaded(ws);
            if released == 0 {
                // Where every contact is held nothing is left out; beyond others nothing is looked at.
                let whole = ws.point.width() == 0;
                (ws.truncation_error, ws.sampling_error) = (None, None);
                if whole {
                    self.exactly(ws);
                }
                let held = ws.held.iter().filter(|held| **held).count();
                let status = if held == candidates { Status::Stuck } else { Status::Converged };
                self.report(status, residual, ws, solution);
                return true;
            }
            if ws.held.iter().all(|held| !*held) {
                break;
            }
        }
        ws.held.fill(false);
        ws.point.set(&ws.condensed, self.laws(), ws.ready, &ws.held);
        false
    }

    /// The balance of the contacts that are not held; its relative residual.
    fn solve_around_held(&self, hertz: f64, ws: &mut Workspace) -> Option<f64> {
        ws.unknowns.fill(c64::ZERO);
        ws.balance[ws.goal].forces.fill(c64::ZERO);
        let nothing_pushes = || ws.point.excitation_norm(self.rungs[ws.goal].slots) == 0.0;
        if ws.point.width() == 0 || (self.joints.is_empty() && nothing_pushes()) {
            return Some(0.0);
        }
        self.secant_start(ws);
        let mut outcome = self.climb(0, ws);
        if !outcome.converged {
            outcome = self.fall_back(hertz, ws);
        }
        outcome.converged.then_some(outcome.residual)
    }

    /// Forces that keep the held contacts at rest, into `ws.holding`.
    pub(crate) fn holding_forces(&self, ws: &mut Workspace) {
        let all = self.rows();
        let last = ws.goal;
        ws.holding.fill(c64::ZERO);
        for slot in 0..self.rungs[last].slots {
            let Workspace { point, condensed, balance, holding, unknowns, .. } = ws;
            point.holding_forces(condensed, slot, &balance[last].forces, unknowns, |contact, force| {
                holding[slot * all + contact] = force;
            });
        }
    }

    /// Releases every held contact whose holding force exceeds its limit at some instant; how many.
    fn release_overloaded(&self, ws: &mut Workspace) -> usize {
        let mut released = 0;
        for (c, contact) in self.contacts.iter().enumerate() {
            if !ws.held[c] {
                continue;
            }
            let limit = contact.law.holding_force() * contact.scale;
            if self.peak_holding_force(c, ws) > limit * (1.0 + HOLDING_SLACK) {
                ws.held[c] = false;
                released += 1;
            }
        }
        released
    }

    /// max |f(t)| of the holding force of contact `c`, in N: the extremes of a trigonometric polynomial.
    fn peak_holding_force(&self, c: usize, ws: &mut Workspace) -> f64 {
        let all = self.rows();
        let Rung { transform, slots, .. } = &self.rungs[ws.goal];
        let mut spectrum = vec![c64::ZERO; self.harmonics.highest() + 1];
        for (slot, &order) in self.harmonics.reduced.iter().enumerate().take(*slots) {
            spectrum[order] = ws.holding[slot * all + c];
        }
        let mean = spectrum.first().map_or(0.0, |mean| mean.re);
        let mut buffers = transform.buffers();
        let mut force = vec![0.0; transform.samples()];
        let mut rate = vec![0.0; transform.samples()];
        transform.to_time(spectrum.iter().copied(), &mut force, &mut buffers);
        let derivative = spectrum.iter().enumerate().map(|(k, f)| c64::new(-f.im, f.re) * k as f64);
        transform.to_time(derivative, &mut rate, &mut buffers);
        let mut extremes = TurningPoints::default();
        let motion =
            Motion { spectrum: &spectrum, displacement: &force, velocity: &rate, odd: false, omega: 0.0 };
        match extremes.find(&motion) {
            Ok(()) => extremes.points().iter().fold(0.0, |peak, p| peak.max(p.displacement.abs())),
            Err(_) => mean.abs(),
        }
    }
}
