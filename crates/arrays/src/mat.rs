//! MATLAB's files of version 5 (`save -v5`, `-v6`, `-v7`): the numeric variables, and those in structs of one element.
//!
//! Source: MathWorks, "MAT-File Format", the chapter on level 5: a header of 128 bytes, then elements, each a tag (type and
//! bytes, or both and four bytes of data in one word) and its data, padded to 8 bytes. A variable is an element of type 14 that
//! holds elements of its own: flags with the class, extents, name, numbers; an element of type 15 is another one, compressed.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::error::{ArrayError, extents, wrong};
use crate::npy::MOST_NUMBERS;

/// What a variable is, by its class.
const NO_NUMBERS: [(u8, &str); 7] = [
    (1, "a cell array"),
    (3, "an object"),
    (4, "text"),
    (5, "a sparse matrix"),
    (16, "a function"),
    (17, "an object"),
    (18, "an object"),
];

const STRUCT: u8 = 2;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Structs within structs beyond this are refused.
const DEEPEST: usize = 4;
/// Names and extents are short; numbers are not read by this.
const LONGEST: usize = 1 << 16;

/// A variable of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variable {
    /// Its name; of a field of a struct, `struct.field`.
    pub name: String,
    pub shape: Vec<usize>,
    /// What it is instead of real numbers.
    pub other: Option<&'static str>,
}

/// A file whose header was read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MatReader<'a> {
    elements: &'a [u8],
    big_endian: bool,
}

/// Whether the bytes begin like a file that MATLAB or one of its kind wrote.
pub(crate) fn is_mat(bytes: &[u8]) -> bool {
    matches!(bytes.get(126..128), Some(b"IM" | b"MI")) && bytes.starts_with(b"MATLAB")
}

impl<'a> MatReader<'a> {
    /// Reads the header.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, ArrayError> {
        let (Some(elements), Some(version), Some(order)) =
            (bytes.get(128..), bytes.get(124..126), bytes.get(126..128))
        else {
            return Err(wrong("the file ends within its header"));
        };
        let big_endian = order == b"MI";
        let version = match (version, big_endian) {
            (&[major, _], true) | (&[_, major], false) => major,
            _ => 0,
        };
        match version {
            1 => Ok(Self { elements, big_endian }),
            2 => Err(newer()),
            other => Err(wrong(format!("is a MATLAB file of the unknown version {other}; save it with -v7"))),
        }
    }

    /// The variables, those in structs of one element included.
    pub(crate) fn variables(&self) -> Result<Vec<Variable>, ArrayError> {
        let mut found = Vec::new();
        self.walk(&mut |variable, _| {
            found.push(variable);
            Ok(())
        })?;
        Ok(found)
    }

    /// The numbers of the variable `name`, column by column.
    pub(crate) fn values(&self, name: &str) -> Result<Vec<f64>, ArrayError> {
        let mut found = None;
        self.walk(&mut |variable, source| {
            // Of two variables of a name the later one counts, as in MATLAB.
            if variable.name == name && variable.other.is_none() {
                found = Some(source.numbers(&variable.shape)?);
            }
            Ok(())
        })?;
        found.ok_or_else(|| wrong(format!("variable {name:?}: there is none with numbers")))
    }

    fn walk(&self, take: &mut Take) -> Result<(), ArrayError> {
        let mut rest = self.elements;
        while !rest.is_empty() {
            let mut source = Source { bytes: &mut rest, big_endian: self.big_endian, left: u64::MAX };
            let Some(tag) = source.tag()? else { break };
            let length = tag.length;
            if length > rest.len() as u64 {
                return Err(wrong("the file ends within a variable; was it cut off?"));
            }
            let (element, after) = rest.split_at(length as usize);
            match tag.kind {
                COMPRESSED => {
                    let mut inflated = ZlibDecoder::new(element);
                    let mut source =
                        Source { bytes: &mut inflated, big_endian: self.big_endian, left: u64::MAX };
                    if let Some(inner) = source.tag()?.filter(|inner| inner.kind == MATRIX) {
                        source.left = inner.length;
                        source.matrix("", 0, take)?;
                    }
                    rest = after;
                }
                kind => {
                    if kind == MATRIX {
                        let mut element = element;
                        let mut source =
                            Source { bytes: &mut element, big_endian: self.big_endian, left: length };
                        source.matrix("", 0, take)?;
                    }
                    let padding = (length.wrapping_neg() % 8) as usize;
                    rest = after.get(padding..).unwrap_or_default();
                }
            }
        }
        Ok(())
    }
}

