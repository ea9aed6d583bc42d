//! Exact periodic orbits: the truth that truncated harmonics are measured against.
//!
//! Independent of harmonic balance: motions are followed in time, from event to event in closed form where all
//! mechanisms are piecewise linear, with a high-order integrator where they are smooth, and closed to a period by
//! Newton's method on the period map (shooting). Of a contact law only its parameters are used
//! ([`contact::Law::mechanism`]).
//!
//! # Conventions
//!
//! `M ẅ + D ẇ + C w = f_ext(t) − Σ contacts`; one-sided complex amplitudes `w(t) = Re Σ W_k e^{ikΩt}`; SI units,
//! frequencies in Hz. Contact forces are given as they act on the first body.

mod orbit;
mod system;

pub use orbit::{Event, EventKind, Orbit, OrbitError, Settings, State, find};
pub use system::{Contact, Load, System};
