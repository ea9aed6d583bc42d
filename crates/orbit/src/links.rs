//! What connects dofs: contacts in one direction and every direction of a joint, as forces along functionals of y.

use std::ops::Range;
use std::sync::Arc;

use contact::{JointMechanism, Law, Mechanism, UnilateralSpring};
use faer::Mat;

use crate::error::OrbitError;
use crate::scaled::Scaled;
use crate::system::System;

/// A slider: elastic up to a limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slider {
    /// Contact it belongs to, which is also its link.
    pub(crate) contact: usize,
    /// k_t.
    pub(crate) stiffness: f64,
    /// F_s.
    pub(crate) limit: f64,
    /// Change of force, in units of its limit, by a unit of relative displacement.
    pub(crate) gain: f64,
}

/// A contact that opens.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Press {
    /// Its contact; joints are counted on after the contacts.
    pub(crate) contact: usize,
    /// Link along the normal.
    pub(crate) normal: usize,
    /// k_n.
    pub(crate) stiffness: f64,
    /// N at u_n = 0, before it is cut at zero.
    pub(crate) pressure: f64,
    /// Part of N that is no force: it belongs to the equilibrium displacements are measured from.
    pub(crate) balanced: f64,
    pub(crate) friction: Option<Friction>,
}

/// A spring in series with a slider whose limit is μN, in one or two tangential directions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction {
    /// Link along the first tangent.
    pub(crate) link: usize,
    /// Along the second, where there is one.
    pub(crate) second: Option<usize>,
    /// k_t.
    pub(crate) stiffness: f64,
    /// μ.
    pub(crate) coefficient: f64,
}

/// A contact, or one direction of a joint.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    /// β: dof and factor.
    pub(crate) ends: Vec<(usize, f64)>,
    /// M̃⁻¹β.
    pub(crate) acceleration: Vec<f64>,
    /// Stiffness of the spring beside the sliders.
    pub(crate) spring: f64,
    /// Its sliders among all of the system.
    pub(crate) sliders: Range<usize>,
    /// Set for smooth laws.
    pub(crate) smooth: Option<Arc<dyn Law>>,
    /// Factor on the law's force.
    pub(crate) scale: f64,
}

/// The force of a link between events: `φ = stiffness · u + coupled · u_other + constant`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Elastic {
    pub(crate) stiffness: f64,
    pub(crate) constant: f64,
    /// Another link and the stiffness by which its displacement acts here: μk_n while a joint slips.
    pub(crate) coupled: Option<(usize, f64)>,
}

impl Friction {
    /// Links along the tangents.
    pub(crate) fn links(&self) -> impl Iterator<Item = usize> + use<> {
        [Some(self.link), self.second].into_iter().flatten()
    }

    /// β·x along the tangents; zero where there is none.
    pub(crate) fn along(&self, links: &[Link], x: &[f64]) -> [f64; 2] {
        let relative = |link: usize| links.get(link).map_or(0.0, |link| link.relative(x));
        [relative(self.link), self.second.map_or(0.0, relative)]
    }
}

impl Press {
    /// Slip turns its direction: friction in two tangential directions.
    pub(crate) fn is_planar(&self) -> bool {
        self.friction.is_some_and(|friction| friction.second.is_some())
    }

    /// μ/k_t: what a pressure means for the slider.
    pub(crate) fn reach(&self) -> f64 {
        self.friction.map_or(0.0, |friction| friction.coefficient / friction.stiffness)
    }

    /// The next elongations of its tangential spring among those of all: one a tangential direction.
    pub(crate) fn take_pull(&self, all: &mut impl Iterator<Item = f64>) -> [f64; 2] {
        let mut pull = [0.0; 2];
        let directions = self.friction.iter().flat_map(Friction::links).count();
        pull.iter_mut().zip(all.take(directions)).for_each(|(slot, pull)| *slot = pull);
        pull
    }

    /// Adds `−factor · force` along the tangents to an acceleration.
    pub(crate) fn push(&self, links: &[Link], force: [f64; 2], factor: f64, acceleration: &mut [f64]) {
        for (link, force) in self.friction.iter().flat_map(Friction::links).zip(force) {
            let own = links.get(link).map_or(&[][..], |link| &link.acceleration);
            acceleration.iter_mut().zip(own).for_each(|(sum, a)| *sum -= factor * force * a);
        }
    }

    /// β_n·x.
    pub(crate) fn approach(&self, links: &[Link], x: &[f64]) -> f64 {
        links.get(self.normal).map_or(0.0, |link| link.relative(x))
    }

    /// N before it is cut.
    pub(crate) fn pressure_at(&self, links: &[Link], y: &[f64]) -> f64 {
        self.pressure + self.stiffness * self.approach(links, y)
    }
}

impl Link {
    /// Relative displacement β·y.
    pub(crate) fn relative(&self, y: &[f64]) -> f64 {
        self.ends.iter().map(|&(dof, factor)| factor * y.get(dof).copied().unwrap_or(0.0)).sum()
    }
}

impl Elastic {
    /// Links whose displacements act on link `own`, itself first, and their stiffnesses.
    pub(crate) fn parts(&self, own: usize) -> impl Iterator<Item = (usize, f64)> + use<> {
        [Some((own, self.stiffness)), self.coupled].into_iter().flatten()
    }

