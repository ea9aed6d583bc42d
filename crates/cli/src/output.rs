//! Where results go: standard output, or a file that appears whole or not at all.

use std::fs;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use arrays::{NpzWriter, Table};
use tempfile::NamedTempFile;

use crate::arguments::{Format, TableFormat};
use crate::ending::{Ending, Failure};

/// A result that is still to come. For a file, that it can be written is known before the work begins.
#[derive(Debug)]
pub enum Output {
    /// Standard output.
    Stdout,
    /// A new file beside the one it will become.
    Beside {
        /// What is written to.
        file: NamedTempFile,
        /// What it becomes.
        path: PathBuf,
    },
    /// A device or a pipe, which is written as it is.
    Device(PathBuf),
}

impl Output {
    /// An output to `path`, or to standard output.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let Some(path) = path else {
            return Ok(Self::Stdout);
        };
        let known = fs::metadata(path).ok();
        if known.as_ref().is_some_and(fs::Metadata::is_dir) {
            return Err(unwritable(path, "it is a folder; name a file in it"));
        }
        if known.as_ref().is_some_and(|data| !data.is_file()) {
            return Ok(Self::Device(path.to_owned()));
        }
        // The file that a link points to is replaced, not the link.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".stickslip-");
        let permissions = known.map_or_else(usual_permissions, |data| Some(data.permissions()));
        if let Some(permissions) = permissions {
            builder.permissions(permissions);
        }
        let file = builder.tempfile_in(folder).map_err(|error| match folder.is_dir() {
            true => unwritable(&path, reason(&error)),
            false => unwritable(&path, format!("there is no folder {}", folder.display())),
        })?;
        Ok(Self::Beside { file, path })
    }

    /// Writes the result with `write`.
    pub fn write(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        let write = |out: &mut dyn Write| write(out).map_err(bare);
        match self {
            Self::Stdout => {
                let mut out = BufWriter::new(io::stdout().lock());
                write(&mut out).and_then(|()| out.flush()).map_err(Failure::stdout)
            }
            Self::Beside { mut file, path } => {
                let written = {
                    let mut out = BufWriter::new(&mut file);
                    write(&mut out).and_then(|()| out.flush())
                };
                written.map_err(|error| unwritable(&path, error))?;
                file.persist(&path).map_err(|error| unwritable(&path, error.error))?;
                Ok(())
            }
            Self::Device(path) => {
                let device = fs::OpenOptions::new().write(true).open(&path);
                let written = device.and_then(|file| {
                    let mut out = BufWriter::new(file);
                    write(&mut out).and_then(|()| out.flush())
                });
                written.map_err(|error| match error.kind() {
                    io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
                    _ => unwritable(&path, error),
                })
            }
        }
    }
}

/// No output may replace the input or another output.
pub fn distinct(input: &Path, outputs: &[&Option<PathBuf>]) -> Result<(), Failure> {
    let mut taken = vec![input];
    let same =
        |a: &Path, b: &Path| a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    for output in outputs.iter().filter_map(|output| output.as_deref()) {
        if !same(output, Path::new("/dev/null")) && taken.iter().any(|path| same(path, output)) {
            let problem =
                format!("{} is named twice; every output needs a file of its own", output.display());
            return Err(Failure::input(problem));
        }
        taken.push(output);
    }
    Ok(())
}

/// The form of an answer: what was asked for, else by the extension of its file, else a table on a terminal and JSON
/// into a pipe.
pub fn table_format(chosen: Option<TableFormat>, output: Option<&Path>) -> Result<TableFormat, Failure> {
    let terminal = output.is_none() && io::stdout().is_terminal();
    let format = match (chosen, output) {
        (Some(chosen), _) => chosen,
        (None, None) if terminal => TableFormat::Text,
        (None, None) => TableFormat::Json,
        (None, Some(path)) => by_extension(path, true)?,
    };
    possible(format, terminal)?;
    Ok(format)
}

