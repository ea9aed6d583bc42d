//! Results as one HTML page: response curves, loops and waveforms at a chosen point, error estimates, notes. The page
//! holds its data and its program, and asks no network for anything.
//!
//! ```no_run
//! use report::{Recorded, Report, Source};
//!
//! let mut report = Report::default();
//! report.add("two-mass", Recorded::from_json(&std::fs::read_to_string("two-mass-result.json")?)?)?;
//! report.explain(&Source::from_file("two-mass.json".as_ref())?)?; // plan, linear response, the laws' own forces
//! std::fs::write("report.html", report.html()?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod data;
mod document;
mod error;
mod motion;
mod recorded;
mod report;
mod source;
mod summary;

pub use document::page;
pub use error::ReportError;
pub use recorded::Recorded;
pub use report::Report;
pub use source::Source;
