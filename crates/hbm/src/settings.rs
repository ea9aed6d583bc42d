//! How a problem is to be solved.

/// How the iteration at a frequency gets its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// From the point itself: all solutions of the first harmonic, then a ladder N = 1 → 3 → … Points do not depend
    /// on their neighbours.
    #[default]
    Ladder,
    /// From the previous frequency's solution, the paper's strategy (its Fig. 2). Sequential.
    March,
}

/// Where the derivative of the contact forces comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Jacobian {
    /// In closed form.
    #[default]
    Analytic,
    /// By forward differences, for comparison.
    Difference,
}

/// How the linear system of a Newton step is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinearSolver {
    /// Whichever is faster for the number of unknowns.
    #[default]
    Auto,
    /// The whole derivative is factored.
    Dense,
    /// GMRES, preconditioned harmonic by harmonic; the whole derivative is factored where it does not converge.
    Krylov,
}

/// Real unknowns from which GMRES is faster than factoring the whole derivative.
const KRYLOV_FROM: usize = 200;

/// Contacts from which it is tried: fewer are coupled more through their harmonics than through the structure.
const KRYLOV_WIDTH: usize = 8;

/// How a problem is to be solved; the defaults are what a user wants without asking.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// N: highest harmonic of the excitation's fundamental frequency.
    pub harmonics: usize,
    /// Relative l2 error of the displacement spectrum at which a point needs no more harmonics; `harmonics` is then the
    /// most it may take. `None`: every point has N harmonics.
    pub truncation: Option<f64>,
    /// Estimate the truncation error of every point.
    pub estimate: bool,
    /// Find high harmonics that the structure barely answers by substitution instead of Newton's method.
    pub slaving: bool,
    /// Samples a period for the contact forces, raised to a power of two; `None` chooses.
    pub samples: Option<usize>,
    /// How an iteration starts.
    pub start: Start,
    /// Where derivatives come from.
    pub jacobian: Jacobian,
    /// How the linear system of a Newton step is solved.
    pub linear_solver: LinearSolver,
    /// Also return the solutions that are not reported first, where they are known.
    pub all_solutions: bool,
    /// Find the Floquet multipliers of every solution, where its laws allow Hill's method.
    pub stability: bool,
    /// Residual, relative to the excitation, at which an iteration has converged.
    pub tolerance: f64,
    /// Newton steps allowed in one attempt.
    pub max_iterations: usize,
}

impl Settings {
    /// The defaults for N harmonics.
    pub fn new(harmonics: usize) -> Self {
        Self {
            harmonics,
            truncation: None,
            estimate: false,
            slaving: true,
            samples: None,
            start: Start::default(),
            jacobian: Jacobian::default(),
            linear_solver: LinearSolver::default(),
            all_solutions: false,
            stability: false,
            tolerance: 1e-11,
            max_iterations: 60,
        }
    }

    /// Whether a Newton step with so many real unknowns of so many contacts is solved for by GMRES.
    pub(crate) fn krylov(&self, unknowns: usize, contacts: usize) -> bool {
        self.jacobian == Jacobian::Analytic
            && match self.linear_solver {
                LinearSolver::Auto => many(unknowns, contacts),
                LinearSolver::Dense => false,
                LinearSolver::Krylov => true,
            }
    }
}

/// Whether so many real unknowns of so many contacts are many: what they do to each other counts for more than what each does.
pub(crate) fn many(unknowns: usize, contacts: usize) -> bool {
    unknowns >= KRYLOV_FROM && contacts >= KRYLOV_WIDTH
}
