//! Typed reading of JSON values: every refusal names the entry's path.

use crate::error::SceneError;
use crate::json::{Json, below};

/// A value and its path in the scene.
#[derive(Debug, Clone)]
pub struct Node<'a> {
    json: &'a Json,
    path: String,
}

/// An object whose keys are all known.
#[derive(Debug, Clone)]
pub struct Object<'a> {
    members: &'a [(String, Json)],
    path: String,
}

impl<'a> Node<'a> {
    /// The top of a text.
    pub fn root(json: &'a Json) -> Self {
        Self { json, path: String::new() }
    }

    /// The value itself.
    pub(crate) fn json(&self) -> &'a Json {
        self.json
    }

    /// Where it stands, for example `contacts[0].law`.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// An error about this entry.
    pub fn error(&self, problem: impl Into<String>) -> SceneError {
        SceneError::entry(&self.path, problem)
    }

    /// An error that says what this entry should be and what it is.
    pub fn must_be(&self, what: &str) -> SceneError {
        self.error(format!("must be {what}, got {}", self.json.describe()))
    }

    /// The object with these keys and no others; `what` says what it stands for.
    pub fn object(&self, what: &str, keys: &[&str]) -> Result<Object<'a>, SceneError> {
        let Json::Object(members) = self.json else {
            return Err(self.must_be(&format!("an object ({what})")));
        };
        for (key, _) in members {
            if !keys.contains(&key.as_str()) {
                let place = below(&self.path, key);
                return Err(SceneError::entry(&place, format!("unknown key; {}", suggestion(key, keys))));
            }
        }
        Ok(Object { members, path: self.path.clone() })
    }

    /// The object, whatever its keys.
    pub fn any_object(&self, what: &str) -> Result<Object<'a>, SceneError> {
        match self.json {
            Json::Object(members) => Ok(Object { members, path: self.path.clone() }),
            _ => Err(self.must_be(&format!("an object ({what})"))),
        }
    }

    /// The value of `key` when this is an object, whatever else is in it.
    pub fn peek(&self, key: &str) -> Option<Node<'a>> {
        let Json::Object(members) = self.json else {
            return None;
        };
        member(members, &self.path, key)
    }

    /// Whether it is an object.
    pub fn is_object(&self) -> bool {
        matches!(self.json, Json::Object(_))
    }

    /// Whether it is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.json, Json::List(_))
    }

    /// Whether it is a number.
    pub fn is_number(&self) -> bool {
        matches!(self.json, Json::Number(_))
    }

    /// The items of a list.
    pub fn list(&self, what: &str) -> Result<Vec<Node<'a>>, SceneError> {
        let Json::List(items) = self.json else {
            return Err(self.must_be(&format!("a list {what}")));
        };
        let path = |i| format!("{}[{i}]", self.path);
        Ok(items.iter().enumerate().map(|(i, json)| Node { json, path: path(i) }).collect())
    }

    /// The items of a list that is not empty.
    pub fn some(&self, what: &str) -> Result<Vec<Node<'a>>, SceneError> {
        let items = self.list(what)?;
        if items.is_empty() { Err(self.error("must not be empty")) } else { Ok(items) }
    }

    /// A list of numbers; paths are made for errors only.
    pub fn numbers(&self, what: &str) -> Result<Vec<f64>, SceneError> {
        let Json::List(items) = self.json else {
            return Err(self.must_be(&format!("a list {what}")));
        };
        let number = |(i, json): (usize, &'a Json)| match json {
            Json::Number(number) => Ok(*number),
            _ => Node { json, path: format!("{}[{i}]", self.path) }.number(),
        };
        items.iter().enumerate().map(number).collect()
    }

    /// A text that is not empty.
    pub fn text(&self, what: &str) -> Result<&'a str, SceneError> {
        match self.json {
            Json::Text(text) if text.is_empty() => {
                Err(self.error(format!("must be {what}, got an empty text")))
            }
            Json::Text(text) => Ok(text),
            _ => Err(self.must_be(what)),
        }
    }

    /// True or false.
    pub fn flag(&self) -> Option<bool> {
        match self.json {
            Json::Flag(flag) => Some(*flag),
            _ => None,
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, SceneError> {
        match self.json {
            Json::Number(number) => Ok(*number),
            _ => Err(self.must_be("a number")),
        }
    }

    /// A positive number.
    pub fn positive(&self) -> Result<f64, SceneError> {
        let number = self.number()?;
        if number > 0.0 {
            Ok(number)
        } else {
            Err(self.error(format!("must be positive, got {}", show(number))))
        }
    }

    /// A number that is not negative.
    pub fn not_negative(&self) -> Result<f64, SceneError> {
        let number = self.number()?;
        if number >= 0.0 {
            Ok(number)
        } else {
            Err(self.error(format!("must not be negative, got {}", show(number))))
        }
    }

    /// A whole number within the limits.
    pub fn whole(&self, least: usize, most: usize) -> Result<usize, SceneError> {
        let number = self.number()?;
        // Within the limits a whole f64 is a usize exactly.
        if number.fract() == 0.0 && number >= least as f64 && number <= most as f64 {
            return Ok(number as usize);
        }
        Err(self.error(format!("must be a whole number from {least} to {most}, got {}", show(number))))
    }

    /// One of several words.
    pub fn choice<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, SceneError> {
        let names: Vec<&str> = words.iter().map(|(name, _)| *name).collect();
        let list = names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(" or ");
        let Json::Text(word) = self.json else {
            return Err(self.must_be(&list));
        };
        let found = words.iter().find(|(name, _)| name == word);
        found.map(|(_, value)| *value).ok_or_else(|| self.must_be(&list))
    }
}

impl<'a> Object<'a> {
    /// Where it stands.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// An error about the object itself.
    pub fn error(&self, problem: impl Into<String>) -> SceneError {
        SceneError::entry(&self.path, problem)
    }

    /// The value of a key, where it is there.
    pub fn get(&self, key: &str) -> Option<Node<'a>> {
        member(self.members, &self.path, key)
    }

    /// The value of a key that must be there; `form` shows how it looks.
    pub fn need(&self, key: &str, form: &str) -> Result<Node<'a>, SceneError> {
        let place = below(&self.path, key);
        self.get(key).ok_or_else(|| SceneError::entry(&place, format!("is missing; write \"{key}\": {form}")))
    }

    /// Keys and values in the order of the text.
    pub fn members(&self) -> impl Iterator<Item = (&'a str, Node<'a>)> + use<'a> {
        let path = self.path.clone();
        self.members.iter().map(move |(key, json)| (key.as_str(), Node { json, path: below(&path, key) }))
    }

    /// Refuses every one of `keys` that is there.
    pub fn without(&self, keys: &[&str], why: &str) -> Result<(), SceneError> {
        match keys.iter().find_map(|key| self.get(key)) {
            Some(node) => Err(node.error(why)),
            None => Ok(()),
        }
    }
}

