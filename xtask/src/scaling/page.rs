//! The page `docs/src/growth.md`: its words stand in `page.md`, its numbers in the measured data.

use anyhow::{Context, Result, ensure};
use study::work_precision::Machine;

use super::family::Family;
use super::figure::points;
use super::measure::Measured;
use super::{COMMAND, exponent};
use crate::error_vs_runtime::time;
use crate::markdown::table;

const WORDS: &str = include_str!("page.md");

pub(super) fn page(machine: &Machine, measured: &[Measured]) -> Result<String> {
    let mut text = WORDS.to_owned();
    let here = format!("{}, {} cores, {}, {}", machine.cpu, machine.cores, machine.os, machine.rustc);
    for (name, words) in [
        ("command", COMMAND.to_owned()),
        ("machine", here),
        ("exponents", exponents(measured)?),
        ("dofs", sizes(measured, Family::Dofs, "dofs")),
        ("contacts", sizes(measured, Family::Contacts, "contacts")),
        ("harmonics", sizes(measured, Family::Harmonics, "N")),
        ("points", sweeps(measured)),
    ] {
        let place = format!("{{{{{name}}}}}");
        ensure!(text.contains(&place), "page.md has no place for {name}");
        text = text.replace(&place, words.trim_end());
    }
    Ok(text)
}

fn exponents(measured: &[Measured]) -> Result<String> {
    let row = |(family, of): (Family, &str)| {
        let slope = exponent(&points(measured, family)).with_context(|| format!("{of} was not measured"))?;
        Ok([of.to_owned(), format!("{slope:.2}")])
    };
    let families = [
        (Family::Dofs, "dofs"),
        (Family::Contacts, "contacts"),
        (Family::Harmonics, "harmonics"),
        (Family::Points, "points"),
    ];
    let rows: Vec<[String; 2]> = families.into_iter().map(row).collect::<Result<_>>()?;
    Ok(table(["quantity", "exponent"], &rows))
}

fn sizes(measured: &[Measured], family: Family, name: &str) -> String {
    let row = |m: &Measured| {
        [
            m.size.to_string(),
            time(m.seconds),
            format!("{:.1}", m.iterations),
            format!("{} of {}", m.unsolved, m.points),
        ]
    };
    let rows: Vec<_> = measured.iter().filter(|m| m.family == family).map(row).collect();
    table([name, "time a point", "Newton steps a point", "not solved"], &rows)
}

fn sweeps(measured: &[Measured]) -> String {
    let seconds = |family: Family, size: usize| {
        let one = measured.iter().find(|m| m.family == family && m.size == size);
        one.map_or(f64::NAN, |m| m.seconds * m.points as f64)
    };
    let row = |&size: &usize| {
        let (one, two) = (seconds(Family::Points, size), seconds(Family::PointsOnTwoThreads, size));
        [size.to_string(), time(one), time(two), format!("{:.2}", one / two)]
    };
    let rows: Vec<_> = Family::Points.sizes().iter().map(row).collect();
    table(["points", "one thread", "two threads", "ratio"], &rows)
}