    /// `factor` times the change of force of link `own` by a change of y.
    pub(crate) fn pull(&self, factor: f64, own: usize, links: &[Link], y: &[f64]) -> f64 {
        let part =
            |(link, k): (usize, f64)| factor * k * links.get(link).map_or(0.0, |link| link.relative(y));
        self.parts(own).map(part).sum()
    }
}

impl Scaled {
    pub(crate) fn add_contacts(&mut self, system: &System, inverse: &Mat<f64>) -> Result<(), OrbitError> {
        let stiffness_unit = self.omega * self.omega;
        for (index, contact) in system.contacts.iter().enumerate() {
            let parts = [(Some(contact.first), 1.0), (contact.second, -1.0)];
            let parts = parts.into_iter().filter_map(|(dof, sign)| Some((dof?, sign)));
            let mut link = self.link(parts, inverse);
            link.scale = contact.scale;
            let first = self.sliders.len();
            match contact.law.mechanism() {
                Mechanism::Sliders { sliders, spring } => {
                    link.spring = contact.scale * spring / stiffness_unit;
                    self.sliders.extend(sliders.iter().map(|slider| {
                        let stiffness = contact.scale * slider.stiffness() / stiffness_unit;
                        let limit = contact.scale * slider.slip_force() / (stiffness_unit * self.size);
                        Slider { contact: index, stiffness, limit, gain: stiffness / limit }
                    }));
                }
                Mechanism::Smooth(_) => link.smooth = Some(contact.law.clone()),
                Mechanism::Unilateral(spring) => {
                    let press = self.press((index, self.links.len()), &spring, contact.scale);
                    self.presses.push(press);
                }
                Mechanism::None { why } => {
                    let (contact, law) = (contact.name.clone(), contact.law.name());
                    return Err(OrbitError::NoMechanism { contact, law, why });
                }
            }
            link.sliders = first..self.sliders.len();
            self.links.push(link);
        }
        self.add_joints(system, inverse)?;
        self.check_mixture(system)
    }

    fn add_joints(&mut self, system: &System, inverse: &Mat<f64>) -> Result<(), OrbitError> {
        let contacts = system.contacts.len();
        for (index, joint) in system.joints.iter().enumerate() {
            let none = |why| {
                let (contact, law) = (joint.name.clone(), joint.law.name());
                Err(OrbitError::NoMechanism { contact, law, why })
            };
            let first = self.links.len();
            for direction in &joint.directions {
                let link = self.link(direction.iter().copied(), inverse);
                self.links.push(link);
            }
            let all = first..self.links.len();
            match joint.law.mechanism() {
                JointMechanism::Friction { tangential_stiffness, friction_coefficient, normal } => {
                    if !(2..=3).contains(&all.len()) {
                        return none("friction is followed in one or two tangential directions");
                    }
                    let mut press = self.press((contacts + index, all.end - 1), &normal, joint.scale);
                    press.friction = Some(Friction {
                        link: first,
                        second: (all.len() == 3).then_some(first + 1),
                        stiffness: joint.scale * tangential_stiffness / (self.omega * self.omega),
                        coefficient: friction_coefficient,
                    });
                    self.presses.push(press);
                }
                JointMechanism::None { why } => return none(why),
            }
            self.directions.push(all);
        }
        Ok(())
    }

    fn link(&self, parts: impl Iterator<Item = (usize, f64)>, inverse: &Mat<f64>) -> Link {
        let ends: Vec<(usize, f64)> =
            parts.filter_map(|(dof, factor)| Some((dof, factor / self.root_mass.get(dof)?))).collect();
        let along = |i: usize| ends.iter().map(|&(j, beta)| inverse[(i, j)] * beta).sum();
        let acceleration = (0..self.dofs).map(along).collect();
        Link { ends, acceleration, spring: 0.0, sliders: 0..0, smooth: None, scale: 1.0 }
    }

    fn press(&self, (contact, normal): (usize, usize), spring: &UnilateralSpring, scale: f64) -> Press {
        let force = scale / (self.omega * self.omega * self.size);
        Press {
            contact,
            normal,
            stiffness: scale * spring.stiffness / (self.omega * self.omega),
            pressure: force * spring.pressure_at_zero,
            balanced: force * spring.balanced,
            friction: None,
        }
    }

    /// Smooth laws are integrated, all others followed from event to event.
    fn check_mixture(&self, system: &System) -> Result<(), OrbitError> {
        let names: Vec<&String> = system
            .contacts
            .iter()
            .map(|contact| &contact.name)
            .chain(system.joints.iter().map(|joint| &joint.name))
            .collect();
        let name = |index: usize| names.get(index).map(|name| (*name).clone());
        let smooth = self.links.iter().position(|link| link.smooth.is_some()).and_then(name);
        let sliders = self.sliders.iter().map(|slider| slider.contact);
        let sliders = sliders.chain(self.presses.iter().map(|press| press.contact)).next().and_then(name);
        match (smooth, sliders) {
            (Some(smooth), Some(sliders)) => Err(OrbitError::Mixed { smooth, sliders }),
            _ => Ok(()),
        }
    }
}
