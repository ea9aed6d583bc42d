//! Embeds the page that `cargo xtask report-page` bundles, where it is there.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let page = Path::new("page").join("dist").join("page.html");
    println!("cargo:rerun-if-changed=build.rs");
    // Also while it is missing: cargo looks again as soon as it appears.
    println!("cargo:rerun-if-changed={}", page.display());
    let text = match fs::read(&page) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error),
    };
    let out = env::var_os("OUT_DIR").map(PathBuf::from).ok_or_else(|| io::Error::other("no OUT_DIR"))?;
    fs::write(out.join("page.html"), text)
}
