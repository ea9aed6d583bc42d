//! A periodic orbit and what can be read off it.

use num_complex::Complex64;

use crate::path::{Along, Path, Piece, force, force_rate, relative_velocity};
use crate::polynomial::{derivative, sign_changes, value};
use crate::quadrature::gauss_legendre;
use crate::scaled::{Scaled, add_product};
use crate::settings::{Event, EventKind, State};
use crate::spectrum::{NODES, displacement_coefficients, force_coefficients};

/// An exact periodic orbit.
#[derive(Debug, Clone)]
pub struct Orbit {
    pub(crate) system: Scaled,
    /// One period.
    pub(crate) path: Path,
    pub(crate) events: Vec<Event>,
    pub(crate) state: Vec<f64>,
    pub(crate) closure: f64,
    pub(crate) iterations: usize,
    pub(crate) periods: usize,
    /// Relative local error of the integrator.
    pub(crate) tolerance: f64,
}

impl Orbit {
    /// T in s.
    pub fn period(&self) -> f64 {
        std::f64::consts::TAU / self.system.omega
    }

    /// Largest difference between the two ends of the period, relative to the orbit's size.
    pub fn closure(&self) -> f64 {
        self.closure
    }

    /// |work of the loads − energy dissipated by contacts and damping| over a period, relative to the larger, or to a
    /// thousandth of what loads and structure exchange back and forth where hardly anything is dissipated.
    pub fn energy_error(&self) -> f64 {
        let (supplied, viscous, exchanged) = work(&self.system, &self.path);
        let links = (0..self.system.links.len()).map(|c| dissipation(&self.system, &self.path, c));
        let dissipated = viscous + links.sum::<f64>();
        let size = supplied.abs().max(dissipated.abs()).max(1e-3 * exchanged);
        if size > 0.0 { (supplied - dissipated).abs() / size } else { 0.0 }
    }

    /// Steps of Newton's method, all attempts together.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Periods that were followed before Newton's method succeeded.
    pub fn settled_periods(&self) -> usize {
        self.periods
    }

    /// Events of one period in order of time; empty for smooth systems.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// (contact, slider) of every slider that never slips. Its rest position, and with it the mean, is not determined
    /// by periodicity: it is the place nearest to the mean displacement at which it does not slip, as of the contact laws.
    pub fn locked_sliders(&self) -> Vec<(usize, usize)> {
        let contacts = self.system.links.iter().enumerate();
        let sliders = contacts.flat_map(|(c, link)| (0..link.sliders.len()).map(move |slider| (c, slider)));
        // Without events it sticks, slips (in a plane) or is apart all the time; a slip that goes on from the period before is
        // begun anew within rounding.
        let sticks = |link: usize| {
            let stiff =
                |piece: &Piece| piece.elastic.get(link).is_some_and(|elastic| elastic.stiffness > 0.0);
            self.path.pieces.iter().all(stiff)
        };
        let frictions = self.system.frictions().filter(|(_, _, friction)| sticks(friction.link));
        sliders
            .chain(frictions.map(|(_, press, _)| (press.contact, 0)))
            .filter(|&(c, slider)| {
                !self.events.iter().any(|event| (event.contact, event.slider) == (c, slider))
            })
            .collect()
    }

    /// Displacement of a dof in m at instant `t` in s; zero for a dof that does not exist.
    pub fn displacement(&self, dof: usize, t: f64) -> f64 {
        let found = self.path.at(self.phase(t));
        found.map_or(0.0, |(piece, s)| self.length(dof) * value(&piece.polynomial(dof, self.system.dofs), s))
    }

    /// Velocity of a dof in m/s.
    pub fn velocity(&self, dof: usize, t: f64) -> f64 {
        self.path.at(self.phase(t)).map_or(0.0, |(piece, s)| {
            let slope = derivative(&piece.polynomial(dof, self.system.dofs));
            self.length(dof) * self.system.omega * value(&slope, s) / piece.length
        })
    }

    /// Force of a contact on its first body in N.
    pub fn contact_force(&self, contact: usize, t: f64) -> f64 {
        let found = self.path.at(self.phase(t));
        found.map_or(0.0, |(piece, s)| -self.system.force() * force(&self.system, piece, contact)(s))
    }

    /// `W_0 … W_highest` of a dof in m, one-sided.
    pub fn spectrum(&self, dof: usize, highest: usize) -> Vec<Complex64> {
        let coefficients = displacement_coefficients(&self.system, &self.path, dof, highest);
        coefficients.into_iter().map(|(value, _)| value * self.length(dof)).collect()
    }

    /// `F_0 … F_highest` of a contact's force on its first body in N, one-sided.
    pub fn force_spectrum(&self, contact: usize, highest: usize) -> Vec<Complex64> {
        let coefficients = force_coefficients(&self.system, &self.path, contact, highest);
        coefficients.into_iter().map(|(value, _)| -value * self.system.force()).collect()
    }

