//! The derivative of the period map at an orbit: how a small disturbance has changed after one period.

use std::f64::consts::TAU;

use faer::Mat;
use num_complex::Complex64;

use crate::error::OrbitError;
use crate::orbit::Orbit;
use crate::piecewise::Piecewise;
use crate::shooting::Map;
use crate::smooth::Smooth;

impl Orbit {
    /// Φ = ∂x(T)/∂x(0), square, by the variational equation along the orbit and jumps at its events (not by differences).
    ///
    /// The state x is laid out as [`crate::State`]: displacements of all n dofs in m, their velocities in m/s, then the
    /// spring force in N of every slider, contact by contact and then joint by joint. An entry (i, j) has the unit of x_i over that of x_j.
    /// A slider that slips at t = 0 has a force that is no freedom of its own: its column is zero. One that never slips
    /// keeps what it is given and has a multiplier of exactly 1.
    ///
    /// # Errors
    /// As of [`crate::find`], when the period cannot be followed again.
    pub fn monodromy(&self) -> Result<Mat<f64>, OrbitError> {
        let scaled = self.scaled_monodromy()?;
        let (n, units) = (scaled.nrows(), self.units());
        let unit = |i: usize| units.get(i).copied().unwrap_or(1.0);
        Ok(Mat::from_fn(n, n, |i, j| scaled[(i, j)] * unit(i) / unit(j)))
    }

    /// Floquet multipliers: the eigenvalues of [`Orbit::monodromy`], as many as the state has entries, the largest
    /// magnitude first. The orbit is stable when all magnitudes are below one.
    ///
    /// # Errors
    /// As of [`Orbit::monodromy`]; [`OrbitError::Eigenvalues`] when they were not found.
    pub fn multipliers(&self) -> Result<Vec<Complex64>, OrbitError> {
        let mut values = self.scaled_monodromy()?.eigenvalues().map_err(|_| OrbitError::Eigenvalues)?;
        values.sort_by(|a, b| {
            b.norm_sqr().total_cmp(&a.norm_sqr()).then(b.im.total_cmp(&a.im)).then(b.re.total_cmp(&a.re))
        });
        Ok(values)
    }

    /// In units of the dimensionless system.
    fn scaled_monodromy(&self) -> Result<Mat<f64>, OrbitError> {
        let n = self.state.len();
        let (mut derivative, mut end) = (Mat::zeros(n, n), Vec::new());
        if self.system.is_smooth() {
            let mut map = Smooth::new(&self.system, self.tolerance);
            map.pass(&self.state, TAU, &mut end, Some(&mut derivative))?;
        } else {
            Piecewise::new(&self.system).pass(&self.state, TAU, &mut end, Some(&mut derivative))?;
        }
        Ok(derivative)
    }

    /// SI units of a unit of every entry of the state.
    fn units(&self) -> Vec<f64> {
        let system = &self.system;
        let length = |root: &f64| system.size / root;
        let displacements = system.root_mass.iter().map(length);
        let velocities = system.root_mass.iter().map(|root| length(root) * system.omega);
        let forces = system.sliders.iter().map(|slider| slider.limit * system.force());
        let pulls = system.pulls().map(|(friction, _)| friction.stiffness * system.force());
        displacements.chain(velocities).chain(forces).chain(pulls).collect()
    }
}
