//! Responses of one harmonic of the structure: to a unit force in every row, to the excitation, and to a change of frequency.

use faer::c64;

use crate::condensation::{Condensed, Structure};
use crate::matrices::Matrices;

/// Contacts so much stiffer than the structure at them need springs lent.
const MUCH_STIFFER: f64 = 1e5;

/// The relative displacement of a row, from that of the dofs.
#[inline]
fn across(parts: &[(usize, f64)], at: impl Fn(usize) -> c64) -> c64 {
    parts.iter().map(|&(dof, coefficient)| at(dof) * coefficient).sum()
}

impl Structure {
    /// Responses of harmonic `slot` from the modes; whether they are good enough.
    pub(crate) fn respond_by_modes(&self, slot: usize, base: f64, into: &mut Condensed) -> bool {
        let Some(modal) =
            self.modal.as_ref().filter(|_| (into.added_damping, into.self_excitation) == (0.0, 0.0))
        else {
            return false;
        };
        let (rows, outputs) = (into.rows, into.outputs);
        let Condensed { modal: buffers, receptance, recovery, free, free_output, .. } = into;
        let Matrices::Dense { mass, damping, stiffness } = &self.matrices else { return false };
        let omega = self.orders[slot] as f64 * base;
        if !modal.respond(omega, buffers) {
            return false;
        }
        let [re, im] = &buffers.receptance;
        // A contact much stiffer than the structure is felt in digits that a receptance without springs does not have.
        let stiff = |i: usize| {
            let stiffness = if self.row_stiffness[i].is_finite() { self.row_stiffness[i] } else { 0.0 };
            re[(i, i)].hypot(im[(i, i)]) * stiffness > MUCH_STIFFER
        };
        if (0..rows).any(stiff) {
            return false;
        }
        for i in 0..rows {
            let row = &mut receptance[(slot * rows + i) * rows..][..rows];
            for (l, entry) in row.iter_mut().enumerate() {
                let (high, low) = (i.max(l), i.min(l));
                *entry = c64::new(re[(high, low)], im[(high, low)]);
            }
        }
        let [re, im] = &buffers.recovery;
        for o in 0..outputs {
            let row = &mut recovery[(slot * outputs + o) * rows..][..rows];
            for (l, entry) in row.iter_mut().enumerate() {
                *entry = c64::new(re[(o, l)], im[(o, l)]);
            }
        }
        let own = &mut free[slot * rows..(slot + 1) * rows];
        modal.free(slot, base, buffers, own, &mut free_output[slot * outputs..(slot + 1) * outputs]);
        // Contacts push where the excitation moves them, as hard as it takes to stop them; higher harmonics likewise.
        let excited = self.loads.iter().position(|loads| !loads.is_empty()).filter(|first| *first <= slot);
        let moved = excited.map(|first| &free[first * rows..(first + 1) * rows]);
        let held = |l: usize| {
            let own = receptance[(slot * rows + l) * rows + l];
            moved
                .and_then(|moved| moved.get(l))
                .map_or(c64::ONE, |moved| if own == c64::ZERO { own } else { moved / own })
        };
        let pushes = self.rows.iter().enumerate().flat_map(|(l, parts)| {
            let force = held(l);
            parts.iter().map(move |&(dof, coefficient)| (dof, force * coefficient))
        });
        let loads = self.loads.get(slot).into_iter().flatten();
        let excitation = loads.map(|load| {
            let grown = if load.grows { base * base } else { 1.0 };
            (load.dof, load.amplitude * grown)
        });
        modal.solves(omega, [mass, damping, stiffness], excitation.chain(pushes), buffers)
    }

