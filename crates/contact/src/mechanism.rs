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
    /// None: the force at an instant needs the whole period, or infinitely many elements.
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
