//! Measured friction hysteresis loops: from a file of a test rig to a Fourier series over loop phase.
//!
//! The way through the crate:
//!
//! 1. [`Record::read`] reads displacement and force (time is optional) from a text file, arrays of NumPy or MATLAB, or a
//!    universal file, and converts them to SI units;
//! 2. [`fit`] finds the turning points, tells the steady cycles from run-up and run-down, gives every
//!    sample its loop phase, averages, and fits the Fourier series;
//! 3. the resulting [`Loop`] evaluates the force over loop phase.
//!
//! # Conventions
//!
//! Everything is in the *rig convention*: the force is the one the rig applies, so a loop that dissipates
//! has $`\oint f\,\mathrm dw > 0`$. Complex amplitudes are one-sided, over the *loop phase* θ,
//!
//! ```math
//! f(\theta) = \operatorname{Re} \sum_{k=0}^{K} F_k \,\mathrm e^{\mathrm i k \theta}, \qquad w = w_\mathrm{mid} + a \cos \theta .
//! ```
//!
//! θ runs from 0 to π on the unloading branch
//! (from the upper turning point to the lower one) and from −π to 0 on the loading branch. `a` is half the
//! peak-to-peak displacement. Where a motion had been a pure cosine, θ would be Ωt; it need not have been.
//!
//! # Example
//!
//! ```
//! use hysteresis::{FitSettings, ReadOptions, Record, fit, synthetic};
//!
//! // A rig would have written this file: run-up, five steady cycles, run-down, 1 % noise.
//! let reference = synthetic::dahl_loop(8e-6, 12.0, 6e6, 15)?;
//! let rig = synthetic::DirtyRecord { force_noise: 0.01, ..synthetic::DirtyRecord::new(reference.clone()) };
//! let text = rig.generate().to_csv("um".parse()?, "N".parse()?, "s".parse()?);
//!
//! let record = Record::parse(&text, &ReadOptions::default())?;
//! let result = fit(&record, &FitSettings::default())?;
//! assert_eq!(result.cycles, 5);
//! let error = (result.hysteresis_loop.dissipation() / reference.dissipation() - 1.0).abs();
//! assert!(error < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod array_file;
mod average;
mod channel_error;
mod channels;
mod checks;
mod cycles;
#[cfg(test)]
mod dft;
mod drift;
mod error;
mod features;
mod fit;
mod harmonics;
mod hysteresis_loop;
mod loop_phase;
mod noise;
mod notes;
mod options;
mod read;
mod record;
mod record_error;
pub mod synthetic;
mod table;
mod turning_points;
mod uff;
mod units;

pub use channel_error::ChannelError;
pub use error::{FitError, LoopError};
pub use fit::{EVEN_CONTENT_LIMIT, Fit, FitSettings, MeanCycle, fit};
pub use hysteresis_loop::Loop;
pub use notes::Note;
pub use options::{Column, Columns, ForceSign, ReadOptions, Units};
pub use record::{Quantity, Record};
pub use record_error::RecordError;
pub use turning_points::TurningPoint;
pub use units::{ForceUnit, LengthUnit, TimeUnit, UnknownUnit};
