//! What a solution is measured against: the exact orbit where there is one, else far more harmonics.

use std::fmt;

use contact::{JointMechanism, Mechanism};
use hbm::{Plan, Problem, Settings, Solution, Status};
use num_complex::Complex64;
use orbit::{Orbit, OrbitError};
use scene::Scene;
use thiserror::Error;

use crate::error::StudyError;
use crate::periodic::{dense, half_range};
use crate::start;
use crate::system::system;

/// Where a truth comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The exact periodic orbit.
    Orbit,
    /// A harmonic solution with that many harmonics.
    Harmonics(usize),
}

/// `orbit` or `harmonics:255`.
impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Orbit => write!(f, "orbit"),
            Self::Harmonics(n) => write!(f, "harmonics:{n}"),
        }
    }
}

/// The true motion of one output dof.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueDof {
    /// `W_0 … W_highest` in m, one-sided; far beyond the harmonics that are compared with it.
    pub spectrum: Vec<Complex64>,
    /// `√(Σ |W_k|²)` in m.
    pub norm: f64,
    /// Half the peak-to-peak displacement in m.
    pub amplitude: f64,
}

/// The true response at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// In Hz.
    pub frequency: f64,
    /// Where it comes from.
    pub reference: Reference,
    /// One entry an output dof of the scene, in its order.
    pub dofs: Vec<TrueDof>,
    /// Energy in J that all contacts together dissipate in a period.
    pub dissipation: f64,
    /// Why there is no orbit, where one could have been.
    pub no_orbit: Option<String>,
    /// How far the best harmonic solution lies from the orbit: the truncation error of that one. Where it is large the
    /// orbit is another solution than the one the balance finds.
    pub distance: Option<f64>,
    /// The harmonic whose amplitude is the first: the lowest that is excited.
    first: usize,
}

/// Distances of a solution from the truth, all relative; each the worst of the output dofs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// The truncation error: l2 error of the displacement spectrum over all harmonics.
    pub spectrum: f64,
    /// `||W_1| − |W_1|_true| / |W_1|_true`, for the lowest excited harmonic.
    pub first: f64,
    /// Of half the peak-to-peak displacement.
    pub peak: f64,
    /// Of the energy that all contacts together dissipate; `None` where nothing is dissipated.
    pub dissipation: Option<f64>,
}

/// There is neither an orbit nor a solution with many harmonics.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("no reference at {frequency} Hz: {why}")]
pub struct NoTruth {
    /// In Hz.
    pub frequency: f64,
    /// Why.
    pub why: String,
}

/// Dofs that move less than this part of the largest one do not count.
const AT_REST: f64 = 1e-6;

/// Dissipation below this part of force times displacement is rounding.
const NO_DISSIPATION: f64 = 1e-12;

/// Harmonics of an orbit that are compared: that many times those of the solutions. A spectrum of friction falls with
/// the fourth power, so that what lies beyond is 1e-4 of the error.
const BEYOND: usize = 16;

/// The truths of a scene; [`Truths::at`] gives that of one frequency.
pub struct Truths<'s> {
    /// The scene's problem; a structure that is reduced stays as it is, whatever the harmonics.
    posed: &'s Problem,
    /// Positions of the scene's output dofs are their numbers: every dof is recovered.
    plan: Plan,
    harmonics: usize,
    highest: usize,
    has_orbits: bool,
}

impl<'s> Truths<'s> {
    /// Truths for comparison with solutions of `scene` that have at most `largest` harmonics.
    ///
    /// # Errors
    /// When the scene cannot be solved as posed.
    pub fn new(scene: &'s Scene, largest: usize) -> Result<Self, StudyError> {
        let harmonics = reference_harmonics(largest);
        let posed = scene.problem()?;
        let mut problem = posed.clone();
        problem.output = (0..problem.model.dofs()).collect();
        let settings = Settings {
            harmonics,
            truncation: None,
            estimate: false,
            all_solutions: false,
            start: hbm::Start::Ladder,
            ..scene.settings().clone()
        };
        let plan = Plan::new(&problem, &settings)?;
        let mechanism = |contact: &hbm::Contact| !matches!(contact.law.mechanism(), Mechanism::None { .. });
        let joint_mechanism =
            |joint: &hbm::Joint| !matches!(joint.law.mechanism(), JointMechanism::None { .. });
        let has_orbits = problem.contacts.iter().all(mechanism) && problem.joints.iter().all(joint_mechanism);
        Ok(Self { posed, plan, harmonics, highest: (BEYOND * (largest + 1)).max(512), has_orbits })
    }

