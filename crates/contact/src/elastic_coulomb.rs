//! Elastic Coulomb friction (Jenkins element): a spring in series with a slider that slips at a constant force.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::events::{ForcePiece, PiecewiseLinear, crossing};
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::masing::wrap;
use crate::mechanism::Mechanism;
use crate::path::{Path, Piece, SampledPath};
use crate::real::Real;
use crate::tangent::{Recall, Tangent};
use crate::turning_points::{angle_minus_sine, drop_from};

/// Parameters of [`ElasticCoulomb`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElasticCoulombParameters {
    /// k_t in N/m; positive.
    pub stiffness: f64,
    /// F_s in N; positive.
    pub slip_force: f64,
}

/// Spring k_t in series with a slider of slip force F_s,
///
/// ```math
/// f = k_t (w - s), \qquad |f| \le F_s, \qquad \dot s = 0 \text{ unless } |f| = F_s .
/// ```
///
/// Between turning points the displacement is monotone, so the force follows the spring until it reaches ±F_s and
/// stays there; at the next turning point the slider rests again. The global maximum of a period that slips at all
/// is reached slipping, which gives the periodic force in one pass. A contact that never slips is a spring whose
/// slider rests as close to the mean displacement as it can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticCoulomb {
    stiffness: f64,
    slip_force: f64,
}

/// Amplitudes so many slip displacements large measure what sticks from its turning point: k_t w would lose as many digits.
const CLOSE: f64 = 1e5;

/// Where the slider of a contact that sticks all period rests.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Slider {
    /// At the mean displacement.
    Mean,
    /// x_c below the maximum, dragged there by it.
    BelowTop,
    /// x_c above the minimum.
    AboveBottom,
}

impl ElasticCoulomb {
    /// The element of the given stiffness and slip force.
    ///
    /// # Errors
    /// [`ParameterError`] when one of them is not positive.
    pub fn new(parameters: ElasticCoulombParameters) -> Result<Self, ParameterError> {
        Ok(Self {
            stiffness: ParameterError::positive("stiffness", parameters.stiffness)?,
            slip_force: ParameterError::positive("slip_force", parameters.slip_force)?,
        })
    }

    /// k_t in N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// F_s in N.
    pub fn slip_force(&self) -> f64 {
        self.slip_force
    }

    /// x_c = F_s / k_t in m: amplitudes above it slip.
    pub fn slip_displacement(&self) -> f64 {
        self.slip_force / self.stiffness
    }

    /// The clamp of the mean into [w_M − x_c, w_m + x_c].
    fn slider(&self, mean: f64, top: f64, bottom: f64) -> Slider {
        if mean < top - self.slip_displacement() {
            Slider::BelowTop
        } else if mean > bottom + self.slip_displacement() {
            Slider::AboveBottom
        } else {
            Slider::Mean
        }
    }

    /// The force of a period that slips: k_t (w − w_r) + f_r, held to ±F_s. `sticking` receives the samples that do
    /// not slip, each piece with the turning point r at which the last slip ended.
    pub(crate) fn trace<T: Real>(&self, path: &impl Path<T>, force: &mut [T], sticking: &mut Vec<Piece>) {
        sticking.clear();
        let samples = force.len();
        // The spring is anchored where the last slip ended, at ±F_s.
        let mut anchor = 0;
        let mut anchored = self.slip_force;
        for r in 0..path.count() {
            let rising = r % 2 == 1;
            let limit = if rising { self.slip_force } else { -self.slip_force };
            let spring = |w: T| (w - path.tip(anchor)) * self.stiffness + T::from(anchored);
            let slips = |f: T| if rising { f.value() > limit } else { f.value() < limit };
            let (start, end) = (path.first_sample(r), path.first_sample(r + 1));
            let mut stick = 0;
            for j in start..end {
                let f = spring(path.sample(wrap(j, samples)));
                if slips(f) {
                    break;
                }
                set(force, wrap(j, samples), f);
                stick += 1;
            }
            let first = wrap(start, samples);
            if stick > 0 {
                sticking.push(Piece { owner: anchor, first, length: stick });
            }
            let slipping =
                Piece { owner: anchor, first: wrap(first + stick, samples), length: end - start - stick };
            slipping.for_each(force, |f| *f = T::from(limit));
            if slips(spring(path.tip(r + 1))) {
                anchor = r + 1;
                anchored = limit;
            }
        }
    }
}

fn set<T>(row: &mut [T], j: usize, x: T) {
    if let Some(slot) = row.get_mut(j) {
        *slot = x;
    }
}

