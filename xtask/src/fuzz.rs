//! `cargo xtask fuzz`: coverage-guided fuzzing of the files that users write, for a bounded time.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// One target a kind of file.
const TARGETS: [&str; 4] = ["scene", "record", "matrix", "study"];

/// Seconds a target when none are named.
const SECONDS: u64 = 60;

/// An input may take this long, in s.
const SLOWEST: &str = "-timeout=20";

/// Runs every target for `seconds`. What is found stays in `fuzz/artifacts`, new inputs in `target/fuzz-corpus`.
pub(crate) fn run(root: &Path, seconds: &[&str]) -> Result<()> {
    let seconds: u64 = match seconds {
        [] => SECONDS,
        [seconds] => seconds.parse().context("a number of seconds a target")?,
        _ => bail!("one number: seconds a target"),
    };
    for target in TARGETS {
        let grown = root.join("target").join("fuzz-corpus").join(target);
        fs::create_dir_all(&grown).with_context(|| grown.display().to_string())?;
        // The compiler that runs this is stable; the sanitizer needs a nightly one.
        let mut command = Command::new("cargo");
        for variable in ["CARGO", "RUSTC", "RUSTUP_TOOLCHAIN"] {
            command.env_remove(variable);
        }
        command.current_dir(root).args(["+nightly", "fuzz", "run", target]);
        command.arg(&grown).arg(root.join("fuzz").join("corpus").join(target));
        command.args(["--", &format!("-max_total_time={seconds}"), SLOWEST, "-max_len=8192"]);
        let status = command.status().context("cargo +nightly fuzz")?;
        ensure!(
            status.success(),
            "the target {target} failed; the input is in fuzz/artifacts/{target} (needed: a nightly compiler, `cargo \
             install cargo-fuzz`)"
        );
    }
    Ok(())
}
