//! From the wish to the problem: the dofs that matter are kept, a large structure is reduced onto them.

use hbm::{Contact, Direction, Excitation, ExcitationKind, Joint, Problem};
use structure::{ModeCount, Progress, SparseDamping, SparseModel};

use crate::contacts::Contacts;
use crate::error::SceneError;
use crate::reduction::{Reduced, ReductionFacts, SMALL, Wish};
use crate::scene::Scene;
use crate::structure::{Structure, with_base};

/// The problem of a scene in the terms of the balance.
#[derive(Debug, Clone)]
pub(crate) struct Posed {
    pub(crate) problem: Problem,
    /// How its structure was reduced, where it was.
    pub(crate) reduced: Option<Reduced>,
}

/// Highest frequency in Hz of a static response.
const STATIC: f64 = 1.0;

/// Dofs that a force, a contact or the output names, ascending.
fn kept(excitation: &[Excitation], contacts: &Contacts, output: &[usize]) -> Vec<usize> {
    let forces = excitation.iter().filter(|entry| entry.kind != ExcitationKind::Base).map(|entry| entry.dof);
    let mut dofs: Vec<usize> = forces.chain(contacts.touched()).chain(output.iter().copied()).collect();
    dofs.sort_unstable();
    dofs.dedup();
    dofs
}

impl Scene {
    /// The problem on a structure that is large and not to be reduced, and M r of its base motions. Modal damping needs
    /// the modes of dense matrices.
    pub(crate) fn direct(&self) -> Option<(Problem<SparseModel>, Vec<Vec<f64>>)> {
        let Structure::Sparse(sparse) = &self.structure else { return None };
        let modal = matches!(sparse.model.damping, SparseDamping::ModalRatio(_));
        if sparse.wish != Wish::Full || sparse.model.dofs() <= SMALL || modal {
            return None;
        }
        Some((self.problem_of(sparse.model.clone(), Some), sparse.base_loads(&self.directions)))
    }

    pub(crate) fn pose(&self, progress: &mut dyn FnMut(Progress)) -> Result<Posed, SceneError> {
        match &self.structure {
            Structure::Dense { dofs, model, mass } => {
                let model = with_base(model, dofs, mass.as_ref(), &self.directions)?;
                Ok(Posed { problem: self.problem_of(model, Some), reduced: None })
            }
            Structure::Sparse(sparse) => {
                let keep = kept(&self.excitation, &self.contacts, &self.output);
                let Some(reduced) = sparse.reduced(keep, &self.directions, self.range(), progress)? else {
                    return Ok(Posed {
                        problem: self.problem_of(sparse.full(&self.directions)?, Some),
                        reduced: None,
                    });
                };
                // Kept dofs come first.
                let number = |dof: usize| reduced.key.keep.binary_search(&dof).ok();
                let problem = self.problem_of(reduced.reduction.model.clone(), number);
                Ok(Posed { problem, reduced: Some(reduced) })
            }
        }
    }

    /// Lowest and highest frequency in Hz at which the structure is asked for an answer.
    fn range(&self) -> (f64, f64) {
        let frequencies = self.frequencies.as_slice().iter().copied();
        let (least, most) = frequencies.fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f), b.max(f)));
        // Where only the static response is asked for, any small band will do.
        let most = if most > 0.0 { most } else { STATIC };
        (least.min(most), most * self.settings.harmonics as f64)
    }

    /// The problem on a model in which the dofs have other numbers; those without one are not in it.
    fn problem_of<M>(&self, model: M, number: impl Fn(usize) -> Option<usize>) -> Problem<M> {
        let moved = |entry: &Excitation| match entry.kind {
            ExcitationKind::Base => Some(*entry),
            _ => Some(Excitation { dof: number(entry.dof)?, ..*entry }),
        };
        let touching = |contact: &Contact| {
            let second = match contact.second {
                Some(second) => Some(number(second)?),
                None => None,
            };
            Some(Contact { first: number(contact.first)?, second, ..contact.clone() })
        };
        let moved_direction = |direction: &Direction| {
            let part = |&(dof, coefficient): &(usize, f64)| Some((number(dof)?, coefficient));
            Some(Direction { parts: direction.parts.iter().map(part).collect::<Option<_>>()? })
        };
        let joined = |joint: &Joint| {
            let directions = joint.directions.iter().map(moved_direction).collect::<Option<_>>()?;
            Some(Joint { directions, ..joint.clone() })
        };
        Problem {
            model,
            excitation: self.excitation.iter().filter_map(moved).collect(),
            contacts: self.contacts.contacts.iter().filter_map(touching).collect(),
            joints: self.contacts.joints.iter().filter_map(joined).collect(),
            output: self.output.iter().filter_map(|dof| number(*dof)).collect(),
        }
    }
}

impl Posed {
    /// What the reduction left, where there is one; `dofs` is what there was.
    pub(crate) fn facts(&self, dofs: usize) -> Option<ReductionFacts> {
        self.reduced.as_ref().map(|reduced| reduced.facts(dofs))
    }

    /// What a user should know about the reduction.
    pub(crate) fn notes(&self) -> Vec<String> {
        let Some(Reduced { key, reduction }) = &self.reduced else { return Vec::new() };
        let ModeCount::Automatic { tolerance } = key.options.modes else { return Vec::new() };
        let note = |error: &f64| {
            let modes = reduction.modes;
            format!(
                "model.reduction: the response of the reduced structure has an error of {error:.1e} (estimate), not \
                 {tolerance:e}; more than {modes} modes do not help"
            )
        };
        reduction.error.iter().filter(|error| **error > tolerance).map(note).collect()
    }
}
