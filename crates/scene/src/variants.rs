//! Variants of a scene: the same text with other numbers at some of its entries.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::SceneError;
use crate::json::{self, Json};
use crate::read::suggestion;
use crate::records::Records;
use crate::scene::Scene;

/// A scene's text, of which variants are made. Records are read once for all of them.
#[derive(Debug)]
pub struct Variants {
    json: Json,
    records: Records,
    /// Name of the file, for scenes without one.
    stem: String,
}

impl Variants {
    /// Reads a scene's file; names of files in it are relative to it.
    ///
    /// # Errors
    /// When it cannot be read or is no JSON.
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Self::from_str(&text, path.parent().unwrap_or(Path::new("")), &stem)
    }

    /// Reads a scene's text; names of files in it are relative to `base`, and a scene without a name gets this one.
    ///
    /// # Errors
    /// When it is no JSON.
    pub fn from_str(text: &str, base: &Path, name: &str) -> Result<Self, SceneError> {
        Ok(Self { json: json::parse(text)?, records: Records::new(base), stem: name.to_owned() })
    }

    /// The number at a JSON pointer (`/contacts/0/law/slip_force`).
    ///
    /// # Errors
    /// Where the pointer leads astray, and what is there.
    pub fn number(&self, pointer: &str) -> Result<f64, String> {
        let mut here = &self.json;
        let mut way = String::new();
        for key in keys(pointer)? {
            let place = if way.is_empty() { "the scene".to_owned() } else { format!("{way:?}") };
            here = child(here, &key).map_err(|why| format!("{place} {why}"))?;
            way = format!("{way}/{key}");
        }
        match here {
            Json::Number(number) => Ok(*number),
            other => Err(format!("is {} in the scene; only numbers can be varied", other.describe())),
        }
    }

    /// The scene with other numbers at some pointers.
    ///
    /// # Errors
    /// [`SceneError`] when the numbers make no scene.
    pub fn scene(&self, changes: &[(&str, f64)]) -> Result<Scene, SceneError> {
        let began = Instant::now();
        let mut json = self.json.clone();
        for (pointer, number) in changes {
            let refused = |why: String| SceneError::entry(pointer, why);
            let mut here = &mut json;
            for key in keys(pointer).map_err(refused)? {
                here =
                    child_mut(here, &key).ok_or_else(|| SceneError::entry(pointer, "is not in the scene"))?;
            }
            *here = Json::Number(*number);
        }
        let mut scene = Scene::from_json(&json, &self.records, began)?;
        scene.name_if_none(&self.stem);
        Ok(scene)
    }

    /// The records that the variants made so far have read.
    pub fn files(&self) -> Vec<PathBuf> {
        self.records.files()
    }
}

/// The keys of a JSON pointer, unescaped.
fn keys(pointer: &str) -> Result<Vec<String>, String> {
    let Some(rest) = pointer.strip_prefix('/') else {
        return Err("is no JSON pointer; write \"/excitation/0/amplitude\" (list items count from 0)".into());
    };
    Ok(rest.split('/').map(|key| key.replace("~1", "/").replace("~0", "~")).collect())
}

fn child<'a>(json: &'a Json, key: &str) -> Result<&'a Json, String> {
    match json {
        Json::Object(members) => {
            let known: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
            let found = members.iter().find(|(name, _)| name == key).map(|(_, json)| json);
            found.ok_or_else(|| format!("has no entry {key:?}; {}", suggestion(key, &known)))
        }
        Json::List(items) => {
            let item = key.parse::<usize>().ok().and_then(|index| items.get(index));
            let count = items.len();
            item.ok_or_else(|| match count {
                0 => "is an empty list".into(),
                _ => format!("is a list whose items are called 0 to {}, got {key:?}", count - 1),
            })
        }
        other => Err(format!("is {}, there is nothing in it", other.describe())),
    }
}

fn child_mut<'a>(json: &'a mut Json, key: &str) -> Option<&'a mut Json> {
    match json {
        Json::Object(members) => members.iter_mut().find(|(name, _)| name == key).map(|(_, json)| json),
        Json::List(items) => items.get_mut(key.parse::<usize>().ok()?),
        _ => None,
    }
}
