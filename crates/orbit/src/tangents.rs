//! The derivative of a passage with respect to its initial state.
//!
//! Between events it obeys the homogeneous linear system. At events the slider's force is continuous, and so is the
//! acceleration, which leaves little of the saltation matrix: the vector field jumps in the rate of the slider's force
//! alone. Where slip begins, at a limit that does not vary, the force ceases to vary; where it ends the relative
//! velocity is zero and nothing jumps. Under a varying limit the slipping force follows the pressure, with its
//! disturbance; where slip ends the slider's velocity is zero. A contact that closes and sticks at once remembers where
//! it touched: the instant moves by `δt = −δu_n/u_n'` and the rest position by `δu_t + u_t' δt`. A force that turns has its angle
//! as one more disturbance, whose series is that of [`crate::turning`] on numbers with a derivative; its rate is continuous where
//! slip begins, so the angle does not jump.

use crate::flow::{Flow, Motion, recur};
use crate::links::{Link, Press};
use crate::number::Pair;
use crate::polynomial::TERMS;
use crate::press::Touch;
use crate::scaled::Scaled;
use crate::turning::Turning;

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
    rest: Vec<[f64; 2]>,
    /// δθ of presses whose force turns; zero for all others.
    turn: Vec<f64>,
}

impl Tangents {
    /// The identity at the state `flow` has begun with.
    pub(crate) fn begin(&mut self, flow: &Flow) {
        let (n, sliders) = (flow.system.dofs, flow.system.sliders.len());
        let frictions = flow.system.pulls().count();
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
                rest: vec![[0.0; 2]; flow.system.presses.len()],
                turn: vec![0.0; flow.system.presses.len()],
            };
            let mut pulls = unit(2 * n + sliders, frictions).into_iter();
            for (index, press, friction) in flow.system.frictions() {
                let (pull, u) = (press.take_pull(&mut pulls), friction.along(&flow.system.links, &column.y));
                let sticks = matches!(flow.touches.get(index), Some(Touch::Stick { .. }));
                if let Some(rest) = column.rest.get_mut(index).filter(|_| sticks) {
                    *rest = [u[0] - pull[0], u[1] - pull[1]];
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
            for (index, press, friction) in system.frictions() {
                let rest = column.rest.get(index).copied().unwrap_or_default();
                let force = rest.map(|rest| -friction.stiffness * rest);
                if let Some(source) = c.get_mut(2 * n..3 * n) {
                    press.push(&system.links, force, length * length, source);
                }
            }
            let mut turnings: Vec<_> = flow
                .turnings
                .iter()
                .zip(&column.turn)
                .map(|(own, turn)| disturbed(own.as_ref()?, *turn))
                .collect();
            recur(system, flow.elastic(), length, c, |j, c, after, next| {
                for ((press, own), turning) in system.presses.iter().zip(&flow.turnings).zip(&mut turnings) {
                    if let (Some(own), Some(turning)) = (own, turning) {
                        let force = extend(press, &system.links, (own, turning), (j, c, after));
                        press.push(&system.links, force, length * length, next);
                    }
                }
            });
            for (turn, turning) in column.turn.iter_mut().zip(&turnings) {
                let Some(turning) = turning else { continue };
                let [x, y] = turning.direction(s);
                *turn = y.change * x.value - x.change * y.value;
            }
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

    /// A press sticks from now on; `before` gives what it did with its reach μN/k_t, `closing` (u_t', u_n') where it has just
    /// closed.
    pub(crate) fn rests(
        &mut self,
        system: &Scaled,
        index: usize,
        before: (Touch, f64),
        closing: Option<([f64; 2], f64)>,
    ) {
        let Some((press, friction)) = system.presses.get(index).and_then(|p| Some((p, p.friction?))) else {
            return;
        };
        for column in &mut self.columns {
            let normal = press.approach(&system.links, &column.y);
            let tangential = friction.along(&system.links, &column.y);
            let pull = match (before, closing) {
                ((Touch::Slip { direction }, reach), _) => {
                    let turn = column.turn.get(index).copied().unwrap_or(0.0);
                    slipping_pull(press, direction, reach, (normal, turn))
                }
                (_, Some((along, towards))) if towards != 0.0 => along.map(|along| normal * along / towards),
                _ => [0.0; 2],
            };
            if let (Some(rest), Some(turn)) = (column.rest.get_mut(index), column.turn.get_mut(index)) {
                *rest = [tangential[0] - pull[0], tangential[1] - pull[1]];
                *turn = 0.0;
            }
        }
    }

    /// A press that stuck slips from now on, its spring's elongation being `pull`.
    pub(crate) fn slides(&mut self, system: &Scaled, index: usize, pull: [f64; 2]) {
        let friction = system.presses.get(index).and_then(|press| press.friction);
        let Some(friction) = friction.filter(|friction| friction.second.is_some()) else {
            self.moves(index);
            return;
        };
        let square = pull[0] * pull[0] + pull[1] * pull[1];
        for column in &mut self.columns {
            let u = friction.along(&system.links, &column.y);
            if let (Some(rest), Some(turn)) = (column.rest.get_mut(index), column.turn.get_mut(index)) {
                let change = [u[0] - rest[0], u[1] - rest[1]];
                let across = change[1] * pull[0] - change[0] * pull[1];
                *turn = if square > 0.0 { across / square } else { 0.0 };
                *rest = [0.0; 2];
            }
        }
    }

    /// A press neither sticks any more nor turns its force from where it was.
    pub(crate) fn moves(&mut self, index: usize) {
        for column in &mut self.columns {
            if let (Some(rest), Some(turn)) = (column.rest.get_mut(index), column.turn.get_mut(index)) {
                (*rest, *turn) = ([0.0; 2], 0.0);
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
            let pull = match flow.touches.get(index) {
                Some(Touch::Stick { .. }) => {
                    let u = friction.along(&flow.system.links, &column.y);
                    let rest = column.rest.get(index).copied().unwrap_or_default();
                    [u[0] - rest[0], u[1] - rest[1]]
                }
                Some(Touch::Slip { direction }) => {
                    let normal = press.approach(&flow.system.links, &column.y);
                    let reach = press.reach() * press.pressure_at(&flow.system.links, &flow.y);
                    let turn = column.turn.get(index).copied().unwrap_or(0.0);
                    slipping_pull(press, *direction, reach, (normal, turn))
                }
                _ => [0.0; 2],
            };
            out.extend(friction.links().zip(pull).map(|(_, pull)| pull));
        }
        out
    }
}

fn relative(system: &Scaled, contact: usize, y: &[f64]) -> f64 {
    system.links.get(contact).map_or(0.0, |link| link.relative(y))
}

/// `δ(r e) = δr e + r δθ e⊥` by changes of u_n and θ.
fn slipping_pull(press: &Press, direction: [f64; 2], reach: f64, (normal, turn): (f64, f64)) -> [f64; 2] {
    let by_pressure = press.reach() * press.stiffness * normal;
    let [x, y] = direction;
    [by_pressure * x - reach * turn * y, by_pressure * y + reach * turn * x]
}

/// The series of a force whose angle begins with a change.
fn disturbed(own: &Turning<f64>, turn: f64) -> Option<Turning<Pair>> {
    let [x, y] = own.direction(0.0);
    let direction = [Pair { value: x, change: -turn * y }, Pair { value: y, change: turn * x }];
    Some(Turning::new(own.phase(), direction))
}

/// Change of coefficient `j` of the force of a press that turns, from the changes `c` of the coefficients of y and `after` of
/// those one order higher.
fn extend(
    press: &Press,
    links: &[Link],
    (own, turning): (&Turning<f64>, &mut Turning<Pair>),
    (j, c, after): (usize, &[f64], &[f64]),
) -> [f64; 2] {
    let Some(friction) = &press.friction else { return [0.0; 2] };
    let (reach, rate) = own.given(j);
    let reach = Pair { value: reach, change: press.reach() * press.stiffness * press.approach(links, c) };
    let [u, v] = friction.along(links, after).map(|u| (j + 1) as f64 * u);
    let rate = [Pair { value: rate[0], change: u }, Pair { value: rate[1], change: v }];
    turning.extend(j, reach, rate, own.turn(j)).map(|pull| friction.stiffness * pull.change)
}
