//! What a curve runs along: the frequency, or an entry of the problem.

use faer::c64;

use crate::balance::Homotopy;
use crate::error::PlanError;
use crate::plan::{Plan, Workspace};
use crate::problem::Problem;
use crate::settings::{Settings, Start};
use crate::solution::Solution;

/// A family of balances in one parameter.
pub trait Course {
    /// The plan at the parameter placed last.
    fn plan(&self) -> &Plan;

    /// The frequency in Hz at `parameter`.
    fn frequency(&self, parameter: f64) -> f64;

    /// Solves at `parameter` without a curve; `None` when the problem cannot be posed there.
    fn start(&mut self, parameter: f64, workspace: &mut Workspace) -> Option<Solution>;

    /// Makes the workspace ready for evaluations at `parameter`; whether that is possible.
    fn place(&mut self, parameter: f64, workspace: &mut Workspace) -> bool;

    /// ∂r/∂λ of the weighted residual at the evaluation made last, into `slope`; leaves that evaluation in place.
    fn slope(&mut self, parameter: f64, workspace: &mut Workspace, slope: &mut [c64]) -> bool;

    /// The longest step that cannot jump over anything known at `parameter`.
    fn reach(&self, parameter: f64) -> f64;
}

/// Relative step of the central difference in an entry, and in the frequency of rate-dependent laws.
const DIFFERENCE: f64 = 1e-5;

impl Plan {
    /// Makes the workspace ready for evaluations at `hertz`, in the units of the point solved last.
    fn place(&self, hertz: f64, ws: &mut Workspace) -> bool {
        let slots = self.slots();
        if hertz.is_nan()
            || hertz < 0.0
            || self.structure.condense_alone(hertz, 0..slots, &mut ws.condensed).is_err()
        {
            return false;
        }
        ws.goal = self.top;
        ws.ready = slots;
        ws.point.set_again(&ws.condensed, slots);
        true
    }

    /// ∂r/∂(frequency in Hz) at the evaluation made last.
    fn frequency_slope(&self, hertz: f64, ws: &mut Workspace, slope: &mut [c64]) -> bool {
        let width = ws.point.width();
        let goal = ws.goal;
        let felt: Vec<c64> = (0..slope.len())
            .map(|entry| {
                let force = ws.balance[goal].forces[entry];
                ws.point.felt(entry, force, ws.unknowns[entry]) * ws.point.force[entry % width]
            })
            .collect();
        self.structure.frequency_slope(hertz, &felt, &mut ws.condensed, slope);
        for (entry, slope) in slope.iter_mut().enumerate() {
            *slope *= -std::f64::consts::TAU * ws.point.weight[entry] / ws.point.length[entry % width];
        }
        !self.rate_dependent() || self.add_rate_slope(hertz, ws, slope)
    }

    fn rate_dependent(&self) -> bool {
        self.contacts.iter().any(|contact| contact.law.nature().rate_dependent)
    }

    /// Adds what the frequency changes in forces that depend on the velocity, by central differences.
    fn add_rate_slope(&self, hertz: f64, ws: &mut Workspace, slope: &mut [c64]) -> bool {
        let omega = ws.point.omega;
        let mut sides = [Vec::new(), Vec::new()];
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            ws.point.omega = omega * (1.0 + sign * DIFFERENCE);
            if !self.evaluate_again(ws) {
                return false;
            }
            side.extend_from_slice(&ws.balance[ws.goal].residual[..slope.len()]);
        }
        ws.point.omega = omega;
        for ((slope, above), below) in slope.iter_mut().zip(&sides[0]).zip(&sides[1]) {
            *slope += (above - below) / (2.0 * DIFFERENCE * hertz);
        }
        self.evaluate_again(ws)
    }

    fn evaluate_again(&self, ws: &mut Workspace) -> bool {
        let goal = ws.goal;
        let Workspace { point, unknowns, balance, .. } = ws;
        self.balance(goal).evaluate(point, self.slots(), Homotopy::NONE, unknowns, &mut balance[goal]).is_ok()
    }
}

/// Continuation in the frequency.
#[derive(Debug)]
pub struct FrequencyCourse {
    plan: Plan,
    /// Frequencies in Hz at which the linear structure is resonant, and half-power bandwidths.
    resonances: Vec<(f64, f64)>,
}

impl FrequencyCourse {
    /// The course of `problem`, with N harmonics solved by Newton's method throughout.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn new(problem: &Problem, settings: &Settings) -> Result<Self, PlanError> {
        let plan = Plan::new(problem, &whole(settings))?;
        Ok(Self { resonances: resonances(problem, plan.orders()), plan })
    }
}

/// The settings of a curve: the same harmonics at every point, all by Newton's method, no estimates.
fn whole(settings: &Settings) -> Settings {
    Settings {
        truncation: None,
        estimate: false,
        slaving: false,
        start: Start::Ladder,
        all_solutions: false,
        ..settings.clone()
    }
}

