//! Sectors of a bladed disk with tip shrouds: one alone, or a closed ring of them.
//!
//! A sector is one grid, i along the axis, j around, k outwards, whose middle columns carry the blade. Bricks stand in the
//! disk and in the shroud over all j, in the blade between them over the middle columns only. Its sides lie in the planes
//! ±π/n, so that neighbours share the nodes of the disk and face each other at the shrouds.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use anyhow::{Result, ensure};

use super::blade::{Blade, brick, centred};
use super::material::STEEL;
use super::mesh::{Directions, Mesh};
use super::plan::{Excited, Generated, Places, Site};

/// Arc between neighbouring blades at their roots in m.
const PITCH: f64 = 0.045;
/// Depth of the disk's rim below the blades in m, and its largest share of the radius there.
const RIM: (f64, f64) = (0.06, 0.6);
/// Radial thickness of the shroud in m.
const SHROUD: f64 = 0.006;

/// Elements of a sector.
#[derive(Debug, Clone, Copy)]
struct Cells {
    chord: usize,
    thickness: usize,
    /// On either side of the blade, around.
    side: usize,
    disk: usize,
    blade: usize,
    shroud: usize,
}

/// One sector of `count`, or all of them as a ring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sectors {
    pub(super) blade: Blade,
    /// Sectors of the whole circle.
    pub(super) count: usize,
    /// All of them, or one.
    pub(super) ring: bool,
    /// Nodal diameters of the travelling excitation of a ring.
    pub(super) engine_order: usize,
}

/// A mesh and where the places of its sectors are.
struct Built {
    mesh: Mesh,
    cells: Cells,
    /// Node at (sector, i, j, k).
    at: HashMap<[usize; 4], usize>,
}

impl Sectors {
    /// Contacts between the shrouds of neighbours (of a sector alone: between its shroud and the ground), axial and
    /// radial; a force around in the middle of each blade, with the phase of the engine order.
    pub(super) fn generate(&self, dofs: usize) -> Result<Generated> {
        let built = self.mesh(dofs)?;
        let (structure, first) = built.mesh.assemble(&STEEL)?;
        let cells = &built.cells;
        let around = cells.around();
        let dof = |place: [usize; 4], direction: usize| {
            built.at.get(&place).and_then(|&node| first[node]).map(|dof| dof + direction)
        };
        let mut places = Places { first: Vec::new(), second: Vec::new(), bodies: self.built() };
        let (mut sites, mut opposite) = (Vec::new(), Vec::new());
        for sector in 0..self.built() {
            for k in cells.disk + cells.blade..=cells.layers() {
                for i in 0..=cells.chord {
                    let right = |direction| dof([sector, i, around, k], direction);
                    let left = |direction| dof([(sector + 1) % self.built(), i, 0, k], direction);
                    if let (Some(right), Some(left)) = (right(0), left(0)) {
                        let second = self.ring.then_some(left);
                        sites.push(Site { first: right, second, normal: 1.0 });
                        if !self.ring {
                            opposite.push(Site { first: left, second: None, normal: -1.0 });
                        }
                    }
                    for (list, direction) in [(&mut places.first, 0), (&mut places.second, 1)] {
                        let (Some(right), Some(left)) = (right(direction), left(direction)) else { continue };
                        if self.ring {
                            list.push((right, Some(left)));
                        } else {
                            list.extend([(right, None), (left, None)]);
                        }
                    }
                }
            }
        }
        let middle = [cells.chord / 2, cells.side, cells.disk + cells.blade / 2];
        let excited = (0..self.built()).filter_map(|sector| {
            let turned = (self.engine_order * sector % self.count) as f64 / self.count as f64;
            let [i, j, k] = middle;
            Some(Excited { dof: dof([sector, i, j, k], 2)?, phase: -TAU * turned })
        });
        let excited = excited.collect();
        // First one side, then the other: an even number of contacts has as many on either.
        sites.append(&mut opposite);
        Ok(Generated { structure, places, sites, excited })
    }

    /// How many sectors there are in the mesh.
    fn built(&self) -> usize {
        if self.ring { self.count } else { 1 }
    }

    /// The mesh alone.
    #[cfg(test)]
    pub(super) fn bare_mesh(&self, dofs: usize) -> Result<Mesh> {
        Ok(self.mesh(dofs)?.mesh)
    }

