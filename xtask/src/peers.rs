//! `cargo xtask peers`: the same scenes side by side with what pip installs for a user.
//!
//! pyHarm and mousai solve the same balance with the same harmonics, points and samples; SciPy and NumPy step through time.
//! Answers are compared with each other and with the exact orbit, and a point of each is timed. Needs Python 3.11 and a
//! package index, so nothing of it runs in CI; what reads and compares answers has unit tests. `--draw` makes the page
//! `docs/src/peers.md` again from `docs/figures/peers.json`.

mod answer;
mod compare;
mod data;
mod environment;
mod page;
mod request;
mod stopwatch;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use study::Truths;
use study::work_precision::Machine;

use crate::error_vs_runtime::rustc;
use answer::Answer;
use compare::Own;
use data::{Data, Row, Stepped};
use environment::Environment;
use request::{Case, Scene};

/// What a user types.
pub(crate) const COMMAND: &str = "cargo xtask peers";

/// Harmonics that are compared.
const HARMONICS: [usize; 3] = [1, 7, 31];
/// Samples a period of the peers' forces.
const SAMPLES: usize = 256;
/// Samples at which friction is compared once more: they differ in where a slider turns, and the difference must fall.
const MORE_SAMPLES: [usize; 3] = [256, 1024, 4096];
/// What the peers' solvers are asked for: more than by default, so that answers can be compared, at hardly more time.
const TOLERANCE: f64 = 1e-10;
/// Repeats of the peers' sweeps after a warm-up.
const REPEATS: usize = 3;

/// Measures everything and writes data and page.
pub(crate) fn run(root: &Path) -> Result<()> {
    let began = Instant::now();
    let environment = Environment::prepare(root)?;
    let mut data = Data {
        command: COMMAND.to_owned(),
        machine: Machine::here(rustc()),
        versions: Vec::new(),
        rows: Vec::new(),
        finer: Vec::new(),
        stepped: Vec::new(),
    };
    let friction = Scene::read(root, "scenes/library/scene-p.json", request::evenly(20.0, 200.0, 46))?;
    let spring = Scene::read(root, "scenes/cubic.json", request::evenly(38.0, 48.0, 26))?;

    let pyharm = Peer { name: "pyHarm", script: "with_pyharm", samples: |_| SAMPLES, repeats: REPEATS };
    balance(&environment, &mut data, &friction, &pyharm)?;
    balance(&environment, &mut data, &spring, &pyharm)?;
    // mousai samples in a Python loop; these are as few as alias nothing of a cubic force. Nothing of it is compiled.
    let mousai = Peer { name: "mousai", script: "with_mousai", samples: |n| (4 * n + 3).max(51), repeats: 0 };
    balance(&environment, &mut data, &spring, &mousai)?;
    finer(&environment, &mut data, &friction)?;
    let points = Scene::read(root, "scenes/library/scene-p.json", vec![55.0, 60.0, 108.0, 118.0])?;
    stepping(&environment, &mut data, &points)?;

    data.write(root)?;
    draw(root)?;
    eprintln!("all of it: {:.0} s", began.elapsed().as_secs_f64());
    Ok(())
}

/// The page once more from the measured data.
pub(crate) fn draw(root: &Path) -> Result<()> {
    let text = page::page(&Data::read(root)?)?;
    let path = page::file(root);
    std::fs::write(&path, text).with_context(|| path.display().to_string())
}

/// Another program that balances harmonics.
struct Peer {
    name: &'static str,
    script: &'static str,
    /// Samples a period for an N.
    samples: fn(usize) -> usize,
    /// Timed sweeps after a warm-up; with none the first sweep counts.
    repeats: usize,
}

/// One scene with one peer: agreement, errors, times.
fn balance(environment: &Environment, data: &mut Data, scene: &Scene, peer: &Peer) -> Result<()> {
    let cases = HARMONICS.map(|n| Case::balance(scene, n, (peer.samples)(n), TOLERANCE, peer.repeats));
    let answer = environment.ask(peer.script, scene, &cases)?;
    data.knows(&answer);
    let truths = Truths::new(&scene.scene, 31)?;
    let truths: Vec<_> = scene.frequencies.iter().map(|hertz| truths.at(*hertz).ok()).collect();
    for case in &answer.cases {
        let (harmonics, samples) = (case.harmonics, case.samples.unwrap_or(SAMPLES));
        let own = Own::solve(scene, harmonics, None)?;
        let sampled = Own::solve(scene, harmonics, Some(samples))?;
        data.rows.push(Row {
            scene: scene.name().to_owned(),
            peer: peer.name.to_owned(),
            harmonics,
            samples,
            points: case.points.len(),
            slipping: own.slips.iter().filter(|slips| **slips).count(),
            peer_unsolved: case.unsolved(),
            own_unsolved: own.unsolved() + sampled.unsolved(),
            difference: compare::difference(case, &sampled.points, &own.slips),
            peer_error: compare::errors(case, &truths, &own.slips),
            sampled_error: compare::errors_of(&sampled.points, &truths, &own.slips),
            own_error: compare::errors_of(&own.points, &truths, &own.slips),
            peer_seconds: case.seconds,
            sampled_seconds: sampled.seconds,
            own_seconds: own.seconds,
        });
        eprintln!("{} {} N = {harmonics}: {:.2e} s a point", scene.name(), peer.name, case.seconds);
    }
    Ok(())
}

/// Friction with more samples, without times.
fn finer(environment: &Environment, data: &mut Data, scene: &Scene) -> Result<()> {
    let few = scene.at(vec![40.0, 55.0, 60.0, 108.0, 118.0])?;
    let cases = MORE_SAMPLES.map(|samples| Case::balance(&few, 7, samples, TOLERANCE, 0));
    let answer = environment.ask("with_pyharm", &few, &cases)?;
    for case in &answer.cases {
        let samples = case.samples.unwrap_or(SAMPLES);
        let sampled = Own::solve(&few, case.harmonics, Some(samples))?;
        data.finer.push((samples, compare::difference(case, &sampled.points, &sampled.slips)));
    }
    Ok(())
}

/// Time integration beside the balance, by error and time.
fn stepping(environment: &Environment, data: &mut Data, scene: &Scene) -> Result<()> {
    let answer: Answer = environment.ask("time_integration", scene, &Case::stepping(scene))?;
    data.knows(&answer);
    let truths = Truths::new(&scene.scene, 1023)?;
    let truths: Vec<_> = scene.frequencies.iter().map(|hertz| truths.at(*hertz).ok()).collect();
    let all = vec![true; scene.frequencies.len()];
    for case in &answer.cases {
        data.stepped.push(Stepped {
            method: case.name(),
            peer: true,
            unsolved: case.unsolved(),
            error: compare::errors(case, &truths, &all),
            seconds: case.seconds,
        });
    }
    for harmonics in [1, 3, 7, 15, 31, 63, 127, 255] {
        let own = Own::solve(scene, harmonics, None)?;
        data.stepped.push(Stepped {
            method: format!("N = {harmonics}"),
            peer: false,
            unsolved: own.unsolved(),
            error: compare::errors_of(&own.points, &truths, &all),
            seconds: own.seconds,
        });
    }
    Ok(())
}
