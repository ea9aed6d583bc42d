//! The system without dimensions: time in radians of the excitation, displacements weighed by the root of their mass.
//!
//! With τ = Ωt, `y_i = w_i √M_ii / X` and X the largest `|load_i| / (√M_ii Ω²)`,
//!
//! ```text
//! M̃ y'' + D̃ y' + K̃ y = Re Σ_h L_h e^{ihτ} − Σ_c β_c φ_c,   u_c = β_c · y
//! ```
//!
//! with `β_c = ±1/√M_ii` at the ends of contact c (of any coefficients for a direction of a joint). Its force φ is in units of X Ω², a stiffness in units of Ω².

use std::ops::Range;

use contact::Mechanism;
use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use num_complex::Complex64;

use crate::error::OrbitError;
use crate::links::{Friction, Link, Press, Slider};
use crate::system::System;

/// Product of norms ‖M̃‖ ‖M̃⁻¹‖ beyond which the mass counts as singular.
const SINGULAR: f64 = 1e13;

/// Amplitudes of one harmonic of the loads.
#[derive(Debug, Clone)]
pub(crate) struct HarmonicLoad {
    pub(crate) harmonic: usize,
    /// L_h, one a dof.
    pub(crate) force: Vec<Complex64>,
    /// M̃⁻¹ L_h.
    pub(crate) acceleration: Vec<Complex64>,
}

/// The system in dimensionless form; matrices row by row.
#[derive(Debug, Clone)]
pub(crate) struct Scaled {
    pub(crate) dofs: usize,
    /// Ω in rad/s.
    pub(crate) omega: f64,
    /// X in m √kg.
    pub(crate) size: f64,
    /// √M_ii in √kg.
    pub(crate) root_mass: Vec<f64>,
    pub(crate) mass: Vec<f64>,
    pub(crate) damping: Vec<f64>,
    pub(crate) stiffness: Vec<f64>,
    /// M̃⁻¹D̃ and M̃⁻¹K̃.
    pub(crate) damping_rate: Vec<f64>,
    pub(crate) stiffness_rate: Vec<f64>,
    pub(crate) loads: Vec<HarmonicLoad>,
    pub(crate) links: Vec<Link>,
    pub(crate) sliders: Vec<Slider>,
    pub(crate) presses: Vec<Press>,
    /// Links of every joint, one a direction.
    pub(crate) directions: Vec<Range<usize>>,
}

impl Scaled {
    /// Checks `system` and makes it dimensionless at `frequency` in Hz.
    pub(crate) fn new(system: &System, frequency: f64) -> Result<Self, OrbitError> {
        system.check(frequency)?;
        let n = system.mass.nrows();
        let omega = std::f64::consts::TAU * frequency;
        let diagonal = (0..n).map(|i| system.mass.get(i, i).sqrt());
        let root_mass: Vec<f64> = diagonal.collect();
        if root_mass.iter().any(|root| !root.is_finite() || *root <= 0.0) {
            return Err(OrbitError::SingularMass);
        }
        let mut scaled = Self {
            dofs: n,
            omega,
            size: 1.0,
            mass: weighed(&system.mass, &root_mass, 1.0),
            damping: weighed(&system.damping, &root_mass, omega),
            stiffness: weighed(&system.stiffness, &root_mass, omega * omega),
            damping_rate: Vec::new(),
            stiffness_rate: Vec::new(),
            root_mass,
            loads: Vec::new(),
            links: Vec::new(),
            sliders: Vec::new(),
            presses: Vec::new(),
            directions: Vec::new(),
        };
        let mass = Mat::from_fn(n, n, |i, j| scaled.mass.get(i * n + j).copied().unwrap_or(0.0));
        let inverse = mass.partial_piv_lu().inverse();
        let condition = mass.norm_l2() * inverse.norm_l2();
        if !condition.is_finite() || condition > SINGULAR {
            return Err(OrbitError::SingularMass);
        }
        scaled.damping_rate = product(&inverse, &scaled.damping);
        scaled.stiffness_rate = product(&inverse, &scaled.stiffness);
        scaled.add_loads(system, &inverse)?;
        scaled.add_contacts(system, &inverse)?;
        Ok(scaled)
    }

    fn add_loads(&mut self, system: &System, inverse: &Mat<f64>) -> Result<(), OrbitError> {
        let n = self.dofs;
        let mut harmonics: Vec<usize> = system.loads.iter().map(|load| load.harmonic).collect();
        harmonics.sort_unstable();
        harmonics.dedup();
        for harmonic in harmonics {
            let mut force = vec![Complex64::ZERO; n];
            for load in system.loads.iter().filter(|load| load.harmonic == harmonic) {
                if let (Some(sum), Some(root)) = (force.get_mut(load.dof), self.root_mass.get(load.dof)) {
                    let real_mean = Complex64::from(load.amplitude.re);
                    *sum +=
                        if harmonic == 0 { real_mean } else { load.amplitude } / (root * self.omega.powi(2));
                }
            }
            self.loads.push(HarmonicLoad { harmonic, force, acceleration: Vec::new() });
        }
        let moving = self.loads.iter().filter(|load| load.harmonic > 0);
        self.size = moving.flat_map(|load| &load.force).map(|force| force.norm()).fold(0.0, f64::max);
        if self.size <= 0.0 {
            return Err(OrbitError::NoExcitation);
        }
        for load in &mut self.loads {
            load.force.iter_mut().for_each(|force| *force /= self.size);
            load.acceleration = (0..n)
                .map(|i| load.force.iter().enumerate().map(|(j, f)| f * inverse[(i, j)]).sum())
                .collect();
        }
        Ok(())
    }

