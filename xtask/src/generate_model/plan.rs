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
    pub(super) excited: Vec<Excited>,
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

/// `count` of the pairs, at even distances.
fn spread(pairs: &[Pair], count: usize) -> Vec<Pair> {
    (0..count).filter_map(|chosen| pairs.get((2 * chosen + 1) * pairs.len() / (2 * count))).copied().collect()
}