    /// Responses of harmonic `slot` to a unit force in every row and to the excitation.
    pub(crate) fn respond(&self, slot: usize, base: f64, into: &mut Condensed) {
        let (rows, outputs) = (into.rows, into.outputs);
        let loads = self.loads.get(slot).map_or(&[][..], |loads| loads);
        if loads.is_empty() {
            into.free[slot * rows..(slot + 1) * rows].fill(c64::ZERO);
            into.free_output[slot * outputs..(slot + 1) * outputs].fill(c64::ZERO);
        }
        let columns = if loads.is_empty() { rows } else { rows + 1 };
        let Condensed { rhs, scale, factor, receptance, free, recovery, free_output, .. } = into;
        let block = rhs.ncols();
        for begin in (0..columns).step_by(block.max(1)) {
            let end = columns.min(begin + block);
            rhs.fill(c64::ZERO);
            for l in begin..end.min(rows) {
                for &(dof, coefficient) in self.rows.parts(l) {
                    rhs[(dof, l - begin)] += coefficient * scale[dof];
                }
            }
            for load in loads.iter().filter(|_| end > rows) {
                let growth = if load.grows { base * base } else { 1.0 };
                rhs[(load.dof, rows - begin)] += load.amplitude * (growth * scale[load.dof]);
            }
            factor.solve(rhs.as_mut().subcols_mut(0, end - begin));
            let at = |dof: usize, column: usize| rhs[(dof, column - begin)] * scale[dof];
            for (i, parts) in self.rows.iter().enumerate() {
                for l in begin..end.min(rows) {
                    receptance[(slot * rows + i) * rows + l] = across(parts, |dof| at(dof, l));
                }
                if end > rows {
                    free[slot * rows + i] = across(parts, |dof| at(dof, rows));
                }
            }
            for (o, &dof) in self.outputs.iter().enumerate() {
                for l in begin..end.min(rows) {
                    recovery[(slot * outputs + o) * rows + l] = at(dof, l);
                }
                if end > rows {
                    free_output[slot * outputs + o] = at(dof, rows);
                }
            }
        }
    }

    /// `∂u/∂Ω` of the rows in m s at forces that do not change, entry `[slot][i]`: with the motion w of all dofs under
    /// the forces `felt` in N (entry `[slot][l]`), `∂w/∂Ω = H⁻¹ (∂f/∂Ω − ∂H/∂Ω w)`. Springs stay lent as they are.
    pub(crate) fn frequency_slope(&self, hertz: f64, felt: &[c64], into: &mut Condensed, slope: &mut [c64]) {
        let base = std::f64::consts::TAU * hertz;
        let (n, rows) = (self.matrices.dofs(), into.rows);
        for (slot, &order) in self.orders.iter().enumerate().take(slope.len() / rows.max(1)) {
            let k = order as f64;
            let omega = k * base;
            self.factor(omega, slot, into);
            let Condensed { rhs, scale, factor, .. } = &mut *into;
            let loads = self.loads.get(slot).map_or(&[][..], |loads| loads);
            rhs.fill(c64::ZERO);
            for load in loads {
                let growth = if load.grows { base * base } else { 1.0 };
                rhs[(load.dof, 0)] += load.amplitude * (growth * scale[load.dof]);
            }
            for (l, parts) in self.rows.iter().enumerate() {
                let force = felt[slot * rows + l];
                for &(dof, coefficient) in parts {
                    rhs[(dof, 0)] -= force * (coefficient * scale[dof]);
                }
            }
            factor.solve(rhs.as_mut().subcols_mut(0, 1));
            let w: Vec<c64> = (0..n).map(|i| rhs[(i, 0)] * scale[i]).collect();
            rhs.fill(c64::ZERO);
            for load in loads.iter().filter(|load| load.grows) {
                rhs[(load.dof, 0)] += load.amplitude * (2.0 * base * scale[load.dof]);
            }
            for (i, change) in self.matrices.slope_times(k, omega, &w).into_iter().enumerate() {
                rhs[(i, 0)] -= change * scale[i];
            }
            factor.solve(rhs.as_mut().subcols_mut(0, 1));
            for (i, parts) in self.rows.iter().enumerate() {
                slope[slot * rows + i] = across(parts, |dof| rhs[(dof, 0)] * scale[dof]);
            }
        }
    }
}
