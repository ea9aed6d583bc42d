//! Reproducible random numbers of one case, and the parts that cases are made of.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use contact::{MagnitudeLaw, PhaseLaw};
use hbm::{Excitation, ExcitationKind};
use num_complex::Complex64;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::law::LawSpec;

/// Kinds of laws, as a scene names them.
pub(super) const KINDS: [&str; 8] =
    ["scaled_loop", "elastic_coulomb", "iwan", "iwan_polygon", "loop_family", "cubic", "coulomb", "linear"];

/// The source of all that is random in a case.
pub(super) struct Draw {
    rng: ChaCha8Rng,
}

impl Draw {
    /// Of case `index` of family number `family`, whatever else is run.
    pub(super) fn new(seed: u64, family: usize, index: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream((family as u64) << 32 | index as u64);
        Self { rng }
    }

    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.rng.random_range(0.0..1.0)
    }

    /// 10^x, x uniform.
    pub(super) fn decades(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.uniform(low, high))
    }

    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    pub(super) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.rng.random_range(0..from.len())]
    }

    /// Mostly one harmonic, or few.
    pub(super) fn harmonics(&mut self) -> usize {
        self.pick(&[1, 1, 1, 1, 1, 3, 3, 3, 5, 7, 7, 15])
    }

    /// cos-force on `dof`.
    pub(super) fn force(&mut self, dof: usize, harmonic: usize, amplitude: f64) -> Excitation {
        let phase = if self.chance(0.5) { 0.0 } else { self.uniform(-PI, PI) };
        Excitation { dof, harmonic, amplitude, phase, kind: ExcitationKind::Force }
    }

    /// A law of secant stiffness about `stiffness` at the force `force`; `omega` turns lengths into velocities.
    pub(super) fn law(&mut self, kind: &str, stiffness: f64, force: f64, omega: f64) -> LawSpec {
        let displacement = force / stiffness;
        match kind {
            "elastic_coulomb" => LawSpec::ElasticCoulomb { stiffness, slip_force: force },
            "iwan" => LawSpec::IwanSmooth { displacement, force, range: self.pick(&[1.0, 10.0, 1e3]) },
            "iwan_polygon" => {
                let last = if self.chance(0.5) { 0.0 } else { 0.02 };
                let mut point = [0.0, 0.0];
                let mut backbone = Vec::new();
                for (way, slope) in [(0.2, 2.0), (0.5, 1.0), (2.0, 0.3), (3.0, last)] {
                    point = [point[0] + way * displacement, point[1] + way * slope * force];
                    backbone.push(point);
                }
                if last == 0.0 {
                    backbone[3][1] = backbone[2][1];
                }
                LawSpec::IwanPolygon { backbone }
            }
            "loop_family" => {
                let loops = [0.1, 0.4, 1.0].map(|alpha| {
                    let g = MagnitudeLaw::default().value(alpha);
                    let turn = PI + PhaseLaw::default().value(alpha);
                    let first = Complex64::from_polar(force * g, turn);
                    let third = Complex64::new(0.05, 0.1) * (force * g * alpha);
                    (alpha * displacement, vec![Complex64::ZERO, first, Complex64::ZERO, third])
                });
                LawSpec::LoopFamily { loops: loops.to_vec() }
            }
            "cubic" => LawSpec::Cubic { stiffness: stiffness / (displacement * displacement) },
            "coulomb" => LawSpec::Coulomb { slip_force: force, velocity: displacement * omega },
            "linear" => LawSpec::Linear { stiffness },
            _ => LawSpec::ScaledLoop {
                displacement,
                series: self.loop_series(force),
                magnitude: MagnitudeLaw::default(),
                phase: PhaseLaw::default(),
            },
        }
    }

    /// An ellipse, or a loop with odd harmonics whose half-width stays positive: Σ k |Im c_k| of the higher ones stays
    /// below Im c_1, and so does Σ Im c_k sin kθ above zero, as |sin kθ| ≤ k sin θ.
    pub(super) fn loop_series(&mut self, force: f64) -> Vec<Complex64> {
        let first = Complex64::from_polar(force, PI - FRAC_PI_2 - 7.0 / 15.0 * PI * (-4.0_f64).exp());
        let mut series = vec![Complex64::ZERO, first];
        if self.chance(0.5) {
            for k in 2..=9 {
                let size = 0.2 * force / f64::from(k * k);
                let odd = k % 2 == 1;
                let turn = Complex64::from_polar(size, self.uniform(0.0, TAU));
                series.push(if odd { turn } else { Complex64::ZERO });
            }
        }
        series
    }
}
