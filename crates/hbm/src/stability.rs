//! Whether a solution is stable: Floquet multipliers of the motion's small perturbations δw,
//!
//! ```text
//! M δẅ + (D + Σ b c(t) bᵀ) δẇ + (C + Σ b κ(t) bᵀ) δw = 0,      κ = ∂f/∂u, c = ∂f/∂u̇ along the motion, u = bᵀ w,
//! ```
//!
//! by Hill's method. Laws whose force remembers are not of this form: what they remember is part of the state.
//!
//! With M = L Lᵀ, y = Lᵀ δw and θ the phase of the coefficients' own period the system has no dimensions. Where excitation
//! and laws are odd, κ and c have half the period of the motion. The multipliers are those of a period 2π/Ω.

use std::f64::consts::TAU;
use std::fmt;

use contact::{ContactState, LawError, Motion, Tangent};
use faer::Mat;
use num_complex::Complex64;
use thiserror::Error;

use crate::beyond::Longer;
use crate::hill::{Hill, HillError, PeriodicSpring, distance, sort};
use crate::plan::Plan;
use crate::problem::Contact;
use crate::solution::{ContactSolution, Solution};
use crate::transform::Transform;

/// What the multipliers say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All of them are inside the unit circle: small perturbations die away.
    Stable,
    /// One of them is outside: the motion is not what one will see.
    Unstable,
    /// The largest lies on the unit circle as far as its error tells.
    Undecided,
}

/// How multipliers were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StabilityMethod {
    /// From Hill's matrix of the linearised balance.
    Hill,
    /// From the exact orbit's map of a period.
    Orbit,
}

/// `hill` or `orbit`.
impl fmt::Display for StabilityMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hill => "hill",
            Self::Orbit => "orbit",
        })
    }
}

/// Stability of a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Stability {
    /// What the largest multiplier says.
    pub verdict: Verdict,
    /// Floquet multipliers of a period 2π/Ω of the excitation, the largest first.
    pub multipliers: Vec<Complex64>,
    /// How far each may be from the true one: of the method's own truncation, of rounding, and of the harmonics that the
    /// solution leaves out. An estimate.
    pub error: f64,
    /// How they were found.
    pub method: StabilityMethod,
}

impl Stability {
    /// Sorts `multipliers` and judges by the largest.
    pub fn new(mut multipliers: Vec<Complex64>, error: f64, method: StabilityMethod) -> Self {
        sort(&mut multipliers);
        let largest = multipliers.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let verdict = match largest - 1.0 {
            beyond if beyond > error => Verdict::Unstable,
            beyond if beyond < -error => Verdict::Stable,
            _ => Verdict::Undecided,
        };
        Self { verdict, multipliers, error, method }
    }
}

/// Why a solution has no multipliers by Hill's method.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoStability {
    /// There is no solution.
    #[error("the point has no solution")]
    NotSolved,
    /// Nothing is periodic.
    #[error("a static response has no period")]
    Static,
    /// A friction law's slider or loop is part of the state.
    #[error(
        "contact {contact:?} ({law}) remembers its motion, so local stiffness and damping do not describe it"
    )]
    Memory {
        /// Its name.
        contact: String,
        /// The law's.
        law: &'static str,
    },
    /// Friction in several directions is part of the state.
    #[error("friction in a joint remembers its motion, so local stiffness and damping do not describe it")]
    Joint,
    /// The harmonics of its stiffness do not end.
    #[error("contact {contact:?} changes its stiffness too suddenly for Hill's matrix")]
    Sudden {
        /// Its name.
        contact: String,
    },
    /// A set-valued law has no derivative at rest.
    #[error("contact {contact:?} is held at rest by a law that has no derivative there")]
    Held {
        /// Its name.
        contact: String,
    },
    /// A law without force at the motion.
    #[error("contact {contact:?}: {error}")]
    Law {
        /// Its name.
        contact: String,
        /// What is wrong.
        error: LawError,
    },
    /// Hill's matrix would be large.
    #[error("the structure has {dofs} dofs; multipliers are found up to {MOST_DOFS} (reduce the model)")]
    TooLarge {
        /// How many.
        dofs: usize,
    },
    /// Massless dofs have no velocity of their own.
    #[error("the mass matrix is not positive definite, so some dof has no motion of its own")]
    Massless,
    /// Hill's matrix gave nothing.
    #[error(transparent)]
    Hill(#[from] HillError),
}

/// Dofs up to which multipliers are found.
const MOST_DOFS: usize = 100;

/// Samples of κ at first and at most.
const FIRST_SAMPLES: usize = 64;
const MOST_SAMPLES: usize = 1 << 14;

/// Coefficients below this part of the largest are rounding.
pub(crate) const ROUNDING: f64 = 1e-15;

/// κ counts as resolved when the upper half of its harmonics is below this part of the largest.
const RESOLVED: f64 = 1e-13;

