//! What a problem needs, made once and used at every frequency.

use contact::TurningPoints;
use faer::{Mat, c64};
use structure::SparseModel;

use crate::balance::{Balance, BalanceBuffers};
use crate::condensation::{Condensed, Structure};
use crate::dense::Lu;
use crate::error::PlanError;
use crate::harmonics::Harmonics;
use crate::matrices::Matrices;
use crate::newton::{Criteria, NewtonBuffers};
use crate::point::Point;
use crate::problem::{Contact, ExcitationKind, Joint, Problem};
use crate::rows::Rows;
use crate::scalar::Root;
use crate::settings::{Settings, Start};
use crate::solution::Stats;
use crate::sparse::SparseMatrices;
use crate::transform::Transform;

/// How the receptances at the contacts are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Receptances {
    /// From a factorisation of the dense dynamic stiffness, one a harmonic.
    Dense,
    /// As sums over the modes of the structure, which its damping does not couple; from factorisations near resonances that
    /// nothing damps.
    Modes,
    /// From a factorisation of the sparse dynamic stiffness, one a harmonic.
    Sparse,
}

/// What a plan uses and what it leaves out, for a reader.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFacts {
    /// Greatest common divisor of the excited harmonics: the period is that many times shorter.
    pub fundamental: usize,
    /// Only odd multiples of the fundamental are unknown: laws and excitation are odd.
    pub odd: bool,
    /// One contact, one harmonic, closed form: a real equation whose roots are all found; no transform, no samples.
    pub scalar: bool,
    /// One contact with a closed form for one harmonic: its solutions start the ladder, no guess is needed.
    pub scalar_start: bool,
    /// No contact law needs iteration.
    pub linear: bool,
    /// Samples a period; 0 where forces need none.
    pub samples: usize,
    /// Contacts whose force is evaluated by its events, without sampling error.
    pub event_exact: usize,
    /// Contacts in several directions: all harmonics and the mean are unknown.
    pub joints: usize,
    /// Of these, those whose forces are evaluated by their events; the forces of the others are sampled.
    pub joints_by_events: usize,
    /// A number of samples was asked for, which piecewise linear laws would not need.
    pub sampled_on_request: bool,
    /// Harmonics of Ω up to which each rung of the ladder goes, the last being N.
    pub ladder: Vec<usize>,
    /// Harmonics of Ω that Newton's method solves for at least; a slaved tail may follow. `None` where there is none.
    pub tail_after: Option<usize>,
    /// No contact can become stiffer than a known number, so it is known which harmonics can be slaved. With joints none are.
    pub bounded_stiffness: bool,
    /// Dofs that carry no contact and are condensed away.
    pub condensed_dofs: usize,
    /// How receptances are found.
    pub receptances: Receptances,
    /// Real unknowns of the iteration.
    pub unknowns: usize,
    /// Newton steps with all harmonics are solved for by GMRES, without factoring the whole derivative.
    pub krylov: bool,
}

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
    condensed_dofs: usize,
}

/// Buffers for one thread.
#[derive(Debug)]
pub struct Workspace {
    /// The rung whose balance is to be solved.
    pub(crate) goal: usize,
    /// Harmonics condensed so far at this frequency.
    pub(crate) ready: usize,
    pub(crate) condensed: Condensed,
    pub(crate) point: Point,
    /// One a rung.
    pub(crate) balance: Vec<BalanceBuffers>,
    pub(crate) newton: NewtonBuffers,
    /// û, entry `[slot][i]` over active rows.
    pub(crate) unknowns: Vec<c64>,
    /// A solution to fall back to.
    pub(crate) kept: Vec<c64>,
    /// The one before it on a way.
    pub(crate) before: Vec<c64>,
    /// Displacement harmonics in m of the previous point of a march, and whether there is one.
    pub(crate) previous: Vec<c64>,
    pub(crate) has_previous: bool,
    /// The solution while an estimate looks beyond it.
    pub(crate) solved: Vec<c64>,
    /// Output displacements of a solution, and of the one beyond it.
    pub(crate) outputs: (Vec<c64>, Vec<c64>),
    /// The residuals of a solution while an estimate iterates.
    pub(crate) history: Vec<f64>,
    /// Estimates for the solution at hand.
    pub(crate) truncation_error: Option<f64>,
    pub(crate) sampling_error: Option<f64>,
    pub(crate) roots: Vec<Root>,
    pub(crate) held: Vec<bool>,
    /// Holding forces in N, entry `[slot][row]`.
    pub(crate) holding: Vec<c64>,
    /// One harmonic's linear system over active rows.
    pub(crate) linear: Lu<c64>,
    pub(crate) linear_rhs: Mat<c64>,
    pub(crate) turning_points: TurningPoints,
    pub(crate) stats: Stats,
}

