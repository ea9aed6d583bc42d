//! The derivative of a passage with respect to its initial state.
//!
//! Between events it obeys the homogeneous linear system. At events the slider's force is continuous, and so is the
//! acceleration, which leaves little of the saltation matrix: the vector field jumps in the rate of the slider's force
//! alone. Where slip begins, at a limit that does not vary, the force ceases to vary; where it ends the relative
//! velocity is zero and nothing jumps. Under a varying limit the slipping force follows the pressure, with its
//! disturbance; where slip ends the slider's velocity is zero. A contact that closes and sticks at once remembers where
//! it touched: the instant moves by `δt = −δu_n/u_n'` and the rest position by `δu_t + u_t' δt`.

use crate::flow::{Flow, Motion, recur};
use crate::polynomial::TERMS;
use crate::press::Touch;
use crate::scaled::Scaled;

/// Derivatives of (y, y', slider forces / limits, elongations of presses with friction), one column for each entry of the initial state.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tangents {
    columns: Vec<Column>,
    coefficients: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Column {
    y: Vec<f64>,
    v: Vec<f64>,
    /// δ(offset) of sticking sliders; zero for slipping ones.
    offset: Vec<f64>,
    /// δ(rest) of presses that stick; zero for all others. One a press.
    rest: Vec<f64>,
}

impl Tangents {
    /// The identity at the state `flow` has begun with.
    pub(crate) fn begin(&mut self, flow: &Flow) {
        let (n, sliders) = (flow.system.dofs, flow.system.sliders.len());
        let frictions = flow.system.frictions().count();
        self.coefficients.resize(TERMS * n, 0.0);
        self.columns.clear();
        for entry in 0..2 * n + sliders + frictions {
            let unit = |from: usize, count: usize| -> Vec<f64> {
                (from..from + count).map(|i| if i == entry { 1.0 } else { 0.0 }).collect()
            };
            let mut column = Column {
                y: unit(0, n),
                v: unit(n, n),
                offset: unit(2 * n, sliders),
                rest: vec![0.0; flow.system.presses.len()],
            };
            let pulls = unit(2 * n + sliders, frictions);
            for ((index, _, friction), pull) in flow.system.frictions().zip(&pulls) {
                let sticks = matches!(flow.touches.get(index), Some(Touch::Stick { .. }));
                if let Some(rest) = column.rest.get_mut(index).filter(|_| sticks) {
                    *rest = relative(flow.system, friction.link, &column.y) - pull;
                }
            }
            for (offset, slider) in column.offset.iter_mut().zip(&flow.system.sliders) {
                *offset -= slider.gain * relative(flow.system, slider.contact, &column.y);
            }
            self.columns.push(column);
        }
    }

    /// Over the first part `s` of the step that `flow` stands at.
    pub(crate) fn step(&mut self, flow: &Flow, length: f64, s: f64) {
        let (system, n) = (flow.system, flow.system.dofs);
        let c = &mut self.coefficients;
        for column in &mut self.columns {
            c.fill(0.0);
            for (i, (y, v)) in column.y.iter().zip(&column.v).enumerate() {
                if let Some(slot) = c.get_mut(i) {
                    *slot = *y;
                }
                if let Some(slot) = c.get_mut(n + i) {
                    *slot = length * v;
                }
            }
            if let Some(source) = c.get_mut(2 * n..3 * n) {
                for ((offset, data), motion) in column.offset.iter().zip(&system.sliders).zip(&flow.sliders) {
                    let sticks = matches!(motion, Motion::Stick { .. }) && *offset != 0.0;
                    if let Some(link) = system.links.get(data.contact).filter(|_| sticks) {
                        for (source, acceleration) in source.iter_mut().zip(&link.acceleration) {
                            *source -= length * length * data.limit * offset * acceleration;
                        }
                    }
                }
            }
            for (index, _, friction) in system.frictions() {
                let rest = column.rest.get(index).copied().unwrap_or(0.0);
                if let (Some(link), Some(source)) = (system.links.get(friction.link), c.get_mut(2 * n..3 * n))
                {
                    for (source, acceleration) in source.iter_mut().zip(&link.acceleration) {
                        *source += length * length * friction.stiffness * rest * acceleration;
                    }
                }
            }
            recur(system, flow.elastic(), length, c);
            for (i, (y, v)) in column.y.iter_mut().zip(&mut column.v).enumerate() {
                let (mut position, mut rate) = (0.0, 0.0);
                for row in c.chunks_exact(n).rev() {
                    rate = rate * s + position;
                    position = position * s + row.get(i).copied().unwrap_or(0.0);
                }
                (*y, *v) = (position, rate / length);
            }
        }
    }

