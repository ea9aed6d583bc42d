//! Linear structures: mass, damping and stiffness, of two dofs or a hundred thousand.
//!
//! [`Model`] is what the balance works with: dense matrices of moderate size. A finite-element structure comes as a
//! [`SparseModel`], from Matrix Market or NumPy files, and is reduced onto the dofs that carry contacts, excitation and
//! output. Dofs are counted from zero; SI units.

mod craig_bampton;
mod error;
mod factor;
mod model;
mod modes;
mod pencil;
mod receptance_error;
mod reduction;
mod sparse;

pub use craig_bampton::reduce;
pub use error::ModelError;
pub use model::{Damping, Model};
pub use reduction::{ModeCount, Progress, Reduction, ReductionError, ReductionOptions};
pub use sparse::{SparseDamping, SparseModel};
