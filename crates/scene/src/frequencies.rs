//! `frequencies`: a range or a list, in Hz; also in the short form `20:200:721:log`.

use std::fmt;
use std::str::FromStr;

use crate::error::SceneError;
use crate::read::{Node, show};

pub(crate) const KEYS: [&str; 5] = ["from", "to", "points", "step", "spacing"];

/// More points than this are a slip of the pen.
const MOST_POINTS: usize = 1_000_000;

/// How the points of a range are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Spacing {
    Linear,
    Log,
}

/// The frequencies of a sweep in Hz, in the order they are solved and reported.
#[derive(Debug, Clone, PartialEq)]
pub struct Frequencies(Vec<f64>);

impl Frequencies {
    /// One frequency; 0 is the static response.
    ///
    /// # Errors
    /// What is wrong with the number.
    pub fn one(frequency: f64) -> Result<Self, BadFrequencies> {
        if frequency.is_finite() && frequency >= 0.0 {
            Ok(Self(vec![frequency]))
        } else {
            Err(BadFrequencies(format!("a frequency must be a number of Hz, not negative, got {frequency}")))
        }
    }

    /// A list of frequencies, such as those of a result.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn list(frequencies: Vec<f64>) -> Result<Self, BadFrequencies> {
        if frequencies.is_empty() {
            return Err(BadFrequencies("there is no frequency".into()));
        }
        frequencies.iter().try_for_each(|frequency| Self::one(*frequency).map(|_| ()))?;
        Ok(Self(frequencies))
    }

    /// The frequencies in Hz.
    pub fn as_slice(&self) -> &[f64] {
        &self.0
    }

    /// The ends of a range, which are finite and positive.
    pub(crate) fn ends(from: f64, to: f64) -> Self {
        Self(vec![from, to])
    }

    /// `points` frequencies from one to the other, both included.
    fn range(from: f64, to: f64, points: usize, spacing: Spacing) -> Self {
        let last = points.saturating_sub(1);
        let at = |i: usize| match i {
            0 => from,
            _ if i == last => to,
            _ => {
                let (i, last) = (i as f64, last as f64);
                match spacing {
                    // Multiplied before it is divided: round steps give round frequencies.
                    Spacing::Linear => from + (to - from) * i / last,
                    Spacing::Log => from * (to / from).powf(i / last),
                }
            }
        };
        Self((0..points).map(at).collect())
    }

    /// Reads a range or a list.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn read(node: &Node) -> Result<Self, SceneError> {
        if node.is_list() {
            return Self::read_list(node);
        }
        let what = "from, to and points or step";
        if !node.is_object() {
            return Err(node.error(format!("must be an object ({what}) or a list of frequencies in Hz")));
        }
        let range = node.object(what, &KEYS)?;
        let form = "a frequency in Hz";
        let (from, to) = (range.need("from", form)?.positive()?, range.need("to", form)?.positive()?);
        let spacing = match range.get("spacing") {
            Some(spacing) => spacing.choice(&[("linear", Spacing::Linear), ("log", Spacing::Log)])?,
            None => Spacing::Linear,
        };
        match (range.get("points"), range.get("step")) {
            (Some(points), None) => {
                let count = points.whole(1, MOST_POINTS)?;
                if count == 1 && from != to {
                    return Err(points
                        .error(format!("one point cannot reach from {from} to {to} Hz; write 2 or more")));
                }
                if count > 1 && from == to {
                    return Err(
                        points.error(format!("{count} points, but \"from\" and \"to\" are both {from} Hz"))
                    );
                }
                Ok(Self::range(from, to, count, spacing))
            }
            (None, Some(step)) if spacing == Spacing::Log => {
                Err(step.error("steps are linear; write \"points\" for logarithmic spacing"))
            }
            (None, Some(step)) => Self::steps(from, to, &step),
            (Some(_), Some(step)) => Err(step.error("is one too many beside \"points\"; keep one of them")),
            (None, None) => Err(range.error("needs \"points\" (how many) or \"step\" (in Hz)")),
        }
    }

    /// From `from` towards `to`, which is included when a step falls on it.
    fn steps(from: f64, to: f64, node: &Node) -> Result<Self, SceneError> {
        let step = node.positive()?;
        // A step that should fall on the end must not miss it by rounding.
        let count = ((to - from).abs() / step * (1.0 + 1e-12)).floor() + 1.0;
        if count > MOST_POINTS as f64 {
            let problem = format!(
                "makes more than {MOST_POINTS} points between {from} and {to} Hz; write a larger one"
            );
            return Err(node.error(problem));
        }
        let signed = if to < from { -step } else { step };
        Ok(Self((0..count as usize).map(|i| from + signed * i as f64).collect()))
    }

    fn read_list(node: &Node) -> Result<Self, SceneError> {
        let list = node.numbers("of frequencies in Hz")?;
        if list.is_empty() {
            return Err(node.error("must not be empty"));
        }
        if list.len() > MOST_POINTS {
            return Err(
                node.error(format!("must have at most {MOST_POINTS} frequencies, got {}", list.len()))
            );
        }
        match list.iter().position(|frequency| *frequency < 0.0) {
            Some(i) => {
                let place = format!("{}[{i}]", node.path());
                let got = list.get(i).copied().unwrap_or_default();
                Err(SceneError::entry(&place, format!("must not be negative, got {}", show(got))))
            }
            None => Ok(Self(list)),
        }
    }
}

/// Why a text is no range of frequencies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadFrequencies(String);

impl fmt::Display for BadFrequencies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadFrequencies {}

impl FromStr for Frequencies {
    type Err = BadFrequencies;

