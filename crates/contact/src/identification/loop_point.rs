//! What one measured loop contributes: amplitude, forces, phase, and their noise.

use std::cmp::Ordering;
use std::f64::consts::PI;

use hysteresis::{Fit, Loop, TurningPoint};

use super::{IdentificationError, Magnitude, Weighting};

/// One loop as a point of the scaling laws, in rig convention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopPoint {
    /// Displacement amplitude \[m\], half peak-to-peak; positive.
    pub displacement: f64,
    /// Half the difference of the force at the upper and the lower turning point \[N\]; positive.
    pub turning_point_force: f64,
    /// Magnitude of the first harmonic, |F_1| \[N\]; positive.
    pub first_harmonic: f64,
    /// Phase of the first harmonic, arg F_1 \[rad\], between 0 (a spring) and π.
    pub phase: f64,
    /// Standard errors, where they are known.
    pub noise: Option<PointNoise>,
}

/// Standard errors of a loop's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointNoise {
    /// Of the displacement amplitude \[m\]; 0 where it is negligible or unknown.
    pub displacement: f64,
    /// Of the force at the turning points \[N\].
    pub turning_point_force: f64,
    /// Of |F_1| \[N\].
    pub first_harmonic: f64,
    /// Of arg F_1 \[rad\].
    pub phase: f64,
}

impl From<&Loop> for LoopPoint {
    /// The point of a loop of unknown noise.
    fn from(measured: &Loop) -> Self {
        Self {
            displacement: measured.displacement_amplitude(),
            turning_point_force: 0.5 * (measured.force(0.0) - measured.force(PI)),
            first_harmonic: measured.force_amplitude(),
            phase: measured.phase(),
            noise: None,
        }
    }
}

impl From<&Fit> for LoopPoint {
    /// The point of a fitted record. A harmonic whose complex amplitude has the standard error σ_k has σ_k/√2 in
    /// each direction: so |F_1|, and arg F_1 times |F_1|; the force at the turning points is the sum of the real
    /// parts of the odd harmonics. The amplitude's error is that of a mean of turning points that scatter.
    fn from(fit: &Fit) -> Self {
        let measured = &fit.hysteresis_loop;
        let variance = |k: usize| fit.harmonic_noise.get(k).map_or(0.0, |error| 0.5 * error * error);
        let first = variance(1).sqrt();
        let tips: f64 = fit.kept_harmonics().filter(|k| k % 2 == 1).map(variance).sum();
        let noise = PointNoise {
            displacement: amplitude_error(&fit.turning_points),
            turning_point_force: tips.sqrt(),
            first_harmonic: first,
            phase: first / measured.force_amplitude(),
        };
        Self { noise: Some(noise), ..Self::from(measured) }
    }
}

/// Standard error of half the distance between the means of the upper and of the lower turning points \[m\]; 0
/// for a single cycle. The turning points' variance is half that of the ways between them, taken for each
/// direction alone, so that a drift does not count.
fn amplitude_error(points: &[TurningPoint]) -> f64 {
    let ways = |down: bool| {
        let pairs = points.windows(2).filter_map(move |pair| match pair {
            [from, to] if from.upper == down => Some((from.displacement - to.displacement).abs()),
            _ => None,
        });
        pairs.collect::<Vec<_>>()
    };
    let deviations = |ways: &[f64]| -> f64 {
        let mean = ways.iter().sum::<f64>() / ways.len().max(1) as f64;
        ways.iter().map(|way| (way - mean).powi(2)).sum()
    };
    let (down, up) = (ways(true), ways(false));
    let freedom = down.len().saturating_sub(1) + up.len().saturating_sub(1);
    let variance = 0.5 * (deviations(&down) + deviations(&up)) / freedom.max(1) as f64;
    let upper = points.iter().filter(|point| point.upper).count().max(1) as f64;
    let lower = points.iter().filter(|point| !point.upper).count().max(1) as f64;
    0.5 * (variance * (1.0 / upper + 1.0 / lower)).sqrt()
}

impl PointNoise {
    /// Of the force that eq. (6) is fitted to \[N\].
    pub(super) fn force(&self, kind: Magnitude) -> f64 {
        match kind {
            Magnitude::TurningPoints => self.turning_point_force,
            Magnitude::FirstHarmonic => self.first_harmonic,
        }
    }
}

impl LoopPoint {
    /// ψ_C \[rad\]: the phase of the force on the mass, which is the rig's turned round; between −π and 0.
    #[must_use]
    pub fn law_phase(&self) -> f64 {
        self.phase - PI
    }

    /// The force that eq. (6) is fitted to \[N\].
    pub(super) fn force(&self, kind: Magnitude) -> f64 {
        match kind {
            Magnitude::TurningPoints => self.turning_point_force,
            Magnitude::FirstHarmonic => self.first_harmonic,
        }
    }

    /// By amplitude; among equals by everything else, so that the order is the same whatever it was before.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let key = |p: &Self| [p.displacement, p.turning_point_force, p.first_harmonic, p.phase];
        let pairs = key(self).into_iter().zip(key(other));
        pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }

    pub(super) fn check(&self, index: usize, weighting: Weighting) -> Result<(), IdentificationError> {
        let positive = "positive and finite";
        for (quantity, value) in [
            ("displacement amplitude", self.displacement),
            ("force at the turning points", self.turning_point_force),
            ("first harmonic", self.first_harmonic),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(IdentificationError::BadLoop { index, quantity, must: positive, value });
            }
        }
        if !(0.0..=PI).contains(&self.phase) {
            let (must, value) = ("between 0 and π (else the loop creates energy)", self.phase);
            return Err(IdentificationError::BadLoop { index, quantity: "phase", must, value });
        }
        let known = |noise: &PointNoise| {
            [noise.turning_point_force, noise.first_harmonic, noise.phase]
                .iter()
                .all(|error| *error > 0.0 && error.is_finite())
                && noise.displacement >= 0.0
                && noise.displacement.is_finite()
        };
        if weighting == Weighting::Noise && !self.noise.as_ref().is_some_and(known) {
            return Err(IdentificationError::UnknownNoise { index });
        }
        Ok(())
    }
}
