//! What a problem needs, made once and used at every frequency.

use structure::SparseModel;

use crate::balance::Balance;
use crate::condensation::Structure;
use crate::error::PlanError;
use crate::harmonics::Harmonics;
use crate::matrices::Matrices;
use crate::newton::Criteria;
use crate::plan_check::{check, check_size};
use crate::problem::{Contact, Joint, Problem};
use crate::rows::Rows;
use crate::settings::{Settings, Start};
use crate::sparse::SparseMatrices;
use crate::transform::Transform;

/// One rung of the ladder in N.
#[derive(Debug)]
pub(crate) struct Rung {
    /// Highest harmonic as a multiple of the base frequency.
    pub(crate) order: usize,
    /// Unknown harmonics of this rung: the first `slots` of the plan's.
    pub(crate) slots: usize,
    pub(crate) transform: Transform,
}

/// A problem made ready: transforms, condensation, buffers' sizes, start strategy.
#[derive(Debug)]
pub struct Plan {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) joints: Vec<Joint>,
    /// Directions of all joints together.
    pub(crate) joint_rows: usize,
    pub(crate) harmonics: Harmonics,
    pub(crate) structure: Structure,
    /// Ascending; beyond the one of N there may be another for estimates.
    pub(crate) rungs: Vec<Rung>,
    /// The rung of N.
    pub(crate) top: usize,
    pub(crate) settings: Settings,
    pub(crate) linear: bool,
    /// Piecewise linear laws are evaluated by their events.
    pub(crate) exact: bool,
    pub(crate) scalar: bool,
    pub(crate) scalar_start: bool,
    pub(crate) condensed_dofs: usize,
}

/// From so many harmonics on the velocity is looked at more coarsely: high harmonics hardly move its zeros.
const LONG: usize = 63;

impl Plan {
    /// Plans `problem`.
    ///
    /// # Errors
    /// [`PlanError`] naming what cannot be: an excitation harmonic above N, a dof that does not exist, a contact of a
    /// dof with itself.
    pub fn new(problem: &Problem, settings: &Settings) -> Result<Self, PlanError> {
        let model = &problem.model;
        check(problem, model.dofs(), model.base_loads().len(), settings)?;
        check_size(problem, model.dofs(), settings)?;
        let matrices = Matrices::Dense {
            mass: model.mass().clone(),
            damping: model.damping().clone(),
            stiffness: model.stiffness().clone(),
        };
        Ok(Self::make(problem, matrices, model.base_loads(), settings))
    }

    /// Plans a problem whose structure is not reduced: at every frequency the sparse dynamic stiffness of every harmonic
    /// is factored. A reduced model is faster by far at more than a few frequencies.
    ///
    /// # Errors
    /// As [`Plan::new`]; also modal damping, which needs modes, and matrices whose factors do not fit into memory.
    pub fn direct(problem: &Problem<SparseModel>, settings: &Settings) -> Result<Self, PlanError> {
        let mut inertia = vec![0.0; problem.model.mass.nrows()];
        for entry in problem.model.mass.triplet_iter() {
            if let Some(sum) = inertia.get_mut(entry.row) {
                *sum += *entry.val;
            }
        }
        Self::direct_with_base(problem, &[inertia], settings)
    }

    /// Likewise with other base motions than that of all dofs alike: for each M r in kg on all dofs, as in
    /// [`Model::with_base_loads`](structure::Model::with_base_loads).
    ///
    /// # Errors
    /// As [`Plan::direct`]; also base loads that have not one finite number a dof.
    pub fn direct_with_base(
        problem: &Problem<SparseModel>,
        base_loads: &[Vec<f64>],
        settings: &Settings,
    ) -> Result<Self, PlanError> {
        let model = &problem.model;
        let dofs = model.mass.nrows();
        check(problem, dofs, base_loads.len(), settings)?;
        if base_loads.iter().any(|load| load.len() != dofs || load.iter().any(|x| !x.is_finite())) {
            let problem = format!("base loads must have {dofs} finite numbers");
            return Err(PlanError { place: "model.mass".into(), problem });
        }
        // Sparse matrices take what they have entries for.
        check_size(problem, 0, settings)?;
        let rows = Rows::new(&problem.contacts, &problem.joints);
        let matrices = Matrices::Sparse(SparseMatrices::new(model, &rows)?);
        Ok(Self::make(problem, matrices, base_loads, settings))
    }

