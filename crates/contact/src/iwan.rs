//! Iwan's law: a stack of Jenkins elements in parallel, made from a backbone; Masing's rule by construction.
//!
//! The backbone f(x) is the force of a first loading from rest. A stack of sliders with the stiffness density
//! −f''(y) over the yield displacement y, and a spring of stiffness f'(∞) beside them, has that backbone; its loops
//! run from the tips ±f(a) along 2 f(x/2), where x is the distance from the last reversal (Masing's rule), and minor
//! loops close and are forgotten.
//!
//! From the paper's magnitude law, eq. (6), the backbone is `f(x) = F* [g(x/W*) − g(0)] = 0.21 F* ln(1 + x/(0.01 W*))`:
//! the Masing-consistent companion of [`ScaledLoop`](crate::ScaledLoop). Its fundamental has the magnitude of (6)
//! within 1.7 % for α between 0.1 and 1, but not the phase of (7): no stack of sliders has both.

use serde::{Deserialize, Serialize};

use crate::backbone::{Backbone, Stack, Unchanging};
use crate::elastic_coulomb::ElasticCoulomb;
use crate::error::{LawError, ParameterError};
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::logarithmic::Logarithmic;
use crate::mechanism::Mechanism;
use crate::path::{Path, SampledPath};
use crate::polygon::Polygon;
use crate::scaling::MagnitudeLaw;
use crate::tangent::{Recall, Tangent};

/// Sliders beyond this are a slip of the pen.
const MOST_SLIDERS: usize = 100_000;

/// Parameters of an [`Iwan`] law made from the magnitude law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IwanParameters {
    /// W* in m, displacement amplitude of the measured loop; positive.
    pub displacement: f64,
    /// F* in N, which g is measured in; positive.
    pub force: f64,
    /// g of eq. (6). Only `slope` and `shift` matter, as g(0) is taken off; both positive.
    #[serde(default)]
    pub magnitude: MagnitudeLaw,
    /// x_max/W*: sliders yield at displacements up to `range · W*`; the stiffness that is left there,
    /// `F* g'(range)/W*`, is a spring. Positive. Beyond α = 1 the magnitude law is extrapolated in any case; the default
    /// of 10 goes on with it, as [`ScaledLoop`](crate::ScaledLoop) does, and 1 stops at what was measured.
    #[serde(default = "IwanParameters::default_range")]
    pub range: f64,
}

impl IwanParameters {
    /// The range that is taken when none is given.
    pub fn default_range() -> f64 {
        10.0
    }
}

/// A stack of Jenkins elements in parallel and a spring: Iwan's law. After a reversal at $`(w_r, f_r)`$ it follows the backbone
/// $`f_b`$, the force of a first loading from rest, at twice its scale (Masing's rule),
///
/// ```math
/// f = f_r \mp 2 f_b\!\left(\frac{|w - w_r|}{2}\right) .
/// ```
///
/// A slider that never slips during a motion rests where [`ElasticCoulomb`] rests, so that a stack of finitely many
/// sliders is the sum of its elements for every motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Iwan {
    backbone: Backbone,
    /// Displacement amplitude that stands for the law, in m.
    length: f64,
    /// Amplitudes above are beyond what the backbone was given for, in m.
    known: f64,
}

impl Iwan {
    /// The stack whose backbone is F* [g(x/W*) − g(0)]: infinitely many sliders, in closed form.
    ///
    /// # Errors
    /// [`ParameterError`] when a parameter is not positive.
    pub fn from_magnitude(parameters: IwanParameters) -> Result<Self, ParameterError> {
        let displacement = ParameterError::positive("displacement", parameters.displacement)?;
        let force = ParameterError::positive("force", parameters.force)?;
        let slope = ParameterError::positive("magnitude.slope", parameters.magnitude.slope)?;
        let shift = ParameterError::positive("magnitude.shift", parameters.magnitude.shift)?;
        let range = ParameterError::positive("range", parameters.range)?;
        let backbone = Backbone::Logarithmic(Logarithmic {
            force: force * slope,
            length: shift * displacement,
            end: range * displacement,
        });
        Ok(Self { backbone, length: displacement, known: displacement })
    }

    /// The stack with the given backbone: `points` [x in m, f in N] in order, the origin added when it is not listed,
    /// straight lines between them. Beyond the last point the last slope goes on: a spring, unless it is zero.
    ///
    /// # Errors
    /// [`ParameterError`] with the key `backbone[i]` at the first point where the displacement does not increase, or
    /// the slope grows or becomes negative; `backbone` when there is no change of slope.
    pub fn from_backbone(points: &[[f64; 2]]) -> Result<Self, ParameterError> {
        let polygon = Polygon::through(points)?;
        let known = points.last().map_or(0.0, |[x, _]| *x);
        // Where a single element of the same stiffness and slip force as all sliders together would slip.
        let stiffness: f64 = polygon.sliders().iter().map(ElasticCoulomb::stiffness).sum();
        let force: f64 = polygon.sliders().iter().map(ElasticCoulomb::slip_force).sum();
        Ok(Self { backbone: Backbone::Polygon(polygon), length: force / stiffness, known })
    }

