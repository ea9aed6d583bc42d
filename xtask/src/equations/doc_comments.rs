//! Every equation in a doc comment can be drawn: checked on the sources, so that no documentation has to be built for it.
#![cfg(test)]

use std::fs;
use std::path::Path;

use pulldown_cmark::{CodeBlockKind, Event, Parser, Tag, TagEnd};

use super::mathml::{Place, mathml};

/// The equations in doc comments of a source file, with their place.
fn equations(source: &str) -> Vec<(String, Place)> {
    let comments: Vec<&str> = source
        .lines()
        .map(|line| {
            let line = line.trim_start();
            let comment = line.strip_prefix("//!").or_else(|| line.strip_prefix("///")).unwrap_or("\0");
            comment.strip_prefix(' ').unwrap_or(comment)
        })
        .collect();
    // What is no comment separates comments.
    let texts: Vec<String> = comments.split(|line| *line == "\0").map(|lines| lines.join("\n")).collect();
    texts.iter().flat_map(|text| of_text(text)).collect()
}

fn of_text(text: &str) -> Vec<(String, Place)> {
    let mut found = Vec::new();
    let mut block = None;
    for (event, range) in Parser::new_ext(text, pulldown_cmark::Options::ENABLE_TABLES).into_offset_iter() {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))) if &*language == "math" => {
                block = Some(String::new());
            }
            Event::Text(part) => {
                if let Some(block) = &mut block {
                    block.push_str(&part);
                }
            }
            Event::End(TagEnd::CodeBlock) => found.extend(block.take().map(|block| (block, Place::Block))),
            Event::Code(code) => {
                let between = text[..range.start].ends_with('$') && text[range.end..].starts_with('$');
                found.extend(between.then(|| (code.to_string(), Place::Line)));
            }
            _ => {}
        }
    }
    found
}

/// Equations below a folder, each tried; the number of them.
fn draw_all(folder: &Path) -> usize {
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            count += draw_all(&path);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            for (latex, place) in equations(&fs::read_to_string(&path).unwrap()) {
                mathml(&latex, place).unwrap_or_else(|error| panic!("{}: {error:#}", path.display()));
                count += 1;
            }
        }
    }
    count
}

#[test]
fn equations_are_found_in_comments_alone() {
    let source =
        "//! Let $`a`$ and `b`.\n//!\n//! ```math\n//! c = d\n//! ```\nlet x = \"$`e`$\";\n/// $`f`$\n";
    let found: Vec<String> =
        equations(source).into_iter().map(|(latex, _)| latex.trim().to_owned()).collect();
    assert_eq!(found, ["a", "c = d", "f"]);
}

#[test]
fn every_equation_of_the_crates_is_drawn() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    // Every crate of the mathematics says what it computes.
    for name in ["hysteresis", "contact", "structure", "hbm", "orbit"] {
        let count = draw_all(&crates.join(name).join("src"));
        assert!(count > 0, "{name} has no equation in its documentation");
    }
    for name in ["scene", "study", "plot", "cli"] {
        draw_all(&crates.join(name).join("src"));
    }
}