    /// Reads `FROM:TO:POINTS`, `FROM:TO:POINTS:log` or a list, `57,62,75`.
    fn from_str(text: &str) -> Result<Self, BadFrequencies> {
        let refuse = |why: String| {
            let forms = "write FROM:TO:POINTS[:log] or a list, for example 20:200:721 or 57,62,75";
            Err(BadFrequencies(format!("{why}; {forms}")))
        };
        if !text.contains(':') {
            let hertz = |text: &str| text.trim().parse().ok().filter(|f| f64::is_finite(*f) && *f >= 0.0);
            return match text.split(',').map(hertz).collect::<Option<Vec<f64>>>() {
                Some(list) => Ok(Self(list)),
                None => refuse(format!("{text:?} is no list of frequencies in Hz")),
            };
        }
        let parts: Vec<&str> = text.split(':').map(str::trim).collect();
        let (from, to, points, spacing) = match parts.as_slice() {
            [from, to, points] | [from, to, points, "linear"] => (from, to, points, Spacing::Linear),
            [from, to, points, "log"] => (from, to, points, Spacing::Log),
            _ => return refuse(format!("{text:?} is no range")),
        };
        let mut ends = [0.0; 2];
        for (end, text) in ends.iter_mut().zip([from, to]) {
            *end = match text.parse() {
                Ok(hertz) if f64::is_finite(hertz) && hertz > 0.0 => hertz,
                _ => return refuse(format!("{text:?} is no positive frequency")),
            };
        }
        let [from, to] = ends;
        match points.parse() {
            Ok(1) if from == to => Ok(Self(vec![from])),
            Ok(count) if (2..=MOST_POINTS).contains(&count) && from != to => {
                Ok(Self::range(from, to, count, spacing))
            }
            Ok(count) if (1..=MOST_POINTS).contains(&count) => {
                refuse(format!("{count} point(s) cannot go from {from} to {to} Hz"))
            }
            _ => refuse(format!("{points:?} is no number of points from 1 to {MOST_POINTS}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::parse;

    fn read(text: &str) -> Result<Vec<f64>, String> {
        let json = parse(&format!("{{\"frequencies\": {text}}}")).unwrap();
        let node = Node::root(&json).peek("frequencies").unwrap();
        Frequencies::read(&node).map(|f| f.0).map_err(|e| e.to_string())
    }

    #[test]
    fn ranges_include_both_ends() {
        assert_eq!(read(r#"{"from": 20, "to": 21, "points": 5}"#).unwrap(), [20.0, 20.25, 20.5, 20.75, 21.0]);
        let log = read(r#"{"from": 1, "to": 100, "points": 3, "spacing": "log"}"#).unwrap();
        assert!((log[1] - 10.0).abs() < 1e-12 && log[2] == 100.0);
        assert_eq!(read(r#"{"from": 1, "to": 1.3, "step": 0.1}"#).unwrap().len(), 4);
        assert_eq!(read(r#"{"from": 1, "to": 1.35, "step": 0.1}"#).unwrap().len(), 4);
        assert_eq!(read(r#"{"from": 3, "to": 1, "step": 1}"#).unwrap(), [3.0, 2.0, 1.0]);
        assert_eq!(read("[5, 0, 5]").unwrap(), [5.0, 0.0, 5.0]);
    }

    #[test]
    fn what_is_no_range_is_refused_with_its_key() {
        for (text, message) in [
            (r#"{"from": 0, "to": 2, "points": 2}"#, "frequencies.from: must be positive, got 0"),
            (r#"{"from": 1, "to": 2}"#, "frequencies: needs \"points\""),
            (r#"{"from": 1, "to": 2, "points": 1e7}"#, "frequencies.points: must be a whole number"),
            (r#"{"from": 1, "to": 2, "step": 1e-9}"#, "frequencies.step: makes more than"),
            (r#"{"from": 1, "to": 2, "step": 1, "points": 2}"#, "frequencies.step: is one too many"),
            (r#"{"from": 1, "to": 2, "step": 1, "spacing": "log"}"#, "frequencies.step: steps are linear"),
            (r#"{"from": 1, "to": 2, "points": 2, "spacing": "cubic"}"#, "frequencies.spacing: must be"),
            (r#"{"from": 1, "to": 1, "points": 2}"#, "frequencies.points: 2 points, but"),
            ("[1, -2]", "frequencies[1]: must not be negative, got -2"),
            ("[]", "frequencies: must not be empty"),
            ("50", "frequencies: must be an object"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[test]
    fn the_short_form_means_the_same() {
        let short: Frequencies = "20:200:721".parse().unwrap();
        assert_eq!(short.0, read(r#"{"from": 20, "to": 200, "points": 721}"#).unwrap());
        let log: Frequencies = "1:100:3:log".parse().unwrap();
        assert_eq!(log.0, read(r#"{"from": 1, "to": 100, "points": 3, "spacing": "log"}"#).unwrap());
        assert_eq!("57, 62,75".parse::<Frequencies>().unwrap().0, [57.0, 62.0, 75.0]);
        assert_eq!("57".parse::<Frequencies>().unwrap().0, [57.0]);
        for text in [
            "",
            "57,",
            "57,-1",
            "nan",
            "1:2",
            "0:2:3",
            "1:2:1",
            "1:1:2",
            "a:2:3",
            "1:inf:3",
            "1:2:3:cubic",
            "1:2:99999999999",
            "1:2:-3",
        ] {
            assert!(
                text.parse::<Frequencies>().unwrap_err().to_string().contains("FROM:TO:POINTS"),
                "{text}"
            );
        }
    }
}
