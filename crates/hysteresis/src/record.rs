//! A record: displacement and force of a rig over its samples, in SI units.

use std::fmt::{self, Write as _};
use std::path::Path;
use std::str::FromStr;

use crate::options::ReadOptions;
use crate::read;
use crate::record_error::RecordError;
use crate::units::{ForceUnit, LengthUnit, TimeUnit};

/// What a column of a record holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Time, optional.
    Time,
    /// Relative displacement of the two contact partners.
    Displacement,
    /// Force the rig applies.
    Force,
}

impl Quantity {
    /// Its name as used in options, headers and messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Force => "force",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        [Self::Time, Self::Displacement, Self::Force]
            .into_iter()
            .find(|quantity| quantity.name() == text)
            .ok_or_else(|| format!("`{text}` is none of time, displacement, force"))
    }
}

/// A measured record in SI units, rig convention (force as the rig applies it).
///
/// All vectors have the same length, one entry a sample, in the order of measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Time \[s\]; never decreases. `None` when the file has no time column.
    pub time: Option<Vec<f64>>,
    /// Displacement \[m\].
    pub displacement: Vec<f64>,
    /// Force \[N\].
    pub force: Vec<f64>,
    /// Line of the file every sample came from, 1 being the first; empty when it came from no file.
    pub lines: Vec<usize>,
}

impl Record {
    /// A record from samples in SI units: time \[s\] (or none), displacement \[m\], force \[N\].
    ///
    /// # Errors
    /// [`RecordError::Lengths`] unless all have the same length.
    pub fn new(time: Option<Vec<f64>>, displacement: Vec<f64>, force: Vec<f64>) -> Result<Self, RecordError> {
        let n = displacement.len();
        if force.len() != n || time.as_ref().is_some_and(|t| t.len() != n) {
            return Err(RecordError::Lengths {
                time: time.map(|t| t.len()),
                displacement: n,
                force: force.len(),
            });
        }
        Ok(Self { time, displacement, force, lines: Vec::new() })
    }

    /// Reads a file of any of the forms of [`Record::from_bytes`].
    ///
    /// # Errors
    /// [`RecordError::InFile`] with the path, around what [`Record::from_bytes`] reports, or
    /// [`RecordError::Unreadable`].
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, RecordError> {
        let bytes = std::fs::read(path)
            .map_err(|source| RecordError::Unreadable { path: path.to_owned(), source })?;
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        read::named(extension.as_deref(), &bytes)
            .and_then(|()| Self::from_bytes(&bytes, options))
            .map_err(|source| RecordError::InFile { path: path.to_owned(), source: Box::new(source) })
    }

    /// Reads the bytes of a file, whose form is told by its first bytes:
    ///
    /// - arrays of NumPy (`.npy`, `.npz`) and variables of MATLAB (`.mat` up to version 7): each vector, and each column of a matrix,
    ///   is a column of the record; it is chosen by its name, `disp`, or `data:2` for the second column of `data`, or by its number
    ///   where the file has one array;
    /// - universal files: datasets of type 58 in ASCII, chosen by their dof, `12+X`, their label, or their number;
    /// - else a text, see [`Record::parse`], which beyond UTF-8 may also be UTF-16 with a byte order mark or Latin-1.
    ///
    /// # Errors
    /// What is wrong, where, and what to try.
    pub fn from_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Self, RecordError> {
        read::from_bytes(bytes, options)
    }

    /// Reads the text of a file.
    ///
    /// The usual form is a header with names and units in brackets, then one line a sample:
    ///
    /// ```text
    /// time \[s\],displacement [um],force \[N\]
    /// 0.000,0.00,0.0
    /// 0.001,0.05,0.7
    /// ```
    ///
    /// Columns are separated by commas, semicolons, tabs or spaces; with semicolons and tabs the decimal sign
    /// may be a comma. Lines that start with `#`, empty lines, quotes around fields, a byte order mark and
    /// line ends of any system are understood. Units may also stand in a line of their own below the names.
    /// A file without header needs the numbers of its columns and their units in `options`.
    ///
    /// # Errors
    /// What is wrong, in which line and column, and what to try.
    pub fn parse(text: &str, options: &ReadOptions) -> Result<Self, RecordError> {
        read::parse(text, options)
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.displacement.len()
    }

    /// Whether it has no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.displacement.is_empty()
    }

    /// The record as a text that [`Record::parse`] reads back, in the given units.
    #[must_use]
    pub fn to_csv(&self, length: LengthUnit, force: ForceUnit, time: TimeUnit) -> String {
        let mut text = String::new();
        if self.time.is_some() {
            let _ = write!(text, "time [{time}],");
        }
        let _ = writeln!(text, "displacement [{length}],force [{force}]");
        let times = self.time.iter().flatten().map(Some).chain(std::iter::repeat(None));
        for ((w, f), t) in self.displacement.iter().zip(&self.force).zip(times) {
            if let Some(t) = t {
                let _ = write!(text, "{:?},", t / time.in_si());
            }
            let _ = writeln!(text, "{:?},{:?}", w / length.in_si(), f / force.in_si());
        }
        text
    }

    /// How to name a sample in a message: by its line in the file where there was one.
    pub(crate) fn place(&self, sample: usize) -> String {
        match self.lines.get(sample) {
            Some(line) => format!("line {line}"),
            None => format!("sample {}", sample + 1),
        }
    }
}
