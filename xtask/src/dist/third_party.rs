//! THIRD-PARTY.md: the crates of others in the binary and the wheel, with their licences in full.

use std::collections::BTreeMap;
use std::fs;

use anyhow::{Context, Result};

use crate::packages::{Package, Packages};

/// Names of files with a licence or a notice begin so.
const BEGINNINGS: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// The text of the file, for what `names` of the workspace link.
///
/// # Errors
/// A crate without a licence, or sources that cannot be read.
pub(crate) fn page(packages: &Packages, names: &[&str]) -> Result<String> {
    let linked: Vec<&Package> =
        packages.needed(names, false).into_iter().filter(|package| !package.is_ours()).collect();
    let mut page = format!(
        "# Software of others\n\nThe program and the Python package contain these {} crates. The texts of their licences follow.\n\n\
         | crate | version | licence |\n|---|---|---|\n",
        linked.len()
    );
    // Many crates carry the same text.
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut silent = Vec::new();
    for package in &linked {
        let Package { name, version, .. } = package;
        let licence =
            package.license.as_deref().with_context(|| format!("{name} {version} names no licence"))?;
        page.push_str(&format!("| {name} | {version} | {licence} |\n"));
        let found = licences(package)?;
        if found.is_empty() {
            silent.push(format!("{name} {version}"));
        }
        for text in found {
            texts.entry(text).or_default().push(format!("{name} {version}"));
        }
    }
    if !silent.is_empty() {
        page.push_str(&format!(
            "\nTheir sources hold no text beside the name of the licence: {}.\n",
            silent.join(", ")
        ));
    }
    let mut texts: Vec<(Vec<String>, String)> =
        texts.into_iter().map(|(text, crates)| (crates, text)).collect();
    texts.sort();
    for (crates, text) in texts {
        page.push_str(&format!("\n## {}\n\n````text\n{text}\n````\n", crates.join(", ")));
    }
    Ok(page)
}

/// The licences and notices in a crate's sources, without blank ends.
fn licences(package: &Package) -> Result<Vec<String>> {
    let folder = package.folder();
    let mut names: Vec<_> = fs::read_dir(folder)
        .with_context(|| folder.display().to_string())?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
            path.is_file() && BEGINNINGS.iter().any(|beginning| name.starts_with(beginning))
        })
        .collect();
    names.sort();
    let text = |path| -> Result<String> {
        let bytes = fs::read(path)?;
        let text = String::from_utf8_lossy(&bytes).replace("\r\n", "\n");
        let lines: Vec<&str> = text.trim_end().lines().map(str::trim_end).collect();
        Ok(lines.join("\n"))
    };
    names.iter().map(text).collect()
}
