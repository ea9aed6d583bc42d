//! What a scene needs and what it leaves out, and why.

use hbm::{Jacobian, PlanFacts, Receptances, Settings, Start};
use serde::Serialize;

use crate::reduction::{Reduced, SMALL, Wish};
use crate::run::Prepared;
use crate::stability;
use crate::structure::Structure;

/// One step of the method.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Step {
    /// The step.
    pub what: &'static str,
    /// Whether this scene uses it.
    pub used: bool,
    /// Why, or why not.
    pub why: String,
}

pub(crate) fn step(what: &'static str, used: bool, why: impl Into<String>) -> Step {
    Step { what, used, why: why.into() }
}

pub(crate) fn steps(prepared: &Prepared) -> Vec<Step> {
    let (scene, facts) = (prepared.scene, prepared.plan.facts());
    let settings = &scene.settings;
    let n = settings.harmonics;
    let mut steps = vec![
        period(&facts),
        even_harmonics(&facts, scene.contacts.joints.len()),
        reduction(prepared),
        condensation(&facts, scene.output().len()),
        transforms(&facts),
        events(&facts),
        several_directions(prepared, &facts),
    ];
    steps.extend(iteration(&facts, settings.jacobian));
    steps.extend(start(&facts, settings.start, n));
    let points = scene.frequencies.as_slice().len();
    steps.push(match (settings.start, points) {
        (Start::March, _) => step("parallel sweep", false, "marching needs the point before"),
        (Start::Ladder, 1) => step("parallel sweep", false, "there is one point"),
        (Start::Ladder, _) if points <= prepared.plan.points_a_task() => {
            step("parallel sweep", false, format!("{points} points are solved before threads have started"))
        }
        (Start::Ladder, _) => {
            step("parallel sweep", true, format!("{points} points do not depend on each other"))
        }
    });
    steps.push(if settings.all_solutions {
        step("other solutions", true, "asked for; they are listed where they are known")
    } else {
        step("other solutions", false, "not asked for (--all-solutions)")
    });
    steps.push(needed_harmonics(settings));
    steps.push(slaved_harmonics(&facts));
    steps.push(estimate(&facts, settings));
    steps.push(stability::explain(scene));
    let alone = "each frequency is solved on its own (stickslip continue follows the response as a curve)";
    steps.push(step("continuation through folds", false, alone));
    steps
}

fn needed_harmonics(settings: &Settings) -> Step {
    let what = "as many harmonics as each point needs";
    match settings.truncation {
        Some(tolerance) => step(
            what,
            true,
            format!(
                "until the truncation error is estimated below {tolerance:e}, {} at most",
                settings.harmonics
            ),
        ),
        None => step(
            what,
            false,
            "every point has the harmonics of the scene (\"harmonics\": {\"tolerance\": …, \"max\": …})",
        ),
    }
}

fn slaved_harmonics(facts: &PlanFacts) -> Step {
    let what = "slaved high harmonics";
    match facts.tail_after {
        Some(n) => step(
            what,
            true,
            format!(
                "those above {n} that the structure barely answers are found by substitution, without Newton"
            ),
        ),
        None if facts.linear || facts.scalar => {
            step(what, false, "there is no iteration that could leave them out")
        }
        None if facts.joints > 0 => {
            step(what, false, "contacts in several directions: all harmonics are solved together")
        }
        None if !facts.bounded_stiffness => {
            step(what, false, "a contact has no largest stiffness, so all harmonics are solved together")
        }
        None => step(what, false, "all harmonics are solved together"),
    }
}

fn estimate(facts: &PlanFacts, settings: &Settings) -> Step {
    let what = "estimate of the truncation error";
    match settings.estimate {
        true if settings.truncation.is_some() => {
            step(what, true, "it decides how many harmonics a point needs")
        }
        true => step(what, true, "each point says how far it is from the solution with all harmonics"),
        false if facts.scalar => {
            step(what, false, "one harmonic in closed form: nothing is evaluated beyond it (solver.estimate)")
        }
        false if settings.harmonics == 1 => step(what, false, "one harmonic (solver.estimate asks for it)"),
        false => step(what, false, "the scene asks for none (solver.estimate)"),
    }
}