    /// The same truths with spectra of orbits up to harmonic `highest` at least.
    #[must_use]
    pub fn compared_up_to(mut self, highest: usize) -> Self {
        self.highest = self.highest.max(highest);
        self
    }

    /// Whether every contact moves by a mechanism, so that there are exact orbits.
    pub fn has_orbits(&self) -> bool {
        self.has_orbits
    }

    /// What solutions are compared with if nothing goes wrong.
    pub fn usual(&self) -> Reference {
        if self.has_orbits { Reference::Orbit } else { Reference::Harmonics(self.harmonics) }
    }

    /// The truth at `hertz`: the exact orbit, looked for from the harmonic solution so that the same branch is found, and
    /// from rest if need be; else the harmonic solution itself.
    ///
    /// # Errors
    /// [`NoTruth`] when there is neither.
    pub fn at(&self, hertz: f64) -> Result<Truth, NoTruth> {
        let solution = self.plan.solve(hertz, &mut self.plan.workspace());
        let mut no_orbit = None;
        if self.has_orbits && hertz > 0.0 {
            match self.beside(hertz, &solution) {
                Ok(orbit) => return Ok(self.orbit_truth(hertz, &orbit, &solution)),
                Err(OrbitError::Stuck) => no_orbit = Some("every slider sticks, the motion is linear".into()),
                Err(error) => no_orbit = Some(error.to_string()),
            }
        }
        match (solution.status, no_orbit) {
            (Status::Failed(reason), Some(why)) => {
                let why = format!("{why}; with {} harmonics {reason}", self.harmonics);
                Err(NoTruth { frequency: hertz, why })
            }
            (Status::Failed(reason), None) => {
                let why = format!("with {} harmonics {reason}", self.harmonics);
                Err(NoTruth { frequency: hertz, why })
            }
            (_, no_orbit) => Ok(self.harmonic_truth(&solution, no_orbit)),
        }
    }

    /// The exact orbit at `hertz`, beside the harmonic solution where there are several.
    ///
    /// # Errors
    /// Why there is none.
    pub fn orbit(&self, hertz: f64) -> Result<Orbit, OrbitError> {
        self.beside(hertz, &self.plan.solve(hertz, &mut self.plan.workspace()))
    }

    fn beside(&self, hertz: f64, solution: &Solution) -> Result<Orbit, OrbitError> {
        let system = system(self.posed, hertz);
        let usual = orbit::Settings::default();
        let start = (solution.status.solved())
            .then(|| start::state(&system, self.plan.orders(), &solution.displacement, solution));
        let beside = orbit::Settings { start, ..usual.clone() };
        let found = orbit::find(&system, hertz, &beside);
        if found.is_err() && beside.start.is_some() {
            return orbit::find(&system, hertz, &usual).or(found);
        }
        found
    }

    fn outputs(&self) -> &[usize] {
        &self.posed.output
    }

    fn first(&self) -> usize {
        self.plan.facts().fundamental.max(1)
    }

