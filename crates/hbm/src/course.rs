//! What a curve runs along: the frequency, or an entry of the problem.

use faer::c64;

use crate::balance::Homotopy;
use crate::error::PlanError;
use crate::plan::Plan;
use crate::problem::{Joint, Problem};
use crate::rows::Rows;
use crate::settings::{Settings, Start};
use crate::workspace::Workspace;

/// A family of balances in one parameter.
pub(crate) trait Course {
    /// The plan at the parameter placed last.
    fn plan(&self) -> &Plan;

    /// The frequency in Hz at `parameter`.
    fn frequency(&self, parameter: f64) -> f64;

    /// How the balance is changed at `parameter`.
    fn homotopy(&self, _parameter: f64) -> Homotopy {
        Homotopy::NONE
    }

    /// Makes the workspace ready for evaluations at `parameter`; whether that is possible.
    fn place(&mut self, parameter: f64, workspace: &mut Workspace) -> bool;

    /// ∂r/∂λ of the weighted residual at the evaluation made last, into `slope`; leaves that evaluation in place.
    fn slope(&mut self, parameter: f64, workspace: &mut Workspace, slope: &mut [c64]) -> bool;

    /// The longest step that cannot jump over anything known at `parameter`.
    fn reach(&self, parameter: f64) -> f64;
}

/// Relative step of the central difference in an entry, and in the frequency of rate-dependent laws.
const DIFFERENCE: f64 = 1e-7;

impl Plan {
    /// Makes the workspace ready for evaluations at `hertz`, in units of its own, all contacts moving.
    pub(crate) fn begin(&self, hertz: f64, ws: &mut Workspace) -> bool {
        let slots = self.slots();
        if self.structure.condense_alone(hertz, 0..slots, &mut ws.condensed).is_err() {
            return false;
        }
        (ws.goal, ws.ready) = (self.top, slots);
        ws.held.fill(false);
        ws.point.set(&ws.condensed, self.laws(), slots, &ws.held);
        true
    }

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
        let step = DIFFERENCE * if hertz > 0.0 { hertz } else { 1.0 };
        let turn = std::f64::consts::TAU * self.harmonics.fundamental as f64 * step;
        let mut sides = [Vec::new(), Vec::new()];
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            ws.point.omega = omega + sign * turn;
            if !self.evaluate_again(ws) {
                return false;
            }
            side.extend_from_slice(&ws.balance[ws.goal].residual[..slope.len()]);
        }
        ws.point.omega = omega;
        for ((slope, above), below) in slope.iter_mut().zip(&sides[0]).zip(&sides[1]) {
            *slope += (above - below) / (2.0 * step);
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
pub(crate) struct FrequencyCourse {
    pub(crate) plan: Plan,
    /// Frequencies in Hz at which the linear structure is resonant, and half-power bandwidths.
    resonances: Vec<(f64, f64)>,
}

impl FrequencyCourse {
    /// The course of `problem`, with N harmonics solved by Newton's method throughout.
    pub(crate) fn new(problem: &Problem, settings: &Settings) -> Result<Self, PlanError> {
        let plan = Plan::new(problem, &whole(settings))?;
        Ok(Self { resonances: resonances(problem, plan.orders()), plan })
    }

    /// The same for a short way near a point that is known: no resonance is looked for.
    pub(crate) fn nearby(problem: &Problem, settings: &Settings) -> Result<Self, PlanError> {
        Ok(Self { resonances: Vec::new(), plan: Plan::new(problem, &whole(settings))? })
    }

    /// Frequencies in Hz at which the linear structure is resonant, with contacts sticking or without any.
    pub(crate) fn resonant(&self) -> impl Iterator<Item = f64> {
        self.resonances.iter().map(|(hertz, _)| *hertz)
    }
}

/// The settings of a curve: the same harmonics at every point, all by Newton's method, no estimates.
pub(crate) fn whole(settings: &Settings) -> Settings {
    Settings {
        truncation: None,
        estimate: false,
        slaving: false,
        start: Start::Ladder,
        all_solutions: false,
        ..settings.clone()
    }
}

/// So many times the stiffness of a sliding contact is that of one at rest: its modes are then known to about 1e-6.
const RIGID: f64 = 1e6;

/// Where kΩ meets a natural frequency of the structure without contacts or with its contacts stuck, for the excited and
/// the first harmonics, with a width that a curve must not jump over.
fn resonances(problem: &Problem, orders: &[usize]) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (hertz, width) in problem.model.modes_with(&stuck_springs(problem, false)) {
        found.push((hertz, width));
    }
    let stuck = stuck_springs(problem, true);
    for (hertz, width) in problem.model.modes_with(&stuck) {
        found.push((hertz, width));
    }
    // Held at rest by a set-valued law: as good as rigid.
    if problem.contacts.iter().any(|contact| contact.law.holding_force() > 0.0) {
        let holds = |row: usize| problem.contacts.get(row).is_some_and(|c| c.law.holding_force() > 0.0);
        let rigid = |(row, (parts, stiffness)): (usize, (Vec<(usize, f64)>, f64))| {
            (parts, if holds(row) { RIGID * stiffness } else { stiffness })
        };
        let rigid: Vec<_> = stuck.into_iter().enumerate().map(rigid).collect();
        found.extend(problem.model.modes_with(&rigid));
    }
    let excited = problem.excitation.iter().filter(|e| e.amplitude != 0.0 && e.harmonic > 0);
    let mut harmonics: Vec<usize> = excited.map(|e| e.harmonic).collect();
    harmonics.extend(orders.iter().copied().filter(|&k| k > 0 && k <= 3));
    harmonics.sort_unstable();
    harmonics.dedup();
    let at = |&(hertz, width): &(f64, f64), k: usize| (hertz / k as f64, width / k as f64);
    harmonics.iter().flat_map(|&k| found.iter().map(move |mode| at(mode, k))).collect()
}

