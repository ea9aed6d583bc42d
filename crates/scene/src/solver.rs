//! `harmonics` and `solver`: how the balance is to be solved.

use hbm::{Jacobian, Settings, Start};

use crate::error::{NOT_YET, SceneError};
use crate::read::Node;

pub(crate) const KEYS: [&str; 3] = ["start", "jacobian", "samples"];
pub(crate) const ADAPTIVE_KEYS: [&str; 2] = ["tolerance", "max"];

/// Harmonics beyond this are a slip of the pen.
pub(crate) const MOST_HARMONICS: usize = 4095;
/// Likewise samples a period.
const MOST_SAMPLES: usize = 1 << 20;

/// Reads `harmonics` (1, the paper's method, when left out) and `solver`.
pub(crate) fn read(harmonics: Option<Node>, solver: Option<Node>) -> Result<Settings, SceneError> {
    let mut settings = Settings::new(harmonics.map_or(Ok(1), |node| read_harmonics(&node))?);
    let Some(solver) = solver else {
        return Ok(settings);
    };
    let solver = solver.object("start, jacobian, samples", &KEYS)?;
    if let Some(start) = solver.get("start") {
        settings.start = start.choice(&[("ladder", Start::Ladder), ("march", Start::March)])?;
    }
    if let Some(jacobian) = solver.get("jacobian") {
        settings.jacobian =
            jacobian.choice(&[("analytic", Jacobian::Analytic), ("difference", Jacobian::Difference)])?;
    }
    if let Some(samples) = solver.get("samples") {
        settings.samples = Some(samples.whole(4, MOST_SAMPLES)?);
    }
    Ok(settings)
}

fn read_harmonics(node: &Node) -> Result<usize, SceneError> {
    if !node.is_object() {
        return node.whole(1, MOST_HARMONICS);
    }
    node.object("tolerance and max", &ADAPTIVE_KEYS)?;
    Err(node
        .error(format!("as many harmonics as each point needs is {NOT_YET}; write a number, for example 15")))
}

/// Checks a number of harmonics that does not come from a scene's text.
pub(crate) fn check_harmonics(harmonics: usize) -> Result<usize, SceneError> {
    if (1..=MOST_HARMONICS).contains(&harmonics) {
        return Ok(harmonics);
    }
    let problem = format!("must be a whole number from 1 to {MOST_HARMONICS}, got {harmonics}");
    Err(SceneError::entry("harmonics", problem))
}
