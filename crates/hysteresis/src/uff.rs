//! Universal files: functions of time in datasets of type 58, ASCII.
//!
//! Source: the description of dataset 58 by SDRC, kept by the Structural Dynamics Research Laboratory of the University of
//! Cincinnati: eleven lines of header in fixed columns, then the values, with their abscissae where those are uneven.

use crate::channel_error::ChannelError;
use crate::channels::{Channel, Channels};
use crate::read::decode;
use crate::record::Quantity;

/// Whether the bytes begin with a dataset: a line with −1, then one with the dataset's number.
pub(crate) fn is_uff(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(bytes.get(..400).unwrap_or(bytes));
    let mut lines = start.lines().map(str::trim).filter(|line| !line.is_empty());
    let number =
        |line: &str| line.split_whitespace().next().is_some_and(|word| dataset_number(word).is_some());
    lines.next() == Some("-1") && lines.next().is_some_and(number)
}

/// The number of a dataset, and whether its data are binary.
fn dataset_number(word: &str) -> Option<(u32, bool)> {
    let digits = word.trim_end_matches('b');
    Some((digits.parse().ok()?, digits.len() < word.len()))
}

/// How the values of a dataset are written.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Form {
    double: bool,
    even: bool,
    count: usize,
    minimum: f64,
    increment: f64,
}

#[derive(Debug)]
struct Dataset {
    form: Form,
    /// Its abscissa is time.
    over_time: bool,
    time: Channel,
    /// Line of the first value, counted from 0.
    first: usize,
}

/// The functions of a universal file.
#[derive(Debug)]
pub(crate) struct UffChannels {
    lines: Vec<String>,
    channels: Vec<Channel>,
    datasets: Vec<Dataset>,
}

impl UffChannels {
    pub(crate) fn open(bytes: &[u8]) -> Result<Self, ChannelError> {
        let lines: Vec<String> = decode(bytes).lines().map(|line| line.trim_end().to_owned()).collect();
        let mut file = Self { lines, channels: Vec::new(), datasets: Vec::new() };
        let mut at = 0;
        while at < file.lines.len() {
            if file.line(at).trim() != "-1" {
                at += 1;
                continue;
            }
            let number = file.line(at + 1).split_whitespace().next().and_then(dataset_number);
            if let Some((58, binary)) = number {
                if binary {
                    return Err(ChannelError::File(format!(
                        "line {}: dataset 58b has binary data, which are not read; write it as ASCII (58)",
                        at + 2
                    )));
                }
                file.dataset(at + 2)?;
            }
            // Up to the line that ends the dataset.
            at += 1;
            while at < file.lines.len() && file.line(at).trim() != "-1" {
                at += 1;
            }
            at += 1;
        }
        if file.channels.is_empty() {
            return Err(ChannelError::File("the universal file has no function (dataset 58)".into()));
        }
        Ok(file)
    }

    fn line(&self, at: usize) -> &str {
        self.lines.get(at).map_or("", String::as_str)
    }

    /// Reads the eleven lines of a header that begins at line `at`, counted from 0.
    fn dataset(&mut self, at: usize) -> Result<(), ChannelError> {
        let bad = |offset: usize, what: &str| {
            Err(ChannelError::File(format!("line {}: dataset 58: {what}", at + offset + 1)))
        };
        if self.lines.len() < at + 11 {
            return bad(0, "the file ends within its header");
        }
        let dof = self.line(at + 5);
        let Some(function) = whole(slice(dof, 0, 5)) else {
            return bad(5, "no type of function in the first five columns");
        };
        let form = self.line(at + 6);
        let numbers = || {
            let [kind, count, spacing] = [0, 10, 20].map(|from| whole(slice(form, from, from + 10)));
            let [minimum, increment] = [30, 43].map(|from| number(slice(form, from, from + 13)));
            Some((
                kind?,
                usize::try_from(count?).ok()?,
                spacing?,
                minimum.unwrap_or(0.0),
                increment.unwrap_or(0.0),
            ))
        };
        let Some((kind, count, spacing, minimum, increment)) = numbers() else {
            return bad(6, "expected type, count and spacing of the values in columns of ten characters");
        };
        let (abscissa, ordinate) = (Axis::of(self.line(at + 7)), Axis::of(self.line(at + 8)));
        let unfit = if !(0..=1).contains(&function) {
            Some(format!("it is no function of time but of type {function}"))
        } else if !matches!(kind, 2 | 4) {
            Some("its values are complex".to_owned())
        } else if !(0..=1).contains(&spacing) {
            Some(format!("its spacing is {spacing}, neither 0 (uneven) nor 1 (even)"))
        } else {
            ordinate.other().map(|what| format!("the file says that it is {what}"))
        };
        let place = dof_name(dof);
        let quantity = ordinate.quantity();
        let number = self.channels.len() + 1;
        let entity = slice(dof, 31, 41);
        let mut aliases: Vec<String> = [ordinate.label.as_str(), self.line(at).trim()]
            .into_iter()
            .filter(|label| !label.is_empty() && *label != "NONE")
            .map(str::to_owned)
            .collect();
        if !entity.is_empty() && entity != "NONE" {
            aliases.push(format!("{entity}:{place}"));
        }
        let kind_of = quantity.map_or_else(|| ordinate.label.clone(), |quantity| quantity.to_string());
        self.channels.push(Channel {
            name: place,
            aliases,
            number: Some(number),
            quantity,
            unit: Some(ordinate.unit.clone()),
            unfit,
            what: if kind_of.is_empty() { format!("line {}", at + 1) } else { kind_of },
        });
        self.datasets.push(Dataset {
            form: Form { double: kind == 4, even: spacing == 1, count, minimum, increment },
            over_time: abscissa.kind == 17 || (function == 1 && abscissa.kind <= 1),
            time: Channel {
                name: format!("abscissa of dataset {number}"),
                aliases: Vec::new(),
                number: None,
                quantity: Some(Quantity::Time),
                unit: Some(abscissa.unit),
                unfit: None,
                what: String::new(),
            },
            first: at + 11,
        });
        Ok(())
    }

