//! Records in files of arrays: NumPy's and MATLAB's.

use arrays::{ArrayFile, Entry, Format, extents};

use crate::channel_error::ChannelError;
use crate::channels::{Channel, Channels};
use crate::table;

/// Columns of a matrix beyond this are not columns of a record: it lies on its side.
const MOST_COLUMNS: usize = 64;

/// The columns of the arrays of a file.
pub(crate) struct ArrayChannels<'a> {
    file: ArrayFile<'a>,
    channels: Vec<Channel>,
    /// Array and column of each channel.
    places: Vec<(usize, usize)>,
}

impl<'a> ArrayChannels<'a> {
    pub(crate) fn open(bytes: &'a [u8], format: Format) -> Result<Self, ChannelError> {
        let file = ArrayFile::open(bytes, format).map_err(|error| ChannelError::File(error.to_string()))?;
        let (mut channels, mut places) = (Vec::new(), Vec::new());
        let single = file.entries().len() == 1;
        for (index, entry) in file.entries().iter().enumerate() {
            let unfit = unfit(entry);
            let columns = match entry.samples_and_columns() {
                Some((_, columns)) if unfit.is_none() => columns,
                _ => 1,
            };
            for column in 0..columns {
                let number = (single && unfit.is_none()).then_some(column + 1);
                channels.push(Channel {
                    name: name(entry, column, columns),
                    aliases: Vec::new(),
                    number,
                    quantity: None,
                    unit: None,
                    unfit: unfit.clone(),
                    what: match &entry.other {
                        Some(other) if entry.shape.is_empty() => other.clone(),
                        Some(other) => format!("{}, {other}", extents(&entry.shape)),
                        None if columns > 1 => format!("of {}", extents(&entry.shape)),
                        None => extents(&entry.shape),
                    },
                });
                places.push((index, column));
            }
        }
        Ok(Self { file, channels, places })
    }
}

/// `force [N]`, or of a matrix `data:2`.
fn name(entry: &Entry, column: usize, columns: usize) -> String {
    match (entry.name.as_str(), columns) {
        ("", _) => String::new(),
        (name, 1) => name.to_owned(),
        (name, _) => match table::name_and_unit(name) {
            (bare, Some(unit)) => format!("{bare}:{} [{unit}]", column + 1),
            (bare, None) => format!("{bare}:{}", column + 1),
        },
    }
}

fn unfit(entry: &Entry) -> Option<String> {
    if let Some(other) = &entry.other {
        return Some(format!("it is no array of real numbers: {other}"));
    }
    match entry.samples_and_columns() {
        None => Some(format!(
            "it is an array of {}; a vector, or a matrix with a sample a row is needed",
            extents(&entry.shape)
        )),
        Some((samples, columns)) if columns > samples.max(1) || columns > MOST_COLUMNS => Some(format!(
            "it is {}; a matrix needs a sample a row, save its transpose",
            extents(&entry.shape)
        )),
        Some(_) => None,
    }
}

impl Channels for ArrayChannels<'_> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn values(&self, channel: usize) -> Result<Vec<f64>, ChannelError> {
        let place = self
            .places
            .get(channel)
            .and_then(|(array, column)| Some((self.file.entries().get(*array)?, *column)));
        let Some((entry, column)) = place else { return Ok(Vec::new()) };
        self.file.column(entry, column).map_err(|error| ChannelError::File(error.to_string()))
    }
}
