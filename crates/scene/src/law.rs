//! `law`: from `law.type` and its parameters to a law of the contact crate.

use std::sync::Arc;

use contact::{
    Coulomb, CoulombParameters, Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Gap,
    GapParameters, Law, Linear, LinearParameters, MagnitudeLaw, ParameterError, PhaseLaw, ScaledLoop,
    Symmetry,
};

use crate::error::SceneError;
use crate::json::below;
use crate::loops::{self, MeasuredLoop};
use crate::read::{Node, Object, suggestion};
use crate::records::Records;
use crate::{iwan, joint_law, loop_family};

/// Laws that exist in one direction.
pub(crate) const LAWS: [&str; 8] =
    ["scaled_loop", "loop_family", "elastic_coulomb", "iwan", "coulomb", "cubic", "linear", "gap"];

pub(crate) const SCALED_LOOP_KEYS: [&str; 6] =
    ["type", "loop", "magnitude", "phase", "symmetric", "normal_load"];
pub(crate) const ELASTIC_COULOMB_KEYS: [&str; 3] = ["type", "stiffness", "slip_force"];
pub(crate) const COULOMB_KEYS: [&str; 3] = ["type", "slip_force", "velocity"];
pub(crate) const SPRING_KEYS: [&str; 2] = ["type", "stiffness"];
pub(crate) const GAP_KEYS: [&str; 3] = ["type", "stiffness", "gap"];
pub(crate) const MAGNITUDE_KEYS: [&str; 3] = ["offset", "slope", "shift"];
pub(crate) const PHASE_KEYS: [&str; 3] = ["limit", "span", "decay"];

/// A law and what a user should know about it.
pub(crate) struct ReadLaw<L: ?Sized> {
    pub(crate) law: Arc<L>,
    pub(crate) notes: Vec<String>,
}

/// The `type` of a law, one of those that exist.
pub(crate) fn kind<'a>(node: &Node<'a>) -> Result<(Node<'a>, &'a str), SceneError> {
    let Some(kind) = node.peek("type") else {
        // Says that it is no object, or that the type is missing.
        let any = [
            &SCALED_LOOP_KEYS[..],
            &ELASTIC_COULOMB_KEYS,
            &COULOMB_KEYS,
            &SPRING_KEYS,
            &GAP_KEYS,
            &loop_family::KEYS,
            &iwan::KEYS,
            &joint_law::FRICTION_CONTACT_KEYS,
        ]
        .concat();
        node.object("type and its parameters", &any)?;
        let types = every_law().map(|law| format!("{law:?}")).collect::<Vec<_>>().join(", ");
        return Err(SceneError::entry(
            &below(node.path(), "type"),
            format!("is missing; write one of {types}"),
        ));
    };
    let name = kind.text("the name of a law")?;
    if every_law().any(|law| law == name) {
        return Ok((kind, name));
    }
    let every: Vec<&str> = every_law().collect();
    let hint = suggestion(name, &every);
    let known =
        if hint.starts_with("known") { String::new() } else { format!(" Known are {}", every.join(", ")) };
    Err(kind.error(format!("there is no law {name:?}; {hint}{known}")))
}

/// Reads the `law` of a contact in one direction.
pub(crate) fn read(node: &Node, records: &Records) -> Result<ReadLaw<dyn Law>, SceneError> {
    let (kind, name) = kind(node)?;
    let law: Arc<dyn Law> = match name {
        "scaled_loop" => return scaled_loop(&node.object("a scaled loop", &SCALED_LOOP_KEYS)?, records),
        "loop_family" => return loop_family::read(node, records),
        "iwan" => Arc::new(iwan::read(node)?),
        "elastic_coulomb" => {
            let law = node.object("elastic Coulomb friction", &ELASTIC_COULOMB_KEYS)?;
            let stiffness = law.need("stiffness", "1e6, in N/m")?.number()?;
            let slip_force = law.need("slip_force", "10.0, in N")?.number()?;
            let parameters = ElasticCoulombParameters { stiffness, slip_force };
            Arc::new(ElasticCoulomb::new(parameters).map_err(|error| refused(node.path(), error))?)
        }
        "coulomb" => {
            let law = node.object("regularised Coulomb friction", &COULOMB_KEYS)?;
            let slip_force = law.need("slip_force", "10.0, in N")?.number()?;
            let velocity = law.need("velocity", "1e-3, in m/s")?.number()?;
            let parameters = CoulombParameters { slip_force, velocity };
            Arc::new(Coulomb::new(parameters).map_err(|error| refused(node.path(), error))?)
        }
        "cubic" => {
            let law = node.object("a cubic spring", &SPRING_KEYS)?;
            let stiffness = law.need("stiffness", "1e9, in N/m³")?.number()?;
            Arc::new(Cubic::new(CubicParameters { stiffness }).map_err(|error| refused(node.path(), error))?)
        }
        "linear" => {
            let law = node.object("a linear spring", &SPRING_KEYS)?;
            let stiffness = law.need("stiffness", "1e6, in N/m")?.number()?;
            Arc::new(
                Linear::new(LinearParameters { stiffness }).map_err(|error| refused(node.path(), error))?,
            )
        }
        "gap" => {
            let law = node.object("a spring that presses and does not pull", &GAP_KEYS)?;
            let stiffness = law.need("stiffness", "1e7, in N/m")?.number()?;
            let gap = law.need("gap", "1e-6, in m")?.number()?;
            Arc::new(Gap::new(GapParameters { stiffness, gap }).map_err(|error| refused(node.path(), error))?)
        }
        // A law of the list in several directions.
        _ => return Err(kind.error(format!("{name} acts in several directions"))),
    };
    Ok(ReadLaw { law, notes: Vec::new() })
}

