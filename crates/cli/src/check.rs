//! `stickslip check`: reads and checks a scene.

use scene::{Harmonics, ReductionFacts};

use crate::arguments::SceneArguments;
use crate::ending::{Ending, Failure, say};
use crate::output;
use crate::progress::prepared;

/// Reads the scene and plans it, which finds everything that can be wrong with it.
pub fn run(arguments: &SceneArguments) -> Result<Ending, Failure> {
    let scene = arguments.read()?;
    let prepared = prepared(&scene).map_err(|error| arguments.unsolvable(error))?;
    for note in prepared.notes() {
        say(format_args!("note: {note}"));
    }
    output::print(&format!(
        "{}: {}{}, {}, {}, {}\n",
        arguments.scene.display(),
        count(scene.dofs().len(), "dof", "dofs"),
        reduction(prepared.reduction()),
        count(scene.contacts().count(), "contact", "contacts"),
        count(scene.frequencies().as_slice().len(), "frequency", "frequencies"),
        harmonics(scene.harmonics())
    ))
}

/// " reduced to 5 kept ones and 30 modes (error 1e-7)".
fn reduction(facts: Option<ReductionFacts>) -> String {
    let Some(ReductionFacts { kept, modes, error, .. }) = facts else { return String::new() };
    let error = error.map_or(String::new(), |error| format!(" (error {error:.1e}, estimate)"));
    format!(" reduced to {kept} and {}{error}", count(modes, "mode", "modes"))
}

fn harmonics(harmonics: Harmonics) -> String {
    match harmonics {
        Harmonics::All(n) => format!("N = {n}"),
        Harmonics::Needed { tolerance, max } => {
            format!("as many harmonics as {tolerance:e} needs, at most {max}")
        }
    }
}

/// "1 dof", "2 dofs".
pub fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}