/// From so many harmonics on the velocity is looked at more coarsely: high harmonics hardly move its zeros.
const LONG: usize = 63;

/// The most harmonics a plan accepts.
const MOST_HARMONICS: usize = 4095;

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

    /// What the plan uses and what it leaves out.
    pub fn facts(&self) -> PlanFacts {
        let iterated = !self.scalar && !self.linear;
        let by_events = |c: &&Contact| iterated && self.exact && c.law.piecewise_linear().is_some();
        let event_exact = self.contacts.iter().filter(by_events).count();
        let joint_by_events = |joint: &&Joint| self.exact && joint.law.piecewise_linear().is_some();
        let joints_by_events = self.joints.iter().filter(joint_by_events).count();
        let sampled = iterated && (event_exact < self.contacts.len() || joints_by_events < self.joints.len());
        let bounded = self.joints.is_empty() && self.contacts.iter().all(|c| c.law.stiffest().is_some());
        let last = self.rungs.get(self.top);
        let unknowns = self.balance(self.top).size(self.rows(), self.slots());
        PlanFacts {
            fundamental: self.harmonics.fundamental,
            odd: self.harmonics.odd,
            scalar: self.scalar,
            scalar_start: self.scalar_start,
            linear: self.linear,
            samples: if sampled { last.map_or(0, |rung| rung.transform.samples()) } else { 0 },
            event_exact,
            joints: self.joints.len(),
            joints_by_events,
            sampled_on_request: !self.exact,
            ladder: self
                .rungs
                .iter()
                .take(self.top + 1)
                .filter_map(|rung| self.harmonics.orders.get(rung.slots.checked_sub(1)?).copied())
                .collect(),
            tail_after: self
                .rungs
                .iter()
                .find(|rung| rung.order >= self.least_core())
                .filter(|rung| iterated && bounded && self.settings.slaving && rung.slots < self.slots())
                .map(|rung| rung.order * self.harmonics.fundamental),
            bounded_stiffness: bounded,
            condensed_dofs: self.condensed_dofs,
            receptances: self.structure.receptances(),
            unknowns,
            krylov: iterated && self.settings.krylov(unknowns, self.rows()),
        }
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

    /// Buffers for one thread.
    pub fn workspace(&self) -> Workspace {
        let (rows, slots) = (self.rows(), self.harmonics.reduced.len());
        let entries = rows * slots;
        let buffers = (0..self.rungs.len()).map(|rung| self.balance(rung).buffers()).collect();
        Workspace {
            goal: self.top,
            ready: 0,
            condensed: self.structure.condensed(),
            point: Point::new(rows, slots),
            balance: buffers,
            newton: NewtonBuffers::new(entries),
            unknowns: vec![c64::ZERO; entries],
            kept: vec![c64::ZERO; entries],
            before: vec![c64::ZERO; entries],
            previous: vec![c64::ZERO; entries],
            has_previous: false,
            solved: vec![c64::ZERO; entries],
            outputs: (Vec::new(), Vec::new()),
            history: Vec::new(),
            truncation_error: None,
            sampling_error: None,
            roots: Vec::with_capacity(8),
            held: vec![false; self.contacts.len()],
            holding: vec![c64::ZERO; entries],
            linear: Lu::new(rows, 1),
            linear_rhs: Mat::zeros(rows, 1),
            turning_points: TurningPoints::default(),
            stats: Stats::default(),
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

/// The most bytes that a factorisation and the receptances of one thread may take.
const MOST_BYTES: f64 = 4e9;

/// Refuses what would not fit into memory before anything is allocated.
fn check_size<M>(problem: &Problem<M>, dofs: usize, settings: &Settings) -> Result<(), PlanError> {
    let directions: usize = problem.joints.iter().map(|joint| joint.directions.len()).sum();
    let count = problem.contacts.len() + directions;
    let (rows, dofs) = (count as f64, dofs as f64);
    // Sized as if no harmonic could be left out or slaved.
    let harmonics = settings.harmonics as f64;
    let unknowns = 2.0 * (harmonics + 1.0) * rows;
    let outputs = problem.output.len() as f64;
    let derivative = if settings.krylov(unknowns as usize, count) {
        // The preconditioner, one block a contact and up to three a row of a joint, and the basis.
        let blocks = (problem.contacts.len() + MOST_DIRECTIONS * directions) as f64;
        let orders = harmonics + 1.0;
        16.0 * orders * (rows * rows + 2.0 * orders * blocks) + 512.0 * unknowns
    } else {
        8.0 * unknowns * unknowns
    };
    let bytes = derivative + 16.0 * 2.0 * harmonics * rows * (rows + outputs) + 16.0 * dofs * (dofs + rows);
    if bytes > MOST_BYTES && unknowns > SAFE_UNKNOWNS {
        let problem = format!(
            "{} harmonics at {} contacts would take {:.0} GB of memory a thread; ask for fewer",
            settings.harmonics,
            problem.contacts.len() + problem.joints.len(),
            bytes / 1e9
        );
        return Err(PlanError { place: "harmonics".into(), problem });
    }
    Ok(())
}

/// Two tangential directions and the normal one.
const MOST_DIRECTIONS: usize = 3;

/// So many real unknowns always fit.
const SAFE_UNKNOWNS: f64 = 16_384.0;

fn check<M>(
    problem: &Problem<M>,
    n: usize,
    base_motions: usize,
    settings: &Settings,
) -> Result<(), PlanError> {
    let error = |place: String, problem: String| Err(PlanError { place, problem });
    let most = settings.harmonics;
    if most == 0 || most > MOST_HARMONICS {
        return error("harmonics".into(), format!("must be between 1 and {MOST_HARMONICS}, got {most}"));
    }
    for (i, excitation) in problem.excitation.iter().enumerate() {
        if excitation.harmonic > most {
            return error(
                format!("excitation[{i}].harmonic"),
                format!(
                    "is {}, above the {most} harmonics of the balance; raise \"harmonics\"",
                    excitation.harmonic
                ),
            );
        }
        if !excitation.amplitude.is_finite() || !excitation.phase.is_finite() {
            return error(format!("excitation[{i}]"), "amplitude and phase must be finite".into());
        }
        let (known, of_what) = match excitation.kind {
            ExcitationKind::Base => (base_motions, "base motions"),
            ExcitationKind::Force | ExcitationKind::Unbalance => (n, "dofs"),
        };
        if excitation.dof >= known {
            return error(format!("excitation[{i}].dof"), format!("the model has {known} {of_what}"));
        }
    }
    for (i, contact) in problem.contacts.iter().enumerate() {
        if contact.first >= n || contact.second.is_some_and(|second| second >= n) {
            return error(format!("contacts[{i}].between"), format!("the model has {n} dofs"));
        }
        if contact.second == Some(contact.first) {
            return error(format!("contacts[{i}].between"), "must name two different dofs".into());
        }
        if !(contact.scale.is_finite() && contact.scale > 0.0) {
            return error(format!("contacts[{i}].scale"), format!("must be positive, got {}", contact.scale));
        }
    }
    for (i, joint) in problem.joints.iter().enumerate() {
        check_joint(&format!("joints[{i}]"), joint, n)?;
    }
    match problem.output.iter().find(|dof| **dof >= n) {
        Some(dof) => error("output".into(), format!("dof {dof} does not exist; the model has {n}")),
        None => Ok(()),
    }
}

fn check_joint(place: &str, joint: &Joint, n: usize) -> Result<(), PlanError> {
    let error = |of: &str, problem: String| Err(PlanError { place: format!("{place}{of}"), problem });
    let wanted = joint.law.directions();
    if joint.directions.len() != wanted || !(1..=MOST_DIRECTIONS).contains(&wanted) {
        let given = joint.directions.len();
        return error(".directions", format!("the law has {wanted} directions, got {given}"));
    }
    for (d, direction) in joint.directions.iter().enumerate() {
        let place = format!(".directions[{d}]");
        let parts = &direction.parts;
        if let Some((dof, _)) = parts.iter().find(|(dof, _)| *dof >= n) {
            return error(&place, format!("dof {dof} does not exist; the model has {n} dofs"));
        }
        if parts.iter().any(|(_, coefficient)| !coefficient.is_finite()) {
            return error(&place, "coefficients must be finite".into());
        }
        if parts.iter().all(|(_, coefficient)| *coefficient == 0.0) {
            return error(&place, "moves with no dof".into());
        }
        let twice = |(i, part): (usize, &(usize, f64))| parts.iter().take(i).any(|before| before.0 == part.0);
        if let Some((_, (dof, _))) = parts.iter().enumerate().find(|part| twice(*part)) {
            return error(&place, format!("names dof {dof} twice"));
        }
        let (length, stiffness) = (joint.law.length(d), joint.law.stiffness(d));
        if !(length >= 0.0 && length.is_finite() && stiffness >= 0.0 && stiffness.is_finite()) {
            let problem = format!("its law has a length of {length} m and a stiffness of {stiffness} N/m");
            return error(&place, problem);
        }
    }
    if !(joint.scale.is_finite() && joint.scale > 0.0) {
        return error(".scale", format!("must be positive, got {}", joint.scale));
    }
    Ok(())
}
