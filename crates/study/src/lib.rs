//! Studies: many solutions of a scene, put side by side.
//!
//! - [`Truths`]: the exact response of a scene where it is known, else one with far more harmonics, and the distance of
//!   a solution from it ([`Truth::errors`]).
//! - [`truncation()`]: error and run time against the number of harmonics.
//! - [`Study`]: a grid over entries of a scene and numbers of harmonics; [`Partial`] keeps what is finished, and
//!   [`Shard`] is a part of it for one of several machines.
//! - [`EstimateQuality`]: how far error estimates can be trusted.
//! - [`Convergence`]: errors over the size of a discretisation, and the order at which they fall.
//! - [`work_precision`]: error against run time.
//! - [`stability()`]: Floquet multipliers of friction that remembers, from the exact orbit beside a solution.
//! - [`step_until_periodic`]: what one does without harmonic balance, for comparison.
//!
//! The *truncation error* of a point is everywhere the same: the worst over the output dofs of the relative l2 error of
//! the dof's displacement spectrum over all harmonics, those above N being zero in the truncated one,
//!
//! ```math
//! \varepsilon^2 = \max_\text{dofs} \frac{\sum_k |W_k - W_{k,\mathrm{true}}|^2}{\sum_k |W_{k,\mathrm{true}}|^2} .
//! ```

mod axis;
mod cases;
mod convergence;
mod error;
mod estimate_quality;
mod fingerprint;
mod grid;
mod partial;
mod periodic;
mod schema;
mod shard;
mod stability;
mod start;
mod stepping;
mod system;
mod table;
mod truncation;
mod truth;
pub mod work_precision;

pub use axis::Axis;
pub use cases::{Entry, FinishedCase, Keeper, Kind, StudyOptions};
pub use convergence::{Convergence, Order};
pub use error::StudyError;
pub use estimate_quality::{EstimateQuality, JudgedPoint};
pub use fingerprint::Fingerprint;
pub use grid::{Case, Keep, Study};
pub use partial::Partial;
pub use schema::SCHEMA;
pub use shard::Shard;
pub use stability::stability;
pub use stepping::{Stepped, SteppingError, SteppingSettings, step_until_periodic};
pub use system::system;
pub use table::Table;
pub use truncation::{Rate, Row, Truncation, TruncationOptions, truncation};
pub use truth::{Errors, NoTruth, Reference, TrueDof, Truth, Truths};
