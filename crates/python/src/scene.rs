//! A scene and what can be asked of it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;

use ::study::{TruncationOptions, Truths};
use contact::Law;
use hbm::{ContinuationOptions, Origin};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scene::{Along, BackboneOptions, PeaksOptions, RunOptions, Variants};
use serde::Serialize;

use crate::arrays::{shaped, vector};
use crate::errors;
use crate::law::{PythonLaw, Raised};
use crate::points::columns;

/// A scene, read and checked.
#[pyclass(frozen, module = "stickslip._native")]
pub(crate) struct Scene {
    scene: ::scene::Scene,
    text: String,
    base: PathBuf,
    raised: Raised,
}

/// Between two looks at Ctrl-C, and two reports of progress.
const PATIENCE: std::time::Duration = std::time::Duration::from_millis(50);

/// Why work ended early: Ctrl-C, or what a progress function raised. Raised again in Python, together with what is finished.
type Stopped = Option<PyErr>;

/// Runs `work` without the interpreter's lock on another thread, while this one reports progress and listens for Ctrl-C.
/// `work` gets the flag that stops it and a place for the number of finished points.
fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    raised: &Raised,
    work: impl FnOnce(&AtomicBool, &(dyn Fn(usize) + Sync)) -> T + Send,
) -> PyResult<(T, Stopped)> {
    let (stop, done) = (AtomicBool::new(false), std::sync::atomic::AtomicUsize::new(0));
    let finished = |count: usize| {
        done.fetch_max(count, Ordering::Relaxed);
    };
    let look = |told: &mut usize| -> PyResult<()> {
        let count = done.load(Ordering::Relaxed);
        Python::attach(|py| {
            py.check_signals()?;
            if let Some(progress) = progress.as_ref().filter(|_| count > *told) {
                *told = count;
                progress.call1(py, (count,))?;
            }
            Ok(())
        })
    };
    let (answer, looked) = py.detach(|| {
        std::thread::scope(|threads| {
            let (over, wait) = std::sync::mpsc::channel();
            let (stop, finished) = (&stop, &finished);
            let worker = threads.spawn(move || {
                let answer = work(stop, finished);
                // Nobody listens any more only if this thread is lost as well.
                let _ = over.send(());
                answer
            });
            let (mut told, mut looked) = (0, Ok(()));
            while wait.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                if looked.is_ok() {
                    looked = look(&mut told);
                    stop.store(looked.is_err(), Ordering::Relaxed);
                }
            }
            let answer = worker.join();
            if looked.is_ok() {
                looked = look(&mut told);
            }
            (answer, looked)
        })
    });
    raised.again()?;
    match answer {
        Ok(answer) => Ok((answer, looked.err())),
        Err(_) => {
            Err(errors::StickslipError::new_err("an error in stickslip itself; please report the scene"))
        }
    }
}

/// An answer, or else why there is none: that it was stopped, before what is wrong with a half of it.
fn finished<T, E>(answer: Result<T, E>, stopped: Stopped, refused: fn(E) -> PyErr) -> PyResult<(T, Stopped)> {
    match (answer, stopped) {
        (Ok(answer), stopped) => Ok((answer, stopped)),
        (Err(_), Some(stopped)) => Err(stopped),
        (Err(error), None) => Err(refused(error)),
    }
}

/// Columns, the whole result as JSON, and the exception that ended it early.
type Points<'py> = (Bound<'py, PyDict>, String, Stopped);

#[pymethods]
impl Scene {
    /// A scene from JSON text; files are relative to `base`. `laws` has for names of contacts (function, length, odd,
    /// determines_mean).
    #[new]
    fn new(text: String, base: PathBuf, laws: Vec<(String, Py<PyAny>, f64, bool, bool)>) -> PyResult<Self> {
        let raised = Raised::default();
        let mut scene = ::scene::Scene::from_str(&text, &base).map_err(errors::scene)?;
        for (name, function, length, odd, determines_mean) in laws {
            let law = PythonLaw { function, length, odd, determines_mean, raised: raised.clone() };
            let law: Arc<dyn Law> = Arc::new(law);
            scene = scene.with_law(&name, &law).map_err(errors::scene)?;
        }
        Ok(Self { scene, text, base, raised })
    }

    #[getter]
    fn name(&self) -> &str {
        self.scene.name()
    }

    #[getter]
    fn dofs(&self) -> Vec<String> {
        self.scene.dofs().to_vec()
    }

    #[getter]
    fn output(&self) -> Vec<&str> {
        self.scene.output()
    }

