//! `cargo xtask extreme`: a seeded table of cases at the limits of every quantity, each labelled before it is run and judged
//! by an independent evaluation of its balance.

mod balance;
mod case;
mod closed_forms;
mod double_double;
mod draw;
mod families;
mod invariants;
mod jenkins;
mod judge;
mod label;
mod law;
mod memory;
mod motion;
mod page;
mod reference_force;
mod run;
mod table;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};

use families::FAMILIES;
use table::Table;

/// Cases of the full run for one of the quick run.
const FULL: usize = 20;

/// Share of the cases labelled solvable that must be solved.
const SOLVED: f64 = 0.999;

/// Which part of the table is run.
struct Options {
    quick: bool,
    seed: u64,
    case: Option<String>,
}

/// Runs the table and judges it; the full run with the default seed writes the book's page.
pub(crate) fn run(root: &Path, words: &[&str]) -> Result<()> {
    let options = options(words)?;
    if let Some(id) = &options.case {
        return run::one(options.seed, id);
    }
    let began = Instant::now();
    let repeats = if options.quick { 1 } else { FULL };
    let cases: Vec<(usize, usize)> = FAMILIES
        .iter()
        .enumerate()
        .flat_map(|(family, f)| (0..f.share * repeats).map(move |index| (family, index)))
        .collect();
    let records = run::all(options.seed, &cases);
    let table = Table::of(&records);
    print!("{}", table.markdown());
    for record in records.iter().filter(|record| record.notable()) {
        eprintln!("{record}");
    }
    let invariants = invariants::check(options.seed, repeats)?;
    println!("\n{invariants}");
    eprintln!("{} cases in {:.0} s", records.len(), began.elapsed().as_secs_f64());
    if !options.quick && options.seed == 0 {
        page::write(root, &table, &invariants)?;
    }
    table.check()
}

fn options(words: &[&str]) -> Result<Options> {
    let mut options = Options { quick: false, seed: 0, case: None };
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().with_context(|| format!("{word} needs a value"));
        match *word {
            "--quick" => options.quick = true,
            "--seed" => options.seed = value()?.parse().context("--seed")?,
            "--case" => options.case = Some((*value()?).to_owned()),
            other => bail!("extreme does not know {other}"),
        }
    }
    ensure!(options.case.is_none() || !options.quick, "--case runs one case alone");
    Ok(options)
}
