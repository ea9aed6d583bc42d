//! From the text of a file to a record: which column is which, in which unit, and the numbers.

use std::borrow::Cow;

use arrays::Format;

use crate::array_file::ArrayChannels;
use crate::channel_error::ChannelError;
use crate::channels;
use crate::options::{Column, ReadOptions};
use crate::record::{Quantity, Record};
use crate::record_error::RecordError;
use crate::table::{self, Delimiter};
use crate::uff::{self, UffChannels};
use crate::units::{ForceUnit, LengthUnit, TimeUnit, UnknownUnit};

/// The text of a file: UTF-8, UTF-16 with a byte order mark, or else Latin-1 (which has a micro sign too).
pub(crate) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let utf16 = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.as_chunks::<2>().0.iter().map(|&pair| unit(pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match (bytes, std::str::from_utf8(bytes)) {
        ([0xff, 0xfe, rest @ ..], _) => utf16(rest, u16::from_le_bytes),
        ([0xfe, 0xff, rest @ ..], _) => utf16(rest, u16::from_be_bytes),
        (_, Ok(text)) => Cow::Borrowed(text),
        (_, Err(_)) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    }
}

/// Names that a quantity's column goes by, in lower case.
pub(crate) fn usual_names(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Time => &["time", "t"],
        Quantity::Displacement => {
            &["displacement", "relative displacement", "disp", "d", "w", "x", "u", "deflection", "stroke"]
        }
        Quantity::Force => &["force", "friction force", "f", "load"],
    }
}

pub(crate) fn example_unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "s",
        Quantity::Displacement => "um",
        Quantity::Force => "N",
    }
}

/// Size of a unit of `quantity` in SI units.
pub(crate) fn unit_in_si(quantity: Quantity, text: &str) -> Result<f64, UnknownUnit> {
    Ok(match quantity {
        Quantity::Time => text.parse::<TimeUnit>()?.in_si(),
        Quantity::Displacement => text.parse::<LengthUnit>()?.in_si(),
        Quantity::Force => text.parse::<ForceUnit>()?.in_si(),
    })
}

/// Size in SI units of the unit that the caller gives for `quantity`.
pub(crate) fn given_unit(quantity: Quantity, options: &ReadOptions) -> Option<f64> {
    match quantity {
        Quantity::Time => options.units.time.map(TimeUnit::in_si),
        Quantity::Displacement => options.units.displacement.map(LengthUnit::in_si),
        Quantity::Force => options.units.force.map(ForceUnit::in_si),
    }
}

/// The names and units above the numbers.
struct Header {
    line: usize,
    /// Each field as it is written.
    columns: Vec<String>,
    /// Units from a line of their own.
    unit_line: Vec<String>,
}

impl Header {
    fn name(&self, index: usize) -> &str {
        self.columns.get(index).map_or("", |field| table::name_and_unit(field).0)
    }

    fn unit(&self, index: usize) -> Option<&str> {
        let beside = self.columns.get(index).and_then(|field| table::name_and_unit(field).1);
        beside.or_else(|| self.unit_line.get(index).map(String::as_str).filter(|unit| !unit.is_empty()))
    }

    fn list(&self, indices: impl IntoIterator<Item = usize>) -> String {
        let named: Vec<String> = indices
            .into_iter()
            .filter_map(|i| self.columns.get(i).map(|field| format!("{} `{field}`", i + 1)))
            .collect();
        named.join(", ")
    }

    /// The column that looks like `quantity`: by its name, else by its unit.
    fn find(&self, quantity: Quantity) -> Result<Option<usize>, RecordError> {
        let all = 0..self.columns.len();
        let named = |names: &[&str]| -> Vec<usize> {
            all.clone().filter(|&i| names.contains(&self.name(i).to_lowercase().as_str())).collect()
        };
        let measured = || -> Vec<usize> {
            all.clone()
                .filter(|&i| self.unit(i).is_some_and(|unit| unit_in_si(quantity, unit).is_ok()))
                .collect()
        };
        let mut candidates = named(usual_names(quantity).split_at(1).0);
        if candidates.is_empty() {
            candidates = named(usual_names(quantity));
        }
        if candidates.is_empty() {
            candidates = measured();
        }
        match candidates.as_slice() {
            [] => Ok(None),
            [only] => Ok(Some(*only)),
            [first, ..] => Err(RecordError::ColumnAmbiguous {
                line: self.line,
                quantity,
                candidates: self.list(candidates.iter().copied()),
                first: first + 1,
            }),
        }
    }
}

