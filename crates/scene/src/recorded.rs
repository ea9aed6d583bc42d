//! Points of a result that was written down, put back into the scene they came from: checked against it, and seen in
//! time as the contact laws make them.

use std::fmt;
use std::marker::PhantomData;

use contact::ContactState;
use hbm::{ContactSolution, DirectionSolution, JointSolution, Solution, Status, Waveform, Workspace};
use num_complex::Complex64;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use thiserror::Error;

use crate::contacts::Place;
use crate::outcome::{Named, Spectrum};
use crate::run::Prepared;

/// A solved point of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedPoint {
    /// In Hz.
    pub frequency: f64,
    /// N.
    pub harmonics: usize,
    /// Spectrum in m of each output dof.
    pub displacement: Named<Spectrum>,
    /// The contacts.
    pub contacts: Named<RecordedContact>,
}

/// A contact of a recorded point.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedContact {
    /// It is at rest, held by its law.
    pub held: bool,
    /// Relative displacement in m and force on the first body in N of each direction.
    pub directions: Vec<(Spectrum, Spectrum)>,
}

/// A result that is not of the scene.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Mismatch {
    /// Other dofs.
    #[error("the result has the dofs {result}, the scene reports {scene}")]
    Dofs {
        /// Those of the result.
        result: String,
        /// Those of the scene.
        scene: String,
    },
    /// Other contacts.
    #[error("the result has the contacts {result}, the scene has {scene}")]
    Contacts {
        /// Those of the result.
        result: String,
        /// Those of the scene.
        scene: String,
    },
    /// A contact with another number of directions.
    #[error("contact {contact:?} has {result} directions in the result and {scene} in the scene")]
    Directions {
        /// The contact.
        contact: String,
        /// In the result.
        result: usize,
        /// In the scene.
        scene: usize,
    },
    /// A harmonic that the scene does not have.
    #[error("the result has harmonic {harmonic} at {frequency} Hz, which the scene leaves out")]
    Harmonic {
        /// The harmonic.
        harmonic: usize,
        /// In Hz.
        frequency: f64,
    },
    /// Displacements that its structure and excitation do not have under the recorded forces.
    #[error(
        "at {frequency} Hz model and excitation of the scene move {dof:?} otherwise than the result says, by {error:.1e} \
         (relative)"
    )]
    Structure {
        /// The dof.
        dof: String,
        /// In Hz.
        frequency: f64,
        /// Relative.
        error: f64,
    },
    /// Forces that its law does not have.
    #[error(
        "at {frequency} Hz the law of contact {contact:?} answers the recorded motion with another force than the result \
         says, off by {error:.1e} (relative)"
    )]
    Law {
        /// The contact.
        contact: String,
        /// In Hz.
        frequency: f64,
        /// Relative.
        error: f64,
    },
}

/// Displacements of a result and its scene agree to this part of what they are made of. A reduction made for other
/// frequencies is off by 1e-4, rounding by far less.
const STRUCTURE: f64 = 1e-3;

/// Likewise forces: those of a result may come from few samples a period.
const LAW: f64 = 1e-2;

/// Parts of the largest force below which a contact counts as without one.
const NO_FORCE: f64 = 1e-9;