    /// The same law with `count` sliders: chords of the backbone between the displacements where it has risen by equal
    /// steps of force. For the logarithmic backbone these chords are all equally far from it, and the error falls with
    /// the square of `count`.
    ///
    /// # Errors
    /// [`ParameterError`] with the key `sliders` when `count` is zero, or beyond what the backbone can be divided into.
    pub fn discretised(&self, count: usize) -> Result<Self, ParameterError> {
        if !(1..=MOST_SLIDERS).contains(&count) {
            let problem = format!("must be a whole number from 1 to {MOST_SLIDERS}, got {count}");
            return Err(ParameterError::new("sliders", problem));
        }
        let end = self.backbone.end();
        let highest = self.backbone.value(end);
        let knot = |i: usize| {
            let force = highest * (i as f64 / count as f64);
            if i == count { [end, highest] } else { [self.backbone.reaching(force), force] }
        };
        let knots: Vec<[f64; 2]> = (1..=count).map(knot).collect();
        let backbone = match &self.backbone {
            Backbone::Logarithmic(_) => Polygon::inscribed(&knots, self.backbone.spring())?,
            // Several knots may lie on one straight part.
            Backbone::Polygon(polygon) => {
                let beyond = [2.0 * end, highest + polygon.spring() * end];
                let points: Vec<[f64; 2]> = knots.into_iter().chain([beyond]).collect();
                Polygon::through(&points)?
            }
        };
        Ok(Self { backbone: Backbone::Polygon(backbone), length: self.length, known: self.known })
    }

    /// Force in N of a first loading from rest to the displacement `x` ≥ 0 in m.
    pub fn backbone(&self, x: f64) -> f64 {
        self.backbone.value(x)
    }

    /// The Jenkins elements, ascending in yield displacement; `None` when there are infinitely many (see
    /// [`Iwan::discretised`]). Beside them stands the spring [`Iwan::spring`].
    pub fn sliders(&self) -> Option<&[ElasticCoulomb]> {
        match &self.backbone {
            Backbone::Logarithmic(_) => None,
            Backbone::Polygon(polygon) => Some(polygon.sliders()),
        }
    }

    /// Stiffness in N/m of the spring beside the sliders; zero when the stack can slip as a whole.
    pub fn spring(&self) -> f64 {
        self.backbone.spring()
    }

    /// The branches during a motion, with its amplitude.
    fn stack<'a>(&'a self, motion: &Motion, path: &SampledPath) -> Stack<'a, f64> {
        let (top, bottom) = (path.tip(0), path.tip(path.lowest()));
        let (mid, mean) = if motion.odd { (0.0, 0.0) } else { (0.5 * (top + bottom), mean(motion)) };
        Stack::new(&self.backbone, 0.5 * (top - bottom), mid, mean)
    }

    /// For verification with other number types.
    #[cfg(test)]
    pub(crate) fn curve(&self) -> &Backbone {
        &self.backbone
    }
}

/// W_0 in m.
fn mean(motion: &Motion) -> f64 {
    motion.spectrum.first().map_or(0.0, |mean| mean.re)
}

impl Law for Iwan {
    fn name(&self) -> &'static str {
        "iwan"
    }

    /// The spring beside the sliders, where there is one, determines the mean; sliders follow it.
    fn nature(&self) -> Nature {
        Nature { odd: true, determines_mean: self.spring() > 0.0, linear: false, rate_dependent: false }
    }

    fn length(&self) -> Option<f64> {
        Some(self.length)
    }

    fn stiffest(&self) -> Option<f64> {
        Some(self.backbone.slope(0.0))
    }

    fn force(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        let Workspace { turning_points: tips, stack, .. } = workspace;
        match tips.find(motion) {
            Err(LawError::NoMotion) => {
                force.fill(self.spring() * mean(motion));
                return Ok(self.marks(0.0));
            }
            found => found?,
        }
        let path = SampledPath::new(motion, tips);
        stack.trace(&self.stack(motion, &path), &path, tips.amplitude(), force);
        Ok(self.marks(tips.amplitude()))
    }

    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        let Workspace { turning_points: tips, stack, masing_tangent, tangent, .. } = workspace;
        let by_mean = if tips.amplitude() > 0.0 {
            let shape = self.stack(motion, &SampledPath::new(motion, tips));
            masing_tangent.evaluate(&shape, &Unchanging, stack, motion, tips, tangent);
            shape.by_mean()
        } else {
            // At rest no slider slips.
            tangent.clear();
            tangent.local.fill(self.backbone.slope(0.0));
            self.spring() - self.backbone.slope(0.0)
        };
        if !motion.odd && by_mean != 0.0 {
            tangent.remember(Recall::Mean).1.fill(by_mean);
        }
        tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    fn mechanism(&self) -> Mechanism<'_> {
        match self.sliders() {
            Some(sliders) => Mechanism::Sliders { sliders, spring: self.spring() },
            None => {
                Mechanism::None { why: "it has infinitely many sliders; give it a number of \"sliders\"" }
            }
        }
    }
}

impl DescribingFunction for Iwan {
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        self.backbone.first_harmonic(a)
    }

    fn marks(&self, a: f64) -> Marks {
        let sticks = match &self.backbone {
            Backbone::Logarithmic(_) => a == 0.0,
            Backbone::Polygon(polygon) => a <= polygon.elastic_range(),
        };
        let state = if sticks { ContactState::Stick } else { ContactState::Mixed };
        Marks { extrapolated: a > self.known * (1.0 + 1e-9), state }
    }

    fn landmark(&self) -> Option<f64> {
        Some(match &self.backbone {
            // Where the logarithm bends.
            Backbone::Logarithmic(curve) => curve.length,
            Backbone::Polygon(polygon) => polygon.elastic_range(),
        })
    }
}
