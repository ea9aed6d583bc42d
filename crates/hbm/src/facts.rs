//! What a plan uses and what it leaves out, for a reader.

use crate::plan::Plan;
use crate::problem::{Contact, Joint};

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

impl Plan {
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
}
