//! The response at one frequency: from the closed form, the ladder, or at rest.

use contact::{ContactState, LawError};
use faer::c64;

use crate::balance::Homotopy;
use crate::dense::Entry;
use crate::newton::Outcome;
use crate::plan::Plan;
use crate::scalar::{Root, ScalarBalance};
use crate::settings::Start;
use crate::solution::{FailureReason, Solution, Stats, Status};
use crate::workspace::Workspace;

/// A residual of the closed form, relative to the excitation, above which a root is not told from rounding.
const UNRESOLVED: f64 = 1e-7;

/// How the ladder above the solutions of the first harmonic ended.
enum Climb {
    /// At least one solution is reported.
    Solved,
    /// The best of the attempts.
    Failed(Outcome),
    /// With one harmonic the contact can only be at rest.
    Held,
}

impl Plan {
    /// The response at `frequency` in Hz, independent of any other point (also where a march is set: that is what
    /// [`crate::sweep`] does with [`Plan::solve_next`]).
    pub fn solve(&self, frequency: f64, workspace: &mut Workspace) -> Solution {
        let mut solution = Solution::default();
        self.solve_into(frequency, workspace, &mut solution);
        solution
    }

    /// As [`Plan::solve`], into a solution whose memory is reused: nothing is allocated once the buffers have grown,
    /// unless other solutions are asked for, a contact with a set-valued law may be at rest, or the ladder fails.
    pub fn solve_into(&self, frequency: f64, ws: &mut Workspace, solution: &mut Solution) {
        ws.has_previous = false;
        self.solve_next(frequency, ws, solution);
    }

    /// As [`Plan::solve_into`], but a march starts from the point solved last in this workspace. Where that fails
    /// the point starts on its own.
    pub fn solve_next(&self, frequency: f64, ws: &mut Workspace, solution: &mut Solution) {
        solution.clear(frequency, self.settings.harmonics);
        ws.stats = Stats::default();
        ws.held.fill(false);
        ws.newton.history.clear();
        (ws.truncation_error, ws.sampling_error) = (None, None);
        ws.goal = self.first_goal();
        ws.condensed.added_damping = 0.0;
        ws.condensed.factored = false;
        ws.ready = self.rungs[ws.goal].slots;
        if let Err(harmonic) = self.structure.condense(frequency, 0..ws.ready, &mut ws.condensed) {
            ws.has_previous = false;
            return solution.fail(FailureReason::SingularStructure { harmonic });
        }
        ws.point.set(&ws.condensed, self.laws(), ws.ready, &ws.held);
        let marching = self.settings.start == Start::March && ws.has_previous;
        if ws.point.excitation_norm(ws.ready) == 0.0 && self.joints_rest(ws) {
            self.at_rest_without_load(ws, solution);
        } else if marching && self.march(frequency, ws, solution) {
            // The previous point led here.
        } else if self.linear {
            self.linear(ws, solution);
        } else if self.scalar {
            self.closed_form(ws, solution);
        } else {
            self.iterative(ws, solution);
        }
        if solution.status.solved() && !solution.is_finite() {
            solution.fail(FailureReason::NotConverged);
        }
        self.judge(solution);
        solution.stats = ws.stats;
        ws.has_previous = solution.status.solved();
    }

    /// Nothing is left out of this solution.
    pub(crate) fn exactly(&self, ws: &mut Workspace) {
        if self.settings.estimate || self.settings.truncation.is_some() {
            (ws.truncation_error, ws.sampling_error) = (Some(0.0), Some(0.0));
        }
    }

    /// Whether no joint pushes at its reference position, as one with an interference does. Leaves that evaluation behind.
    fn joints_rest(&self, ws: &mut Workspace) -> bool {
        if self.joints.is_empty() {
            return true;
        }
        let (goal, first) = (ws.goal, ws.point.width() - self.joint_rows);
        ws.unknowns.fill(c64::ZERO);
        let Workspace { point, unknowns, balance, .. } = ws;
        let evaluated = self.balance(goal).evaluate(
            point,
            self.rungs[goal].slots,
            Homotopy::NONE,
            unknowns,
            &mut balance[goal],
        );
        let width = point.width();
        let mut forces = balance[goal].forces.iter().enumerate();
        evaluated.is_ok() && forces.all(|(entry, force)| entry % width < first || *force == c64::ZERO)
    }

