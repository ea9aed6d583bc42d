//! What Hoffmann et al. (2017) say about their Fig. 4, and what a pair of scenes gives instead.

pub(crate) mod peaks;
pub(crate) mod reading;
pub(crate) mod statements;
