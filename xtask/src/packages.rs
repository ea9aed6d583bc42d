//! What `cargo metadata` says about the packages of the workspace and all they stand on.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

/// One package.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub(crate) struct Package {
    pub name: String,
    pub version: String,
    pub license: Option<String>,
    /// The oldest compiler it declares.
    pub rust_version: Option<String>,
    id: String,
    /// Where it comes from; none for a member of the workspace.
    source: Option<String>,
    manifest_path: PathBuf,
    /// Registries it may be published to; none means any, an empty list nowhere.
    publish: Option<Vec<String>>,
}

impl Package {
    /// A member of this workspace.
    pub(crate) fn is_ours(&self) -> bool {
        self.source.is_none()
    }

    /// A library or program that is published.
    pub(crate) fn is_published(&self) -> bool {
        self.is_ours() && self.publish.as_ref().is_none_or(|registries| !registries.is_empty())
    }

    /// The folder of its sources.
    pub(crate) fn folder(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(Path::new(""))
    }
}

/// All packages, and which needs which.
#[derive(Debug)]
pub(crate) struct Packages {
    by_id: BTreeMap<String, Package>,
    needs: BTreeMap<String, Vec<Need>>,
}

#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    resolve: Resolve,
}

#[derive(Debug, Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Debug, Deserialize)]
struct Node {
    id: String,
    deps: Vec<Need>,
}

#[derive(Debug, Deserialize)]
struct Need {
    pkg: String,
    dep_kinds: Vec<DepKind>,
}

#[derive(Debug, Deserialize)]
struct DepKind {
    /// None is linked; else `build` or `dev`.
    kind: Option<String>,
}

impl Packages {
    /// Asks cargo; `filter` is a target triple, for what is linked on one system alone.
    ///
    /// # Errors
    /// When cargo refuses, for example because Cargo.lock is not that of the manifests.
    pub(crate) fn read(root: &Path, filter: Option<&str>) -> Result<Self> {
        let mut command = Command::new(cargo());
        command.current_dir(root).args(["metadata", "--format-version", "1", "--locked"]);
        if let Some(triple) = filter {
            command.args(["--filter-platform", triple]);
        }
        let output = command.output().context("cargo metadata")?;
        ensure!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
        let metadata: Metadata = serde_json::from_slice(&output.stdout).context("cargo metadata")?;
        Ok(Self {
            by_id: metadata.packages.into_iter().map(|package| (package.id.clone(), package)).collect(),
            needs: metadata.resolve.nodes.into_iter().map(|node| (node.id, node.deps)).collect(),
        })
    }

    /// The members of the workspace.
    pub(crate) fn ours(&self) -> impl Iterator<Item = &Package> {
        self.by_id.values().filter(|package| package.is_ours())
    }

    /// Everything that `names` of the workspace need, themselves included: what is linked, and with `building` what runs while
    /// they are built. In alphabetical order.
    pub(crate) fn needed(&self, names: &[&str], building: bool) -> BTreeSet<&Package> {
        let mut found = BTreeSet::new();
        let mut waiting: Vec<&str> =
            self.ours().filter(|p| names.contains(&p.name.as_str())).map(|p| p.id.as_str()).collect();
        while let Some(id) = waiting.pop() {
            let Some(package) = self.by_id.get(id) else { continue };
            if !found.insert(package) {
                continue;
            }
            let counts = |kind: &DepKind| match kind.kind.as_deref() {
                None => true,
                Some(kind) => building && kind == "build",
            };
            let needs = self.needs.get(id).into_iter().flatten();
            waiting
                .extend(needs.filter(|need| need.dep_kinds.iter().any(counts)).map(|need| need.pkg.as_str()));
        }
        found
    }
}

/// The cargo that runs this.
pub(crate) fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}
