//! The families of cases: each drives one or several quantities to their extremes and leaves the others moderate.

use std::f64::consts::TAU;
use std::sync::Arc;

use contact::{MagnitudeLaw, PhaseLaw};
use hbm::{Excitation, ExcitationKind};
use hysteresis::Record;
use hysteresis::synthetic::{DirtyRecord, dahl_loop};
use num_complex::Complex64;

use super::balance::Rows;
use super::case::{Case, ContactSpec, DampingSpec, Label, Reason};
use super::draw::{Draw, KINDS};
use super::label::{self, Special};
use super::law::LawSpec;
use super::reference_force::first_harmonic;

/// A family: its name, what it drives to the extreme, and its share of the quick run.
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) what: &'static str,
    pub(super) share: usize,
    make: fn(&mut Draw, usize) -> Case,
}

/// All families. The order is part of a case's seed: append only.
pub(super) const FAMILIES: [Family; 22] = [
    Family {
        name: "stiffness",
        what: "contact stiffness 1e-6 … 1e14 of the structure's",
        share: 120,
        make: stiffness,
    },
    Family { name: "force", what: "slip force 1e-12 … 1e12 of the excitation", share: 90, make: force },
    Family { name: "alpha", what: "amplitude 1e-9 … 1e9 of the loop's", share: 90, make: alpha },
    Family { name: "damping", what: "damping ratio 0, 1e-12 … 0.5", share: 60, make: damping },
    Family { name: "frequency", what: "frequency 1e-6 … 1e3 of a natural one", share: 90, make: frequency },
    Family {
        name: "free-resonance",
        what: "exactly at a resonance of the free structure",
        share: 60,
        make: free_resonance,
    },
    Family {
        name: "stuck-resonance",
        what: "exactly at a resonance with the contact fixed or sticking",
        share: 60,
        make: stuck_resonance,
    },
    Family { name: "harmonics", what: "N up to 511", share: 24, make: harmonics },
    Family { name: "masses", what: "mass and stiffness ratios 1e-9 … 1e9", share: 60, make: masses },
    Family {
        name: "records",
        what: "records of 3 points, of 1e6, with noise of 1 % and 100 %",
        share: 12,
        make: records,
    },
    Family {
        name: "holding",
        what: "g(0) near zero, excitation at the holding limit",
        share: 60,
        make: holding,
    },
    Family {
        name: "grazing",
        what: "amplitude within 1e-12 of the slip displacement",
        share: 60,
        make: grazing,
    },
    Family { name: "zero", what: "no excitation", share: 30, make: zero },
    Family {
        name: "excitation",
        what: "harmonic 3 only, several harmonics, static loads, base, unbalance",
        share: 60,
        make: excitation,
    },
    Family { name: "many", what: "64 identical contacts", share: 6, make: many },
    Family { name: "twice", what: "the same contact twice or more", share: 40, make: twice },
    Family { name: "massless", what: "contact dof without mass", share: 40, make: massless },
    Family { name: "static", what: "frequency 0", share: 30, make: still },
    Family { name: "free-body", what: "free rigid-body motion", share: 30, make: free_body },
    Family {
        name: "negative",
        what: "scaling laws that become negative, loops with even harmonics",
        share: 20,
        make: negative,
    },
    Family {
        name: "ladder", what: "contact stiffness 1e0 … 1e12 at N = 1, 7, 31", share: 26, make: ladder
    },
    Family { name: "mixed", what: "everything at once", share: 100, make: mixed },
];

/// Case `index` of family number `family`.
pub(super) fn case(seed: u64, family: usize, index: usize) -> Case {
    let mut draw = Draw::new(seed, family, index);
    let Family { name, make, .. } = &FAMILIES[family];
    let mut case = make(&mut draw, index);
    case.id = format!("{name}-{index}");
    case.family = name;
    case
}

/// What a moderate case is made of, before it is driven anywhere.
struct Frame {
    mass: Vec<f64>,
    springs: Vec<f64>,
    damping: f64,
    /// Ratio to a natural frequency.
    frequency: f64,
    harmonics: usize,
    kind: &'static str,
    /// Contact stiffness over the structure's, slip force over the excitation.
    stiffness: f64,
    force: f64,
    excitation: f64,
}