    fn mesh(&self, dofs: usize) -> Result<Built> {
        ensure!(self.count >= 6, "--sectors: must be at least 6, got {}", self.count);
        let cells = Cells::of_dofs(dofs / self.built());
        let mut built = Built {
            mesh: Mesh {
                nodes: Vec::new(),
                elements: Vec::new(),
                clamped: Vec::new(),
                directions: Directions::Cylindrical,
            },
            cells,
            at: HashMap::new(),
        };
        for sector in 0..self.built() {
            for k in 0..=cells.layers() {
                for j in 0..=cells.around() {
                    for i in 0..=cells.chord {
                        if cells.node(j, k) {
                            self.add(&mut built, [sector, i, j, k]);
                        }
                    }
                }
            }
        }
        for sector in 0..self.built() {
            for k in 0..cells.layers() {
                for j in (0..cells.around()).filter(|&j| cells.brick(j, k)) {
                    for i in 0..cells.chord {
                        let corners = brick(|a, b, c| built.at[&[sector, i + a, j + b, k + c]]);
                        built.mesh.elements.push(corners);
                    }
                }
            }
        }
        Ok(built)
    }

    /// Adds a node, or finds the neighbour's where the disk is whole.
    fn add(&self, built: &mut Built, place: [usize; 4]) {
        let [sector, i, j, k] = place;
        let cells = &built.cells;
        let shared = self.ring && k <= cells.disk;
        let known = match j {
            0 if shared && sector > 0 => built.at.get(&[sector - 1, i, cells.around(), k]),
            _ if shared && j == cells.around() && sector + 1 == self.count => built.at.get(&[0, i, 0, k]),
            _ => None,
        };
        let node = known.copied().unwrap_or(built.mesh.nodes.len());
        if node == built.mesh.nodes.len() {
            let [x, y, z] = self.position(cells, [i, j, k]);
            let (sine, cosine) = (TAU * sector as f64 / self.count as f64).sin_cos();
            built.mesh.nodes.push([x, y * cosine + z * sine, z * cosine - y * sine]);
            built.mesh.clamped.push(k == 0);
        }
        built.at.insert(place, node);
    }

    /// Where a node of the first sector is: z outwards through the blade, y around.
    fn position(&self, cells: &Cells, [i, j, k]: [usize; 3]) -> [f64; 3] {
        let blade = &self.blade;
        let root = PITCH * self.count as f64 / TAU;
        let part = |from: usize, cells: usize| (k.max(from) - from).min(cells) as f64 / cells as f64;
        let depth = RIM.0.min(RIM.1 * root);
        let s = part(cells.disk, cells.blade);
        let z = root - depth * (1.0 - part(0, cells.disk))
            + blade.length * s
            + SHROUD * part(cells.disk + cells.blade, cells.shroud);
        let xi = centred(i, cells.chord);
        let eta = centred(j.max(cells.side) - cells.side, cells.thickness).min(1.0);
        let [x, y] = blade.point(s, xi, eta);
        // Straight lines from the blade's faces to the planes between sectors.
        let right = j.max(cells.side + cells.thickness) - cells.side - cells.thickness;
        let left = cells.side - j.min(cells.side);
        let share = left.max(right) as f64 / cells.side as f64;
        let taper = 1.0 + (blade.taper - 1.0) * s;
        let plane = z * (PI / self.count as f64).tan() * if left > 0 { -1.0 } else { 1.0 };
        [x + share * (0.5 * xi * taper * blade.chord - x), y + share * (plane - y), z]
    }
}

impl Cells {
    /// A mesh with about as many dofs.
    fn of_dofs(dofs: usize) -> Self {
        let scale = (dofs as f64 / 1000.0).cbrt();
        let at_least = |least: usize, cells: f64| ((cells * scale).round() as usize).max(least);
        let mut cells = Self {
            chord: at_least(2, 4.0),
            thickness: at_least(1, 1.0),
            side: at_least(1, 2.0),
            disk: at_least(1, 3.0),
            blade: 4,
            shroud: at_least(1, 1.0),
        };
        let wide = (cells.chord + 1) * (cells.around() + 1) * (cells.disk + cells.shroud + 1);
        let narrow = (cells.chord + 1) * (cells.thickness + 1);
        let left = (dofs / 3).saturating_sub(wide);
        cells.blade = (left / narrow + 1).max(cells.blade);
        cells
    }

    fn around(&self) -> usize {
        2 * self.side + self.thickness
    }

    fn layers(&self) -> usize {
        self.disk + self.blade + self.shroud
    }

    /// Whether there is a brick outwards and around from (j, k).
    fn brick(&self, j: usize, k: usize) -> bool {
        let blade = (self.disk..self.disk + self.blade).contains(&k);
        !blade || (self.side..self.side + self.thickness).contains(&j)
    }

    /// Whether there is a node at (j, k).
    fn node(&self, j: usize, k: usize) -> bool {
        let blade = (self.disk + 1..self.disk + self.blade).contains(&k);
        !blade || (self.side..=self.side + self.thickness).contains(&j)
    }
}