    /// Mirrored motions have mirrored forces: all laws are odd and all loads have odd harmonics.
    pub(crate) fn is_odd(&self) -> bool {
        let odd_law = |link: &Link| link.smooth.as_ref().is_none_or(|law| law.nature().odd);
        let at_rest = |load: &HarmonicLoad| load.force.iter().all(|force| force.norm() == 0.0);
        self.presses.is_empty()
            && self.links.iter().all(odd_law)
            && self.loads.iter().all(|load| load.harmonic % 2 == 1 || at_rest(load))
    }

    /// Presses with friction, with their numbers among all.
    pub(crate) fn frictions(&self) -> impl Iterator<Item = (usize, &Press, &Friction)> {
        self.presses
            .iter()
            .enumerate()
            .filter_map(|(index, press)| Some((index, press, press.friction.as_ref()?)))
    }

    /// One entry for every elongation of a tangential spring in a state: its friction and its link.
    pub(crate) fn pulls(&self) -> impl Iterator<Item = (&Friction, usize)> {
        self.frictions().flat_map(|(_, _, friction)| friction.links().map(move |link| (friction, link)))
    }

    /// Whether a contact has a smooth law: the motion is then integrated instead of followed by its events.
    pub(crate) fn is_smooth(&self) -> bool {
        self.links.iter().any(|link| link.smooth.is_some())
    }

    /// Unit of contact forces in N.
    pub(crate) fn force(&self) -> f64 {
        self.size * self.omega * self.omega
    }

    /// (φ, ∂φ/∂u, ∂φ/∂u') of a smooth contact.
    pub(crate) fn smooth(&self, link: &Link, u: f64, rate: f64) -> (f64, f64, f64) {
        let Some(Mechanism::Smooth(law)) = link.smooth.as_ref().map(|law| law.mechanism()) else {
            return (link.spring * u, link.spring, 0.0);
        };
        let (w, v) = (u * self.size, rate * self.size * self.omega);
        let (by_w, by_v) = law.slopes(w, v);
        let per_stiffness = link.scale / (self.omega * self.omega);
        (per_stiffness * law.at(w, v) / self.size, per_stiffness * by_w, link.scale * by_v / self.omega)
    }

    /// M̃⁻¹ times the loads' derivative of order `order` at phase τ, added to `sum`.
    pub(crate) fn add_load(&self, tau: f64, order: i32, factor: f64, sum: &mut [f64]) {
        for load in &self.loads {
            let h = load.harmonic as f64;
            if load.harmonic == 0 && order > 0 {
                continue;
            }
            let turn = Complex64::cis(h * tau) * Complex64::new(0.0, h).powi(order) * factor;
            for (sum, acceleration) in sum.iter_mut().zip(&load.acceleration) {
                *sum += (turn * acceleration).re;
            }
        }
    }
}

/// `matrix_ij / (root_i root_j unit)`, row by row.
fn weighed(matrix: &Mat<f64>, root: &[f64], unit: f64) -> Vec<f64> {
    let entry = |(i, ri): (usize, &f64)| -> Vec<f64> {
        root.iter().enumerate().map(|(j, rj)| matrix[(i, j)] / (ri * rj * unit)).collect()
    };
    root.iter().enumerate().flat_map(entry).collect()
}

/// `inverse · matrix`, row by row.
fn product(inverse: &Mat<f64>, matrix: &[f64]) -> Vec<f64> {
    let n = inverse.nrows();
    let right = Mat::from_fn(n, n, |i, j| matrix.get(i * n + j).copied().unwrap_or(0.0));
    let product = inverse * right;
    (0..n * n).map(|at| product[(at / n, at % n)]).collect()
}

/// `out += factor · matrix x` for a matrix given row by row.
pub(crate) fn add_product(matrix: &[f64], x: &[f64], factor: f64, out: &mut [f64]) {
    for (out, row) in out.iter_mut().zip(matrix.chunks_exact(x.len())) {
        *out += factor * row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
    }
}

/// Largest sum of magnitudes in a row.
pub(crate) fn row_norm(matrix: &[f64], columns: usize) -> f64 {
    matrix.chunks_exact(columns).map(|row| row.iter().map(|a| a.abs()).sum()).fold(0.0, f64::max)
}
