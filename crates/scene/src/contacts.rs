//! `contacts`: which bodies touch, and by which law.

use hbm::Contact;

use crate::dofs::{Dofs, GROUND};
use crate::error::SceneError;
use crate::law;
use crate::read::Node;
use crate::records::Records;

pub(crate) const KEYS: [&str; 5] = ["name", "between", "pairs", "law", "scale"];

/// All contacts of a scene, those of `pairs` one by one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Contacts {
    pub(crate) contacts: Vec<Contact>,
    /// What a user should know about the loops.
    pub(crate) notes: Vec<String>,
}

/// Reads `contacts`; none at all is a linear structure.
pub(crate) fn read(node: Option<Node>, dofs: &Dofs, records: &Records) -> Result<Contacts, SceneError> {
    let mut all = Contacts::default();
    for entry in node.map_or(Ok(Vec::new()), |node| node.list("of contacts"))? {
        read_one(&entry, dofs, records, &mut all)?;
    }
    Ok(all)
}

fn read_one(node: &Node, dofs: &Dofs, records: &Records, all: &mut Contacts) -> Result<(), SceneError> {
    let entry = node.object("name, between or pairs, law", &KEYS)?;
    let name_node = entry.need("name", "a name for results and messages")?;
    let name = name_node.text("a name")?;
    let form = "[\"w1\", \"ground\"]";
    let pairs = match (entry.get("between"), entry.get("pairs")) {
        (Some(between), None) => vec![(name.to_owned(), pair(&between, dofs)?)],
        (None, Some(pairs)) => {
            let named = |(i, node): (usize, &Node)| Ok((format!("{name}[{i}]"), pair(node, dofs)?));
            pairs
                .some("of pairs of dofs")?
                .iter()
                .enumerate()
                .map(named)
                .collect::<Result<_, SceneError>>()?
        }
        (Some(_), Some(pairs)) => {
            return Err(pairs.error("is one too many beside \"between\"; keep one of them"));
        }
        (None, None) => {
            return Err(entry.need("between", form).err().unwrap_or_else(|| entry.error("has no bodies")));
        }
    };
    let scale = entry.get("scale").map_or(Ok(1.0), |scale| scale.positive())?;
    let law = law::read(&entry.need("law", "{\"type\": …}")?, records)?;
    for note in law.notes {
        all.notes.push(format!("contact {name:?}: {note}"));
    }
    for (name, (first, second)) in pairs {
        if all.contacts.iter().any(|known| known.name == name) {
            return Err(name_node.error(format!("there is a contact {name:?} already; names must differ")));
        }
        all.contacts.push(Contact { name, first, second, law: law.law.clone(), scale });
    }
    Ok(())
}

/// Two dofs, or one and the ground.
fn pair(node: &Node, dofs: &Dofs) -> Result<(usize, Option<usize>), SceneError> {
    let form = "two dofs, or one and \"ground\": [\"w1\", \"ground\"]";
    let names = node.list(form)?;
    let [first, second] = names.as_slice() else {
        return Err(node.error(format!("must be {form}, got {} name(s)", names.len())));
    };
    let grounded = |node: &Node| node.text("the name of a dof").is_ok_and(|name| name == GROUND);
    if grounded(first) {
        return Err(first
            .error("put the dof first: the law acts on the displacement of the first against the second"));
    }
    let a = dofs.index(first)?;
    if grounded(second) {
        return Ok((a, None));
    }
    let b = dofs.index(second)?;
    if a == b {
        return Err(second.error("a dof has no contact with itself; name another one or \"ground\""));
    }
    Ok((a, Some(b)))
}
