//! Forces that are piecewise linear in the displacement, by their events: no samples, no sampling error.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::error::LawError;
use crate::law::{Marks, Motion, Workspace};
use crate::tangent::Recall;
use crate::turning_points::{TurningPoint, drop_from, halley, has_odd_only, jet_of, settled};

/// A stretch of the period on which an element of the contact has the force `f(τ) = stiffness · w(τ) + offset`. The
/// stretches of several elements in parallel may overlap: their forces add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcePiece {
    /// Phase at which it begins, in rad.
    pub from: f64,
    /// Phase at which it ends, in rad, not below `from`.
    pub to: f64,
    /// In N/m: zero while slipping.
    pub stiffness: f64,
    /// In N.
    pub offset: f64,
    /// Force at `from` in N; where the piece is `close` that is a turning point.
    pub start_force: f64,
    /// The way that it takes is so short a part of the motion that `stiffness · w + offset` would cancel. Without terms that
    /// do, `f(τ) = start_force − stiffness · drop` with [`crate::drop_from`].
    pub close: bool,
    /// What the offset depends on, and how strongly (N/m): the displacement at the turning point where the last slip
    /// ended.
    pub memory: Option<(Recall, f64)>,
}

/// A law whose force is piecewise linear in the displacement. Its harmonics and their derivatives are then closed
/// expressions of the events' phases; the phases themselves need no derivative, since the force is continuous there.
pub trait PiecewiseLinear {
    /// The pieces of one period of `motion`, into `pieces`; of an odd motion those of half a period, which the other half
    /// mirrors: the same stiffness, the other sign of offset and memory. Only spectrum and velocity samples of the motion
    /// are used.
    ///
    /// # Errors
    /// [`LawError`] when the motion has no force under this law.
    fn pieces(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        pieces: &mut Vec<ForcePiece>,
    ) -> Result<Marks, LawError>;
}

/// A way shorter than this part of the whole is measured from the turning point without cancellation.
const SHORT: f64 = 1e-8;

/// Phase at which the displacement has gone the way `rise` (with its sign) from one turning point to the next, by `total`:
/// Halley's method kept inside the bracket, started from the half cosine between the two. A `close` way is measured
/// without cancellation.
pub(crate) fn crossing(
    spectrum: &[Complex64],
    start: TurningPoint,
    end: TurningPoint,
    (rise, total): (f64, f64),
    close: bool,
) -> f64 {
    let part = (rise / total).clamp(0.0, 1.0);
    let (mut left, mut right) = (start.tau, end.tau);
    let mut at = left + (right - left) * 2.0 * part.sqrt().asin() / PI;
    let rising = total > 0.0;
    let close = close || part < SHORT;
    let odd = has_odd_only(spectrum);
    let mut before = 0.0;
    for _ in 0..60 {
        let here = jet_of(spectrum, odd, at);
        let way = if close {
            -drop_from(spectrum, start.tau, at - start.tau)
        } else {
            here.displacement - start.displacement
        };
        let beyond = way - rise;
        if beyond == 0.0 {
            break;
        }
        if (beyond > 0.0) == rising {
            right = at;
        } else {
            left = at;
        }
        let step = halley(beyond, here.velocity, here.acceleration);
        let inside = at + step > left && at + step < right;
        let next = if inside { at + step } else { 0.5 * (left + right) };
        let length = (next - at).abs();
        let enough = length <= 2.0 * f64::EPSILON * next.abs().max(1.0)
            || (inside && !close && settled(length, before));
        (at, before) = (next, if inside { length } else { 0.0 });
        if enough {
            break;
        }
    }
    at
}
