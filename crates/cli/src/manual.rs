//! `stickslip completions` and `stickslip man`.

use clap::CommandFactory;
use clap_complete::Shell;

use crate::arguments::Arguments;
use crate::ending::{Ending, Failure};
use crate::output::Output;

/// Prints the completions of a shell.
pub fn completions(shell: Shell) -> Result<Ending, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "stickslip", &mut text);
    print(&text)
}

/// Prints the manual page, or that of one command.
pub fn page(command: Option<&str>) -> Result<Ending, Failure> {
    let mut all = Arguments::command();
    all.build();
    let chosen = match command {
        None => all,
        Some(name) => {
            let names: Vec<String> = all.get_subcommands().map(|c| c.get_name().to_owned()).collect();
            let found = all.find_subcommand(name).cloned();
            found.ok_or_else(|| {
                Failure::input(format!("there is no command {name:?}; there are {}", names.join(", ")))
            })?
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(chosen).render(&mut text).map_err(Failure::stdout)?;
    print(&text)
}

fn print(text: &[u8]) -> Result<Ending, Failure> {
    Output::Stdout.write(|out| out.write_all(text))?;
    Ok(Ending::Done)
}
