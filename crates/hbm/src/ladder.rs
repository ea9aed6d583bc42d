//! Starts and fallbacks at one frequency: the ladder in N, homotopies, perturbed starts. All of it happens inside the
//! point, so that no point depends on a neighbour.

use faer::c64;

use crate::balance::Homotopy;
use crate::newton::{self, Criteria, Outcome, Task};
use crate::plan::{Plan, Rung};
use crate::point::Point;
use crate::settings::many;
use crate::workspace::Workspace;

/// Up to this harmonic of the base frequency Newton's method costs no more than substitution.
const LEAST_CORE: usize = 31;

/// Relative residual to which a rung on the way is solved: beyond it its own truncation error is larger.
const ROUGHLY: f64 = 3e-3;

impl Plan {
    /// Newton's method with the transform of `rung` on the first `slots` harmonics.
    pub(crate) fn iterate(
        &self,
        rung: usize,
        slots: usize,
        homotopy: Homotopy,
        ws: &mut Workspace,
    ) -> Outcome {
        self.iterate_with(rung, slots, homotopy, self.criteria(), ws)
    }

    pub(crate) fn iterate_with(
        &self,
        rung: usize,
        slots: usize,
        homotopy: Homotopy,
        criteria: Criteria,
        ws: &mut Workspace,
    ) -> Outcome {
        let task = Task { criteria, ..self.task(rung, slots, homotopy, &ws.point) };
        let outcome = newton::solve(&task, &mut ws.unknowns, &mut ws.balance[rung], &mut ws.newton);
        ws.stats.iterations += outcome.iterations;
        outcome
    }

    fn task<'a>(&'a self, rung: usize, slots: usize, homotopy: Homotopy, point: &'a Point) -> Task<'a> {
        let core = self.core(slots, point);
        let balance = self.balance(rung);
        let krylov = self.settings.krylov(balance.size(point.width(), core), point.width());
        Task { balance, point, slots, core, krylov, homotopy, criteria: self.criteria() }
    }

    /// Newton's method on the first `slots` harmonics, until the residual is below `tolerance`, in a few steps.
    pub(crate) fn iterate_roughly(
        &self,
        rung: usize,
        slots: usize,
        tolerance: f64,
        steps: usize,
        ws: &mut Workspace,
    ) -> Outcome {
        let rough = Criteria { tolerance, max_iterations: steps, polish: false, ..self.criteria() };
        self.iterate_with(rung, slots, Homotopy::NONE, rough, ws)
    }

    /// The step that Newton's method with the samples of `rung` would make, into `kept`; whether there is one.
    pub(crate) fn correction(&self, rung: usize, slots: usize, ws: &mut Workspace) -> bool {
        let task = self.task(rung, slots, Homotopy::NONE, &ws.point);
        let Workspace { unknowns, kept, balance, newton, .. } = ws;
        newton::correction(&task, unknowns, kept, &mut balance[rung], newton)
    }

    /// How many of the first `slots` harmonics need Newton's method.
    pub(crate) fn core(&self, slots: usize, point: &Point) -> usize {
        if !self.settings.slaving {
            return slots;
        }
        let enough = |rung: &&Rung| rung.slots >= point.contracting && rung.order >= self.least_core();
        self.rungs.iter().find(enough).map_or(slots, |rung| rung.slots.min(slots))
    }

    /// Fewer harmonics than these are not worth a tail.
    pub(crate) fn least_core(&self) -> usize {
        LEAST_CORE.max(self.harmonics.highest_excited)
    }

