//! Ways around a ladder that failed: homotopies, starts from rest and at random. All of it happens inside the point, so that
//! no point depends on a neighbour.

use faer::c64;

use crate::balance::Homotopy;
use crate::newton::{Criteria, Outcome};
use crate::plan::{Plan, Rung};
use crate::workspace::Workspace;

/// The same on the way of a homotopy.
const PASSING: f64 = 1e-6;

/// Perturbed starts tried at the end.
const PERTURBED_STARTS: usize = 8;

/// Steps a homotopy may take, failed ones included.
const HOMOTOPY_STEPS: usize = 400;

/// Complex unknowns that a homotopy along the arc may have.
const ARC_ENTRIES: usize = 64;

/// Above so many real unknowns only homotopies are tried: ways from elsewhere take too long.
const MANY_UNKNOWNS: usize = 2048;

/// Ways around a failed ladder that are tried however many unknowns there are.
const HOMOTOPIES: usize = 5;

/// The excitation homotopy begins where friction is a small part of the excitation.
const LARGE_EXCITATION: f64 = 100.0;

impl Plan {
    /// What is tried when the ladder failed, in turn, until one solves the balance with all harmonics.
    pub(crate) fn fall_back(&self, hertz: f64, ws: &mut Workspace) -> Outcome {
        let mut best = Outcome::NONE;
        type Attempt = fn(&Plan, f64, &mut Workspace) -> Outcome;
        let attempts: [Attempt; 9] = [
            |plan, _, ws| plan.secant_homotopy(ws),
            |plan, _, ws| plan.stiffness_homotopy(ws),
            |plan, _, ws| plan.contact_homotopy(ws),
            |plan, _, ws| plan.excitation_homotopy(ws),
            Self::damping_homotopy,
            |plan, _, ws| plan.arclength_homotopy(ws),
            |plan, _, ws| plan.start_at_rest(ws),
            |plan, _, ws| plan.perturbed_starts(ws),
            Self::detour,
        ];
        let unknowns = self.balance(ws.goal).size(ws.point.width(), self.rungs[ws.goal].slots);
        let tried = if unknowns > MANY_UNKNOWNS { HOMOTOPIES } else { attempts.len() };
        for attempt in attempts.into_iter().take(tried) {
            let outcome = attempt(self, hertz, ws);
            if outcome.converged {
                return outcome;
            }
            if outcome.residual < best.residual {
                best = outcome;
            }
        }
        best
    }

    /// From contacts replaced by secant stiffnesses at the amplitudes that result (a linear problem) to the problem.
    fn secant_homotopy(&self, ws: &mut Workspace) -> Outcome {
        ws.stats.secant_homotopies += 1;
        self.secant_start(ws);
        let count = self.rungs[0].slots * ws.point.width();
        ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
        self.solve_linearised(self.rungs[ws.goal].slots, self.first_slot().unwrap_or(0), ws);
        self.follow(0.0, 1.0, 0.1, |s| Homotopy { secant: 1.0 - s, ..Homotopy::NONE }, ws)
    }

    /// From contacts as soft as the structure, with the slip forces they have, to their own stiffness: equal steps in its
    /// logarithm.
    fn stiffness_homotopy(&self, ws: &mut Workspace) -> Outcome {
        ws.stats.stiffness_homotopies += 1;
        let (slots, width) = (self.rungs[ws.goal].slots, ws.point.width());
        let first = self.first_slot().unwrap_or(0) * width * width;
        let stiffest = ws.point.receptance[first..first + width * width].iter().map(|g| g.norm());
        let softness = 1.0 / (1.0 + stiffest.fold(0.0, f64::max));
        ws.point.secant[..width].fill(c64::from(softness));
        self.solve_with_secants(slots, ws);
        let decades = softness.ln();
        let steps = (-decades).max(1.0);
        let stretch = move |s: f64| Homotopy { stretch: (decades * (1.0 - s)).exp(), ..Homotopy::NONE };
        self.follow(0.0, 1.0, 0.5 / steps, stretch, ws)
    }

    /// From the structure without contacts (μ = 0) to the problem (μ = 1), with all harmonics.
    fn contact_homotopy(&self, ws: &mut Workspace) -> Outcome {
        ws.stats.contact_homotopies += 1;
        let count = self.rungs[ws.goal].slots * ws.point.width();
        ws.unknowns[..count].copy_from_slice(&ws.point.free[..count]);
        // Equal steps in √μ: contacts are felt early.
        self.follow(0.0, 1.0, 0.1, |s| Homotopy { contact: s * s, ..Homotopy::NONE }, ws)
    }

    /// The same along the arc, with few harmonics, and up the ladder from there: the whole derivative is factored at
    /// every point of the arc, which many harmonics cannot afford.
    fn arclength_homotopy(&self, ws: &mut Workspace) -> Outcome {
        let (goal, width) = (ws.goal, ws.point.width());
        let few = |rung: &Rung| rung.slots * width <= ARC_ENTRIES;
        let low = self.rungs[..=goal].iter().rposition(few).unwrap_or(0);
        ws.goal = low;
        let mut outcome = self.homotopy_arcs(ws);
        ws.goal = goal;
        if outcome.converged && low < goal {
            outcome = self.climb(low + 1, ws);
        }
        outcome
    }

