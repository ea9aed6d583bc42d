//! A periodic orbit and what can be read off it.

use num_complex::Complex64;
use thiserror::Error;

use crate::system::System;

/// A state of motion to begin with.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// In m, one a dof.
    pub displacement: Vec<f64>,
    /// In m/s, one a dof.
    pub velocity: Vec<f64>,
    /// Spring force in N of every slider, contact by contact in the order of their mechanisms; in rig convention.
    pub sliders: Vec<f64>,
}

/// How an orbit is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Largest difference between the ends of a period, relative to the orbit's own size, that is accepted.
    pub closure: f64,
    /// Periods that are followed from the start before the period map is solved, at most.
    pub settling_periods: usize,
    /// The state at t = 0 to start from; `None` is rest. Where several orbits exist it chooses among them.
    pub start: Option<State>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { closure: 1e-12, settling_periods: 400, start: None }
    }
}

/// What happens to a slider at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// It begins to slip.
    Slip,
    /// It sticks again: the velocity is zero.
    Stick,
}

/// An event of the orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Instant in s, in [0, T).
    pub time: f64,
    /// Contact it belongs to.
    pub contact: usize,
    /// Slider of that contact.
    pub slider: usize,
    /// What begins.
    pub kind: EventKind,
    /// Direction of the slip that begins or ends: +1 or −1.
    pub direction: i8,
}

/// Why there is no orbit to report.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OrbitError {
    /// Not supported by this method.
    #[error("no exact orbit of contact \"{contact}\" ({law}): {why}")]
    NoMechanism {
        /// Name of the contact.
        contact: String,
        /// Name of its law.
        law: &'static str,
        /// Why, and what to do about it.
        why: &'static str,
    },
}

/// An exact periodic orbit.
#[derive(Debug, Clone)]
pub struct Orbit {}

/// Looks for the periodic orbit of `system` at `frequency` in Hz.
///
/// # Errors
/// [`OrbitError`] when there is none, or none was found.
pub fn find(_system: &System, _frequency: f64, _settings: &Settings) -> Result<Orbit, OrbitError> {
    Err(OrbitError::NoMechanism { contact: String::new(), law: "", why: "" })
}

impl Orbit {
    /// T in s.
    pub fn period(&self) -> f64 {
        0.0
    }

    /// Largest difference between the two ends of the period, relative to the orbit's size.
    pub fn closure(&self) -> f64 {
        0.0
    }

    /// |work of the loads − energy dissipated by contacts and damping| over a period, relative to the larger.
    pub fn energy_error(&self) -> f64 {
        0.0
    }

    /// Events of one period in order of time; empty for smooth systems.
    pub fn events(&self) -> &[Event] {
        &[]
    }

    /// Displacement of a dof in m at instant `t` in s.
    pub fn displacement(&self, _dof: usize, _t: f64) -> f64 {
        0.0
    }

    /// Velocity of a dof in m/s.
    pub fn velocity(&self, _dof: usize, _t: f64) -> f64 {
        0.0
    }

    /// Force of a contact on its first body in N.
    pub fn contact_force(&self, _contact: usize, _t: f64) -> f64 {
        0.0
    }

    /// `W_0 … W_highest` of a dof in m, one-sided.
    pub fn spectrum(&self, _dof: usize, _highest: usize) -> Vec<Complex64> {
        Vec::new()
    }

    /// `F_0 … F_highest` of a contact's force on its first body in N, one-sided.
    pub fn force_spectrum(&self, _contact: usize, _highest: usize) -> Vec<Complex64> {
        Vec::new()
    }

    /// `√(Σ_k |W_k|²)` of a dof in m over all harmonics, from the mean square (the mean counts fully).
    pub fn norm(&self, _dof: usize) -> f64 {
        0.0
    }

    /// Smallest and largest displacement of a dof in m.
    pub fn range(&self, _dof: usize) -> (f64, f64) {
        (0.0, 0.0)
    }

    /// Energy in J that a contact dissipates in a period.
    pub fn dissipation(&self, _contact: usize) -> f64 {
        0.0
    }

    /// The state at t = 0.
    pub fn state(&self) -> State {
        State::default()
    }
}