    /// Nothing moves the contacts.
    fn at_rest_without_load(&self, ws: &mut Workspace, solution: &mut Solution) {
        ws.unknowns.fill(c64::ZERO);
        // Nor do joints push: they are evaluated already.
        ws.balance[ws.goal].forces.fill(c64::ZERO);
        for held in &mut ws.held {
            *held = true;
        }
        ws.point.set(&ws.condensed, self.laws(), ws.ready, &ws.held);
        self.holding_forces(ws);
        self.exactly(ws);
        self.report(Status::Converged, 0.0, ws, solution);
        for (contact, report) in self.contacts.iter().zip(&mut solution.contacts) {
            report.state =
                if contact.law.holding_force() > 0.0 { ContactState::Held } else { ContactState::Stick };
        }
    }

    /// All laws are linear: one linear system a harmonic.
    fn linear(&self, ws: &mut Workspace, solution: &mut Solution) {
        let (last, slots) = (ws.goal, ws.ready);
        self.solve_linearised(slots, self.first_slot().unwrap_or(0), ws);
        self.exactly(ws);
        let evaluated = self.balance(last).evaluate(
            &ws.point,
            slots,
            Homotopy::NONE,
            &ws.unknowns,
            &mut ws.balance[last],
        );
        match evaluated {
            Ok(residual) => {
                solution.solutions = Some(1);
                self.report(Status::Converged, residual / ws.point.excitation_norm(slots), ws, solution);
            }
            Err(error) => self.fail(Some(error), f64::INFINITY, ws, solution),
        }
    }

