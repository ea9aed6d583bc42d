//! One case: a problem as plain numbers, and what mathematics says about it before it is run.

use std::fmt;

use anyhow::{Result, anyhow};
use contact::Law;
use faer::Mat;
use hbm::{Contact, Damping, Excitation, ExcitationKind, Model, Problem};

use super::law::{Built, LawSpec};

/// What may become of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Label {
    /// A solution exists.
    Solvable,
    /// None need exist, or the input is none.
    MayBeRefused(Reason),
}

/// Why a case may be refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    /// Undamped and at a resonance of the free structure with more force than the friction can oppose, or at one of the
    /// structure with its springs.
    UnboundedResonance,
    /// A motion without stiffness carries a static load, or its mean is not determined.
    FreeBody,
    /// Between what the contact holds at every instant and what no force within its limit can oppose.
    HoldingShell,
    /// A record that is no loop.
    NoLoop,
    /// A law so steep against the way between samples that its harmonics form a staircase over the motion.
    Staircase,
    /// The last digits of the numbers given decide on the solution.
    Undetermined,
    /// The magnitude law becomes negative in its range or beyond.
    NegativeMagnitude,
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Solvable => write!(f, "solvable"),
            Self::MayBeRefused(reason) => write!(f, "may be refused ({reason:?})"),
        }
    }
}

/// A contact of a case.
#[derive(Debug, Clone)]
pub(super) struct ContactSpec {
    pub(super) first: usize,
    pub(super) second: Option<usize>,
    pub(super) law: LawSpec,
    pub(super) scale: f64,
}

/// A case.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) id: String,
    pub(super) family: &'static str,
    pub(super) mass: Vec<Vec<f64>>,
    pub(super) stiffness: Vec<Vec<f64>>,
    /// Ratio of critical damping in every mode, or, where modes are not defined, that of stiffness-proportional damping.
    pub(super) damping: DampingSpec,
    pub(super) loads: Vec<Excitation>,
    pub(super) contacts: Vec<ContactSpec>,
    /// In Hz.
    pub(super) frequency: f64,
    pub(super) harmonics: usize,
    pub(super) label: Label,
    /// Within 1e-9 of a threshold: either neighbour's answer is right.
    pub(super) threshold: bool,
}

/// How a case is damped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DampingSpec {
    None,
    ModalRatio(f64),
    /// D = seconds · C + rate · M.
    Rayleigh {
        seconds: f64,
        rate: f64,
    },
}

/// A case with its laws built.
pub(super) struct Ready {
    pub(super) problem: Problem,
    pub(super) built: Vec<Built>,
}

impl Case {
    /// Constructs what the solver takes.
    pub(super) fn build(&self) -> Result<Ready> {
        let built: Vec<Built> = self.contacts.iter().map(|c| c.law.build()).collect::<Result<_>>()?;
        let contacts = self.contacts.iter().zip(&built).enumerate().map(|(i, (spec, built))| Contact {
            name: format!("c{i}"),
            first: spec.first,
            second: spec.second,
            law: built.law.clone(),
            scale: spec.scale,
        });
        let problem = Problem {
            joints: Vec::new(),
            contacts: contacts.collect(),
            model: self.model()?,
            excitation: self.loads.clone(),
            output: (0..self.mass.len()).collect(),
        };
        Ok(Ready { problem, built })
    }

    pub(super) fn model(&self) -> Result<Model> {
        let damping = match self.damping {
            DampingSpec::None => Damping::Rayleigh { mass: 0.0, stiffness: 0.0 },
            DampingSpec::ModalRatio(ratio) => Damping::ModalRatio(ratio),
            DampingSpec::Rayleigh { seconds, rate } => Damping::Rayleigh { mass: rate, stiffness: seconds },
        };
        Model::new(dense(&self.mass), damping, dense(&self.stiffness)).map_err(|e| anyhow!("{e}"))
    }

    /// Greatest common divisor of the excited harmonics: the base frequency's multiple. One where nothing is excited.
    pub(super) fn fundamental(&self) -> usize {
        let excited = self.loads.iter().filter(|l| l.amplitude != 0.0).map(|l| l.harmonic);
        excited.fold(0, |a, b| if b == 0 { a } else { gcd(a, b) }).max(1)
    }

    /// The same case in other units: lengths, forces and times are `length`, `force`, `time` of the new ones.
    pub(super) fn in_units(&self, length: f64, force: f64) -> Self {
        let mut other = self.clone();
        let stiffness = force / length;
        for row in other.mass.iter_mut().chain(&mut other.stiffness) {
            row.iter_mut().for_each(|entry| *entry *= stiffness);
        }
        for load in &mut other.loads {
            load.amplitude *= match load.kind {
                ExcitationKind::Force => force,
                ExcitationKind::Base => length,
                ExcitationKind::Unbalance => force,
            };
        }
        for contact in &mut other.contacts {
            contact.law = contact.law.in_units(length, force);
        }
        other
    }
}

impl LawSpec {
    fn in_units(&self, length: f64, force: f64) -> Self {
        let stiff = force / length;
        match self.clone() {
            Self::ScaledLoop { displacement, series, magnitude, phase } => Self::ScaledLoop {
                displacement: displacement * length,
                series: series.iter().map(|c| c * force).collect(),
                magnitude,
                phase,
            },
            Self::LoopFamily { loops } => Self::LoopFamily {
                loops: loops
                    .into_iter()
                    .map(|(a, series)| (a * length, series.iter().map(|c| c * force).collect()))
                    .collect(),
            },
            Self::ElasticCoulomb { stiffness, slip_force } => {
                Self::ElasticCoulomb { stiffness: stiffness * stiff, slip_force: slip_force * force }
            }
            Self::IwanSmooth { displacement, force: f, range } => {
                Self::IwanSmooth { displacement: displacement * length, force: f * force, range }
            }
            Self::IwanPolygon { backbone } => Self::IwanPolygon {
                backbone: backbone.into_iter().map(|[x, f]| [x * length, f * force]).collect(),
            },
            Self::Cubic { stiffness } => Self::Cubic { stiffness: stiffness * stiff / (length * length) },
            Self::Linear { stiffness } => Self::Linear { stiffness: stiffness * stiff },
            Self::Coulomb { slip_force, velocity } => {
                Self::Coulomb { slip_force: slip_force * force, velocity: velocity * length }
            }
            Self::Measured { record } => Self::Measured { record },
        }
    }
}

/// The nature of a law without building it twice.
pub(super) fn is_odd(law: &dyn Law) -> bool {
    law.nature().odd
}

pub(super) fn dense(rows: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(rows.len(), rows.len(), |i, j| rows.get(i).and_then(|r| r.get(j)).copied().unwrap_or(0.0))
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
