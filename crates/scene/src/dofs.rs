//! `model.dofs` and `model.fixed`: the names of the degrees of freedom, and which of them are held.

use std::collections::HashMap;
use std::sync::Arc;

use crate::error::SceneError;
use crate::lines::names;
use crate::read::{Node, suggestion};
use crate::records::Records;

/// The other side of a contact that is no dof.
pub(crate) const GROUND: &str = "ground";

pub(crate) const FILE_KEYS: [&str; 1] = ["file"];

/// Names that are shown when one is unknown.
const SHOWN: usize = 16;

/// The names of a model's dofs: all of them in the order of its files, and those that move.
#[derive(Debug, Clone)]
pub(crate) struct Dofs(Arc<Table>);

#[derive(Debug)]
struct Table {
    /// Names of the dofs that move, in order.
    free: Vec<String>,
    /// Names of all, in the order of the matrices; empty when none is held.
    all: Vec<String>,
    /// Position among all.
    places: HashMap<String, usize>,
    /// Position among those that move of each dof; `None` is held.
    numbers: Vec<Option<usize>>,
}

impl Dofs {
    /// Dofs with these names, none held.
    fn new(names: Vec<String>) -> Self {
        let places = names.iter().enumerate().map(|(i, name)| (name.clone(), i)).collect();
        let numbers = (0..names.len()).map(Some).collect();
        Self(Arc::new(Table { free: names, all: Vec::new(), places, numbers }))
    }

    /// The names "1" … "n".
    pub(crate) fn counted(n: usize) -> Self {
        Self::new((1..=n).map(|i| i.to_string()).collect())
    }

    /// Reads `dofs`: a list of names, or a file with one a line.
    pub(crate) fn read(node: &Node, records: &Records) -> Result<Self, SceneError> {
        let form = "names, one a dof: a list, or {\"file\": \"names.txt\"}";
        let named = given(node, form, records)?;
        if named.is_empty() {
            return Err(node.error("must not be empty"));
        }
        let mut places = HashMap::with_capacity(named.len());
        for (i, (name, place)) in named.iter().enumerate() {
            let wrong = |problem: String| place.error(problem);
            if name == GROUND {
                return Err(wrong("\"ground\" is what does not move; give the dof another name".into()));
            }
            if places.insert(name.clone(), i).is_some() {
                return Err(wrong(format!("there is a dof {name:?} already; names must differ")));
            }
        }
        let free: Vec<String> = named.into_iter().map(|(name, _)| name).collect();
        let numbers = (0..free.len()).map(Some).collect();
        Ok(Self(Arc::new(Table { free, all: Vec::new(), places, numbers })))
    }

    /// The same dofs with those held that `fixed` names: a list of names and patterns (`12:*`), or a file of them.
    pub(crate) fn hold(self, fixed: &Node, records: &Records) -> Result<Self, SceneError> {
        let form = "names of held dofs and patterns such as \"12:*\": a list, or {\"file\": \"fixed.txt\"}";
        let patterns = match fixed.text("") {
            Ok(pattern) => vec![(pattern.to_owned(), Place { node: fixed.clone(), line: None })],
            Err(_) => given(fixed, form, records)?,
        };
        let mut held = vec![false; self.everything()];
        for (pattern, place) in &patterns {
            let found = if pattern.contains('*') {
                let mut any = false;
                for (name, held) in self.all().iter().zip(&mut held).filter(|(name, _)| fits(pattern, name)) {
                    any = !name.is_empty();
                    *held = true;
                }
                any
            } else {
                let place = self.0.places.get(pattern);
                place.and_then(|place| held.get_mut(*place)).map(|held| *held = true).is_some()
            };
            if !found {
                return Err(place.error(self.unknown(pattern)));
            }
        }
        if held.iter().all(|held| *held) {
            return Err(fixed.error("holds every dof; nothing is left to move"));
        }
        if !held.contains(&true) {
            return Ok(self);
        }
        let all = self.all().to_vec();
        let mut numbers = Vec::with_capacity(all.len());
        let mut free = Vec::new();
        for (name, held) in all.iter().zip(&held) {
            numbers.push((!held).then_some(free.len()));
            if !held {
                free.push(name.clone());
            }
        }
        let places = self.0.places.clone();
        Ok(Self(Arc::new(Table { free, all, places, numbers })))
    }

    /// Names of the dofs that move.
    pub(crate) fn names(&self) -> &[String] {
        &self.0.free
    }

    /// How many of them.
    pub(crate) fn len(&self) -> usize {
        self.0.free.len()
    }

    /// How many there are with those that are held.
    pub(crate) fn everything(&self) -> usize {
        self.0.numbers.len()
    }

    fn all(&self) -> &[String] {
        if self.0.all.is_empty() { &self.0.free } else { &self.0.all }
    }

    /// Which of all dofs are held; `None` when none is.
    pub(crate) fn held(&self) -> Option<Vec<bool>> {
        (self.len() < self.everything()).then(|| self.0.numbers.iter().map(Option::is_none).collect())
    }

    /// Takes from values of all dofs those of the ones that move.
    pub(crate) fn moving(&self, values: &[f64]) -> Vec<f64> {
        let free = values.iter().zip(&self.0.numbers).filter(|(_, number)| number.is_some());
        free.map(|(value, _)| *value).collect()
    }

