//! Rust's numbers as NumPy arrays.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;

/// A one-dimensional array.
pub(crate) fn vector<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyAny> {
    values.into_pyarray(py).into_any()
}

/// An array of the given shape, last index fastest.
///
/// # Errors
/// When there are not as many values as the shape has room for.
pub(crate) fn shaped<'py, T: numpy::Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    Ok(values.into_pyarray(py).reshape(shape.to_vec())?.into_any())
}
