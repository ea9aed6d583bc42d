//! Contact laws for harmonic balance.
//!
//! A law answers one question: which force does a contact exert over one period of a given relative
//! displacement, and how does that force change when the displacement does? Everything a solver needs is
//! in the trait [`Law`]; each law lives in a file of its own:
//!
//! | law | file | force |
//! |---|---|---|
//! | [`ScaledLoop`] | `scaled_loop.rs` | a measured loop, scaled by eqs (6)–(9) of the paper |
//! | [`LoopFamily`] | `loop_family.rs` | measured loops at several amplitudes, interpolated |
//! | [`ElasticCoulomb`] | `elastic_coulomb.rs` | spring in series with a Coulomb slider (Jenkins element) |
//! | [`Iwan`] | `iwan.rs` | Jenkins elements in parallel, from a backbone (Masing's rule) |
//! | [`Coulomb`] | `coulomb.rs` | $`F_s \tanh(\dot w / v)`$ |
//! | [`Cubic`] | `cubic.rs` | $`k_3 w^3`$ |
//! | [`Gap`] | `gap.rs` | $`k \max(w - g, 0)`$ |
//! | [`Linear`] | `linear.rs` | $`k w`$ |
//!
//! A contact in several directions, friction under a normal load that the motion changes, is a [`JointLaw`]:
//!
//! | law | file | forces |
//! |---|---|---|
//! | [`FrictionContact`] | `friction_contact.rs` | spring and Coulomb slider in one or two directions, limit μN; N unilateral |
//! | [`LoadedLoop`] | `loaded_loop.rs` | a scaled loop whose force goes with the normal load |
//!
//! The numbers of eqs (6) and (7) are identified from measured loops by [`identification::identify`].
//!
//! "The paper" is T. Hoffmann, L. Panning-von Scheidt, J. Wallaschek, *Modelling friction characteristics in
//! turbine blade vibrations using a Fourier series expansion of a real friction hysteresis*, Procedia
//! Engineering 199 (2017) 669–674.
//!
//! # Conventions
//!
//! * Relative displacement over the phase τ ∈ [0, 2π) of one period, in one-sided complex amplitudes, `W_0` real, in metres:
//!   $`w(\tau) = \operatorname{Re} \sum_{k=0}^{N} W_k \mathrm e^{\mathrm i k \tau}`$.
//! * Forces are in **rig convention**: the force that drives the contact, $`\oint f\,\mathrm dw \ge 0`$; newtons. The force on
//!   the vibrating mass is `−f`.

mod backbone;
mod common_point;
mod coulomb;
mod cubic;
mod elastic_coulomb;
mod error;
mod events;
mod family_curve;
mod friction_contact;
mod friction_events;
mod gap;
pub mod identification;
mod iwan;
mod joint;
mod law;
mod linear;
mod loaded_loop;
mod logarithmic;
mod loop_curve;
mod loop_family;
mod masing;
mod masing_tangent;
mod mechanism;
mod normal_contact;
mod partials;
mod path;
mod place;
mod play;
mod polygon;
mod real;
mod scaled_loop;
mod scaling;
mod slider;
mod sliding_period;
mod tangent;
mod turning_points;
#[cfg(test)]
mod verification;

pub use coulomb::{Coulomb, CoulombParameters};
pub use cubic::{Cubic, CubicParameters};
pub use elastic_coulomb::{ElasticCoulomb, ElasticCoulombParameters};
pub use error::{LawError, ParameterError};
pub use events::{ForcePiece, PiecewiseLinear};
pub use friction_contact::{FrictionContact, FrictionContactParameters};
pub use gap::{Gap, GapParameters};
pub use iwan::{Iwan, IwanParameters};
pub use joint::{
    Coupling, JointChange, JointLaw, JointMarks, JointMotion, JointPiecewiseLinear, JointWorkspace,
};
pub use law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
pub use linear::{Linear, LinearParameters};
pub use loaded_loop::LoadedLoop;
pub use loop_family::LoopFamily;
pub use mechanism::{JointMechanism, Mechanism, SmoothForce, UnilateralSpring};
pub use normal_contact::{NormalContact, NormalContactParameters};
pub use scaled_loop::{ScaledLoop, Symmetry};
pub use scaling::{MagnitudeLaw, PhaseLaw};
pub use tangent::{Recall, Recalled, Tangent};
pub use turning_points::{TurningPoint, TurningPoints, drop_from};
