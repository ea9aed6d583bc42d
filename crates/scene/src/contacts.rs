//! `contacts`: which bodies touch, and by which law.

use hbm::{Contact, Joint};

use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::law::{self, ReadLaw};
use crate::read::{Node, Object};
use crate::records::Records;
use crate::{joint_law, joints};

pub(crate) const KEYS: [&str; 9] =
    ["name", "between", "pairs", "nodes", "node_pairs", "axes", "directions", "law", "scale"];

/// Which entry of a problem a contact of the scene is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Of its contacts in one direction.
    Contact(usize),
    /// Of its joints.
    Joint(usize),
}

/// All contacts of a scene, those of `pairs` one by one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Contacts {
    pub(crate) contacts: Vec<Contact>,
    /// Those in several directions.
    pub(crate) joints: Vec<Joint>,
    /// All of them in the order of the scene.
    pub(crate) order: Vec<Place>,
    /// What a user should know about the loops.
    pub(crate) notes: Vec<String>,
}

impl Contacts {
    /// Names in the order of the scene.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.order.iter().filter_map(|place| match *place {
            Place::Contact(i) => self.contacts.get(i).map(|contact| contact.name.as_str()),
            Place::Joint(i) => self.joints.get(i).map(|joint| joint.name.as_str()),
        })
    }

    /// The dofs that contacts touch; some of them several times.
    pub(crate) fn touched(&self) -> impl Iterator<Item = usize> {
        let pairs = self.contacts.iter().flat_map(|contact| [Some(contact.first), contact.second]).flatten();
        let directions = self.joints.iter().flat_map(|joint| &joint.directions);
        pairs.chain(directions.flat_map(|direction| direction.parts.iter().map(|part| part.0)))
    }
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
    let scale = entry.get("scale").map_or(Ok(1.0), |scale| scale.positive())?;
    let law_node = entry.need("law", "{\"type\": …}")?;
    let several = joint_law::acts_in_several_directions(&law_node)?;
    let new = |all: &Contacts, name: &str| match all.names().any(|known| known == name) {
        true => Err(name_node.error(format!("there is a contact {name:?} already; names must differ"))),
        false => Ok(()),
    };
    let law_notes = if several {
        let why = "has one direction, and this law acts in several; write \"nodes\" with \"axes\", or \"directions\"";
        entry.without(&["between", "pairs"], why)?;
        let bodies = joints::read(&entry, name, dofs)?;
        let directions = bodies.first().map_or(0, |(_, directions)| directions.len());
        let ReadLaw { law, notes } = joint_law::read(&law_node, directions, records)?;
        for (name, directions) in bodies {
            new(all, &name)?;
            all.order.push(Place::Joint(all.joints.len()));
            all.joints.push(Joint { name, directions, law: law.clone(), scale });
        }
        notes
    } else {
        let pairs = one_direction(&entry, &law_node, name, dofs)?;
        let ReadLaw { law, notes } = law::read(&law_node, records)?;
        for (name, (first, second)) in pairs {
            new(all, &name)?;
            all.order.push(Place::Contact(all.contacts.len()));
            all.contacts.push(Contact { name, first, second, law: law.clone(), scale });
        }
        notes
    };
    all.notes.extend(law_notes.into_iter().map(|note| format!("contact {name:?}: {note}")));
    Ok(())
}

/// A name, a dof and another one or the ground.
type Pair = (String, (usize, Option<usize>));

/// The bodies of an entry whose law acts in one direction.
fn one_direction(entry: &Object, law: &Node, name: &str, dofs: &Dofs) -> Result<Vec<Pair>, SceneError> {
    let way_out = match law::kind(law)?.1 {
        "scaled_loop" => "; or add \"normal_load\" to the law",
        _ => " (\"friction_contact\" is a law for several)",
    };
    let why = format!(
        "is for a law in several directions, and this one acts in one; write \"between\": [\"2201:x\", \"2301:x\"]{way_out}"
    );
    entry.without(&joints::KEYS, &why)?;
    match (entry.get("between"), entry.get("pairs")) {
        (Some(between), None) => Ok(vec![(name.to_owned(), joints::pair(&between, dofs)?)]),
        (None, Some(pairs)) => {
            let named = |(i, node): (usize, &Node)| Ok((format!("{name}[{i}]"), joints::pair(node, dofs)?));
            pairs.some("of pairs of dofs")?.iter().enumerate().map(named).collect()
        }
        (Some(_), Some(pairs)) => Err(pairs.error("is one too many beside \"between\"; keep one of them")),
        (None, None) => {
            let form = "[\"w1\", \"ground\"]";
            Err(entry.need("between", form).err().unwrap_or_else(|| entry.error("has no bodies")))
        }
    }
}
