//! What the README and the book say is run: commands in their order, printed output compared, scenes checked, and every
//! key of a scene and every flag of the command line named.
//!
//! Marks for this test are comments of HTML on the line before a code block, which readers do not see:
//! `<!-- not run: reason -->`, `<!-- exit code 1 -->` (of the block's last command), `<!-- file: name.json -->` (the block
//! is written to that file; a scene is checked), `<!-- refused file: name.json -->` (a scene that is wrong). In a block with lines that begin with `$ ` the other lines are output.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// Blocks with commands of stickslip that are not run, page by page; each says why where it stands.
const NOT_RUN: &[(&str, usize)] = &[
    ("docs/src/clusters.md", 2),
    ("docs/src/formats.md", 1),
    ("docs/src/joints.md", 2),
    ("docs/src/peaks.md", 1),
    ("docs/src/report.md", 2),
    ("docs/src/scaling.md", 2),
];

/// One fenced code block and the mark before it.
struct Block {
    language: String,
    mark: Option<String>,
    lines: Vec<String>,
    line: usize,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// README.md and all pages of the book, with their text.
fn pages() -> Vec<(String, String)> {
    let root = root();
    let mut names = vec!["README.md".to_owned()];
    for entry in fs::read_dir(root.join("docs/src")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") && name != "SUMMARY.md" {
            names.push(format!("docs/src/{name}"));
        }
    }
    names.sort();
    names.into_iter().map(|name| (name.clone(), fs::read_to_string(root.join(name)).unwrap())).collect()
}

fn page(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    let mut mark = None;
    for (number, line) in page.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(block), None) => block.lines.push(line.to_owned()),
            (None, Some(language)) => {
                let language = language.to_owned();
                open = Some(Block { language, mark: mark.take(), lines: Vec::new(), line: number + 1 });
            }
            (None, None) => {
                let comment = line.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->"));
                mark = comment.map(str::to_owned);
            }
        }
    }
    assert!(open.is_none(), "a code block is not closed");
    blocks
}

/// A command as the page shows it, and the output shown below it.
struct Shown {
    command: String,
    output: Vec<String>,
}

/// The commands of a console block; a line that ends in a backslash goes on in the next.
fn commands(block: &Block) -> Vec<Shown> {
    let prompted = block.lines.iter().any(|line| line.starts_with("$ "));
    let mut commands: Vec<Shown> = Vec::new();
    let mut continues = false;
    for line in &block.lines {
        let part = if prompted { line.strip_prefix("$ ") } else { Some(line.as_str()) };
        match (part, commands.last_mut()) {
            (_, Some(last)) if continues => last.command = last.command.replace('\\', " ") + line.trim(),
            (Some(command), _) => {
                commands.push(Shown { command: command.trim().to_owned(), output: Vec::new() });
            }
            (None, Some(last)) => last.output.push(line.clone()),
            (None, None) => panic!("line {}: output before any command", block.line),
        }
        continues = line.ends_with('\\');
    }
    commands.retain(|shown| !shown.command.is_empty());
    commands
}

/// Whether a line of a page is a command of stickslip, as installed or by way of cargo; the workshop's commands are
/// checks of their own.
fn of_stickslip(command: &str) -> bool {
    let by_cargo = command.starts_with("cargo run ") && command.contains(" -- ");
    command.starts_with("stickslip ") || by_cargo && !command.contains("-p xtask")
}

/// The command for a shell in which the binary under test is `stickslip`.
fn for_shell(command: &str) -> String {
    command.replace("cargo run --release -- ", "stickslip ")
}

/// Runs a command in a folder as if at a terminal, so that it prints what a reader sees; exit code and output, messages
/// last. Standard error is no terminal, so that there is no progress between the lines.
fn run(folder: &Path, command: &str) -> (Option<i32>, String) {
    let binary = Path::new(env!("CARGO_BIN_EXE_stickslip")).parent().unwrap();
    let path = format!("{}:{}", binary.display(), std::env::var("PATH").unwrap());
    let at_terminal =
        format!("stty columns 200; (\n{command}\n) 2>.messages; code=$?; cat .messages; exit $code");
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", &at_terminal, "/dev/null"])
        .current_dir(folder)
        .env("PATH", path)
        .env("TERM", "dumb")
        .stdin(std::process::Stdio::null())
        .output()
        .expect("`script` of util-linux");
    (output.status.code(), String::from_utf8(output.stdout).unwrap().replace('\r', ""))
}

/// Whether an output has the lines shown, in order; `…` alone is any number of lines, at the end of a line its rest.
fn shows(shown: &[String], output: &str) -> Result<(), String> {
    let mut lines = output.lines();
    let mut skipping = false;
    for expected in shown.iter().filter(|line| !line.trim().is_empty()) {
        if expected.trim() == "…" {
            skipping = true;
            continue;
        }
        let mut candidates = lines.by_ref().filter(|line| !line.trim().is_empty());
        let found = if skipping {
            candidates.any(|line| same(expected, line))
        } else {
            candidates.next().is_some_and(|line| same(expected, line))
        };
        if !found {
            return Err(format!("does not print\n{expected}\nbut\n{output}"));
        }
        skipping = false;
    }
    Ok(())
}

