//! What moves a contact in time, for those who integrate motions instead of balancing harmonics.

use crate::elastic_coulomb::ElasticCoulomb;

/// How a law's force follows a displacement in time.
#[derive(Clone, Copy)]
pub enum Mechanism<'a> {
    /// Elastic Coulomb elements and a spring, all in parallel: between events the force is linear.
    Sliders {
        /// The elements; empty for a spring alone.
        sliders: &'a [ElasticCoulomb],
        /// Stiffness of the spring in N/m.
        spring: f64,
    },
    /// A force that depends smoothly on displacement and velocity.
    Smooth(&'a dyn SmoothForce),
    /// A spring that presses but does not pull: between contact and separation the force is linear.
    Unilateral(UnilateralSpring),
    /// None: the force at an instant needs the whole period, or infinitely many elements.
    None {
        /// Why, and what to do about it.
        why: &'static str,
    },
}

/// A spring that presses but does not pull: pressure `N = max(pressure_at_zero + k w, 0)`, of which the part
/// `balanced` belongs to the equilibrium that displacements are measured from, so that the force is `f = N − balanced`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnilateralSpring {
    /// k in N/m; positive.
    pub stiffness: f64,
    /// N at zero displacement in N; negative where a gap is open there (`−k g`).
    pub pressure_at_zero: f64,
    /// In N; zero unless the spring is preloaded.
    pub balanced: f64,
}

/// How a joint's forces follow its displacements in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointMechanism {
    /// A unilateral spring along the normal direction and, in the tangential ones, a spring in series with a slider
    /// whose limit is μN: `|f_t| ≤ μN`, and the slider moves along f_t while `|f_t| = μN`.
    Friction {
        /// k_t in N/m.
        tangential_stiffness: f64,
        /// μ.
        friction_coefficient: f64,
        /// The normal direction.
        normal: UnilateralSpring,
    },
    /// None: the forces at an instant need the whole period.
    None {
        /// Why, and what to do about it.
        why: &'static str,
    },
}

/// A force f(w, ẇ), differentiable as often as an integrator needs it.
pub trait SmoothForce {
    /// f in N (rig convention) at displacement `w` in m and velocity `v` in m/s.
    fn at(&self, w: f64, v: f64) -> f64;

    /// (∂f/∂w in N/m, ∂f/∂ẇ in N s/m).
    fn slopes(&self, w: f64, v: f64) -> (f64, f64);
}
