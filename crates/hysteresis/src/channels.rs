//! From the channels of a file, its arrays or datasets, to a record: which is which, in which unit, and the numbers.

use crate::channel_error::ChannelError;
use crate::options::{Column, ReadOptions};
use crate::read::{example_unit, given_unit, unit_in_si, usual_names};
use crate::record::{Quantity, Record};
use crate::table;

/// Something in a file that may be a quantity of a record.
#[derive(Debug, Clone)]
pub(crate) struct Channel {
    /// How it is asked for; with a unit in brackets where the file gives one so.
    pub name: String,
    /// Other names that it goes by.
    pub aliases: Vec<String>,
    /// Its number, where channels may be chosen by number.
    pub number: Option<usize>,
    /// What the file says that it is.
    pub quantity: Option<Quantity>,
    /// Unit beside the name.
    pub unit: Option<String>,
    /// Why it cannot be chosen.
    pub unfit: Option<String>,
    /// For messages, beside the name.
    pub what: String,
}

impl Channel {
    fn bare_name(&self) -> &str {
        table::name_and_unit(&self.name).0
    }

    fn unit(&self) -> Option<&str> {
        table::name_and_unit(&self.name).1.or(self.unit.as_deref()).filter(|unit| !unit.is_empty())
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        [self.name.as_str(), self.bare_name()].into_iter().chain(self.aliases.iter().map(String::as_str))
    }

    /// `"disp" (1000 x 1)`; `number 2 (displacement …)`.
    fn shown(&self) -> String {
        let what = if self.what.is_empty() { String::new() } else { format!(" ({})", self.what) };
        match (&*self.name, self.number) {
            ("", Some(number)) => format!("column {number}{what}"),
            (name, Some(number)) => format!("{number} `{name}`{what}"),
            ("", None) => format!("an array{what}"),
            (name, None) => format!("`{name}`{what}"),
        }
    }

    /// How it is asked for on the command line.
    fn example(&self) -> String {
        self.number.map_or_else(|| self.bare_name().to_owned(), |number| number.to_string())
    }

    /// The name that tells a quantity: of a field of a struct the field's.
    fn telling(&self) -> impl Iterator<Item = String> {
        let own = self.bare_name().rsplit('.').next().unwrap_or_default();
        [own]
            .into_iter()
            .chain(self.aliases.iter().map(String::as_str))
            .map(|name| name.trim().to_lowercase())
            .collect::<Vec<_>>()
            .into_iter()
    }
}

/// A file with channels.
pub(crate) trait Channels {
    fn channels(&self) -> &[Channel];

    /// The numbers of a channel, in the file's unit.
    fn values(&self, channel: usize) -> Result<Vec<f64>, ChannelError>;

    /// The instants of a channel, in the file's unit, where they are part of it.
    fn instants(&self, _channel: usize) -> Result<Option<(Channel, Vec<f64>)>, ChannelError> {
        Ok(None)
    }
}

/// The record in a file.
pub(crate) fn record(file: &impl Channels, options: &ReadOptions) -> Result<Record, ChannelError> {
    let channels = file.channels();
    let displacement = need(channels, Quantity::Displacement, options)?;
    let force = need(channels, Quantity::Force, options)?;
    let time = choose(channels, Quantity::Time, options)?;
    for (a, b, first, second) in [
        (Some(displacement), Some(force), Quantity::Displacement, Quantity::Force),
        (Some(displacement), time, Quantity::Displacement, Quantity::Time),
        (Some(force), time, Quantity::Force, Quantity::Time),
    ] {
        if let Some(channel) = a.filter(|_| a == b).and_then(|index| channels.get(index)) {
            return Err(ChannelError::Twice { channel: channel.shown(), first, second });
        }
    }
    let shown = |index: usize| channels.get(index).map(Channel::shown).unwrap_or_default();
    let read = |index: usize, quantity| match channels.get(index) {
        Some(channel) => in_si(channel, quantity, file.values(index)?, options),
        None => Ok(Vec::new()),
    };
    let w = read(displacement, Quantity::Displacement)?;
    let mut f = read(force, Quantity::Force)?;
    f.iter_mut().for_each(|value| *value *= options.force_sign.factor());
    let mut together = vec![(force, Quantity::Force, f.len())];
    let time = match (time, file.instants(displacement)?, file.instants(force)?) {
        (Some(index), ..) => {
            let times = read(index, Quantity::Time)?;
            together.push((index, Quantity::Time, times.len()));
            Some(times)
        }
        (None, Some((channel, one)), other) => {
            let apart = other.is_some_and(|(_, other)| one.len() == other.len() && !same(&one, &other));
            if apart {
                let (displacement, force) = (shown(displacement), shown(force));
                return Err(ChannelError::Instants { displacement, force });
            }
            Some(in_si(&channel, Quantity::Time, one, options)?)
        }
        (None, None, _) => None,
    };
    for (index, quantity, found) in together {
        if found != w.len() {
            let channel = shown(index);
            return Err(ChannelError::Lengths { channel, quantity, found, expected: w.len() });
        }
    }
    Ok(Record { time, displacement: w, force: f, lines: Vec::new() })
}

/// Whether two series of instants agree within the digits of a file.
fn same(one: &[f64], other: &[f64]) -> bool {
    let span = one.first().zip(one.last()).map_or(0.0, |(first, last)| (last - first).abs());
    one.iter().zip(other).all(|(a, b)| (a - b).abs() <= 1e-5 * span)
}

