//! Ways back from an easier structure: one with more damping, or, as a last resort, at a nearby frequency. The ways are
//! the same for every sweep, so a point still does not depend on its neighbours.

use faer::c64;

use crate::balance::Homotopy;
use crate::newton::Outcome;
use crate::plan::Plan;
use crate::workspace::Workspace;

/// Frequencies tried, relative to the one asked for.
const DETOURS: [f64; 8] = [1.05, 0.95, 1.12, 0.89, 1.3, 0.77, 1.6, 0.62];

/// Steps of one way back, failed ones included.
const STEPS: usize = 60;

/// The shortest step of a way back, as a fraction of it.
const SHORTEST: f64 = 1e-3;

/// Structural damping that makes a point easy.
const DAMPING: f64 = 1.0;

impl Plan {
    /// Solves at frequencies around `hertz` until one leads back to it. Leaves the workspace at `hertz`.
    pub(crate) fn detour(&self, hertz: f64, ws: &mut Workspace) -> Outcome {
        let mut outcome = Outcome::NONE;
        if hertz > 0.0 {
            for factor in DETOURS {
                ws.stats.detours += 1;
                outcome = self.way_back(|left| (hertz * factor.powf(left), 0.0), ws);
                if outcome.converged {
                    return outcome;
                }
            }
        }
        self.move_to((hertz, 0.0), ws);
        outcome
    }

    /// From much structural damping to that of the model. Leaves the workspace at `hertz`.
    pub(crate) fn damping_homotopy(&self, hertz: f64, ws: &mut Workspace) -> Outcome {
        ws.stats.damping_homotopies += 1;
        let outcome = self.way_back(|left| (hertz, DAMPING * left * left), ws);
        if !outcome.converged {
            self.move_to((hertz, 0.0), ws);
        }
        outcome
    }

    /// Condenses at a frequency with added damping, keeping the motion in the unknowns; whether the structure allows it.
    fn move_to(&self, (hertz, damping): (f64, f64), ws: &mut Workspace) -> bool {
        let slots = self.rungs[ws.goal].slots;
        let count = slots * ws.point.width();
        let width = ws.point.width().max(1);
        for (entry, unknown) in ws.unknowns.iter_mut().enumerate().take(count) {
            *unknown *= ws.point.length[entry % width];
        }
        ws.condensed.added_damping = damping;
        let regular = self.structure.condense(hertz, 0..slots, &mut ws.condensed).is_ok();
        ws.ready = slots;
        ws.point.set(&ws.condensed, self.laws(), slots, &ws.held);
        for (entry, unknown) in ws.unknowns.iter_mut().enumerate().take(count) {
            *unknown /= ws.point.length[entry % width];
        }
        regular
    }

    /// From a solution at `place(1)` (a frequency and added damping) to `place(0)` in steps that adapt to success.
    fn way_back(&self, place: impl Fn(f64) -> (f64, f64), ws: &mut Workspace) -> Outcome {
        let (last, slots) = (ws.goal, self.rungs[ws.goal].slots);
        let count = slots * ws.point.width();
        if !self.move_to(place(1.0), ws) {
            return Outcome::NONE;
        }
        ws.unknowns[..count].fill(c64::ZERO);
        self.secant_start(ws);
        let mut outcome = self.climb(0, ws);
        if !outcome.converged {
            return outcome;
        }
        let mut lengths: Vec<f64> = ws.point.length.clone();
        ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
        let (mut left, mut step) = (1.0_f64, 0.25_f64);
        for _ in 0..STEPS {
            let next = (left - step).max(0.0);
            if !self.move_to(place(next), ws) {
                return Outcome::NONE;
            }
            outcome = self.iterate(last, slots, Homotopy::NONE, ws);
            if outcome.converged {
                if next == 0.0 {
                    return outcome;
                }
                left = next;
                step *= 1.5;
                lengths.clone_from(&ws.point.length);
                ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
            } else {
                step *= 0.3;
                if step < SHORTEST {
                    break;
                }
                // Back to the last solution, in the units of where it will be used from.
                let width = ws.point.width().max(1);
                for entry in 0..count {
                    ws.unknowns[entry] =
                        ws.kept[entry] * (lengths[entry % width] / ws.point.length[entry % width]);
                }
            }
        }
        Outcome { converged: false, ..outcome }
    }
}