    /// Slip of `slider` begins.
    pub(crate) fn slips(&mut self, slider: usize) {
        for column in &mut self.columns {
            if let Some(offset) = column.offset.get_mut(slider) {
                *offset = 0.0;
            }
        }
    }

    /// Slip of `slider` ends.
    pub(crate) fn sticks(&mut self, system: &Scaled, slider: usize) {
        let Some(data) = system.sliders.get(slider) else { return };
        for column in &mut self.columns {
            let change = data.gain * relative(system, data.contact, &column.y);
            if let Some(offset) = column.offset.get_mut(slider) {
                *offset = -change;
            }
        }
    }

    /// A press sticks from now on; `closing` gives (u_t', u_n') where it has just closed.
    pub(crate) fn rests(
        &mut self,
        system: &Scaled,
        index: usize,
        before: Touch,
        closing: Option<(f64, f64)>,
    ) {
        let Some((press, friction)) = system.presses.get(index).and_then(|p| Some((p, p.friction?))) else {
            return;
        };
        for column in &mut self.columns {
            let (normal, tangential) =
                (relative(system, press.normal, &column.y), relative(system, friction.link, &column.y));
            let pull = match (before, closing) {
                (Touch::Slip { direction }, _) => {
                    direction * friction.coefficient * press.stiffness * normal / friction.stiffness
                }
                (_, Some((along, towards))) if towards != 0.0 => normal * along / towards,
                _ => 0.0,
            };
            if let Some(rest) = column.rest.get_mut(index) {
                *rest = tangential - pull;
            }
        }
    }

    /// A press does not stick any more.
    pub(crate) fn moves(&mut self, index: usize) {
        for column in &mut self.columns {
            if let Some(rest) = column.rest.get_mut(index) {
                *rest = 0.0;
            }
        }
    }

    /// δ(state) for a unit change of entry `column` of the initial state.
    pub(crate) fn column(&self, flow: &Flow, column: usize) -> Vec<f64> {
        let Some(column) = self.columns.get(column) else { return Vec::new() };
        let mut out: Vec<f64> = column.y.iter().chain(&column.v).copied().collect();
        for ((offset, data), motion) in column.offset.iter().zip(&flow.system.sliders).zip(&flow.sliders) {
            out.push(match motion {
                Motion::Slip { .. } => 0.0,
                Motion::Stick { .. } => offset + data.gain * relative(flow.system, data.contact, &column.y),
            });
        }
        for (index, press, friction) in flow.system.frictions() {
            let u = |link: usize| relative(flow.system, link, &column.y);
            out.push(match flow.touches.get(index) {
                Some(Touch::Stick { .. }) => {
                    u(friction.link) - column.rest.get(index).copied().unwrap_or(0.0)
                }
                Some(Touch::Slip { direction }) => {
                    direction * friction.coefficient * press.stiffness * u(press.normal) / friction.stiffness
                }
                _ => 0.0,
            });
        }
        out
    }
}

fn relative(system: &Scaled, contact: usize, y: &[f64]) -> f64 {
    system.links.get(contact).map_or(0.0, |link| link.relative(y))
}