/// Springs in place of contacts and joints: the parts of every row, N/m.
pub(crate) fn stuck_springs(problem: &Problem, stuck: bool) -> Vec<(Vec<(usize, f64)>, f64)> {
    let stiffness = |contact: &crate::Contact| match (stuck, contact.law.stiffest()) {
        (false, _) => 0.0,
        (true, Some(stiffest)) => stiffest * contact.scale,
        (true, None) => contact.law.length().map_or(0.0, |a| contact.law.secant_stiffness(a)) * contact.scale,
    };
    let of_joint = |joint: &Joint, direction: usize| {
        if stuck { joint.law.stiffness(direction) * joint.scale } else { 0.0 }
    };
    let joints = problem.joints.iter().flat_map(|j| (0..j.directions.len()).map(move |d| of_joint(j, d)));
    let rows = Rows::new(&problem.contacts, &problem.joints);
    let parts = rows.iter().map(<[_]>::to_vec);
    parts.zip(problem.contacts.iter().map(stiffness).chain(joints)).collect()
}

impl Course for FrequencyCourse {
    fn plan(&self) -> &Plan {
        &self.plan
    }

    fn frequency(&self, parameter: f64) -> f64 {
        parameter
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
pub(crate) struct EntryCourse<'p> {
    plan: Plan,
    frequency: f64,
    settings: Settings,
    problem: &'p dyn Fn(f64) -> Option<Problem>,
}

impl<'p> EntryCourse<'p> {
    /// The course of `problem(λ)` at `frequency` in Hz; `from` is where it begins.
    pub(crate) fn new(
        problem: &'p dyn Fn(f64) -> Option<Problem>,
        frequency: f64,
        from: f64,
        settings: &Settings,
    ) -> Result<Self, PlanError> {
        let settings = whole(settings);
        let missing =
            || PlanError { place: "from".into(), problem: format!("there is no problem at {from}") };
        let plan = Plan::new(&problem(from).ok_or_else(missing)?, &settings)?;
        Ok(Self { plan, frequency, settings, problem })
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
            [self.residual_at(parameter + h, ws, slope), self.residual_at(parameter - h, ws, &mut below)];
        // Back to the evaluation that the caller made.
        let back = self.residual_at(parameter, ws, &mut here);
        // At the end of what makes sense there is one side only.
        let apart = match found {
            [true, true] => 2.0 * h,
            [true, false] => {
                below.copy_from_slice(&here);
                h
            }
            [false, true] => {
                slope.copy_from_slice(&here);
                h
            }
            [false, false] => return false,
        };
        for (above, below) in slope.iter_mut().zip(&below) {
            *above = (*above - below) / apart;
        }
        back
    }

    fn reach(&self, _parameter: f64) -> f64 {
        f64::INFINITY
    }
}

/// Homotopies run from this parameter on, one unit far: lengths are relative to the parameter.
pub(crate) const HOMOTOPY_START: f64 = 1.0;

/// A homotopy to the problem of a plan at the frequency condensed last.
pub(crate) struct HomotopyCourse<'p> {
    pub(crate) plan: &'p Plan,
    /// Of the part of the way, 0 … 1 and a little beyond.
    pub(crate) homotopy: fn(f64) -> Homotopy,
}