impl Prepared<'_> {
    /// The solution that `point` wrote down, its names and harmonics those of the scene.
    ///
    /// # Errors
    /// [`Mismatch`] when they are others.
    pub fn recall(&self, point: &RecordedPoint) -> Result<Solution, Mismatch> {
        let scene = self.scene;
        let names = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join(", ");
        let (ours, theirs) = (scene.output(), point.displacement.0.iter().map(|(name, _)| name.as_str()));
        if !ours.iter().copied().eq(theirs.clone()) {
            let (result, scene) = (names(&mut theirs.clone()), names(&mut ours.into_iter()));
            return Err(Mismatch::Dofs { result, scene });
        }
        let theirs = point.contacts.0.iter().map(|(name, _)| name.as_str());
        if !scene.contacts().eq(theirs.clone()) {
            let (result, scene) = (names(&mut theirs.clone()), names(&mut scene.contacts()));
            return Err(Mismatch::Contacts { result, scene });
        }
        let row = |spectrum: &Spectrum| self.row(point.frequency, spectrum);
        let displacement = point.displacement.0.iter().map(|(_, spectrum)| row(spectrum));
        let mut solution = Solution {
            frequency: point.frequency,
            status: Status::Converged,
            harmonics: point.harmonics,
            displacement: displacement.collect::<Result<_, _>>()?,
            contacts: vec![ContactSolution::default(); scene.contacts.contacts.len()],
            joints: vec![JointSolution::default(); scene.contacts.joints.len()],
            ..Solution::default()
        };
        for ((name, contact), place) in point.contacts.0.iter().zip(&scene.contacts.order) {
            let directions = contact.directions.iter().map(|(displacement, force)| {
                Ok(DirectionSolution { amplitude: 0.0, displacement: row(displacement)?, force: row(force)? })
            });
            let directions: Vec<DirectionSolution> = directions.collect::<Result<_, _>>()?;
            let other = |scene: usize| Mismatch::Directions {
                contact: name.clone(),
                result: directions.len(),
                scene,
            };
            let state = if contact.held { ContactState::Held } else { ContactState::Mixed };
            match *place {
                Place::Contact(i) => {
                    let [direction] = directions.as_slice() else { return Err(other(1)) };
                    let (displacement, force) = (direction.displacement.clone(), direction.force.clone());
                    if let Some(entry) = solution.contacts.get_mut(i) {
                        *entry = ContactSolution { state, displacement, force, ..ContactSolution::default() };
                    }
                }
                Place::Joint(i) => {
                    let count = scene.contacts.joints.get(i).map_or(0, |joint| joint.directions.len());
                    if directions.len() != count {
                        return Err(other(count));
                    }
                    if let Some(entry) = solution.joints.get_mut(i) {
                        *entry = JointSolution { state, directions, ..JointSolution::default() };
                    }
                }
            }
        }
        Ok(solution)
    }

    /// A spectrum over the plan's harmonics.
    fn row(&self, frequency: f64, spectrum: &Spectrum) -> Result<Vec<Complex64>, Mismatch> {
        let orders = self.plan.orders();
        let mut row = vec![Complex64::ZERO; orders.len()];
        for (harmonic, amplitude) in &spectrum.0 {
            let slot = orders.iter().position(|order| order == harmonic).and_then(|slot| row.get_mut(slot));
            match slot {
                Some(slot) => *slot = *amplitude,
                None if *amplitude == Complex64::ZERO => {}
                None => return Err(Mismatch::Harmonic { harmonic: *harmonic, frequency }),
            }
        }
        Ok(row)
    }

    /// Whether model and excitation of the scene move the output dofs as `solution` says, under its contact forces.
    ///
    /// # Errors
    /// [`Mismatch::Structure`] when they do not.
    pub fn check_structure(&self, solution: &Solution, workspace: &mut Workspace) -> Result<(), Mismatch> {
        // At a singular structure the contacts alone hold the motion, and nothing is known.
        let Some(response) = self.plan.response_under(solution, workspace) else { return Ok(()) };
        for ((name, row), recorded) in self.scene.output().iter().zip(&response).zip(&solution.displacement) {
            let size = row.iter().map(|(_, size)| size * size).sum::<f64>().sqrt();
            let distance: f64 = row.iter().zip(recorded).map(|((w, _), r)| (w - r).norm_sqr()).sum();
            let error = distance.sqrt() / size;
            if error > STRUCTURE {
                let (dof, frequency) = ((*name).to_owned(), solution.frequency);
                return Err(Mismatch::Structure { dof, frequency, error });
            }
        }
        Ok(())
    }

    /// Whether the contact laws of the scene answer the motion of `solution` with its forces; `waveform` is its motion.
    ///
    /// # Errors
    /// [`Mismatch::Law`] when they do not.
    pub fn check_laws(&self, solution: &Solution, waveform: &Waveform) -> Result<(), Mismatch> {
        let contacts = solution.contacts.iter().zip(&waveform.contacts);
        let contacts = contacts.map(|(contact, wave)| (&contact.force, &wave.force)).collect::<Vec<_>>();
        let directions = solution.joints.iter().zip(&waveform.joints).map(|(joint, wave)| {
            joint.directions.iter().map(|d| &d.force).zip(&wave.force).collect::<Vec<_>>()
        });
        let directions: Vec<_> = directions.collect();
        let largest = contacts.iter().chain(directions.iter().flatten());
        let largest = largest.map(|(force, _)| norm(force)).fold(0.0, f64::max);
        for (name, place) in self.scene.contacts().zip(&self.scene.contacts.order) {
            let rows = match *place {
                Place::Contact(i) => contacts.get(i).into_iter().collect::<Vec<_>>(),
                Place::Joint(i) => directions.get(i).into_iter().flatten().collect(),
            };
            let (mut size, mut distance) = (0.0_f64, 0.0_f64);
            for (force, wave) in rows {
                size = size.hypot(norm(force));
                for (&order, recorded) in self.plan.orders().iter().zip(force.iter()) {
                    if order <= solution.harmonics {
                        distance = distance.hypot((harmonic(wave, order) - recorded).norm());
                    }
                }
            }
            if distance > LAW * size && distance > NO_FORCE * largest {
                let (contact, frequency) = (name.to_owned(), solution.frequency);
                return Err(Mismatch::Law { contact, frequency, error: distance / size });
            }
        }
        Ok(())
    }
}

fn norm(row: &[Complex64]) -> f64 {
    row.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt()
}

/// One-sided amplitude of one harmonic of a sampled period.
fn harmonic(samples: &[f64], order: usize) -> Complex64 {
    let count = samples.len().max(1);
    let turn =
        |j: usize| Complex64::cis(-std::f64::consts::TAU * ((order * j) % count) as f64 / count as f64);
    let sum: Complex64 = samples.iter().enumerate().map(|(j, x)| turn(j) * x).sum();
    sum * if order == 0 { 1.0 } else { 2.0 } / count as f64
}

impl<'de> Deserialize<'de> for Spectrum {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let lines = Vec::<(usize, f64, f64)>::deserialize(deserializer)?;
        Ok(Self(lines.into_iter().map(|(k, re, im)| (k, Complex64::new(re, im))).collect()))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

/// Reads the members of an object in their order.
struct Entries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
    type Value = Named<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Named<T>, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Named(entries))
    }
}
