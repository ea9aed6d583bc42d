//! The page `docs/src/reproduction.md`: its words stand in `page.md`, its numbers come from the computation.

use anyhow::{Result, ensure};

/// The page's words, with `{{name}}` where a table goes.
const WORDS: &str = include_str!("page.md");

/// The page with its tables; fails when a place is left or has none.
pub(crate) fn page(tables: &[(&str, String)]) -> Result<String> {
    let mut text = WORDS.to_owned();
    for (name, table) in tables {
        let place = format!("{{{{{name}}}}}");
        ensure!(text.contains(&place), "page.md has no place for {name}");
        text = text.replace(&place, table.trim_end());
    }
    ensure!(!text.contains("{{"), "page.md has a place that nothing fills");
    Ok(text)
}