/// A file of version 7.3.
pub(crate) fn newer() -> ArrayError {
    wrong(
        "is a MATLAB file of version 7.3 (HDF5), which is not read; save it with -v7: save('record.mat', '-v7')",
    )
}

/// Takes a variable; its numbers are next in the source.
type Take<'t> = dyn FnMut(Variable, &mut Source) -> Result<(), ArrayError> + 't;

struct Tag {
    kind: u32,
    length: u64,
    /// The data of an element so short that they stand in the tag.
    short: Option<[u8; 4]>,
}

/// The elements within one, read from its beginning to its end.
struct Source<'r> {
    bytes: &'r mut dyn Read,
    big_endian: bool,
    /// Bytes of the element that are left.
    left: u64,
}

impl Source<'_> {
    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), ArrayError> {
        let wanted = bytes.len() as u64;
        self.left =
            self.left.checked_sub(wanted).ok_or_else(|| wrong("a variable is shorter than its parts"))?;
        self.bytes.read_exact(bytes).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => wrong("the file ends within a variable; was it cut off?"),
            _ => wrong(format!("a variable cannot be decompressed: {error}")),
        })
    }

    fn skip(&mut self, mut count: u64) -> Result<(), ArrayError> {
        let mut block = [0; 4096];
        while count > 0 {
            let part = count.min(4096);
            self.fill(block.get_mut(..part as usize).unwrap_or_default())?;
            count -= part;
        }
        Ok(())
    }

    /// The next tag; none where nothing but a few bytes is left.
    fn tag(&mut self) -> Result<Option<Tag>, ArrayError> {
        if self.left < 8 {
            self.skip(self.left)?;
            return Ok(None);
        }
        let (mut first, mut second) = ([0; 4], [0; 4]);
        self.fill(&mut first)?;
        self.fill(&mut second)?;
        let word = self.word(first);
        Ok(Some(match word >> 16 {
            0 => Tag { kind: word, length: u64::from(self.word(second)), short: None },
            length => Tag { kind: word & 0xffff, length: u64::from(length.min(4)), short: Some(second) },
        }))
    }

    /// The data of a short element, for example of a name.
    fn data(&mut self) -> Result<(u32, Vec<u8>), ArrayError> {
        let tag = self.tag()?.ok_or_else(|| wrong("a variable has no name or no extents"))?;
        if let Some(short) = tag.short {
            return Ok((tag.kind, short.into_iter().take(tag.length as usize).collect()));
        }
        if tag.length > LONGEST as u64 {
            return Err(wrong("a variable has a name or extents of impossible length"));
        }
        let mut data = vec![0; tag.length as usize];
        self.fill(&mut data)?;
        self.pad(tag.length)?;
        Ok((tag.kind, data))
    }

    fn pad(&mut self, length: u64) -> Result<(), ArrayError> {
        // The last padding may be missing.
        self.skip((length.wrapping_neg() % 8).min(self.left))
    }

    fn words(&mut self) -> Result<Vec<u32>, ArrayError> {
        let (_, data) = self.data()?;
        Ok(data.as_chunks::<4>().0.iter().map(|word| self.word(*word)).collect())
    }

    /// A variable whose tag was read, as part of the struct `within`; all of it is read.
    fn matrix(&mut self, within: &str, depth: usize, take: &mut Take) -> Result<(), ArrayError> {
        let end = self.left;
        if end == 0 {
            // An empty field of a struct.
            return Ok(());
        }
        let flags = self.words()?.first().copied().ok_or_else(|| wrong("a variable has no class"))?;
        let class = (flags & 0xff) as u8;
        if class == 17 {
            // Of an object other parts follow.
            return self.skip(self.left);
        }
        let shape: Vec<usize> = self.words()?.into_iter().map(|extent| extent as usize).collect();
        let name: String = self.data()?.1.into_iter().map(char::from).collect();
        let name = if within.is_empty() { name } else { within.to_owned() };
        let single = shape.iter().all(|extent| *extent == 1);
        if class == STRUCT && single && depth < DEEPEST {
            self.fields(&name, depth, take)?;
        } else {
            let complex = (flags & 0x800 != 0).then_some("complex numbers");
            let known = NO_NUMBERS.iter().find(|(of, _)| *of == class).map(|(_, what)| *what);
            let numeric = (6..=15).contains(&class);
            let strange =
                (!numeric).then_some(if class == STRUCT { "an array of structs" } else { "no array" });
            let other = known.or(strange).or(complex);
            take(Variable { name, shape, other }, self)?;
        }
        self.skip(self.left)
    }

    /// The fields of a struct with one element.
    fn fields(&mut self, within: &str, depth: usize, take: &mut Take) -> Result<(), ArrayError> {
        let length = self.words()?.first().copied().unwrap_or_default() as usize;
        let (_, names) = self.data()?;
        if length == 0 {
            return Ok(());
        }
        for name in names.chunks(length) {
            let field: String =
                name.iter().take_while(|byte| **byte != 0).map(|byte| char::from(*byte)).collect();
            let Some(tag) = self.tag()?.filter(|tag| tag.kind == MATRIX) else { return Ok(()) };
            if tag.length > self.left {
                return Err(wrong(format!("variable {within:?}: a field is longer than the struct")));
            }
            let outside = self.left - tag.length;
            self.left = tag.length;
            self.matrix(&format!("{within}.{field}"), depth + 1, take)?;
            self.left = outside;
            self.pad(tag.length)?;
        }
        Ok(())
    }

    /// The real numbers of a variable of these extents, in whatever type they were stored.
    fn numbers(&mut self, shape: &[usize]) -> Result<Vec<f64>, ArrayError> {
        let count = shape.iter().try_fold(1_usize, |product, extent| product.checked_mul(*extent));
        let count = count.filter(|count| *count <= MOST_NUMBERS).ok_or_else(|| {
            wrong(format!("an array of {}; more than {MOST_NUMBERS} numbers are refused", extents(shape)))
        })?;
        let tag = self.tag()?.ok_or_else(|| wrong("a variable has no numbers"))?;
        let (size, number): (usize, fn(u64) -> f64) = match tag.kind {
            1 => (1, |bits| f64::from(bits as u8 as i8)),
            2 => (1, |bits| bits as f64),
            3 => (2, |bits| f64::from(bits as u16 as i16)),
            4 => (2, |bits| bits as f64),
            5 => (4, |bits| f64::from(bits as u32 as i32)),
            6 => (4, |bits| bits as f64),
            7 => (4, |bits| f64::from(f32::from_bits(bits as u32))),
            9 => (8, f64::from_bits),
            12 => (8, |bits| bits as i64 as f64),
            13 => (8, |bits| bits as f64),
            other => return Err(wrong(format!("numbers of the unknown type {other}"))),
        };
        if tag.length != (count * size) as u64 {
            return Err(wrong(format!(
                "an array of {} has {} bytes instead of {}",
                extents(shape),
                tag.length,
                count * size
            )));
        }
        let big_endian = self.big_endian;
        let value = |item: &[u8]| {
            let place = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
            number(if big_endian { item.iter().fold(0, place) } else { item.iter().rev().fold(0, place) })
        };
        if let Some(short) = tag.short {
            return Ok(short.chunks_exact(size).take(count).map(value).collect());
        }
        let mut values = Vec::with_capacity(count.min(1 << 20));
        let mut block = vec![0; size << 12];
        while values.len() < count {
            let items = (count - values.len()).min(1 << 12);
            let part = block.get_mut(..items * size).unwrap_or_default();
            self.fill(part)?;
            values.extend(part.chunks_exact(size).map(value));
        }
        self.pad(tag.length)?;
        Ok(values)
    }
}
