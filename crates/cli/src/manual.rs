//! `stickslip completions` and `stickslip man`.

use std::fs;
use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;

use crate::arguments::Arguments;
use crate::ending::{Ending, Failure, say};
use crate::output::{Output, unwritable};

/// Prints the completions of a shell.
pub fn completions(shell: Shell) -> Result<Ending, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "stickslip", &mut text);
    print(&text)
}

/// Prints the manual page, or that of one command: `["loop", "fit"]` is `stickslip loop fit`.
pub fn page(command: &[String]) -> Result<Ending, Failure> {
    let all = root();
    let mut chosen = &all;
    for name in command {
        chosen = chosen.find_subcommand(name).ok_or_else(|| {
            let names: Vec<&str> = chosen.get_subcommands().map(clap::Command::get_name).collect();
            let known = match names.as_slice() {
                [] => "no further one".to_owned(),
                names => names.join(", "),
            };
            Failure::input(format!("there is no command {:?}; there are {known}", command.join(" ")))
        })?;
    }
    let mut text = Vec::new();
    Man::new(chosen.clone()).render(&mut text).map_err(Failure::stdout)?;
    print(&text)
}

/// Writes the pages of all commands into `folder`: `stickslip.1`, `stickslip-sweep.1`, `stickslip-loop-fit.1`, …
pub fn pages(folder: &Path) -> Result<Ending, Failure> {
    fs::create_dir_all(folder).map_err(|error| unwritable(folder, error))?;
    let mut waiting = vec![root()];
    let mut written = 0;
    while let Some(command) = waiting.pop() {
        waiting.extend(command.get_subcommands().cloned());
        let page = Man::new(command);
        let path = folder.join(page.get_filename());
        let mut text = Vec::new();
        page.render(&mut text).map_err(|error| unwritable(&path, error))?;
        Output::open(Some(&path))?.write(|out| out.write_all(&text))?;
        written += 1;
    }
    say(format_args!("wrote {written} pages into {}", folder.display()));
    Ok(Ending::Done)
}

/// All commands but `help`, whose pages would say nothing.
fn root() -> clap::Command {
    let mut all = Arguments::command().disable_help_subcommand(true);
    all.build();
    all
}

fn print(text: &[u8]) -> Result<Ending, Failure> {
    Output::Stdout.write(|out| out.write_all(text))?;
    Ok(Ending::Done)
}
