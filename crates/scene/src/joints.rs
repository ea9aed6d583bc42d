//! Contacts in several directions: which displacements their laws act on.

use hbm::Direction;

use crate::axes::{self, Axis};
use crate::dofs::{Dofs, GROUND};
use crate::error::SceneError;
use crate::read::{Node, Object};

/// The keys of an entry in `contacts` that belong to several directions.
pub(crate) const KEYS: [&str; 4] = ["nodes", "node_pairs", "axes", "directions"];
pub(crate) const DIRECTION_KEYS: [&str; 2] = ["tangential", "normal"];

const NODES: &str = "[\"2201\", \"2301\"], or a node and \"ground\"";
const PAIR: &str = "two dofs, or one and \"ground\": [\"w1\", \"ground\"]";

/// A pair of bodies: its name, and the relative displacements, the normal one last.
pub(crate) type Bodies = (String, Vec<Direction>);

/// The bodies of an entry called `name` whose law acts in several directions.
pub(crate) fn read(entry: &Object, name: &str, dofs: &Dofs) -> Result<Vec<Bodies>, SceneError> {
    let given: Vec<Node> =
        ["nodes", "node_pairs", "directions"].iter().filter_map(|key| entry.get(key)).collect();
    match given.as_slice() {
        [] => return Err(entry.error(format!(
            "has no bodies; write \"nodes\": {NODES}, with \"axes\": {{\"normal\": [0, 0, 1]}}; or \"directions\": \
             {{\"tangential\": [\"w1\", \"ground\"], \"normal\": [\"w2\", \"ground\"]}}"
        ))),
        [_] => {}
        [.., last] => return Err(last.error("is one too many; keep one of \"nodes\", \"node_pairs\", \"directions\"")),
    }
    if let Some(given) = entry.get("directions") {
        entry
            .without(&["axes"], "belongs to \"nodes\"; the dofs in \"directions\" say where the law acts")?;
        if given.is_list() {
            let numbered = |(i, node): (usize, &Node)| Ok((format!("{name}[{i}]"), directions(node, dofs)?));
            let bodies =
                given.some("of directions")?.iter().enumerate().map(numbered).collect::<Result<_, _>>()?;
            return alike(&given, bodies);
        }
        return Ok(vec![(name.to_owned(), directions(&given, dofs)?)]);
    }
    let pairs = match (entry.get("nodes"), entry.get("node_pairs")) {
        (Some(nodes), _) => vec![(name.to_owned(), Nodes::read(&nodes, dofs)?)],
        (None, Some(pairs)) => {
            let nodes = pairs.some("of pairs of nodes")?.into_iter().enumerate();
            let numbered = nodes.map(|(i, node)| Ok((format!("{name}[{i}]"), Nodes::read(&node, dofs)?)));
            numbered.collect::<Result<_, SceneError>>()?
        }
        (None, None) => Vec::new(),
    };
    between_nodes(
        &entry.need("axes", "{\"normal\": [0, 0, 1]}, from the first body to the second")?,
        pairs,
        dofs,
    )
}

/// The directions of pairs of nodes with one set of axes for all, or one each.
fn between_nodes(axes: &Node, pairs: Vec<(String, Nodes)>, dofs: &Dofs) -> Result<Vec<Bodies>, SceneError> {
    if !axes.is_list() {
        let Some((_, first)) = pairs.first() else { return Ok(Vec::new()) };
        let shared = axes::read(axes, &dofs.directions_of(first.first.0))?;
        return pairs
            .into_iter()
            .map(|(name, nodes)| Ok((name, nodes.directions(&shared, axes, dofs)?)))
            .collect();
    }
    let each = axes.list("of axes, one a pair of nodes")?;
    if each.len() != pairs.len() {
        let problem = format!(
            "must be one object for all, or a list with one for each of the {} pair(s) of nodes, got {}",
            pairs.len(),
            each.len()
        );
        return Err(axes.error(problem));
    }
    let own = |((name, nodes), node): ((String, Nodes), &Node)| {
        let read = axes::read(node, &dofs.directions_of(nodes.first.0))?;
        Ok((name, nodes.directions(&read, node, dofs)?))
    };
    alike(axes, pairs.into_iter().zip(&each).map(own).collect::<Result<_, SceneError>>()?)
}

/// All bodies of an entry share its law, so they have as many directions.
fn alike(node: &Node, bodies: Vec<Bodies>) -> Result<Vec<Bodies>, SceneError> {
    let count = |bodies: &Bodies| bodies.1.len();
    match bodies.iter().find(|other| bodies.first().is_some_and(|first| count(first) != count(other))) {
        None => Ok(bodies),
        Some((name, _)) => Err(node.error(format!(
            "all must have the same number of tangential directions, as they share a law, but {name} differs; write two \
             entries in contacts"
        ))),
    }
}

