//! `cargo xtask ci`: every check of a change, in the order in which they fail fastest.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
use std::{env, fs};

use anyhow::{Context, Result, ensure};

use crate::{deny, dist, iwan, loop_family, msrv, package, python, reference_loop};

/// Commands of cargo before the tests, with their environment.
const CHECKS: [(&str, Option<(&str, &str)>); 4] = [
    ("fmt --all -- --check", None),
    ("clippy --workspace --all-targets -- -D warnings", None),
    ("check -p stickslip --no-default-features", None),
    ("doc --workspace --no-deps", Some(("RUSTDOCFLAGS", "-Dwarnings"))),
];

/// The README's commands.
const TESTS: &str = "test --workspace";
const EXAMPLE: &str = "run --release -- sweep scenes/hoffmann-2017.json";

/// The paper's scenes, figures and numbers once more, in release: the libraries are built for the example already.
const FIGURES: &str = "run --release -p xtask -- figures --check";
/// Errors and their orders on a small part of the scene library, never times.
const ERRORS: &str = "run --release -p xtask -- error-vs-runtime --quick";

/// Cases at the limits of every quantity.
const EXTREME: &str = "run --release -p xtask -- extreme --quick";

/// Instructions a point of the hot paths; says so and passes where valgrind is missing.
const INSTRUCTIONS: &str = "run --release -p xtask -- instructions";

/// Runs all checks in the workspace at `root`; the first that fails ends the run.
pub(crate) fn run(root: &Path) -> Result<()> {
    let start = Instant::now();
    says_so(root)?;
    step("cargo xtask package");
    package::run(root, &[])?;
    step("cargo xtask deny");
    deny::run(root)?;
    step("cargo xtask reference-loop --check");
    reference_loop::check(root)?;
    step("cargo xtask iwan --check");
    iwan::check(root)?;
    step("cargo xtask loop-family --check");
    loop_family::check(root)?;
    for (arguments, variable) in CHECKS {
        cargo(root, arguments, variable, Stdio::inherit())?;
    }
    step("cargo xtask msrv");
    msrv::run(root)?;
    cargo(root, TESTS, None, Stdio::inherit())?;
    example(root)?;
    step("cargo xtask dist --quick");
    dist::run(root, &["--quick"])?;
    cargo(root, FIGURES, None, Stdio::inherit())?;
    cargo(root, ERRORS, None, Stdio::inherit())?;
    cargo(root, EXTREME, None, Stdio::inherit())?;
    cargo(root, INSTRUCTIONS, None, Stdio::inherit())?;
    step("cargo xtask python");
    python::run(root, false)?;
    step(&format!("all checks passed in {:.0} s", start.elapsed().as_secs_f64()));
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
fn example(root: &Path) -> Result<()> {
    let result = root.join("target").join("ci-example.out");
    let file = fs::File::create(&result).with_context(|| result.display().to_string())?;
    cargo(root, EXAMPLE, None, file.into())?;
    let size = fs::metadata(&result)?.len();
    ensure!(size > 0, "`cargo {EXAMPLE}` printed nothing");
    Ok(())
}

fn cargo(root: &Path, arguments: &str, variable: Option<(&str, &str)>, output: Stdio) -> Result<()> {
    let shown = variable.map_or(String::new(), |(name, value)| format!("{name}={value} "));
    step(&format!("{shown}cargo {arguments}"));
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.current_dir(root).args(arguments.split(' ')).stdout(output);
    if let Some((name, value)) = variable {
        command.env(name, value);
    }
    let status = command.status().with_context(|| format!("cargo {arguments}"))?;
    ensure!(status.success(), "`{shown}cargo {arguments}` failed");
    Ok(())
}

fn step(what: &str) {
    eprintln!("\n==> {what}");
}
