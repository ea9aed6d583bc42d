//! Numbers in files: NumPy arrays (`.npy`) and their archives (`.npz`).

mod error;
mod header;
mod npy;
mod npz;

pub use error::{ArrayError, extents};
pub use header::Field;
pub use npy::{MOST_NUMBERS, NpyReader};
pub use npz::{Member, NpzReader};