fn period(facts: &PlanFacts) -> Step {
    let what = "reduction of the period";
    match facts.fundamental {
        0 | 1 => step(what, false, "the excitation has the period of Ω"),
        f => step(
            what,
            true,
            format!("only multiples of harmonic {f} are excited: the period is {f} times shorter"),
        ),
    }
}

fn even_harmonics(facts: &PlanFacts, joints: usize) -> Step {
    let what = "even harmonics and the mean";
    if facts.odd {
        step(what, false, "all laws and the excitation are odd, so they are zero")
    } else if joints > 0 {
        step(what, true, "a contact presses but does not pull, so its force has a mean and even harmonics")
    } else {
        step(what, true, "a law or the excitation is not odd")
    }
}

fn reduction(prepared: &Prepared) -> Step {
    let what = "reduction of the structure";
    let n = prepared.scene.dofs().len();
    let dofs = if n == 1 { "1 dof".to_owned() } else { format!("{n} dofs") };
    let Structure::Sparse(sparse) = &prepared.scene.structure else {
        return step(
            what,
            false,
            format!("the matrices stand in the scene; the structure with {dofs} is solved as it is"),
        );
    };
    let nonzeros = sparse.model.nonzeros();
    let Some(Reduced { key, reduction }) = prepared.posed.and_then(|posed| posed.reduced.as_ref()) else {
        let why = match sparse.wish {
            Wish::Full if prepared.posed.is_none() => {
                "the scene asks for none; a sparse factor at every frequency and harmonic".to_owned()
            }
            Wish::Full => "the scene asks for none; solved as dense matrices".to_owned(),
            _ => format!("it pays from {} dofs on", SMALL + 1),
        };
        return step(
            what,
            false,
            format!("{dofs}, {nonzeros} nonzeros in the stiffness: {why} (model.reduction)"),
        );
    };
    let kept = key.keep.len();
    let reach =
        reduction.fixed_frequencies.last().map_or(String::new(), |hertz| format!(" up to {hertz:.4e} Hz"));
    let shapes = match reduction.modes - reduction.fixed_frequencies.len() {
        0 => String::new(),
        count => format!(" and {count} static shapes for the inertia of higher ones"),
    };
    let error = match reduction.error {
        None => String::new(),
        Some(error) => {
            let (least, most) = (key.options.lowest, key.options.highest);
            let checks = match reduction.checked_at.len() {
                1 => "at 1 frequency".to_owned(),
                count => format!("at {count} frequencies"),
            };
            format!(
                "; their response is off by {error:.1e} at most (estimate, against the full structure {checks} \
                 from {least} to {most} Hz)"
            )
        }
    };
    step(
        what,
        true,
        format!(
            "{dofs}, {nonzeros} nonzeros in the stiffness: the {kept} of contacts, excitation and output are kept, {} \
             modes{reach} with these held{shapes} stand for the others{error}",
            reduction.fixed_frequencies.len()
        ),
    )
}

fn condensation(facts: &PlanFacts, output: usize) -> Step {
    let what = "condensation to the contacts";
    let how = match facts.receptances {
        Receptances::Dense => "",
        Receptances::Modes => "; receptances are sums over modes",
        Receptances::Sparse => "; a sparse factorisation a harmonic",
    };
    match facts.condensed_dofs {
        0 => step(what, false, "every dof carries a contact"),
        1 => step(what, true, format!("1 dof carries no contact; {output} output dof(s) are recovered{how}")),
        count => step(
            what,
            true,
            format!("{count} dofs carry no contact; {output} output dof(s) are recovered{how}"),
        ),
    }
}

fn transforms(facts: &PlanFacts) -> Step {
    let what = "alternating frequency-time evaluation (FFT)";
    if facts.linear {
        step(what, false, "no law needs it: the scene is linear")
    } else if facts.scalar {
        step(what, false, "one harmonic: the law has a closed form (describing function)")
    } else if facts.samples == 0 {
        step(
            what,
            false,
            "all laws are piecewise linear: their forces come from their events, without sampling error",
        )
    } else {
        step(what, true, format!("forces are evaluated at {} instants of a period", facts.samples))
    }
}

