//! Studies: many solutions of a scene, put side by side.

mod estimate_quality;
mod reference;

pub use estimate_quality::{EstimateQuality, JudgedPoint};
pub use reference::{Reference, Spectrum};
