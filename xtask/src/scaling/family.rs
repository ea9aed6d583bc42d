//! What is varied.

use anyhow::{Context, Result};

/// A quantity that grows while all others are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    /// Dofs of the model, one contact, N = 7.
    Dofs,
    /// Contacts of a model with that many dofs and 32 more, N = 7.
    Contacts,
    /// Highest harmonic N, two dofs, one contact.
    Harmonics,
    /// Frequencies of one sweep on one thread, two dofs, one contact, N = 7.
    Points,
    /// Likewise on two threads.
    PointsOnTwoThreads,
}

impl Family {
    pub(crate) const ALL: [Self; 5] =
        [Self::Dofs, Self::Contacts, Self::Harmonics, Self::Points, Self::PointsOnTwoThreads];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Dofs => "dofs",
            Self::Contacts => "contacts",
            Self::Harmonics => "harmonics",
            Self::Points => "points",
            Self::PointsOnTwoThreads => "points-2-threads",
        }
    }

    pub(crate) fn of(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|family| family.name() == name)
            .with_context(|| format!("no family {name:?}"))
    }

    pub(crate) fn sizes(self) -> &'static [usize] {
        match self {
            Self::Dofs => &[2, 4, 8, 16, 32, 64, 128, 256, 512],
            Self::Contacts => &[1, 2, 4, 10, 20, 40, 100, 200, 400, 1000],
            Self::Harmonics => &[1, 3, 7, 15, 31, 63, 127, 255, 511],
            Self::Points | Self::PointsOnTwoThreads => &[32, 100, 1000, 10_000, 100_000],
        }
    }

    pub(crate) fn dofs(self, size: usize) -> usize {
        match self {
            Self::Dofs => size,
            Self::Contacts => size + 32,
            Self::Harmonics | Self::Points | Self::PointsOnTwoThreads => 2,
        }
    }

    pub(crate) fn contacts(self, size: usize) -> usize {
        if self == Self::Contacts { size } else { 1 }
    }

    pub(crate) fn harmonics(self, size: usize) -> usize {
        if self == Self::Harmonics { size } else { 7 }
    }

    /// Frequencies of one run.
    pub(crate) fn points(self, size: usize) -> usize {
        match self {
            Self::Points | Self::PointsOnTwoThreads => size,
            // A point takes a while.
            Self::Contacts if size >= 100 => 6,
            _ => 24,
        }
    }

    pub(crate) fn threads(self) -> usize {
        if self == Self::PointsOnTwoThreads { 2 } else { 1 }
    }
}
