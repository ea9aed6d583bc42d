//! Linear structures: mass, damping and stiffness, of two dofs or a hundred thousand.
//!
//! [`Model`] is what the balance works with: dense matrices of moderate size. A finite-element structure comes as a
//! [`SparseModel`], from Matrix Market or NumPy files, and is reduced onto the dofs that carry contacts, excitation and
//! output. Dofs are counted from zero; SI units. A structure answers forces F at the frequency Ω through its dynamic stiffness,
//!
//! ```math
//! H(\Omega)\, W = F, \qquad H(\Omega) = C - \Omega^2 M + \mathrm i \Omega D ,
//! ```
//!
//! and a reduction keeps the dofs b and the lowest modes Φ of the inner dofs i (Craig, Bampton, AIAA J. 6 (1968) 1313),
//!
//! ```math
//! \begin{bmatrix} w_b \\ w_i \end{bmatrix} = T \begin{bmatrix} w_b \\ q \end{bmatrix}, \qquad
//! T = \begin{bmatrix} 1 & 0 \\ -C_{ii}^{-1} C_{ib} & \Phi \end{bmatrix}, \qquad
//! M, D, C \to T^{\mathsf T} M T,\ T^{\mathsf T} D T,\ T^{\mathsf T} C T .
//! ```

mod boundary;
mod checks;
mod craig_bampton;
mod entries;
mod error;
mod factor;
mod matrix_file;
mod matrix_market;
mod model;
mod modes;
mod npy;
mod npz;
mod pencil;
mod receptance_error;
mod reduction;
mod residual_shapes;
mod sparse;
mod triangle;

pub use boundary::{MOST_DENSE_DOFS, times};
pub use craig_bampton::reduce;
pub use entries::compressed;
pub use error::ModelError;
pub use matrix_file::{MatrixFile, MatrixFileError, MatrixNote};
pub use matrix_market::{parse_matrix_market, read_matrix_market};
pub use model::{Damping, Model};
pub use npy::{parse_npy, read_npy};
pub use npz::{parse_npz, read_npz};
pub use reduction::{ModeCount, Progress, Reduction, ReductionError, ReductionOptions};
pub use sparse::{SparseDamping, SparseModel};
