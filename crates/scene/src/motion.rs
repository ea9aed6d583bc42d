//! What the contacts of a scene do over one period, under their names.

use hbm::Waveform;

use crate::contacts::Place;
use crate::outcome::direction_names;
use crate::scene::Scene;

/// One contact over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactMotion<'a> {
    /// The contact's.
    pub name: &'a str,
    /// One, or the tangential ones and the normal one.
    pub directions: Vec<DirectionMotion<'a>>,
}

/// One direction of a contact over a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionMotion<'a> {
    /// `tangential`, …, `normal`; empty where the contact has one direction only.
    pub name: &'static str,
    /// Relative displacement in m.
    pub displacement: &'a [f64],
    /// Force on the first body in N.
    pub force: &'a [f64],
}

impl Scene {
    /// The contacts in the order of the scene.
    pub fn contact_motions<'a>(&'a self, waveform: &'a Waveform) -> Vec<ContactMotion<'a>> {
        let one = |i: usize| {
            let contact = waveform.contacts.get(i)?;
            Some(vec![DirectionMotion {
                name: "",
                displacement: &contact.displacement,
                force: &contact.force,
            }])
        };
        let several = |i: usize| {
            let joint = waveform.joints.get(i)?;
            let rows = joint.displacement.iter().zip(&joint.force);
            let names = direction_names(joint.displacement.len());
            let direction = |((displacement, force), name): ((&'a Vec<f64>, &'a Vec<f64>), &&'static str)| {
                DirectionMotion { name, displacement, force }
            };
            Some(rows.zip(names).map(direction).collect())
        };
        let motion = |(name, place): (&'a str, &Place)| {
            let directions = match *place {
                Place::Contact(i) => one(i)?,
                Place::Joint(i) => several(i)?,
            };
            Some(ContactMotion { name, directions })
        };
        self.contacts().zip(&self.contacts.order).filter_map(motion).collect()
    }
}
