//! `stickslip explain`: what a scene needs, what it leaves out, and why.

use scene::Step;
use serde::Serialize;

use crate::arguments::{ExplainArguments, TextFormat};
use crate::ending::{Ending, Failure};
use crate::output;
use crate::progress::prepared;

#[derive(Serialize)]
struct Explanation {
    steps: Vec<Step>,
}

/// Plans the scene and lists the steps.
pub fn run(arguments: &ExplainArguments) -> Result<Ending, Failure> {
    let scene = arguments.scene.read()?;
    let prepared = prepared(&scene).map_err(|error| arguments.scene.unsolvable(error))?;
    let explanation = Explanation { steps: prepared.explain() };
    match arguments.format {
        TextFormat::Text => output::print(&text(scene.name(), &explanation.steps)),
        TextFormat::Json => output::print_json(&explanation),
    }
}

fn text(name: &str, steps: &[Step]) -> String {
    let lines = |used: bool| -> String {
        let chosen = steps.iter().filter(|step| step.used == used);
        chosen.map(|step| format!("  {}: {}\n", step.what, step.why)).collect()
    };
    format!("{name} needs\n{}\nand leaves out\n{}", lines(true), lines(false))
}
