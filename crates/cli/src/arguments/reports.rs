//! Arguments of the command that shows results in a browser.

use std::path::PathBuf;

use clap::Args;

pub const REPORT: &str = "\
A result is the JSON that sweep, continue or backbone wrote. With its scene the page also has the plan, the response \
without contacts, and loops with the forces of the contact laws; without it, loops are drawn from the harmonics of the result. \
A scene that does not have these results is refused.

Examples:
  stickslip sweep blade.json -o response.json
  stickslip report response.json --scene blade.json -o report.html
  stickslip report one.json seven.json --scene blade.json -o compared.html   several results over one axis";

/// `stickslip report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Results to show over one axis, JSON
    #[arg(required = true, value_name = "RESULT")]
    pub results: Vec<PathBuf>,
    /// The scene of results, found by its name; may be given once for each scene
    #[arg(long, value_name = "SCENE")]
    pub scene: Vec<PathBuf>,
    /// Write the page to FILE, whole or not at all
    #[arg(short, long, value_name = "FILE.html")]
    pub output: PathBuf,
}
