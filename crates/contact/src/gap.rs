//! A gap: a spring that presses once it is closed and never pulls.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, ParameterError};
use crate::events::{ForcePiece, PiecewiseLinear, crossing};
use crate::law::{ContactState, Law, Marks, Motion, Nature, Workspace};
use crate::mechanism::{Mechanism, UnilateralSpring};
use crate::tangent::Tangent;
use crate::turning_points::{TurningPoint, TurningPoints};

/// Parameters of [`Gap`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GapParameters {
    /// k in N/m; positive.
    pub stiffness: f64,
    /// g in m: the displacement at which the bodies touch; negative where they interfere.
    pub gap: f64,
}

/// The spring $`f = k \max(w - g, 0)`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    stiffness: f64,
    gap: f64,
}

impl Gap {
    /// The spring of the given stiffness behind the given gap.
    ///
    /// # Errors
    /// [`ParameterError`] when the stiffness is not positive or the gap not finite.
    pub fn new(parameters: GapParameters) -> Result<Self, ParameterError> {
        Ok(Self {
            stiffness: ParameterError::positive("stiffness", parameters.stiffness)?,
            gap: ParameterError::finite("gap", parameters.gap)?,
        })
    }

    fn marks(touches: bool, always: bool) -> Marks {
        let state = match (touches, always) {
            (false, _) => ContactState::Apart,
            (_, true) => ContactState::Stick,
            _ => ContactState::Mixed,
        };
        Marks { extrapolated: false, state }
    }
}

impl Law for Gap {
    fn name(&self) -> &'static str {
        "gap"
    }

    fn nature(&self) -> Nature {
        Nature { odd: false, determines_mean: true, linear: false, rate_dependent: false }
    }

    /// |g|; a gap of zero has no length.
    fn length(&self) -> Option<f64> {
        (self.gap != 0.0).then_some(self.gap.abs())
    }

    /// That of the closed gap, its upper bound: what is met depends on the mean displacement.
    fn secant_stiffness(&self, _a: f64) -> f64 {
        self.stiffness
    }

    fn stiffest(&self) -> Option<f64> {
        Some(self.stiffness)
    }

    fn force(
        &self,
        motion: &Motion,
        _workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        for (f, &w) in force.iter_mut().zip(motion.displacement) {
            *f = self.stiffness * (w - self.gap).max(0.0);
        }
        let closed = |w: &f64| *w > self.gap;
        Ok(Self::marks(motion.displacement.iter().any(closed), motion.displacement.iter().all(closed)))
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        workspace.tangent.clear();
        for (kappa, &w) in workspace.tangent.local.iter_mut().zip(motion.displacement) {
            *kappa = if w > self.gap { self.stiffness } else { 0.0 };
        }
        &workspace.tangent
    }

    fn piecewise_linear(&self) -> Option<&dyn PiecewiseLinear> {
        Some(self)
    }

    fn mechanism(&self) -> Mechanism<'_> {
        Mechanism::Unilateral(UnilateralSpring {
            stiffness: self.stiffness,
            pressure_at_zero: -self.stiffness * self.gap,
            balanced: 0.0,
        })
    }
}

impl PiecewiseLinear for Gap {
    /// Closed from where the displacement rises through g until it falls through it. A period begins at the global
    /// maximum, in contact if there is any.
    fn pieces(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        pieces: &mut Vec<ForcePiece>,
    ) -> Result<Marks, LawError> {
        pieces.clear();
        let closed = |from: f64, to: f64| ForcePiece {
            from,
            to,
            stiffness: self.stiffness,
            offset: -self.stiffness * self.gap,
            start_force: 0.0,
            close: false,
            memory: None,
        };
        let tips = &mut workspace.turning_points;
        match tips.find(motion) {
            Err(LawError::NoMotion) => {
                let touches = motion.spectrum.first().is_some_and(|mean| mean.re > self.gap);
                pieces.extend(touches.then(|| closed(0.0, TAU)));
                return Ok(Self::marks(touches, touches));
            }
            found => found?,
        }
        let always =
            closed_stretches(motion.spectrum, tips, self.gap, |from, to| pieces.push(closed(from, to)));
        Ok(Self::marks(!pieces.is_empty(), always))
    }
}

/// Calls `visit` with the phases between which the displacement lies above `level`, in the order of time from the global
/// maximum; the last stretch may be the one that the period began in. Whether it lies there always.
pub(crate) fn closed_stretches(
    spectrum: &[Complex64],
    tips: &TurningPoints,
    level: f64,
    mut visit: impl FnMut(f64, f64),
) -> bool {
    let points = tips.points();
    let (Some(top), Some(bottom)) = (points.first(), points.get(tips.lowest())) else { return false };
    if top.displacement <= level {
        return false;
    }
    if bottom.displacement >= level {
        visit(0.0, TAU);
        return true;
    }
    let again = TurningPoint { tau: top.tau + TAU, ..*top };
    let ends = points.iter().skip(1).chain(std::iter::once(&again));
    let (mut first_end, mut begin) = (0.0, None);
    for (start, end) in points.iter().zip(ends) {
        let (from, to) = (start.displacement, end.displacement);
        if (from > level) == (to > level) {
            continue;
        }
        let tau = crossing(spectrum, *start, *end, (level - from, to - from), false);
        if to > level {
            begin = Some(tau);
        } else if let Some(begin) = begin.take() {
            visit(begin, tau);
        } else {
            first_end = tau;
        }
    }
    // The contact at the end of the period is the one that it began with.
    if let Some(begin) = begin {
        visit(begin, first_end + TAU);
    }
    false
}
