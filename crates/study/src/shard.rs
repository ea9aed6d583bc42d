//! A part of a study's cases, for runs on several machines.

use std::fmt;
use std::str::FromStr;

/// Part `index` of `count`: every case whose number leaves the same rest, so that each part has a share of the easy and of the hard
/// ones. Which cases a part has does not depend on anything else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// The part with one case alone, of a study with so many.
    pub fn one(case: usize, cases: usize) -> Self {
        Self { index: case, count: cases.max(1) }
    }

    /// Whether it has the case of that number, counted from 0.
    pub fn has(self, case: usize) -> bool {
        case % self.count == self.index
    }

    /// How many of `cases` cases it has.
    pub fn cases(self, cases: usize) -> usize {
        (0..cases).filter(|case| self.has(*case)).count()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    /// `2/8`: the second of eight.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index: index - 1, count }),
            _ => Err("must be I/N with 1 ≤ I ≤ N, for example 2/8 for the second of eight".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn every_case_is_in_one_part() {
        for (cases, count) in [(0, 3), (1, 3), (7, 3), (24, 5), (4, 9)] {
            let parts: Vec<Shard> = (1..=count).map(|i| format!("{i}/{count}").parse().unwrap()).collect();
            for case in 0..cases {
                assert_eq!(parts.iter().filter(|part| part.has(case)).count(), 1);
            }
            assert_eq!(parts.iter().map(|part| part.cases(cases)).sum::<usize>(), cases);
        }
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for wrong in ["", "3", "0/2", "3/2", "1/0", "a/2", "-1/2", "1/2/3"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
