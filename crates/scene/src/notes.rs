//! What a user should be told about a result, beyond its numbers.

use hbm::Solution;

use crate::scene::Scene;

/// Notes on the scene's data and on its solutions.
pub(crate) fn all(scene: &Scene, solutions: &[Solution]) -> Vec<String> {
    let mut notes = scene.notes.clone();
    for (i, name) in scene.contacts().enumerate() {
        let left =
            |solution: &&Solution| solution.contacts.get(i).is_some_and(|contact| contact.extrapolated);
        if let Some(note) = span(solutions.iter().filter(left)) {
            notes.push(format!(
                "contact {name:?} moves further than its loop was measured at {note}; the law is extrapolated there"
            ));
        }
    }
    let several = solutions.iter().filter(|solution| solution.solutions.is_some_and(|count| count > 1));
    if let Some(note) = span(several) {
        notes.push(format!(
            "more than one solution exists at {note}; the one with the largest contact amplitude is reported \
             (--all-solutions lists the others)"
        ));
    }
    let starts =
        solutions.iter().filter(|solution| solution.solutions.is_none() && solution.stats.starts > 1);
    if let Some(note) = span(starts) {
        notes.push(format!(
            "the first harmonic alone has more than one solution at {note}, so there may be several; stickslip continue \
             follows the response through its folds"
        ));
    }
    let failed: Vec<&Solution> = solutions.iter().filter(|solution| !solution.status.solved()).collect();
    if let Some(note) = span(failed.iter().copied()) {
        notes.push(format!("no solution was found at {note}; these points have a reason instead of numbers"));
    }
    notes
}

/// "3 points between 40 and 42 Hz".
fn span<'a>(solutions: impl Iterator<Item = &'a Solution>) -> Option<String> {
    let frequencies: Vec<f64> = solutions.map(|solution| solution.frequency).collect();
    let least = frequencies.iter().copied().reduce(f64::min)?;
    let most = frequencies.iter().copied().reduce(f64::max)?;
    Some(match frequencies.len() {
        1 => format!("{} Hz", short(least)),
        count => format!("{count} points between {} and {} Hz", short(least), short(most)),
    })
}

/// A frequency to seven digits, without the noise of its last ones.
fn short(frequency: f64) -> f64 {
    format!("{frequency:.6e}").parse().unwrap_or(frequency)
}
