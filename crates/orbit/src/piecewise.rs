//! The period map of a piecewise-linear system.

use faer::Mat;

use crate::error::OrbitError;
use crate::flow::{Flow, Motion};
use crate::links::Press;
use crate::opening;
use crate::path::{Element, Path};
use crate::press::Touch;
use crate::scaled::Scaled;
use crate::settings::EventKind;
use crate::shooting::{Map, Passage};
use crate::tangents::Tangents;

/// Phase within which two instants are one.
const INSTANT: f64 = 1e-12;

/// States are (y, y', slider forces / limits, elongations of the tangential springs of contacts that open).
pub(crate) struct Piecewise<'a> {
    flow: Flow<'a>,
    tangents: Tangents,
}

impl<'a> Piecewise<'a> {
    pub(crate) fn new(system: &'a Scaled) -> Self {
        Self { flow: Flow::new(system), tangents: Tangents::default() }
    }

    pub(crate) fn system(&self) -> &'a Scaled {
        self.flow.system
    }

    /// A passage with its record; returns the end state.
    pub(crate) fn record(
        &mut self,
        from: &[f64],
        until: f64,
    ) -> Result<(Path, Vec<f64>, Passage), OrbitError> {
        let (mut path, mut end) = (Path::default(), Vec::new());
        self.flow.begin(from);
        self.flow.follow(until, None, Some(&mut path))?;
        self.flow.state(&mut end);
        // A slip that goes on from the period before does not begin at τ = 0.
        let (system, sliders, touches) = (self.flow.system, &self.flow.sliders, &self.flow.touches);
        path.events.retain(|event| {
            let direction = f64::from(event.direction);
            let slipping = match event.element {
                Element::Slider(slider) => sliders.get(slider) == Some(&Motion::Slip { direction }),
                Element::Press(press) => {
                    let planar = system.presses.get(press).is_some_and(Press::is_planar);
                    matches!(touches.get(press), Some(Touch::Slip { direction: [own, _] }) if planar || *own == direction)
                }
            };
            event.tau > INSTANT || event.kind != EventKind::Slip || !slipping
        });
        Ok((path, end, Passage { peak: self.flow.peak }))
    }
}

impl Map for Piecewise<'_> {
    fn pass(
        &mut self,
        from: &[f64],
        until: f64,
        end: &mut Vec<f64>,
        derivative: Option<&mut Mat<f64>>,
    ) -> Result<Passage, OrbitError> {
        self.flow.begin(from);
        match derivative {
            None => self.flow.follow(until, None, None)?,
            Some(matrix) => {
                self.tangents.begin(&self.flow);
                self.flow.follow(until, Some(&mut self.tangents), None)?;
                for j in 0..from.len() {
                    for (i, entry) in self.tangents.column(&self.flow, j).into_iter().enumerate() {
                        matrix[(i, j)] = entry;
                    }
                }
            }
        }
        self.flow.state(end);
        Ok(Passage { peak: self.flow.peak })
    }

    fn weights(&self, passage: Passage, weights: &mut Vec<f64>) {
        let system = self.flow.system;
        let (y, v) = passage.peak;
        let relative = |size: f64| if size > 0.0 { 1.0 / size } else { 1.0 };
        weights.clear();
        weights.extend(std::iter::repeat_n(relative(y), system.dofs));
        weights.extend(std::iter::repeat_n(relative(v), system.dofs));
        // A force differs by its gain times a displacement.
        weights.extend(system.sliders.iter().map(|slider| {
            let ends = system.links.get(slider.contact).map_or(&[][..], |link| &link.ends);
            1.0 / (1.0 + slider.gain * y * ends.iter().map(|(_, beta)| beta.abs()).sum::<f64>())
        }));
        weights.extend(system.pulls().map(|(_, link)| {
            let ends = system.links.get(link).map_or(&[][..], |link| &link.ends);
            relative(y * ends.iter().map(|(_, beta)| beta.abs()).sum::<f64>())
        }));
    }

    fn admit(&self, state: &mut [f64]) {
        let system = self.flow.system;
        let (motion, forces) = state.split_at_mut((2 * system.dofs).min(state.len()));
        let (sliders, pulls) = forces.split_at_mut(system.sliders.len().min(forces.len()));
        sliders.iter_mut().for_each(|force| *force = force.clamp(-1.0, 1.0));
        let mut rest = pulls;
        for (_, press, friction) in system.frictions() {
            let count = friction.links().count().min(rest.len());
            let (own, others) = std::mem::take(&mut rest).split_at_mut(count);
            let pull = press.take_pull(&mut own.iter().copied());
            let touch = opening::begin(press, &system.links, motion, pull);
            own.iter_mut()
                .zip(opening::pull(press, touch, &system.links, motion))
                .for_each(|(own, pull)| *own = pull);
            rest = others;
        }
    }
}