    /// Where a homotopy folds, the curve turns back and comes again. From contacts replaced by secant stiffnesses, and
    /// from none.
    fn homotopy_arcs(&self, ws: &mut Workspace) -> Outcome {
        let slots = self.rungs[ws.goal].slots;
        let count = slots * ws.point.width();
        let from_secant = |s: f64| Homotopy { secant: 1.0 - s, ..Homotopy::NONE };
        let from_nothing = |s: f64| Homotopy { contact: s, ..Homotopy::NONE };
        let mut outcome = Outcome::NONE;
        for secant in [true, false] {
            let homotopy: fn(f64) -> Homotopy = if secant { from_secant } else { from_nothing };
            ws.stats.arclength_homotopies += 1;
            if secant {
                self.secant_start(ws);
                let first = self.rungs[0].slots * ws.point.width();
                ws.kept[..first].copy_from_slice(&ws.unknowns[..first]);
                self.solve_linearised(slots, self.first_slot().unwrap_or(0), ws);
            } else {
                ws.unknowns[..count].copy_from_slice(&ws.point.free[..count]);
            }
            if self.iterate(ws.goal, slots, homotopy(0.0), ws).converged && self.follow_homotopy(homotopy, ws)
            {
                outcome = self.iterate(ws.goal, slots, Homotopy::NONE, ws);
                if outcome.converged {
                    break;
                }
            }
        }
        outcome
    }

    /// From an excitation so large that friction hardly matters down to the problem's own.
    fn excitation_homotopy(&self, ws: &mut Workspace) -> Outcome {
        ws.stats.excitation_homotopies += 1;
        let count = self.rungs[ws.goal].slots * ws.point.width();
        for entry in 0..count {
            ws.unknowns[entry] = ws.point.free[entry] * LARGE_EXCITATION;
        }
        let decades = LARGE_EXCITATION.ln();
        let excitation = move |s: f64| Homotopy { excitation: (decades * (1.0 - s)).exp(), ..Homotopy::NONE };
        self.follow(0.0, 1.0, 0.1, excitation, ws)
    }

    /// Follows a homotopy from `start` to `end` with steps that adapt to success, each guessed from the two before.
    fn follow(
        &self,
        start: f64,
        end: f64,
        step: f64,
        homotopy: impl Fn(f64) -> Homotopy,
        ws: &mut Workspace,
    ) -> Outcome {
        let last = ws.goal;
        let slots = self.rungs[last].slots;
        let count = slots * ws.point.width();
        let mut reached = start;
        let mut before = None;
        let mut step = step;
        let mut outcome = self.iterate(last, slots, homotopy(start), ws);
        ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
        for _ in 0..HOMOTOPY_STEPS {
            let next = (reached + step).min(end);
            if let Some(before) = before {
                let ratio = (next - reached) / (reached - before);
                for entry in 0..count {
                    let slope = ws.kept[entry] - ws.before[entry];
                    ws.unknowns[entry] = ws.kept[entry] + slope * ratio;
                }
            }
            let mut criteria = self.criteria();
            if next < end {
                criteria = Criteria { tolerance: PASSING, polish: false, ..criteria };
            }
            outcome = self.iterate_with(last, slots, homotopy(next), criteria, ws);
            if outcome.converged {
                if next >= end {
                    return outcome;
                }
                before = Some(reached);
                reached = next;
                step *= match outcome.iterations {
                    0..=5 => 2.0,
                    6..=8 => 1.3,
                    _ => 1.0,
                };
                ws.before[..count].copy_from_slice(&ws.kept[..count]);
                ws.kept[..count].copy_from_slice(&ws.unknowns[..count]);
            } else {
                step *= 0.4;
                ws.unknowns[..count].copy_from_slice(&ws.kept[..count]);
                if step < 1e-6 {
                    break;
                }
            }
        }
        Outcome { converged: false, residual: f64::INFINITY, ..outcome }
    }

    /// Newton's method from no motion at all: its first step is the motion with the tangents at rest. Friction that depends on
    /// the velocity is a damper there, and may be a staircase at any larger motion.
    fn start_at_rest(&self, ws: &mut Workspace) -> Outcome {
        ws.stats.starts_at_rest += 1;
        let slots = self.rungs[ws.goal].slots;
        ws.unknowns[..slots * ws.point.width()].fill(c64::ZERO);
        self.iterate(ws.goal, slots, Homotopy::NONE, ws)
    }

