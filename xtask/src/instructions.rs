//! `cargo xtask instructions`: how many instructions a point of each hot path takes, against committed counts.
//!
//! Times depend on what else a machine does, counts hardly on anything: the program runs itself under valgrind's callgrind
//! with n and with 2n passes over a path, and the difference is free of start and set-up. Counts belong to a compiler, a
//! valgrind and an instruction set; with others they are shown and not judged.

mod hot_path;

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::error_vs_runtime::rustc;
use crate::markdown::table;
use hot_path::HotPath;

/// What a user types.
const COMMAND: &str = "cargo xtask instructions";
/// The word before a path's name by which the program runs it.
pub(crate) const HOT_PATH: &str = "hot-path";
/// Relative change of a count that nobody has to explain.
const TOLERANCE: f64 = 0.05;

/// The committed counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Counts {
    /// What they belong to.
    machine: Identity,
    /// Instructions a point, by path.
    counts: BTreeMap<String, u64>,
}

/// Everything that changes counts without a change of the code.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Identity {
    rustc: String,
    valgrind: String,
    instructions: String,
}

/// How a count compares with the committed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Same,
    Slower,
    Faster,
    New,
}

/// Counts, and fails when one has changed; says so and does nothing where valgrind is missing.
pub(crate) fn check(root: &Path) -> Result<()> {
    let Some(found) = count()? else { return Ok(()) };
    let path = file(root);
    let text = fs::read_to_string(&path)
        .with_context(|| format!("{}; `{COMMAND} --accept` writes it", path.display()))?;
    let known: Counts = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    eprintln!("{}", show(&known, &found));
    if known.machine != found.machine {
        eprintln!(
            "not judged: the committed counts are those of {:?}, these of {:?}",
            known.machine, found.machine
        );
        return Ok(());
    }
    let changed: Vec<String> = judge(&known, &found)
        .into_iter()
        .filter(|(_, verdict)| *verdict != Verdict::Same)
        .map(|(name, verdict)| format!("{name} ({})", verdict.word()))
        .collect();
    ensure!(
        changed.is_empty(),
        "instructions changed by more than {:.0} %: {}. If that is meant, `{COMMAND} --accept` and commit {}",
        100.0 * TOLERANCE,
        changed.join(", "),
        path.display()
    );
    Ok(())
}

/// Counts, and writes them down.
pub(crate) fn accept(root: &Path) -> Result<()> {
    let found = count()?.context("there is nothing to accept without valgrind")?;
    let path = file(root);
    fs::write(&path, serde_json::to_string_pretty(&found)? + "\n")
        .with_context(|| path.display().to_string())?;
    eprintln!("{}", show(&found, &found));
    Ok(())
}

/// Runs a path; what valgrind is asked to count.
pub(crate) fn run_hot_path(root: &Path, name: &str, passes: &str) -> Result<()> {
    let path = HotPath::named(name).with_context(|| format!("there is no hot path {name:?}"))?;
    path.run(root, passes.parse().context("passes")?)
}

fn file(root: &Path) -> PathBuf {
    root.join("xtask").join("instructions.json")
}

/// All counts, or none without valgrind.
fn count() -> Result<Option<Counts>> {
    let Ok(version) = Command::new("valgrind").arg("--version").output() else {
        eprintln!("valgrind is missing, instructions are not counted; your system's packages have it");
        return Ok(None);
    };
    if cfg!(debug_assertions) {
        bail!("counts are those of a release build: `{COMMAND}`");
    }
    let machine = Identity {
        rustc: rustc(),
        valgrind: String::from_utf8_lossy(&version.stdout).trim().to_owned(),
        instructions: instruction_set(),
    };
    let mut counts = BTreeMap::new();
    for path in HotPath::all() {
        let [once, twice] = [path.passes, 2 * path.passes].map(|passes| run(path.name, passes));
        let (once, twice) = (once?, twice?);
        let passes = twice.saturating_sub(once);
        // Set-up is not the same to the last instruction from run to run, some of it has threads.
        ensure!(passes > once / 50, "{}: too few passes to tell them from the set-up", path.name);
        counts.insert(path.name.to_owned(), passes / (path.passes * hot_path::POINTS) as u64);
    }
    Ok(Some(Counts { machine, counts }))
}