pub(crate) fn refused(path: &str, error: ParameterError) -> SceneError {
    SceneError::entry(&below(path, &error.key), error.problem)
}

fn every_law() -> impl Iterator<Item = &'static str> {
    LAWS.into_iter().chain(joint_law::LAWS)
}

fn scaled_loop(law: &Object, records: &Records) -> Result<ReadLaw<dyn Law>, SceneError> {
    let (law, notes) = read_scaled_loop(law, records)?;
    Ok(ReadLaw { law: Arc::new(law), notes })
}

/// The loop of a law `scaled_loop` and what a user should know about it.
pub(crate) fn read_scaled_loop(
    law: &Object,
    records: &Records,
) -> Result<(ScaledLoop, Vec<String>), SceneError> {
    let magnitude = law.get("magnitude").map_or(Ok(MagnitudeLaw::default()), |node| read_magnitude(&node))?;
    let phase = law.get("phase").map_or(Ok(PhaseLaw::default()), |node| read_phase(&node))?;
    let symmetry = read_symmetry(law)?;
    let place = |error: ParameterError| refused(law.path(), error);
    let form = "{\"file\": \"record.csv\"} or {\"displacement\": 8e-6, \"force\": 12.0}";
    match loops::read(&law.need("loop", form)?, records)? {
        MeasuredLoop::Ellipse { displacement, force } => {
            Ok((ScaledLoop::ellipse(displacement, force, magnitude, phase).map_err(place)?, Vec::new()))
        }
        MeasuredLoop::Series { hysteresis_loop, noise, mut notes } => {
            let scaled =
                ScaledLoop::new(&hysteresis_loop, noise, magnitude, phase, symmetry).map_err(place)?;
            notes.extend(loops::notes(&hysteresis_loop, &scaled));
            Ok((scaled, notes))
        }
    }
}

/// `symmetric` of a law of measured loops.
pub(crate) fn read_symmetry(law: &Object) -> Result<Symmetry, SceneError> {
    law.get("symmetric").map_or(Ok(Symmetry::Auto), |node| match node.flag() {
        Some(true) => Ok(Symmetry::Odd),
        Some(false) => Ok(Symmetry::Full),
        None => node
            .choice(&[("auto", Symmetry::Auto)])
            .map_err(|_| node.error("must be \"auto\", true or false")),
    })
}

pub(crate) fn read_magnitude(node: &Node) -> Result<MagnitudeLaw, SceneError> {
    let law = node.object("offset, slope, shift of eq. (6)", &MAGNITUDE_KEYS)?;
    let paper = MagnitudeLaw::default();
    let number = |key: &str, default: f64| law.get(key).map_or(Ok(default), |node| node.number());
    Ok(MagnitudeLaw {
        offset: number("offset", paper.offset)?,
        slope: number("slope", paper.slope)?,
        shift: number("shift", paper.shift)?,
    })
}

fn read_phase(node: &Node) -> Result<PhaseLaw, SceneError> {
    let law = node.object("limit, span, decay of eq. (7)", &PHASE_KEYS)?;
    let paper = PhaseLaw::default();
    let number = |key: &str, default: f64| law.get(key).map_or(Ok(default), |node| node.number());
    Ok(PhaseLaw {
        limit: number("limit", paper.limit)?,
        span: number("span", paper.span)?,
        decay: number("decay", paper.decay)?,
    })
}
