//! What can be read off an orbit about its joints.

use num_complex::Complex64;

use crate::links::Press;
use crate::orbit::{Orbit, slider_work};
use crate::path::force;
use crate::polynomial::value;
use crate::spectrum::force_coefficients;

impl Orbit {
    /// Relative displacement first − second of a joint along one of its directions in m at instant `t` in s; zero for one
    /// that does not exist.
    pub fn joint_displacement(&self, joint: usize, direction: usize, t: f64) -> f64 {
        let (link, place) = (self.joint_link(joint, direction), self.path.at(self.phase(t)));
        let found = link.and_then(|link| Some((self.system.links.get(link)?, place?)));
        found.map_or(0.0, |(link, (piece, s))| {
            self.system.size * value(&piece.relative(link, self.system.dofs), s)
        })
    }

    /// Force of a joint on its first body along one of its directions in N; without the part of a preload that is in
    /// equilibrium at rest.
    pub fn joint_force(&self, joint: usize, direction: usize, t: f64) -> f64 {
        let (link, place) = (self.joint_link(joint, direction), self.path.at(self.phase(t)));
        link.zip(place)
            .map_or(0.0, |(link, (piece, s))| -self.system.force() * force(&self.system, piece, link)(s))
    }

    /// `F_0 … F_highest` of [`Orbit::joint_force`] in N, one-sided.
    pub fn joint_force_spectrum(&self, joint: usize, direction: usize, highest: usize) -> Vec<Complex64> {
        let Some(link) = self.joint_link(joint, direction) else { return Vec::new() };
        let coefficients = force_coefficients(&self.system, &self.path, link, highest);
        coefficients.into_iter().map(|(value, _)| -value * self.system.force()).collect()
    }

    /// Contact pressure N ≥ 0 of a joint in N, with its preload.
    pub fn joint_pressure(&self, joint: usize, t: f64) -> f64 {
        let Some(directions) = self.system.directions.get(joint) else { return 0.0 };
        let own = |press: &&Press| directions.contains(&press.normal);
        let balanced = self.system.presses.iter().find(own).map_or(0.0, |press| press.balanced);
        let last = directions.len().saturating_sub(1);
        self.system.force() * balanced - self.joint_force(joint, last, t)
    }

    /// Energy in J that a joint dissipates in a period: the work of friction on its slider, exactly zero where that never moves.
    pub fn joint_dissipation(&self, joint: usize) -> f64 {
        let Some(directions) = self.system.directions.get(joint) else { return 0.0 };
        let own = |press: &&Press| directions.contains(&press.normal);
        let friction = self.system.presses.iter().find(own).and_then(|press| press.friction);
        let work = friction.iter().flat_map(|friction| {
            friction.links().map(|link| slider_work(&self.system, &self.path, link, friction.stiffness))
        });
        work.sum::<f64>() * self.system.force() * self.system.size
    }

    fn joint_link(&self, joint: usize, direction: usize) -> Option<usize> {
        self.system.directions.get(joint)?.clone().nth(direction)
    }
}
