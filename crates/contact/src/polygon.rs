//! A piecewise linear backbone: a finite stack of Jenkins elements, and a spring beside them.

use num_complex::Complex64;

use crate::elastic_coulomb::{ElasticCoulomb, ElasticCoulombParameters};
use crate::error::ParameterError;
use crate::law::{DescribingFunction, FirstHarmonic};
use crate::real::Real;

/// Slopes closer than this, relative to the first, are one slope: what decimal numbers in a file leave of a straight
/// line.
const SAME_SLOPE: f64 = 1e-9;

/// Where the slope changes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    /// In m.
    x: f64,
    /// f(x) in N.
    force: f64,
    /// Slope from here on, in N/m.
    slope: f64,
}

/// A concave, piecewise linear backbone from the origin; beyond the last knot the last slope goes on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polygon {
    /// The first at the origin; one more at every slider's yield displacement.
    knots: Vec<Knot>,
    sliders: Vec<ElasticCoulomb>,
}

impl Polygon {
    /// The backbone through `points` (x in m, f in N), begun at the origin whether that is listed or not.
    ///
    /// The slope between points may not grow nor become negative: a stack of sliders only loses elements as the
    /// displacement grows.
    ///
    /// # Errors
    /// [`ParameterError`] that names the first point where this fails, `backbone[i]`.
    pub(crate) fn through(points: &[[f64; 2]]) -> Result<Self, ParameterError> {
        let bad = |i: usize, problem: String| ParameterError::new(format!("backbone[{i}]"), problem);
        let mut knots: Vec<Knot> = Vec::new();
        let mut before = [0.0, 0.0];
        for (i, &[x, force]) in points.iter().enumerate() {
            if !(x.is_finite() && force.is_finite()) {
                return Err(bad(i, format!("must be two finite numbers, got [{x}, {force}]")));
            }
            if i == 0 && x == 0.0 && force == 0.0 {
                continue;
            }
            let run = x - before[0];
            if run <= 0.0 {
                return Err(bad(
                    i,
                    format!("displacements must increase from 0, but {x} follows {}", before[0]),
                ));
            }
            let slope = (force - before[1]) / run;
            let first = knots.first().map_or(slope, |knot| knot.slope);
            let slack = SAME_SLOPE * first.abs();
            let steeper = knots.last().is_some_and(|knot| slope > knot.slope + slack);
            if steeper || slope < -slack || first <= 0.0 {
                let why =
                    if steeper { "steeper than before it" } else { "not rising from the origin, or falling" };
                return Err(bad(
                    i,
                    format!(
                        "the backbone is {why}: a slope of {slope:.4e} N/m up to this point; only a concave rising one is a stack of sliders"
                    ),
                ));
            }
            let slope = if slope < slack { 0.0 } else { slope };
            if knots.last().is_none_or(|knot| slope < knot.slope - slack) {
                // From the slopes, so that points on a nearly straight line leave no step.
                let rise = |knot: &Knot| knot.force + knot.slope * (before[0] - knot.x);
                let force = knots.last().map_or(0.0, rise);
                knots.push(Knot { x: before[0], force, slope });
            }
            before = [x, force];
        }
        if knots.len() < 2 {
            return Err(ParameterError::new(
                "backbone",
                "needs two points beyond the origin and a change of slope between them; a straight backbone is the law linear",
            ));
        }
        Self::of_knots(knots)
    }

    /// The chords of a concave backbone through its values at `knots` (x > 0 in m, ascending, and f in N), with the
    /// slope `spring` beyond the last.
    pub(crate) fn inscribed(knots: &[[f64; 2]], spring: f64) -> Result<Self, ParameterError> {
        let mut before = [0.0, 0.0];
        let mut all = Vec::with_capacity(knots.len() + 1);
        for &[x, force] in knots {
            let slope = (force - before[1]) / (x - before[0]);
            all.push(Knot { x: before[0], force: before[1], slope });
            before = [x, force];
        }
        all.push(Knot { x: before[0], force: before[1], slope: spring });
        Self::of_knots(all)
    }

    fn of_knots(knots: Vec<Knot>) -> Result<Self, ParameterError> {
        let element = |pair: &[Knot]| match pair {
            [before, here] => {
                let stiffness = before.slope - here.slope;
                ElasticCoulomb::new(ElasticCoulombParameters { stiffness, slip_force: stiffness * here.x })
                    .map_err(|error| ParameterError::new("sliders", format!("an element's {error}")))
                    .map(Some)
            }
            _ => Ok(None),
        };
        let sliders =
            knots.windows(2).filter_map(|pair| element(pair).transpose()).collect::<Result<_, _>>()?;
        Ok(Self { knots, sliders })
    }

    /// The Jenkins elements, ascending in yield displacement.
    pub(crate) fn sliders(&self) -> &[ElasticCoulomb] {
        &self.sliders
    }

    /// The slope beyond the last knot in N/m: a spring beside the sliders.
    pub(crate) fn spring(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.slope)
    }

    /// Displacement in m beyond which every slider slips.
    pub(crate) fn end(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.x)
    }

    /// Displacement in m up to which no slider slips.
    pub(crate) fn elastic_range(&self) -> f64 {
        self.knots.get(1).map_or(0.0, |knot| knot.x)
    }

    #[inline]
    fn knot_before(&self, x: f64) -> Knot {
        let beyond = self.knots.partition_point(|knot| knot.x <= x);
        let knot = self.knots.get(beyond.saturating_sub(1)).copied();
        knot.unwrap_or(Knot { x: 0.0, force: 0.0, slope: 0.0 })
    }

    /// f(x) for x ≥ 0.
    #[inline]
    pub(crate) fn value<T: Real>(&self, x: T) -> T {
        let knot = self.knot_before(x.value());
        (x - T::from(knot.x)) * knot.slope + T::from(knot.force)
    }

    /// f'(x) for x ≥ 0; at a knot the slope beyond it.
    #[inline]
    pub(crate) fn slope(&self, x: f64) -> f64 {
        self.knot_before(x).slope
    }

    /// Displacement at which the force is `force`, below the force at [`Polygon::end`].
    pub(crate) fn reaching(&self, force: f64) -> f64 {
        let beyond = self.knots.partition_point(|knot| knot.force < force).max(1);
        self.knots.get(beyond - 1).map_or(0.0, |knot| knot.x + (force - knot.force) / knot.slope)
    }

    /// The sum of the elements' describing functions.
    pub(crate) fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        let spring = self.spring();
        let start = FirstHarmonic { force: Complex64::from(spring * a), derivative: Complex64::from(spring) };
        self.sliders.iter().fold(start, |sum, slider| {
            let one = slider.first_harmonic(a);
            FirstHarmonic { force: sum.force + one.force, derivative: sum.derivative + one.derivative }
        })
    }
}
