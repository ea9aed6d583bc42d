//! `axes`: the directions of a contact between nodes, as unit vectors at a right angle to each other.

use crate::error::SceneError;
use crate::read::{Node, show};

pub(crate) const KEYS: [&str; 2] = ["tangential", "normal"];

/// What three numbers of an axis stand for: directions in the names of dofs (`2201:x`).
const FRAMES: [[&str; 3]; 3] = [["x", "y", "z"], ["ux", "uy", "uz"], ["1", "2", "3"]];

/// Cosine of the angle between two axes up to which they count as orthogonal.
const SQUARE: f64 = 1e-6;

/// A unit vector: its components, by the direction in the names of dofs. None of them is zero.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis(pub(crate) Vec<(String, f64)>);

/// Reads `axes` of nodes whose dofs have the directions `known`: one or two tangential axes, then the normal one.
pub(crate) fn read(node: &Node, known: &[&str]) -> Result<Vec<Axis>, SceneError> {
    let entry = node.object("normal and, where it is not to be completed, tangential", &KEYS)?;
    let form = "[0, 0, 1], from the first body to the second";
    let normal_node = entry.need("normal", form)?;
    let normal = Axis::read(&normal_node, known)?;
    let Some(tangential_node) = entry.get("tangential") else {
        let mut axes = normal.completed(known).map_err(|problem| normal_node.error(problem))?;
        axes.push(normal);
        return Ok(axes);
    };
    let several = tangential_node.is_list()
        && tangential_node.list("of axes")?.first().is_none_or(|item| !item.is_number());
    let given = if several { tangential_node.some("of axes")? } else { vec![tangential_node.clone()] };
    if given.len() > 2 {
        return Err(
            tangential_node.error(format!("one or two tangential axes are possible, got {}", given.len()))
        );
    }
    let mut axes: Vec<Axis> = Vec::with_capacity(3);
    for item in &given {
        let axis = Axis::read(item, known)?;
        axis.square_to(&normal, "the normal axis").map_err(|problem| item.error(problem))?;
        if let Some(first) = axes.first() {
            axis.square_to(first, "the first tangential one").map_err(|problem| item.error(problem))?;
        }
        axes.push(axis);
    }
    axes.push(normal);
    Ok(axes)
}

impl Axis {
    /// `[0, 0, 1]` or `{"z": 1}`.
    fn read(node: &Node, known: &[&str]) -> Result<Self, SceneError> {
        let form = "three numbers (x, y, z), or numbers by direction: {\"z\": 1}";
        let parts = if node.is_object() {
            let entry = node.any_object("numbers by direction")?;
            let component = |(name, number): (&str, Node)| {
                if !known.contains(&name) {
                    let why = format!("is no direction of these nodes; they have {}", known.join(", "));
                    return Err(number.error(why));
                }
                Ok((name.to_owned(), number.number()?))
            };
            entry.members().map(component).collect::<Result<Vec<_>, _>>()?
        } else if node.is_list() {
            let numbers = node.numbers(form)?;
            let &[a, b, c] = numbers.as_slice() else {
                return Err(node.error(format!("must be {form}, got {} number(s)", numbers.len())));
            };
            let Some(frame) = frame(known) else {
                let example = known.last().copied().unwrap_or("z");
                return Err(node.error(format!(
                    "the dofs of these nodes have the directions {}, not x, y, z; write numbers by direction: \
                     {{\"{example}\": 1}}",
                    known.join(", ")
                )));
            };
            let parts = frame.iter().map(|name| (*name).to_owned()).zip([a, b, c]);
            let missing = parts.clone().find(|(name, part)| *part != 0.0 && !known.contains(&name.as_str()));
            if let Some((name, _)) = missing {
                let why =
                    format!("these nodes have no dof in the direction {name}, only {}", known.join(", "));
                return Err(node.error(why));
            }
            parts.collect()
        } else {
            return Err(node.must_be(form));
        };
        let scale = parts.iter().fold(0.0_f64, |most, (_, part)| most.max(part.abs()));
        if scale == 0.0 {
            return Err(node.error("must not be zero"));
        }
        let length = parts.iter().map(|(_, part)| (part / scale).powi(2)).sum::<f64>().sqrt();
        let unit = parts.into_iter().map(|(name, part)| (name, part / scale / length));
        Ok(Self(unit.filter(|(_, part)| *part != 0.0).collect()))
    }

    fn component(&self, name: &str) -> f64 {
        self.0.iter().find(|(own, _)| own == name).map_or(0.0, |(_, part)| *part)
    }

    fn square_to(&self, other: &Self, what: &str) -> Result<(), String> {
        let cosine: f64 = self.0.iter().map(|(name, part)| part * other.component(name)).sum();
        if cosine.abs() <= SQUARE {
            return Ok(());
        }
        let angle = show((100.0 * cosine.clamp(-1.0, 1.0).acos().to_degrees()).round() / 100.0);
        let way_out = match what {
            "the normal axis" => "leave \"tangential\" out and it is completed, or turn it",
            _ => "turn it, or leave \"tangential\" out and both are completed",
        };
        Err(format!("must be at a right angle to {what}, but the angle is {angle}°; {way_out}"))
    }

