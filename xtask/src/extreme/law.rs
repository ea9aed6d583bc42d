//! Contact laws as plain numbers: built for the solver through the public constructors, and known to the judge.

use std::sync::Arc;

use anyhow::{Result, anyhow};
use contact::{
    Coulomb, CoulombParameters, Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Iwan,
    IwanParameters, Law, Linear, LinearParameters, LoopFamily, MagnitudeLaw, PhaseLaw, ScaledLoop, Symmetry,
};
use hysteresis::{FitSettings, Loop, Record};
use num_complex::Complex64;

/// What a contact obeys.
#[derive(Debug, Clone)]
pub(super) enum LawSpec {
    /// Eqs (6)–(9) on a loop: W*, its series over loop phase (index k; only c_1 = F* e^{iφ} for an ellipse).
    ScaledLoop {
        displacement: f64,
        series: Vec<Complex64>,
        magnitude: MagnitudeLaw,
        phase: PhaseLaw,
    },
    /// Loops at several amplitudes.
    LoopFamily {
        loops: Vec<(f64, Vec<Complex64>)>,
    },
    ElasticCoulomb {
        stiffness: f64,
        slip_force: f64,
    },
    /// Iwan's law from the magnitude law: W*, F*, range.
    IwanSmooth {
        displacement: f64,
        force: f64,
        range: f64,
    },
    /// Iwan's law from a polygon.
    IwanPolygon {
        backbone: Vec<[f64; 2]>,
    },
    Cubic {
        stiffness: f64,
    },
    Linear {
        stiffness: f64,
    },
    Coulomb {
        slip_force: f64,
        velocity: f64,
    },
    /// A scaled loop from a measured record, through the whole fit.
    Measured {
        record: Arc<Record>,
    },
}

/// A law, and for a measured one the loop that was fitted.
pub(super) struct Built {
    pub(super) law: Arc<dyn Law>,
    /// What the judge evaluates: for a measured law the scaled loop of the fitted series.
    pub(super) spec: LawSpec,
    /// The family, whose interpolated coefficients are public.
    pub(super) family: Option<LoopFamily>,
    /// Even harmonics of the loop count.
    pub(super) full: bool,
}

impl LawSpec {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::ScaledLoop { .. } | Self::Measured { .. } => "scaled_loop",
            Self::LoopFamily { .. } => "loop_family",
            Self::ElasticCoulomb { .. } => "elastic_coulomb",
            Self::IwanSmooth { .. } | Self::IwanPolygon { .. } => "iwan",
            Self::Cubic { .. } => "cubic",
            Self::Linear { .. } => "linear",
            Self::Coulomb { .. } => "coulomb",
        }
    }

    /// The law as the solver takes it.
    pub(super) fn build(&self) -> Result<Built> {
        let mut built = Built {
            law: Arc::new(Linear::new(LinearParameters { stiffness: 0.0 })?),
            spec: self.clone(),
            family: None,
            full: false,
        };
        built.law = match self {
            Self::ScaledLoop { displacement, series, magnitude, phase } => {
                let even = series.iter().skip(2).step_by(2).any(|c| *c != Complex64::ZERO);
                built.full = even;
                let ellipse = series.len() == 2;
                let symmetry = if even { Symmetry::Full } else { Symmetry::Auto };
                if ellipse {
                    let force = series.get(1).map_or(0.0, |c| c.norm());
                    Arc::new(ScaledLoop::ellipse(*displacement, force, *magnitude, *phase)?)
                } else {
                    let measured = Loop::new(*displacement, series.clone())?;
                    Arc::new(ScaledLoop::new(&measured, 0.0, *magnitude, *phase, symmetry)?)
                }
            }
            Self::LoopFamily { loops } => {
                let loops: Vec<Loop> = loops
                    .iter()
                    .map(|(a, series)| Loop::new(*a, series.clone()))
                    .collect::<std::result::Result<_, _>>()?;
                let family = LoopFamily::new(&loops, 0.0, Symmetry::Auto)?;
                built.family = Some(family.clone());
                Arc::new(family)
            }
            Self::ElasticCoulomb { stiffness, slip_force } => {
                Arc::new(ElasticCoulomb::new(ElasticCoulombParameters {
                    stiffness: *stiffness,
                    slip_force: *slip_force,
                })?)
            }
            Self::IwanSmooth { displacement, force, range } => {
                let parameters = IwanParameters {
                    displacement: *displacement,
                    force: *force,
                    magnitude: MagnitudeLaw::default(),
                    range: *range,
                };
                Arc::new(Iwan::from_magnitude(parameters)?)
            }
            Self::IwanPolygon { backbone } => Arc::new(Iwan::from_backbone(backbone)?),
            Self::Cubic { stiffness } => Arc::new(Cubic::new(CubicParameters { stiffness: *stiffness })?),
            Self::Linear { stiffness } => Arc::new(Linear::new(LinearParameters { stiffness: *stiffness })?),
            Self::Coulomb { slip_force, velocity } => {
                let parameters = CoulombParameters { slip_force: *slip_force, velocity: *velocity };
                Arc::new(Coulomb::new(parameters)?)
            }
            Self::Measured { record } => {
                let fit = hysteresis::fit(record, &FitSettings::default()).map_err(|e| anyhow!("{e}"))?;
                let measured = fit.hysteresis_loop;
                let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
                let law = ScaledLoop::new(&measured, fit.noise, magnitude, phase, Symmetry::Odd)?;
                built.spec = Self::ScaledLoop {
                    displacement: measured.displacement_amplitude(),
                    series: measured.odd_part().coefficients().to_vec(),
                    magnitude,
                    phase,
                };
                Arc::new(law)
            }
        };
        Ok(built)
    }

    /// Bound of |F_1| in N that the law reaches for large amplitudes; `None` for a spring's force, which has none.
    pub(super) fn first_harmonic_limit(&self) -> Option<f64> {
        let four_over_pi = 4.0 / std::f64::consts::PI;
        match self {
            // g(1e9): farther nobody goes.
            Self::ScaledLoop { series, magnitude, .. } => {
                Some(series.get(1).map_or(0.0, |c| c.norm()) * magnitude.value(1e9))
            }
            Self::Measured { .. } => None,
            // Of the largest loop; more is extrapolated.
            Self::LoopFamily { loops } => loops
                .iter()
                .map(|(_, c)| c.get(1).map_or(0.0, |c| c.norm()))
                .fold(None, |least: Option<f64>, f| Some(least.map_or(f, |least| least.min(f)))),
            Self::ElasticCoulomb { slip_force, .. } | Self::Coulomb { slip_force, .. } => {
                Some(four_over_pi * slip_force)
            }
            Self::IwanPolygon { backbone } => match backbone.as_slice() {
                [.., a, b] if b[1] == a[1] => Some(four_over_pi * b[1]),
                _ => None,
            },
            Self::IwanSmooth { .. } | Self::Cubic { .. } | Self::Linear { .. } => None,
        }
    }

    /// Magnitude that a set-valued law holds at rest.
    pub(super) fn holding_force(&self) -> f64 {
        match self {
            Self::ScaledLoop { series, magnitude, .. } => {
                series.get(1).map_or(0.0, |c| c.norm()) * magnitude.value(0.0)
            }
            _ => 0.0,
        }
    }
}
