//! A contact law written in Python: slow, since the interpreter evaluates it at every step of every iteration, and
//! one thread at a time.

use std::sync::{Arc, Mutex, PoisonError};

use contact::{ContactState, Law, LawError, Marks, Motion, Nature, Tangent, Workspace};
use numpy::{PyArray1, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors;

/// The first exception that a law raised during a solution; raised again when the solution is over.
#[derive(Debug, Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn keep(&self, error: PyErr) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// What was raised since the last call.
    ///
    /// # Errors
    /// That.
    pub(crate) fn again(&self) -> PyResult<()> {
        match self.0.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }
}

/// `f(displacement, velocity) -> force` over the samples of a period; SI units, rig convention.
#[derive(Debug)]
pub(crate) struct PythonLaw {
    pub(crate) function: Py<PyAny>,
    /// Displacement in m at which the law changes its character, for units.
    pub(crate) length: f64,
    pub(crate) odd: bool,
    pub(crate) determines_mean: bool,
    pub(crate) raised: Raised,
}

impl PythonLaw {
    fn call(&self, motion: &Motion, force: &mut [f64]) -> PyResult<()> {
        Python::attach(|py| {
            let displacement = PyArray1::from_slice(py, motion.displacement);
            let rate: Vec<f64> = motion.velocity.iter().map(|slope| slope * motion.omega).collect();
            let velocity = PyArray1::from_vec(py, rate);
            let answer = self.function.bind(py).call1((displacement, velocity))?;
            let answer: PyReadonlyArray1<'_, f64> = answer.extract().map_err(|_| {
                errors::SceneError::new_err(
                    "a law must answer with a one-dimensional array of floats, one a sample",
                )
            })?;
            if answer.len() != force.len() {
                return Err(errors::SceneError::new_err(format!(
                    "a law must answer with one force a sample: {}, not {}",
                    force.len(),
                    answer.len()
                )));
            }
            for (force, answer) in force.iter_mut().zip(answer.as_array().iter()) {
                *force = *answer;
            }
            Ok(())
        })
    }
}

impl Law for PythonLaw {
    fn name(&self) -> &'static str {
        "python"
    }

    fn nature(&self) -> Nature {
        Nature { odd: self.odd, determines_mean: self.determines_mean, linear: false, rate_dependent: true }
    }

    fn length(&self) -> Option<f64> {
        Some(self.length)
    }

    /// Of the motion `a cos τ` at a rate of 1 rad/s.
    fn secant_stiffness(&self, a: f64) -> f64 {
        const SAMPLES: usize = 64;
        let angle = |j: usize| std::f64::consts::TAU * j as f64 / SAMPLES as f64;
        let displacement: Vec<f64> = (0..SAMPLES).map(|j| a * angle(j).cos()).collect();
        let velocity: Vec<f64> = (0..SAMPLES).map(|j| -a * angle(j).sin()).collect();
        let motion = Motion {
            spectrum: &[],
            displacement: &displacement,
            velocity: &velocity,
            odd: false,
            omega: 1.0,
        };
        let mut force = vec![0.0; SAMPLES];
        if let Err(error) = self.call(&motion, &mut force) {
            self.raised.keep(error);
            return 0.0;
        }
        let part = |of: fn(f64) -> f64| {
            force.iter().enumerate().map(|(j, f)| f * of(angle(j))).sum::<f64>() * 2.0 / SAMPLES as f64
        };
        part(f64::cos).hypot(part(f64::sin)) / a
    }

    fn force(
        &self,
        motion: &Motion,
        _workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        match self.call(motion, force) {
            Ok(()) => Ok(Marks { extrapolated: false, state: ContactState::Mixed }),
            Err(error) => {
                self.raised.keep(error);
                Err(LawError::NotFinite)
            }
        }
    }

    /// Unknown: problems with such laws take their derivative by differences.
    fn tangent<'w>(&self, _motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        workspace.tangent_mut()
    }
}