/// Where a quantity stands and what one of its numbers is worth in SI units.
struct Source {
    quantity: Quantity,
    column: usize,
    factor: f64,
}

impl Source {
    fn locate(
        quantity: Quantity,
        header: Option<&Header>,
        options: &ReadOptions,
        first_line: usize,
        width: usize,
    ) -> Result<Option<Self>, RecordError> {
        let unknown = |wanted: &Column| RecordError::ColumnUnknown {
            quantity,
            wanted: wanted.clone(),
            found: match header {
                Some(header) => header.list(0..header.columns.len()),
                None => format!("{width} columns and no header"),
            },
        };
        let column = match (options.columns.of(quantity), header) {
            (Some(&Column::Number(number)), _) if number == 0 || number > width => {
                return Err(unknown(&Column::Number(number)));
            }
            (Some(&Column::Number(number)), _) => number - 1,
            (Some(wanted @ Column::Name(name)), Some(header)) => {
                let same = |text: &str| text.trim().to_lowercase() == name.trim().to_lowercase();
                (0..header.columns.len())
                    .find(|&i| same(header.name(i)) || header.columns.get(i).is_some_and(|field| same(field)))
                    .ok_or_else(|| unknown(wanted))?
            }
            (Some(wanted @ Column::Name(_)), None) => return Err(unknown(wanted)),
            (None, Some(header)) => match header.find(quantity)? {
                Some(column) => column,
                None if quantity == Quantity::Time => return Ok(None),
                None => {
                    let found = header.list(0..header.columns.len());
                    return Err(RecordError::ColumnMissing { line: header.line, quantity, found });
                }
            },
            (None, None) if quantity == Quantity::Time => return Ok(None),
            (None, None) => return Err(RecordError::NoHeader { line: first_line, quantity }),
        };
        let factor = match (given_unit(quantity, options), header.and_then(|header| header.unit(column))) {
            (Some(factor), _) => factor,
            (None, Some(unit)) => unit_in_si(quantity, unit).map_err(|source| RecordError::UnitUnknown {
                column: column + 1,
                quantity,
                source,
                example: example_unit(quantity),
            })?,
            (None, None) => {
                let example = example_unit(quantity);
                return Err(RecordError::UnitMissing { column: column + 1, quantity, example });
            }
        };
        Ok(Some(Self { quantity, column, factor }))
    }

