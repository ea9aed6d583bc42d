//! The exceptions of the package: one base class, so that one `except` catches all of them.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    stickslip,
    StickslipError,
    PyException,
    "Anything that stickslip refuses; the base of its exceptions."
);
create_exception!(
    stickslip,
    SceneError,
    StickslipError,
    "A mistake in a scene; the message names the entry."
);
create_exception!(stickslip, LoopError, StickslipError, "A record that cannot be read or fitted.");
create_exception!(
    stickslip,
    SolveError,
    StickslipError,
    "There is no answer: no orbit, no curve, nothing to compare with."
);

/// Adds the exceptions to the module.
pub(crate) fn add(py: Python<'_>, module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("StickslipError", py.get_type::<StickslipError>())?;
    module.add("SceneError", py.get_type::<SceneError>())?;
    module.add("LoopError", py.get_type::<LoopError>())?;
    module.add("SolveError", py.get_type::<SolveError>())
}

/// Of a scene.
pub(crate) fn scene(error: impl std::fmt::Display) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// Of a record.
pub(crate) fn record(error: impl std::fmt::Display) -> PyErr {
    LoopError::new_err(error.to_string())
}

/// Of a solution.
pub(crate) fn solve(error: impl std::fmt::Display) -> PyErr {
    SolveError::new_err(error.to_string())
}
