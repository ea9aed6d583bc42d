//! `solver`: how the balance is to be solved.

use hbm::{Jacobian, Settings, Start};

use crate::error::SceneError;
use crate::read::Node;

pub(crate) const KEYS: [&str; 5] = ["start", "jacobian", "samples", "estimate", "stability"];

/// More samples a period than this are a slip of the pen.
const MOST_SAMPLES: usize = 1 << 20;

/// Reads `solver` into `settings`; returns whether an estimate of the truncation error is wanted, where it says so.
pub(crate) fn read(solver: Option<Node>, settings: &mut Settings) -> Result<Option<bool>, SceneError> {
    let Some(solver) = solver else {
        return Ok(None);
    };
    let solver = solver.object("start, jacobian, samples, estimate, stability", &KEYS)?;
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
    let flag = |node: Node| node.flag().ok_or_else(|| node.must_be("true or false"));
    settings.stability = solver.get("stability").map(flag).transpose()?.unwrap_or(false);
    solver.get("estimate").map(flag).transpose()
}
