//! The page `docs/src/peers.md`: its words stand in `page.md`, its numbers in the measured data.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use super::COMMAND;
use super::compare::Spread;
use super::data::{Data, Row, Stepped};
use crate::error_vs_runtime::time;
use crate::markdown::{significant, table};

/// The page's words, with `{{name}}` where numbers go.
const WORDS: &str = include_str!("page.md");

pub(super) fn file(root: &Path) -> PathBuf {
    root.join("docs").join("src").join("peers.md")
}

/// The page with its tables; fails when a place is left or has none.
pub(super) fn page(data: &Data) -> Result<String> {
    let mut text = WORDS.to_owned();
    for (name, words) in [
        ("command", COMMAND.to_owned()),
        ("machine", machine(data)),
        ("versions", versions(data)),
        ("agreement", agreement(data)),
        ("finer", finer(data)),
        ("times", times(data)),
        ("stepping", stepping(data)),
        ("equal", equal(data)),
    ] {
        let place = format!("{{{{{name}}}}}");
        ensure!(text.contains(&place), "page.md has no place for {name}");
        text = text.replace(&place, words.trim_end());
    }
    ensure!(!text.contains("{{"), "page.md has a place that nothing fills");
    Ok(text)
}

fn machine(data: &Data) -> String {
    let machine = &data.machine;
    format!("{}, {} cores, {}, {}.", machine.cpu, machine.cores, machine.os, machine.rustc)
}

fn versions(data: &Data) -> String {
    let all: Vec<String> = data.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    all.join(", ")
}

fn both(spread: Option<Spread>) -> String {
    spread.map_or_else(|| "—".to_owned(), |s| format!("{:.1e} / {:.1e}", s.median, s.worst))
}

fn solved(row: &Row) -> String {
    format!("{} of {}", row.points - row.peer_unsolved, row.points)
}

fn agreement(data: &Data) -> String {
    let cells = |row: &Row| {
        [
            format!("{}, {}", row.scene, row.peer),
            row.harmonics.to_string(),
            row.samples.to_string(),
            solved(row),
            both(row.difference),
            both(row.peer_error),
            both(row.sampled_error),
            both(row.own_error),
        ]
    };
    let rows: Vec<_> = data.rows.iter().map(cells).collect();
    let head = [
        "scene, peer",
        "N",
        "samples",
        "it solves",
        "difference",
        "its error",
        "stickslip, sampled",
        "unasked",
    ];
    table(head, &rows)
}

fn finer(data: &Data) -> String {
    let cells = |(samples, spread): &(usize, Option<Spread>)| [samples.to_string(), both(*spread)];
    let rows: Vec<_> = data.finer.iter().map(cells).collect();
    table(["samples", "difference"], &rows)
}

fn times(data: &Data) -> String {
    let ratio = |other: f64, own: f64| significant(other / own, 2);
    let cells = |row: &Row| {
        [
            format!("{}, {}", row.scene, row.peer),
            row.harmonics.to_string(),
            time(row.peer_seconds),
            time(row.sampled_seconds),
            time(row.own_seconds),
            ratio(row.peer_seconds, row.sampled_seconds),
            ratio(row.peer_seconds, row.own_seconds),
        ]
    };
    let rows: Vec<_> = data.rows.iter().map(cells).collect();
    let head =
        ["scene, peer", "N", "peer", "stickslip, sampled", "unasked", "peer / sampled", "peer / unasked"];
    table(head, &rows)
}

fn stepping(data: &Data) -> String {
    let cells = |s: &Stepped| [s.method.clone(), both(s.error), s.unsolved.to_string(), time(s.seconds)];
    let rows: Vec<_> = data.stepped.iter().map(cells).collect();
    table(["method", "error, median / largest", "unsolved", "time a point"], &rows)
}

/// Each way through time beside the balance with no larger median error, and with no longer time.
fn equal(data: &Data) -> String {
    let balance = || data.stepped.iter().filter(|s| !s.peer && s.unsolved == 0);
    let median = |s: &Stepped| s.error.map_or(f64::INFINITY, |error| error.median);
    let named = |found: Option<&Stepped>, words: &dyn Fn(&Stepped) -> String| {
        found.map_or_else(|| "—".to_owned(), words)
    };
    let cells = |peer: &Stepped| {
        let quickest =
            balance().filter(|s| median(s) <= median(peer)).min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let best =
            balance().filter(|s| s.seconds <= peer.seconds).min_by(|a, b| median(a).total_cmp(&median(b)));
        [
            peer.method.clone(),
            named(quickest, &|s| format!("{}, {}", s.method, time(s.seconds))),
            named(quickest, &|s| significant(peer.seconds / s.seconds, 2)),
            named(best, &|s| format!("{}, {:.1e}", s.method, median(s))),
        ]
    };
    let rows: Vec<_> = data.stepped.iter().filter(|s| s.peer).map(cells).collect();
    table(["method", "same error by", "times as fast", "in the same time"], &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_that_of_its_data() {
        let root = crate::root();
        let text = std::fs::read_to_string(file(&root)).unwrap();
        let page = page(&Data::read(&root).unwrap()).unwrap();
        assert!(text.lines().eq(page.lines()), "run `{COMMAND} --draw`");
    }
}