    /// The number of this quantity in a line, in the file's own unit.
    fn value(&self, line: usize, fields: &[Cow<'_, str>], delimiter: Delimiter) -> Result<f64, RecordError> {
        let Self { quantity, column, .. } = *self;
        let Some(field) = fields.get(column) else {
            return Err(RecordError::ShortLine { line, found: fields.len(), needed: column + 1, quantity });
        };
        match table::number(field, delimiter) {
            Some(value) if (value * self.factor).is_finite() => Ok(value),
            Some(_) => {
                Err(RecordError::NotFinite { line, column: column + 1, quantity, text: field.to_string() })
            }
            None => {
                let hint = if field.is_empty() {
                    "; the cell is empty"
                } else if delimiter == Delimiter::Space && field.contains(',') {
                    "; decimal commas need semicolons or tabs between the columns"
                } else {
                    ""
                };
                let text = field.chars().take(40).collect();
                Err(RecordError::NotANumber { line, column: column + 1, quantity, text, hint })
            }
        }
    }
}

/// Refuses a file whose name says that it holds arrays while its bytes don't.
pub(crate) fn named(extension: Option<&str>, bytes: &[u8]) -> Result<(), RecordError> {
    let known = Format::of(bytes).map_err(|error| ChannelError::File(error.to_string()))?;
    let wanted = match extension {
        Some("mat") if known != Some(Format::Mat) => {
            "is no MATLAB file of version 5 to 7; save it with -v7: save('record.mat', '-v7')"
        }
        Some("npy") if known != Some(Format::Npy) => "is no .npy array: it does not begin with \\x93NUMPY",
        Some("npz") if known != Some(Format::Npz) => "is no .npz archive",
        _ => return Ok(()),
    };
    Err(ChannelError::File(wanted.to_owned()).into())
}

/// Reads the bytes of a file; see [`Record::from_bytes`].
pub(crate) fn from_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Record, RecordError> {
    let format = Format::of(bytes).map_err(|error| ChannelError::File(error.to_string()))?;
    if let Some(format) = format {
        return Ok(channels::record(&ArrayChannels::open(bytes, format)?, options)?);
    }
    if uff::is_uff(bytes) {
        return Ok(channels::record(&UffChannels::open(bytes)?, options)?);
    }
    parse(&decode(bytes), options)
}

/// Reads the text of a file; see [`Record::parse`].
pub(crate) fn parse(text: &str, options: &ReadOptions) -> Result<Record, RecordError> {
    let delimiter = table::detect_delimiter(text);
    let mut lines = table::content_lines(text).peekable();
    let is_number = |field: &str| table::number(field, delimiter).is_some();

    let &(first_line, first) = lines.peek().ok_or(RecordError::Empty)?;
    let mut header = None;
    if !table::fields(first, delimiter).iter().any(|field| is_number(field)) {
        lines.next();
        let columns = table::header_fields(first, delimiter);
        let mut unit_line = Vec::new();
        if let Some(&(_, second)) = lines.peek() {
            let second = table::fields(second, delimiter);
            if !second.iter().any(|field| is_number(field)) && second.iter().any(|field| is_unit(field)) {
                unit_line = second.iter().map(|field| bare_unit(field).to_owned()).collect();
                lines.next();
            }
        }
        header = Some(Header { line: first_line, columns, unit_line });
    }
    let &(first_line, first) = lines.peek().ok_or(RecordError::Empty)?;
    let width = table::fields(first, delimiter).len().max(header.as_ref().map_or(0, |h| h.columns.len()));

    let locate = |quantity| Source::locate(quantity, header.as_ref(), options, first_line, width);
    let displacement = locate(Quantity::Displacement)?.ok_or(RecordError::Empty)?;
    let force = locate(Quantity::Force)?.ok_or(RecordError::Empty)?;
    let time = locate(Quantity::Time)?;
    let pairs = [
        Some((&displacement, &force)),
        time.as_ref().map(|t| (t, &displacement)),
        time.as_ref().map(|t| (t, &force)),
    ];
    for (one, other) in pairs.into_iter().flatten() {
        if one.column == other.column {
            let column = one.column + 1;
            return Err(RecordError::ColumnTwice { column, first: one.quantity, second: other.quantity });
        }
    }

    let mut record = Record {
        time: time.as_ref().map(|_| Vec::new()),
        displacement: Vec::new(),
        force: Vec::new(),
        lines: Vec::new(),
    };
    let mut before = f64::NEG_INFINITY;
    for (line, text) in lines {
        let fields = table::fields(text, delimiter);
        let value = |source: &Source| source.value(line, &fields, delimiter);
        if let (Some(source), Some(times)) = (&time, &mut record.time) {
            let after = value(source)?;
            if after < before {
                return Err(RecordError::TimeBackwards { line, column: source.column + 1, before, after });
            }
            before = after;
            times.push(after * source.factor);
        }
        record.displacement.push(value(&displacement)? * displacement.factor);
        record.force.push(value(&force)? * force.factor * options.force_sign.factor());
        record.lines.push(line);
    }
    Ok(record)
}

/// `[um]` or `um` in a line of units.
fn bare_unit(field: &str) -> &str {
    table::name_and_unit(field).1.unwrap_or(field)
}

fn is_unit(field: &str) -> bool {
    [Quantity::Time, Quantity::Displacement, Quantity::Force]
        .into_iter()
        .any(|quantity| unit_in_si(quantity, bare_unit(field)).is_ok())
}