    #[getter]
    fn contacts(&self) -> Vec<&str> {
        self.scene.contacts().collect()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.scene.notes().to_vec()
    }

    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        vector(py, self.scene.frequencies().as_slice().to_vec())
    }

    /// (what, used, why) of every step.
    fn explain(&self, py: Python<'_>) -> PyResult<Vec<(String, bool, String)>> {
        let steps = py.detach(|| self.scene.prepare().map(|prepared| prepared.explain()));
        let steps = steps.map_err(errors::scene)?;
        self.raised.again()?;
        Ok(steps.into_iter().map(|s| (s.what.to_string(), s.used, s.why.to_string())).collect())
    }

    /// The response at every frequency.
    #[pyo3(signature = (threads=None, progress=None, all_solutions=false, stability=false))]
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
        all_solutions: bool,
        stability: bool,
    ) -> PyResult<Points<'py>> {
        let scene = if all_solutions { self.scene.clone().with_all_solutions() } else { self.scene.clone() };
        let scene = if stability { scene.with_stability() } else { scene };
        let (solved, stopped) = watched(py, progress, &self.raised, |stop, finished| {
            let prepared = scene.prepare()?;
            let options = RunOptions { threads, cancel: Some(stop), progress: Some(finished) };
            let mut solved = prepared.solve(&options);
            solved.judge(&|problem, orders, solution| match stop.load(Ordering::Relaxed) {
                true => Err("stopped before".into()),
                false => ::study::stability(problem, orders, solution),
            });
            Ok(solved.outcome())
        })?;
        let refused = |error: ::scene::SceneError| errors::scene(error);
        let (outcome, stopped) = finished(solved, stopped, refused)?;
        let points: Vec<_> = outcome.points.iter().collect();
        Ok((columns(py, &points, &outcome.dofs)?, json(py, &outcome)?, stopped))
    }

    /// The response as a curve.
    #[pyo3(signature = (begin, end, along=None, at=None, stability=false))]
    fn curve<'py>(
        &self,
        py: Python<'py>,
        begin: f64,
        end: f64,
        along: Option<String>,
        at: Option<f64>,
        stability: bool,
    ) -> PyResult<Points<'py>> {
        let scene = if stability { self.scene.clone().with_stability() } else { self.scene.clone() };
        let (found, stopped) = watched(py, None, &self.raised, |stop, _| {
            let judge = |problem: &hbm::Problem, orders: &[usize], solution: &hbm::Solution| match stop
                .load(Ordering::Relaxed)
            {
                true => Err("stopped before".into()),
                false => ::study::stability(problem, orders, solution),
            };
            let go_on = |_: f64| !stop.load(Ordering::Relaxed);
            let options = ContinuationOptions { progress: &go_on, ..ContinuationOptions::default() };
            match (&along, at) {
                (Some(pointer), Some(frequency)) => {
                    let variants = Variants::from_str(&self.text, &self.base, self.scene.name())?;
                    let along = Along::Entry { pointer, frequency };
                    scene.curve_judged(along, (begin, end), Some(&variants), &options, Some(&judge))
                }
                _ => scene.curve_judged(Along::Frequency, (begin, end), None, &options, Some(&judge)),
            }
        })?;
        let (curve, stopped) = finished(found, stopped, errors::scene)?;
        let points: Vec<_> = curve.points.iter().map(|point| &point.point).collect();
        let columns = columns(py, &points, &curve.dofs)?;
        let numbers = |of: fn(&::scene::CurveOutcomePoint) -> f64| -> Vec<f64> {
            curve.points.iter().map(of).collect()
        };
        columns.set_item("parameter", vector(py, numbers(|p| p.parameter)))?;
        columns.set_item("arclength", vector(py, numbers(|p| p.arclength)))?;
        let folds: Vec<bool> = curve.points.iter().map(|point| point.fold).collect();
        columns.set_item("fold", vector(py, folds))?;
        Ok((columns, json(py, &curve)?, stopped))
    }

    /// The highest peak over an entry, as JSON.
    #[pyo3(signature = (vary, range, log, points, dof, harmonics, threads=None))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn peaks(
        &self,
        py: Python<'_>,
        vary: &str,
        range: (f64, f64),
        log: bool,
        points: usize,
        dof: Option<String>,
        harmonics: Vec<usize>,
        threads: Option<usize>,
    ) -> PyResult<(String, Stopped)> {
        let (found, stopped) = watched(py, None, &self.raised, |stop, _| {
            let go_on = |_: usize, _: usize| !stop.load(Ordering::Relaxed);
            let variants = Variants::from_str(&self.text, &self.base, self.scene.name())?;
            let options = PeaksOptions {
                pointer: vary,
                range,
                logarithmic: log,
                points,
                dof: dof.as_deref(),
                harmonics: &harmonics,
                threads,
                progress: &go_on,
            };
            options.check(&variants)?;
            self.scene.peaks(&variants, &options)
        })?;
        let refused = |error: ::scene::SceneError| errors::scene(error);
        let (found, stopped) = finished(found, stopped, refused)?;
        Ok((json(py, &found)?, stopped))
    }

    /// A damped nonlinear mode.
    #[pyo3(signature = (mode, stuck, dof, amplitudes, points))]
    fn backbone<'py>(
        &self,
        py: Python<'py>,
        mode: usize,
        stuck: bool,
        dof: Option<String>,
        amplitudes: (Option<f64>, Option<f64>),
        points: usize,
    ) -> PyResult<Points<'py>> {
        let (found, stopped) = watched(py, None, &self.raised, |stop, _| {
            let go_on = |_: f64| !stop.load(Ordering::Relaxed);
            self.scene.backbone(&BackboneOptions {
                mode,
                origin: if stuck { Origin::Stuck } else { Origin::Free },
                dof: dof.as_deref(),
                amplitudes,
                points,
                progress: &go_on,
            })
        })?;
        let (found, stopped) = finished(found, stopped, errors::scene)?;
        let points: Vec<_> = found.points.iter().map(|point| &point.point).collect();
        let columns = columns(py, &points, std::slice::from_ref(&found.dof))?;
        let numbers =
            |of: fn(&::scene::BackbonePoint) -> f64| -> Vec<f64> { found.points.iter().map(of).collect() };
        columns.set_item("amplitude", vector(py, numbers(|p| p.amplitude)))?;
        columns.set_item("damping_ratio", vector(py, numbers(|p| p.damping_ratio)))?;
        columns.set_item("excitation", vector(py, numbers(|p| p.excitation.unwrap_or(f64::NAN))))?;
        columns.set_item("resonance", vector(py, numbers(|p| p.resonance.unwrap_or(f64::NAN))))?;
        Ok((columns, json(py, &found)?, stopped))
    }

    /// Errors over the number of harmonics, as JSON.
    #[pyo3(signature = (harmonics, threads=None, progress=None))]
    fn truncation(
        &self,
        py: Python<'_>,
        harmonics: Vec<usize>,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(String, Stopped)> {
        let (found, stopped) = watched(py, progress, &self.raised, |stop, finished| {
            let options =
                TruncationOptions { threads, cancel: Some(stop), progress: Some(&|count| finished(count)) };
            ::study::truncation(&self.scene, &harmonics, &options)
        })?;
        let (found, stopped) = finished(found, stopped, errors::solve)?;
        Ok((json(py, &found)?, stopped))
    }

    /// The exact periodic motion at one frequency: spectra up to `harmonics`, and one period at `instants` instants.
    fn orbit<'py>(
        &self,
        py: Python<'py>,
        frequency: f64,
        harmonics: usize,
        instants: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (found, stopped) = watched(py, None, &self.raised, |_, _| {
            let scene = self.scene.clone();
            let scene = match ::scene::Frequencies::one(frequency) {
                Ok(one) => scene.with_frequencies(one),
                Err(_) => scene,
            };
            let scene = scene.with_harmonics(START.max(harmonics)).map_err(|error| error.to_string())?;
            let outputs = scene.problem().map_err(|error| error.to_string())?.output.clone();
            let truths = Truths::new(&scene, START).map_err(|error| error.to_string())?;
            Ok((outputs, truths.orbit(frequency).map_err(|error| error.to_string())?))
        })?;
        // Half an orbit is none.
        if let Some(stopped) = stopped {
            return Err(stopped);
        }
        let (outputs, orbit) = found.map_err(|why: String| errors::solve(why))?;
        let answer = PyDict::new(py);
        let period = orbit.period();
        let times: Vec<f64> = (0..instants).map(|j| period * j as f64 / instants as f64).collect();
        let contacts = self.scene.contacts().count();
        let rows = |rows: usize, of: &dyn Fn(usize, f64) -> f64| -> PyResult<Bound<'py, PyAny>> {
            let values: Vec<f64> = (0..rows)
                .flat_map(|row| times.iter().map(move |t| (row, *t)))
                .map(|(row, t)| of(row, t))
                .collect();
            shaped(py, values, &[rows, times.len()])
        };
        let at = |row: usize| outputs.get(row).copied().unwrap_or(0);
        answer.set_item("displacement", rows(outputs.len(), &|row, t| orbit.displacement(at(row), t))?)?;
        answer.set_item("velocity", rows(outputs.len(), &|row, t| orbit.velocity(at(row), t))?)?;
        answer.set_item("contact_force", rows(contacts, &|row, t| orbit.contact_force(row, t))?)?;
        let spectra = |rows: usize, of: &dyn Fn(usize) -> Vec<num_complex::Complex64>| {
            let values = (0..rows).flat_map(of).collect();
            shaped(py, values, &[rows, harmonics + 1])
        };
        answer.set_item("spectrum", spectra(outputs.len(), &|row| orbit.spectrum(at(row), harmonics))?)?;
        answer.set_item("force_spectrum", spectra(contacts, &|row| orbit.force_spectrum(row, harmonics))?)?;
        let dissipation: Vec<f64> = (0..contacts).map(|contact| orbit.dissipation(contact)).collect();
        answer.set_item("dissipation", vector(py, dissipation))?;
        answer.set_item("closure", orbit.closure())?;
        answer.set_item("period", period)?;
        answer.set_item("time", vector(py, times))?;
        Ok(answer)
    }
}

/// Harmonics of the solution from which an orbit is looked for.
const START: usize = 31;

/// A result as text.
fn json(py: Python<'_>, answer: &(impl Serialize + Sync)) -> PyResult<String> {
    py.detach(|| serde_json::to_string(answer)).map_err(errors::solve)
}
