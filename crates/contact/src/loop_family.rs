//! A family of measured loops: between their displacement amplitudes the Fourier coefficients are interpolated.
//!
//! Where the paper has one loop and two scaling laws, (6) and (7), a family has the loops themselves: every harmonic
//! c_k(a) is measured at several amplitudes a. [`FamilyCurve`](crate::family_curve) says how they are joined. As in the
//! other loop law a general motion follows the loop of its amplitude over loop phase, and interior reversals follow
//! Masing's memory.
//!
//! Below the smallest loop the force vanishes with the amplitude (a stick stiffness, no set-valued rest); above the
//! largest the coefficients level off like A + B/a, as those of a slipping contact do, and the amplitude counts as
//! extrapolated.

use hysteresis::Loop;
use num_complex::Complex64;

use crate::error::{LawError, ParameterError};
use crate::family_curve::FamilyCurve;
use crate::law::{ContactState, DescribingFunction, FirstHarmonic, Law, Marks, Motion, Nature, Workspace};
use crate::path::SampledPath;
use crate::scaled_loop::Symmetry;
use crate::tangent::{Recall, Tangent};

/// Loops whose amplitudes differ by less than this, relatively, are loops of one amplitude.
const SAME_AMPLITUDE: f64 = 1e-3;

/// Measured loops at two or more displacement amplitudes.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopFamily {
    curve: FamilyCurve,
    odd: bool,
    /// Largest even content of the loops.
    even_content: f64,
}

impl LoopFamily {
    /// The law of the `measured` loops, in any order; `noise` is the largest of the records' noises relative to |F_1|
    /// (0 when unknown), which decides about even harmonics in [`Symmetry::Auto`] together with the largest even
    /// content. The loops' mean forces are left out: they have no meaning at another amplitude.
    ///
    /// # Errors
    /// [`ParameterError`] with the key `loops` when there are fewer than two, `loops[i]` when one has the amplitude of
    /// another (within 0.1 %), or dissipates nothing.
    pub fn new(measured: &[Loop], noise: f64, symmetry: Symmetry) -> Result<Self, ParameterError> {
        if measured.len() < 2 {
            let problem = format!(
                "a family needs two or more loops of different amplitudes, got {}; one loop is the law scaled_loop",
                measured.len()
            );
            return Err(ParameterError::new("loops", problem));
        }
        let mut order: Vec<(usize, &Loop)> = measured.iter().enumerate().collect();
        order.sort_by(|(_, a), (_, b)| a.displacement_amplitude().total_cmp(&b.displacement_amplitude()));
        for (i, one) in &order {
            if one.first_harmonic().im <= 0.0 {
                let problem = "its first harmonic dissipates nothing (Im F_1 must be positive)";
                return Err(ParameterError::new(format!("loops[{i}]"), problem));
            }
        }
        for pair in order.windows(2) {
            if let [(i, one), (j, other)] = pair
                && other.displacement_amplitude() <= one.displacement_amplitude() * (1.0 + SAME_AMPLITUDE)
            {
                let problem = format!(
                    "has the displacement amplitude of loops[{}], {:.4e} m; loops of a family must differ in amplitude",
                    i.min(j),
                    one.displacement_amplitude()
                );
                return Err(ParameterError::new(format!("loops[{}]", i.max(j)), problem));
            }
        }
        let even_content = measured.iter().map(Loop::even_content).fold(0.0, f64::max);
        let odd = symmetry.is_odd(even_content, noise);
        let harmonics = measured.iter().map(|one| one.coefficients().len()).max().unwrap_or(0);
        let keep = |k: usize| k >= 1 && !(odd && k.is_multiple_of(2));
        let coefficients = |one: &Loop| {
            let all = one.coefficients();
            (0..harmonics)
                .map(|k| if keep(k) { all.get(k).copied().unwrap_or_default() } else { Complex64::ZERO })
                .collect()
        };
        let loops =
            order.into_iter().map(|(_, one)| (one.displacement_amplitude(), coefficients(one))).collect();
        Ok(Self { curve: FamilyCurve::through(loops), odd, even_content })
    }

    /// Displacement amplitudes in m of the smallest and the largest loop.
    pub fn range(&self) -> (f64, f64) {
        self.curve.range()
    }

    /// Whether the law is odd: the measured loops are, or their even harmonics were left out.
    pub fn is_odd(&self) -> bool {
        self.odd
    }

    /// Largest even content of the measured loops, relative to |F_1|.
    pub fn even_content(&self) -> f64 {
        self.even_content
    }

    /// The coefficients c_k(a) in N of the loop of amplitude `a` > 0 in m, and dc_k/da in N/m; index k.
    pub fn harmonics(&self, a: f64) -> impl Iterator<Item = (Complex64, Complex64)> {
        let blend = self.curve.blend(a);
        self.curve.coefficients(blend).zip(self.curve.derivatives(blend))
    }
}

impl Law for LoopFamily {
    fn name(&self) -> &'static str {
        "loop_family"
    }

    fn nature(&self) -> Nature {
        Nature { odd: self.odd, determines_mean: false, linear: false, rate_dependent: false }
    }

    /// The largest measured amplitude.
    fn length(&self) -> Option<f64> {
        Some(self.range().1)
    }

    fn force(
        &self,
        motion: &Motion,
        workspace: &mut Workspace,
        force: &mut [f64],
    ) -> Result<Marks, LawError> {
        let Workspace { turning_points: tips, curve, growth, masing, .. } = workspace;
        match tips.find(motion) {
            Err(LawError::NoMotion) => {
                force.fill(0.0);
                return Ok(Marks { extrapolated: false, state: ContactState::Stick });
            }
            found => found?,
        }
        let a = tips.amplitude();
        let blend = self.curve.blend(a);
        curve.set(self.curve.coefficients(blend), self.odd);
        growth.set(self.curve.derivatives(blend), self.odd);
        masing.trace(curve, &SampledPath::new(motion, tips), a, force);
        Ok(self.marks(a))
    }

    /// At rest, where the loop shrinks to a point and has no derivative, the stick stiffness about the mean.
    fn tangent<'w>(&self, motion: &Motion, workspace: &'w mut Workspace) -> &'w Tangent {
        let Workspace { turning_points, curve, growth, masing, masing_tangent, tangent, .. } = workspace;
        if turning_points.amplitude() > 0.0 {
            masing_tangent.evaluate(curve, growth, masing, motion, turning_points, tangent);
        } else {
            let stiffness = self.curve.stick_stiffness().re;
            tangent.clear();
            tangent.local.fill(stiffness);
            if !motion.odd {
                tangent.remember(Recall::Mean).1.fill(-stiffness);
            }
        }
        tangent
    }

    fn describing_function(&self) -> Option<&dyn DescribingFunction> {
        Some(self)
    }

    /// No harmonic of the loops may alias onto one of the motion.
    fn samples(&self, harmonics: usize) -> usize {
        (16 * (harmonics + 1)).max(256).max(4 * (self.curve.len() + harmonics))
    }
}

impl DescribingFunction for LoopFamily {
    /// `F_1 = c_1(a)`.
    fn first_harmonic(&self, a: f64) -> FirstHarmonic {
        let (force, derivative) = self.harmonics(a).nth(1).unwrap_or_default();
        FirstHarmonic { force, derivative }
    }

    fn marks(&self, a: f64) -> Marks {
        Marks { extrapolated: a > self.range().1 * (1.0 + 1e-9), state: ContactState::Mixed }
    }

    /// The smallest measured amplitude: below it the contact sticks more and more.
    fn landmark(&self) -> Option<f64> {
        Some(self.range().0)
    }
}
