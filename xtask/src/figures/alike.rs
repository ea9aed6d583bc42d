//! Whether two texts are the same but for the last digits of their numbers.
//!
//! Another processor or a newer library may round a sum differently, so a committed figure is not compared byte for
//! byte: words must be equal, numbers within a tolerance.

use anyhow::{Result, bail};

/// How far numbers may differ: relative to the larger one, or absolutely.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slack {
    pub(crate) relative: f64,
    pub(crate) absolute: f64,
}

/// Fails at the first line that differs by more than `slack`.
pub(crate) fn require(committed: &str, made: &str, slack: Slack) -> Result<()> {
    let (mut old, mut new) = (committed.lines(), made.lines());
    let mut number = 0;
    loop {
        number += 1;
        match (old.next(), new.next()) {
            (None, None) => return Ok(()),
            (Some(a), Some(b)) if alike(a, b, slack) => {}
            (a, b) => {
                bail!("line {number}: {:?} is committed, {:?} is made", a.unwrap_or(""), b.unwrap_or(""))
            }
        }
    }
}

fn alike(a: &str, b: &str, slack: Slack) -> bool {
    if a == b {
        return true;
    }
    let (mut a, mut b) = (pieces(a), pieces(b));
    loop {
        match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b => {}
            (Some(a), Some(b)) => match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(x), Ok(y))
                    if (x - y).abs() <= slack.absolute.max(slack.relative * x.abs().max(y.abs())) => {}
                _ => return false,
            },
            _ => return false,
        }
    }
}

/// Numbers and what stands between them.
fn pieces(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        let length = match number_length(rest) {
            0 => {
                let mut ends = rest.char_indices().map(|(i, _)| i).skip(1);
                ends.find(|&i| number_length(rest.get(i..).unwrap_or("")) > 0).unwrap_or(rest.len())
            }
            length => length,
        };
        let (piece, after) = rest.split_at_checked(length).filter(|(piece, _)| !piece.is_empty())?;
        rest = after;
        Some(piece)
    })
}

/// Length of the number that `text` begins with; 0 for none.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes.get(from..).map_or(0, |rest| rest.iter().take_while(|b| b.is_ascii_digit()).count())
    };
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let whole = digits(sign);
    if whole == 0 {
        return 0;
    }
    let mut length = sign + whole;
    if bytes.get(length) == Some(&b'.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'-' | b'+')));
        if digits(length + 1 + sign) > 0 {
            length += 1 + sign + digits(length + 1 + sign);
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLACK: Slack = Slack { relative: 1e-4, absolute: 0.0 };

    #[test]
    fn last_digits_may_differ() {
        assert!(alike("a,N = 31,1.23456e-6,-0.5", "a,N = 31,1.23459e-6,-0.5", SLACK));
        assert!(!alike("a,N = 31,1.23456e-6,-0.5", "a,N = 31,1.24e-6,-0.5", SLACK));
        assert!(!alike("a,N = 31,1.23456e-6,-0.5", "a,N = 31,1.23456e-6,0.5", SLACK));
        assert!(!alike("a,b,1", "a,c,1", SLACK));
        assert!(!alike("a,1", "a,1,2", SLACK));
    }

    #[test]
    fn a_changed_line_is_named() {
        let error = require("x\n1.0\n", "x\n2.0\n", SLACK).unwrap_err().to_string();
        assert!(error.contains("line 2"), "{error}");
        assert!(require("x\n", "x\ny\n", SLACK).is_err());
    }

    #[test]
    fn a_line_falls_into_pieces() {
        assert_eq!(pieces("M12.5,-3e-7 L µ4").collect::<Vec<_>>(), ["M", "12.5", ",", "-3e-7", " L µ", "4"]);
    }
}