/// One Newton step finds most of a distance, not all of it.
const CAUTION: f64 = 2.0;

/// The structure by mass-weighted coordinates: L, K̃ = L⁻¹ C L⁻ᵀ, D̃ = L⁻¹ D L⁻ᵀ.
struct Weighted {
    root: Mat<f64>,
    stiffness: Mat<f64>,
    damping: Mat<f64>,
}

/// A contact along a motion, as harmonics of the base frequency.
pub(crate) struct Local {
    /// Two-sided coefficients of κ in N/m and of ∂f/∂(du/dτ) in N/m.
    pub(crate) stiffness: Vec<Complex64>,
    pub(crate) rate: Vec<Complex64>,
    /// Likewise of the force in N.
    pub(crate) force: Vec<Complex64>,
}

impl Plan {
    /// The multipliers of `solution`, which must be one of this plan's.
    ///
    /// # Errors
    /// [`NoStability`] with the reason.
    pub fn stability(&self, solution: &Solution) -> Result<Stability, NoStability> {
        if !solution.status.solved() {
            return Err(NoStability::NotSolved);
        }
        if solution.frequency == 0.0 {
            return Err(NoStability::Static);
        }
        if !solution.joints.is_empty() {
            return Err(NoStability::Joint);
        }
        let dofs = self.structure.dofs();
        let (mass, damping, stiffness) =
            self.structure.dense().filter(|_| dofs <= MOST_DOFS).ok_or(NoStability::TooLarge { dofs })?;
        let root = cholesky(mass).ok_or(NoStability::Massless)?;
        let weighted =
            Weighted { stiffness: congruent(&root, stiffness), damping: congruent(&root, damping), root };
        let omega = TAU * solution.frequency * self.harmonics.fundamental as f64;
        let motions: Vec<Vec<Complex64>> =
            solution.contacts.iter().map(|contact| self.dense(&contact.displacement, 0)).collect();
        let along = |motions: &[Vec<Complex64>]| -> Result<Vec<Local>, NoStability> {
            let reports = solution.contacts.iter().zip(motions);
            let each = self.contacts.iter().zip(reports);
            each.map(|(contact, (report, motion))| self.local(contact, report, motion, omega)).collect()
        };
        let local = along(&motions)?;
        let hill = self.hill(&weighted, &local, omega)?;
        let found = hill.multipliers()?;
        let mut error = found.error;
        // The solution leaves harmonics out; what they would change is seen one Newton step further on.
        let matrices = (mass, damping, stiffness);
        let step = Longer { plan: self, matrices, solution, local: &local, omega };
        if let Some(longer) = step.motions(&motions) {
            let longer = self.hill(&weighted, &along(&longer)?, omega)?;
            error += CAUTION * distance(&longer.multipliers_with(found.truncation)?, &found.values);
        }
        // μ = λ^p over all p periods of the coefficients in one of the excitation.
        let periods = self.periods() as i32;
        let largest = found.values.first().map_or(0.0, |value| value.norm());
        let error = (largest + error).powi(periods) - largest.powi(periods);
        let multipliers = found.values.iter().map(|value| value.powi(periods)).collect();
        Ok(Stability::new(multipliers, error, StabilityMethod::Hill))
    }

    /// Finds the multipliers of a solution and of the others beside it, where they are asked for.
    pub(crate) fn judge(&self, solution: &mut Solution) {
        if self.settings.stability {
            solution.stability = self.stability(solution).ok();
            for other in &mut solution.others {
                other.stability = self.stability(other).ok();
            }
        }
    }

    /// Periods of κ and c in one of the motion.
    fn halves(&self) -> usize {
        if self.harmonics.odd { 2 } else { 1 }
    }

    /// Periods of κ and c in one of the excitation.
    fn periods(&self) -> usize {
        self.harmonics.fundamental * self.halves()
    }

    /// The system without dimensions.
    fn hill(&self, weighted: &Weighted, local: &[Local], omega: f64) -> Result<Hill, NoStability> {
        let halves = self.halves();
        let omega = omega * halves as f64;
        let springs = self.contacts.iter().zip(local).map(|(contact, local)| {
            let direction = forward(&weighted.root, &direction(contact, weighted.root.nrows()));
            let scale = contact.scale / (omega * omega);
            let every = |all: &[Complex64], by: f64| all.iter().step_by(halves).map(|z| z * by).collect();
            PeriodicSpring {
                direction,
                stiffness: every(&local.stiffness, scale),
                rate: every(&local.rate, scale * halves as f64),
            }
        });
        let springs: Vec<PeriodicSpring> = springs.collect();
        let stiffness = &weighted.stiffness * faer::Scale(1.0 / (omega * omega));
        let damping = &weighted.damping * faer::Scale(1.0 / omega);
        Ok(Hill::new(&stiffness, &damping, &springs)?)
    }

