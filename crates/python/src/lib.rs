//! The compiled part of the Python package `stickslip`.
//!
//! It speaks in text (JSON), NumPy arrays and plain containers; the classes that users see, their documentation and their
//! types are in `python/stickslip`. Whatever takes long runs without the interpreter's lock.

mod arrays;
mod errors;
mod law;
mod loops;
mod points;
mod scene;
mod study;

use pyo3::prelude::*;

/// Compiled part of stickslip.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SCENE_SCHEMA", ::scene::SCHEMA)?;
    module.add("STUDY_SCHEMA", ::study::SCHEMA)?;
    errors::add(py, module)?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<study::Study>()?;
    module.add_class::<loops::Fit>()?;
    module.add_function(wrap_pyfunction!(loops::fit, module)?)?;
    module.add_function(wrap_pyfunction!(loops::fit_file, module)?)?;
    module.add_function(wrap_pyfunction!(loops::identify, module)?)
}
