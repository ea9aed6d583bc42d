//! Contacts that open within the motion: their part in the series of a step, in its events and in what these change.

use crate::flow::{Flow, Next};
use crate::links::{Elastic, Link, Press};
use crate::path::{Element, PhaseEvent};
use crate::polynomial::{Polynomial, TERMS};
use crate::press::{Change, Course, Touch, length, unit};
use crate::scaled::Scaled;
use crate::settings::EventKind;
use crate::tangents::Tangents;
use crate::turning::{Phase, Turning};

/// The contact at the given y, with the tangential spring's elongation `pull`, cut to what friction can hold.
pub(crate) fn begin(press: &Press, links: &[Link], y: &[f64], pull: [f64; 2]) -> Touch {
    let pressure = press.pressure_at(links, y);
    match press.friction.filter(|friction| friction.coefficient > 0.0) {
        _ if pressure <= 0.0 => Touch::Apart,
        None => Touch::Closed,
        Some(friction) => {
            let (u, limit) = (friction.along(links, y), press.reach() * pressure);
            let size = length(pull);
            let pull = if size > limit { pull.map(|pull| pull / size * limit) } else { pull };
            Touch::Stick { rest: [u[0] - pull[0], u[1] - pull[1]] }
        }
    }
}

/// Elongation of the tangential spring.
pub(crate) fn pull(press: &Press, touch: Touch, links: &[Link], y: &[f64]) -> [f64; 2] {
    match (touch, &press.friction) {
        (Touch::Stick { rest }, Some(friction)) => {
            let u = friction.along(links, y);
            [u[0] - rest[0], u[1] - rest[1]]
        }
        (Touch::Slip { direction }, _) => {
            let reach = press.reach() * press.pressure_at(links, y);
            direction.map(|direction| direction * reach)
        }
        _ => [0.0; 2],
    }
}

/// Forces of the contact's links between events, set in `elastic`; those that turn are zero here.
pub(crate) fn set_elastic(press: &Press, touch: Touch, elastic: &mut [Elastic]) {
    if let Some(normal) = elastic.get_mut(press.normal) {
        *normal = match touch {
            Touch::Apart => Elastic { constant: -press.balanced, ..Elastic::default() },
            _ => Elastic {
                stiffness: press.stiffness,
                constant: press.pressure - press.balanced,
                coupled: None,
            },
        };
    }
    let Some(friction) = &press.friction else { return };
    for (link, direction) in friction.links().zip(0..) {
        let Some(tangential) = elastic.get_mut(link) else { continue };
        *tangential = match touch {
            Touch::Stick { rest } => {
                let rest = rest.get(direction).copied().unwrap_or(0.0);
                Elastic { stiffness: friction.stiffness, constant: -friction.stiffness * rest, coupled: None }
            }
            Touch::Slip { direction: [direction, _] } if friction.second.is_none() => {
                let signed = direction * friction.coefficient;
                Elastic {
                    stiffness: 0.0,
                    constant: signed * press.pressure,
                    coupled: Some((press.normal, signed * press.stiffness)),
                }
            }
            _ => Elastic::default(),
        };
    }
}

