//! `cargo xtask report-page`: bundles the page of `stickslip report`, and tests it in a browser.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::packages::cargo;

/// The oldest Node.js that will do.
const NODE: u32 = 20;

/// Browsers, the first that is there is taken; the environment variable `CHROMIUM` names another.
const BROWSERS: [&str; 3] = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/// Bundles the page into `crates/report/page/dist`. Where Node.js or its packages cannot be had it says so, and with `required`
/// fails. Returns whether the page is there.
///
/// # Errors
/// What failed.
pub(crate) fn bundle(root: &Path, required: bool) -> Result<bool> {
    match ready(root)? {
        Some(missing) if required => bail!("{missing}"),
        Some(missing) => {
            eprintln!("skipped: {missing}");
            Ok(false)
        }
        None => {
            npm(root, &["run", "--silent", "check"])?;
            npm(root, &["run", "--silent", "build"])?;
            Ok(true)
        }
    }
}

/// Tests the page in a browser, with the reports of the release build, or of the program that `STICKSLIP` names.
///
/// # Errors
/// What failed.
pub(crate) fn test(root: &Path) -> Result<()> {
    if !bundle(root, false)? {
        return Ok(());
    }
    let Some(browser) = browser() else {
        eprintln!("skipped: there is no Chromium, and it cannot be installed here");
        return Ok(());
    };
    let program = match env::var_os("STICKSLIP") {
        Some(program) => std::path::absolute(program)?,
        None => built(root)?,
    };
    let status = Command::new(NPM)
        .args(["run", "--silent", "test"])
        .current_dir(page(root))
        .env("STICKSLIP", program)
        .env("CHROMIUM", browser)
        .status()
        .context("npm")?;
    ensure!(status.success(), "tests of the report page fail");
    Ok(())
}

/// The release build.
fn built(root: &Path) -> Result<PathBuf> {
    let status =
        Command::new(cargo()).args(["build", "--release", "-p", "stickslip"]).current_dir(root).status()?;
    ensure!(status.success(), "stickslip cannot be built");
    let target =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    Ok(target.join("release").join(format!("stickslip{}", env::consts::EXE_SUFFIX)))
}

const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

fn page(root: &Path) -> PathBuf {
    root.join("crates").join("report").join("page")
}

/// Installs the packages of the lock file, unless they are there; says what is missing.
fn ready(root: &Path) -> Result<Option<String>> {
    let version = Command::new("node").arg("--version").output();
    let text = version.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let major = text.trim().strip_prefix('v').and_then(|text| text.split('.').next()?.parse::<u32>().ok());
    match major {
        None => return Ok(Some(format!("the report page needs Node.js {NODE} or later"))),
        Some(major) if major < NODE => {
            return Ok(Some(format!("the report page needs Node.js {NODE} or later, got {}", text.trim())));
        }
        Some(_) => {}
    }
    if !quiet(Command::new(NPM).arg("--version")) {
        return Ok(Some("the report page needs npm".into()));
    }
    let lock = fs::read_to_string(page(root).join("package-lock.json")).context("package-lock.json")?;
    let stamp = page(root).join("node_modules").join(".installed-lock.json");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(None);
    }
    // A registry that cannot be reached is no mistake of the page; packages that do not fit the lock file are.
    if !quiet(Command::new(NPM).arg("ping").current_dir(page(root))) {
        return Ok(Some("the report page needs a package registry that npm can reach".into()));
    }
    npm(root, &["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"])?;
    fs::write(stamp, lock)?;
    Ok(None)
}

fn npm(root: &Path, arguments: &[&str]) -> Result<()> {
    let status = Command::new(NPM).args(arguments).current_dir(page(root)).status().context("npm")?;
    ensure!(status.success(), "`npm {}` fails in crates/report/page", arguments.join(" "));
    Ok(())
}

/// A Chromium; installed where the system lets us.
fn browser() -> Option<PathBuf> {
    let known = || {
        let named = env::var_os("CHROMIUM").map(PathBuf::from);
        named.into_iter().chain(BROWSERS.map(PathBuf::from)).find(|path| path.exists())
    };
    known().or_else(|| {
        eprintln!("installing chromium");
        let install = ["install", "-y", "-qq", "--no-install-recommends", "chromium"];
        // Only the administrator may; for anybody else this fails at once.
        let done = quiet(Command::new("apt-get").args(["update", "-qq"]))
            && quiet(Command::new("apt-get").args(install).env("DEBIAN_FRONTEND", "noninteractive"));
        if done { known() } else { None }
    })
}

/// Whether a command that says nothing succeeds.
fn quiet(command: &mut Command) -> bool {
    let run = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    run.is_ok_and(|status| status.success())
}
