//! `cargo xtask ci`: every check of a change, in the order in which they fail fastest.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs};

use anyhow::{Context, Result, ensure};

use crate::{
    deny, dist, equations, error_vs_runtime, extreme, figures, instructions, iwan, loop_family, msrv,
    package, python, reference_loop, report_page,
};

/// Commands of cargo before documentation and tests.
const CHECKS: [&str; 3] = [
    "fmt --all -- --check",
    "clippy --workspace --all-targets -- -D warnings",
    "check -p stickslip --no-default-features",
];

/// The README's commands.
const TESTS: &str = "test --workspace";
const EXAMPLE: &str = "run --release -- sweep scenes/hoffmann-2017.json";

/// Runs all checks in the workspace at `root`; the first that fails ends the run.
pub(crate) fn run(root: &Path) -> Result<()> {
    let mut steps = Steps::default();
    says_so(root)?;
    // Before anything is built: the page is part of the program.
    steps.take("cargo xtask report-page", || report_page::bundle(root, false).map(|_| ()))?;
    steps.take("cargo xtask package", || package::run(root, &[]))?;
    steps.take("cargo xtask deny", || deny::run(root))?;
    steps.take("cargo xtask reference-loop --check", || reference_loop::check(root))?;
    steps.take("cargo xtask iwan --check", || iwan::check(root))?;
    steps.take("cargo xtask loop-family --check", || loop_family::check(root))?;
    for arguments in CHECKS {
        steps.cargo(root, arguments, Stdio::inherit())?;
    }
    steps.take("cargo xtask doc", || equations::document(root))?;
    steps.take("cargo xtask msrv", || msrv::run(root))?;
    steps.cargo(root, TESTS, Stdio::inherit())?;
    example(root, &mut steps)?;
    steps.take("cargo xtask report-page --test", || report_page::test(root))?;
    // What goes into a release, around the program of the example.
    steps.take("cargo xtask dist --quick", || dist::run(root, &["--quick"]))?;
    // The paper's scenes, figures and numbers once more.
    steps.take("cargo xtask figures --check", || figures::check(root))?;
    // Errors and their orders on a small part of the scene library, never times.
    steps.take("cargo xtask error-vs-runtime --quick", || error_vs_runtime::quick(root))?;
    // Cases at the limits of every quantity.
    steps.take("cargo xtask extreme --quick", || extreme::run(root, &["--quick"]))?;
    // Instructions a point of the hot paths; says so and passes where valgrind is missing.
    steps.take("cargo xtask instructions", || instructions::check(root))?;
    steps.take("cargo xtask python", || python::run(root, false))?;
    steps.tell();
    Ok(())
}

/// What the README tells its readers to type is what is checked here.
fn says_so(root: &Path) -> Result<()> {
    let readme = fs::read_to_string(root.join("README.md")).context("README.md")?;
    for arguments in [TESTS, EXAMPLE] {
        ensure!(readme.contains(&format!("cargo {arguments}")), "README.md does not say `cargo {arguments}`");
    }
    Ok(())
}

/// The README's first command; its result goes to a file under `target` and must not be empty.
fn example(root: &Path, steps: &mut Steps) -> Result<()> {
    let result = root.join("target").join("ci-example.out");
    let file = fs::File::create(&result).with_context(|| result.display().to_string())?;
    steps.cargo(root, EXAMPLE, file.into())?;
    let size = fs::metadata(&result)?.len();
    ensure!(size > 0, "`cargo {EXAMPLE}` printed nothing");
    Ok(())
}

/// What was done, and how long it took.
#[derive(Default)]
struct Steps {
    taken: Vec<(String, Duration)>,
}

impl Steps {
    fn take(&mut self, what: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
        eprintln!("\n==> {what}");
        let start = Instant::now();
        work()?;
        self.taken.push((what.to_owned(), start.elapsed()));
        Ok(())
    }

    fn cargo(&mut self, root: &Path, arguments: &str, output: Stdio) -> Result<()> {
        let shown = format!("cargo {arguments}");
        self.take(&shown, || {
            let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
            let mut command = Command::new(program);
            command.current_dir(root).args(arguments.split(' ')).stdout(output);
            let status = command.status().with_context(|| shown.clone())?;
            ensure!(status.success(), "`{shown}` failed");
            Ok(())
        })
    }

    /// Where the time went.
    fn tell(&self) {
        let total: Duration = self.taken.iter().map(|(_, took)| *took).sum();
        eprintln!("\n==> all checks passed in {:.0} s", total.as_secs_f64());
        for (what, took) in &self.taken {
            eprintln!("{:6.0} s  {what}", took.as_secs_f64());
        }
    }
}