impl Frame {
    fn moderate(draw: &mut Draw) -> Self {
        let dofs = draw.pick(&[1, 2, 2, 2, 3]);
        let (m, k) = (draw.decades(-3.0, 3.0), draw.decades(3.0, 8.0));
        Self {
            mass: (0..dofs).map(|_| m * draw.decades(-0.7, 0.7)).collect(),
            springs: (0..dofs).map(|_| k * draw.decades(-0.7, 0.7)).collect(),
            damping: draw.decades(-3.0, -0.7),
            frequency: draw.decades(-1.0, 0.6),
            harmonics: draw.harmonics(),
            kind: draw.pick(&KINDS),
            stiffness: draw.decades(-1.5, 1.5),
            force: draw.decades(-1.5, 1.5),
            excitation: draw.decades(-3.0, 3.0),
        }
    }

    /// A chain: ground, the first spring, the first mass, the second spring, …; contact at the first mass, excitation at the last.
    fn case(&self, draw: &mut Draw) -> Case {
        let n = self.mass.len();
        let mut stiffness = vec![vec![0.0; n]; n];
        for (i, k) in self.springs.iter().enumerate() {
            stiffness[i][i] += k;
            if i > 0 {
                stiffness[i - 1][i - 1] += k;
                stiffness[i - 1][i] -= k;
                stiffness[i][i - 1] -= k;
            }
        }
        let mut mass = vec![vec![0.0; n]; n];
        for (i, m) in self.mass.iter().enumerate() {
            mass[i][i] = *m;
        }
        let damping =
            if self.damping == 0.0 { DampingSpec::None } else { DampingSpec::ModalRatio(self.damping) };
        let mut case = Case {
            id: String::new(),
            family: "",
            mass,
            stiffness,
            damping,
            loads: vec![draw.force(n - 1, 1, self.excitation)],
            contacts: Vec::new(),
            frequency: 0.0,
            harmonics: self.harmonics,
            label: Label::Solvable,
            threshold: false,
        };
        let natural = natural_frequencies(&case);
        case.frequency = self.frequency * if natural.is_empty() { 1.0 } else { draw.pick(&natural) };
        let own = self.springs.first().copied().unwrap_or(1.0);
        let law =
            draw.law(self.kind, self.stiffness * own, self.force * self.excitation, TAU * case.frequency);
        case.contacts.push(ContactSpec { first: 0, second: None, law, scale: 1.0 });
        case
    }
}

fn natural_frequencies(case: &Case) -> Vec<f64> {
    let all = case.model().map(|model| model.natural_frequencies()).unwrap_or_default();
    all.into_iter().filter(|hertz| *hertz > 0.0).collect()
}

fn labelled(mut case: Case, special: Special) -> Case {
    case.label = label::label(&case, special);
    case
}