    fn orbit_truth(&self, hertz: f64, orbit: &Orbit, solution: &Solution) -> Truth {
        let dof = |dof: &usize| {
            let (least, most) = orbit.range(*dof);
            TrueDof {
                spectrum: orbit.spectrum(*dof, self.highest),
                norm: orbit.norm(*dof),
                amplitude: 0.5 * (most - least),
            }
        };
        let (contacts, joints) = (0..self.posed.contacts.len(), 0..self.posed.joints.len());
        let mut truth = Truth {
            frequency: hertz,
            reference: Reference::Orbit,
            dofs: self.outputs().iter().map(dof).collect(),
            dissipation: contacts
                .map(|contact| orbit.dissipation(contact))
                .chain(joints.map(|joint| orbit.joint_dissipation(joint)))
                .sum(),
            no_orbit: None,
            distance: None,
            first: self.first(),
        };
        let rows: Vec<&[Complex64]> = self.rows(solution);
        truth.distance = solution.status.solved().then(|| truth.spectrum_error(self.plan.orders(), &rows));
        truth
    }

    /// The rows of the scene's output dofs in a solution that has all dofs.
    fn rows<'a>(&self, solution: &'a Solution) -> Vec<&'a [Complex64]> {
        let row = |dof: &usize| solution.displacement.get(*dof).map_or(&[][..], Vec::as_slice);
        self.outputs().iter().map(row).collect()
    }

    fn harmonic_truth(&self, solution: &Solution, no_orbit: Option<String>) -> Truth {
        let dof = |row: &[Complex64]| {
            let spectrum = dense(self.plan.orders(), row);
            let norm = spectrum.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
            TrueDof { amplitude: half_range(&spectrum), spectrum, norm }
        };
        Truth {
            frequency: solution.frequency,
            reference: Reference::Harmonics(solution.harmonics),
            dofs: self.rows(solution).into_iter().map(dof).collect(),
            dissipation: dissipation(solution),
            no_orbit,
            distance: None,
            first: self.first(),
        }
    }
}

/// Energy in J that all contacts of a solution together dissipate in a period.
pub(crate) fn dissipation(solution: &Solution) -> f64 {
    let joints = solution.joints.iter().map(|joint| joint.dissipation);
    solution.contacts.iter().map(|contact| contact.dissipation).chain(joints).sum()
}

/// Enough that the reference's own error does not count: four times as many, 127 at least; no more than 1023 unless the
/// solutions themselves have that many.
fn reference_harmonics(largest: usize) -> usize {
    (4 * (largest + 1) - 1).clamp(127, 1023).max(2 * largest + 1).min(4095)
}

impl Truth {
    /// Distances of a solution of the same scene, whose amplitudes belong to the harmonics `orders`; `None` when the
    /// point failed.
    pub fn errors(&self, orders: &[usize], solution: &Solution) -> Option<Errors> {
        if !solution.status.solved() {
            return None;
        }
        let rows: Vec<&[Complex64]> = solution.displacement.iter().map(Vec::as_slice).collect();
        let first = |spectrum: &[Complex64]| spectrum.get(self.first).map_or(0.0, |w| w.norm());
        let spectra: Vec<Vec<Complex64>> = rows.iter().map(|row| dense(orders, row)).collect();
        let pairs = || self.dofs.iter().zip(&spectra);
        let dissipation = dissipation(solution);
        Some(Errors {
            spectrum: self.spectrum_error(orders, &rows),
            first: worst(pairs().map(|(truth, row)| {
                let size = first(&truth.spectrum);
                ((first(row) - size).abs(), size)
            })),
            peak: worst(
                pairs().map(|(truth, row)| ((half_range(row) - truth.amplitude).abs(), truth.amplitude)),
            ),
            dissipation: self.dissipates(solution).then(|| (dissipation / self.dissipation - 1.0).abs()),
        })
    }

    /// The truncation error of amplitudes at the harmonics `orders`, one row per output dof.
    pub fn spectrum_error(&self, orders: &[usize], rows: &[&[Complex64]]) -> f64 {
        worst(self.dofs.iter().zip(rows).map(|(truth, row)| {
            let row = dense(orders, row);
            let harmonics = 0..truth.spectrum.len().max(row.len());
            let at = |spectrum: &[Complex64], k: usize| spectrum.get(k).copied().unwrap_or_default();
            let square = |k: usize| (at(&row, k) - at(&truth.spectrum, k)).norm_sqr();
            (harmonics.map(square).sum::<f64>().sqrt(), truth.norm)
        }))
    }

