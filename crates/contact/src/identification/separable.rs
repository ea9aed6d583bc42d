//! Least squares of y = c₀ + c₁ u(α; p): two numbers by a straight-line fit, the third by a search that finds
//! every minimum (variable projection, Golub and Pereyra 1973).

use crate::scaling::{MagnitudeLaw, PhaseLaw};

use super::{Law, Parameter};

/// What was measured at one amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Observation {
    pub alpha: f64,
    pub value: f64,
    /// Standard errors of the value, positive, and of α, where known.
    pub noise: Option<(f64, f64)>,
}

/// One of the two laws, written as y = c₀ + c₁ u(α; p).
pub(super) struct Family<L> {
    pub which: Law,
    /// Names of c₀, c₁ and p.
    pub parameters: [Parameter; 3],
    /// u, ∂u/∂p and ∂u/∂α.
    pub basis: fn(alpha: f64, p: f64) -> [f64; 3],
    /// Between which p the loops could tell apart, from their ascending α.
    pub range: fn(&[f64]) -> (f64, f64),
    pub law: fn([f64; 3]) -> L,
}

impl Family<MagnitudeLaw> {
    /// Eq. (6): u = ln(α + shift). Below 10⁻⁶ of the smallest α the shift changes nothing; above 100 times the
    /// largest the law is a straight line over α.
    pub const MAGNITUDE: Self = Self {
        which: Law::Magnitude,
        parameters: [Parameter::Offset, Parameter::Slope, Parameter::Shift],
        basis: |alpha, shift| [(alpha + shift).ln(), 1.0 / (alpha + shift), 1.0 / (alpha + shift)],
        range: |alphas| (1e-6 * first(alphas), 1e2 * last(alphas)),
        law: |[offset, slope, shift]| MagnitudeLaw { offset, slope, shift },
    };
}

impl Family<PhaseLaw> {
    /// Eq. (7): u = −e^{−decay α}. Below 10⁻³ over the largest α the law is a straight line; at the upper end
    /// only the smallest loop differs from the limit.
    pub const PHASE: Self = Self {
        which: Law::Phase,
        parameters: [Parameter::Limit, Parameter::Span, Parameter::Decay],
        basis: |alpha, decay| {
            let fall = (-decay * alpha).exp();
            [-fall, alpha * fall, decay * fall]
        },
        range: |alphas| {
            let second = alphas.iter().copied().find(|alpha| *alpha > 1.02 * first(alphas));
            let apart = second.map_or(f64::INFINITY, |alpha| 30.0 / (alpha - first(alphas)));
            (1e-3 / last(alphas), apart.min(50.0 / first(alphas)))
        },
        law: |[limit, span, decay]| PhaseLaw { limit, span, decay },
    };
}

impl<L> Family<L> {
    /// y(α) for the numbers c₀, c₁, p.
    pub fn value(&self, alpha: f64, [constant, factor, p]: [f64; 3]) -> f64 {
        constant + factor * (self.basis)(alpha, p)[0]
    }

    /// ∂y/∂(c₀, c₁, p).
    pub fn jacobian(&self, alpha: f64, [_, factor, p]: [f64; 3]) -> [f64; 3] {
        let [u, growth, _] = (self.basis)(alpha, p);
        [1.0, u, factor * growth]
    }

    /// Standard error of a value with that of its α, which the slope of the law carries over.
    pub fn noise(&self, seen: &Observation, [_, factor, p]: [f64; 3]) -> Option<f64> {
        let [_, _, slope] = (self.basis)(seen.alpha, p);
        seen.noise.map(|(value, alpha)| value.hypot(factor * slope * alpha))
    }
}

fn first(alphas: &[f64]) -> f64 {
    alphas.first().copied().unwrap_or(1.0)
}

fn last(alphas: &[f64]) -> f64 {
    alphas.last().copied().unwrap_or(1.0)
}

/// The straight-line fit for a given p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub constant: f64,
    pub factor: f64,
    /// S(p) = Σ weight · residual², the smallest for this p.
    pub sum: f64,
    /// dS/d ln p. The linear numbers are optimal, so it is the partial derivative.
    gradient: f64,
}

/// Where the best p lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// At a minimum.
    Inside,
    /// At an end of the range: S falls towards it.
    End {
        /// Whether it is the lower one.
        lower: bool,
    },
    /// Nowhere: S does not depend on p.
    Flat,
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Optimum {
    pub p: f64,
    pub line: Line,
    pub place: Place,
    /// The other minima: p and S.
    pub others: Vec<(f64, f64)>,
    /// S at the lower and the upper end of the range.
    pub ends: (f64, f64),
    /// S up to which residuals are rounding.
    pub rounding: f64,
}

