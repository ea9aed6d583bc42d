//! Measured records: fitted loops and the scaling laws identified from several of them.

use std::path::PathBuf;

use contact::identification::{IdentificationSettings, LoopPoint, identify as identify_laws};
use hysteresis::{FitSettings, ReadOptions, Record};
use num_complex::Complex64;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::vector;
use crate::errors;

/// A fitted record.
#[pyclass(frozen, module = "stickslip._native")]
pub(crate) struct Fit(hysteresis::Fit);

/// Fits arrays in SI units.
#[pyfunction]
#[pyo3(signature = (displacement, force, time=None))]
pub(crate) fn fit(
    py: Python<'_>,
    displacement: PyReadonlyArray1<'_, f64>,
    force: PyReadonlyArray1<'_, f64>,
    time: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<Fit> {
    if displacement.len() != force.len() {
        let (w, f) = (displacement.len(), force.len());
        return Err(errors::record(format!(
            "displacement has {w} samples and force {f}; they must have as many"
        )));
    }
    let values = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
    let (displacement, force, time) = (values(&displacement), values(&force), time.as_ref().map(values));
    py.detach(|| fitted(&Record::new(time, displacement, force).map_err(errors::record)?))
}

/// Reads and fits a file; `options` is what a scene says beside `file`, as JSON.
#[pyfunction]
pub(crate) fn fit_file(py: Python<'_>, path: PathBuf, options: &str) -> PyResult<Fit> {
    let options: ReadOptions = serde_json::from_str(options).map_err(errors::record)?;
    py.detach(|| fitted(&Record::read(&path, &options).map_err(errors::record)?))
}

fn fitted(record: &Record) -> PyResult<Fit> {
    hysteresis::fit(record, &FitSettings::default()).map(Fit).map_err(errors::record)
}

#[pymethods]
impl Fit {
    /// Half peak-to-peak displacement in m.
    #[getter]
    fn displacement_amplitude(&self) -> f64 {
        self.0.hysteresis_loop.displacement_amplitude()
    }

    /// |F_1| in N.
    #[getter]
    fn force_amplitude(&self) -> f64 {
        self.0.hysteresis_loop.force_amplitude()
    }

    /// arg F_1 in rad.
    #[getter]
    fn phase(&self) -> f64 {
        self.0.hysteresis_loop.phase()
    }

    /// J a cycle.
    #[getter]
    fn dissipation(&self) -> f64 {
        self.0.hysteresis_loop.dissipation()
    }

    /// F_0 … F_K in N.
    #[getter]
    fn harmonics<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let coefficients: Vec<Complex64> = self.0.hysteresis_loop.coefficients().to_vec();
        vector(py, coefficients)
    }

    #[getter]
    fn cycles(&self) -> usize {
        self.0.cycles
    }

    #[getter]
    fn period(&self) -> Option<f64> {
        self.0.period
    }

    #[getter]
    fn noise(&self) -> f64 {
        self.0.noise
    }

    #[getter]
    fn even_content(&self) -> f64 {
        self.0.even_content
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes.iter().map(ToString::to_string).collect()
    }

    /// Force in N at loop phases in rad.
    fn force<'py>(&self, py: Python<'py>, theta: PyReadonlyArray1<'py, f64>) -> Bound<'py, PyAny> {
        vector(
            py,
            theta.as_array().iter().map(|theta| self.0.hysteresis_loop.force(*theta)).collect::<Vec<f64>>(),
        )
    }
}

/// Identifies eqs (6) and (7) from fitted loops; `settings` as JSON.
#[pyfunction]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    loops: Vec<PyRef<'py, Fit>>,
    settings: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let settings: IdentificationSettings = serde_json::from_str(settings).map_err(errors::record)?;
    let points: Vec<LoopPoint> = loops.iter().map(|fit| LoopPoint::from(&fit.0)).collect();
    let found = identify_laws(&points, &settings).map_err(errors::record)?;
    let answer = PyDict::new(py);
    for (law, estimates) in [("magnitude", &found.magnitude.estimates), ("phase", &found.phase.estimates)] {
        let values = PyDict::new(py);
        for estimate in estimates {
            let value = PyDict::new(py);
            value.set_item("value", estimate.value)?;
            value.set_item("std_error", estimate.std_error)?;
            value.set_item("interval", estimate.interval)?;
            values.set_item(estimate.parameter.name(), value)?;
        }
        answer.set_item(law, values)?;
    }
    let reference = PyDict::new(py);
    reference.set_item("index", found.reference.index)?;
    reference.set_item("displacement", found.reference.displacement)?;
    reference.set_item("force", found.reference.force)?;
    answer.set_item("reference", reference)?;
    answer.set_item("residual_rms", found.residual_rms)?;
    answer.set_item("notes", found.notes.iter().map(ToString::to_string).collect::<Vec<_>>())?;
    Ok(answer)
}
