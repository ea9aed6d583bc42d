//! Lines, delimiters, fields, numbers: the text of a record as a table.

use std::borrow::Cow;

/// What separates the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delimiter {
    /// One character a gap; empty fields are possible.
    Character(char),
    /// Any number of spaces.
    Space,
}

/// The lines that hold something, with their numbers (1 is the first): no comments, no empty ones.
pub(crate) fn content_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // A text without any line feed is from a system that ends lines with a carriage return alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.split(end)
        .enumerate()
        .map(|(index, line)| (index + 1, line.strip_suffix('\r').unwrap_or(line)))
        .filter(|(_, line)| {
            let line = line.trim();
            !line.is_empty() && !line.starts_with('#') && line.contains(|c: char| !is_separator(c))
        })
}

fn is_separator(c: char) -> bool {
    c.is_whitespace() || c == ',' || c == ';'
}

/// The delimiter of a table: the first of semicolon, tab and comma that most of its first lines contain
/// outside quotes, else space.
pub(crate) fn detect_delimiter(text: &str) -> Delimiter {
    let lines: Vec<&str> = content_lines(text).take(20).map(|(_, line)| line).collect();
    let contains = |line: &&&str, delimiter| {
        let mut quoted = false;
        line.chars().any(|c| {
            quoted ^= c == '"';
            !quoted && c == delimiter
        })
    };
    [';', '\t', ',']
        .into_iter()
        .find(|&delimiter| 2 * lines.iter().filter(|line| contains(line, delimiter)).count() > lines.len())
        .map_or(Delimiter::Space, Delimiter::Character)
}

/// The fields of a line, trimmed, quotes taken off; in quotes a doubled quote is one.
pub(crate) fn fields(line: &str, delimiter: Delimiter) -> Vec<Cow<'_, str>> {
    let mut fields = Vec::new();
    let mut start = 0;
    let mut quoted = false;
    for (at, c) in line.char_indices() {
        quoted ^= c == '"';
        let separates = match delimiter {
            Delimiter::Character(delimiter) => c == delimiter,
            Delimiter::Space => c.is_whitespace(),
        };
        if separates && !quoted {
            fields.push(unquote(line.get(start..at).unwrap_or("")));
            start = at + c.len_utf8();
        }
    }
    fields.push(unquote(line.get(start..).unwrap_or("")));
    if delimiter == Delimiter::Space {
        fields.retain(|field| !field.is_empty());
    }
    fields
}

fn unquote(field: &str) -> Cow<'_, str> {
    let field = field.trim();
    match field.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) if inner.contains("\"\"") => Cow::Owned(inner.replace("\"\"", "\"").trim().to_owned()),
        Some(inner) => Cow::Borrowed(inner.trim()),
        None => Cow::Borrowed(field),
    }
}

/// A number as written in a table: the decimal sign may be a comma where commas do not separate columns.
pub(crate) fn number(field: &str, delimiter: Delimiter) -> Option<f64> {
    if let Ok(value) = field.parse() {
        return Some(value);
    }
    let mut text = field.replace('\u{2212}', "-"); // the typographic minus sign
    if delimiter != Delimiter::Character(',') && text.matches(',').count() == 1 && !text.contains('.') {
        text = text.replace(',', ".");
    }
    text.parse().ok()
}

/// Name and unit of a header's field: `force \[N\]` or `force (N)`.
pub(crate) fn name_and_unit(field: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, rest)) = field.rsplit_once(open)
            && let Some((unit, _)) = rest.split_once(close)
        {
            return (name.trim(), Some(unit.trim()));
        }
    }
    (field.trim(), None)
}

/// The fields of a header. Where spaces separate columns, a unit in brackets belongs to the name before it.
pub(crate) fn header_fields(line: &str, delimiter: Delimiter) -> Vec<String> {
    let mut header: Vec<String> = Vec::new();
    for field in fields(line, delimiter) {
        match header.last_mut() {
            Some(name) if delimiter == Delimiter::Space && field.starts_with(['[', '(']) => {
                name.push(' ');
                name.push_str(&field);
            }
            _ => header.push(field.into_owned()),
        }
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delimiter_is_recognised_beside_decimal_commas_and_quotes() {
        assert_eq!(detect_delimiter("a;b\n1,5;2,5\n"), Delimiter::Character(';'));
        assert_eq!(detect_delimiter("a\tb\n1,5\t2,5\n"), Delimiter::Character('\t'));
        assert_eq!(detect_delimiter("\"a;b\",c\n1,2\n"), Delimiter::Character(','));
        assert_eq!(detect_delimiter("a b\n1 2\n"), Delimiter::Space);
    }

    #[test]
    fn fields_keep_what_quotes_protect() {
        let comma = Delimiter::Character(',');
        assert_eq!(fields(r#" "a, ""b""" , c,"#, comma), ["a, \"b\"", "c", ""]);
        assert_eq!(fields("  1   2\t3 ", Delimiter::Space), ["1", "2", "3"]);
    }

    #[test]
    fn numbers_are_read_as_they_are_written() {
        let read = |text| number(text, Delimiter::Character(';'));
        assert_eq!(read("1,5"), Some(1.5));
        assert_eq!(read("\u{2212}1.5e-3"), Some(-1.5e-3));
        assert_eq!(read("1,000.5"), None);
        assert_eq!(read("1,000,5"), None);
        assert_eq!(number("1,5", Delimiter::Character(',')), None);
    }

    #[test]
    fn headers_give_name_and_unit() {
        assert_eq!(name_and_unit("force [N]"), ("force", Some("N")));
        assert_eq!(name_and_unit("Force (rig) [kN]"), ("Force (rig)", Some("kN")));
        assert_eq!(name_and_unit("force"), ("force", None));
        assert_eq!(header_fields("d [um]  f [N]", Delimiter::Space), ["d [um]", "f [N]"]);
    }

    #[test]
    fn lines_are_counted_as_an_editor_counts_them() {
        let lines: Vec<_> = content_lines("\u{feff}# note\r\n\r\na,b\r\n,,\r\n1,2\r\n\r\n").collect();
        assert_eq!(lines, [(3, "a,b"), (5, "1,2")]);
        assert_eq!(content_lines("a\rb\r").collect::<Vec<_>>(), [(1, "a"), (2, "b")]);
    }
}