    /// Displacements of all dofs that go with a unit displacement of the base: of every dof, or of those whose name ends
    /// in `:direction`.
    pub(crate) fn base_motion(&self, direction: Option<&str>) -> Vec<f64> {
        let moves = |name: &String| match direction {
            Some(direction) => name.rsplit_once(':').is_some_and(|(_, own)| own == direction),
            None => true,
        };
        self.all().iter().map(|name| f64::from(u8::from(moves(name)))).collect()
    }

    /// The directions in the names (`12:x`), each once.
    pub(crate) fn directions(&self) -> Vec<&str> {
        let mut directions: Vec<&str> = Vec::new();
        for (_, own) in self.all().iter().filter_map(|name| name.rsplit_once(':')) {
            if directions.len() < SHOWN && !directions.contains(&own) {
                directions.push(own);
            }
        }
        directions
    }

    /// Number of a dof that moves.
    pub(crate) fn find(&self, name: &str) -> Result<usize, String> {
        match self.0.places.get(name).and_then(|place| self.0.numbers.get(*place)) {
            Some(Some(number)) => Ok(*number),
            Some(None) => Err(format!(
                "dof {name:?} is held by model.fixed and does not move; it is part of \"ground\""
            )),
            None => Err(self.unknown(name)),
        }
    }

    /// The directions in the names of a node's dofs, held ones included, in the order of the model.
    pub(crate) fn directions_of(&self, node: &str) -> Vec<&str> {
        let parts = self.all().iter().filter_map(|name| name.rsplit_once(':'));
        parts.filter(|(own, _)| *own == node).map(|(_, direction)| direction).collect()
    }

    /// Number of a dof; `None` where it is held.
    pub(crate) fn place(&self, name: &str) -> Result<Option<usize>, String> {
        match self.0.places.get(name).and_then(|place| self.0.numbers.get(*place)) {
            Some(number) => Ok(*number),
            None => Err(self.unknown(name)),
        }
    }

    /// Number of the dof that `node` names.
    pub(crate) fn index(&self, node: &Node) -> Result<usize, SceneError> {
        self.find(node.text("the name of a dof")?).map_err(|problem| node.error(problem))
    }

    fn unknown(&self, name: &str) -> String {
        let all = self.all();
        if name.contains('*') {
            return format!("no dof in model.dofs fits {name:?}; {}", self.known(name, &[]));
        }
        // The nearest of all names, and the first of them.
        let nearest =
            all.iter().map(|known| (strsim::damerau_levenshtein(name, known), known.as_str())).min();
        let known: Vec<&str> =
            nearest.map(|(_, nearest)| nearest).into_iter().filter(|_| all.len() > SHOWN).collect();
        format!("there is no dof {name:?} in model.dofs; {}", self.known(name, &known))
    }

    fn known(&self, name: &str, nearest: &[&str]) -> String {
        let all = self.all();
        let first = all.iter().map(String::as_str).filter(|known| !nearest.contains(known));
        let known: Vec<&str> = nearest.iter().copied().chain(first).take(SHOWN).collect();
        let suggested = suggestion(name, &known);
        match all.len().saturating_sub(known.len()) {
            more if more > 0 && suggested.starts_with("known") => format!("{suggested} and {more} more"),
            _ => suggested,
        }
    }
}

/// Where a name stands: an item of a list, or a line of a file.
struct Place<'a> {
    node: Node<'a>,
    line: Option<usize>,
}

impl Place<'_> {
    fn error(&self, problem: String) -> SceneError {
        match self.line {
            Some(line) => self.node.error(format!("line {line}: {problem}")),
            None => self.node.error(problem),
        }
    }
}

/// The names in a list or in a file.
fn given<'a>(node: &Node<'a>, form: &str, records: &Records) -> Result<Vec<(String, Place<'a>)>, SceneError> {
    let mut named = Vec::new();
    if node.is_object() {
        let file = node.object("file: names, one a line", &FILE_KEYS)?.need("file", "\"names.txt\"")?;
        for (line, name) in names(&file, records)? {
            named.push((name, Place { node: file.clone(), line: Some(line) }));
        }
        return Ok(named);
    }
    if !node.is_list() {
        return Err(node.must_be(form));
    }
    for item in node.list("of names")? {
        named.push((item.text("the name of a dof")?.to_owned(), Place { node: item, line: None }));
    }
    Ok(named)
}

/// Whether a name fits a pattern, in which `*` stands for anything.
fn fits(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let Some(mut rest) = parts.next().and_then(|first| name.strip_prefix(first)) else {
        return false;
    };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
    for part in middle {
        match rest.find(part) {
            Some(at) => rest = rest.get(at + part.len()..).unwrap_or_default(),
            None => return false,
        }
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_stand_for_anything() {
        for (pattern, name, fit) in [
            ("12:*", "12:x", true),
            ("12:*", "112:x", false),
            ("*:x", "12:x", true),
            ("*:x", "12:xx", false),
            ("*", "", true),
            ("1*2*3", "1a2b3", true),
            ("1*2*3", "132", false),
            ("a*a", "a", false),
            ("*ab*ab", "xab", false),
        ] {
            assert_eq!(fits(pattern, name), fit, "{pattern} {name}");
        }
    }
}
