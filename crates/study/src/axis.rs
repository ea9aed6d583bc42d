//! One varied entry of a scene: where it stands and the values it takes.

use scene::SceneError;
use scene::reading::{Node, show};

pub(crate) const KEYS: [&str; 4] = ["from", "to", "points", "spacing"];

/// The most values of one entry.
const MOST_VALUES: usize = 1_000_000;

/// A varied entry.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// JSON pointer into the scene.
    pub pointer: String,
    /// The values it takes, in the order of the cases.
    pub values: Vec<f64>,
    /// The values grow by a factor rather than by a step.
    pub logarithmic: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Spacing {
    Linear,
    Log,
}

impl Axis {
    /// Reads a range or a list.
    pub(crate) fn read(pointer: &str, node: &Node) -> Result<Self, SceneError> {
        if node.is_list() {
            let values = node.numbers("of values")?;
            if values.is_empty() {
                return Err(node.error("must not be empty"));
            }
            return Ok(Self { pointer: pointer.to_owned(), values, logarithmic: false });
        }
        let what = "from, to, points";
        if !node.is_object() {
            return Err(node.must_be(&format!("a list of values or an object ({what})")));
        }
        let range = node.object(what, &KEYS)?;
        let (first, last) = (range.need("from", "1.0")?, range.need("to", "100.0")?);
        let (from, to) = (first.number()?, last.number()?);
        let points_node = range.need("points", "20")?;
        let points = points_node.whole(1, MOST_VALUES)?;
        let spacing = match range.get("spacing") {
            Some(spacing) => spacing.choice(&[("linear", Spacing::Linear), ("log", Spacing::Log)])?,
            None => Spacing::Linear,
        };
        if points == 1 && from != to {
            let problem =
                format!("one point cannot reach from {} to {}; write 2 or more", show(from), show(to));
            return Err(points_node.error(problem));
        }
        if points > 1 && from == to {
            return Err(points_node
                .error(format!("{points} points, but \"from\" and \"to\" are both {}", show(from))));
        }
        let logarithmic = spacing == Spacing::Log;
        if logarithmic && from * to <= 0.0 {
            return Err(last.error("logarithmic spacing needs two ends of the same sign, not zero"));
        }
        let at = |i: usize| match i {
            0 => from,
            _ if i + 1 == points => to,
            _ => {
                let (i, count) = (i as f64, (points - 1) as f64);
                // Multiplied before it is divided: round steps give round values.
                if logarithmic { from * (to / from).powf(i / count) } else { from + (to - from) * i / count }
            }
        };
        Ok(Self { pointer: pointer.to_owned(), values: (0..points).map(at).collect(), logarithmic })
    }
}
