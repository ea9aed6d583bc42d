//! `model.reduction`: whether a structure is solved as it is or reduced, and with how many modes.

use std::sync::{Arc, PoisonError};

use structure::{ModeCount, Progress, Reduction, ReductionOptions};

use crate::error::SceneError;
use crate::model::refused;
use crate::read::{Node, show};
use crate::sparse::Sparse;

pub(crate) const KEYS: [&str; 2] = ["modes", "tolerance"];

/// Up to this many dofs a structure is solved as it is.
pub(crate) const SMALL: usize = 300;

/// Error of the response that a reduction aims at when a scene does not say.
const TOLERANCE: f64 = 1e-6;

/// More modes than this are a slip of the pen.
const MOST_MODES: usize = 100_000;

/// What a scene says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Wish {
    /// As it is when small, else reduced.
    Auto,
    /// As it is.
    Full,
    /// So many modes.
    Modes(usize),
    /// As many modes as this relative error of the response needs.
    Tolerance(f64),
}

impl Wish {
    pub(crate) fn read(node: Option<Node>) -> Result<Self, SceneError> {
        let Some(node) = node else { return Ok(Self::Auto) };
        if !node.is_object() {
            let form = "\"auto\", \"none\", {\"modes\": 40} or {\"tolerance\": 1e-6}";
            let word = node.text(form)?;
            return match word {
                "auto" => Ok(Self::Auto),
                "none" => Ok(Self::Full),
                _ => Err(node.must_be(form)),
            };
        }
        let entry = node.object("modes or tolerance", &KEYS)?;
        match (entry.get("modes"), entry.get("tolerance")) {
            (Some(modes), None) => modes.whole(0, MOST_MODES).map(Self::Modes),
            (None, Some(node)) => {
                let tolerance = node.positive()?;
                if tolerance >= 1.0 {
                    let problem = format!("is a relative error and must be below 1, got {}", show(tolerance));
                    return Err(node.error(problem));
                }
                Ok(Self::Tolerance(tolerance))
            }
            _ => Err(entry.error("write one of {\"modes\": 40} and {\"tolerance\": 1e-6}")),
        }
    }

    /// Whether a reduction is asked for, whatever the size.
    pub(crate) fn is_reduced(self) -> bool {
        matches!(self, Self::Modes(_) | Self::Tolerance(_))
    }

    /// How many modes a structure of `n` dofs gets; `None` is solved as it is.
    fn modes(self, n: usize) -> Option<ModeCount> {
        match self {
            Self::Auto if n <= SMALL => None,
            Self::Auto => Some(ModeCount::Automatic { tolerance: TOLERANCE }),
            Self::Full => None,
            Self::Modes(count) => Some(ModeCount::Exactly(count)),
            Self::Tolerance(tolerance) => Some(ModeCount::Automatic { tolerance }),
        }
    }
}

/// All that a reduction depends on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Key {
    /// Dofs that are kept.
    pub(crate) keep: Vec<usize>,
    /// How the base moves.
    pub(crate) directions: Vec<Option<String>>,
    pub(crate) options: ReductionOptions,
}

/// A reduced structure and what it was made for.
#[derive(Debug, Clone)]
pub(crate) struct Reduced {
    pub(crate) key: Key,
    pub(crate) reduction: Arc<Reduction>,
}

/// What a reduction left, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ReductionFacts {
    /// Dofs of the structure.
    pub dofs: usize,
    /// Those of contacts, excitation and output, which are kept.
    pub kept: usize,
    /// Modes that stand for the others.
    pub modes: usize,
    /// Largest relative error of the response that was found, an estimate; `None` when nothing was left to check.
    pub error: Option<f64>,
}

/// Reductions that are remembered for a structure.
const REMEMBERED: usize = 8;

impl Sparse {
    /// The structure reduced onto the dofs `keep` for frequencies from `lowest` to `highest` Hz; `None` is solved as it is.
    pub(crate) fn reduced(
        &self,
        keep: Vec<usize>,
        directions: &[Option<String>],
        (lowest, highest): (f64, f64),
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Reduced>, SceneError> {
        let Some(modes) = self.wish.modes(self.model.dofs()) else { return Ok(None) };
        let options = ReductionOptions { modes, lowest, highest };
        let key = Key { keep, directions: directions.to_vec(), options };
        let mut known = self.reductions.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = known.iter().find(|(other, _)| *other == key) {
            return Ok(Some(Reduced { key, reduction: found.clone() }));
        }
        let loads = self.base_loads(directions);
        let made = structure::reduce(&self.model, &key.keep, &loads, &options, progress);
        let reduction =
            Arc::new(made.map_err(|error| SceneError::entry("model.reduction", error.to_string()))?);
        known.insert(0, (key.clone(), reduction.clone()));
        known.truncate(REMEMBERED);
        Ok(Some(Reduced { key, reduction }))
    }

    /// The structure as it is.
    pub(crate) fn full(&self, directions: &[Option<String>]) -> Result<hbm::Model, SceneError> {
        let model = self.model.dense().map_err(refused)?;
        match directions {
            [] => Ok(model),
            directions => model.with_base_loads(self.base_loads(directions)).map_err(refused),
        }
    }
}

impl Reduced {
    pub(crate) fn facts(&self, dofs: usize) -> ReductionFacts {
        let Reduction { modes, error, .. } = *self.reduction;
        ReductionFacts { dofs, kept: self.key.keep.len(), modes, error }
    }
}
