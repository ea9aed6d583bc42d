//! Numbers in files: NumPy arrays (`.npy`) and their archives (`.npz`), MATLAB's variables (`.mat`), and tables.

mod error;
mod file;
mod header;
mod mat;
mod npy;
mod npz;
mod npz_writer;
mod parquet;
mod table;
mod thrift;

pub use error::{ArrayError, extents};
pub use file::{ArrayFile, Entry, Format};
pub use header::Field;
pub use npy::{MOST_NUMBERS, NpyReader};
pub use npz::{Member, NpzReader};
pub use npz_writer::NpzWriter;
pub use table::{Cell, Kind, Table, TakeRow};
