//! A friction slider between its two edges by events: where it is pushed and where it rests, from the spectra.
//!
//! The slider s lies between the edges `w − ρ` and `w + ρ`, trigonometric polynomials while the bodies touch. It rests until an
//! edge comes back to it, is pushed until that edge turns round, and rests there: events are turning points of the edges and
//! crossings of a level on their monotone legs.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::error::LawError;
use crate::events::crossing;
use crate::law::Motion;
use crate::turning_points::{TurningPoint, TurningPoints};

/// Which edge: the lower one pushes up, the upper one down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Lower,
    Upper,
}

impl Side {
    /// Sign of the force while this edge pushes, and of the way of the slider.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Lower => 1.0,
            Self::Upper => -1.0,
        }
    }
}

/// An edge of the slider's room; buffers are reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct Edge {
    spectrum: Vec<Complex64>,
    velocity: Vec<f64>,
    tips: TurningPoints,
}

impl Edge {
    /// The edge with this spectrum in m and these velocity samples.
    pub(crate) fn set(
        &mut self,
        spectrum: impl Iterator<Item = Complex64>,
        velocity: impl Iterator<Item = f64>,
    ) -> Result<(), LawError> {
        self.spectrum.clear();
        self.spectrum.extend(spectrum);
        self.velocity.clear();
        self.velocity.extend(velocity);
        let motion = Motion {
            spectrum: &self.spectrum,
            displacement: &[],
            velocity: &self.velocity,
            odd: false,
            omega: 0.0,
        };
        match self.tips.find(&motion) {
            // A constant edge pushes nothing.
            Err(LawError::NoMotion) => Ok(()),
            found => found,
        }
    }

    /// Its highest and its lowest turning point; `None` for a constant.
    pub(crate) fn extremes(&self) -> Option<(TurningPoint, TurningPoint)> {
        let points = self.tips.points();
        Some((*points.first()?, *points.get(self.tips.lowest())?))
    }

    /// Its mean in m.
    pub(crate) fn mean(&self) -> f64 {
        self.spectrum.first().map_or(0.0, |mean| mean.re)
    }

    /// Turning point number `r`, counted on over the periods.
    fn tip(&self, r: i64) -> Option<TurningPoint> {
        let count = self.tips.points().len() as i64;
        let point = self.tips.points().get(usize::try_from(r.checked_rem_euclid(count)?).ok()?)?;
        Some(TurningPoint { tau: point.tau + TAU * r.div_euclid(count) as f64, ..*point })
    }

    /// Number of the turning point at which the leg begins that is under way at phase `tau`.
    fn leg(&self, tau: f64) -> Option<i64> {
        let points = self.tips.points();
        let first = points.first()?.tau;
        let whole = ((tau - first) / TAU).floor();
        let inside = tau - TAU * whole;
        let passed = points.partition_point(|point| point.tau <= inside);
        Some(whole as i64 * points.len() as i64 + passed as i64 - 1)
    }

    /// Whether the leg that begins at turning point `r` pushes the slider.
    fn pushes(&self, r: i64, side: Side) -> bool {
        // Maxima have even numbers.
        (r.rem_euclid(2) == 1) == (side == Side::Lower)
    }

    /// The leg that pushes at phase `tau`, if it does.
    pub(crate) fn pushing(&self, tau: f64, side: Side) -> Option<i64> {
        self.leg(tau).filter(|&r| self.pushes(r, side))
    }

    /// The phase after `tau` at which it comes to push a slider that rests at `level`, and the leg on which it does.
    fn next_push(&self, tau: f64, level: f64, side: Side) -> Option<(f64, i64)> {
        let first = self.leg(tau)?;
        for r in first..=first + self.tips.points().len() as i64 {
            let (start, end) = (self.tip(r)?, self.tip(r + 1)?);
            if !self.pushes(r, side) || (end.displacement - level) * side.sign() <= 0.0 {
                continue;
            }
            let way = (level - start.displacement, end.displacement - start.displacement);
            return Some((crossing(&self.spectrum, start, end, way, false).max(tau), r));
        }
        None
    }
}

/// Where a slider rests, and which event put it there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rest {
    /// In m.
    pub(crate) level: f64,
    pub(crate) cause: Cause,
}

/// What a resting slider remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cause {
    /// The mean displacement.
    Mean,
    /// An edge turned round at this phase.
    Turned(Side, f64),
    /// The bodies touched at this phase.
    Touched(f64),
}

/// A stretch of the period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stretch {
    Resting(Rest),
    Pushed(Side),
}

/// Follows the slider from phase `from` to `to`, from a stretch that begins there: `Resting`, or `Pushed` on the leg given. Calls
/// `visit` for each stretch.
pub(crate) fn follow(
    [lower, upper]: [&Edge; 2],
    (from, to): (f64, f64),
    begin: Result<Rest, (Side, i64)>,
    mut visit: impl FnMut(f64, f64, Stretch),
) -> Result<(), LawError> {
    let mut now = from;
    let mut state = begin;
    let most = 4 * (lower.tips.points().len() + upper.tips.points().len() + 2);
    for _ in 0..most {
        if now >= to {
            return Ok(());
        }
        match state {
            Ok(rest) => {
                let up = lower.next_push(now, rest.level, Side::Lower);
                let down = upper.next_push(now, rest.level, Side::Upper);
                let pushes = up.map(|(tau, leg)| (tau, (Side::Lower, leg)));
                let others = down.map(|(tau, leg)| (tau, (Side::Upper, leg)));
                let next = pushes.into_iter().chain(others).min_by(|a, b| a.0.total_cmp(&b.0));
                let end = next.map_or(to, |(tau, _)| tau.min(to));
                visit(now, end, Stretch::Resting(rest));
                now = end;
                match next {
                    Some((_, push)) => state = Err(push),
                    None => return Ok(()),
                }
            }
            Err((side, leg)) => {
                let edge = if side == Side::Lower { lower } else { upper };
                let Some(tip) = edge.tip(leg + 1) else { return Ok(()) };
                let end = tip.tau.min(to);
                visit(now, end, Stretch::Pushed(side));
                now = end;
                state = Ok(Rest { level: tip.displacement, cause: Cause::Turned(side, tip.tau) });
            }
        }
    }
    if now >= to { Ok(()) } else { Err(LawError::NoPeriodicState { cycles: 1, change: f64::NAN }) }
}