impl Course for HomotopyCourse<'_> {
    fn plan(&self) -> &Plan {
        self.plan
    }

    fn frequency(&self, _parameter: f64) -> f64 {
        0.0
    }

    fn homotopy(&self, parameter: f64) -> Homotopy {
        (self.homotopy)(parameter - HOMOTOPY_START)
    }

    fn place(&mut self, _parameter: f64, _ws: &mut Workspace) -> bool {
        true
    }

    fn slope(&mut self, parameter: f64, ws: &mut Workspace, slope: &mut [c64]) -> bool {
        let goal = ws.goal;
        let mut at = |parameter: f64, into: &mut [c64]| -> bool {
            let Workspace { point, unknowns, balance, .. } = &mut *ws;
            let homotopy = self.homotopy(parameter);
            let slots = self.plan.rungs[goal].slots;
            let evaluated =
                self.plan.balance(goal).evaluate(point, slots, homotopy, unknowns, &mut balance[goal]);
            into.copy_from_slice(&balance[goal].residual[..into.len()]);
            evaluated.is_ok()
        };
        let mut other = vec![c64::ZERO; slope.len()];
        let found = at(parameter + DIFFERENCE, slope) && at(parameter - DIFFERENCE, &mut other);
        for (above, below) in slope.iter_mut().zip(&other) {
            *above = (*above - below) / (2.0 * DIFFERENCE);
        }
        at(parameter, &mut other) && found
    }

    fn reach(&self, _parameter: f64) -> f64 {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use contact::{Coulomb, CoulombParameters, ElasticCoulomb, ElasticCoulombParameters, Law};
    use faer::{Mat, mat};

    use super::*;
    use crate::{Contact, Damping, Excitation, ExcitationKind, Model};

    /// At a solution the slope in the frequency is what central differences show: for every kind of excitation, forces
    /// that depend on the velocity, and springs lent to a free body for its mean.
    #[test]
    fn the_slope_in_the_frequency_agrees_with_differences() {
        let jenkins: Arc<dyn Law> = Arc::new(
            ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 2e5, slip_force: 4.0 }).unwrap(),
        );
        let creeping: Arc<dyn Law> =
            Arc::new(Coulomb::new(CoulombParameters { slip_force: 2.0, velocity: 0.2 }).unwrap());
        let spring: Arc<dyn Law> =
            Arc::new(contact::Cubic::new(contact::CubicParameters { stiffness: 1e12 }).unwrap());
        let kinds = [ExcitationKind::Force, ExcitationKind::Base, ExcitationKind::Unbalance];
        for (kind, ground, harmonic) in kinds.into_iter().flat_map(|kind| [(kind, 0.0, 1), (kind, 3e5, 2)]) {
            let contact = |first, second, law: &Arc<dyn Law>| Contact {
                name: "c".into(),
                first,
                second,
                law: law.clone(),
                scale: 1.5,
            };
            let amplitude = if kind == ExcitationKind::Unbalance { 2e-4 } else { 20.0 };
            let dof = usize::from(kind != ExcitationKind::Base);
            let excitation = Excitation { dof, harmonic: 1, amplitude, phase: 0.3, kind };
            let problem = Problem {
                joints: Vec::new(),
                model: Model::new(
                    mat![[2.0, 0.0], [0.0, 1.0]],
                    Damping::Rayleigh { mass: 8.0, stiffness: 1e-5 },
                    mat![[2e5 + ground, -2e5], [-2e5, 2e5]],
                )
                .unwrap(),
                excitation: vec![
                    excitation,
                    Excitation { harmonic, amplitude: 0.3 * amplitude, dof: 0, ..excitation },
                ],
                contacts: vec![
                    contact(0, None, &jenkins),
                    contact(1, Some(0), &creeping),
                    contact(1, None, &spring),
                ],
                output: vec![0],
            };
            let course = FrequencyCourse::new(&problem, &Settings::new(6)).unwrap();
            let (plan, hertz) = (&course.plan, 47.0);
            let mut ws = plan.workspace();
            assert!(plan.solve(hertz, &mut ws).status.solved());
            let entries = plan.slots() * ws.point.width();
            let mut slope = vec![c64::ZERO; entries];
            assert!(plan.place(hertz, &mut ws) && plan.evaluate_again(&mut ws));
            assert!(plan.frequency_slope(hertz, &mut ws, &mut slope));
            let step = 1e-4;
            let mut sides = Mat::zeros(entries, 2);
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                assert!(plan.place(hertz + sign * step, &mut ws) && plan.evaluate_again(&mut ws));
                for entry in 0..entries {
                    sides[(entry, side)] = ws.balance[ws.goal].residual[entry];
                }
            }
            let size = slope.iter().map(|s| s.norm()).fold(0.0, f64::max);
            for (entry, slope) in slope.iter().enumerate() {
                let difference: c64 = (sides[(entry, 0)] - sides[(entry, 1)]) / (2.0 * step);
                let error = (slope - difference).norm();
                assert!(error < 1e-6 * size, "{kind:?} {ground}, entry {entry}: {slope} for {difference}");
            }
        }
    }
}
