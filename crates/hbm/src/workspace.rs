//! Buffers in which one thread solves points.

use contact::TurningPoints;
use faer::{Mat, c64};

use crate::balance::BalanceBuffers;
use crate::condensation::Condensed;
use crate::dense::Lu;
use crate::newton::NewtonBuffers;
use crate::plan::Plan;
use crate::point::Point;
use crate::scalar::Root;
use crate::solution::Stats;

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

impl Plan {
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
