//! Starts of the first rung: contacts replaced by secant stiffnesses.

use faer::c64;

use crate::balance::Homotopy;
use crate::plan::Plan;
use crate::point::secant;
use crate::rows::joint_rows;
use crate::settings::many;
use crate::workspace::Workspace;

impl Plan {
    /// A guess at the first rung without any closed solution: the structure with every contact replaced by its secant
    /// stiffness, repeated with the amplitudes that result.
    pub(crate) fn secant_start(&self, ws: &mut Workspace) {
        let width = ws.point.width();
        let slots = self.rungs[0].slots;
        let count = slots * width;
        // A rung above may go on from here although the first one failed.
        ws.unknowns.fill(c64::ZERO);
        ws.unknowns[..count].copy_from_slice(&ws.point.free[..count]);
        let first = self.first_slot().unwrap_or(0);
        // A round of many contacts costs as much as a Newton step, and one of them that cycles would hold up all others.
        let many = many(self.balance(0).size(width, slots), width);
        let (rounds, enough) = if many { (6, 1e-2) } else { (20, 1e-3) };
        for round in 0..rounds {
            ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
            self.solve_linearised(slots, first, ws);
            let mut change = 0.0_f64;
            for entry in 0..count {
                // Full steps first, then halved ones against cycling between stick and slip.
                let weight = if round < 3 { 1.0 } else { 0.5 };
                let next = ws.kept[entry] + weight * (ws.unknowns[entry] - ws.kept[entry]);
                change = change.max((next - ws.kept[entry]).norm() / (next.norm() + f64::MIN_POSITIVE));
                ws.unknowns[entry] = next;
            }
            if change < enough {
                break;
            }
        }
    }

    /// Solves `(1 + Ĝ K̂) û = û⁰` in every slot, with secant stiffnesses at the amplitudes in slot `first` of `kept`.
    /// Exact when all laws are linear.
    pub(crate) fn solve_linearised(&self, slots: usize, first: usize, ws: &mut Workspace) {
        let width = ws.point.width();
        for column in 0..width - self.joint_rows {
            let contact = &self.contacts[ws.point.active[column]];
            let amplitude = ws.kept[first * width + column].norm();
            let (length, force) = (ws.point.length[column], ws.point.force[column]);
            ws.point.secant[column] = secant(&*contact.law, contact.scale, amplitude, length, force);
        }
        self.linearise_joints(first, ws);
        self.solve_with_secants(slots, ws);
    }

    /// Secant stiffnesses F̂_1/û_1 of the rows of joints at the motion in `kept`, slot `first` being that of F̂_1. They lie
    /// between none and that of a joint that sticks; where nothing moves it sticks.
    fn linearise_joints(&self, first: usize, ws: &mut Workspace) {
        self.stick_joints(1.0, ws);
        let (slots, width) = (self.rungs[0].slots, ws.point.width());
        let Workspace { point, kept, balance, .. } = ws;
        let buffers = &mut balance[0];
        if self.joints.is_empty()
            || self.balance(0).joint_forces(point, slots, Homotopy::NONE, kept, buffers).is_err()
        {
            return;
        }
        for row in width - self.joint_rows..width {
            let (motion, stuck) = (kept[first * width + row], point.secant[row].re);
            let secant = buffers.forces[first * width + row] / motion;
            if !secant.is_finite() {
                continue;
            }
            let passive = c64::new(secant.re.max(0.0), secant.im.max(0.0));
            let size = passive.norm();
            point.secant[row] = if size > stuck { passive * (stuck / size) } else { passive };
        }
    }

    /// Gives the rows of joints this share of the stiffness that their laws have where they stick.
    pub(crate) fn stick_joints(&self, share: f64, ws: &mut Workspace) {
        let first = ws.point.width() - self.joint_rows;
        for (joint, rows) in joint_rows(first, &self.joints) {
            for (direction, row) in rows.enumerate() {
                ws.point.secant[row] = c64::from(share * ws.point.stuck(joint, direction, row));
            }
        }
    }

    /// A guess at the first rung with all joints open: those that slip nearly always, or hardly touch.
    pub(crate) fn open_start(&self, ws: &mut Workspace) {
        self.secant_start(ws);
        self.stick_joints(0.0, ws);
        self.solve_with_secants(self.rungs[0].slots, ws);
    }

    /// Solves `(1 + Ĝ K̂) û = û⁰` in every slot with the secant stiffnesses of the point.
    pub(crate) fn solve_with_secants(&self, slots: usize, ws: &mut Workspace) {
        let width = ws.point.width();
        for slot in 0..slots {
            for column in 0..width {
                let stiffness = ws.point.secant_stiffness(column, self.harmonics.reduced[slot]);
                for row in 0..width {
                    let g = ws.point.receptance[(slot * width + row) * width + column];
                    let unit = if row == column { c64::ONE } else { c64::ZERO };
                    ws.linear.matrix[(row, column)] =
                        unit + g * (stiffness - ws.point.lent[slot * width + column]);
                }
            }
            for row in 0..width {
                ws.linear_rhs[(row, 0)] = ws.point.free[slot * width + row];
            }
            ws.linear.factor(width);
            ws.linear.solve(ws.linear_rhs.as_mut().subrows_mut(0, width));
            for row in 0..width {
                ws.unknowns[slot * width + row] = ws.linear_rhs[(row, 0)];
            }
        }
    }
}