/// Whether two lines agree word by word: numbers to the digits shown.
fn same(shown: &str, printed: &str) -> bool {
    let mut printed = printed.split_whitespace();
    for word in shown.split_whitespace() {
        if word == "…" {
            return true;
        }
        if !printed
            .next()
            .is_some_and(|other| word == other || is_rule(word) && is_rule(other) || near(word, other))
        {
            return false;
        }
    }
    printed.next().is_none()
}

/// A line below the head of a table, whatever its width.
fn is_rule(word: &str) -> bool {
    word.chars().all(|c| c == '─')
}

/// Whether two numbers differ by at most one unit of the last digit shown.
fn near(shown: &str, printed: &str) -> bool {
    let (Ok(a), Ok(b)) = (shown.parse::<f64>(), printed.parse::<f64>()) else { return false };
    let (mantissa, exponent) = shown.split_once('e').unwrap_or((shown, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let Ok(exponent) = exponent.parse::<i32>() else { return false };
    // Integers are counts.
    mantissa.contains('.') && (a - b).abs() <= 1.001 * 10f64.powi(exponent - i32::try_from(decimals).unwrap())
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs all blocks of a page in one folder that has the repository's scenes; how many were marked as not run, and what was
/// wrong.
fn run_page(name: &str, text: &str) -> (usize, Vec<String>) {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    copy(&root().join("scenes"), &folder.join("scenes"));
    let mut not_run = 0;
    let mut wrong = Vec::new();
    for block in blocks(text) {
        let place = format!("{name}:{}", block.line);
        let mark = block.mark.as_deref().unwrap_or_default();
        if let Some((refused, file)) = mark.split_once("file: ") {
            fs::write(folder.join(file), block.lines.join("\n") + "\n").unwrap();
            // A scene stands for itself: it must be one, or be refused where the page says so.
            if block.language == "json" && block.lines.iter().any(|line| line.contains("\"model\":")) {
                let (code, output) = run(folder, &format!("stickslip check {file}"));
                if code != Some(if refused.is_empty() { 0 } else { 2 }) {
                    wrong.push(format!("{place}: {file} ends with {code:?}\n{output}"));
                }
            }
        }
        if !["console", "sh", "bash"].contains(&block.language.as_str()) {
            continue;
        }
        let commands = commands(&block);
        if !commands.iter().any(|shown| of_stickslip(&shown.command)) {
            continue;
        }
        if let Some(reason) = mark.strip_prefix("not run: ") {
            assert!(!reason.is_empty(), "{place}: no reason");
            not_run += 1;
            continue;
        }
        let last = commands.len() - 1;
        for (number, shown) in commands.iter().enumerate() {
            let (code, output) = run(folder, &for_shell(&shown.command));
            let expected = match mark.strip_prefix("exit code ") {
                Some(code) if number == last => code.parse().unwrap(),
                _ => 0,
            };
            if code != Some(expected) {
                wrong
                    .push(format!("{place}: {} ends with {code:?}, not {expected}\n{output}", shown.command));
            } else if let Err(difference) = shows(&shown.output, &output) {
                wrong.push(format!("{place}: {} {difference}", shown.command));
            }
        }
    }
    (not_run, wrong)
}

#[test]
fn every_command_of_readme_and_book_runs() {
    let pages = pages();
    let results: Vec<(usize, Vec<String>)> = std::thread::scope(|scope| {
        let workers: Vec<_> =
            pages.iter().map(|(name, text)| scope.spawn(move || run_page(name, text))).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).collect()
    });
    let wrong: Vec<&str> = results.iter().flat_map(|(_, wrong)| wrong).map(String::as_str).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    let expected = |name: &str| NOT_RUN.iter().find(|(page, _)| *page == name).map_or(0, |(_, count)| *count);
    for ((name, _), (count, _)) in pages.iter().zip(&results) {
        assert_eq!(*count, expected(name), "{name}: blocks that are marked as not run");
    }
    for (name, _) in NOT_RUN {
        assert!(pages.iter().any(|(page, _)| page == name), "{name} is no page");
    }
}

/// Every key that a scene can have is named, as code, on the page of all keys or the one of its own.
#[test]
fn every_key_of_a_scene_is_explained() {
    let named =
        page("docs/src/scenes.md") + &page("docs/src/joints.md") + &page("docs/src/finite-elements.md");
    let schema: Value = serde_json::from_str(scene::SCHEMA).unwrap();
    let mut keys = BTreeSet::new();
    properties(&schema, &mut keys);
    assert!(keys.len() > 60, "{keys:?}");
    let missing: Vec<&String> = keys
        .iter()
        .filter(|key| !named.contains(&format!("`{key}`")) && !named.contains(&format!("\"{key}\"")))
        .collect();
    assert!(missing.is_empty(), "no page explains {missing:?}");
}

/// The names of all properties anywhere in a schema.
fn properties(schema: &Value, keys: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            for (key, value) in object {
                if let ("properties", Value::Object(properties)) = (key.as_str(), value) {
                    keys.extend(properties.keys().cloned());
                }
                properties_of(value, keys);
            }
        }
        value => properties_of(value, keys),
    }
}

