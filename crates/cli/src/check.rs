//! `stickslip check`: reads and checks a scene.

use scene::Harmonics;

use crate::arguments::SceneArguments;
use crate::ending::{Ending, Failure, say};
use crate::output;

/// Reads the scene and plans it, which finds everything that can be wrong with it.
pub fn run(arguments: &SceneArguments) -> Result<Ending, Failure> {
    let scene = arguments.read()?;
    let _ = scene.prepare().map_err(|error| arguments.unsolvable(error))?;
    for note in scene.notes() {
        say(format_args!("note: {note}"));
    }
    output::print(&format!(
        "{}: {}, {}, {}, {}\n",
        arguments.scene.display(),
        count(scene.dofs().len(), "dof", "dofs"),
        count(scene.contacts().count(), "contact", "contacts"),
        count(scene.frequencies().as_slice().len(), "frequency", "frequencies"),
        harmonics(scene.harmonics())
    ))
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
