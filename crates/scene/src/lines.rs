//! Files of names: one a line, or node and direction in two columns.

use crate::error::SceneError;
use crate::read::Node;
use crate::records::Records;

/// A file of names longer than this is none.
const LONGEST: u64 = 1 << 30;

/// The names in the file that `file` names, each with its line counted from 1: one word a line, or two (node and
/// direction) which are joined, `12 x` being `12:x`. Words are separated by spaces, tabs, commas or semicolons; blank
/// lines and those that begin with `#` do not count.
pub(crate) fn names(file: &Node, records: &Records) -> Result<Vec<(usize, String)>, SceneError> {
    let name = file.text("the name of a file")?;
    let path = records.file(name);
    let unreadable = |why: String| file.error(format!("cannot read {name}: {why}"));
    let about = std::fs::metadata(&path).map_err(|error| unreadable(error.to_string()))?;
    if !about.is_file() || about.len() > LONGEST {
        return Err(unreadable("it is no file of names".into()));
    }
    let text = std::fs::read_to_string(&path).map_err(|error| unreadable(error.to_string()))?;
    let mut found = Vec::new();
    for (i, line) in text.strip_prefix('\u{feff}').unwrap_or(&text).lines().enumerate() {
        if line.trim_start().starts_with('#') {
            continue;
        }
        let separates = |letter: char| letter.is_whitespace() || letter == ',' || letter == ';';
        let words: Vec<&str> = line.split(separates).filter(|word| !word.is_empty()).collect();
        match words.as_slice() {
            [] => {}
            [name] => found.push((i + 1, (*name).to_owned())),
            [node, direction] => found.push((i + 1, format!("{node}:{direction}"))),
            more => {
                let count = more.len();
                return Err(file.error(format!(
                    "{name}, line {}: must be a name, or node and direction, got {count} words",
                    i + 1
                )));
            }
        }
    }
    if found.is_empty() {
        return Err(file.error(format!("{name} has no names in it")));
    }
    Ok(found)
}
