//! Stability of points as plain data, and what there is to say about it.

use contact::{JointMechanism, Mechanism};
use hbm::{Problem, Solution, Stability, Verdict};
use num_complex::Complex64;
use serde::{Serialize, Serializer};

use crate::explain::{Step, step};
use crate::notes;
use crate::scene::Scene;

/// Finds multipliers where the balance has none: of friction that remembers. It is given the problem, the harmonics of a
/// solution's columns and the solution, and says why when there are none.
pub type Judge<'a> = dyn Fn(&Problem, &[usize], &Solution) -> Result<Stability, String> + 'a;

/// Stability of a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointStability {
    /// Whether it is stable; `None` where the largest multiplier lies on the unit circle as far as its error tells.
    pub stable: Option<bool>,
    /// Floquet multipliers of a period of the excitation, the largest first; `[[re, im], …]` in JSON.
    #[serde(serialize_with = "pairs")]
    pub multipliers: Vec<Complex64>,
    /// How far each may be from the true one, an estimate.
    pub error: f64,
    /// `hill` or `orbit`.
    pub method: String,
}

fn pairs<S: Serializer>(values: &[Complex64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(|z| [z.re, z.im]))
}

impl PointStability {
    pub(crate) fn new(stability: &Stability) -> Self {
        Self {
            stable: match stability.verdict {
                Verdict::Stable => Some(true),
                Verdict::Unstable => Some(false),
                Verdict::Undecided => None,
            },
            multipliers: stability.multipliers.clone(),
            error: stability.error,
            method: stability.method.to_string(),
        }
    }
}

/// Has the solutions judged that are not, with their parameters; returns where and why some have no multipliers.
pub(crate) fn judge<'s>(
    solutions: impl Iterator<Item = (f64, &'s mut Solution)>,
    find: &dyn Fn(f64, &Solution) -> Result<Stability, String>,
) -> Vec<(f64, String)> {
    let mut unknown = Vec::new();
    for (parameter, solution) in solutions {
        let mut others = std::mem::take(&mut solution.others);
        for solution in std::iter::once(&mut *solution).chain(&mut others) {
            if solution.status.solved() && solution.stability.is_none() {
                match find(parameter, solution) {
                    Ok(stability) => solution.stability = Some(stability),
                    Err(why) => unknown.push((parameter, why)),
                }
            }
        }
        solution.others = others;
    }
    unknown
}

/// What a reader should know about the stability of points, at parameters with a unit behind them.
pub(crate) fn notes<'s>(
    solutions: impl Iterator<Item = (f64, &'s Solution)>,
    unknown: &[(f64, String)],
    unit: &str,
) -> Vec<String> {
    let (mut unstable, mut undecided) = (Vec::new(), Vec::new());
    for (parameter, solution) in solutions {
        match solution.stability.as_ref().map(|stability| stability.verdict) {
            Some(Verdict::Unstable) => unstable.push(parameter),
            Some(Verdict::Undecided) => undecided.push(parameter),
            _ => {}
        }
    }
    let mut found = Vec::new();
    found.extend(
        notes::range(unstable, unit).map(|places| format!("unstable, so not what one will see: {places}")),
    );
    found.extend(notes::range(undecided, unit).map(|places| {
        format!("the largest multiplier has a magnitude of 1 within its error at {places}: stability is undecided there")
    }));
    let mut reasons: Vec<&String> = unknown.iter().map(|(_, why)| why).collect();
    reasons.sort();
    reasons.dedup();
    for reason in reasons {
        let places = unknown.iter().filter(|(_, why)| why == reason).map(|(place, _)| *place).collect();
        found.extend(
            notes::range(places, unit).map(|places| format!("stability is not known at {places}: {reason}")),
        );
    }
    found
}

/// Whether and how stability is found.
pub(crate) fn explain(scene: &Scene) -> Step {
    let what = "stability (Floquet multipliers)";
    if !scene.settings.stability {
        return step(what, false, "not asked for (solver.stability, --stability)");
    }
    let mut remembers = false;
    for joint in &scene.contacts.joints {
        if let JointMechanism::None { why } = joint.law.mechanism() {
            return step(what, false, format!("contact {:?} has no state in time: {why}", joint.name));
        }
        remembers = true;
    }
    for contact in &scene.contacts.contacts {
        match contact.law.mechanism() {
            Mechanism::Sliders { sliders: [], .. } | Mechanism::Smooth(_) => {}
            Mechanism::None { why } if !contact.law.nature().rate_dependent => {
                return step(what, false, format!("contact {:?} has no state in time: {why}", contact.name));
            }
            _ => remembers = true,
        }
    }
    match remembers {
        true => step(
            what,
            true,
            "contacts remember or open: multipliers of the exact orbit beside each solution; of Hill's matrix where all of them \
             stick or stay closed",
        ),
        false => {
            step(what, true, "no contact remembers: Hill's matrix of the linearised balance, without sorting")
        }
    }
}
