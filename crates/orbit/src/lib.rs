//! Exact periodic orbits: the truth that truncated harmonics are measured against.
//!
//! Independent of harmonic balance: motions are followed in time, from event to event in closed form where all
//! mechanisms are piecewise linear, with a high-order integrator where they are smooth, and closed to a period by
//! Newton's method on the period map (shooting). Of a contact law only its parameters are used
//! ([`contact::Law::mechanism`]). With the state x = (w, ẇ, spring forces of the sliders) an orbit of the period T is a fixed
//! point of the period map P,
//!
//! ```math
//! P(x_0) - x_0 = 0, \qquad P : x(0) \mapsto x(T), \qquad \Phi = \frac{\partial P}{\partial x_0}(x_0) ,
//! ```
//!
//! and the eigenvalues of the monodromy matrix Φ ([`Orbit::monodromy`]) say whether it is stable.
//!
//! # Conventions
//!
//! $`M \ddot w + D \dot w + C w = f_\mathrm{ext}(t) - \sum \text{contacts}`$; one-sided complex amplitudes `w(t) = Re Σ W_k e^{ikΩt}`; SI units,
//! frequencies in Hz. Contact forces are given as they act on the first body.

mod collocation;
mod dynamic_stiffness;
mod error;
mod find;
mod flow;
mod joints;
mod links;
mod monodromy;
mod number;
mod opening;
mod orbit;
mod path;
mod piecewise;
mod polynomial;
mod press;
mod quadrature;
mod reachable;
mod resting;
mod scaled;
mod settings;
mod shooting;
mod smooth;
mod spectrum;
mod system;
mod tangents;
mod turning;
#[cfg(test)]
mod verification;

pub use error::OrbitError;
pub use find::find;
pub use orbit::Orbit;
pub use settings::{Event, EventKind, Settings, State};
pub use system::{Contact, Joint, Load, System};
