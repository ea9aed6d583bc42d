//! How a command ends, and the exit code that says so.

use std::fmt;
use std::io::{self, Write};
use std::process::ExitCode;

/// A command that did its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// All points were solved, or there was nothing to solve.
    Done,
    /// Some points were not solved; the result says which.
    SomeFailed,
    /// Ctrl-C; finished points were written.
    Interrupted,
}

impl Ending {
    /// 0, 1 or 130.
    pub fn code(self) -> ExitCode {
        ExitCode::from(match self {
            Self::Done => 0,
            Self::SomeFailed => 1,
            Self::Interrupted => 130,
        })
    }
}

/// A command that could not do its work.
#[derive(Debug)]
pub enum Failure {
    /// A scene, a record or arguments that cannot be used.
    Input(anyhow::Error),
    /// An output that cannot be written.
    Output(anyhow::Error),
    /// Whoever read our output has seen enough.
    ClosedPipe,
}

impl Failure {
    /// An input that cannot be used, with what is wrong.
    pub fn input(problem: impl fmt::Display + fmt::Debug + Send + Sync + 'static) -> Self {
        Self::Input(anyhow::anyhow!(problem))
    }

    /// Standard output that cannot be written to.
    pub fn stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::ClosedPipe;
        }
        Self::Output(anyhow::anyhow!("cannot write to standard output: {error}"))
    }

    /// 2, 3 or 0.
    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Input(_) => 2,
            Self::Output(_) => 3,
            Self::ClosedPipe => 0,
        })
    }

    /// What to tell the user.
    pub fn message(&self) -> Option<String> {
        match self {
            Self::Input(error) | Self::Output(error) => Some(format!("{error:#}")),
            Self::ClosedPipe => None,
        }
    }
}

/// One line on standard error. That nobody reads it is no failure.
pub fn say(message: fmt::Arguments) {
    let _ = writeln!(io::stderr(), "{message}");
}
