//! The workshop of stickslip: `cargo xtask COMMAND`.

mod ci;
mod deny;
mod dist;
mod equations;
mod error_vs_runtime;
mod estimates;
mod extreme;
mod figures;
mod fuzz;
mod generate_model;
mod instructions;
mod iwan;
mod library;
mod loop_family;
mod loop_series;
mod markdown;
mod msrv;
mod non_negative;
mod package;
mod packages;
mod page;
mod paper;
mod peers;
mod python;
mod reconstruct;
mod record_family;
mod reference_loop;
mod report_page;
mod scaling;
mod synthetic_loop;
mod truths;
mod virtual_environment;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};

const USAGE: &str = "usage: cargo xtask COMMAND

  ci                       every check of a change: format, lints, documentation, tests, figures, the README's commands
  deny                     licences, sources and advisories of all dependencies with cargo-deny; says so where that is missing
  dist                     what a release consists of, in target/dist: program, manual pages, completions, wheel, licences, sums
                           (--without-wheel without Python, --quick around the release build)
  doc                      the documentation of all crates with drawn equations, in target/doc
  equations                draws the equations of the book; `mdbook build docs` calls it
  figures                  writes docs/figures and docs/src/reproduction.md: the paper's figures and numbers
  figures --check          fails when a stated number leaves its tolerance or a committed figure shows other data
  reconstruct              searches the parameters of the paper's Fig. 4 and writes scenes/hoffmann-2017*.json
  reconstruct --check      fails unless those files are what the command writes
  error-vs-runtime         error against run time of every method on the scene library: data, figures, page (release build)
  error-vs-runtime --draw  figures and page once more from the measured data
  error-vs-runtime --quick fails when errors are out of order or the page is not that of its data
  estimates [SCENE…]       what error estimates are worth on the scene library (or on scenes of such names): tables, CSV
  extreme                  cases at the limits of every quantity, labelled and judged; writes the tables of docs/src/extreme.md
                           (release build; --quick a twentieth of them, --seed S others, --case ID one alone)
  fuzz [SECONDS]           coverage-guided fuzzing of scenes, records and studies; needs a nightly compiler and cargo-fuzz
  generate-model KIND      a finite-element model and a scene: blade, sector, ring or lumped (release build; --help)
  instructions             instructions a point of the hot paths against committed counts, under valgrind (release build)
  instructions --accept    commits to the counts of now: writes xtask/instructions.json
  iwan                     the tables of docs/src/iwan.md; writes docs/figures/iwan.csv
  loop-family              the tables of docs/src/loop-family.md; writes docs/figures/loop-family.csv
  loop-family FILE…        the same question to measured records at several amplitudes; prints a table
  loop-series FOLDER       writes synthetic records at eight amplitudes that follow the paper's scaling laws
  scaling                  how the cost grows with dofs, contacts, harmonics, points: docs/src/growth.md (release build)
  scaling --draw           figure and page once more from the measured data
  msrv                     the declared rust-version is true: of dependencies, of the lint that watches it, of that compiler if it is there
  package                  every crate can be packaged and is whole (--verify: and builds from its package)
  peers                    the same scenes with pyHarm, mousai and SciPy: agreement, error, time; writes docs/src/peers.md
                           (release build; needs Python 3.11 and a package index)
  peers --draw             the page once more from the measured data
  python                   builds the wheel of the Python package and tests it in an environment of its own (needs Python 3.10
                           or later and a package index)
  reference-loop           writes scenes/loops/reference.csv
  report-page              bundles the page of `stickslip report` (needs Node.js 20 or later and a package registry)
  report-page --test       and tests it in Chromium
  … --check                fails unless what one of reference-loop, iwan and loop-family writes and prints is in the repository";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["ci"] => ci::run(&root()),
        ["deny"] => deny::run(&root()),
        ["dist", words @ ..] => dist::run(&root(), words),
        ["doc"] => equations::document(&root()),
        ["equations"] => equations::preprocess(),
        // mdBook asks which renderers are supported; MathML is for browsers.
        ["equations", "supports", "html"] => Ok(()),
        ["equations", "supports", renderer] => bail!("equations are drawn for html, not for {renderer}"),
        ["error-vs-runtime"] => error_vs_runtime::run(&root()),
        ["error-vs-runtime", "--draw"] => error_vs_runtime::draw(&root()),
        ["error-vs-runtime", "--quick"] => error_vs_runtime::quick(&root()),
        ["estimates", names @ ..] => estimates::run(&root(), names),
        ["extreme", words @ ..] => extreme::run(&root(), words),
        ["fuzz", seconds @ ..] => fuzz::run(&root(), seconds),
        ["generate-model", words @ ..] => generate_model::run(words),
        ["instructions"] => instructions::check(&root()),
        ["instructions", "--accept"] => instructions::accept(&root()),
        [instructions::HOT_PATH, name, passes] => instructions::run_hot_path(&root(), name, passes),
        ["iwan"] => iwan::write(&root()),
        ["iwan", "--check"] => iwan::check(&root()),
        ["loop-family", "--check"] => loop_family::check(&root()),
        ["loop-family"] => loop_family::write(&root()),
        ["loop-family", files @ ..] => record_family::print(files),
        ["loop-series", folder] => loop_series::write(Path::new(folder)),
        ["msrv"] => msrv::run(&root()),
        ["package", words @ ..] => package::run(&root(), words),
        ["peers"] => peers::run(&root()),
        ["peers", "--draw"] => peers::draw(&root()),
        ["python"] => python::run(&root(), true),
        ["figures"] => figures::write(&root()),
        ["figures", "--check"] => figures::check(&root()),
        ["reconstruct"] => reconstruct::write(&root()),
        ["reconstruct", "--check"] => reconstruct::check(&root()),
        ["report-page"] => report_page::bundle(&root(), true).map(|_| ()),
        ["report-page", "--test"] => report_page::test(&root()),
        ["scaling"] => scaling::run(&root()),
        ["scaling", "--draw"] => scaling::draw(&root()),
        ["reference-loop"] => reference_loop::write(&root()),
        ["reference-loop", "--check"] => reference_loop::check(&root()),
        _ => bail!("{USAGE}"),
    }
}

/// The folder of the workspace.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