fn stiffness(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.stiffness = draw.decades(-6.0, 14.0);
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn force(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.force = draw.decades(-12.0, 12.0);
    let case = frame.case(draw);
    labelled(case, Special::None)
}

/// The excitation that gives the wanted amplitude with one harmonic: `|u⁰| = |a + G F_1(a)|`, and u⁰ is proportional to it.
fn alpha(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = draw.pick(&KINDS[..6]);
    frame.harmonics = draw.pick(&[1, 1, 1, 3]);
    let mut case = frame.case(draw);
    let spec = case.contacts[0].law.clone();
    let length = label::length(&spec);
    let a = length * draw.decades(-9.0, 9.0);
    if let (Ok(built), Ok(model)) = (spec.build(), case.model()) {
        let (g, free) = Rows::new(&case, &model, 1).receptances()[0];
        let wanted = (a + g * first_harmonic(&built, a)).norm();
        case.loads[0].amplitude *= wanted / free.norm();
    }
    labelled(case, Special::None)
}

fn damping(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.damping = if draw.chance(0.4) { 0.0 } else { draw.decades(-12.0, -0.3) };
    frame.frequency = draw.decades(-0.5, 0.5);
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn frequency(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.frequency = draw.decades(-6.0, 3.0);
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn free_resonance(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.frequency = 1.0;
    let undamped = draw.chance(0.6);
    frame.damping = if undamped { 0.0 } else { draw.decades(-9.0, -1.0) };
    frame.stiffness = draw.decades(-4.0, 8.0);
    let case = frame.case(draw);
    labelled(case, if undamped { Special::FreeResonance } else { Special::None })
}

/// The first dof fixed, or held by the law's spring, undamped or not. The free structure is regular there.
fn stuck_resonance(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.damping = if draw.chance(0.6) { 0.0 } else { draw.decades(-9.0, -1.0) };
    frame.stiffness = draw.decades(-2.0, 10.0);
    frame.kind = draw.pick(&KINDS[..7]);
    let mut case = frame.case(draw);
    let mut changed = case.clone();
    if frame.mass.len() > 1 && draw.chance(0.5) {
        let cut = |rows: &[Vec<f64>]| rows[1..].iter().map(|row| row[1..].to_vec()).collect();
        (changed.mass, changed.stiffness) = (cut(&case.mass), cut(&case.stiffness));
    } else {
        changed.stiffness[0][0] += frame.stiffness * frame.springs[0];
    }
    let natural = natural_frequencies(&changed);
    if !natural.is_empty() {
        case.frequency = draw.pick(&natural);
    }
    labelled(case, Special::StuckResonance)
}

fn harmonics(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.harmonics = [31, 63, 31, 127, 31, 63, 255, 63, 31, 511][index % 10];
    frame.kind =
        if frame.harmonics > 127 { draw.pick(&["elastic_coulomb", "linear"]) } else { draw.pick(&KINDS) };
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn masses(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    for m in &mut frame.mass {
        *m *= draw.decades(-4.5, 4.5);
    }
    if draw.chance(0.5) {
        for k in &mut frame.springs {
            *k *= draw.decades(-4.5, 4.5);
        }
    }
    let case = frame.case(draw);
    labelled(case, Special::None)
}

/// A rig's record of Dahl's loop. Three points are no cycle; noise as strong as the force leaves no loop to be sure of.
fn records(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = "scaled_loop";
    frame.harmonics = draw.pick(&[1, 1, 3]);
    let mut case = frame.case(draw);
    let force = frame.force * frame.excitation;
    let displacement = force / (frame.stiffness * frame.springs[0]);
    let Ok(truth) = dahl_loop(displacement, force, 3.0 * force / displacement, 15) else { return case };
    let mut dirty = DirtyRecord { seed: index as u64, ..DirtyRecord::new(truth) };
    let mut label = None;
    match index % 12 {
        0 => dirty.samples_per_cycle = 1e6 / 9.0,
        1..=3 => label = Some(Reason::NoLoop),
        4..=8 => dirty.force_noise = 0.01,
        _ => {
            dirty.force_noise = 1.0;
            label = Some(Reason::NoLoop);
        }
    }
    let mut record = dirty.generate();
    if (1..=3).contains(&(index % 12)) {
        let take = |row: &[f64]| [row[100], row[300], row[500]].map(|x| x + 0.0).to_vec();
        record = Record {
            time: None,
            displacement: take(&record.displacement),
            force: take(&record.force),
            lines: Vec::new(),
        };
    }
    case.contacts[0].law = LawSpec::Measured { record: Arc::new(record) };
    // A little above what a loop of this size holds nothing is refused; the shell beneath is narrow, and with one harmonic there is none.
    case.label = match label {
        Some(reason) => Label::MayBeRefused(reason),
        None if case.harmonics == 1 => Label::Solvable,
        None => Label::MayBeRefused(Reason::HoldingShell),
    };
    case
}

/// The loop's force such that the contact nearly, just or hardly holds the excitation.
fn holding(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = "scaled_loop";
    let mut case = frame.case(draw);
    let shift: f64 = draw.pick(&[0.01, 0.01, 1e-6, 1e-3]);
    // g(0) = offset + 0.21 ln(shift): from zero up.
    let rest = draw.pick(&[0.0, 1e-15, 1e-12, 1e-6, 1e-3, 0.0129]);
    let magnitude = MagnitudeLaw { offset: rest - 0.21 * shift.ln(), slope: 0.21, shift };
    let blocked = label::blocked(&case).map_or(1.0, |forces| label::peak(&forces));
    let away =
        draw.pick(&[0.0, 1e-16, -1e-16, 1e-13, -1e-13, 1e-10, -1e-10, 1e-6, -1e-6, 1e-2, -1e-2, 0.5, -0.5]);
    if let LawSpec::ScaledLoop { magnitude: g, series, displacement, .. } = &mut case.contacts[0].law {
        *g = magnitude;
        let value = magnitude.value(0.0);
        if value > 1e-14 {
            let factor = blocked / (1.0 + away) / (value * series[1].norm());
            series.iter_mut().for_each(|c| *c *= factor);
            *displacement *= factor;
        }
    }
    case.threshold = f64::abs(away) < 1e-9;
    labelled(case, Special::None)
}

/// The slip displacement such that the sticking amplitude `|u⁰/(1 + G k)|` is all but reached.
fn grazing(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = "elastic_coulomb";
    frame.damping = if draw.chance(0.2) { 0.0 } else { frame.damping };
    frame.stiffness = draw.decades(-4.0, 8.0);
    let mut case = frame.case(draw);
    let away = draw.pick(&[0.0, 1e-16, -1e-16, 3e-16, -3e-16, 1e-14, -1e-14, 1e-12, -1e-12, 1e-9, -1e-9]);
    let stiff = frame.stiffness * frame.springs[0];
    if let Ok(model) = case.model() {
        let (g, free) = Rows::new(&case, &model, 1).receptances()[0];
        let amplitude = (free / (Complex64::ONE + g * stiff)).norm();
        case.contacts[0].law =
            LawSpec::ElasticCoulomb { stiffness: stiff, slip_force: stiff * amplitude * (1.0 + away) };
    }
    case.threshold = true;
    labelled(case, Special::None)
}

fn zero(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = KINDS[index % KINDS.len()];
    let mut case = frame.case(draw);
    case.loads[0].amplitude = 0.0;
    if draw.chance(0.3) {
        case.loads.clear();
    }
    case.label = Label::Solvable;
    case
}

fn excitation(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.harmonics = draw.pick(&[3, 3, 5, 7, 9]);
    let last = frame.mass.len() - 1;
    let mut case = frame.case(draw);
    match index % 6 {
        0 | 1 => case.loads[0].harmonic = 3,
        2 => {
            let size = frame.excitation * draw.decades(-3.0, 0.5);
            case.loads.push(draw.force(last, 3, size));
        }
        3 => {
            let size = frame.excitation * draw.decades(-3.0, 0.5);
            case.loads.push(draw.force(0, 2, size));
        }
        4 => {
            let size = frame.excitation * draw.decades(-3.0, 2.0);
            let load =
                Excitation { dof: 0, harmonic: 0, amplitude: size, phase: 0.0, kind: ExcitationKind::Force };
            case.loads.push(load);
        }
        _ => {
            let omega = TAU * case.frequency;
            let (kind, unit) = if draw.chance(0.5) {
                (ExcitationKind::Base, frame.mass[last])
            } else {
                (ExcitationKind::Unbalance, omega * omega)
            };
            case.loads[0].kind = kind;
            case.loads[0].amplitude /= unit;
            if kind == ExcitationKind::Base {
                case.loads[0].dof = 0;
            }
        }
    }
    // Only its odd motion is known to the judge for the smooth Iwan law; a softening spring needs one too.
    let even = case.loads.iter().any(|load| load.harmonic.is_multiple_of(2));
    if even && matches!(case.contacts[0].law, LawSpec::IwanSmooth { .. }) {
        case.contacts[0].law =
            draw.law("iwan_polygon", frame.stiffness * frame.springs[0], frame.force * frame.excitation, 1.0);
    }
    labelled(case, Special::None)
}

fn many(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    let (m, k) = (frame.mass[0], frame.springs[0]);
    frame.mass = vec![m; 64];
    frame.springs = vec![k; 64];
    frame.harmonics = [1, 1, 3][index % 3];
    frame.kind = draw.pick(&["elastic_coulomb", "scaled_loop", "iwan_polygon", "coulomb", "linear"]);
    let mut case = frame.case(draw);
    let law = case.contacts[0].law.clone();
    case.contacts =
        (0..64).map(|i| ContactSpec { first: i, second: None, law: law.clone(), scale: 1.0 }).collect();
    labelled(case, Special::None)
}

fn twice(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.stiffness = draw.decades(-3.0, 6.0);
    let mut case = frame.case(draw);
    let between = if frame.mass.len() > 1 && draw.chance(0.4) { Some(1) } else { None };
    case.contacts[0].second = between;
    let copies = draw.pick(&[1, 1, 1, 2, 4]);
    for _ in 0..copies {
        let again = case.contacts[0].clone();
        case.contacts.push(again);
    }
    labelled(case, Special::None)
}

fn massless(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    if frame.mass.len() == 1 {
        frame.mass.push(frame.mass[0]);
        frame.springs.push(frame.springs[0]);
    }
    frame.mass[0] = 0.0;
    frame.stiffness = draw.decades(-4.0, 8.0);
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn still(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.stiffness = draw.decades(-4.0, 8.0);
    let mut case = frame.case(draw);
    case.frequency = 0.0;
    if draw.chance(0.4) {
        case.loads[0].harmonic = 0;
        case.loads[0].phase = 0.0;
    }
    if matches!(case.contacts[0].law, LawSpec::IwanSmooth { .. }) && case.loads[0].harmonic == 0 {
        case.contacts[0].law = draw.law("linear", frame.stiffness * frame.springs[0], 1.0, 1.0);
    }
    labelled(case, Special::None)
}

/// A chain that hangs on nothing but its contact.
fn free_body(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    let own = frame.springs[0];
    frame.springs[0] = 0.0;
    let mut case = frame.case(draw);
    case.frequency = (own / frame.mass[0]).sqrt() / TAU * frame.frequency;
    case.damping = match draw.pick(&[0, 1]) {
        0 => DampingSpec::None,
        _ => DampingSpec::Rayleigh { seconds: 0.02 / (TAU * case.frequency), rate: 0.0 },
    };
    case.contacts[0].law =
        draw.law(frame.kind, frame.stiffness * own, frame.force * frame.excitation, TAU * case.frequency);
    let statically = draw.chance(0.3);
    if statically {
        let amplitude = 0.1 * frame.excitation;
        case.loads.push(Excitation {
            dof: 0,
            harmonic: 0,
            amplitude,
            phase: 0.0,
            kind: ExcitationKind::Force,
        });
        if matches!(case.contacts[0].law, LawSpec::IwanSmooth { .. }) {
            case.contacts[0].law = draw.law("linear", frame.stiffness * own, 1.0, 1.0);
        }
    }
    labelled(case, if statically { Special::FreeBody } else { Special::None })
}

/// g falls with the amplitude, down to zero at α = 1 or beyond; or the loop is not odd.
fn negative(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.kind = "scaled_loop";
    let mut case = frame.case(draw);
    let falling = index.is_multiple_of(2);
    if let LawSpec::ScaledLoop { magnitude, series, phase, .. } = &mut case.contacts[0].law {
        *phase = PhaseLaw::default();
        if falling {
            *magnitude =
                MagnitudeLaw { offset: draw.pick(&[0.0, 0.1, 1.0, -0.01]), slope: -0.2, shift: 0.01 };
        } else {
            let first = series[1];
            series.resize(4, Complex64::ZERO);
            series[2] = Complex64::from_polar(0.1 * first.norm(), draw.uniform(0.0, TAU));
        }
    }
    if falling {
        case.label = Label::MayBeRefused(Reason::NegativeMagnitude);
        return case;
    }
    labelled(case, Special::None)
}

/// The stated target: stiff contacts at N = 1, 7, 31, event-exact and sampled.
fn ladder(draw: &mut Draw, index: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.stiffness = 10.0_f64.powi((index % 13) as i32);
    frame.harmonics = [1, 7, 31][index / 13 % 3];
    frame.kind = ["elastic_coulomb", "scaled_loop", "iwan_polygon"][index / 39 % 3];
    let case = frame.case(draw);
    labelled(case, Special::None)
}

fn mixed(draw: &mut Draw, _: usize) -> Case {
    let mut frame = Frame::moderate(draw);
    frame.stiffness = draw.decades(-6.0, 12.0);
    frame.force = draw.decades(-9.0, 9.0);
    frame.damping = draw.decades(-6.0, -0.3);
    frame.frequency = draw.decades(-4.0, 2.0);
    for m in &mut frame.mass {
        *m *= draw.decades(-3.0, 3.0);
    }
    let case = frame.case(draw);
    labelled(case, Special::None)
}
