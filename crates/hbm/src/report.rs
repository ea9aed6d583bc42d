//! From the unknowns back to what a user asked for: displacements of output dofs, contact forces, dissipation.

use contact::ContactState;
use faer::c64;
use num_complex::Complex64;

use crate::dense::Entry;
use crate::plan::{Plan, Workspace};
use crate::solution::{ContactSolution, Solution, Status};

impl Plan {
    /// Writes the solution that the workspace holds.
    pub(crate) fn report(&self, status: Status, residual: f64, ws: &mut Workspace, solution: &mut Solution) {
        solution.status = status;
        solution.residual = residual;
        solution.stats = ws.stats;
        solution.residual_history.clear();
        solution.residual_history.extend_from_slice(&ws.newton.history);
        let slots = self.rungs[ws.goal].slots;
        solution.harmonics = self.harmonics_of(ws.goal);
        solution.slaved = if self.scalar || self.linear { 0 } else { slots - self.core(slots, &ws.point) };
        (solution.truncation_error, solution.sampling_error) = (ws.truncation_error, ws.sampling_error);
        solution.contacts.resize_with(self.contacts.len(), ContactSolution::default);
        for (c, contact) in solution.contacts.iter_mut().enumerate() {
            self.report_contact(c, slots, ws, contact);
        }
        self.report_outputs(slots, ws.condensed.outputs, ws, solution);
    }

    fn report_contact(&self, c: usize, slots: usize, ws: &mut Workspace, report: &mut ContactSolution) {
        let all = self.contacts.len();
        let last = ws.goal;
        report.displacement.clear();
        report.force.clear();
        let Some(row) = ws.point.active.iter().position(|&active| active == c) else {
            report.displacement.resize(slots, c64::ZERO);
            report.force.extend((0..slots).map(|slot| -ws.holding[slot * all + c]));
            (report.amplitude, report.dissipation) = (0.0, 0.0);
            (report.state, report.turning_points, report.extrapolated) = (ContactState::Held, 0, false);
            for slot in 0..slots {
                ws.previous[slot * all + c] = c64::ZERO;
            }
            return;
        };
        let width = ws.point.width();
        let (length, unit) = (ws.point.length[row], ws.point.force[row]);
        for slot in 0..slots {
            let displacement = ws.unknowns[slot * width + row] * length;
            report.displacement.push(displacement);
            report.force.push(-ws.balance[last].forces[slot * width + row] * unit);
            ws.previous[slot * all + c] = displacement;
        }
        // ∮ f dw over a base period is π Σ k Im(F_k conj W_k) in rig convention; a period of Ω has `fundamental` of them.
        let work: f64 = (0..slots)
            .map(|slot| {
                let k = self.harmonics.reduced[slot] as f64;
                -k * (report.force[slot] * report.displacement[slot].conj()).im
            })
            .sum();
        report.dissipation = std::f64::consts::PI * work * self.harmonics.fundamental as f64;
        self.report_motion(c, report, ws);
    }

    /// Amplitude, turning points and what the law noticed.
    fn report_motion(&self, c: usize, report: &mut ContactSolution, ws: &mut Workspace) {
        let marks = if self.scalar {
            let first = self.first_slot().and_then(|slot| report.displacement.get(slot));
            report.amplitude = first.map_or(0.0, |w| w.magnitude());
            report.turning_points = 2;
            self.contacts[c].law.describing_function().map(|law| law.marks(report.amplitude))
        } else {
            let buffers = &ws.balance[ws.goal];
            // A contact that does not move has no turning points and no amplitude.
            let _ = ws.turning_points.find(&self.balance(ws.goal).motion(buffers, c));
            report.amplitude = ws.turning_points.amplitude();
            report.turning_points = ws.turning_points.points().len();
            buffers.marks(c)
        };
        report.state = marks.map_or(ContactState::Stick, |marks| marks.state);
        report.extrapolated = marks.is_some_and(|marks| marks.extrapolated);
    }

    /// `W = W_free − R F` for every output dof. A dof that contacts tie to the ground is the sum of their relative
    /// displacements instead: where a contact nearly holds it, the difference would be all cancellation.
    fn report_outputs(&self, slots: usize, outputs: usize, ws: &Workspace, solution: &mut Solution) {
        let all = self.contacts.len();
        let contacts = &solution.contacts;
        solution.displacement.resize_with(outputs, Vec::new);
        for (o, row) in solution.displacement.iter_mut().enumerate() {
            row.clear();
            if let Some(path) = self.structure.path_to_ground(o) {
                row.extend((0..slots).map(|slot| -> c64 {
                    path.iter().map(|&(c, sign)| contacts[c].displacement[slot] * sign).sum()
                }));
                continue;
            }
            row.extend((0..slots).map(|slot| {
                let entry = slot * outputs + o;
                let recovery = &ws.condensed.recovery[entry * all..(entry + 1) * all];
                let lent = &ws.condensed.lent[slot * all..(slot + 1) * all];
                let felt = |contact: &ContactSolution, lent: &c64| {
                    contact.force[slot] + lent * contact.displacement[slot]
                };
                let moved: c64 =
                    recovery.iter().zip(contacts).zip(lent).map(|((r, c), lent)| r * felt(c, lent)).sum();
                ws.condensed.free_output[entry] + moved
            }));
        }
    }

    /// The response without contact forces: one row per output dof, one column per order. `None` where the
    /// structure is singular.
    pub fn linear_response(&self, frequency: f64, workspace: &mut Workspace) -> Option<Vec<Vec<Complex64>>> {
        let slots = self.slots();
        self.structure.condense_alone(frequency, 0..slots, &mut workspace.condensed).ok()?;
        let outputs = workspace.condensed.outputs;
        if workspace.condensed.singular[..slots].contains(&true) {
            return None;
        }
        let row = |o: usize| (0..slots).map(|s| workspace.condensed.free_output[s * outputs + o]).collect();
        Some((0..outputs).map(row).collect())
    }
}