impl Flow<'_> {
    /// A press over the step that the coefficients describe.
    fn course<'a>(&'a self, system: &'a Scaled, index: usize) -> Option<Course<'a>> {
        let press = system.presses.get(index)?;
        let along = |link: usize| -> Polynomial {
            let mut u = [0.0; TERMS];
            if let Some(link) = system.links.get(link) {
                for (u, row) in u.iter_mut().zip(self.coefficients.chunks_exact(system.dofs)) {
                    *u = link.relative(row);
                }
            }
            u
        };
        Some(Course {
            press,
            touch: *self.touches.get(index)?,
            normal: along(press.normal),
            tangential: press.friction.map_or([[0.0; TERMS]; 2], |friction| {
                [along(friction.link), friction.second.map_or([0.0; TERMS], along)]
            }),
            turning: self.turnings.get(index).and_then(Option::as_ref),
            turned: self.turned.get(index).copied().flatten(),
            met: self.met.get(index).copied().unwrap_or(false),
        })
    }

    /// Begins the series of every force that turns; returns the length that a step should not exceed.
    pub(crate) fn begin_turnings(&mut self) -> f64 {
        let system = self.system;
        let mut longest = f64::INFINITY;
        for (index, press) in system.presses.iter().enumerate() {
            let (Some(friction), Some(slot)) = (&press.friction, self.turnings.get_mut(index)) else {
                continue;
            };
            let met = self.met.get(index).copied().unwrap_or(false);
            *slot = match self.touches.get(index) {
                Some(Touch::Slip { direction }) if press.is_planar() => {
                    let reach = press.reach() * press.pressure_at(&system.links, &self.y);
                    let rate = press.reach() * press.stiffness * press.approach(&system.links, &self.v);
                    let speed = length(friction.along(&system.links, &self.v));
                    let (phase, most) = Turning::judge(reach, rate, speed, met);
                    longest = longest.min(most);
                    Some(Turning::new(phase, *direction))
                }
                _ => None,
            };
        }
        longest
    }

    /// Forces that turn have the direction of place `s` of the step.
    pub(crate) fn turn(&mut self, s: f64) {
        for (touch, turning) in self.touches.iter_mut().zip(&self.turnings) {
            if let (Touch::Slip { direction }, Some(turning)) = (touch, turning) {
                *direction = unit(turning.direction(s));
            }
        }
    }

    /// A change of a press that is due at the begin of the step.
    pub(crate) fn press_at_once(&self, press: usize) -> Option<Next> {
        let change = self.course(self.system, press)?.at_once()?;
        Some(Next::Touch { press, change })
    }

    /// The first change of a press in the step.
    pub(crate) fn next_of_presses(&mut self) -> Option<(f64, Next)> {
        let mut roots = std::mem::take(&mut self.roots);
        let mut earliest: Option<(f64, Next)> = None;
        for press in 0..self.touches.len() {
            let found = self.course(self.system, press).and_then(|course| course.next(&mut roots));
            if let Some((s, change)) = found.filter(|found| earliest.is_none_or(|(s, _)| found.0 < s)) {
                earliest = Some((s, Next::Touch { press, change }));
            }
        }
        self.roots = roots;
        earliest
    }

    /// The contact changes at the present state.
    pub(crate) fn change_touch(
        &mut self,
        (index, change): (usize, Change),
        events: Option<&mut Vec<PhaseEvent>>,
        tangents: Option<&mut Tangents>,
    ) {
        let system = self.system;
        let (Some(press), Some(before)) = (system.presses.get(index), self.touches.get(index).copied())
        else {
            return;
        };
        let (links, planar) = (&system.links, press.is_planar());
        let along = |x: &[f64]| press.friction.map_or([0.0; 2], |friction| friction.along(links, x));
        // In a plane directions have no sign.
        let sign = |direction: [f64; 2]| if planar { 0.0 } else { direction[0] };
        let (kind, direction, touch) = match change {
            Change::Open => (EventKind::Open, 0.0, Touch::Apart),
            Change::Close => {
                let touch = press.closes(press.approach(links, &self.v), along(&self.v), along(&self.y));
                (EventKind::Close, 0.0, touch)
            }
            Change::Slip { direction } => (EventKind::Slip, sign(direction), Touch::Slip { direction }),
            Change::Stick => {
                let direction = if let Touch::Slip { direction } = before { sign(direction) } else { 0.0 };
                let (u, pull) = (along(&self.y), pull(press, before, links, &self.y));
                (EventKind::Stick, direction, Touch::Stick { rest: [u[0] - pull[0], u[1] - pull[1]] })
            }
        };
        if let Some(slot) = self.touches.get_mut(index) {
            *slot = touch;
        }
        if let Some(turned) = self.turned.get_mut(index) {
            *turned = None;
        }
        if let Some(met) = self.met.get_mut(index) {
            *met = change == Change::Close;
        }
        if let Some(events) = events {
            let (tau, element) = (self.tau(), Element::Press(index));
            events.push(PhaseEvent { tau, element, kind, direction: direction as i8 });
            if let (Change::Close, Touch::Slip { direction }) = (change, touch) {
                let direction = sign(direction) as i8;
                events.push(PhaseEvent { tau, element, kind: EventKind::Slip, direction });
            }
        }
        let Some(tangents) = tangents else { return };
        match touch {
            Touch::Stick { .. } => {
                let rates = (along(&self.v), press.approach(links, &self.v));
                let reach = press.reach() * press.pressure_at(links, &self.y);
                tangents.rests(system, index, (before, reach), (before == Touch::Apart).then_some(rates));
            }
            Touch::Slip { .. } if before != Touch::Apart => {
                tangents.slides(system, index, pull(press, before, links, &self.y));
            }
            _ => tangents.moves(index),
        }
    }
}

/// Coefficient `j` of the force of a press that turns, along both tangents, from the coefficients `c` of y and `next` of the
/// one after; see [`Turning::extend`].
pub(crate) fn extend(
    press: &Press,
    links: &[Link],
    turning: &mut Turning<f64>,
    (j, c, next): (usize, &[f64], &[f64]),
) -> [f64; 2] {
    let Some(friction) = &press.friction else { return [0.0; 2] };
    let constant = if j == 0 && turning.phase() != Phase::Met { press.pressure } else { 0.0 };
    let approach = if j == 0 && turning.phase() == Phase::Met { 0.0 } else { press.approach(links, c) };
    let reach = press.reach() * (constant + press.stiffness * approach);
    let rate = friction.along(links, next).map(|u| (j + 1) as f64 * u);
    turning.extend(j, reach, rate, 0.0).map(|pull| friction.stiffness * pull)
}