    /// The ladder from rung `from` on: each rung's solution starts the next, new harmonics by one substitution. A rung
    /// that fails is climbed harmonic by harmonic; one that fails even so is left out.
    pub(crate) fn climb(&self, from: usize, ws: &mut Workspace) -> Outcome {
        let width = ws.point.width();
        let mut reached = match from {
            0 => 0,
            _ => self.rungs[from - 1].slots,
        };
        let goal = ws.goal;
        let core = self.core(self.rungs[goal].slots, &ws.point);
        let mut outcome = Outcome { converged: from > goal, residual: 0.0, ..Outcome::NONE };
        // So many harmonics are solved, and one more fails.
        let mut stuck = 0;
        // The rung whose evaluation is that of the unknowns so far.
        let mut below = None;
        for (index, rung) in self.rungs.iter().enumerate().take(goal + 1).skip(from) {
            // Between the harmonics that need Newton's method and all of them there is nothing to climb.
            if rung.slots > core && index < goal && reached >= core {
                continue;
            }
            ws.stats.rungs += 1;
            let count = reached * width;
            ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
            match below.take().filter(|_| self.samples_all()) {
                Some(below) => self.extend_from(below, reached, rung.slots, ws),
                None => self.extend(index, reached, rung.slots, ws),
            }
            outcome = if index < goal {
                self.iterate_roughly(index, rung.slots, ROUGHLY, self.settings.max_iterations, ws)
            } else {
                self.iterate(index, rung.slots, Homotopy::NONE, ws)
            };
            if outcome.converged {
                reached = rung.slots;
                below = Some(index);
                continue;
            }
            ws.unknowns[..count].copy_from_slice(&ws.kept[..count]);
            if rung.slots == reached + 1 || reached == stuck {
                // One harmonic more was tried already.
                stuck = reached;
                continue;
            }
            let mut slots = reached;
            while slots > 0 && slots < rung.slots {
                ws.stats.extra_rungs += 1;
                self.extend(index, slots, slots + 1, ws);
                outcome = if slots + 1 < rung.slots || index < goal {
                    self.iterate_roughly(index, slots + 1, ROUGHLY, self.settings.max_iterations, ws)
                } else {
                    self.iterate(index, slots + 1, Homotopy::NONE, ws)
                };
                if !outcome.converged {
                    ws.unknowns[..count].copy_from_slice(&ws.kept[..count]);
                    if slots == reached {
                        stuck = reached;
                    }
                    break;
                }
                slots += 1;
            }
            if outcome.converged {
                reached = rung.slots;
            }
        }
        outcome
    }

    /// Adds harmonics `from..to` to the unknowns, each as the response to the force harmonic of the motion so far; zero where
    /// that makes the residual of many contacts larger.
    pub(crate) fn extend(&self, rung: usize, from: usize, to: usize, ws: &mut Workspace) {
        let width = ws.point.width();
        if from == 0 || from >= to {
            return;
        }
        let range = from * width..to * width;
        ws.unknowns[range.clone()].fill(c64::ZERO);
        let balance = self.balance(rung);
        let Workspace { point, unknowns, balance: buffers, .. } = ws;
        let buffers = &mut buffers[rung];
        let Ok(before) = balance.evaluate(point, to, Homotopy::NONE, unknowns, buffers) else { return };
        for entry in range.clone() {
            unknowns[entry] = -buffers.residual[entry];
        }
        // Contacts side by side overshoot together where the structure answers much; the Newton step knows them all.
        let many = many(balance.size(width, to), width) && point.contracting > from;
        let worse = |after: Result<f64, _>| after.map_or(true, |after| after > before);
        if many && worse(balance.evaluate(point, to, Homotopy::NONE, unknowns, buffers)) {
            unknowns[range].fill(c64::ZERO);
        }
    }

    /// Whether every contact force is sampled: then more of its harmonics are known than the motion has.
    fn samples_all(&self) -> bool {
        let by_events = self.contacts.iter().any(|c| c.law.piecewise_linear().is_some())
            || self.joints.iter().any(|joint| joint.law.piecewise_linear().is_some());
        !(self.exact && by_events)
    }

    /// As [`Plan::extend`], with the forces that rung `below` ended with, and against the secant stiffness of the contact.
    fn extend_from(&self, below: usize, from: usize, to: usize, ws: &mut Workspace) {
        let width = ws.point.width();
        let known = self.rungs[below].transform.samples();
        let first = self.first_slot().filter(|slot| *slot < from);
        for entry in from * width..to * width {
            let slot = entry / width;
            if 2 * self.harmonics.reduced[slot] >= known || slot > 2 * from {
                ws.unknowns[entry] = c64::ZERO;
                continue;
            }
            let forces = &ws.balance[below].forces[slot * width..(slot + 1) * width];
            let row = &ws.point.receptance[entry * width..(entry + 1) * width];
            let pull: c64 = row.iter().zip(forces).map(|(g, force)| g * force).sum();
            let yields = ws.point.yields(entry, first, &ws.balance[below].forces, &ws.unknowns);
            ws.unknowns[entry] = (ws.point.free[entry] - pull) * (ws.point.weight[entry] * yields);
        }
    }
}
