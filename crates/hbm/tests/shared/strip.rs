//! A strip of masses and springs with friction along it: three masses across, springs to all neighbours, its short edge
//! held.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use contact::{ElasticCoulomb, ElasticCoulombParameters};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, c64};
use hbm::{Contact, Damping, Excitation, ExcitationKind, Model, Problem, SparseDamping, SparseModel};

/// Masses across.
const ACROSS: usize = 3;

/// In kg.
const MASS: f64 = 0.1;

/// Of a spring between neighbours, in N/m.
pub const SPRING: f64 = 4e6;

/// The springs of the strip: (dof, dof or the support).
fn springs(dofs: usize) -> Vec<(usize, Option<usize>)> {
    let mut springs = Vec::new();
    for dof in 0..dofs {
        let (along, across) = (dof / ACROSS, dof % ACROSS);
        if along == 0 {
            springs.push((dof, None));
        }
        let ahead = dof + ACROSS;
        springs.extend((ahead < dofs).then_some((dof, Some(ahead))));
        let aside = dof + 1;
        springs.extend((across + 1 < ACROSS && aside < dofs).then_some((dof, Some(aside))));
    }
    springs
}

/// Entries (row, column, N/m) of the stiffness matrix, to be added up.
pub fn stiffness(dofs: usize) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::new();
    for (first, second) in springs(dofs) {
        entries.push((first, first, SPRING));
        if let Some(second) = second {
            entries.extend([(second, second, SPRING), (first, second, -SPRING), (second, first, -SPRING)]);
        }
    }
    entries
}

/// Entries of the mass matrix: no two masses alike.
pub fn mass(dofs: usize) -> Vec<(usize, usize, f64)> {
    (0..dofs).map(|i| (i, i, MASS * (1.0 + 0.2 * (i as f64 * 1.7).sin()))).collect()
}

/// Factors on mass and stiffness.
pub const DAMPING: (f64, f64) = (6.0, 2e-6);

/// Stiffness in N/m and slip force in N of contact `c`.
pub fn law(c: usize) -> (f64, f64) {
    (1.5e5, 0.6 * (1.0 + 0.6 * (c as f64 * 2.3).sin()))
}

/// Contacts to the ground and, every third, between neighbours across, of different strength.
pub fn contacts(dofs: usize, count: usize) -> Vec<Contact> {
    (0..count)
        .map(|c| {
            let first = (c * dofs) / count;
            let pair = c % 3 == 2 && first % ACROSS + 1 < ACROSS && first + 1 < dofs;
            let (stiffness, slip_force) = law(c);
            let parameters = ElasticCoulombParameters { stiffness, slip_force };
            Contact {
                name: format!("pad {c}"),
                first,
                second: pair.then_some(first + 1),
                law: Arc::new(ElasticCoulomb::new(parameters).unwrap()),
                scale: 1.0,
            }
        })
        .collect()
}

/// A force at the free end, and another one a third of the way.
pub fn excitation(dofs: usize) -> Vec<Excitation> {
    let force = |dof, amplitude, phase| Excitation {
        dof,
        harmonic: 1,
        amplitude,
        phase,
        kind: ExcitationKind::Force,
    };
    vec![force(dofs - 1, 12.0, 0.0), force(dofs / 3, 5.0, 1.0)]
}

/// The strip with dense matrices.
pub fn dense(dofs: usize, count: usize) -> Problem {
    let assemble = |entries: Vec<(usize, usize, f64)>| {
        let mut matrix = Mat::zeros(dofs, dofs);
        for (i, j, value) in entries {
            matrix[(i, j)] += value;
        }
        matrix
    };
    let damping = Damping::Rayleigh { mass: DAMPING.0, stiffness: DAMPING.1 };
    Problem {
        joints: Vec::new(),
        model: Model::new(assemble(mass(dofs)), damping, assemble(stiffness(dofs))).unwrap(),
        excitation: excitation(dofs),
        contacts: contacts(dofs, count),
        output: vec![dofs - 1],
    }
}

/// H at the angular frequency `omega`, from the entries of the strip.
#[allow(dead_code)]
pub fn dynamic_stiffness(dofs: usize, omega: f64) -> SparseColMat<usize, c64> {
    let (by_mass, by_stiffness) = DAMPING;
    let stiffness =
        stiffness(dofs).into_iter().map(|(i, j, c)| (i, j, c64::new(c, omega * by_stiffness * c)));
    let mass =
        mass(dofs).into_iter().map(|(i, j, m)| (i, j, c64::new(-omega * omega * m, omega * by_mass * m)));
    let entries: Vec<_> = stiffness.chain(mass).map(|(i, j, value)| Triplet::new(i, j, value)).collect();
    SparseColMat::try_new_from_triplets(dofs, dofs, &entries).unwrap()
}

/// So many equal oscillators on their own springs, each with a contact and a force.
#[allow(dead_code)]
pub fn single(count: usize) -> Problem {
    let diagonal = |value: f64| Mat::from_fn(count, count, |i, j| if i == j { value } else { 0.0 });
    let law =
        Arc::new(ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 8e4, slip_force: 1.2 }).unwrap());
    let contact = |first| Contact { name: "c".into(), first, second: None, law: law.clone(), scale: 1.0 };
    let force =
        |dof| Excitation { dof, harmonic: 1, amplitude: 3.0, phase: 0.4, kind: ExcitationKind::Force };
    Problem {
        model: Model::new(diagonal(1.0), Damping::Matrix(diagonal(9.0)), diagonal(1.4e5)).unwrap(),
        excitation: (0..count).map(force).collect(),
        contacts: (0..count).map(contact).collect(),
        output: vec![0],
        joints: Vec::new(),
    }
}

/// Frequencies in Hz over the first resonances.
#[allow(dead_code)]
pub fn frequencies(points: usize) -> Vec<f64> {
    (0..points).map(|i| 8.0 + 92.0 * i as f64 / points.max(2) as f64).collect()
}

/// The strip with sparse matrices.
#[allow(dead_code)]
pub fn sparse(dofs: usize, count: usize) -> Problem<SparseModel> {
    let assemble = |entries: Vec<(usize, usize, f64)>| {
        let entries: Vec<_> = entries.into_iter().map(|(i, j, value)| Triplet::new(i, j, value)).collect();
        SparseColMat::try_new_from_triplets(dofs, dofs, &entries).unwrap()
    };
    Problem {
        joints: Vec::new(),
        model: SparseModel {
            mass: assemble(mass(dofs)),
            damping: SparseDamping::Rayleigh { mass: DAMPING.0, stiffness: DAMPING.1 },
            stiffness: assemble(stiffness(dofs)),
        },
        excitation: excitation(dofs),
        contacts: contacts(dofs, count),
        output: vec![dofs - 1],
    }
}
