//! Models with known answers, shared by the cross-crate tests and the benchmarks.

pub mod joint_models;
pub mod orbit_models;
pub mod planar_truth;

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use contact::{
    Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Law, MagnitudeLaw, Motion, PhaseLaw,
    ScaledLoop, Symmetry,
};
use faer::{Mat, mat};
use hbm::{Contact, Damping, Excitation, ExcitationKind, Model, Plan, Problem};
use hysteresis::{FitSettings, Loop, ReadOptions, Record};
use num_complex::Complex64;
use serde_json::Value;

/// cos-force of `amplitude` on `dof`, first harmonic.
pub fn force(dof: usize, amplitude: f64) -> Excitation {
    Excitation { dof, harmonic: 1, amplitude, phase: 0.0, kind: ExcitationKind::Force }
}

/// A contact between dof 0 and the ground.
pub fn to_ground(law: Arc<dyn Law>) -> Contact {
    Contact { name: "root".into(), first: 0, second: None, law, scale: 1.0 }
}

/// A model from its matrices.
pub fn model(mass: Mat<f64>, damping: Mat<f64>, stiffness: Mat<f64>) -> Model {
    Model::new(mass, Damping::Matrix(damping), stiffness).expect("matrices of a test model")
}

/// The two masses of scene R with any law at w1: 43 Hz and 108 Hz without it.
pub fn two_mass(law: Arc<dyn Law>) -> Problem {
    Problem {
        joints: Vec::new(),
        model: model(
            mat![[3.98, 0.0], [0.0, 1.27]],
            mat![[24.0, 0.0], [0.0, 24.0]],
            mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
        ),
        excitation: vec![force(1, 9.1)],
        contacts: vec![to_ground(law)],
        output: vec![0, 1],
    }
}

/// Elastic Coulomb element.
pub fn elastic_coulomb(stiffness: f64, slip_force: f64) -> Arc<dyn Law> {
    let parameters = ElasticCoulombParameters { stiffness, slip_force };
    Arc::new(ElasticCoulomb::new(parameters).expect("parameters of a test law"))
}

/// Scene R: the reconstructed two masses with an elastic Coulomb contact, x_c = 2.232 µm.
pub fn scene_r() -> Problem {
    two_mass(elastic_coulomb(6.705e6, 6.705e6 * 2.232e-6))
}

/// Scene P: unit masses, k1 = k2 = 190 kN/m, 3 N, with any law at w1.
pub fn unit_masses(law: Arc<dyn Law>) -> Problem {
    Problem {
        joints: Vec::new(),
        model: model(
            mat![[1.0, 0.0], [0.0, 1.0]],
            mat![[2.0, 0.0], [0.0, 2.0]],
            mat![[3.8e5, -1.9e5], [-1.9e5, 1.9e5]],
        ),
        excitation: vec![force(1, 3.0)],
        contacts: vec![to_ground(law)],
        output: vec![0, 1],
    }
}

/// Scene P: elastic Coulomb 60 kN/m, 1 N.
pub fn scene_p() -> Problem {
    unit_masses(elastic_coulomb(6e4, 1.0))
}

/// Scene P with a cubic spring of 1e9 N/m³ instead.
pub fn scene_p_cubic() -> Problem {
    unit_masses(Arc::new(Cubic::new(CubicParameters { stiffness: 1e9 }).expect("parameters of a test law")))
}

/// The shipped synthetic 8 µm loop, through the whole pipeline from its file.
pub fn reference_loop() -> Loop {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/loops/reference.csv");
    let record = Record::read(&path, &ReadOptions::default()).expect("the shipped record");
    hysteresis::fit(&record, &FitSettings::default()).expect("the shipped record").hysteresis_loop
}

/// The paper's law on the shipped loop.
pub fn scaled_reference_loop() -> Arc<dyn Law> {
    let (magnitude, phase) = (MagnitudeLaw::default(), PhaseLaw::default());
    Arc::new(
        ScaledLoop::new(&reference_loop(), 0.0, magnitude, phase, Symmetry::Auto).expect("the paper's law"),
    )
}

/// A motion in harmonics and samples, as a law is asked about it.
pub struct SampledMotion {
    spectrum: Vec<Complex64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl SampledMotion {
    /// `samples` samples of `w(τ) = Re Σ W_k e^{ikτ}`, by the definition.
    pub fn new(spectrum: &[Complex64], samples: usize) -> Self {
        let at = |j: usize, power: i32| -> f64 {
            let tau = TAU * j as f64 / samples as f64;
            let term = |(k, w): (usize, &Complex64)| {
                (w * Complex64::new(0.0, k as f64).powi(power) * Complex64::cis(k as f64 * tau)).re
            };
            spectrum.iter().enumerate().map(term).sum()
        };
        Self {
            spectrum: spectrum.to_vec(),
            displacement: (0..samples).map(|j| at(j, 0)).collect(),
            velocity: (0..samples).map(|j| at(j, 1)).collect(),
        }
    }

    /// The form in which laws take it.
    pub fn motion(&self) -> Motion<'_> {
        Motion {
            spectrum: &self.spectrum,
            displacement: &self.displacement,
            velocity: &self.velocity,
            odd: self.spectrum.iter().step_by(2).all(|w| *w == Complex64::ZERO),
            omega: 1.0,
        }
    }
}

/// The paper's scene: two masses with the paper's law on the shipped loop.
pub fn paper_scene() -> Problem {
    two_mass(scaled_reference_loop())
}

/// An exact orbit of `reference/exact_orbits.json`.
pub struct ExactOrbit {
    /// In Hz.
    pub hertz: f64,
    /// Harmonics of w1 in m, with their orders.
    pub harmonics: Vec<(usize, Complex64)>,
    /// In J per cycle.
    pub dissipation: f64,
}

/// The exact orbits of scene `"R"` or `"P"`.
pub fn exact_orbits(scene: &str) -> Vec<ExactOrbit> {
    let data: Value =
        serde_json::from_str(include_str!("reference/exact_orbits.json")).expect("the reference data");
    let number = |v: &Value| v.as_f64().expect("a number");
    let points = data[scene]["points"].as_array().expect("a scene of the reference data");
    let orbit = |point: &Value| ExactOrbit {
        hertz: number(&point["hertz"]),
        harmonics: (point["w1"].as_array().expect("a spectrum").iter())
            .map(|h| (number(&h[0]) as usize, Complex64::new(number(&h[1]), number(&h[2]))))
            .collect(),
        dissipation: number(&point["dissipation"]),
    };
    points.iter().map(orbit).collect()
}

impl ExactOrbit {
    /// Relative l2 error of the spectrum of w1 over all harmonics.
    pub fn error(&self, plan: &Plan, found: &[Complex64]) -> f64 {
        let at = |k: usize| {
            let slot = plan.orders().iter().position(|&order| order == k);
            slot.and_then(|slot| found.get(slot)).copied().unwrap_or(Complex64::ZERO)
        };
        let difference: f64 = self.harmonics.iter().map(|&(k, w)| (at(k) - w).norm_sqr()).sum();
        let size: f64 = self.harmonics.iter().map(|(_, w)| w.norm_sqr()).sum();
        (difference / size).sqrt()
    }
}
