//! What a user should be told about a result, beyond its numbers.

use hbm::Solution;

use crate::contacts::Place;
use crate::run::Prepared;
use crate::scene::Scene;

/// Notes on the scene's data and on its solutions.
pub(crate) fn all(prepared: &Prepared, solutions: &[Solution]) -> Vec<String> {
    let scene = prepared.scene;
    let mut notes = prepared.notes();
    let places: Vec<(f64, &Solution)> = solutions.iter().map(|s| (s.frequency, s)).collect();
    notes.extend(extrapolated(scene, &places, " Hz"));
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

/// Notes on contacts that leave what was measured, at places with a unit behind them.
pub(crate) fn extrapolated(scene: &Scene, places: &[(f64, &Solution)], unit: &str) -> Vec<String> {
    let note = |(name, place): (&str, &Place)| {
        let left = |solution: &Solution| match *place {
            Place::Contact(i) => solution.contacts.get(i).is_some_and(|contact| contact.extrapolated),
            Place::Joint(i) => solution.joints.get(i).is_some_and(|joint| joint.extrapolated),
        };
        let places = places.iter().filter(|(_, solution)| left(solution)).map(|(place, _)| *place).collect();
        let places = range(places, unit)?;
        Some(format!(
            "contact {name:?} moves further than its loop was measured at {places}; the law is extrapolated there"
        ))
    };
    scene.contacts().zip(&scene.contacts.order).filter_map(note).collect()
}

fn span<'a>(solutions: impl Iterator<Item = &'a Solution>) -> Option<String> {
    range(solutions.map(|solution| solution.frequency).collect(), " Hz")
}

/// "3 points between 40 and 42 Hz".
pub(crate) fn range(places: Vec<f64>, unit: &str) -> Option<String> {
    let least = places.iter().copied().reduce(f64::min)?;
    let most = places.iter().copied().reduce(f64::max)?;
    Some(match places.len() {
        1 => format!("{}{unit}", short(least)),
        count => format!("{count} points between {} and {}{unit}", short(least), short(most)),
    })
}

/// A number to seven digits, without the noise of its last ones.
fn short(frequency: f64) -> f64 {
    format!("{frequency:.6e}").parse().unwrap_or(frequency)
}
