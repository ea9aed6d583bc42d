//! What a problem needs, made once and used at every frequency.

use num_complex::Complex64;

use crate::error::PlanError;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::solution::{Solution, Waveform};

/// What a plan uses and what it leaves out, for a reader.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFacts {
    /// Greatest common divisor of the excited harmonics: the period is that many times shorter.
    pub fundamental: usize,
    /// Only odd multiples of the fundamental are unknown: laws and excitation are odd.
    pub odd: bool,
    /// One contact, one harmonic, closed form: a real equation whose roots are all found; no transform, no samples.
    pub scalar: bool,
    /// No contact law needs iteration.
    pub linear: bool,
    /// Samples a period; 0 where forces come in closed form.
    pub samples: usize,
    /// Harmonics 1 → 3 → … climbed to N.
    pub ladder: Vec<usize>,
    /// Dofs that carry no contact and are condensed away.
    pub condensed_dofs: usize,
    /// Real unknowns of the iteration.
    pub unknowns: usize,
}

/// A problem made ready: transforms, condensation, buffers' sizes, start strategy.
#[derive(Debug)]
pub struct Plan {
    _private: (),
}

/// Buffers for one thread.
#[derive(Debug)]
pub struct Workspace {
    _private: (),
}

impl Plan {
    /// Plans `problem`.
    ///
    /// # Errors
    /// [`PlanError`] naming what cannot be.
    pub fn new(problem: &Problem, settings: &Settings) -> Result<Self, PlanError> {
        let _ = (problem, settings);
        Ok(Self { _private: () })
    }

    /// Harmonics of Ω that are not identically zero, ascending; columns of every spectrum in a [`Solution`].
    pub fn orders(&self) -> &[usize] {
        &[]
    }

    /// What the plan uses and what it leaves out.
    pub fn facts(&self) -> PlanFacts {
        PlanFacts {
            fundamental: 1,
            odd: false,
            scalar: false,
            linear: false,
            samples: 0,
            ladder: Vec::new(),
            condensed_dofs: 0,
            unknowns: 0,
        }
    }

    /// Buffers for one thread.
    pub fn workspace(&self) -> Workspace {
        Workspace { _private: () }
    }

    /// The response at `frequency` in Hz, independent of any other point.
    pub fn solve(&self, frequency: f64, workspace: &mut Workspace) -> Solution {
        let _ = (frequency, workspace);
        unreachable!()
    }

    /// The response without contact forces: one row per output dof, one column per order. `None` where the
    /// structure is singular.
    pub fn linear_response(&self, frequency: f64, workspace: &mut Workspace) -> Option<Vec<Vec<Complex64>>> {
        let _ = (frequency, workspace);
        None
    }

    /// One period of `solution` at `samples` equidistant instants; `None` when the point failed.
    pub fn waveform(&self, solution: &Solution, samples: usize) -> Option<Waveform> {
        let _ = (solution, samples);
        None
    }
}
