//! `law` of a contact in several directions: friction under a normal load that the motion changes.

use std::sync::Arc;

use contact::{
    FrictionContact, FrictionContactParameters, JointLaw, LoadedLoop, NormalContact, NormalContactParameters,
};

use crate::error::SceneError;
use crate::law::{self, ReadLaw, SCALED_LOOP_KEYS, read_scaled_loop, refused};
use crate::read::{Node, Object};
use crate::records::Records;

/// Laws that act in several directions; [`SCALED_LOOP_KEYS`] with a normal load is another.
pub(crate) const LAWS: [&str; 1] = ["friction_contact"];

pub(crate) const FRICTION_CONTACT_KEYS: [&str; 6] =
    ["type", "tangential_stiffness", "normal_stiffness", "friction_coefficient", "preload", "gap"];
pub(crate) const NORMAL_LOAD_KEYS: [&str; 4] = ["reference", "stiffness", "preload", "gap"];

/// Whether the law is one for several directions.
pub(crate) fn acts_in_several_directions(law: &Node) -> Result<bool, SceneError> {
    let (_, name) = law::kind(law)?;
    Ok(LAWS.contains(&name) || (name == "scaled_loop" && law.peek("normal_load").is_some()))
}

/// Reads such a law for contacts with so many directions, the normal one included.
pub(crate) fn read(
    node: &Node,
    directions: usize,
    records: &Records,
) -> Result<ReadLaw<dyn JointLaw>, SceneError> {
    let tangential = directions.saturating_sub(1);
    if law::kind(node)?.1 == "scaled_loop" {
        return loaded_loop(node, tangential, records);
    }
    let law = node.object("friction under a normal load", &FRICTION_CONTACT_KEYS)?;
    let number = |key: &str, form: &str| law.need(key, form)?.number();
    let tangential_stiffness = number("tangential_stiffness", "1e7, in N/m")?;
    let normal_stiffness = number("normal_stiffness", "1e7, in N/m")?;
    let friction_coefficient = number("friction_coefficient", "0.3")?;
    let (preload, gap) = load(&law)?;
    let parameters = FrictionContactParameters {
        tangential_stiffness,
        normal_stiffness,
        friction_coefficient,
        preload,
        gap,
    };
    let law = FrictionContact::new(parameters, tangential).map_err(|error| refused(node.path(), error))?;
    Ok(ReadLaw { law: Arc::new(law), notes: Vec::new() })
}

/// A measured loop whose force goes with the normal load.
fn loaded_loop(
    node: &Node,
    tangential: usize,
    records: &Records,
) -> Result<ReadLaw<dyn JointLaw>, SceneError> {
    let law = node.object("a scaled loop", &SCALED_LOOP_KEYS)?;
    let entry = law.need("normal_load", "{\"reference\": 22.0, …}")?;
    let normal = entry.object("reference, stiffness and preload or gap", &NORMAL_LOAD_KEYS)?;
    let form = "22.0, the normal load in N under which the loop was measured";
    let reference = normal.need("reference", form)?.number()?;
    let stiffness = normal.need("stiffness", "1e7, in N/m")?.number()?;
    let (preload, gap) = load(&normal)?;
    if tangential != 1 {
        return Err(node.error(
            "a measured loop acts in one tangential direction, and this contact has two; write \"tangential\" with one",
        ));
    }
    let (scaled, notes) = read_scaled_loop(&law, records)?;
    let place = |error| refused(entry.path(), error);
    let normal = NormalContact::new(NormalContactParameters { stiffness, preload, gap }).map_err(place)?;
    let loaded = LoadedLoop::new(scaled, normal, reference).map_err(place)?;
    Ok(ReadLaw { law: Arc::new(loaded), notes })
}

/// `preload` in N or `gap` in m.
fn load(law: &Object) -> Result<(Option<f64>, Option<f64>), SceneError> {
    match (law.get("preload"), law.get("gap")) {
        (Some(preload), None) => Ok((Some(preload.number()?), None)),
        (None, Some(gap)) => Ok((None, Some(gap.number()?))),
        (Some(_), Some(gap)) => Err(gap.error(
            "is one too many beside \"preload\"; keep one: a preload belongs to the static equilibrium from which \
             displacements are measured, a gap (negative: an interference) to the unloaded structure",
        )),
        (None, None) => {
            Err(law.error("needs \"preload\" (N, at the equilibrium without motion) or \"gap\" (m, negative: an interference)"))
        }
    }
}