fn properties_of(value: &Value, keys: &mut BTreeSet<String>) {
    match value {
        Value::Object(_) => properties(value, keys),
        Value::Array(items) => items.iter().for_each(|item| properties(item, keys)),
        _ => {}
    }
}

/// The page of the command line ends with the help of every command as the program prints it.
#[test]
fn the_page_of_the_command_line_is_the_programs_help() {
    const PAGE: &str = "docs/src/command-line.md";
    const MARK: &str = "<!-- from here on: the help of every command, written by BOOK=write cargo test -p stickslip --test book -->";
    let mut help = String::new();
    let mut names = Vec::new();
    describe(&mut Vec::new(), &mut help, &mut names);
    assert!(names.len() > 15 && names.contains(&"loop fit".to_owned()), "{names:?}");
    let written = page(PAGE);
    let (before, _) = written.split_once(MARK).expect("the mark of the generated part");
    let page = format!("{before}{MARK}\n{help}");
    if std::env::var_os("BOOK").is_some_and(|value| value == "write") {
        fs::write(root().join(PAGE), &page).unwrap();
    } else {
        assert!(page == written, "{PAGE} is not what the program says; BOOK=write writes it");
    }
}

/// Appends the help of a command and of those below it, each under its own heading.
fn describe(words: &mut Vec<String>, page: &mut String, names: &mut Vec<String>) {
    let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(&*words)
        .arg("--help")
        .env("COLUMNS", "110")
        .stdin(std::process::Stdio::null())
        .output()
        .unwrap();
    assert!(output.status.success());
    let help = String::from_utf8(output.stdout).unwrap();
    let below: Vec<String> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| line.starts_with("  "))
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .filter(|name| name != "help")
        .collect();
    if !words.is_empty() && below.is_empty() {
        let name = words.join(" ");
        let text: Vec<&str> = help.lines().map(str::trim_end).collect();
        page.push_str(&format!("\n### `stickslip {name}`\n\n```text\n{}\n```\n", text.join("\n").trim_end()));
        names.push(name);
    }
    for name in below {
        words.push(name);
        describe(words, page, names);
        words.pop();
    }
}

/// What the page on hard cases quotes is what the program says: each message stands in the sources.
#[test]
fn quoted_messages_are_the_programs() {
    let mut sources = String::new();
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        gather(&entry.unwrap().path().join("src"), &mut sources);
    }
    let page = page("docs/src/hard-cases.md");
    let mut quoted = 0;
    for row in page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| you see")) {
        let first = row.split('|').nth(1).unwrap();
        // Between the marks of code; an ellipsis stands for a number or a name.
        for part in first.split('`').skip(1).step_by(2).flat_map(|message| message.split('…')) {
            quoted += 1;
            assert!(sources.contains(part.trim()), "hard-cases.md quotes {part:?}, which no source has");
        }
    }
    assert!(quoted > 10, "{quoted} messages");
}

/// Appends the text of all Rust files below a folder, strings that go on in the next line put together.
fn gather(folder: &Path, sources: &mut String) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, sources);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            for line in fs::read_to_string(&path).unwrap().lines() {
                match line.strip_suffix('\\') {
                    Some(part) => sources.push_str(part.trim_start()),
                    None => {
                        sources.push_str(line.trim_start());
                        sources.push('\n');
                    }
                }
            }
        }
    }
}

/// Links between pages lead to a file that exists, and to a heading of it.
#[test]
fn every_link_leads_somewhere() {
    let mut links = 0;
    for (name, text) in pages() {
        let folder = root().join(&name).parent().unwrap().to_path_buf();
        for part in text.split("](").skip(1) {
            let target = part.split(')').next().unwrap();
            if target.contains("://") || target.contains(char::is_whitespace) {
                continue;
            }
            links += 1;
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { root().join(&name) } else { folder.join(file) };
            assert!(path.exists(), "{name} links to {target}, which does not exist");
            if !heading.is_empty() {
                let there = fs::read_to_string(&path).unwrap();
                let mut headings = there.lines().filter(|line| line.starts_with('#')).map(anchor);
                assert!(headings.any(|other| other == heading), "{name} links to {target}: no such heading");
            }
        }
    }
    assert!(links > 100, "{links} links");
}

/// The anchor that mdBook and GitHub give a heading.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn outputs_are_compared_to_the_digits_shown() {
    let shown = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let printed = "a 1.2345 N\nb 2\nc 3e-9 …\n";
    assert!(shows(&shown("a 1.23 N\n…\nc …"), printed).is_ok());
    assert!(shows(&shown("b 2"), printed).is_err());
    assert!(shows(&shown("a 1.25 N"), printed).is_err());
    assert!(shows(&shown("…\nb 3"), printed).is_err());
}