    /// The axes at right angles to this one in the space of the nodes' directions: two in three, one in two.
    fn completed(&self, known: &[&str]) -> Result<Vec<Self>, String> {
        let space: Vec<&str> = match frame(known) {
            Some(frame) => frame.into_iter().filter(|name| known.contains(name)).collect(),
            None => known.to_vec(),
        };
        let outside = self.0.iter().any(|(name, _)| !space.contains(&name.as_str()));
        let axis = |parts: &[f64]| {
            let named = space.iter().map(|name| (*name).to_owned()).zip(parts.iter().copied());
            Self(named.filter(|(_, part)| *part != 0.0).collect())
        };
        let own: Vec<f64> = space.iter().map(|name| self.component(name)).collect();
        match *own.as_slice() {
            _ if outside => {}
            [a, b] => return Ok(vec![axis(&[b, -a])]),
            [a, b, c] => {
                // Away from the direction that the normal leans on least: no cancellation.
                let least = a.abs().min(b.abs()).min(c.abs());
                let mut first = [0.0; 3];
                let chosen = own.iter().position(|part| part.abs() == least).unwrap_or(0);
                let part = own.get(chosen).copied().unwrap_or(0.0);
                for (i, (value, normal)) in first.iter_mut().zip(&own).enumerate() {
                    *value = f64::from(u8::from(i == chosen)) - part * normal;
                }
                let length = first.iter().map(|v| v * v).sum::<f64>().sqrt();
                let [x, y, z] = first.map(|value| value / length);
                let second = [b * z - c * y, c * x - a * z, a * y - b * x];
                return Ok(vec![axis(&[x, y, z]), axis(&second)]);
            }
            _ => {}
        }
        Err(format!(
            "cannot be completed in the directions {} of these nodes; write \"tangential\" as well",
            known.join(", ")
        ))
    }
}

/// The x, y, z that the directions `known` are called by.
fn frame(known: &[&str]) -> Option<[&'static str; 3]> {
    FRAMES.into_iter().find(|frame| {
        let count = frame.iter().filter(|name| known.contains(name)).count();
        count >= 2 || (count == 1 && known.len() == 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::parse;

    fn axes(text: &str, known: &[&str]) -> Result<Vec<Vec<f64>>, String> {
        let json = parse(text).unwrap();
        let read = read(&Node::root(&json), known).map_err(|error| error.to_string())?;
        Ok(read.iter().map(|axis| known.iter().map(|name| axis.component(name)).collect()).collect())
    }

    const XYZ: [&str; 3] = ["x", "y", "z"];

    #[test]
    fn axes_along_directions_stay_exact() {
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec::from);
        assert_eq!(axes(r#"{"normal": [0, 0, 2]}"#, &XYZ).unwrap(), unit);
        assert_eq!(
            axes(r#"{"normal": {"z": 1}, "tangential": [3, 0, 0]}"#, &XYZ).unwrap(),
            [unit[0].clone(), unit[2].clone()]
        );
        assert_eq!(axes(r#"{"normal": {"t": -1}}"#, &["x", "r", "t"]).unwrap()[2], [0.0, 0.0, -1.0]);
        assert_eq!(axes(r#"{"normal": [0, 1, 0]}"#, &["x", "y"]).unwrap(), [[1.0, 0.0], [0.0, 1.0]]);
        // Rotations of a node are no directions in space.
        let shell = ["x", "y", "z", "rx", "ry", "rz"];
        assert_eq!(axes(r#"{"normal": [0, 0, 1]}"#, &shell).unwrap().len(), 3);
    }

    #[test]
    fn completed_axes_are_orthonormal() {
        for normal in ["[1, 2, 3]", "[1, 1, 1]", "[-1, 1e-9, 0]", "[1e300, 1e300, 0]", "[0.1, -7, 1e-200]"] {
            let axes = axes(&format!("{{\"normal\": {normal}}}"), &XYZ).unwrap();
            for (i, a) in axes.iter().enumerate() {
                for (j, b) in axes.iter().enumerate() {
                    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                    assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-15, "{normal}: {axes:?}");
                }
            }
        }
    }

    #[test]
    fn wrong_axes_say_what_to_do() {
        let error = |text: &str, known: &[&str]| axes(text, known).unwrap_err();
        for (text, known, message) in [
            (r#"{}"#, &XYZ[..], "normal: is missing"),
            (r#"{"normal": [0, 0, 0]}"#, &XYZ, "normal: must not be zero"),
            (r#"{"normal": [0, 1]}"#, &XYZ, "normal: must be three numbers (x, y, z)"),
            (r#"{"normal": "z"}"#, &XYZ, "normal: must be three numbers (x, y, z)"),
            (r#"{"normal": [0, 0, 1]}"#, &["x", "r", "t"], "write numbers by direction: {\"t\": 1}"),
            (r#"{"normal": {"q": 1}}"#, &XYZ, "normal.q: is no direction of these nodes; they have x, y, z"),
            (r#"{"normal": [0, 0, 1]}"#, &["x", "y"], "no dof in the direction z, only x, y"),
            (r#"{"normal": {"a": 1}}"#, &["a", "b", "c", "d"], "write \"tangential\" as well"),
            (r#"{"normal": {"x": 1}}"#, &["x"], "write \"tangential\" as well"),
            (r#"{"normal": [0, 0, 1], "tangential": []}"#, &XYZ, "tangential: must not be empty"),
            (
                r#"{"normal": [0, 0, 1], "tangential": [1, 0, 1]}"#,
                &XYZ,
                "tangential: must be at a right angle to the normal axis, but the angle is 45°; leave",
            ),
            (
                r#"{"normal": [0, 0, 1], "tangential": [[1, 0, 0], [1, 1, 0]]}"#,
                &XYZ,
                "tangential[1]: must be at a right angle to the first tangential one, but the angle is 45°",
            ),
            (
                r#"{"normal": [0, 0, 1], "tangential": [[1, 0, 0], [0, 1, 0], [1, 1, 0]]}"#,
                &XYZ,
                "one or two tangential axes are possible, got 3",
            ),
            (r#"{"normal": [0, 0, 1], "axis": 1}"#, &XYZ, "axis: unknown key"),
        ] {
            let error = error(text, known);
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
