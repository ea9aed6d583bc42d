//! What a caller can say about a record that its header does not: columns, units, sign of the force.

use std::fmt;
use std::str::FromStr;

use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::record::Quantity;
use crate::units::{ForceUnit, LengthUnit, TimeUnit};

/// How to read a record. The default takes everything from the header.
///
/// Its fields have the form they have in a scene:
/// `"columns": {"displacement": "d", "force": 3}, "units": {"displacement": "in", "force": "kip"},
/// "force_sign": -1`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReadOptions {
    /// Which column holds what.
    pub columns: Columns,
    /// The columns' units; they win over those in the header.
    pub units: Units,
    /// Whether the file's force is the rig's or its reaction.
    pub force_sign: ForceSign,
}

/// A column of a file: by its name in the header, or by its number, **1 being the first**, as in a
/// spreadsheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Its name in the header, without the unit, or with it exactly as written there. Capitals don't matter.
    Name(String),
    /// Its number; 1 is the first column.
    Number(usize),
}

/// Which column holds which quantity. What is left out is looked for in the header.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Columns {
    /// Column of the time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Column>,
    /// Column of the displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Column>,
    /// Column of the force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<Column>,
}

impl Columns {
    /// The column given for a quantity.
    #[must_use]
    pub fn of(&self, quantity: Quantity) -> Option<&Column> {
        match quantity {
            Quantity::Time => self.time.as_ref(),
            Quantity::Displacement => self.displacement.as_ref(),
            Quantity::Force => self.force.as_ref(),
        }
    }
}

/// Units of the columns. What is left out is taken from the header.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Units {
    /// Unit of the time column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeUnit>,
    /// Unit of the displacement column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<LengthUnit>,
    /// Unit of the force column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<ForceUnit>,
}

/// Whether a file's force is the one the rig applies or the reaction to it. Written `1` or `-1`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "i8")]
pub enum ForceSign {
    /// The force the rig applies: a loop runs so that `∮ f dw > 0`.
    #[default]
    Rig,
    /// The reaction of the specimen: its sign is turned while reading.
    Reaction,
}

impl ForceSign {
    /// +1 or −1.
    #[must_use]
    pub fn factor(self) -> f64 {
        match self {
            Self::Rig => 1.0,
            Self::Reaction => -1.0,
        }
    }
}

impl TryFrom<f64> for ForceSign {
    type Error = String;

    fn try_from(sign: f64) -> Result<Self, String> {
        if sign == 1.0 {
            Ok(Self::Rig)
        } else if sign == -1.0 {
            Ok(Self::Reaction)
        } else {
            Err(format!("the sign of the force must be 1 or -1, got {sign}"))
        }
    }
}

impl From<ForceSign> for i8 {
    fn from(sign: ForceSign) -> Self {
        match sign {
            ForceSign::Rig => 1,
            ForceSign::Reaction => -1,
        }
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "`{name}`"),
            Self::Number(number) => write!(f, "number {number}"),
        }
    }
}

impl From<&str> for Column {
    /// A whole number is a column number, anything else a name.
    fn from(text: &str) -> Self {
        let text = text.trim();
        text.parse().map_or_else(|_| Self::Name(text.to_owned()), Self::Number)
    }
}

impl Serialize for Column {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Name(name) => serializer.serialize_str(name),
            Self::Number(number) => number.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameOrNumber;

        impl Visitor<'_> for NameOrNumber {
            type Value = Column;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a column: its name in the header, or its number, 1 being the first")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Column, E> {
                Ok(Column::Name(name.to_owned()))
            }

            fn visit_u64<E: de::Error>(self, number: u64) -> Result<Column, E> {
                match usize::try_from(number) {
                    Ok(number) if number > 0 => Ok(Column::Number(number)),
                    _ => Err(E::invalid_value(de::Unexpected::Unsigned(number), &self)),
                }
            }
        }

        deserializer.deserialize_any(NameOrNumber)
    }
}

/// Splits `displacement=2,force=F` into pairs; the names must be quantities.
fn assignments(text: &str) -> impl Iterator<Item = Result<(Quantity, &str), String>> {
    text.split(',').map(|part| {
        let (name, value) = part
            .split_once('=')
            .ok_or_else(|| format!("`{part}`: expected something like displacement=2,force=3"))?;
        Ok((name.trim().parse()?, value.trim()))
    })
}

impl FromStr for Columns {
    type Err = String;

    /// Reads `displacement=2,force=F,time=1`, the form of a command line.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut columns = Self::default();
        for assignment in assignments(text) {
            let (quantity, value) = assignment?;
            let column = Column::from(value);
            if matches!(column, Column::Number(0)) {
                return Err("columns are counted from 1".to_owned());
            }
            match quantity {
                Quantity::Time => columns.time = Some(column),
                Quantity::Displacement => columns.displacement = Some(column),
                Quantity::Force => columns.force = Some(column),
            }
        }
        Ok(columns)
    }
}

impl FromStr for Units {
    type Err = String;

    /// Reads `displacement=um,force=N,time=s`, the form of a command line.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut units = Self::default();
        for assignment in assignments(text) {
            let (quantity, value) = assignment?;
            match quantity {
                Quantity::Time => units.time = Some(value.parse().map_err(|e| format!("{e}"))?),
                Quantity::Displacement => {
                    units.displacement = Some(value.parse().map_err(|e| format!("{e}"))?);
                }
                Quantity::Force => units.force = Some(value.parse().map_err(|e| format!("{e}"))?),
            }
        }
        Ok(units)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_have_the_form_they_have_in_a_scene() {
        let text = r#"{"columns": {"displacement": "d", "force": 3},
                       "units": {"displacement": "in", "force": "kip"}, "force_sign": -1}"#;
        let options: ReadOptions = serde_json::from_str(text).unwrap();
        assert_eq!(options.columns.displacement, Some(Column::Name("d".into())));
        assert_eq!(options.columns.force, Some(Column::Number(3)));
        assert_eq!(options.units.displacement, Some(LengthUnit::Inch));
        assert_eq!(options.units.force, Some(ForceUnit::Kip));
        assert_eq!(options.force_sign, ForceSign::Reaction);
        let again: ReadOptions = serde_json::from_str(&serde_json::to_string(&options).unwrap()).unwrap();
        assert_eq!(again, options);
    }

    #[test]
    fn mistakes_in_options_are_refused_with_the_reason() {
        let says = |text: &str, words: &str| {
            let error = serde_json::from_str::<ReadOptions>(text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        says(r#"{"columns": {"displacment": 1}}"#, "displacment");
        says(r#"{"columns": {"force": 0}}"#, "1 being the first");
        says(r#"{"columns": {"force": 1.5}}"#, "1 being the first");
        says(r#"{"units": {"force": "pound"}}"#, "lbf");
        says(r#"{"force_sign": 2}"#, "1 or -1");
    }

    #[test]
    fn options_have_a_form_for_the_command_line() {
        let columns: Columns = "displacement=2, force=load cell".parse().unwrap();
        assert_eq!(columns.displacement, Some(Column::Number(2)));
        assert_eq!(columns.force, Some(Column::Name("load cell".into())));
        let units: Units = "force=kip,displacement=in,time=ms".parse().unwrap();
        assert_eq!(units.time, Some(TimeUnit::Millisecond));
        assert!("force=0".parse::<Columns>().is_err());
        assert!("farce=1".parse::<Columns>().unwrap_err().contains("farce"));
        assert!("3".parse::<Columns>().is_err());
        assert!("force=stone".parse::<Units>().is_err());
    }
}