    /// κ, c and the force of a contact along its motion.
    fn local(
        &self,
        contact: &Contact,
        report: &ContactSolution,
        spectrum: &[Complex64],
        omega: f64,
    ) -> Result<Local, NoStability> {
        let name = || contact.name.clone();
        if report.state == ContactState::Held {
            return Err(NoStability::Held { contact: name() });
        }
        let mut samples = FIRST_SAMPLES.max((8 * spectrum.len()).next_power_of_two());
        loop {
            let transform = Transform::new(samples);
            let mut buffers = transform.buffers();
            let (mut u, mut v, mut force) = (vec![0.0; samples], vec![0.0; samples], vec![0.0; samples]);
            transform.to_time(spectrum.iter().copied(), &mut u, &mut buffers);
            let turned = spectrum.iter().zip(0..).map(|(w, k)| w * Complex64::new(0.0, f64::from(k)));
            transform.to_time(turned, &mut v, &mut buffers);
            let motion = Motion { spectrum, displacement: &u, velocity: &v, odd: self.harmonics.odd, omega };
            let mut workspace = contact::Workspace::new(samples);
            let evaluated = contact.law.force(&motion, &mut workspace, &mut force);
            evaluated.map_err(|error| NoStability::Law { contact: name(), error })?;
            let tangent: &Tangent = contact.law.tangent(&motion, &mut workspace);
            if !tangent.memories().is_empty() {
                // Sliders that stick are springs: where they rest is no motion.
                return match contact.law.stiffest().filter(|_| report.state == ContactState::Stick) {
                    Some(stiffness) => Ok(Local::spring(stiffness)),
                    None => Err(NoStability::Memory { contact: name(), law: contact.law.name() }),
                };
            }
            let mut of = |values: &[f64]| transform.to_coefficients(values, &mut buffers).to_vec();
            let stiffness = of(&tangent.local);
            let rate = tangent.rate().map_or(Vec::new(), &mut of);
            if resolved(&stiffness) && resolved(&rate) {
                let force = of(&force);
                return Ok(Local { stiffness: trimmed(stiffness), rate: trimmed(rate), force });
            }
            if samples >= MOST_SAMPLES {
                return Err(NoStability::Sudden { contact: name() });
            }
            samples *= 2;
        }
    }
}

impl Local {
    /// A spring that does not change.
    fn spring(stiffness: f64) -> Self {
        let stiffness = vec![Complex64::from(stiffness)];
        Self { stiffness, rate: Vec::new(), force: Vec::new() }
    }
}

/// Whether the upper half of the coefficients is next to nothing, so that those that are not there are less.
fn resolved(coefficients: &[Complex64]) -> bool {
    let size = |part: &[Complex64]| part.iter().map(|z| z.norm()).fold(0.0, f64::max);
    size(coefficients.get(coefficients.len() / 2..).unwrap_or_default()) <= RESOLVED * size(coefficients)
}

/// Without what is rounding at the end.
fn trimmed(mut coefficients: Vec<Complex64>) -> Vec<Complex64> {
    let largest = coefficients.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let length = coefficients.iter().rposition(|z| z.norm() > ROUNDING * largest).map_or(0, |last| last + 1);
    coefficients.truncate(length);
    coefficients
}

/// e_first − e_second.
fn direction(contact: &Contact, dofs: usize) -> Vec<f64> {
    let mut direction = vec![0.0; dofs];
    direction[contact.first] = 1.0;
    if let Some(second) = contact.second {
        direction[second] = -1.0;
    }
    direction
}

/// L with M = L Lᵀ; `None` where M is not positive definite beyond rounding.
fn cholesky(mass: &Mat<f64>) -> Option<Mat<f64>> {
    let n = mass.nrows();
    let mut root = Mat::<f64>::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let sum: f64 = (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum();
            let left = mass[(i, j)] - sum;
            if i > j {
                root[(i, j)] = left / root[(j, j)];
            } else if left > 1e-13 * mass[(j, j)] {
                root[(j, j)] = left.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(root)
}

/// L⁻¹ x.
fn forward(root: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    let mut y = x.to_vec();
    for i in 0..y.len() {
        let sum: f64 = (0..i).map(|k| root[(i, k)] * y[k]).sum();
        y[i] = (y[i] - sum) / root[(i, i)];
    }
    y
}

/// L⁻¹ A L⁻ᵀ.
fn congruent(root: &Mat<f64>, matrix: &Mat<f64>) -> Mat<f64> {
    let n = matrix.nrows();
    let columns: Vec<Vec<f64>> =
        (0..n).map(|j| forward(root, &matrix.col(j).iter().copied().collect::<Vec<_>>())).collect();
    let rows: Vec<Vec<f64>> =
        (0..n).map(|i| forward(root, &columns.iter().map(|column| column[i]).collect::<Vec<_>>())).collect();
    Mat::from_fn(n, n, |i, j| rows[i][j])
}