    /// The numbers of a dataset in the order of the file.
    fn numbers(&self, dataset: &Dataset) -> Result<Vec<f64>, ChannelError> {
        let Form { double, even, count, .. } = dataset.form;
        let wanted = if even { count } else { count.saturating_mul(2) };
        let widths: &[usize] = match (double, even) {
            (false, _) => &[13],
            (true, true) => &[20],
            (true, false) => &[13, 20],
        };
        let mut values = Vec::new();
        for (at, line) in self.lines.iter().enumerate().skip(dataset.first) {
            if values.len() >= wanted || line.trim() == "-1" {
                break;
            }
            let words: Option<Vec<f64>> = line.split_whitespace().map(number).collect();
            let found = words.or_else(|| columns(line, widths)).ok_or_else(|| {
                ChannelError::File(format!("line {}: expected numbers, got `{}`", at + 1, slice(line, 0, 40)))
            })?;
            values.extend(found);
        }
        if values.len() != wanted {
            return Err(ChannelError::File(format!(
                "line {}: dataset 58 has {} numbers instead of {wanted}",
                dataset.first + 1,
                values.len()
            )));
        }
        Ok(values)
    }
}

impl Channels for UffChannels {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn values(&self, channel: usize) -> Result<Vec<f64>, ChannelError> {
        let Some(dataset) = self.datasets.get(channel) else { return Ok(Vec::new()) };
        let numbers = self.numbers(dataset)?;
        let (first, step) = if dataset.form.even { (0, 1) } else { (1, 2) };
        Ok(numbers.into_iter().skip(first).step_by(step).collect())
    }

    fn instants(&self, channel: usize) -> Result<Option<(Channel, Vec<f64>)>, ChannelError> {
        let Some(dataset) = self.datasets.get(channel).filter(|dataset| dataset.over_time) else {
            return Ok(None);
        };
        let Form { even, minimum, increment, .. } = dataset.form;
        let numbers = self.numbers(dataset)?;
        let instants = match even {
            // A file without times.
            true if increment == 0.0 => return Ok(None),
            true => (0..numbers.len()).map(|k| minimum + k as f64 * increment).collect(),
            false => numbers.into_iter().step_by(2).collect(),
        };
        Ok(Some((dataset.time.clone(), instants)))
    }
}

/// What a line of the header says about an axis.
struct Axis {
    kind: i64,
    label: String,
    unit: String,
}

impl Axis {
    fn of(line: &str) -> Self {
        let given = |text: &str| if text == "NONE" { String::new() } else { text.to_owned() };
        Self {
            kind: whole(slice(line, 0, 10)).unwrap_or(0),
            label: given(slice(line, 26, 46)),
            unit: given(slice(line, 47, 67)),
        }
    }

    fn quantity(&self) -> Option<Quantity> {
        match self.kind {
            8 => Some(Quantity::Displacement),
            9 | 13 => Some(Quantity::Force),
            _ => None,
        }
    }

    /// What it is if it is neither a displacement nor a force, nor unknown.
    fn other(&self) -> Option<&'static str> {
        Some(match self.kind {
            2 => "a stress",
            3 => "a strain",
            5 => "a temperature",
            6 => "a heat flux",
            11 => "a velocity",
            12 => "an acceleration",
            15 => "a pressure",
            16 => "a mass",
            17 => "a time",
            18 => "a frequency",
            19 => "a speed of revolution",
            20 => "an order",
            _ => return None,
        })
    }
}

/// The dof of the response, for example `12+X`.
fn dof_name(line: &str) -> String {
    let node = slice(line, 41, 51);
    let direction = match slice(line, 51, 55) {
        "1" => "+X",
        "-1" => "-X",
        "2" => "+Y",
        "-2" => "-Y",
        "3" => "+Z",
        "-3" => "-Z",
        "4" => "+RX",
        "-4" => "-RX",
        "5" => "+RY",
        "-5" => "-RY",
        "6" => "+RZ",
        "-6" => "-RZ",
        _ => "",
    };
    format!("{node}{direction}")
}

/// Characters `from` to `to` of a line, trimmed; what is beyond its end is empty.
fn slice(line: &str, from: usize, to: usize) -> &str {
    let at = |count: usize| line.char_indices().nth(count).map_or(line.len(), |(at, _)| at);
    line.get(at(from)..at(to)).unwrap_or_default().trim()
}

fn whole(text: &str) -> Option<i64> {
    text.parse().ok()
}

/// A number as FORTRAN writes it: the letter of the exponent may be D, or missing where the exponent has three digits.
fn number(text: &str) -> Option<f64> {
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    if text.contains(['D', 'd']) {
        return text.replace(['D', 'd'], "E").parse().ok();
    }
    let sign = text.rfind(['+', '-']).filter(|at| *at > 0)?;
    let (mantissa, exponent) = text.split_at_checked(sign)?;
    let complete = mantissa.contains('.') && exponent.len() == 4;
    complete.then(|| format!("{mantissa}E{exponent}").parse().ok()).flatten()
}

/// The numbers of a line in columns of these widths, one after the other and again.
fn columns(line: &str, widths: &[usize]) -> Option<Vec<f64>> {
    let length = line.chars().count();
    let (mut from, mut found) = (0, Vec::new());
    for width in widths.iter().cycle() {
        if from >= length {
            return Some(found);
        }
        found.push(number(slice(line, from, from + width))?);
        from += width;
    }
    None
}