    /// The balance of the first harmonic at the only contact.
    fn scalar_balance<'a>(&'a self, ws: &Workspace) -> Option<ScalarBalance<'a>> {
        let contact = self.contacts.first()?;
        let slot = self.first_slot()?;
        let free = ws.condensed.free[slot];
        if free == c64::ZERO {
            return None;
        }
        Some(ScalarBalance {
            law: contact.law.describing_function()?,
            scale: contact.scale,
            receptance: ws.condensed.receptance[slot],
            own: 1.0 - ws.condensed.receptance[slot] * ws.condensed.lent[slot],
            free: free.magnitude(),
            length: contact.law.length().unwrap_or(free.magnitude()),
        })
    }

    /// Puts a root of the scalar balance into the unknowns and forces of rung 0.
    fn place_root(&self, root: &Root, ws: &mut Workspace) {
        let (Some(slot), length, force) = (self.first_slot(), ws.point.length[0], ws.point.force[0]) else {
            return;
        };
        let displacement = root.displacement(ws.condensed.free[slot]);
        ws.unknowns.fill(c64::ZERO);
        ws.balance[0].forces.fill(c64::ZERO);
        ws.unknowns[slot] = displacement / length;
        ws.balance[0].forces[slot] = root.force * (displacement / root.a) / force;
        if let (1, Some(mean)) = (slot, self.free_mean(ws)) {
            ws.unknowns[0] = mean;
        }
    }

    /// The dimensionless mean displacement that no contact force opposes, `û⁰/(1 − Ĝ Ŝ)`; `None` where the structure does
    /// not determine it.
    fn free_mean(&self, ws: &Workspace) -> Option<c64> {
        let (free, lent) = (ws.point.free[0], ws.point.lent[0]);
        match ws.condensed.singular.first() {
            Some(true) if free != c64::ZERO => None,
            Some(true) => Some(c64::ZERO),
            _ => Some(free / (1.0 - ws.point.receptance[0] * lent)),
        }
    }

    /// One harmonic, one contact: all solutions, the one of largest amplitude first, at rest only if it is alone.
    fn closed_form(&self, ws: &mut Workspace, solution: &mut Solution) {
        let Some(balance) = self.scalar_balance(ws) else {
            return self.iterative(ws, solution);
        };
        if self.first_slot() == Some(1) && self.free_mean(ws).is_none() {
            return self.fail(None, f64::INFINITY, ws, solution);
        }
        let mut roots = std::mem::take(&mut ws.roots);
        roots.clear();
        balance.roots(&mut roots);
        roots.reverse();
        let negative = roots.iter().copied().find(Root::creates_energy);
        roots.retain(|root| !root.creates_energy());
        // Of a root so large that rounding hides the excitation nothing is known, unless there is no other.
        let resolved = |root: &Root| root.residual <= UNRESOLVED;
        if roots.iter().any(resolved) {
            roots.retain(resolved);
        }
        let (mut reported, largest) = (false, roots.first().copied());
        for root in roots.iter().take(if self.settings.all_solutions { usize::MAX } else { 1 }) {
            self.place_root(root, ws);
            if self.estimating() {
                let closed = Outcome { converged: true, ..Outcome::NONE };
                self.complete(closed, solution.frequency, ws);
                self.place_root(root, ws);
            }
            if reported {
                let mut other = Solution::empty(solution.frequency, solution.harmonics);
                self.report(Status::Converged, root.residual, ws, &mut other);
                solution.others.push(other);
            } else {
                self.report(Status::Converged, root.residual, ws, solution);
            }
            reported = true;
        }
        let mut count = roots.len();
        ws.roots = roots;
        let can_hold = balance.can_hold();
        if can_hold {
            let mut rest = Solution::empty(solution.frequency, solution.harmonics);
            let held = match reported {
                true => self.try_holding(ws, &mut rest),
                false => self.try_holding(ws, solution),
            };
            count += usize::from(held);
            if held && reported && self.settings.all_solutions {
                solution.others.push(rest);
            }
            if let Some(root) = largest {
                // The workspace is left with what is reported.
                ws.held.fill(false);
                ws.point.set(&ws.condensed, self.laws(), ws.ready, &ws.held);
                self.place_root(&root, ws);
            }
            reported |= held;
        }
        match reported {
            true => solution.solutions = Some(count),
            // Held by the first harmonic alone, but not together with a static load.
            false if can_hold => self.fail(Some(LawError::NoMotion), f64::INFINITY, ws, solution),
            false => {
                let alpha = |root: Root| LawError::NegativeMagnitude { alpha: root.a / balance.length };
                self.fail(negative.map(alpha), f64::INFINITY, ws, solution);
            }
        }
    }

    /// Newton's method from every start; at rest when nothing slides.
    fn iterative(&self, ws: &mut Workspace, solution: &mut Solution) {
        let start = self.scalar_balance(ws).filter(|_| self.scalar_start);
        let mut outcome = match start {
            Some(balance) => match self.climb_from_roots(&balance, ws, solution) {
                Climb::Solved => return,
                Climb::Failed(outcome) => outcome,
                Climb::Held if self.try_holding(ws, solution) => return,
                Climb::Held => Outcome { law_error: Some(LawError::NoMotion), ..Outcome::NONE },
            },
            None => {
                self.secant_start(ws);
                self.climb(0, ws)
            }
        };
        if !outcome.converged && !self.joints.is_empty() {
            self.open_start(ws);
            outcome = self.climb(0, ws);
        }
        if !outcome.converged
            && let Some(goal) = self.second_goal(ws)
            && self.reach(self.rungs[goal].slots, solution.frequency, ws).is_ok()
        {
            ws.goal = goal;
            self.secant_start(ws);
            outcome = self.climb(0, ws);
        }
        if !outcome.converged {
            let law_error = outcome.law_error;
            outcome = self.fall_back(solution.frequency, ws);
            outcome.law_error = outcome.law_error.or(law_error);
        }
        if outcome.converged {
            return self.accept(outcome, false, ws, solution);
        }
        if !self.try_holding(ws, solution) {
            self.fail(outcome.law_error, outcome.residual, ws, solution);
        }
    }

    /// The ladder above every solution of the first harmonic, the largest amplitude first.
    fn climb_from_roots(
        &self,
        balance: &ScalarBalance,
        ws: &mut Workspace,
        solution: &mut Solution,
    ) -> Climb {
        let mut roots = std::mem::take(&mut ws.roots);
        roots.clear();
        balance.roots(&mut roots);
        roots.reverse();
        ws.stats.starts = roots.len();
        let mut failed = Outcome::NONE;
        let mut found = false;
        for root in &roots {
            self.place_root(root, ws);
            // A ladder of one rung is climbed all the same: its balance is asked for, not the closed form.
            ws.goal = self.first_goal();
            let outcome = self.climb(usize::from(ws.goal > 0), ws);
            if outcome.converged {
                self.accept(outcome, found, ws, solution);
                found = true;
                if !self.settings.all_solutions {
                    break;
                }
            } else if outcome.residual < failed.residual {
                failed = outcome;
            }
        }
        let nothing_slides = roots.is_empty() && balance.can_hold();
        ws.roots = roots;
        match (found, nothing_slides) {
            (true, _) => Climb::Solved,
            (false, true) => Climb::Held,
            (false, false) => Climb::Failed(failed),
        }
    }

    /// Reports a converged iteration, as a further solution when one is reported already and this one is new.
    fn accept(&self, outcome: Outcome, further: bool, ws: &mut Workspace, solution: &mut Solution) {
        let outcome = self.complete(outcome, solution.frequency, ws);
        if !further {
            return self.report(Status::Converged, outcome.residual, ws, solution);
        }
        let mut other = Solution::empty(solution.frequency, solution.harmonics);
        // A march goes on from the solution that is reported first.
        ws.solved.copy_from_slice(&ws.previous);
        self.report(Status::Converged, outcome.residual, ws, &mut other);
        ws.previous.copy_from_slice(&ws.solved);
        let known = std::iter::once(&*solution).chain(&solution.others);
        if known.into_iter().all(|s| s.differs_from(&other)) {
            solution.others.push(other);
        }
    }

    fn fail(&self, law_error: Option<LawError>, residual: f64, ws: &Workspace, solution: &mut Solution) {
        let reason = match law_error {
            Some(LawError::NoMotion) => FailureReason::HoldingLimit,
            Some(error @ (LawError::NegativeMagnitude { .. } | LawError::NoPeriodicState { .. })) => {
                FailureReason::Law(error)
            }
            _ if self.singular_harmonic(ws).is_some() => {
                FailureReason::SingularStructure { harmonic: self.singular_harmonic(ws).unwrap_or(0) }
            }
            _ => FailureReason::NotConverged,
        };
        solution.fail(reason);
        solution.residual = residual;
        solution.residual_history.extend_from_slice(&ws.newton.history);
    }

    /// The harmonic of Ω at which the structure alone is singular, if there is one.
    fn singular_harmonic(&self, ws: &Workspace) -> Option<usize> {
        let slot = ws.condensed.singular.iter().take(ws.ready).position(|singular| *singular)?;
        self.harmonics.orders.get(slot).copied()
    }

    /// The paper's strategy: damped Newton from the previous frequency's solution.
    fn march(&self, hertz: f64, ws: &mut Workspace, solution: &mut Solution) -> bool {
        let width = ws.point.width();
        for entry in 0..ws.ready * width {
            ws.unknowns[entry] = ws.previous[entry] / ws.point.length[entry % width];
        }
        let mut outcome = self.iterate(ws.goal, ws.ready, Homotopy::NONE, ws);
        if outcome.converged {
            outcome = self.complete(outcome, hertz, ws);
            self.report(Status::Converged, outcome.residual, ws, solution);
        }
        outcome.converged
    }
}