    /// `√(Σ_k |W_k|²)` of a dof in m over all harmonics, from the mean square (the mean counts fully).
    pub fn norm(&self, dof: usize) -> f64 {
        // Parseval: ⟨w²⟩ = W_0² + ½ Σ_{k≥1} |W_k|²
        let over_period = |power: i32| {
            let y = |piece: &Piece| -> Along {
                let y = piece.polynomial(dof, self.system.dofs);
                Box::new(move |s| value(&y, s).powi(power))
            };
            integrate(&self.path, y) / std::f64::consts::TAU
        };
        let mean = over_period(1);
        self.length(dof) * (2.0 * over_period(2) - mean * mean).max(0.0).sqrt()
    }

    /// Smallest and largest displacement of a dof in m.
    pub fn range(&self, dof: usize) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut roots = Vec::new();
        for piece in &self.path.pieces {
            let y = piece.polynomial(dof, self.system.dofs);
            roots.clear();
            sign_changes(&derivative(&y), &mut roots);
            for s in roots.iter().copied().chain([0.0]) {
                let at = value(&y, s);
                (low, high) = (low.min(at), high.max(at));
            }
        }
        (self.length(dof) * low, self.length(dof) * high)
    }

    /// Energy in J that a contact dissipates in a period; exactly zero where no slider of it moves.
    pub fn dissipation(&self, contact: usize) -> f64 {
        let smooth = self.system.links.get(contact).is_some_and(|link| link.smooth.is_some());
        let slips = self.events.iter().any(|event| event.contact == contact && event.kind == EventKind::Slip);
        if !smooth && !slips {
            return 0.0;
        }
        dissipation(&self.system, &self.path, contact) * self.system.force() * self.system.size
    }

    /// The state at t = 0.
    pub fn state(&self) -> State {
        let n = self.system.dofs;
        let scaled = |from: usize, unit: f64| -> Vec<f64> {
            let entries = self.state.iter().skip(from).take(n).zip(&self.system.root_mass);
            entries.map(|(x, root)| x * unit / root).collect()
        };
        let forces = self.state.iter().skip(2 * n).zip(&self.system.sliders);
        let pulls = self.state.iter().skip(2 * n + self.system.sliders.len()).zip(self.system.pulls());
        State {
            displacement: scaled(0, self.system.size),
            velocity: scaled(n, self.system.size * self.system.omega),
            sliders: forces
                .map(|(force, slider)| force * slider.limit * self.system.force())
                .chain(pulls.map(|(pull, (friction, _))| pull * friction.stiffness * self.system.force()))
                .collect(),
        }
    }

    pub(crate) fn phase(&self, t: f64) -> f64 {
        (t * self.system.omega).rem_euclid(std::f64::consts::TAU)
    }

    /// Metres of a unit of y.
    fn length(&self, dof: usize) -> f64 {
        self.system.root_mass.get(dof).map_or(0.0, |root| self.system.size / root)
    }
}

/// `∮ x dτ`.
fn integrate<'a>(path: &Path, x: impl Fn(&Piece) -> Along<'a>) -> f64 {
    let rule = gauss_legendre(NODES);
    let over_piece = |piece: &Piece| {
        let x = x(piece);
        rule.iter().map(|(s, weight)| weight * x(*s)).sum::<f64>() * piece.length
    };
    path.pieces.iter().map(over_piece).sum()
}

/// `∮ φ du`.
pub(crate) fn dissipation(system: &Scaled, path: &Path, contact: usize) -> f64 {
    integrate(path, |piece| {
        let (force, rate) = (force(system, piece, contact), relative_velocity(system, piece, contact));
        Box::new(move |s| force(s) * rate(s))
    })
}

/// `∮ φ ds` of a slider at s = u − φ/k_t: stretches on which it sticks count for nothing.
pub(crate) fn slider_work(system: &Scaled, path: &Path, link: usize, stiffness: f64) -> f64 {
    integrate(path, |piece| {
        if piece.elastic.get(link).is_some_and(|elastic| elastic.stiffness > 0.0) {
            return Box::new(|_| 0.0);
        }
        let (force, rate) = (force(system, piece, link), force_rate(system, piece, link));
        let body = relative_velocity(system, piece, link);
        Box::new(move |s| force(s) * (body(s) - rate(s) / stiffness))
    })
}

/// Energies of a period: supplied by the loads, dissipated by viscous damping, ∮ |power of the loads|.
fn work(system: &Scaled, path: &Path) -> (f64, f64, f64) {
    let n = system.dofs;
    let (mut supplied, mut viscous, mut exchanged, mut v, mut damping) =
        (0.0, 0.0, 0.0, vec![0.0; n], vec![0.0; n]);
    let rule = gauss_legendre(NODES);
    for piece in &path.pieces {
        for (s, weight) in &rule {
            let (tau, weight) = (piece.start + s * piece.length, weight * piece.length);
            piece.state(*s, 1, &mut v);
            let mut power = 0.0;
            for load in &system.loads {
                let turn = Complex64::cis(load.harmonic as f64 * tau);
                power += load.force.iter().zip(&v).map(|(force, v)| (force * turn).re * v).sum::<f64>();
            }
            supplied += weight * power;
            exchanged += weight * power.abs();
            damping.fill(0.0);
            add_product(&system.damping, &v, weight, &mut damping);
            viscous += damping.iter().zip(&v).map(|(d, v)| d * v).sum::<f64>();
        }
    }
    (supplied, viscous, exchanged)
}
