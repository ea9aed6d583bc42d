//! A blade: its sections along the span, and a mesh of it alone, clamped at the root.

use anyhow::{Result, ensure};

use super::material::STEEL;
use super::mesh::{Directions, Mesh};
use super::plan::{Excited, Generated, Places};

/// Sizes of a blade; x along the chord, y across, z along the span.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blade {
    /// Span, chord and largest thickness at the root in m.
    pub(super) length: f64,
    pub(super) chord: f64,
    pub(super) thickness: f64,
    /// Chord and thickness of the tip over those of the root.
    pub(super) taper: f64,
    /// Angle of the tip's section against the root's in radians.
    pub(super) twist: f64,
    /// Thickness of the edges over that of the middle of the chord.
    pub(super) edge: f64,
}

/// Elements along the chord, across the thickness, along the span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cells {
    pub(super) chord: usize,
    pub(super) thickness: usize,
    pub(super) span: usize,
}

impl Blade {
    /// x and y at the height `s` of the span, `xi` of the chord and `eta` of the thickness, both from −1 to 1.
    pub(super) fn point(&self, s: f64, xi: f64, eta: f64) -> [f64; 2] {
        let taper = 1.0 + (self.taper - 1.0) * s;
        let along = 0.5 * xi * taper * self.chord;
        let across = 0.5 * eta * taper * self.thickness * (1.0 - (1.0 - self.edge) * xi * xi);
        let (sine, cosine) = (self.twist * s).sin_cos();
        [along * cosine - across * sine, along * sine + across * cosine]
    }

    /// The blade with its root removed from the dofs.
    pub(super) fn mesh(&self, cells: &Cells) -> Mesh {
        let (across, layer) = (cells.chord + 1, (cells.chord + 1) * (cells.thickness + 1));
        let at = |i: usize, j: usize, k: usize| k * layer + j * across + i;
        let mut mesh = Mesh {
            nodes: Vec::new(),
            elements: Vec::new(),
            clamped: Vec::new(),
            directions: Directions::Cartesian,
        };
        for k in 0..=cells.span {
            let s = k as f64 / cells.span as f64;
            for j in 0..=cells.thickness {
                for i in 0..=cells.chord {
                    let [x, y] = self.point(s, centred(i, cells.chord), centred(j, cells.thickness));
                    mesh.nodes.push([x, y, s * self.length]);
                    mesh.clamped.push(k == 0);
                }
            }
        }
        for k in 0..cells.span {
            for j in 0..cells.thickness {
                for i in 0..cells.chord {
                    mesh.elements.push(brick(|a, b, c| at(i + a, j + b, k + c)));
                }
            }
        }
        mesh
    }

    /// The blade with contacts between its tip and the ground (x and y), excited at a corner of the tip in y.
    pub(super) fn generate(&self, cells: &Cells) -> Result<Generated> {
        ensure!(cells.chord * cells.thickness * cells.span > 0, "--elements: all three must be positive");
        let (structure, first) = self.mesh(cells).assemble(&STEEL)?;
        let tip = first.len() - (cells.chord + 1) * (cells.thickness + 1);
        let tip: Vec<usize> = first.iter().skip(tip).flatten().copied().collect();
        let towards = |direction: usize| tip.iter().map(|dof| (dof + direction, None)).collect();
        let dof = tip.first().map_or(0, |dof| dof + 1);
        Ok(Generated {
            structure,
            places: Places { first: towards(1), second: towards(0), bodies: 1 },
            sites: Vec::new(),
            excited: vec![Excited { dof, phase: 0.0 }],
        })
    }
}

impl Cells {
    /// A mesh with about as many dofs.
    pub(super) fn of_dofs(dofs: usize) -> Self {
        let scale = (dofs as f64 / 10_000.0).cbrt();
        let chord = ((12.0 * scale).round() as usize).max(3);
        let thickness = ((3.0 * scale).round() as usize).max(1);
        let layer = 3 * (chord + 1) * (thickness + 1);
        Self { chord, thickness, span: ((dofs as f64 / layer as f64).round() as usize).max(2) }
    }
}

/// −1 … 1 for the nodes 0 … `cells` of a line.
pub(super) fn centred(node: usize, cells: usize) -> f64 {
    2.0 * node as f64 / cells as f64 - 1.0
}

/// The corners of a brick in the order of the element, from the node at (a, b, c) of its own grid.
pub(super) fn brick(at: impl Fn(usize, usize, usize) -> usize) -> [usize; 8] {
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        .map(|(a, b, c)| at(a, b, c))
}
