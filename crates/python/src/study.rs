//! A study whose cases are solved one by one, wherever there is a machine.

use std::path::PathBuf;

use ::study::{FinishedCase, Shard, StudyOptions, Table};
use pyo3::prelude::*;

use crate::errors;

/// A grid over entries of a scene.
#[pyclass(frozen, module = "stickslip._native")]
pub(crate) struct Study(::study::Study);

#[pymethods]
impl Study {
    /// From JSON text; files are relative to `base`.
    #[new]
    fn new(text: &str, base: PathBuf, name: &str) -> PyResult<Self> {
        ::study::Study::from_str(text, &base, name).map(Self).map_err(errors::scene)
    }

    #[getter]
    fn cases(&self) -> usize {
        self.0.cases()
    }

    /// Of everything that the results depend on.
    #[getter]
    fn fingerprint(&self) -> String {
        self.0.fingerprint().to_string()
    }

    /// Solves one case on one thread; the finished case as JSON.
    fn solve(&self, py: Python<'_>, case: usize) -> PyResult<String> {
        if case >= self.0.cases() {
            return Err(errors::scene(format!("there is no case {case}; there are {}", self.0.cases())));
        }
        let shard = Some(Shard::one(case, self.0.cases()));
        let options = StudyOptions { shard, threads: Some(1), ..StudyOptions::default() };
        let finished = py.detach(|| self.0.run(Vec::new(), options)).map_err(errors::solve)?;
        let one = finished.first().ok_or_else(|| errors::solve("the case was not solved"))?;
        serde_json::to_string(one).map_err(errors::solve)
    }

    /// The table of finished cases, `json` or `csv`, as the command line writes it.
    fn table(&self, finished: Vec<String>, format: &str) -> PyResult<String> {
        let mut cases: Vec<FinishedCase> = finished
            .iter()
            .map(|case| serde_json::from_str(case).map_err(errors::solve))
            .collect::<PyResult<_>>()?;
        cases.sort_by_key(|case| case.case);
        cases.dedup_by_key(|case| case.case);
        let table = Table { study: &self.0, cases: &cases };
        let mut text = Vec::new();
        match format {
            "json" => table.write_json(&mut text),
            "csv" => table.write_csv(&mut text),
            _ => return Err(errors::solve(format!("a table is json or csv, not {format:?}"))),
        }
        .map_err(errors::solve)?;
        String::from_utf8(text).map_err(errors::solve)
    }
}