/// The form of a full result; `None` is the table for a terminal.
pub fn full_format(chosen: Option<Format>, output: Option<&Path>) -> Result<Option<TableFormat>, Failure> {
    let terminal = output.is_none() && io::stdout().is_terminal();
    let format = match (chosen, output) {
        (Some(chosen), _) => chosen.into(),
        (None, None) if terminal => return Ok(None),
        (None, None) => TableFormat::Json,
        (None, Some(path)) => by_extension(path, false)?,
    };
    possible(format, terminal)?;
    Ok(Some(format))
}

/// The form by the extension of a file's name; JSON where it has none.
fn by_extension(path: &Path, text: bool) -> Result<TableFormat, Failure> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    Ok(match extension.as_deref() {
        None | Some("json") => TableFormat::Json,
        Some("csv") => TableFormat::Csv,
        Some("npz") => TableFormat::Npz,
        Some("parquet") => TableFormat::Parquet,
        Some("txt") if text => TableFormat::Text,
        Some(other) => {
            let txt = if text { ", .txt" } else { "" };
            return Err(Failure::input(format!(
                "-o {}: no format is called .{other}; name the file .json, .csv{txt}, .npz or .parquet, or add --format json",
                path.display()
            )));
        }
    })
}

/// Refuses bytes on a terminal.
fn possible(format: TableFormat, terminal: bool) -> Result<(), Failure> {
    match format {
        TableFormat::Npz | TableFormat::Parquet if terminal => {
            Err(Failure::input("this format is no text; name a file with -o"))
        }
        _ => Ok(()),
    }
}

/// Writes a flat table about `name` in a form that is one.
pub fn table(out: &mut dyn Write, format: TableFormat, table: &Table, name: &str) -> io::Result<()> {
    match format {
        TableFormat::Npz => {
            let mut archive = NpzWriter::new(out);
            table.write_npz(&mut archive)?;
            archive.finish()
        }
        TableFormat::Parquet => {
            let version = env!("CARGO_PKG_VERSION");
            let about = [
                ("stickslip.scene", name),
                ("stickslip.version", version),
                ("stickslip.units", "SI, Hz, rad"),
            ];
            table.write_parquet(out, &about)
        }
        _ => table.write_csv(out),
    }
}

/// The system's error without the wrapping of the writer of tables, which hides that a pipe is closed.
fn bare(error: io::Error) -> io::Error {
    match error.downcast::<csv::Error>() {
        Ok(table) => match table.into_kind() {
            csv::ErrorKind::Io(error) => error,
            other => io::Error::other(format!("{other:?}")),
        },
        Err(error) => error,
    }
}

/// The system's reason without the made-up name of the file beside.
fn reason(error: &io::Error) -> String {
    let system = error.raw_os_error().or_else(|| {
        let inner = error.get_ref()?.source()?;
        inner.downcast_ref::<io::Error>()?.raw_os_error()
    });
    system.map_or_else(|| error.kind().to_string(), |code| io::Error::from_raw_os_error(code).to_string())
}

/// What a new file gets from the system, less the user's mask.
#[cfg(unix)]
fn usual_permissions() -> Option<fs::Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<fs::Permissions> {
    None
}

/// An output that cannot be written.
pub fn unwritable(path: &Path, why: impl std::fmt::Display) -> Failure {
    Failure::Output(anyhow::anyhow!("cannot write {}: {why}", path.display()))
}

/// Prints a text that is a whole result.
pub fn print(text: &str) -> Result<Ending, Failure> {
    Output::Stdout.write(|out| out.write_all(text.as_bytes()))?;
    Ok(Ending::Done)
}

/// Prints a result as JSON.
pub fn print_json(result: &impl serde::Serialize) -> Result<Ending, Failure> {
    Output::Stdout.write(|out| scene::write_json(out, result))?;
    Ok(Ending::Done)
}
