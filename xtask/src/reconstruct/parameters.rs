//! The six numbers of the search, and the problems that they describe.

use std::f64::consts::TAU;
use std::sync::Arc;

use anyhow::Result;
use contact::{ElasticCoulomb, ElasticCoulombParameters, Law, MagnitudeLaw, PhaseLaw, ScaledLoop};
use faer::mat;
use hbm::{Contact, Damping, Excitation, ExcitationKind, Model, Problem};

use crate::paper::reading::{Agreement, BLADE, QUASI_STATIC, ROOT, Response};
use crate::paper::statements::AGREE;

/// W* in m: amplitude of the paper's reference loop.
pub(crate) const DISPLACEMENT: f64 = 8e-6;
/// F* in N: assumed; it scales masses, stiffnesses, damping and excitation alike.
pub(crate) const FORCE: f64 = 12.0;

/// Number of unknowns.
pub(crate) const COUNT: usize = 6;

/// A set of parameters, without dimensions but for time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parameters {
    /// √(c1/m1) / 2π in Hz.
    pub(crate) frequency: f64,
    /// m2/m1.
    pub(crate) mass_ratio: f64,
    /// d/m1 in 1/s.
    pub(crate) damping: f64,
    /// F*/(c1 W*).
    pub(crate) friction: f64,
    /// f̂/F*.
    pub(crate) excitation: f64,
    /// x_c/W*.
    pub(crate) slip: f64,
}

/// The same with dimensions: kg, N/m, N s/m, N, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Physical {
    pub(crate) mass: [f64; 2],
    /// c1 = c2.
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) excitation: f64,
    /// k_t.
    pub(crate) contact_stiffness: f64,
    /// F_s = k_t x_c.
    pub(crate) slip_force: f64,
}

impl Parameters {
    /// Where the set lies in the search: the logarithms of its numbers.
    pub(crate) fn place(&self) -> [f64; COUNT] {
        [self.frequency, self.mass_ratio, self.damping, self.friction, self.excitation, self.slip]
            .map(f64::ln)
    }

    pub(crate) fn from_values(
        [frequency, mass_ratio, damping, friction, excitation, slip]: [f64; COUNT],
    ) -> Self {
        Self { frequency, mass_ratio, damping, friction, excitation, slip }
    }

    /// With dimensions; k_t makes the static responses of m2 equal. `None` where no spring does.
    pub(crate) fn physical(&self) -> Result<Option<Physical>> {
        let stiffness = FORCE / (self.friction * DISPLACEMENT);
        let mass = stiffness / (TAU * self.frequency).powi(2);
        let mut physical = Physical {
            mass: [mass, self.mass_ratio * mass],
            stiffness,
            damping: self.damping * mass,
            excitation: self.excitation * FORCE,
            contact_stiffness: 0.0,
            slip_force: 0.0,
        };
        let at_rest = Response::new(&physical.hysteresis()?)?.amplitude(QUASI_STATIC, BLADE);
        // |W_1| of m2 = f̂ (1/c2 + 1/(c1 + k_t)) while the contact sticks.
        let spring = 1.0 / (at_rest / physical.excitation - 1.0 / stiffness) - stiffness;
        physical.contact_stiffness = spring;
        physical.slip_force = spring * self.slip * DISPLACEMENT;
        Ok((spring > 0.0 && spring.is_finite()).then_some(physical))
    }
}

impl Physical {
    /// With the paper's law.
    pub(crate) fn hysteresis(&self) -> Result<Problem> {
        self.problem(Arc::new(ScaledLoop::ellipse(
            DISPLACEMENT,
            FORCE,
            MagnitudeLaw::default(),
            PhaseLaw::default(),
        )?))
    }

    /// With elastic Coulomb friction.
    pub(crate) fn coulomb(&self) -> Result<Problem> {
        let parameters =
            ElasticCoulombParameters { stiffness: self.contact_stiffness, slip_force: self.slip_force };
        self.problem(Arc::new(ElasticCoulomb::new(parameters)?))
    }

    fn problem(&self, law: Arc<dyn Law>) -> Result<Problem> {
        let ([m1, m2], c, d) = (self.mass, self.stiffness, self.damping);
        let model = Model::new(
            mat![[m1, 0.0], [0.0, m2]],
            Damping::Matrix(mat![[d, 0.0], [0.0, d]]),
            mat![[2.0 * c, -c], [-c, c]],
        )?;
        let amplitude = self.excitation;
        Ok(Problem {
            joints: Vec::new(),
            model,
            excitation: vec![Excitation {
                dof: 1,
                harmonic: 1,
                amplitude,
                phase: 0.0,
                kind: ExcitationKind::Force,
            }],
            contacts: vec![Contact { name: "root".into(), first: 0, second: None, law, scale: 1.0 }],
            output: vec![0, 1],
        })
    }
}

/// A number to be reported, with how far it is determined.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quantity {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) value: fn(&Parameters, &Physical) -> f64,
}

/// The unknowns, and what follows from them: k_t and how well both models agree.
pub(crate) const QUANTITIES: [Quantity; COUNT + 3] = [
    Quantity { name: "√(c1/m1) / 2π", unit: "Hz", value: |p, _| p.frequency },
    Quantity { name: "m2/m1", unit: "", value: |p, _| p.mass_ratio },
    Quantity { name: "d/m1", unit: "1/s", value: |p, _| p.damping },
    Quantity { name: "F*/(c1 W*)", unit: "", value: |p, _| p.friction },
    Quantity { name: "f̂/F*", unit: "", value: |p, _| p.excitation },
    Quantity { name: "x_c/W*", unit: "", value: |p, _| p.slip },
    Quantity {
        name: "k_t W*/F*",
        unit: "",
        value: |_, physical| physical.contact_stiffness * DISPLACEMENT / FORCE,
    },
    Quantity {
        name: "median difference of the models, m1",
        unit: "%",
        value: |_, physical| median_difference(physical, ROOT),
    },
    Quantity {
        name: "median difference of the models, m2",
        unit: "%",
        value: |_, physical| median_difference(physical, BLADE),
    },
];

/// Of |W_1| in %, over the whole range in which the paper says that the models agree; not a number where one has no
/// solution.
fn median_difference(physical: &Physical, output: usize) -> f64 {
    let agreement = || Agreement::of(&physical.hysteresis()?, &physical.coulomb()?, output, AGREE[0], 1.0);
    agreement().map_or(f64::NAN, |agreement| 100.0 * agreement.median)
}