fn events(facts: &PlanFacts) -> Step {
    let what = "event-exact force";
    match facts.event_exact {
        0 if facts.scalar || facts.linear => step(what, false, "no force has to be evaluated in time"),
        0 if facts.joints > 0 => {
            step(what, false, "contacts in several directions are followed over samples")
        }
        0 if facts.sampled_on_request => step(what, false, "the scene asks for samples (solver.samples)"),
        0 => step(what, false, "no law is piecewise linear"),
        1 => step(what, true, "1 contact has a piecewise linear law: exact integrals between its events"),
        count => step(
            what,
            true,
            format!("{count} contacts have piecewise linear laws: exact integrals between events"),
        ),
    }
}

fn several_directions(prepared: &Prepared, facts: &PlanFacts) -> Step {
    let what = "contacts in several directions";
    let joints = &prepared.scene.contacts.joints;
    let of = |directions: usize| joints.iter().filter(|joint| joint.directions.len() == directions).count();
    let (line, plane) = (of(2), of(3));
    let which = match (line, plane) {
        (0, 0) => return step(what, false, "every law acts in one direction"),
        (count, 0) => format!("{count} with one tangential direction"),
        (0, count) => format!("{count} with two tangential directions"),
        (line, plane) => format!("{line} with one tangential direction, {plane} with two"),
    };
    let how = match facts.joints_by_events {
        0 => {
            format!("their friction is followed over {} instants of a period until it repeats", facts.samples)
        }
        all if all == facts.joints => {
            "their forces come from their events, without sampling error".to_owned()
        }
        some => format!(
            "the forces of {some} come from their events, the others are followed over {} instants of a period until they repeat",
            facts.samples
        ),
    };
    step(what, true, format!("{which}, under a normal load that the motion changes; {how}"))
}

fn iteration(facts: &PlanFacts, jacobian: Jacobian) -> Vec<Step> {
    let newton = "Newton iteration";
    let derivative = "derivatives in closed form";
    if facts.linear {
        return vec![step(newton, false, "the scene is linear: one solve a frequency")];
    }
    if facts.scalar {
        return vec![step(
            newton,
            false,
            "one contact, one harmonic: all roots of one real equation are found",
        )];
    }
    vec![
        step(newton, true, {
            let how = if facts.krylov { ", steps by GMRES, preconditioned harmonic by harmonic" } else { "" };
            format!("{} real unknowns{how}", facts.unknowns)
        }),
        match jacobian {
            Jacobian::Analytic => step(derivative, true, "the usual choice; exact and cheap"),
            Jacobian::Difference => {
                step(derivative, false, "the scene asks for differences (solver.jacobian)")
            }
        },
    ]
}

fn start(facts: &PlanFacts, start: Start, n: usize) -> Vec<Step> {
    let scalar = "all solutions of the first harmonic";
    let ladder = "ladder of harmonics";
    let march = "start from the frequency before";
    if facts.linear {
        return vec![step(march, false, "a linear scene needs no start")];
    }
    let march = match start {
        Start::March => step(march, true, "the scene asks for it (solver.start), as in the paper's Fig. 2"),
        Start::Ladder => step(march, false, "every point finds its own start"),
    };
    let one = "one contact with a closed form: all are found, no initial guess is needed";
    if facts.scalar {
        return vec![step(scalar, true, one), march];
    }
    let roots = match (facts.scalar_start, start) {
        (true, Start::Ladder) => step(scalar, true, format!("{one}; they start the ladder")),
        (true, Start::March) => step(scalar, true, format!("{one}; they start the first point")),
        (false, _) => step(scalar, false, "no closed form for these contacts and this excitation"),
    };
    let rungs = facts.ladder.iter().map(usize::to_string).collect::<Vec<_>>().join(" → ");
    let climb = match facts.ladder.len() {
        0 | 1 => step(ladder, false, format!("N = {n} is solved at once")),
        _ if start == Start::March => step(ladder, true, format!("N = {rungs} for the first point")),
        _ => step(ladder, true, format!("N = {rungs}, each the start of the next")),
    };
    vec![roots, climb, march]
}