/// Observations (ascending in α) with the weight of each.
pub(super) struct Problem<'a, L> {
    pub family: &'a Family<L>,
    pub observations: &'a [Observation],
    pub weights: &'a [f64],
}

/// Steps of the search over p: each is about 5 % of p.
const STEPS: u32 = 600;

/// Sums of squares below this part of Σ weight (y − ȳ)² are rounding.
const ROUNDING: f64 = 1e-24;

impl<L> Problem<'_, L> {
    fn mean(&self, value: impl Fn(&Observation) -> f64) -> f64 {
        let pairs = || self.observations.iter().zip(self.weights);
        let total: f64 = self.weights.iter().sum();
        pairs().map(|(seen, weight)| weight * value(seen)).sum::<f64>() / total
    }

    /// c₁ = Σ w (u − ū)(y − ȳ) / Σ w (u − ū)²,   c₀ = ȳ − c₁ ū.
    pub fn line(&self, p: f64) -> Line {
        let basis = |seen: &Observation| (self.family.basis)(seen.alpha, p);
        let (centre, level) = (self.mean(|seen| basis(seen)[0]), self.mean(|seen| seen.value));
        let square = self.mean(|seen| (basis(seen)[0] - centre).powi(2));
        let product = self.mean(|seen| (basis(seen)[0] - centre) * (seen.value - level));
        let factor = if square > 0.0 { product / square } else { 0.0 };
        let off = |seen: &Observation| seen.value - level - factor * (basis(seen)[0] - centre);
        let total: f64 = self.weights.iter().sum();
        Line {
            constant: level - factor * centre,
            factor,
            sum: total * self.mean(|seen| off(seen).powi(2)),
            gradient: -2.0 * total * factor * p * self.mean(|seen| off(seen) * basis(seen)[1]),
        }
    }

    /// The best p of all, with the other minima.
    pub fn optimum(&self) -> Optimum {
        let alphas: Vec<f64> = self.observations.iter().map(|seen| seen.alpha).collect();
        let (low, high) = (self.family.range)(&alphas);
        let step = (high / low).ln() / f64::from(STEPS);
        let at = |j: u32| low * (f64::from(j) * step).exp();
        let gradients: Vec<(f64, f64)> = (0..=STEPS).map(|j| (at(j), self.line(at(j)).gradient)).collect();
        let mut minima: Vec<f64> = gradients
            .windows(2)
            .filter_map(|pair| match *pair {
                [(a, falling), (b, rising)] if falling < 0.0 && rising >= 0.0 => Some(self.bisect(a, b)),
                _ => None,
            })
            .collect();
        let ends = (self.line(low).sum, self.line(high).sum);
        let falls_outwards = (
            gradients.first().is_some_and(|(_, gradient)| *gradient > 0.0),
            gradients.last().is_some_and(|(_, gradient)| *gradient < 0.0),
        );
        let inside = minima.len();
        minima.extend(falls_outwards.0.then_some(low).into_iter().chain(falls_outwards.1.then_some(high)));

        // Of several exact solutions, which differ by rounding alone, the smallest p.
        let level = self.mean(|seen| seen.value);
        let rounding = ROUNDING
            * self.weights.iter().sum::<f64>()
            * self.mean(|seen| (seen.value - level).powi(2) + level * level);
        let sum = |p: &f64| self.line(*p).sum.max(rounding);
        let best = minima.iter().enumerate().min_by(|(_, a), (_, b)| sum(a).total_cmp(&sum(b)));
        let Some((chosen, &p)) = best.filter(|_| rounding > 0.0) else {
            return Optimum {
                p: low,
                line: self.line(low),
                place: Place::Flat,
                others: Vec::new(),
                ends,
                rounding,
            };
        };
        let others = minima.iter().enumerate().filter(|(other, _)| *other != chosen);
        Optimum {
            p,
            line: self.line(p),
            place: if chosen < inside { Place::Inside } else { Place::End { lower: p == low } },
            others: others.map(|(_, p)| (*p, sum(p))).collect(),
            ends,
            rounding,
        }
    }

    /// Where the gradient changes sign between `low` and `high`, to rounding.
    fn bisect(&self, mut low: f64, mut high: f64) -> f64 {
        loop {
            let middle = (low * high).sqrt();
            if middle <= low || middle >= high {
                return middle;
            }
            if self.line(middle).gradient < 0.0 { low = middle } else { high = middle }
        }
    }
}