/// `{"tangential": …, "normal": …}` with pairs of dofs.
fn directions(node: &Node, dofs: &Dofs) -> Result<Vec<Direction>, SceneError> {
    let entry = node.object("tangential and normal: pairs of dofs", &DIRECTION_KEYS)?;
    let form = "[\"w1\", \"ground\"]";
    let tangential = entry.need("tangential", form)?;
    let items = tangential.list(PAIR)?;
    let mut nodes = match items.first() {
        Some(first) if first.is_list() => items,
        _ => vec![tangential.clone()],
    };
    if nodes.len() > 2 {
        return Err(
            tangential.error(format!("one or two tangential directions are possible, got {}", nodes.len()))
        );
    }
    nodes.push(entry.need("normal", form)?);
    let mut directions: Vec<Direction> = Vec::with_capacity(nodes.len());
    for node in &nodes {
        let (first, second) = pair(node, dofs)?;
        let parts = std::iter::once((first, 1.0)).chain(second.map(|dof| (dof, -1.0))).collect();
        let direction = Direction { parts };
        let same = |other: &Direction| {
            let key = |d: &Direction| {
                let mut dofs: Vec<usize> = d.parts.iter().map(|part| part.0).collect();
                dofs.sort_unstable();
                dofs
            };
            key(other) == key(&direction)
        };
        if directions.iter().any(same) {
            return Err(node.error("are the dofs of another direction of this contact; name others"));
        }
        directions.push(direction);
    }
    Ok(directions)
}

/// Two dofs, or one and the ground.
pub(crate) fn pair(node: &Node, dofs: &Dofs) -> Result<(usize, Option<usize>), SceneError> {
    let names = node.list(PAIR)?;
    let [first, second] = names.as_slice() else {
        return Err(node.error(format!("must be {PAIR}, got {} name(s)", names.len())));
    };
    if is_ground(first) {
        return Err(first
            .error("put the dof first: the law acts on the displacement of the first against the second"));
    }
    let a = dofs.index(first)?;
    if is_ground(second) {
        return Ok((a, None));
    }
    let b = dofs.index(second)?;
    if a == b {
        return Err(second.error("a dof has no contact with itself; name another one or \"ground\""));
    }
    Ok((a, Some(b)))
}

fn is_ground(node: &Node) -> bool {
    node.text("a name").is_ok_and(|name| name == GROUND)
}

/// A node and another one, or the ground; each with where it stands.
struct Nodes<'a> {
    first: (&'a str, Node<'a>),
    second: Option<(&'a str, Node<'a>)>,
}

impl<'a> Nodes<'a> {
    fn read(node: &Node<'a>, dofs: &Dofs) -> Result<Self, SceneError> {
        let form = format!("two nodes, or one and \"ground\": {NODES}");
        let names = node.list(&form)?;
        let [first, second] = names.as_slice() else {
            return Err(node.error(format!("must be {form}, got {} name(s)", names.len())));
        };
        if is_ground(first) {
            return Err(
                first.error("put the node first: the normal axis points from the first body to the second")
            );
        }
        let known = |node: &Node<'a>| {
            let name = node.text("the name of a node, \"2201\" for the dofs \"2201:x\", \"2201:y\", …")?;
            if !dofs.directions_of(name).is_empty() {
                return Ok((name, node.clone()));
            }
            Err(node.error(match dofs.directions().as_slice() {
                [] => "the names of the dofs have no nodes (\"2201:x\"); write \"directions\" with pairs of dofs".to_owned(),
                known => format!(
                    "there is no node {name:?} in model.dofs: no dof is called \"{name}:{}\"",
                    known.first().copied().unwrap_or_default()
                ),
            }))
        };
        let first = known(first)?;
        if is_ground(second) {
            return Ok(Self { first, second: None });
        }
        let second = known(second)?;
        if first.0 == second.0 {
            return Err(second.1.error("a node has no contact with itself; name another one or \"ground\""));
        }
        Ok(Self { first, second: Some(second) })
    }

    /// Displacement of the first against the second along each axis: Σ c_i (w_first,i − w_second,i). What is held does
    /// not move.
    fn directions(&self, axes: &[Axis], node: &Node, dofs: &Dofs) -> Result<Vec<Direction>, SceneError> {
        let mut directions = Vec::with_capacity(axes.len());
        for (i, axis) in axes.iter().enumerate() {
            let mut parts = Vec::new();
            for (sign, body) in [(1.0, Some(&self.first)), (-1.0, self.second.as_ref())] {
                let Some((name, place)) = body else { continue };
                for (direction, component) in &axis.0 {
                    let dof =
                        dofs.place(&format!("{name}:{direction}")).map_err(|problem| place.error(problem))?;
                    parts.extend(dof.map(|dof| (dof, sign * component)));
                }
            }
            if parts.is_empty() {
                let which = if i + 1 == axes.len() { "normal" } else { "tangential" };
                return Err(node.error(format!(
                    "the {which} direction at node {:?}: model.fixed holds every dof there, so the law has nothing to act on",
                    self.first.0
                )));
            }
            directions.push(Direction { parts });
        }
        Ok(directions)
    }
}
