//! Archives of NumPy arrays (`.npz`): a zip of `.npy` files.

use std::io::{Read, Seek};

use zip::ZipArchive;

use crate::error::{ArrayError, wrong};
use crate::npy::NpyReader;

/// An archive whose list of arrays was read.
#[derive(Debug)]
pub struct NpzReader<R>(ZipArchive<R>);

/// An array within an archive.
pub type Member<'a> = NpyReader<&'a mut dyn Read>;

impl<R: Read + Seek> NpzReader<R> {
    /// Reads the list of arrays.
    ///
    /// # Errors
    /// When it is no archive.
    pub fn open(bytes: R) -> Result<Self, ArrayError> {
        let archive =
            ZipArchive::new(bytes).map_err(|error| wrong(format!("is no .npz archive: {error}")))?;
        Ok(Self(archive))
    }

    /// The names of its arrays.
    pub fn names(&self) -> Vec<String> {
        self.0.file_names().filter_map(|name| Some(name.ok()?.strip_suffix(".npy")?.to_owned())).collect()
    }

    /// Hands the array `name` to `read`.
    ///
    /// # Errors
    /// When there is no such array, or what `read` answers; both name the array.
    pub fn read<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(Member<'_>) -> Result<T, ArrayError>,
    ) -> Result<T, ArrayError> {
        let within = |error: ArrayError| wrong(format!("array {name:?}: {error}"));
        let mut file =
            self.0.by_name(&format!("{name}.npy")).map_err(|error| within(wrong(error.to_string())))?;
        let length = file.size();
        NpyReader::open(&mut file as &mut dyn Read, length).and_then(read).map_err(within)
    }
}
