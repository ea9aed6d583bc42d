//! Scenes: what a user writes down, and what comes back.
//!
//! A scene is a JSON file with a model, its excitation, its contacts and the frequencies of interest. The way through
//! the crate:
//!
//! ```no_run
//! use scene::{RunOptions, Scene};
//!
//! let scene = Scene::from_file("two-mass.json".as_ref())?; // read and checked
//! let prepared = scene.prepare()?; // what all frequencies share
//! for step in prepared.explain() {
//!     println!("{} {}: {}", if step.used { "+" } else { "-" }, step.what, step.why);
//! }
//! let outcome = prepared.solve(&RunOptions::default()).outcome(); // plain data
//! scene::write_json(std::io::stdout(), &outcome)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Every mistake in a scene is a [`SceneError`] with the path of the entry: `contacts[0].law.slip_force: must be
//! positive, got -1`.

mod axes;
mod backbone;
mod contacts;
mod curve;
mod dofs;
mod error;
mod excitation;
mod explain;
mod frequencies;
mod harmonics;
mod iwan;
mod joint_law;
mod joints;
mod json;
mod law;
mod layout;
mod lines;
mod loop_family;
mod loops;
mod matrix;
mod model;
mod motion;
mod notes;
mod npz;
mod outcome;
mod peak;
mod pose;
mod read;
mod recorded;
mod records;
mod reduction;
mod response;
mod run;
mod scene;
mod schema;
mod solver;
mod sparse;
mod stability;
mod structure;
mod variants;

pub use ::structure::Progress;
pub use backbone::{BackboneOptions, BackboneOutcome, BackbonePoint, Expected};
pub use curve::{Along, CurveOutcome, CurveOutcomePoint};
pub use error::SceneError;
pub use explain::Step;
pub use frequencies::{BadFrequencies, Frequencies};
pub use harmonics::{BadHarmonics, Harmonics};
pub use hbm::{ContinuationOptions, Origin, Problem, SweepOptions as RunOptions};
pub use layout::write_json;
pub use motion::{ContactMotion, DirectionMotion};
pub use outcome::{
    ContactOutcome, ContactPoint, DirectionPoint, JointPoint, Named, Outcome, Point, Spectrum, Timing,
    direction_names,
};
pub use peak::{PeaksCurve, PeaksEffort, PeaksOptimum, PeaksOptions, PeaksOutcome, PeaksPeak, PeaksPoint};
pub use recorded::{Mismatch, RecordedContact, RecordedPoint};
pub use reduction::ReductionFacts;
pub use response::{Curve, Peak, Resonance, Response, Responses, highest, peaks};
pub use run::{Motion, Prepared, Solved};
pub use scene::Scene;
pub use schema::SCHEMA;
pub use stability::{Judge, PointStability};
pub use variants::Variants;

/// Reading of JSON whose errors name the entry; for files like a scene's.
pub mod reading {
    pub use crate::json::{Json, parse};
    pub use crate::read::{Node, Object, show, suggestion};
}
