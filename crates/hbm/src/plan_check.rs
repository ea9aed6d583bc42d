//! What a problem may not have, found before anything is allocated.

use crate::error::PlanError;
use crate::problem::{ExcitationKind, Joint, Problem};
use crate::settings::Settings;

/// The most harmonics a plan accepts.
const MOST_HARMONICS: usize = 4095;

/// The most bytes that a factorisation and the receptances of one thread may take.
const MOST_BYTES: f64 = 4e9;

/// Two tangential directions and the normal one.
const MOST_DIRECTIONS: usize = 3;

/// So many real unknowns always fit.
const SAFE_UNKNOWNS: f64 = 16_384.0;

pub(crate) fn check<M>(
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

/// Refuses what would not fit into memory before anything is allocated.
pub(crate) fn check_size<M>(problem: &Problem<M>, dofs: usize, settings: &Settings) -> Result<(), PlanError> {
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