impl Law for ElasticCoulomb {
    fn name(&self) -> &'static str {
        "elastic_coulomb"
    }

    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: false, linear: false, rate_dependent: false }
    }

    fn length(&self) -> Option<f64> {
        Some(self.slip_displacement())
    }

    fn stiffest(&self) -> Option<f64> {
        Some(self.stiffness)
    }

    fn force(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        let tips = &mut workspace.turning_points;
        workspace.pieces.clear();
        match tips.find(motion) {
            Err(LawError::NoMotion) => {
                force.fill(0.0);
                return Ok(Marks { extrapolated: false, state: ContactState::Stick });
            }
            found => found?,
        }
        if tips.amplitude() > self.slip_displacement() {
            self.trace(&SampledPath::new(motion, tips), force, &mut workspace.pieces);
            return Ok(Marks { extrapolated: false, state: ContactState::Mixed });
        }
        let path = SampledPath::new(motion, tips);
        let (mean, top, bottom) = (mean(motion), path.tip(0), path.tip(path.lowest()));
        let slider = match self.slider(mean, top, bottom) {
            Slider::Mean => mean,
            Slider::BelowTop => top - self.slip_displacement(),
            Slider::AboveBottom => bottom + self.slip_displacement(),
        };
        for (f, &w) in force.iter_mut().zip(motion.displacement) {
            *f = self.stiffness * (w - slider);
        }
        Ok(Marks { extrapolated: false, state: ContactState::Stick })
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        let Workspace { turning_points: tips, tangent, pieces, .. } = workspace;
        tangent.clear();
        let path = SampledPath::new(motion, tips);
        if tips.amplitude() > self.slip_displacement() {
            self.slipping_tangent(&path, motion.odd, pieces, tangent);
            return tangent;
        }
        tangent.local.fill(self.stiffness);
        if !motion.odd {
            let lowest = path.lowest();
            let recall = match self.slider(mean(motion), path.tip(0), path.tip(lowest)) {
                Slider::BelowTop => Recall::Displacement { tau: path.point(0).tau },
                Slider::AboveBottom => Recall::Displacement { tau: path.point(lowest).tau },
                Slider::Mean => Recall::Mean,
            };
            tangent.remember(recall).1.fill(-self.stiffness);
        }
        tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    fn piecewise_linear(&self) -> Option<&dyn PiecewiseLinear> {
        Some(self)
    }

    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Sliders { sliders: std::slice::from_ref(self), spring: 0.0 }
    }
}

impl ElasticCoulomb {
    /// κ = k_t while sticking, and −k_t from the turning point at which the last slip ended.
    fn slipping_tangent(&self, path: &SampledPath, odd: bool, pieces: &[Piece], tangent: &mut Tangent) {
        let count = path.count();
        for piece in pieces {
            piece.for_each(&mut tangent.local, |kappa| *kappa = self.stiffness);
        }
        // In odd motion δw(τ + π) = −δw(τ): opposite turning points share one memory.
        let distinct = if odd { count / 2 } else { count };
        for r in 0..distinct {
            if !pieces.iter().any(|piece| piece.owner % distinct == r) {
                continue;
            }
            let (_, influence) = tangent.remember(Recall::Displacement { tau: path.point(r).tau });
            for piece in pieces.iter().filter(|piece| piece.owner % distinct == r) {
                let mirrored = odd && (piece.owner / distinct) % 2 == 1;
                let strength = if mirrored { self.stiffness } else { -self.stiffness };
                piece.for_each(influence, |s| *s = strength);
            }
        }
    }
}

/// W_0 in m.
fn mean(motion: &Motion) -> f64 {
    motion.spectrum.first().map_or(0.0, |mean| mean.re)
}

