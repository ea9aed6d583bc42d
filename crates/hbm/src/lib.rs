//! N-harmonic balance with alternating frequency–time (AFT) evaluation of contact forces.
//!
//! `M ẅ + D ẇ + C w = f_ext − Σ contacts` is solved for its periodic response, eqs (1)–(4) of the paper for any
//! number of harmonics N. The corridor: [`Problem`] (model, excitation, contacts) → [`Plan`] (what this problem
//! needs, made once) → [`Solution`] for each frequency; [`sweep`] maps the last step over frequencies in parallel.
//!
//! # Conventions
//!
//! One-sided complex amplitudes, `w(t) = Re Σ_{k=0..N} W_k e^{ikΩt}`; SI units; frequencies in Hz. A contact force is
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
