//! A structure with the places where it is touched and excited.

use anyhow::{Result, ensure};
use faer::Mat;

use super::structure::Structure;

/// Two dofs that rub, or one and the ground.
pub(super) type Pair = (usize, Option<usize>);

/// What a kind of structure offers.
#[derive(Debug, Clone)]
pub(super) struct Generated {
    pub(super) structure: Structure,
    pub(super) places: Places,
    /// Where nodes can rub in three directions; none where --joints is not for this kind.
    pub(super) sites: Vec<Site>,
    pub(super) excited: Vec<Excited>,
}

/// Two nodes that rub, or one and the ground, by the first of their three dofs, whose directions are x, r, t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Site {
    pub(super) first: usize,
    pub(super) second: Option<usize>,
    /// Component along t of the normal axis, from the first body to the second: 1 or −1.
    pub(super) normal: f64,
}

impl Site {
    /// What its springs couple while it sticks.
    pub(super) fn pairs(&self) -> impl Iterator<Item = Pair> + use<> {
        let Self { first, second, .. } = *self;
        (0..3).map(move |direction| (first + direction, second.map(|second| second + direction)))
    }
}

/// A force of the common amplitude.
#[derive(Debug, Clone, Copy)]
pub(super) struct Excited {
    pub(super) dof: usize,
    /// In radians.
    pub(super) phase: f64,
}

/// Where contacts can be: `first` is used up before `second`.
#[derive(Debug, Clone)]
pub(super) struct Places {
    pub(super) first: Vec<Pair>,
    pub(super) second: Vec<Pair>,
    /// Blades that share the contacts.
    pub(super) bodies: usize,
}

impl Generated {
    /// The forces of unit amplitude at the instant zero, one column.
    pub(super) fn forces(&self) -> Mat<f64> {
        let mut forces = Mat::zeros(self.structure.dofs(), 1);
        for excited in &self.excited {
            forces[(excited.dof, 0)] += excited.phase.cos();
        }
        forces
    }
}

/// `count` of the sites, spread evenly.
pub(super) fn choose_sites(sites: &[Site], count: usize) -> Result<Vec<Site>> {
    ensure!(!sites.is_empty(), "--joints: is for a sector or a ring, whose shrouds touch");
    ensure!(
        (1..=sites.len()).contains(&count),
        "--contacts: with --joints there is room for 1 to {}, asked for {count}; more --dofs or --sectors make more",
        sites.len()
    );
    Ok(spread(sites, count))
}

impl Places {
    /// `count` contacts, spread evenly.
    pub(super) fn choose(&self, count: usize) -> Result<Vec<Pair>> {
        let most = self.first.len() + self.second.len();
        ensure!(
            count <= most,
            "--contacts: there is room for {most}, asked for {count}; more --dofs or --sectors make more"
        );
        let beyond = count.saturating_sub(self.first.len());
        let mut chosen = spread(&self.first, count - beyond);
        chosen.extend(spread(&self.second, beyond));
        Ok(chosen)
    }
}

/// `count` of the places, at even distances.
fn spread<T: Copy>(places: &[T], count: usize) -> Vec<T> {
    (0..count)
        .filter_map(|chosen| places.get((2 * chosen + 1) * places.len() / (2 * count)))
        .copied()
        .collect()
}
