//! How far a solution is from the one with all harmonics, and how many harmonics a point needs.
//!
//! A solution with N harmonics is compared with the one of about 2N, of which only the leading digits are needed: the
//! new harmonics by substitution, then as many Newton steps as it takes. What both leave out is small against what only
//! the first leaves out, since the errors of forces with kinks fall like (N + 1)^−3.5.

use faer::c64;

use crate::balance::Homotopy;
use crate::harmonics::beyond;
use crate::newton::Outcome;
use crate::plan::Plan;
use crate::rows::joint_rows;
use crate::workspace::Workspace;

/// What the difference to twice the harmonics is multiplied with: the part of the error that both have in common, and
/// spectra that fall unevenly.
const SAFETY: f64 = 2.0;

/// The difference between two numbers of samples is multiplied with this.
const SAMPLING_SAFETY: f64 = 1.5;

/// An estimate needs this many digits of a difference.
const DIGITS: f64 = 0.03;

/// What rounding leaves in any solution.
const ROUNDING: f64 = 1e-13;

/// A dof that moves less than this part of the one that moves most is measured against that part.
const AT_REST: f64 = 1e-6;

/// Newton steps for the leading digits.
const FEW_STEPS: usize = 10;

/// Where the search for a number of harmonics goes when the first rung of an adaptive ladder cannot be solved.
const SAFE_RUNG: usize = 3;

impl Plan {
    /// The first rung whose solution may be the answer.
    pub(crate) fn first_goal(&self) -> usize {
        if self.settings.truncation.is_some() { 0 } else { self.top }
    }

    /// Where to look when nothing was found at the first goal; `None` when that was all.
    pub(crate) fn second_goal(&self, ws: &Workspace) -> Option<usize> {
        let goal = SAFE_RUNG.min(self.top);
        (goal > ws.goal).then_some(goal)
    }

    /// Condenses as many harmonics as `slots` at this frequency, if that is not done yet; whether it can be done.
    pub(crate) fn reach(&self, slots: usize, hertz: f64, ws: &mut Workspace) -> Result<(), usize> {
        if slots > ws.ready {
            self.structure.condense(hertz, ws.ready..slots, &mut ws.condensed)?;
            ws.point.add(&ws.condensed, ws.ready..slots);
            ws.ready = slots;
        }
        Ok(())
    }

    /// Whether errors of solutions are estimated.
    pub(crate) fn estimating(&self) -> bool {
        self.settings.estimate || self.settings.truncation.is_some()
    }

    /// Completes a solution of `ws.goal`: estimates its errors where that is wanted, and takes more harmonics until the
    /// estimate meets the tolerance, or none are left.
    pub(crate) fn complete(&self, outcome: Outcome, hertz: f64, ws: &mut Workspace) -> Outcome {
        (ws.truncation_error, ws.sampling_error) = (None, None);
        if !self.estimating() {
            return outcome;
        }
        let mut outcome = outcome;
        loop {
            ws.sampling_error = self.sampling_error(ws);
            let count = self.rungs[ws.goal].slots * ws.point.width();
            ws.solved[..count].copy_from_slice(&ws.unknowns[..count]);
            let error = self.look_beyond(hertz, ws);
            ws.truncation_error = error;
            let enough = match (self.settings.truncation, error) {
                (None, _) => true,
                (Some(tolerance), Some(error)) if error <= tolerance => true,
                _ => ws.goal >= self.top,
            };
            let above = self.rungs[(ws.goal + 1).min(self.top)].slots;
            if !enough && self.reach(above, hertz, ws).is_ok() {
                ws.goal += 1;
                let mut next = match error {
                    Some(_) => self.iterate(ws.goal, above, Homotopy::NONE, ws),
                    None => Outcome::NONE,
                };
                if !next.converged {
                    ws.unknowns[..count].copy_from_slice(&ws.solved[..count]);
                    next = self.climb(ws.goal, ws);
                }
                if !next.converged {
                    next = self.fall_back(hertz, ws);
                }
                if next.converged {
                    outcome = next;
                    continue;
                }
                ws.goal -= 1;
            }
            ws.unknowns[..count].copy_from_slice(&ws.solved[..count]);
            // Ways around a failed ladder go over lower rungs: what is reported has to be this one's again.
            let Workspace { goal, point, unknowns, balance, .. } = ws;
            let slots = self.rungs[*goal].slots;
            let _ = self.balance(*goal).evaluate(point, slots, Homotopy::NONE, unknowns, &mut balance[*goal]);
            return outcome;
        }
    }

    /// Estimate of the relative l2 error of the displacement spectrum, the worst of the output dofs, of the solution in
    /// the workspace. Leaves a solution with more harmonics in the unknowns.
    fn look_beyond(&self, hertz: f64, ws: &mut Workspace) -> Option<f64> {
        if self.linear || self.harmonics.asked == 0 || ws.point.width() == 0 {
            return Some(0.0);
        }
        let here = ws.goal;
        let wanted = beyond(self.rungs[here].order);
        let there = self.rungs.iter().position(|rung| rung.order >= wanted)?;
        let (from, to) = (self.rungs[here].slots, self.rungs[there].slots);
        if ws.point.width() < self.rows() || self.reach(to, hertz, ws).is_err() {
            return None;
        }
        let mut near = std::mem::take(&mut ws.outputs.0);
        self.outputs(here, &mut near, ws);
        let stats = ws.stats;
        std::mem::swap(&mut ws.newton.history, &mut ws.history);
        let found = self.leading_digits(hertz, there, (from, to), ws);
        std::mem::swap(&mut ws.newton.history, &mut ws.history);
        if self.settings.truncation.is_none() {
            ws.stats = stats;
        }
        let mut far = std::mem::take(&mut ws.outputs.1);
        self.outputs(there, &mut far, ws);
        let error = difference(&near, from, &far, to);
        ws.outputs = (near, far);
        (found && error.is_finite()).then_some(SAFETY * error + ROUNDING)
    }