/// What a message lists at most.
const LISTED: usize = 12;

fn list<'c>(channels: impl Iterator<Item = &'c Channel>) -> String {
    let each = |channel: &Channel| match &channel.unfit {
        Some(problem) => format!("{}, but {problem}", channel.shown()),
        None => channel.shown(),
    };
    let mut shown: Vec<String> = channels.map(each).collect();
    let more = shown.len().saturating_sub(LISTED);
    shown.truncate(LISTED);
    if more > 0 {
        shown.push(format!("{more} more"));
    }
    if shown.is_empty() { "nothing".into() } else { shown.join(", ") }
}

fn need(channels: &[Channel], quantity: Quantity, options: &ReadOptions) -> Result<usize, ChannelError> {
    choose(channels, quantity, options)?.ok_or_else(|| {
        let example = channels.iter().find(|channel| channel.unfit.is_none());
        let example = example.map_or_else(|| "NAME".to_owned(), Channel::example);
        ChannelError::Missing { quantity, found: list(channels.iter()), example }
    })
}

/// The channel that is asked for, else the one that looks like the quantity.
fn choose(
    channels: &[Channel],
    quantity: Quantity,
    options: &ReadOptions,
) -> Result<Option<usize>, ChannelError> {
    let select = |test: &dyn Fn(&Channel) -> bool| -> Vec<usize> {
        let all = channels.iter().enumerate();
        all.filter(|(_, channel)| test(channel)).map(|(index, _)| index).collect()
    };
    let fit = |channel: &Channel| channel.unfit.is_none();
    let found = match options.columns.of(quantity) {
        Some(wanted) => {
            let found = match wanted {
                Column::Number(number) => select(&|channel| channel.number == Some(*number)),
                Column::Name(name) => {
                    let exact = select(&|channel| channel.names().any(|known| known.trim() == name.trim()));
                    let same = |known: &str| known.trim().to_lowercase() == name.trim().to_lowercase();
                    if exact.is_empty() { select(&|channel| channel.names().any(same)) } else { exact }
                }
            };
            let said = |index: &usize| channels.get(*index).is_some_and(|one| one.quantity == Some(quantity));
            let told: Vec<usize> = found.iter().copied().filter(said).collect();
            let found = if told.is_empty() { found } else { told };
            if found.is_empty() {
                let (wanted, found) = (wanted.clone(), list(channels.iter()));
                return Err(ChannelError::Unknown { quantity, wanted, found });
            }
            found
        }
        None => {
            let names = |names: &'static [&'static str]| {
                move |channel: &Channel| {
                    fit(channel) && channel.telling().any(|name| names.contains(&name.as_str()))
                }
            };
            let usual = usual_names(quantity);
            let unit = |channel: &Channel| {
                fit(channel) && channel.unit().is_some_and(|unit| unit_in_si(quantity, unit).is_ok())
            };
            let tests: [&dyn Fn(&Channel) -> bool; 4] = [
                &|channel| fit(channel) && channel.quantity == Some(quantity),
                &names(usual.split_at(1).0),
                &names(usual),
                &unit,
            ];
            tests.into_iter().map(select).find(|found| !found.is_empty()).unwrap_or_default()
        }
    };
    let chosen = match found.as_slice() {
        [] => return Ok(None),
        [only] => *only,
        [first, ..] => {
            let example = channels.get(*first).map(Channel::example).unwrap_or_default();
            let candidates = list(found.iter().filter_map(|index| channels.get(*index)));
            return Err(ChannelError::Ambiguous { quantity, candidates, example });
        }
    };
    let Some(channel) = channels.get(chosen) else { return Ok(None) };
    let told = channel.quantity.filter(|told| *told != quantity);
    match channel.unfit.clone().or(told.map(|told| format!("the file says that it is a {told}"))) {
        Some(problem) => Err(ChannelError::Unfit { channel: channel.shown(), quantity, problem }),
        None => Ok(Some(chosen)),
    }
}

/// The numbers of a channel in SI units, checked.
fn in_si(
    channel: &Channel,
    quantity: Quantity,
    mut values: Vec<f64>,
    options: &ReadOptions,
) -> Result<Vec<f64>, ChannelError> {
    let example = example_unit(quantity);
    let factor = match (given_unit(quantity, options), channel.unit()) {
        (Some(factor), _) => factor,
        (None, Some(unit)) => unit_in_si(quantity, unit).map_err(|source| ChannelError::UnitUnknown {
            channel: channel.shown(),
            quantity,
            source,
            example,
        })?,
        (None, None) => {
            return Err(ChannelError::UnitMissing { channel: channel.shown(), quantity, example });
        }
    };
    let mut before = f64::NEG_INFINITY;
    for (index, value) in values.iter_mut().enumerate() {
        let (sample, found) = (index + 1, *value);
        *value *= factor;
        if !value.is_finite() {
            let channel = channel.shown();
            return Err(ChannelError::NotFinite { channel, quantity, sample, value: found });
        }
        if quantity == Quantity::Time {
            if found < before {
                let channel = channel.shown();
                return Err(ChannelError::TimeBackwards { channel, sample, before, after: found });
            }
            before = found;
        }
    }
    Ok(values)
}