    /// The free response scaled and turned at random, from a fixed seed.
    fn perturbed_starts(&self, ws: &mut Workspace) -> Outcome {
        let count = self.rungs[ws.goal].slots * ws.point.width();
        let last = ws.goal;
        let slots = self.rungs[last].slots;
        let mut random = SplitMix(0x5711_c451_1b00_57e4);
        let mut best = Outcome::NONE;
        for _ in 0..PERTURBED_STARTS {
            ws.stats.perturbed_starts += 1;
            for entry in 0..count {
                let size = 10.0_f64.powf(2.0 * random.unit() - 1.5);
                let turn = std::f64::consts::TAU * (random.unit() - 0.5);
                ws.unknowns[entry] = ws.point.free[entry] * c64::from_polar(size, turn);
            }
            let first = self.rungs.first().map_or(0, |rung| rung.slots);
            let mut outcome = self.iterate(0, first, Homotopy::NONE, ws);
            if outcome.converged {
                outcome = self.climb(1, ws);
            }
            if !outcome.converged && first == slots {
                outcome = self.iterate(last, slots, Homotopy::NONE, ws);
            }
            if outcome.converged {
                return outcome;
            }
            if outcome.residual < best.residual {
                best = outcome;
            }
        }
        best
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): a few reproducible numbers, not statistics.
struct SplitMix(u64);

impl SplitMix {
    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use contact::{Coulomb, CoulombParameters, ElasticCoulomb, ElasticCoulombParameters};
    use faer::mat;

    use super::*;
    use crate::{Contact, Damping, Excitation, ExcitationKind, Model, Problem, Settings};

    /// Two masses with an elastic Coulomb contact that sticks and slips with interior reversals at 57 Hz, where a ladder
    /// judged by residuals alone fails.
    fn hard_plan() -> Plan {
        let parameters = ElasticCoulombParameters { stiffness: 6.705e6, slip_force: 6.705e6 * 2.232e-6 };
        let law = Arc::new(ElasticCoulomb::new(parameters).unwrap());
        let problem = Problem {
            joints: Vec::new(),
            model: Model::new(
                mat![[3.98, 0.0], [0.0, 1.27]],
                Damping::Matrix(mat![[24.0, 0.0], [0.0, 24.0]]),
                mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
            )
            .unwrap(),
            excitation: vec![Excitation {
                dof: 1,
                harmonic: 1,
                amplitude: 9.1,
                phase: 0.0,
                kind: ExcitationKind::Force,
            }],
            contacts: vec![Contact { name: "root".into(), first: 0, second: None, law, scale: 1.0 }],
            output: vec![0],
        };
        Plan::new(&problem, &Settings::new(7)).unwrap()
    }

    /// Each way around a failed ladder reaches a solution by itself, and all reach the same.
    #[test]
    fn every_fallback_solves_a_hard_point() {
        let plan = hard_plan();
        let mut ws = plan.workspace();
        let solution = plan.solve(57.0, &mut ws);
        // The natural test of the line search spares this point a homotopy.
        assert!(solution.status.solved() && solution.stats.secant_homotopies == 0, "{:?}", solution.stats);
        let expected = solution.contacts[0].displacement.clone();
        type Fallback = fn(&Plan, &mut Workspace) -> Outcome;
        let fallbacks: [(&str, Fallback); 7] = [
            ("stiffness", Plan::stiffness_homotopy),
            ("secant", Plan::secant_homotopy),
            ("contact", Plan::contact_homotopy),
            ("excitation", Plan::excitation_homotopy),
            ("damping", |plan, ws| plan.damping_homotopy(57.0, ws)),
            ("arclength", Plan::arclength_homotopy),
            ("detour", |plan, ws| plan.detour(57.0, ws)),
        ];
        for (name, fallback) in fallbacks {
            plan.structure.condense(57.0, 0..plan.slots(), &mut ws.condensed).unwrap();
            ws.point.set(&ws.condensed, plan.laws(), plan.slots(), &[false]);
            ws.unknowns.fill(c64::ZERO);
            let outcome = fallback(&plan, &mut ws);
            assert!(outcome.converged, "{name}");
            for (unknown, w) in ws.unknowns.iter().zip(&expected) {
                let error = (unknown * ws.point.length[0] - w).norm() / expected[0].norm();
                assert!(error < 1e-9, "{name}: {error:e}");
            }
        }
    }

    /// Where the first rung fails the next one goes on from what is there: nothing of another point.
    #[test]
    fn a_failed_first_rung_starts_the_next_afresh() {
        let mut plan = hard_plan();
        // Coulomb's law: no describing function, so no closed start.
        let creeping = CoulombParameters { slip_force: 6.0, velocity: 1e-4 };
        plan.contacts[0].law = Arc::new(Coulomb::new(creeping).unwrap());
        plan.scalar_start = false;
        plan.settings.max_iterations = 3;
        let mut ws = plan.workspace();
        for hertz in [57.0, 30.0, 43.0, 80.0] {
            let used = plan.solve(hertz, &mut ws);
            assert_eq!(used, plan.solve(hertz, &mut plan.workspace()), "{hertz} Hz");
        }
    }
}
