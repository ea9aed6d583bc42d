//! A ring of three masses a sector: disk, blade and shroud; for many contacts at little cost.

use std::f64::consts::TAU;

use anyhow::{Result, ensure};

use super::plan::{Excited, Generated, Places};
use super::structure::{Lower, Structure};

/// Masses of disk, blade and shroud in kg.
const MASSES: [f64; 3] = [0.8, 0.09, 0.03];
/// Springs in N/m: disk to the hub, disk to the next disk, disk to blade, blade to shroud.
const HUB: f64 = 4.0e7;
const RIM: f64 = 1.5e7;
const BLADE: f64 = 1.2e5;
const NECK: f64 = 6.0e5;

/// A ring of `sectors` with contacts between the shrouds of neighbours; then between blades and the ground.
pub(super) fn generate(sectors: usize, engine_order: usize) -> Result<Generated> {
    ensure!(sectors >= 3, "--sectors: must be at least 3, got {sectors}");
    let n = 3 * sectors;
    let names = (1..=n).map(|node| format!("{node}:t")).collect();
    let mut structure = Structure { names, mass: Lower::default(), stiffness: Lower::default() };
    let next = |sector: usize| 3 * ((sector + 1) % sectors);
    let mut springs = Vec::new();
    for sector in 0..sectors {
        let disk = 3 * sector;
        springs.push((disk, None, HUB));
        springs.push((disk, Some(next(sector)), RIM));
        springs.push((disk, Some(disk + 1), BLADE));
        springs.push((disk + 1, Some(disk + 2), NECK));
    }
    let mut diagonal = vec![0.0; n];
    let mut below = vec![Vec::new(); n];
    for (a, b, stiffness) in springs {
        diagonal[a] += stiffness;
        if let Some(b) = b {
            diagonal[b] += stiffness;
            below[a.min(b)].push((a.max(b), -stiffness));
        }
    }
    for (column, (diagonal, below)) in diagonal.iter().zip(&mut below).enumerate() {
        structure.mass.push(column, column, MASSES[column % 3]);
        structure.stiffness.push(column, column, *diagonal);
        below.sort_by_key(|(row, _)| *row);
        below.iter().for_each(|(row, value)| structure.stiffness.push(*row, column, *value));
    }
    let places = Places {
        first: (0..sectors).map(|sector| (3 * sector + 2, Some(next(sector) + 2))).collect(),
        second: (0..sectors).map(|sector| (3 * sector + 1, None)).collect(),
        bodies: sectors,
    };
    let phase = |sector: usize| -TAU * (engine_order * sector % sectors) as f64 / sectors as f64;
    let excited = (0..sectors).map(|sector| Excited { dof: 3 * sector + 1, phase: phase(sector) }).collect();
    Ok(Generated { structure, places, sites: Vec::new(), excited })
}
