//! `law` of type `iwan`: from the magnitude law or from a backbone of the user's.

use contact::{Iwan, IwanParameters, MagnitudeLaw, ParameterError};

use crate::error::SceneError;
use crate::law::{read_magnitude, refused};
use crate::read::{Node, Object};

pub(crate) const KEYS: [&str; 7] =
    ["type", "displacement", "force", "magnitude", "range", "backbone", "sliders"];

/// Sliders beyond this are a slip of the pen.
const MOST_SLIDERS: usize = 100_000;

/// Reads the law.
pub(crate) fn read(node: &Node) -> Result<Iwan, SceneError> {
    let law = node.object("an Iwan law", &KEYS)?;
    let place = |error: ParameterError| refused(law.path(), error);
    let iwan = if let Some(backbone) = law.get("backbone") {
        let others = ["displacement", "force", "magnitude", "range"];
        law.without(&others, "is one too many beside \"backbone\"; keep one of them")?;
        Iwan::from_backbone(&read_points(&backbone)?).map_err(place)?
    } else {
        Iwan::from_magnitude(read_parameters(&law)?).map_err(place)?
    };
    match law.get("sliders") {
        Some(sliders) => iwan.discretised(sliders.whole(1, MOST_SLIDERS)?).map_err(place),
        None => Ok(iwan),
    }
}

fn read_parameters(law: &Object) -> Result<IwanParameters, SceneError> {
    Ok(IwanParameters {
        displacement: law.need("displacement", "8e-6, in m (or \"backbone\": [[x, f], …])")?.positive()?,
        force: law.need("force", "12.0, in N")?.positive()?,
        magnitude: law
            .get("magnitude")
            .map_or(Ok(MagnitudeLaw::default()), |magnitude| read_magnitude(&magnitude))?,
        range: law.get("range").map_or(Ok(IwanParameters::default_range()), |range| range.positive())?,
    })
}

/// `[[x, f], …]`
fn read_points(node: &Node) -> Result<Vec<[f64; 2]>, SceneError> {
    let form = "[x in m, f in N]";
    let point = |item: &Node| {
        let numbers = item.numbers(form)?;
        <[f64; 2]>::try_from(numbers)
            .map_err(|numbers| item.error(format!("must be {form}, got {} number(s)", numbers.len())))
    };
    node.some("[[1e-6, 4.0], [2e-6, 6.0]]")?.iter().map(point).collect()
}
