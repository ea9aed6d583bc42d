//! JSON text → values, with duplicate keys refused, comments dropped, and errors that know their path.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};

use crate::error::SceneError;
use crate::read::show;

/// A JSON value. Objects keep the order of the text.
#[derive(Debug, Clone, PartialEq)]
pub enum Json {
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag(bool),
    /// Finite.
    Number(f64),
    /// A string.
    Text(String),
    /// An array.
    List(Vec<Json>),
    /// Keys and values.
    Object(Vec<(String, Json)>),
}

impl Json {
    /// What this is, for a message.
    pub fn describe(&self) -> String {
        match self {
            Self::Null => "null".into(),
            Self::Flag(flag) => flag.to_string(),
            Self::Number(number) => show(*number),
            Self::Text(text) => format!("the text {text:?}"),
            Self::List(list) => format!("a list of {}", list.len()),
            Self::Object(_) => "an object".into(),
        }
    }
}

/// Keys that are allowed in every object and mean nothing.
const REMARKS: [&str; 2] = ["$schema", "comment"];

/// Reads one JSON value and nothing after it.
pub fn parse(text: &str) -> Result<Json, SceneError> {
    // Editors on some systems begin a file with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let culprit = RefCell::new(None);
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Value { path: String::new(), culprit: &culprit };
    value
        .deserialize(&mut deserializer)
        .and_then(|json| deserializer.end().map(|()| json))
        .map_err(|error| syntax(&error, culprit.take().unwrap_or_default()))
}

fn syntax(error: &serde_json::Error, place: String) -> SceneError {
    let (line, column) = (error.line(), error.column());
    let text = error.to_string();
    let problem = text.split(" at line ").next().unwrap_or(&text).to_owned();
    if let Some(problem) = problem.strip_prefix(ENTRY) {
        return SceneError::entry(&place, problem);
    }
    match problem.as_str() {
        "number out of range" => SceneError::entry(&place, "the number is too large to be finite"),
        "trailing characters" => SceneError::Syntax {
            line,
            column,
            place,
            problem: "something follows after the scene's closing brace".into(),
        },
        _ => SceneError::Syntax { line, column, place, problem: format!("not valid JSON: {problem}") },
    }
}

/// Marks an error of ours, which is about an entry rather than the syntax.
const ENTRY: &str = "entry: ";

/// One value and where it stands. The innermost value that cannot be read leaves its path in `culprit`.
struct Value<'c> {
    path: String,
    culprit: &'c RefCell<Option<String>>,
}

impl Value<'_> {
    fn child(&self, path: String) -> Self {
        Self { path, culprit: self.culprit }
    }

    fn blame(&self, path: &str) {
        self.culprit.borrow_mut().get_or_insert_with(|| path.to_owned());
    }
}

impl<'de> DeserializeSeed<'de> for Value<'_> {
    type Value = Json;

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<Json, D::Error> {
        let (path, culprit) = (self.path.clone(), self.culprit);
        deserializer.deserialize_any(self).inspect_err(|_| {
            culprit.borrow_mut().get_or_insert(path);
        })
    }
}

impl<'de> Visitor<'de> for Value<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Json, E> {
        Ok(Json::Flag(flag))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Json, E> {
        Ok(Json::Number(number as f64))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Json, E> {
        Ok(Json::Number(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Json, E> {
        Ok(Json::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Json, E> {
        Ok(Json::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut list = Vec::new();
        loop {
            let item = self.child(format!("{}[{}]", self.path, list.len()));
            match items.next_element_seed(item)? {
                Some(item) => list.push(item),
                None => return Ok(Json::List(list)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Json, A::Error> {
        let mut object: Vec<(String, Json)> = Vec::new();
        while let Some(key) = members.next_key::<String>()? {
            let path = below(&self.path, &key);
            if object.iter().any(|(known, _)| *known == key) {
                self.blame(&path);
                return Err(A::Error::custom(format!("{ENTRY}given twice; keep one")));
            }
            let value = members.next_value_seed(self.child(path))?;
            if !REMARKS.contains(&key.as_str()) {
                object.push((key, value));
            }
        }
        Ok(Json::Object(object))
    }
}

/// The path of `key` below `path`.
pub fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn remarks_are_dropped_in_every_object() {
        let json = parse(r#"{"comment": 1, "a": [{"$schema": {}, "b": null, "comment": []}]}"#).unwrap();
        let inner = Json::Object(vec![("b".into(), Json::Null)]);
        assert_eq!(json, Json::Object(vec![("a".into(), Json::List(vec![inner]))]));
    }

    #[test]
    fn a_key_given_twice_is_named() {
        assert_eq!(message(r#"{"a": [0, {"b": 1, "b": 1}]}"#), "a[1].b: given twice; keep one");
        assert!(parse(r#"{"comment": 1, "comment": 2}"#).is_ok());
    }

    #[test]
    fn a_number_that_is_infinite_is_named() {
        assert_eq!(message(r#"{"a": {"b": [1, 1e999]}}"#), "a.b[1]: the number is too large to be finite");
        assert_eq!(message(r#"{"a": -1e999}"#), "a: the number is too large to be finite");
    }

    #[test]
    fn syntax_errors_have_line_column_and_entry() {
        let text = "{\n  \"a\": {\"b\": nan}\n}";
        assert!(message(text).starts_with("line 2, column 15 (in a.b): not valid JSON"), "{}", message(text));
        assert!(message("{\"a\": 1").starts_with("line 1, column 7: not valid JSON: EOF"));
        assert!(message("{} x").contains("something follows"));
        assert!(message("").starts_with("line 1, column 0: not valid JSON"));
    }

    #[test]
    fn deep_nesting_is_refused_without_overflow() {
        assert!(message(&"[".repeat(100_000)).contains("recursion limit"));
    }

    #[test]
    fn a_byte_order_mark_is_no_error() {
        assert_eq!(parse("\u{feff}1").unwrap(), Json::Number(1.0));
    }
}