fn member<'a>(members: &'a [(String, Json)], path: &str, key: &str) -> Option<Node<'a>> {
    let (_, json) = members.iter().find(|(name, _)| name == key)?;
    Some(Node { json, path: below(path, key) })
}

/// A number as a reader would write it.
pub fn show(number: f64) -> String {
    if number == 0.0 || (1e-4..1e9).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// "did you mean …?" or the list of what is known.
pub fn suggestion(word: &str, known: &[&str]) -> String {
    let nearest = known.iter().map(|name| (strsim::damerau_levenshtein(word, name), name)).min();
    match nearest {
        Some((distance, name)) if 3 * distance <= name.len().max(3) => format!("did you mean \"{name}\"?"),
        _ => format!("known are {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::parse;

    #[test]
    fn unknown_keys_get_the_nearest_name() {
        let json = parse(r#"{"law": {"slipforce": 1}}"#).unwrap();
        let law = Node::root(&json).peek("law").unwrap();
        let error = law.object("a law", &["stiffness", "slip_force"]).unwrap_err().to_string();
        assert_eq!(error, "law.slipforce: unknown key; did you mean \"slip_force\"?");
        assert_eq!(suggestion("xyz", &["from", "to"]), "known are from, to");
    }

    #[test]
    fn wrong_types_say_what_was_found() {
        let json = parse(r#"[1.5, "a", [], {}, null, true, -2]"#).unwrap();
        let items = Node::root(&json).list("of things").unwrap();
        assert_eq!(items[1].number().unwrap_err().to_string(), "[1]: must be a number, got the text \"a\"");
        assert_eq!(
            items[0].whole(1, 9).unwrap_err().to_string(),
            "[0]: must be a whole number from 1 to 9, got 1.5"
        );
        assert_eq!(items[6].positive().unwrap_err().to_string(), "[6]: must be positive, got -2");
        assert!(items[2].some("of things").is_err());
        assert!(items[3].text("a name").unwrap_err().to_string().contains("an object"));
        assert!(
            items[4]
                .choice(&[("a", 1), ("b", 2)])
                .unwrap_err()
                .to_string()
                .contains("\"a\" or \"b\", got null")
        );
    }
}
