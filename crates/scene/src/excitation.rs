//! `excitation`: forces, base accelerations and unbalances.

use hbm::{Excitation, ExcitationKind};

use crate::error::SceneError;
use crate::harmonics::MOST_HARMONICS;
use crate::model::Dofs;
use crate::read::Node;

pub(crate) const KEYS: [&str; 5] = ["dof", "harmonic", "amplitude", "phase", "kind"];

/// Reads `excitation`; an empty list is a structure at rest.
pub(crate) fn read(node: &Node, dofs: &Dofs) -> Result<Vec<Excitation>, SceneError> {
    node.list("of excitations")?.iter().map(|item| read_one(item, dofs)).collect()
}

fn read_one(node: &Node, dofs: &Dofs) -> Result<Excitation, SceneError> {
    let entry =
        node.object("dof, amplitude and, where they differ from the usual, harmonic, phase, kind", &KEYS)?;
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
        0
    } else {
        dofs.index(&entry.need("dof", "the name of the excited dof")?)?
    };
    let amplitude =
        entry.need("amplitude", "1.0, in N (force), m/s² (base) or kg m (unbalance)")?.number()?;
    let harmonic = entry.get("harmonic").map_or(Ok(1), |node| node.whole(0, MOST_HARMONICS))?;
    let phase = entry.get("phase").map_or(Ok(0.0), |node| node.number())?;
    Ok(Excitation { dof, harmonic, amplitude, phase, kind })
}
