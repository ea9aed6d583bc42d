//! The book: a preprocessor of mdBook, which hands all chapters over as JSON and takes them back with equations drawn.

use std::io;

use anyhow::{Context, Result, bail, ensure};
use pulldown_cmark::{Event, Options, Parser};
use serde_json::Value;

use super::mathml::{Place, mathml};

/// `cargo xtask equations`: reads `[context, book]` from standard input, writes the book to standard output.
pub(crate) fn preprocess() -> Result<()> {
    let input: Value = serde_json::from_reader(io::stdin().lock())
        .context("mdBook calls this command and hands the book over (`mdbook build docs`)")?;
    let Value::Array(mut parts) = input else { bail!("expected a list of context and book") };
    ensure!(parts.len() == 2, "expected context and book, got {} parts", parts.len());
    let Some(mut book) = parts.pop() else { bail!("expected a book") };
    chapters(&mut book)?;
    serde_json::to_writer(io::stdout().lock(), &book)?;
    Ok(())
}

/// Draws the equations of every chapter, wherever chapters are in the book.
fn chapters(part: &mut Value) -> Result<()> {
    match part {
        Value::Array(items) => items.iter_mut().try_for_each(chapters),
        Value::Object(object) => {
            let name = object.get("name").and_then(Value::as_str).unwrap_or("a page").to_owned();
            for (key, value) in object {
                match value {
                    Value::String(text) if key == "content" => *text = drawn(text).context(name.clone())?,
                    value => chapters(value)?,
                }
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

/// A page with its equations as MathML; all else, code among it, as it was.
pub(crate) fn drawn(markdown: &str) -> Result<String> {
    let options = Options::ENABLE_MATH | Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES;
    let mut page = String::with_capacity(markdown.len());
    let mut done = 0;
    for (event, range) in Parser::new_ext(markdown, options).into_offset_iter() {
        let math = match &event {
            Event::InlineMath(latex) => mathml(latex, Place::Line)?,
            Event::DisplayMath(latex) => mathml(latex, Place::Block)?,
            _ => continue,
        };
        page.push_str(markdown.get(done..range.start).unwrap_or_default());
        page.push_str(&math);
        done = range.end;
    }
    page.push_str(markdown.get(done..).unwrap_or_default());
    Ok(page)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use serde_json::json;

    use super::{chapters, drawn};

    #[test]
    fn only_equations_change() {
        let page = "Text $a_1$ and `$b$`, $5.\n\n$$\nc\n$$\n\n| $x$ | y |\n|---|---|\n\n```sh\necho \"$d$\" $$\n```\n";
        let drawn = drawn(page).unwrap();
        assert_eq!(drawn.matches("<math").count(), 3, "{drawn}");
        assert_eq!(drawn.matches("display=\"block\"").count(), 1);
        for kept in ["`$b$`, $5.", "```sh\necho \"$d$\" $$\n```\n", "| y |\n|---|---|\n"] {
            assert!(drawn.contains(kept), "{drawn}");
        }
    }

    #[test]
    fn chapters_are_found_at_any_depth() {
        let inner = json!({"Chapter": {"name": "b", "content": "$b$", "sub_items": []}});
        let mut book = json!({"items": [{"PartTitle": "$p$"}, "Separator",
            {"Chapter": {"name": "a", "content": "$a$", "sub_items": [inner]}}]});
        chapters(&mut book).unwrap();
        assert_eq!(book["items"][0]["PartTitle"], "$p$");
        let outer = &book["items"][2]["Chapter"];
        assert!(outer["content"].as_str().unwrap().contains("<mi>a</mi>"));
        assert!(outer["sub_items"][0]["Chapter"]["content"].as_str().unwrap().contains("<mi>b</mi>"));
        let mut wrong = json!({"Chapter": {"name": "The method", "content": "$\\nosuch$"}});
        assert!(format!("{:#}", chapters(&mut wrong).unwrap_err()).starts_with("The method"));
    }

    /// Every equation of the book and of the README can be drawn; the theory has many.
    #[test]
    fn every_equation_of_the_book_is_drawn() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src");
        let mut equations = 0;
        for entry in fs::read_dir(docs).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "md") {
                let page = drawn(&fs::read_to_string(&path).unwrap());
                let page = page.unwrap_or_else(|error| panic!("{}: {error:#}", path.display()));
                equations += page.matches("<math").count();
            }
        }
        assert!(equations > 50, "{equations} equations");
    }
}
