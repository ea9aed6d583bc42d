//! One equation: from LaTeX to MathML that can stand in Markdown and in HTML.

use anyhow::{Result, anyhow};
use pulldown_latex::config::DisplayMode;
use pulldown_latex::mathml::push_mathml;
use pulldown_latex::{Parser, RenderConfig, Storage};

/// Where an equation stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// In a line of text.
    Line,
    /// By itself; may end in `\tag{number}`.
    Block,
}

/// The equation `latex` as one line of MathML, without anything that Markdown would take for its own.
pub(crate) fn mathml(latex: &str, place: Place) -> Result<String> {
    let (latex, number) = match place {
        Place::Line => (latex.trim(), None),
        Place::Block => split_number(latex),
    };
    let storage = Storage::new();
    let events: Result<Vec<_>, _> = Parser::new(latex, &storage).collect();
    let events = events.map_err(|error| anyhow!("{latex:?}: {error}"))?;
    let display_mode = match place {
        Place::Line => DisplayMode::Inline,
        Place::Block => DisplayMode::Block,
    };
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut raw = String::new();
    push_mathml(&mut raw, events.into_iter().map(Ok::<_, std::fmt::Error>), config)?;
    // A control space arrives as the text of a reference.
    let math = tidy(&raw.replace("&amp;nbsp;", "&nbsp;"));
    Ok(match place {
        Place::Line => math,
        Place::Block => {
            let number = number.map_or(String::new(), |number| format!("<span>({number})</span>"));
            format!(
                "<span class=\"equation\" style=\"display:flex;align-items:center;overflow-x:auto;\
                 overflow-y:hidden;padding:0.4em 0\">{}{number}</span>",
                math.replacen("<math ", "<math style=\"flex:1 0 auto\" ", 1)
            )
        }
    })
}

/// An equation without its final `\tag{number}`, and the number.
fn split_number(latex: &str) -> (&str, Option<&str>) {
    let latex = latex.trim();
    let tagged = latex.strip_suffix('}').and_then(|rest| rest.rsplit_once("\\tag{"));
    tagged.map_or((latex, None), |(latex, number)| (latex.trim_end(), Some(number)))
}

/// Columns of aligned equations get their alignment, empty elements an end, and text no character that Markdown knows.
fn tidy(raw: &str) -> String {
    let mut tidy = String::with_capacity(raw.len());
    // The open tables: whether they are aligned equations, and the column.
    let mut tables: Vec<(bool, usize)> = Vec::new();
    let mut rest = raw;
    while let Some(start) = tag_start(rest) {
        let (text, from) = rest.split_at(start);
        escape(text, &mut tidy);
        let end = from.find('>').map_or(from.len(), |end| end + 1);
        let (tag, after) = from.split_at(end);
        rest = after;
        if tag.starts_with("<mtable") {
            tables.push((tag.contains("align"), 0));
        } else if tag == "</mtable>" {
            tables.pop();
        }
        match (tables.last_mut(), tag) {
            (Some((_, column)), "<mtr>") => {
                *column = 0;
                tidy.push_str(tag);
            }
            (Some((true, column)), "<mtd>") => {
                let side =
                    if column.is_multiple_of(2) { "right;padding-right:0" } else { "left;padding-left:0" };
                *column += 1;
                tidy.push_str(&format!("<mtd style=\"text-align:{side}\">"));
            }
            _ => match tag.strip_suffix("/>") {
                Some(open) => {
                    let name: String = open.chars().skip(1).take_while(char::is_ascii_alphabetic).collect();
                    tidy.push_str(&format!("{}></{name}>", open.trim_end()));
                }
                None => tidy.push_str(tag),
            },
        }
    }
    escape(rest, &mut tidy);
    tidy
}

/// Where the first tag begins; a less-than sign of an equation begins none.
fn tag_start(text: &str) -> Option<usize> {
    let begins = |(at, _): &(usize, &str)| {
        text.get(at + 1..)
            .is_some_and(|after| after.starts_with(|c: char| c == '/' || c.is_ascii_alphabetic()))
    };
    text.match_indices('<').find(begins).map(|(at, _)| at)
}

/// Text whose punctuation HTML or Markdown would read, in numeric references; references stay as they are.
fn escape(text: &str, into: &mut String) {
    for (at, c) in text.char_indices() {
        match c {
            '\n' => into.push(' '),
            '&' if is_reference(text.get(at + 1..).unwrap_or_default()) => into.push('&'),
            '<' | '&' | '*' | '_' | '|' | '\\' | '`' | '$' | '[' | ']' | '~' | '!' | '{' | '}' => {
                into.push_str(&format!("&#{};", u32::from(c)));
            }
            c => into.push(c),
        }
    }
}

/// Whether a reference of HTML goes on with this after its `&`.
fn is_reference(after: &str) -> bool {
    let name = after.split_once(';').map_or("", |(name, _)| name);
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '#')
}

#[cfg(test)]
mod tests {
    use super::{Place, mathml};

    #[test]
    fn an_equation_becomes_one_line_without_markdown() {
        let line = mathml(r"F^* = |W_1| \bigl[x_*\bigr] < 1", Place::Line).unwrap();
        assert!(line.starts_with("<math") && line.ends_with("</math>"), "{line}");
        assert!(line.contains("<msup><mi>F</mi>"), "{line}");
        let text: String =
            line.split('<').filter_map(|part| part.split_once('>')).map(|(_, text)| text).collect();
        assert!(!text.contains(['*', '|', '[', '_', '\n']), "{text}");
        assert!(text.contains("&#60;"), "{text}");
        assert!(!line.contains("/>"));
    }

    #[test]
    fn a_block_may_have_a_number() {
        let block = mathml("a = b \\tag{6}\n", Place::Block).unwrap();
        assert!(block.contains("display=\"block\"") && block.ends_with("<span>(6)</span></span>"), "{block}");
        assert!(mathml("a = b", Place::Block).unwrap().ends_with("</math></span>"));
    }

    #[test]
    fn aligned_equations_meet_at_their_signs() {
        let two = mathml(r"\begin{aligned} a &= b \\ c &= d \end{aligned}", Place::Block).unwrap();
        assert_eq!(two.matches("text-align:right").count(), 2, "{two}");
        assert_eq!(two.matches("text-align:left").count(), 2, "{two}");
        let matrix = mathml(r"\begin{bmatrix} a & b \\ c & d \end{bmatrix}", Place::Block).unwrap();
        assert!(!matrix.contains("text-align"), "{matrix}");
    }

    #[test]
    fn a_wrong_equation_is_an_error_that_shows_it() {
        for wrong in [r"\frac{a", r"\nosuchcommand x", r"a_b_c"] {
            let error = mathml(wrong, Place::Line).unwrap_err().to_string();
            assert!(error.contains(&wrong.replace('\\', "\\\\")), "{error}");
        }
    }
}
