//! `cargo xtask package`: every published crate can be packaged, and is whole: nothing it includes lies outside its folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::packages::{Package, Packages, cargo};
use crate::report_page;

/// What every crate says about itself, and the licences it carries.
const LICENCES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// Packages the crates into `target/package`; with `--verify` also builds each from its package, as the registry's users will.
///
/// # Errors
/// What cannot be packaged, or is missing in a package.
pub(crate) fn run(root: &Path, words: &[&str]) -> Result<()> {
    let verify = match words {
        [] => false,
        ["--verify"] => true,
        _ => bail!("usage: cargo xtask package [--verify]"),
    };
    if verify {
        // For a release; without it the command `report` of the published program refuses.
        report_page::bundle(root, true)?;
    }
    let packages = Packages::read(root, None)?;
    let published: Vec<&Package> = packages.ours().filter(|package| package.is_published()).collect();
    let mut command = Command::new(cargo());
    command.current_dir(root).args(["package", "--quiet", "--locked", "--offline", "--allow-dirty"]);
    if !verify {
        command.arg("--no-verify");
    }
    for package in &published {
        command.args(["--package", &package.name]);
    }
    // Warnings say that tests are left out, and that there is no homepage.
    let output = command.output().context("cargo package")?;
    ensure!(output.status.success(), "cargo package: {}", String::from_utf8_lossy(&output.stderr));
    for package in &published {
        whole(root, package).with_context(|| format!("the package of {}", package.name))?;
        eprintln!("{} {} is whole", package.name, package.version);
    }
    Ok(())
}

/// What is in the package is enough for what its sources include.
fn whole(root: &Path, package: &Package) -> Result<()> {
    let output = Command::new(cargo())
        .current_dir(root)
        .args(["package", "--list", "--offline", "--allow-dirty", "--package", &package.name])
        .output()
        .context("cargo package --list")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let list = String::from_utf8(output.stdout)?;
    let files: Vec<&str> = list.lines().collect();
    for licence in LICENCES {
        ensure!(files.contains(&licence), "{licence} is not in it");
        let text = fs::read_to_string(package.folder().join(licence))?;
        ensure!(
            text == fs::read_to_string(root.join(licence))?,
            "its {licence} is not the repository's; it should be a link to it"
        );
    }
    for file in files.iter().filter(|file| file.ends_with(".rs")) {
        let source = package.folder().join(file);
        // Cargo.lock and the like are made while packaging; sources are not.
        let text = fs::read_to_string(&source).with_context(|| source.display().to_string())?;
        for included in inclusions(&text) {
            let wanted = beside(Path::new(file), included);
            let found =
                wanted.as_ref().is_some_and(|wanted| files.iter().any(|file| Path::new(file) == wanted));
            ensure!(found, "{file} includes {included}, which is not in it");
        }
    }
    Ok(())
}

/// The files that `include_str!` and `include_bytes!` name.
fn inclusions(text: &str) -> impl Iterator<Item = &str> {
    ["include_str!(\"", "include_bytes!(\""]
        .into_iter()
        .flat_map(|word| text.split(word).skip(1))
        .filter_map(|rest| rest.split('"').next())
}

/// A path relative to a file's folder, in the same package; none where it leads out of it.
fn beside(file: &Path, path: &str) -> Option<PathBuf> {
    let mut found = file.parent()?.to_owned();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." if !found.pop() => return None,
            ".." => {}
            name => found.push(name),
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::{beside, inclusions};

    #[test]
    fn what_a_source_includes_is_found() {
        let text = "const A: &str = include_str!(\"a.json\"); f(include_bytes!(\"../b/c.bin\"))";
        assert_eq!(inclusions(text).collect::<Vec<_>>(), ["a.json", "../b/c.bin"]);
        let file = Path::new("src/init.rs");
        assert_eq!(beside(file, "init/a.json"), Some(PathBuf::from("src/init/a.json")));
        assert_eq!(beside(file, "../page/x"), Some(PathBuf::from("page/x")));
        assert_eq!(beside(file, "../../scenes/a.json"), None);
    }
}