    /// The plan of a problem that was checked.
    fn make<M>(
        problem: &Problem<M>,
        matrices: Matrices,
        base_loads: &[Vec<f64>],
        settings: &Settings,
    ) -> Self {
        let (contacts, joints) = (problem.contacts.clone(), problem.joints.clone());
        let nature = |c: &Contact| c.law.nature();
        // A contact pressure depends on the mean, as a spring's force does.
        let mean_is_free = joints.is_empty() && contacts.iter().all(|c| !nature(c).determines_mean);
        let estimating = settings.estimate || settings.truncation.is_some();
        let harmonics = Harmonics::new(problem, settings.harmonics, estimating, mean_is_free);
        let linear = joints.is_empty() && contacts.iter().all(|c| nature(c).linear);
        let static_load = problem.excitation.iter().any(|e| e.harmonic == 0 && e.amplitude != 0.0);
        let scalar_start = match contacts.as_slice() {
            [only] if joints.is_empty() => {
                only.law.describing_function().is_some()
                    && (!nature(only).determines_mean || !static_load)
                    && harmonics.reduced.contains(&1)
                    && harmonics.highest_excited == 1
            }
            _ => false,
        } && !linear;
        let scalar = scalar_start && harmonics.asked == 1 && settings.start == Start::Ladder;
        // Asking for a number of samples asks for samples.
        let exact = settings.samples.is_none();
        // Only to see between which samples the velocity changes sign, and to multiply two spectra.
        let by_events = |n: usize| (if n < LONG { 8 } else { 4 }) * (n + 1);
        let needed = |c: &Contact, n: usize| match c.law.piecewise_linear().filter(|_| exact) {
            Some(_) => by_events(n),
            None => c.law.samples(n),
        };
        let has_samples = sampled(&contacts, &joints, exact);
        let on_the_way = |n: usize| settings.truncation.is_none() && n < harmonics.asked;
        let rung = |n: usize, least: usize| {
            let by_joints = joints.iter().map(|joint| match joint.law.piecewise_linear().filter(|_| exact) {
                Some(_) => by_events(n),
                None => joint.law.samples(n),
            });
            let asked = contacts.iter().map(|c| needed(c, n)).chain(by_joints).max().unwrap_or(0);
            // A rung on the way is left before its sampling error counts.
            let asked = if on_the_way(n) && has_samples { asked / 4 } else { asked };
            let samples = settings.samples.unwrap_or(asked).max(4 * (n + 1)).max(least).next_power_of_two();
            Rung { order: n, slots: harmonics.up_to(n), transform: Transform::new(samples) }
        };
        let mut rungs: Vec<Rung> = ladder(&harmonics).into_iter().map(|n| rung(n, 0)).collect();
        let top = rungs.len() - 1;
        if estimating && harmonics.highest() > harmonics.asked {
            // Twice the samples as well: what an estimate compares with must err less in every respect.
            let least = rungs.last().map_or(0, |rung| 2 * rung.transform.samples());
            rungs.push(rung(harmonics.highest(), if has_samples { least } else { 0 }));
        }
        let carrying: std::collections::BTreeSet<usize> = Rows::new(&contacts, &joints).dofs().collect();
        Self {
            condensed_dofs: matrices.dofs() - carrying.len(),
            structure: Structure::new(problem, matrices, base_loads, &harmonics),
            harmonics,
            rungs,
            top,
            settings: settings.clone(),
            linear,
            exact,
            scalar,
            scalar_start,
            joint_rows: joints.iter().map(|joint| joint.directions.len()).sum(),
            contacts,
            joints,
        }
    }

    /// Harmonics of Ω that are not identically zero, ascending; columns of every spectrum in a
    /// [`crate::Solution`].
    pub fn orders(&self) -> &[usize] {
        self.harmonics.orders.get(..self.slots()).unwrap_or_default()
    }

    /// Number of rows: contacts, then the directions of all joints.
    pub(crate) fn rows(&self) -> usize {
        self.contacts.len() + self.joint_rows
    }

    /// What acts in the rows.
    pub(crate) fn laws(&self) -> (&[Contact], &[Joint]) {
        (&self.contacts, &self.joints)
    }

    /// Number of harmonics that a solution may have.
    pub(crate) fn slots(&self) -> usize {
        self.rungs.get(self.top).map_or(0, |rung| rung.slots)
    }

    /// N of a solution of rung `rung`, in harmonics of Ω.
    pub(crate) fn harmonics_of(&self, rung: usize) -> usize {
        if rung == self.top {
            return self.settings.harmonics;
        }
        self.rungs.get(rung).map_or(0, |rung| rung.order * self.harmonics.fundamental)
    }

    /// Whether some contact force is evaluated at samples.
    pub(crate) fn has_samples(&self) -> bool {
        sampled(&self.contacts, &self.joints, self.exact)
    }

    /// The slot of the base frequency itself.
    pub(crate) fn first_slot(&self) -> Option<usize> {
        self.harmonics.reduced.iter().position(|&k| k == 1)
    }

    pub(crate) fn balance(&self, rung: usize) -> Balance<'_> {
        Balance {
            contacts: &self.contacts,
            joints: &self.joints,
            joint_rows: self.joint_rows,
            orders: &self.harmonics.reduced,
            odd: self.harmonics.odd,
            transform: &self.rungs[rung].transform,
            exact: self.exact,
        }
    }

    pub(crate) fn criteria(&self) -> Criteria {
        Criteria {
            tolerance: self.settings.tolerance,
            max_iterations: self.settings.max_iterations,
            jacobian: self.settings.jacobian,
            polish: true,
        }
    }
}

/// Whether some contact force is evaluated at samples.
fn sampled(contacts: &[Contact], joints: &[Joint], exact: bool) -> bool {
    joints.iter().any(|joint| !exact || joint.law.piecewise_linear().is_none())
        || contacts.iter().any(|c| !exact || c.law.piecewise_linear().is_none())
}

/// Rungs in multiples of the base frequency: 1, 3, 7, 15, … below the highest, from the highest excited one on.
fn ladder(harmonics: &Harmonics) -> Vec<usize> {
    let highest = harmonics.asked;
    let lowest = harmonics.highest_excited.max(1);
    let below = (1..usize::BITS).map(|b| (1_usize << b) - 1).take_while(|n| *n < highest);
    below.filter(|n| *n >= lowest).chain([highest]).collect()
}
