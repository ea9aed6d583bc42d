//! The header of a NumPy array: what an item is, and how many there are.

use crate::error::{ArrayError, wrong};

/// What an item of a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Float,
    Signed,
    Unsigned,
    Complex,
    /// Bytes of a text.
    Bytes,
    /// A text of four-byte characters.
    Unicode,
}

/// A part of an item: of a structured array one with a name, else the whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Empty where the array is not structured.
    pub name: String,
    pub(crate) kind: Kind,
    /// Bytes.
    pub(crate) size: usize,
    /// Bytes before it in an item.
    pub(crate) offset: usize,
    pub(crate) big_endian: bool,
}

impl Field {
    /// Refuses what is no real number.
    pub(crate) fn check_numeric(&self) -> Result<(), ArrayError> {
        match self.kind {
            Kind::Bytes | Kind::Unicode => Err(wrong("holds texts, not numbers")),
            Kind::Complex => Err(wrong("holds complex numbers; real ones are wanted")),
            Kind::Float | Kind::Signed | Kind::Unsigned => Ok(()),
        }
    }

    /// Its number in an item.
    pub(crate) fn number(&self, item: &[u8]) -> f64 {
        // The most significant byte last, whatever the order of the file.
        let mut bytes = [0_u8; 8];
        for (i, slot) in bytes.iter_mut().take(self.size).enumerate() {
            let place = if self.big_endian { self.size - 1 - i } else { i };
            *slot = item.get(self.offset + place).copied().unwrap_or_default();
        }
        let whole = u64::from_le_bytes(bytes);
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(whole as u32)),
            (Kind::Float, _) => f64::from_bits(whole),
            (Kind::Signed, size) => {
                let spare = 64 - 8 * size as u32;
                ((whole << spare) as i64 >> spare) as f64
            }
            _ => whole as f64,
        }
    }
}

/// What follows after a key of the header's dictionary.
pub(crate) fn after<'h>(header: &'h str, key: &str) -> Result<&'h str, ArrayError> {
    let find = |quote: char| header.split_once(&format!("{quote}{key}{quote}"));
    let value = find('\'').or_else(|| find('"')).and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
    value.map(str::trim_start).ok_or_else(|| wrong(format!("the header has no {key}")))
}

/// A text in quotes, and what follows.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text.strip_prefix(quote)?.split_once(quote)
}

/// The fields of an item out of `descr`: `'<f8'`, or `[('displacement', '<f8'), ('force', '<f8')]`.
pub(crate) fn fields(header: &str) -> Result<Vec<Field>, ArrayError> {
    let descr = after(header, "descr")?;
    if let Some((text, _)) = quoted(descr) {
        return Ok(vec![item(text)?]);
    }
    let nested =
        || wrong("holds records whose fields are not single numbers; save the columns by themselves");
    let mut rest = descr.strip_prefix('[').ok_or_else(nested)?;
    let mut fields: Vec<Field> = Vec::new();
    loop {
        rest = rest.trim_start_matches([',', ' ']);
        if rest.starts_with(']') && !fields.is_empty() {
            return Ok(fields);
        }
        let (name, after) = rest.strip_prefix('(').and_then(quoted).ok_or_else(nested)?;
        let (text, after) = after.trim_start().strip_prefix(',').and_then(quoted).ok_or_else(nested)?;
        rest = after.trim_start().strip_prefix(')').ok_or_else(nested)?;
        let offset = fields.last().map_or(0, |field| field.offset + field.size);
        fields.push(Field { name: name.to_owned(), offset, ..item(text)? });
    }
}

/// An item by its short name, for example `<f8`.
fn item(text: &str) -> Result<Field, ArrayError> {
    let unknown = || wrong(format!("holds numbers of type {text:?}; write float64"));
    let mut letters = text.chars();
    let (order, kind) = (letters.next().ok_or_else(unknown)?, letters.next().ok_or_else(unknown)?);
    if kind == 'O' {
        return Err(wrong("holds Python objects (pickled), which are not read; save an array of numbers"));
    }
    let size: usize = letters.as_str().parse().map_err(|_| unknown())?;
    let big_endian = match order {
        '<' | '|' | '=' => false,
        '>' => true,
        _ => return Err(unknown()),
    };
    let (kind, size) = match (kind, size) {
        ('f', 4 | 8) => (Kind::Float, size),
        ('i', 1 | 2 | 4 | 8) => (Kind::Signed, size),
        ('u', 1 | 2 | 4 | 8) | ('b', 1) => (Kind::Unsigned, size),
        ('c', 8 | 16) => (Kind::Complex, size),
        ('S', 0..=64) => (Kind::Bytes, size.max(1)),
        ('U', 0..=256) => (Kind::Unicode, 4 * size.max(1)),
        _ => return Err(unknown()),
    };
    Ok(Field { name: String::new(), kind, size, offset: 0, big_endian })
}

/// The extents.
pub(crate) fn shape(header: &str) -> Result<Vec<usize>, ArrayError> {
    let text = after(header, "shape")?;
    let inner = text.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(inner, _)| inner);
    let inner = inner.ok_or_else(|| wrong("the header's shape is no list"))?;
    let extents = inner.split(',').map(str::trim).filter(|extent| !extent.is_empty());
    let number = |extent: &str| {
        let digits = extent.trim_end_matches('L');
        digits.parse().map_err(|_| wrong(format!("the header's shape has {extent:?} in it")))
    };
    extents.take(8).map(number).collect()
}
