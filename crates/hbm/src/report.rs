//! From the unknowns back to what a user asked for: displacements of output dofs, contact forces, dissipation.

use contact::{ContactState, JointMechanism};
use faer::c64;
use num_complex::Complex64;

use crate::dense::Entry;
use crate::plan::Plan;
use crate::rows::joint_rows;
use crate::solution::{ContactSolution, DirectionSolution, JointSolution, Solution, Status};
use crate::workspace::Workspace;

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
        solution.joints.resize_with(self.joints.len(), JointSolution::default);
        for (index, joint) in solution.joints.iter_mut().enumerate() {
            self.report_joint(index, slots, ws, joint);
        }
        self.report_outputs(slots, ws.condensed.outputs, ws, solution);
    }

    fn report_contact(&self, c: usize, slots: usize, ws: &mut Workspace, report: &mut ContactSolution) {
        let all = self.rows();
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
        self.report_row((row, c), slots, ws, &mut report.displacement, &mut report.force);
        report.dissipation = self.dissipation(&report.displacement, &report.force);
        self.report_motion(c, report, ws);
    }

    /// Displacement and force of active row `row`, which is row `index` of all.
    fn report_row(
        &self,
        (row, index): (usize, usize),
        slots: usize,
        ws: &mut Workspace,
        displacements: &mut Vec<c64>,
        forces: &mut Vec<c64>,
    ) {
        let (all, width) = (self.rows(), ws.point.width());
        let (length, unit) = (ws.point.length[row], ws.point.force[row]);
        for slot in 0..slots {
            let displacement = ws.unknowns[slot * width + row] * length;
            displacements.push(displacement);
            forces.push(-ws.balance[ws.goal].forces[slot * width + row] * unit);
            ws.previous[slot * all + index] = displacement;
        }
    }

    /// ∮ f dw in J over a period of Ω, of the force on the first body. Over a base period it is π Σ k Im(F_k conj W_k) in rig
    /// convention; a period of Ω has `fundamental` of them.
    fn dissipation(&self, displacement: &[c64], force: &[c64]) -> f64 {
        let terms = displacement.iter().zip(force).zip(&self.harmonics.reduced);
        let work: f64 = terms.map(|((w, f), &k)| -(k as f64) * (f * w.conj()).im).sum();
        std::f64::consts::PI * work * self.harmonics.fundamental as f64
    }

    fn report_joint(&self, index: usize, slots: usize, ws: &mut Workspace, report: &mut JointSolution) {
        let Some((joint, rows)) = joint_rows(self.contacts.len(), &self.joints).nth(index) else { return };
        // Contacts at rest are not among the active rows.
        let resting = self.rows() - ws.point.width();
        report.directions.resize_with(joint.directions.len(), DirectionSolution::default);
        report.dissipation = 0.0;
        for (direction, (report_in, row)) in report.directions.iter_mut().zip(rows).enumerate() {
            let DirectionSolution { displacement, force, amplitude } = report_in;
            displacement.clear();
            force.clear();
            self.report_row((row - resting, row), slots, ws, displacement, force);
            report.dissipation += self.dissipation(displacement, force);
            // A direction that does not move has no turning points and no amplitude.
            let _ = ws.turning_points.find(&ws.balance[ws.goal].joints[index].motion_in(direction));
            *amplitude = ws.turning_points.amplitude();
        }
        let marks = ws.balance[ws.goal].joints[index].marks;
        (report.state, report.apart, report.cycles) = (marks.state, marks.apart, marks.cycles);
        report.extrapolated = marks.extrapolated;
        let friction = matches!(joint.law.mechanism(), JointMechanism::Friction { .. });
        if friction && marks.state == ContactState::Stick && marks.apart == 0.0 {
            // Its springs return what they take: the sum is rounding.
            report.dissipation = 0.0;
        }
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
        let all = self.rows();
        let contacts = &solution.contacts;
        let directions = || solution.joints.iter().flat_map(|joint| &joint.directions);
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
                let of_contacts = contacts.iter().map(|c| (c.force[slot], c.displacement[slot]));
                let rows = of_contacts.chain(directions().map(|d| (d.force[slot], d.displacement[slot])));
                let parts = recovery.iter().zip(rows).zip(lent);
                let moved: c64 = parts.map(|((r, (force, w)), lent)| r * (force + lent * w)).sum();
                ws.condensed.free_output[entry] + moved
            }));
        }
    }

    /// The response of the output dofs under the contact forces of `solution`, whatever its displacements say:
    /// `W = W_free − R F`, and beside each amplitude the sum of the magnitudes it is made of. One row per output dof, one
    /// column per order; for solutions that were written down and are to be checked. `None` where the structure is
    /// singular.
    pub fn response_under(
        &self,
        solution: &Solution,
        workspace: &mut Workspace,
    ) -> Option<Vec<Vec<(Complex64, f64)>>> {
        let slots = self.slots();
        let condensed = &mut workspace.condensed;
        self.structure.condense_alone(solution.frequency, 0..slots, condensed).ok()?;
        if condensed.singular.get(..slots)?.contains(&true) {
            return None;
        }
        let (all, outputs) = (self.rows(), condensed.outputs);
        let contacts = || solution.contacts.iter().map(|c| (&c.force, &c.displacement));
        let directions = || solution.joints.iter().flat_map(|joint| &joint.directions);
        let rows = || contacts().chain(directions().map(|d| (&d.force, &d.displacement)));
        let at = |row: &[c64], slot: usize| row.get(slot).copied().unwrap_or(c64::ZERO);
        let response = |o: usize, slot: usize| {
            let entry = slot * outputs + o;
            let free = condensed.free_output[entry];
            let recovery = &condensed.recovery[entry * all..(entry + 1) * all];
            let lent = &condensed.lent[slot * all..(slot + 1) * all];
            let parts = recovery.iter().zip(lent).zip(rows());
            let parts = parts.map(|((r, lent), (force, w))| r * (at(force, slot) + lent * at(w, slot)));
            parts.fold((free, free.magnitude()), |(sum, size), part| (sum + part, size + part.magnitude()))
        };
        Some((0..outputs).map(|o| (0..slots).map(|slot| response(o, slot)).collect()).collect())
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
