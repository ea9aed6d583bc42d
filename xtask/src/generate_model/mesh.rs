//! A mesh of bricks, and its assembly to mass and stiffness.

use anyhow::{Context, Result};

use super::hexahedron::{Block, NODES, element};
use super::material::Material;
use super::structure::{Lower, Structure};

/// In which directions a node's displacement is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Directions {
    /// x, y, z.
    Cartesian,
    /// Axial x, radial r, tangential t about the x axis, at each node its own.
    Cylindrical,
}

/// Nodes and bricks; clamped nodes have no dofs.
#[derive(Debug, Clone)]
pub(super) struct Mesh {
    /// x, y, z in m.
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) elements: Vec<[usize; NODES]>,
    pub(super) clamped: Vec<bool>,
    pub(super) directions: Directions,
}

impl Directions {
    pub(super) fn names(self) -> [&'static str; 3] {
        match self {
            Self::Cartesian => ["x", "y", "z"],
            Self::Cylindrical => ["x", "r", "t"],
        }
    }

    /// Rows are the unit vectors at a node; the tangential one turns y towards −z, from r = z.
    pub(super) fn frame(self, node: &[f64; 3]) -> Block {
        match self {
            Self::Cartesian => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Self::Cylindrical => {
                let radius = node[1].hypot(node[2]);
                let (sine, cosine) = (node[1] / radius, node[2] / radius);
                [[1.0, 0.0, 0.0], [0.0, sine, cosine], [0.0, cosine, -sine]]
            }
        }
    }
}

impl Mesh {
    /// Mass and stiffness of the free dofs, three a node in the order of the nodes, called `node:direction` with nodes
    /// counted from one, and where each node's first dof is.
    pub(super) fn assemble(&self, material: &Material) -> Result<(Structure, Vec<Option<usize>>)> {
        let mut first = Vec::with_capacity(self.nodes.len());
        let mut names = Vec::new();
        for (node, clamped) in self.clamped.iter().enumerate() {
            first.push((!clamped).then_some(names.len()));
            if !clamped {
                names.extend(self.directions.names().map(|direction| format!("{}:{direction}", node + 1)));
            }
        }
        let frames: Vec<Block> = self.nodes.iter().map(|node| self.directions.frame(node)).collect();
        let mut coupled = vec![Vec::new(); self.nodes.len()];
        for (number, corners) in self.elements.iter().enumerate() {
            let nodes = corners.map(|node| self.nodes[node]);
            let element = element(&nodes, material).with_context(|| format!("element {}", number + 1))?;
            for (a, &column) in corners.iter().enumerate() {
                for (b, &row) in corners.iter().enumerate() {
                    if row < column || self.clamped[row] || self.clamped[column] {
                        continue;
                    }
                    let pair = at(&mut coupled[column], row);
                    for i in 0..3 {
                        for j in 0..3 {
                            pair.stiffness[i][j] += element.stiffness[b][a][i][j];
                        }
                    }
                    pair.mass += element.mass[b][a];
                }
            }
        }
        let mut structure = Structure { names, mass: Lower::default(), stiffness: Lower::default() };
        for (column, pairs) in coupled.iter_mut().enumerate() {
            pairs.sort_by_key(|pair| pair.row);
            let blocks: Vec<(usize, Block, Block)> =
                pairs.iter().map(|pair| pair.turned(&frames[pair.row], &frames[column])).collect();
            let Some(start) = first[column] else { continue };
            for j in 0..3 {
                for (row, stiffness, mass) in &blocks {
                    let Some(below) = first[*row] else { continue };
                    for i in 0..3 {
                        structure.stiffness.push(below + i, start + j, stiffness[i][j]);
                        structure.mass.push(below + i, start + j, mass[i][j]);
                    }
                }
            }
        }
        Ok((structure, first))
    }
}

/// What couples a node with another one of no smaller number.
#[derive(Debug, Clone)]
struct Coupled {
    row: usize,
    stiffness: Block,
    mass: f64,
}

impl Coupled {
    /// Row, stiffness and mass in the nodes' own directions: R K Sᵀ and m R Sᵀ.
    fn turned(&self, row: &Block, column: &Block) -> (usize, Block, Block) {
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let force = |unit: &[f64; 3]| self.stiffness.map(|line| dot(&line, unit));
        let entry = |row: &[f64; 3], unit: &[f64; 3]| dot(row, &force(unit));
        let stiffness = row.map(|row| column.map(|unit| entry(&row, &unit)));
        let mass = row.map(|row| column.map(|unit| self.mass * dot(&row, &unit)));
        (self.row, stiffness, mass)
    }
}

/// The entry of `row`; a node has at most 27 of them.
fn at(pairs: &mut Vec<Coupled>, row: usize) -> &mut Coupled {
    let index = pairs.iter().position(|pair| pair.row == row).unwrap_or_else(|| {
        pairs.push(Coupled { row, stiffness: [[0.0; 3]; 3], mass: 0.0 });
        pairs.len() - 1
    });
    &mut pairs[index]
}