    /// Whether the true dissipation is more than rounding.
    fn dissipates(&self, solution: &Solution) -> bool {
        let work = |contact: &hbm::ContactSolution| {
            contact.force.iter().map(|force| force.norm()).fold(0.0, f64::max) * contact.amplitude
        };
        let directions = solution.joints.iter().flat_map(|joint| &joint.directions);
        let joints = directions
            .map(|d| d.force.iter().map(|force| force.norm()).fold(0.0, f64::max) * d.amplitude)
            .sum::<f64>();
        self.dissipation > NO_DISSIPATION * (solution.contacts.iter().map(work).sum::<f64>() + joints)
    }
}

/// The largest quotient of (error, size), where a size counts as at least [`AT_REST`] of the largest one; without any
/// size the response is zero, and so is the error unless there is one.
fn worst(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let largest = pairs.clone().map(|(_, size)| size).fold(0.0, f64::max);
    let quotient = |(error, size): (f64, f64)| match size.max(AT_REST * largest) {
        _ if error == 0.0 => 0.0,
        0.0 => f64::INFINITY,
        size => error / size,
    };
    pairs.map(quotient).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn dofs_at_rest_do_not_count() {
        assert_eq!(worst([(1.0, 2.0), (0.0, 0.0)].into_iter()), 0.5);
        assert_eq!(worst([(1.0, 2.0), (1e-9, 0.0)].into_iter()), 0.5);
        assert_eq!(worst([(0.0, 0.0)].into_iter()), 0.0);
    }

    #[test]
    fn a_reference_has_many_more_harmonics() {
        assert_eq!(
            [1, 31, 63, 255, 511, 1023, 4000].map(reference_harmonics),
            [127, 127, 255, 1023, 1023, 2047, 4095]
        );
    }

    const SCENE: &str = r#"{
        "model": {"dofs": ["w1", "w2"], "mass": [[3.98, 0], [0, 1.27]], "damping": [[24, 0], [0, 24]],
                  "stiffness": [[8.2e5, -4.1e5], [-4.1e5, 4.1e5]]},
        "excitation": [{"dof": "w2", "amplitude": 9.1}],
        "contacts": [{"name": "root", "between": ["w1", "ground"], "law": LAW}],
        "frequencies": [75.0], "output": ["w2", "w1"]}"#;

    fn error(law: &str, n: usize) -> (Truth, Errors) {
        let scene = Scene::from_str(&SCENE.replace("LAW", law), Path::new("")).unwrap();
        let scene = scene.with_harmonics(n).unwrap();
        let truth = Truths::new(&scene, n).unwrap().at(75.0).unwrap();
        let prepared = scene.prepare().unwrap();
        let plan = prepared.plan();
        let solution = plan.solve(75.0, &mut plan.workspace());
        let errors = truth.errors(plan.orders(), &solution).unwrap();
        (truth, errors)
    }

    #[test]
    fn more_harmonics_are_nearer_to_the_truth() {
        let law = r#"{"type": "scaled_loop", "loop": {"displacement": 8e-6, "harmonics": [[1, 0.32, 11.99], [3, 2.83, 2.55]]}}"#;
        let (truth, one) = error(law, 1);
        let (_, seven) = error(law, 7);
        assert_eq!(truth.reference, Reference::Harmonics(127));
        assert_eq!(truth.reference.to_string(), "harmonics:127");
        assert!(one.spectrum > 10.0 * seven.spectrum && seven.spectrum > 0.0, "{one:?} {seven:?}");
        assert!(one.dissipation.unwrap() < 1.0 && seven.dissipation.unwrap() < 0.1, "{one:?} {seven:?}");
    }

    #[test]
    fn a_linear_scene_has_no_error() {
        let (truth, errors) = error(r#"{"type": "linear", "stiffness": 1e5}"#, 3);
        assert!(errors.spectrum < 1e-10 && errors.first < 1e-10 && errors.peak < 1e-10, "{errors:?}");
        assert_eq!(errors.dissipation, None);
        assert_eq!(truth.dofs.len(), 2);
    }
}