/// Instructions of this program with so many passes over a path.
fn run(name: &str, passes: usize) -> Result<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env::current_exe()?)
        .args([HOT_PATH, name, &passes.to_string()])
        .output()?;
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "valgrind: {words}");
    collected(&words).with_context(|| format!("valgrind says nothing about instructions: {words}"))
}

/// The number in callgrind's line `==123== Collected : 4567`.
fn collected(words: &str) -> Option<u64> {
    let line = words.lines().find(|line| line.contains("Collected :"))?;
    line.rsplit(':').next()?.trim().parse().ok()
}

/// The architecture and those extensions that vectorised code is chosen by.
fn instruction_set() -> String {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        return "x86_64 with avx2 and fma".to_owned();
    }
    env::consts::ARCH.to_owned()
}

fn judge(known: &Counts, found: &Counts) -> Vec<(String, Verdict)> {
    let one = |(name, count): (&String, &u64)| {
        let verdict = match known.counts.get(name) {
            None => Verdict::New,
            Some(&before) if *count as f64 > (1.0 + TOLERANCE) * before as f64 => Verdict::Slower,
            Some(&before) if (*count as f64) < (1.0 - TOLERANCE) * before as f64 => Verdict::Faster,
            Some(_) => Verdict::Same,
        };
        (name.clone(), verdict)
    };
    found.counts.iter().map(one).collect()
}

fn show(known: &Counts, found: &Counts) -> String {
    let cells = |(name, count): (&String, &u64)| {
        let before = known.counts.get(name);
        let change = before.map(|before| 100.0 * (*count as f64 / *before as f64 - 1.0));
        [
            name.clone(),
            before.map_or("—".to_owned(), u64::to_string),
            count.to_string(),
            change.map_or("—".to_owned(), |change| format!("{change:+.1} %")),
        ]
    };
    let rows: Vec<_> = found.counts.iter().map(cells).collect();
    table(["instructions a point", "committed", "now", "change"], &rows)
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Self::Same => "the same",
            Self::Slower => "more",
            Self::Faster => "fewer",
            Self::New => "new",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_beyond_the_tolerance_are_found() {
        let machine = Identity { rustc: String::new(), valgrind: String::new(), instructions: String::new() };
        let counts = |all: &[(&str, u64)]| Counts {
            machine: machine.clone(),
            counts: all.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect(),
        };
        let known = counts(&[("a", 1000), ("b", 1000), ("c", 1000), ("gone", 1)]);
        let found = counts(&[("a", 1049), ("b", 1051), ("c", 949), ("d", 5)]);
        let verdicts: Vec<Verdict> = judge(&known, &found).into_iter().map(|(_, verdict)| verdict).collect();
        assert_eq!(verdicts, [Verdict::Same, Verdict::Slower, Verdict::Faster, Verdict::New]);
    }

    #[test]
    fn the_count_is_read() {
        let words = "==7== Events    : Ir\n==7== Collected : 123456\n==7==\n";
        assert_eq!(collected(words), Some(123_456));
        assert_eq!(collected("==7== nothing"), None);
    }

    #[test]
    fn every_hot_path_is_committed_and_runs() {
        let root = crate::root();
        let known: Counts = serde_json::from_str(&fs::read_to_string(file(&root)).unwrap()).unwrap();
        let names: Vec<&str> = known.counts.keys().map(String::as_str).collect();
        let mut all: Vec<&str> = HotPath::all().iter().map(|path| path.name).collect();
        all.sort_unstable();
        assert_eq!(names, all);
        HotPath::named("cubic, N = 7").unwrap().run(&root, 1).unwrap();
    }
}
