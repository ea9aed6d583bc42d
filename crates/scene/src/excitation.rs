//! `excitation`: forces, base accelerations and unbalances.

use hbm::{Excitation, ExcitationKind};

use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::harmonics::MOST_HARMONICS;
use crate::read::{Node, Object, suggestion};

pub(crate) const KEYS: [&str; 6] = ["dof", "harmonic", "amplitude", "phase", "kind", "direction"];

/// All excitations of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Excitations {
    pub(crate) entries: Vec<Excitation>,
    /// The directions in which bases move, each once; `None` is every dof. A base excitation has its number as dof.
    pub(crate) directions: Vec<Option<String>>,
    /// What a user should know.
    pub(crate) notes: Vec<String>,
}

/// Reads `excitation`; an empty list is a structure at rest.
pub(crate) fn read(node: &Node, dofs: &Dofs) -> Result<Excitations, SceneError> {
    let mut all = Excitations::default();
    for item in node.list("of excitations")? {
        let entry = read_one(&item, dofs, &mut all)?;
        all.entries.push(entry);
    }
    Ok(all)
}

fn read_one(node: &Node, dofs: &Dofs, all: &mut Excitations) -> Result<Excitation, SceneError> {
    let entry = node.object(
        "dof, amplitude and, where they differ from the usual, harmonic, phase, kind, direction",
        &KEYS,
    )?;
    let kind = match entry.get("kind") {
        Some(kind) => kind.choice(&[
            ("force", ExcitationKind::Force),
            ("base", ExcitationKind::Base),
            ("unbalance", ExcitationKind::Unbalance),
        ])?,
        None => ExcitationKind::Force,
    };
    let dof = if kind == ExcitationKind::Base {
        entry.without(&["dof"], "a base acceleration acts on every dof; leave \"dof\" out")?;
        base(&entry, dofs, all)?
    } else {
        entry.without(
            &["direction"],
            "belongs to a base acceleration; the name of the dof says where a force acts",
        )?;
        dofs.index(&entry.need("dof", "the name of the excited dof")?)?
    };
    let amplitude =
        entry.need("amplitude", "1.0, in N (force), m/s² (base) or kg m (unbalance)")?.number()?;
    let harmonic = entry.get("harmonic").map_or(Ok(1), |node| node.whole(0, MOST_HARMONICS))?;
    let phase = entry.get("phase").map_or(Ok(0.0), |node| node.number())?;
    Ok(Excitation { dof, harmonic, amplitude, phase, kind })
}

/// Number of the base motion of a base excitation.
fn base(entry: &Object, dofs: &Dofs, all: &mut Excitations) -> Result<usize, SceneError> {
    let known = dofs.directions();
    let direction = match entry.get("direction") {
        None => None,
        Some(node) => {
            let direction = node.text("a direction, \"x\" for all dofs whose names end in \":x\"")?;
            if !known.contains(&direction) && !dofs.base_motion(Some(direction)).contains(&1.0) {
                let why = match known.as_slice() {
                    [] => "dofs are called \"12:x\" where they have one".to_owned(),
                    known => suggestion(direction, known),
                };
                return Err(node.error(format!("no dof has a name that ends in \":{direction}\"; {why}")));
            }
            Some(direction.to_owned())
        }
    };
    if direction.is_none() && known.len() > 1 {
        all.notes.push(format!(
            "{}: the base moves every dof alike, in the directions {}; \"direction\": {:?} moves those whose names end in \
             it",
            entry.path(),
            known.join(", "),
            known.first().copied().unwrap_or_default()
        ));
    }
    if let Some(number) = all.directions.iter().position(|other| *other == direction) {
        return Ok(number);
    }
    all.directions.push(direction);
    Ok(all.directions.len() - 1)
}
