//! `cargo xtask dist`: what a release consists of, in `target/dist`.
//!
//! A folder `stickslip-VERSION-TARGET` with the program, its manual pages and completions, the wheel, the schemas and the licences;
//! the same as `.tar.gz`, and the SHA-256 sums.

mod archive;
mod third_party;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, Result, bail, ensure};

use crate::packages::{Packages, cargo};
use crate::{python, report_page};

/// Files of the repository that are part of it.
const FILES: [&str; 5] = ["README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE-MIT", "LICENSE-APACHE"];

/// Shells and the names their completions go by.
const COMPLETIONS: [(&str, &str); 5] = [
    ("bash", "stickslip.bash"),
    ("zsh", "_stickslip"),
    ("fish", "stickslip.fish"),
    ("powershell", "_stickslip.ps1"),
    ("elvish", "stickslip.elv"),
];

/// The release.
///
/// # Errors
/// What cannot be built, or does not run.
pub(crate) fn run(root: &Path, words: &[&str]) -> Result<()> {
    // (profile of cargo, its folder, with a wheel)
    let (profile, folder, wheel) = match words {
        [] => ("dist", "dist", true),
        ["--without-wheel"] => ("dist", "dist", false),
        // The release build is there in `cargo xtask ci`; a program without debug information takes minutes more.
        ["--quick"] => ("release", "release", false),
        _ => bail!("usage: cargo xtask dist [--without-wheel | --quick]"),
    };
    let target = target()?;
    let name = format!("stickslip-{}-{target}", env!("CARGO_PKG_VERSION"));
    let place = root.join("target").join("dist").join(if profile == "dist" { "" } else { "quick" });
    let tree = place.join(&name);
    if tree.exists() {
        fs::remove_dir_all(&tree).with_context(|| tree.display().to_string())?;
    }
    fs::create_dir_all(&tree)?;

    // The page of `stickslip report` is part of the program; it has the licences of what it is bundled from in it.
    report_page::bundle(root, profile == "dist")?;
    build(root, profile)?;
    let suffix = std::env::consts::EXE_SUFFIX;
    let program = tree.join(format!("stickslip{suffix}"));
    fs::copy(root.join("target").join(folder).join(format!("stickslip{suffix}")), &program)?;
    for file in FILES {
        fs::copy(root.join(file), tree.join(file)).with_context(|| file.to_owned())?;
    }
    let packages = Packages::read(root, Some(&target))?;
    fs::write(
        tree.join("THIRD-PARTY.md"),
        third_party::page(&packages, &["stickslip", "stickslip-python"])?,
    )?;
    says(&program, &tree, &["man", "--all", "man"])?;
    fs::create_dir_all(tree.join("completions"))?;
    for (shell, file) in COMPLETIONS {
        let text = says(&program, &tree, &["completions", shell])?.stdout;
        fs::write(tree.join("completions").join(file), text)?;
    }
    for schema in ["scene", "study"] {
        let text = says(&program, &tree, &["schema", schema])?.stdout;
        fs::write(tree.join(format!("{schema}.schema.json")), text)?;
    }
    let mut published = Vec::new();
    if wheel {
        let built = python::wheel(root, &flags(root))?;
        let file = built.file_name().context("a wheel without a name")?;
        fs::create_dir_all(tree.join("python"))?;
        fs::copy(&built, tree.join("python").join(file))?;
        fs::copy(&built, place.join(file))?;
        published.push(file.to_string_lossy().into_owned());
    }

    let archive = format!("{name}.tar.gz");
    archive::pack(&tree, &place.join(&archive), time(root))?;
    published.push(archive.clone());
    published.sort();
    let mut sums = String::new();
    for file in &published {
        sums.push_str(&format!("{}  {file}\n", archive::sha256(&place.join(file))?));
    }
    fs::write(place.join("SHA256SUMS"), &sums)?;
    tried(&place.join(&archive), &name)?;
    eprint!("in {}:\n{sums}", place.display());
    Ok(())
}

/// The system it is built for, which is the one it is built on.
fn target() -> Result<String> {
    let output = Command::new("rustc").arg("-vV").output().context("rustc")?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc does not say what it builds for")?.to_owned())
}

/// Flags of the compiler for a release: the folders of this machine are not in what it builds, and the same sources give the same
/// program elsewhere.
fn flags(root: &Path) -> String {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(std::env::home_dir()?.join(".cargo")));
    let mut flags = vec![format!("--remap-path-prefix={}=stickslip", root.display())];
    flags.extend(home.map(|home| format!("--remap-path-prefix={}=cargo", home.display())));
    flags.join("\u{1f}")
}

/// Builds the program.
fn build(root: &Path, profile: &str) -> Result<()> {
    let mut command = Command::new(cargo());
    command.current_dir(root).args(["build", "--locked", "--package", "stickslip", "--profile", profile]);
    if profile == "dist" {
        command.env("CARGO_ENCODED_RUSTFLAGS", flags(root)).env_remove("RUSTFLAGS");
    }
    let built = command.status().context("cargo build")?;
    ensure!(built.success(), "the program cannot be built");
    Ok(())
}

/// What the program answers.
fn says(program: &Path, folder: &Path, arguments: &[&str]) -> Result<Output> {
    let output = Command::new(program).args(arguments).current_dir(folder).output();
    let output = output.with_context(|| program.display().to_string())?;
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "stickslip {} fails: {words}", arguments.join(" "));
    Ok(output)
}

/// Seconds since 1970 of all files: `SOURCE_DATE_EPOCH`, else the commit's, else 0.
fn time(root: &Path) -> u64 {
    let seconds = |text: String| text.trim().parse().ok();
    let commit = || {
        let output =
            Command::new("git").current_dir(root).args(["log", "-1", "--format=%ct"]).output().ok()?;
        seconds(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    std::env::var("SOURCE_DATE_EPOCH").ok().and_then(seconds).or_else(commit).unwrap_or(0)
}

/// What was packed is unpacked somewhere else: everything is there, and the program runs.
fn tried(archive: &Path, name: &str) -> Result<()> {
    let elsewhere = tempfile::tempdir()?;
    archive::unpack(archive, elsewhere.path())?;
    let tree = elsewhere.path().join(name);
    let pages =
        ["man/stickslip.1", "man/stickslip-loop-fit.1", "completions/_stickslip", "scene.schema.json"];
    for file in FILES.iter().chain(&pages).chain(&["THIRD-PARTY.md"]) {
        let size =
            fs::metadata(tree.join(file)).with_context(|| format!("{file} is not in the archive"))?.len();
        ensure!(size > 0, "{file} in the archive is empty");
    }
    let program = tree.join(format!("stickslip{}", std::env::consts::EXE_SUFFIX));
    let version = String::from_utf8(says(&program, &tree, &["--version"])?.stdout)?;
    ensure!(
        version.trim() == concat!("stickslip ", env!("CARGO_PKG_VERSION")),
        "the program says {version:?}"
    );
    says(&program, elsewhere.path(), &["init", "cubic"])?;
    says(&program, elsewhere.path(), &["sweep", "cubic.json", "--frequencies", "2,3"])?;
    Ok(())
}