/// Where kΩ meets a natural frequency of the structure without contacts or with its contacts stuck, for the excited and
/// the first harmonics, with a width that a curve must not jump over.
fn resonances(problem: &Problem, orders: &[usize]) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (hertz, width) in problem.model.modes_with(&stuck_springs(problem, false)) {
        found.push((hertz, width));
    }
    for (hertz, width) in problem.model.modes_with(&stuck_springs(problem, true)) {
        found.push((hertz, width));
    }
    let excited = problem.excitation.iter().filter(|e| e.amplitude != 0.0 && e.harmonic > 0);
    let mut harmonics: Vec<usize> = excited.map(|e| e.harmonic).collect();
    harmonics.extend(orders.iter().copied().filter(|&k| k > 0 && k <= 3));
    harmonics.sort_unstable();
    harmonics.dedup();
    let at = |&(hertz, width): &(f64, f64), k: usize| (hertz / k as f64, width / k as f64);
    harmonics.iter().flat_map(|&k| found.iter().map(move |mode| at(mode, k))).collect()
}

/// Springs in place of the contacts: (first, second, N/m).
fn stuck_springs(problem: &Problem, stuck: bool) -> Vec<(usize, Option<usize>, f64)> {
    let stiffness = |contact: &crate::Contact| match (stuck, contact.law.stiffest()) {
        (false, _) => 0.0,
        (true, Some(stiffest)) => stiffest * contact.scale,
        (true, None) => contact.law.length().map_or(0.0, |a| contact.law.secant_stiffness(a)) * contact.scale,
    };
    problem.contacts.iter().map(|c| (c.first, c.second, stiffness(c))).collect()
}

impl Course for FrequencyCourse {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn frequency(&self, parameter: f64) -> f64 {
        parameter
    }

    fn start(&mut self, parameter: f64, ws: &mut Workspace) -> Option<Solution> {
        Some(self.plan.solve(parameter, ws))
    }

    fn place(&mut self, parameter: f64, ws: &mut Workspace) -> bool {
        self.plan.place(parameter, ws)
    }

    /// With w_k the motion of all dofs, `∂(u⁰ − G F)/∂Ω = Bᵀ H⁻¹ (∂f/∂Ω − ∂H/∂Ω w)`.
    fn slope(&mut self, parameter: f64, ws: &mut Workspace, slope: &mut [c64]) -> bool {
        self.plan.frequency_slope(parameter, ws, slope)
    }

    fn reach(&self, parameter: f64) -> f64 {
        let clear = |&(hertz, width): &(f64, f64)| (0.3 * (parameter - hertz).abs()).max(0.3 * width);
        self.resonances.iter().map(clear).fold(f64::INFINITY, f64::min).max(1e-7 * parameter)
    }
}

/// Continuation in an entry of the problem at one frequency.
pub struct EntryCourse<'p> {
    plan: Plan,
    frequency: f64,
    settings: Settings,
    problem: &'p dyn Fn(f64) -> Option<Problem>,
}

impl<'p> EntryCourse<'p> {
    /// The course of `problem(λ)` at `frequency` in Hz; `from` is where it begins.
    ///
    /// # Errors
    /// As [`Plan::new`]; `None` where there is no problem at `from`.
    pub fn new(
        problem: &'p dyn Fn(f64) -> Option<Problem>,
        frequency: f64,
        from: f64,
        settings: &Settings,
    ) -> Option<Result<Self, PlanError>> {
        let settings = whole(settings);
        let first = problem(from)?;
        Some(Plan::new(&first, &settings).map(|plan| Self { plan, frequency, settings, problem }))
    }

    /// The residual at `parameter` of the unknowns in the workspace.
    fn residual_at(&mut self, parameter: f64, ws: &mut Workspace, into: &mut [c64]) -> bool {
        if !self.place(parameter, ws) {
            return false;
        }
        let evaluated = self.plan.evaluate_again(ws);
        into.copy_from_slice(&ws.balance[ws.goal].residual[..into.len()]);
        evaluated
    }
}

impl Course for EntryCourse<'_> {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn frequency(&self, _parameter: f64) -> f64 {
        self.frequency
    }

    fn start(&mut self, _parameter: f64, ws: &mut Workspace) -> Option<Solution> {
        Some(self.plan.solve(self.frequency, ws))
    }

    fn place(&mut self, parameter: f64, ws: &mut Workspace) -> bool {
        let Some(problem) = (self.problem)(parameter) else { return false };
        let Ok(plan) = Plan::new(&problem, &self.settings) else { return false };
        if plan.orders() != self.plan.orders() {
            return false;
        }
        self.plan = plan;
        self.plan.place(self.frequency, ws)
    }

    fn slope(&mut self, parameter: f64, ws: &mut Workspace, slope: &mut [c64]) -> bool {
        let h = DIFFERENCE * if parameter == 0.0 { 1.0 } else { parameter.abs() };
        let mut below = vec![c64::ZERO; slope.len()];
        let mut here = vec![c64::ZERO; slope.len()];
        let found =
            self.residual_at(parameter + h, ws, slope) && self.residual_at(parameter - h, ws, &mut below);
        // Back to the evaluation that the caller made.
        let back = self.residual_at(parameter, ws, &mut here);
        for (above, below) in slope.iter_mut().zip(&below) {
            *above = (*above - below) / (2.0 * h);
        }
        found && back
    }

    fn reach(&self, _parameter: f64) -> f64 {
        f64::INFINITY
    }
}
