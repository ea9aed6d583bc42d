//! Contacts that open within the motion: their part in the series of a step, in its events and in what these change.

use crate::flow::{Flow, Next};
use crate::links::{Elastic, Link, Press};
use crate::path::{Element, PhaseEvent};
use crate::polynomial::{Polynomial, TERMS};
use crate::press::{Change, Course, Touch};
use crate::scaled::Scaled;
use crate::settings::EventKind;
use crate::tangents::Tangents;

/// The contact at the given y, with the tangential spring's elongation `pull`, cut to what friction can hold.
pub(crate) fn begin(press: &Press, links: &[Link], y: &[f64], pull: f64) -> Touch {
    let u = |link: usize| links.get(link).map_or(0.0, |link| link.relative(y));
    let pressure = press.pressure + press.stiffness * u(press.normal);
    match &press.friction {
        _ if pressure <= 0.0 => Touch::Apart,
        None => Touch::Closed,
        Some(friction) => {
            let limit = friction.coefficient * pressure / friction.stiffness;
            Touch::Stick { rest: u(friction.link) - pull.clamp(-limit, limit) }
        }
    }
}

/// Elongation of the tangential spring.
pub(crate) fn pull(press: &Press, touch: Touch, links: &[Link], y: &[f64]) -> f64 {
    let u = |link: usize| links.get(link).map_or(0.0, |link| link.relative(y));
    let Some(friction) = &press.friction else { return 0.0 };
    match touch {
        Touch::Apart | Touch::Closed => 0.0,
        Touch::Stick { rest } => u(friction.link) - rest,
        Touch::Slip { direction } => {
            let pressure = press.pressure + press.stiffness * u(press.normal);
            direction * friction.coefficient * pressure / friction.stiffness
        }
    }
}

/// Forces of the contact's links between events, set in `elastic`.
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
    if let Some(tangential) = elastic.get_mut(friction.link) {
        *tangential = match touch {
            Touch::Apart | Touch::Closed => Elastic::default(),
            Touch::Stick { rest } => {
                Elastic { stiffness: friction.stiffness, constant: -friction.stiffness * rest, coupled: None }
            }
            Touch::Slip { direction } => {
                let signed = direction * friction.coefficient;
                Elastic {
                    stiffness: 0.0,
                    constant: signed * press.pressure,
                    coupled: Some((press.normal, signed * press.stiffness)),
                }
            }
        };
    }
}

impl Flow<'_> {
    /// A press over the step that the coefficients describe.
    fn course<'a>(&self, system: &'a Scaled, index: usize) -> Option<Course<'a>> {
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
            tangential: press.friction.map_or([0.0; TERMS], |friction| along(friction.link)),
            turned: self.turned.get(index).copied().flatten(),
        })
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
        let at = |link: usize, x: &[f64]| system.links.get(link).map_or(0.0, |link| link.relative(x));
        let friction = press.friction.as_ref();
        let tangential = |x: &[f64]| friction.map_or(0.0, |friction| at(friction.link, x));
        let (kind, direction, touch) = match change {
            Change::Open => (EventKind::Open, 0.0, Touch::Apart),
            Change::Close => {
                let touch = press.closes(at(press.normal, &self.v), tangential(&self.v), tangential(&self.y));
                (EventKind::Close, 0.0, touch)
            }
            Change::Slip { direction } => (EventKind::Slip, direction, Touch::Slip { direction }),
            Change::Stick => {
                let direction = if let Touch::Slip { direction } = before { direction } else { 0.0 };
                let rest = tangential(&self.y) - pull(press, before, &system.links, &self.y);
                (EventKind::Stick, direction, Touch::Stick { rest })
            }
        };
        if let Some(slot) = self.touches.get_mut(index) {
            *slot = touch;
        }
        if let Some(turned) = self.turned.get_mut(index) {
            *turned = None;
        }
        if let Some(events) = events {
            let (tau, element) = (self.tau(), Element::Press(index));
            events.push(PhaseEvent { tau, element, kind, direction: direction as i8 });
            if let (Change::Close, Touch::Slip { direction }) = (change, touch) {
                events.push(PhaseEvent { tau, element, kind: EventKind::Slip, direction: direction as i8 });
            }
        }
        match (tangents, touch) {
            (Some(tangents), Touch::Stick { .. }) => {
                let rates = (tangential(&self.v), at(press.normal, &self.v));
                tangents.rests(system, index, before, (before == Touch::Apart).then_some(rates));
            }
            (Some(tangents), _) => tangents.moves(index),
            (None, _) => {}
        }
    }
}