    /// The solution of rung `there` to a few digits, from the one with the first `from` harmonics; whether it was found.
    fn leading_digits(
        &self,
        hertz: f64,
        there: usize,
        (from, to): (usize, usize),
        ws: &mut Workspace,
    ) -> bool {
        let width = ws.point.width();
        let count = from * width;
        self.extend(there, from, to, ws);
        let added: f64 = (count..to * width)
            .map(|entry| (ws.unknowns[entry] * ws.point.weight[entry]).norm_sqr())
            .sum::<f64>()
            .sqrt();
        let tolerance = (DIGITS * added / ws.point.excitation_norm(to)).max(self.settings.tolerance);
        let mut outcome = self.iterate_roughly(there, to, tolerance, FEW_STEPS, ws);
        if !outcome.converged {
            ws.unknowns[..count].copy_from_slice(&ws.solved[..count]);
            let goal = std::mem::replace(&mut ws.goal, there);
            outcome = self.climb(there, ws);
            if !outcome.converged {
                outcome = self.fall_back(hertz, ws);
            }
            ws.goal = goal;
        }
        outcome.converged
    }

    /// Displacements of the output dofs in m, entry `[o][slot]`, of the motion and the forces last evaluated in `rung`;
    /// without any output dofs those of the rows. No contact is held.
    fn outputs(&self, rung: usize, rows: &mut Vec<c64>, ws: &Workspace) {
        let (slots, width, outputs) = (self.rungs[rung].slots, ws.point.width(), ws.condensed.outputs);
        rows.clear();
        if outputs == 0 {
            let of =
                |c: usize| (0..slots).map(move |slot| ws.unknowns[slot * width + c] * ws.point.length[c]);
            rows.extend((0..width).flat_map(of));
        }
        for o in 0..outputs {
            for slot in 0..slots {
                rows.push(match self.structure.path_to_ground(o) {
                    Some(path) => path
                        .iter()
                        .map(|&(c, sign)| ws.unknowns[slot * width + c] * (ws.point.length[c] * sign))
                        .sum(),
                    None => {
                        let entry = slot * outputs + o;
                        let pull: c64 = (0..width)
                            .map(|c| {
                                let source = slot * width + c;
                                let force = ws.balance[rung].forces[source];
                                let felt = ws.point.felt(source, force, ws.unknowns[source]);
                                ws.condensed.recovery[entry * width + c] * felt * ws.point.force[c]
                            })
                            .sum();
                        ws.condensed.free_output[entry] - pull
                    }
                });
            }
        }
    }

    /// Estimate of the relative l2 error of the relative displacement from the finite number of samples, the worst of
    /// the contacts and joints: the Newton step that more samples would make. `None` where it cannot be made.
    fn sampling_error(&self, ws: &mut Workspace) -> Option<f64> {
        let free = self.linear || self.scalar || self.harmonics.asked == 0;
        if free || !self.has_samples() || ws.point.width() == 0 {
            return Some(0.0);
        }
        let slots = self.rungs[ws.goal].slots;
        let samples = self.rungs[ws.goal].transform.samples();
        let finer = self.rungs.iter().position(|rung| rung.transform.samples() > samples)?;
        if !self.correction(finer, slots, ws) {
            return None;
        }
        let width = ws.point.width();
        let sums = |row: usize| {
            let entries = || (0..slots).map(|slot| slot * width + row);
            let size: f64 = entries().map(|entry| ws.unknowns[entry].norm_sqr()).sum();
            let change: f64 = entries().map(|entry| ws.kept[entry].norm_sqr()).sum();
            (change, size)
        };
        let part = |(change, size): (f64, f64)| if change > 0.0 { (change / size).sqrt() } else { 0.0 };
        // The directions of a joint together: it may hardly move in one of them.
        let together = |rows: std::ops::Range<usize>| {
            rows.fold((0.0, 0.0), |all, row| {
                let (square, (change, size)) = (ws.point.length[row].powi(2), sums(row));
                (all.0 + change * square, all.1 + size * square)
            })
        };
        let scalar = width - self.joint_rows;
        let joints = joint_rows(scalar, &self.joints).map(|(_, rows)| part(together(rows)));
        let worst = (0..scalar).map(|row| part(sums(row))).chain(joints).fold(0.0, f64::max);
        // The error falls with the square of the number of samples.
        let ratio = samples as f64 / self.rungs[finer].transform.samples() as f64;
        Some(SAMPLING_SAFETY * worst / (1.0 - ratio * ratio))
    }
}

/// Relative l2 difference of two sets of spectra, rows of `from` and `to` harmonics; the worst row.
fn difference(near: &[c64], from: usize, far: &[c64], to: usize) -> f64 {
    let size = |row: &[c64]| row.iter().map(|w| w.norm_sqr()).sum::<f64>().sqrt();
    let largest = far.chunks_exact(to).map(size).fold(0.0, f64::max);
    let rows = near.chunks_exact(from).zip(far.chunks_exact(to));
    let errors = rows.map(|(near, far)| {
        let padded = near.iter().copied().chain(std::iter::repeat(c64::ZERO));
        let change: f64 = far.iter().zip(padded).map(|(far, near)| (far - near).norm_sqr()).sum();
        if change == 0.0 { 0.0 } else { change.sqrt() / size(far).max(AT_REST * largest) }
    });
    errors.fold(0.0, f64::max)
}
