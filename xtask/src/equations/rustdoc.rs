//! The pages of rustdoc: equations in their HTML are drawn after `cargo doc` has written it.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result, ensure};

use super::mathml::{Place, mathml};

/// What rustdoc makes of an equation in a line and of a code block `math`.
const FORMS: [(&str, &str, Place); 2] = [
    ("$<code>", "</code>$", Place::Line),
    ("<div class=\"example-wrap\"><pre class=\"language-math\"><code>", "</code></pre></div>", Place::Block),
];

/// `cargo xtask doc`: the documentation of all crates of the workspace at `root`, equations drawn; a warning is an error.
pub(crate) fn document(root: &Path) -> Result<()> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root).args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-Dwarnings");
    let status = command.status().context("cargo doc")?;
    ensure!(status.success(), "`RUSTDOCFLAGS=-Dwarnings cargo doc --workspace --no-deps` failed");
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), Into::into);
    folder(&target.join("doc"))
}

/// Draws the equations of every page in a folder and below; pages without any are not written.
fn folder(path: &Path) -> Result<()> {
    for entry in fs::read_dir(path).with_context(|| path.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            folder(&path)?;
        } else if path.extension().is_some_and(|extension| extension == "html") {
            let page = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            let drawn = drawn(&page).with_context(|| path.display().to_string())?;
            if drawn != page {
                fs::write(&path, drawn).with_context(|| path.display().to_string())?;
            }
        }
    }
    Ok(())
}

/// A page with its equations as MathML.
fn drawn(html: &str) -> Result<String> {
    let mut page = html.to_owned();
    for (open, close, place) in FORMS {
        let mut rest = page.as_str();
        let mut next = String::with_capacity(rest.len());
        while let Some((before, from)) = rest.split_once(open) {
            next.push_str(before);
            match from.split_once(close) {
                Some((latex, after)) if !latex.contains('<') => {
                    next.push_str(&mathml(&plain(latex), place)?);
                    rest = after;
                }
                // A dollar beside other code.
                _ => {
                    next.push_str(open);
                    rest = from;
                }
            }
        }
        next.push_str(rest);
        page = next;
    }
    Ok(page)
}

/// Text of HTML as it was written.
fn plain(html: &str) -> String {
    let text = html.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&#39;", "'");
    text.replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::drawn;

    #[test]
    fn equations_of_a_page_are_drawn_and_nothing_else() {
        let page = "<p>Let $<code>a &amp;lt b</code>$, costs $5, <code>$x</code>$ and <code>c</code>.</p>";
        assert_eq!(drawn(&page.replace("&amp;lt", "&lt;")).unwrap().matches("<math").count(), 1);
        let block = "<div class=\"example-wrap\"><pre class=\"language-math\"><code>a &amp;= b \\tag{4}</code></pre></div>";
        let block = block.replace("&amp;", "");
        let after = drawn(&block).unwrap();
        assert!(
            after.starts_with("<span class=\"equation\"") && after.ends_with("(4)</span></span>"),
            "{after}"
        );
        for untouched in ["<p>$5 and <code>$HOME</code></p>", "$<code>a<b>b</b></code>$", "$<code>open"] {
            assert_eq!(drawn(untouched).unwrap(), untouched);
        }
        assert!(drawn("$<code>\\nosuch</code>$").is_err());
    }
}
