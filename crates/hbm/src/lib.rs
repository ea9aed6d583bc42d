//! N-harmonic balance with alternating frequency–time (AFT) evaluation of contact forces.
//!
//! The periodic response of
//!
//! ```math
//! M \ddot w + D \dot w + C w = f_\mathrm{ext}(t) - B f(u, \dot u), \qquad u = B^{\mathsf T} w \tag{1, 2}
//! ```
//!
//! is found in the relative displacements u of the contacts, harmonic by harmonic, k = 0 … N:
//!
//! ```math
//! u_k + G_k F_k(u) = u^0_k, \qquad G_k = B^{\mathsf T} H_k^{-1} B, \qquad
//! u^0_k = B^{\mathsf T} H_k^{-1} F_{\mathrm{ext},k}, \qquad H_k = C - (k\Omega)^2 M + \mathrm i k \Omega D \tag{4}
//! ```
//!
//! with F_k the harmonics of f in rig convention (numbers are those of the paper's equations). The corridor: [`Problem`] (model, excitation, contacts) → [`Plan`] (what this problem
//! needs, made once) → [`Solution`] for each frequency; [`sweep`] maps the last step over frequencies in parallel.
//!
//! # Conventions
//!
//! One-sided complex amplitudes, $`w(t) = \operatorname{Re} \sum_{k=0}^{N} W_k \mathrm e^{\mathrm i k \Omega t}`$; SI units; frequencies in Hz. A contact force is
//! given as it acts **on the first body** of the contact: it opposes the motion.

mod balance;
mod beyond;
mod condensation;
mod continuation;
mod course;
mod dense;
mod detour;
mod error;
mod estimate;
mod facts;
mod fallback;
mod free_motion;
mod ground_paths;
mod harmonics;
mod hill;
mod holding;
mod jacobian;
mod joint_events;
mod joint_force;
mod krylov;
mod ladder;
mod landmarks;
mod matrices;
mod modal;
mod mode;
mod newton;
mod peak;
mod peak_branch;
mod peak_follow;
mod peak_optimum;
mod peak_rest;
mod peak_search;
mod peak_survey;
mod pieces;
mod plan;
mod plan_check;
mod point;
mod problem;
mod prominence;
mod report;
mod responses;
mod rows;
mod scalar;
mod settings;
mod solution;
mod solve;
mod sparse;
mod stability;
mod start;
mod sweep;
mod tracer;
mod transform;
#[cfg(test)]
mod verification;
mod waveform;
mod workspace;

pub use continuation::{ContinuationOptions, Curve, CurveEnd, CurvePoint, entry_curve, frequency_curve};
pub use error::PlanError;
pub use facts::{PlanFacts, Receptances};
pub use hill::{Hill, HillError, Multipliers, PeriodicSpring};
pub use mode::{ModeEnd, ModeOptions, ModePoint, NonlinearMode, Origin, nonlinear_mode};
pub use peak::{
    Optimum, OptimumKind, Peak, PeakCurve, PeakEffort, PeakEnd, PeakOptions, PeakPoint, PeakStatus,
    follow_peaks,
};
pub use plan::Plan;
pub use problem::{Contact, Direction, Excitation, ExcitationKind, Joint, Problem};
pub use settings::{Jacobian, LinearSolver, Settings, Start};
pub use solution::{
    ContactSolution, DirectionSolution, FailureReason, JointSolution, Solution, Stats, Status, Waveform,
    WaveformContact, WaveformJoint,
};
pub use stability::{NoStability, Stability, StabilityMethod, Verdict};
pub use structure::{Damping, Model, ModelError, SparseDamping, SparseModel};
pub use sweep::{Sweep, SweepOptions, sweep};
pub use workspace::Workspace;
