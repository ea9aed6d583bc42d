//! Finished cases of a study that runs, one a line, so that an interrupted study goes on where it was.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::cases::FinishedCase;
use crate::error::StudyError;
use crate::grid::Study;

/// The first line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    stickslip_study: u32,
    fingerprint: String,
    cases: usize,
}

impl Header {
    fn of(study: &Study) -> Self {
        let fingerprint = study.fingerprint().to_string();
        Self { stickslip_study: FORMAT, fingerprint, cases: study.cases() }
    }
}

/// Raised when lines of older programs would be misread.
const FORMAT: u32 = 1;

/// A file of finished cases.
#[derive(Debug)]
pub struct Partial {
    path: PathBuf,
    file: File,
}

impl Partial {
    /// Opens the file beside `output` (`OUTPUT.part`) and reads the cases that are finished; a last line that was only
    /// half written is dropped. With `restart` it begins anew.
    ///
    /// # Errors
    /// [`StudyError::OtherStudy`] when it belongs to another study, [`StudyError::Busy`] when another run works on it,
    /// [`StudyError::Keeping`] when it cannot be used.
    pub fn open(
        study: &Study,
        output: &Path,
        restart: bool,
    ) -> Result<(Self, Vec<FinishedCase>), StudyError> {
        let mut name: OsString = output.as_os_str().to_owned();
        name.push(".part");
        let path = PathBuf::from(name);
        let keeping = |source| StudyError::Keeping { path: path.clone(), source };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(keeping)?;
        // Two runs would overwrite each other; where files cannot be locked nobody can know.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(StudyError::Busy { path });
        }
        if restart {
            file.set_len(0).map_err(keeping)?;
        }
        let header = Header::of(study);
        let found = read(&file, &header, study.cases()).map_err(keeping)?;
        let (finished, length) = match found {
            Found::Nothing => {
                file.set_len(0).and_then(|()| file.rewind()).map_err(keeping)?;
                write_line(&mut file, &header).map_err(keeping)?;
                return Ok((Self { path, file }, Vec::new()));
            }
            Found::Another => return Err(StudyError::OtherStudy { path }),
            Found::Cases(finished, length) => (finished, length),
        };
        file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(keeping)?;
        Ok((Self { path, file }, finished))
    }

    /// Keeps a case; it is on its way to the disk when this returns.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&mut self, case: &FinishedCase) -> Result<(), StudyError> {
        let keeping = |source| StudyError::Keeping { path: self.path.clone(), source };
        write_line(&mut self.file, case).map_err(keeping)
    }

    /// Calls the file `output`: it holds all cases of a shard, to be read by [`Partial::finished`].
    ///
    /// # Errors
    /// When it cannot be brought to the disk under that name.
    pub fn finish(self, output: &Path) -> Result<(), StudyError> {
        let keeping = |source| StudyError::Keeping { path: output.to_owned(), source };
        self.file.sync_all().map_err(keeping)?;
        std::fs::rename(&self.path, output).map_err(keeping)
    }

    /// The finished cases in a file that [`Partial::finish`] left, or in one that a run stopped early left.
    ///
    /// # Errors
    /// [`StudyError::NoCases`] when it is none of `study`, [`StudyError::Unreadable`] when it cannot be read.
    pub fn finished(study: &Study, path: &Path) -> Result<Vec<FinishedCase>, StudyError> {
        let unreadable = |source| StudyError::Unreadable { path: path.to_owned(), source };
        let file = File::open(path).map_err(unreadable)?;
        match read(&file, &Header::of(study), study.cases()).map_err(unreadable)? {
            Found::Cases(finished, _) => Ok(finished),
            Found::Nothing | Found::Another => Err(StudyError::NoCases { path: path.to_owned() }),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the file: the result is written.
    pub fn remove(self) {
        drop(self.file);
        // Left behind it does no harm: it is known to be complete.
        let _ = std::fs::remove_file(&self.path);
    }
}

fn write_line(file: &mut File, value: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    // One write a line: what breaks is the last line, never one in the middle.
    file.write_all(&line)
}

enum Found {
    Nothing,
    Another,
    /// Finished cases and the length of the whole lines in bytes.
    Cases(Vec<FinishedCase>, u64),
}

fn read(file: &File, expected: &Header, cases: usize) -> io::Result<Found> {
    let mut lines = BufReader::new(file);
    let mut line = Vec::new();
    let length = lines.read_until(b'\n', &mut line)? as u64;
    if !line.ends_with(b"\n") {
        // Empty, or stopped in the first line; but something else must not be overwritten.
        let mine = serde_json::to_vec(expected)?.starts_with(&line);
        return Ok(if mine { Found::Nothing } else { Found::Another });
    }
    if serde_json::from_slice::<Header>(&line).ok().as_ref() != Some(expected) {
        return Ok(Found::Another);
    }
    let mut whole = length;
    let mut finished = BTreeMap::new();
    loop {
        line.clear();
        let length = lines.read_until(b'\n', &mut line)? as u64;
        if !line.ends_with(b"\n") {
            break;
        }
        let Ok(case) = serde_json::from_slice::<FinishedCase>(&line) else { break };
        whole += length;
        if case.case < cases {
            finished.insert(case.case, case);
        }
    }
    Ok(Found::Cases(finished.into_values().collect(), whole))
}
