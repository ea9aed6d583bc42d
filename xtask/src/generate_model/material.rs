//! What the structures are made of.

/// An isotropic material in SI units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Material {
    /// Young's modulus in N/m².
    pub(super) young: f64,
    /// Poisson's ratio.
    pub(super) poisson: f64,
    /// In kg/m³.
    pub(super) density: f64,
}

/// Blade steel.
pub(super) const STEEL: Material = Material { young: 2.1e11, poisson: 0.3, density: 7850.0 };

impl Material {
    /// Lamé's first constant λ.
    pub(super) fn lame(&self) -> f64 {
        self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))
    }

    /// The shear modulus μ.
    pub(super) fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }
}