impl PiecewiseLinear for ElasticCoulomb {
    /// Slip of sign s ends at a turning point. The next one begins where the spring force, counted from there, reaches
    /// ±F_s: −s after 2 x_c, or s again when the displacement comes back to the turning point.
    fn pieces(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        pieces: &mut Vec<ForcePiece>,
    ) -> Result<Marks, LawError> {
        let tips = &mut workspace.turning_points;
        pieces.clear();
        match tips.find(motion) {
            Err(LawError::NoMotion) => return Ok(self.marks(0.0)),
            found => found?,
        }
        let (k, xc) = (self.stiffness, self.slip_displacement());
        let path = SampledPath::new(motion, tips);
        let count = path.count();
        if tips.amplitude() <= xc {
            let (mean, lowest) = (mean(motion), path.lowest());
            let (slider, recall) = match self.slider(mean, path.tip(0), path.tip(lowest)) {
                Slider::Mean => (mean, Recall::Mean),
                Slider::BelowTop => (path.tip(0) - xc, Recall::Displacement { tau: path.point(0).tau }),
                Slider::AboveBottom => {
                    (path.tip(lowest) + xc, Recall::Displacement { tau: path.point(lowest).tau })
                }
            };
            let memory = (!motion.odd).then_some((recall, -k));
            pieces.push(ForcePiece {
                from: 0.0,
                to: if motion.odd { PI } else { TAU },
                stiffness: k,
                offset: -k * slider,
                start_force: k * (path.tip(0) - slider),
                close: false,
                memory,
            });
            return Ok(self.marks(tips.amplitude()));
        }
        let distinct = if motion.odd { count / 2 } else { count };
        let (mut anchor, mut anchored) = (0, self.slip_force);
        let close = tips.amplitude() > CLOSE * xc;
        let mut start_force = self.slip_force;
        for r in 0..distinct {
            let limit = if r % 2 == 1 { self.slip_force } else { -self.slip_force };
            let (start, mut end) = (path.point(r), path.point(r + 1));
            if r + 1 == count {
                end.tau += TAU;
            }
            let offset = anchored - k * path.tip(anchor);
            let way = if close {
                -drop_from(motion.spectrum, start.tau, end.tau - start.tau)
            } else {
                end.displacement - start.displacement
            };
            let end_force = if close { start_force + k * way } else { k * end.displacement + offset };
            let slips = (end_force - limit) * limit > 0.0;
            let onset = if slips {
                crossing(motion.spectrum, start, end, ((limit - start_force) / k, way), close)
            } else {
                end.tau
            };
            let memory = Some((Recall::Displacement { tau: path.point(anchor).tau }, -k));
            pieces.push(ForcePiece {
                from: start.tau,
                to: onset,
                stiffness: k,
                offset,
                start_force,
                close,
                memory,
            });
            start_force = end_force;
            if slips {
                pieces.push(ForcePiece {
                    from: onset,
                    to: end.tau,
                    stiffness: 0.0,
                    offset: limit,
                    start_force: limit,
                    close: false,
                    memory: None,
                });
                (anchor, anchored, start_force) = (r + 1, limit, limit);
            }
        }
        Ok(self.marks(tips.amplitude()))
    }
}

impl DescribingFunction for ElasticCoulomb {
    /// With θ* = arccos(1 − 2 x_c/A) for A > x_c:
    /// in phase `(k_t/π)(θ* − ½ sin 2θ*)`, quadrature `(4 F_s/(πA))(1 − x_c/A)`, times A.
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        let (k, xc) = (self.stiffness, self.slip_displacement());
        if a <= xc {
            return FirstHarmonic { force: Complex64::from(k * a), derivative: Complex64::from(k) };
        }
        let (part, rest) = (xc / a, 1.0 - xc / a);
        // Beside x_c, where θ* is nearly π, what is missing from π is known to more digits.
        let theta = if part > 0.5 { PI - 2.0 * rest.sqrt().asin() } else { 2.0 * part.sqrt().asin() };
        let sine = 2.0 * (part * rest).sqrt();
        // 2θ − sin 2θ
        let lens =
            if theta > 0.25 { 2.0 * (theta - sine * (rest - part)) } else { angle_minus_sine(2.0 * theta) };
        let in_phase = k / PI * 0.5 * lens;
        let damping = 4.0 * self.slip_force / PI;
        FirstHarmonic {
            force: Complex64::new(a * in_phase, damping * rest),
            derivative: Complex64::new(in_phase - 4.0 * k * part / PI * sine, damping * part / a),
        }
    }

    /// A force within ±F_s has no harmonic above that of the rectangle.
    fn largest(&self, a: f64) -> Option<f64> {
        let (k, xc) = (self.stiffness, self.slip_displacement());
        Some(if a <= xc { k * a } else { 4.0 * self.slip_force / PI })
    }

    fn spring_up_to(&self) -> Option<f64> {
        Some(self.slip_displacement())
    }

    fn marks(&self, a: f64) -> Marks {
        let slips = a > self.slip_displacement();
        Marks { extrapolated: false, state: if slips { ContactState::Mixed } else { ContactState::Stick } }
    }

    fn landmark(&self) -> Option<f64> {
        Some(self.slip_displacement())
    }
}
