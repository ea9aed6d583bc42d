//! What mathematics says about a case before it is run.
//!
//! **Bounded or slowly growing forces** (elastic Coulomb, Coulomb, loops, Iwan without a spring): where every H_k is
//! regular, `u = u⁰ − G F(u)` maps a large ball into itself, as |F| grows more slowly than |u|, and F is continuous: Brouwer's
//! theorem gives a solution for every N. Damping makes every H_k regular; so does any frequency whose multiples miss the
//! resonances of an undamped model, which a random one does. A spring beside them (Iwan, linear) only changes H_k, and
//! Im(uᴴ H u) > 0 stays.
//!
//! **Springs** (cubic): Galerkin keeps `∫ f(w) ẇ dt = 0`, so damping bounds the velocity whatever the stiffness and its sign; the
//! degree is that of the linear problem, one. Without damping `Σ Re(F_k conj(u_k)) = (2/T) ∫ k₃ w⁴` dominates at infinity, and the degree of the
//! gradient of a definite form is not zero either, as long as no G_k vanishes.
//!
//! **Set-valued laws** (scaled loop): at rest any force within the limit is allowed; Kakutani's theorem takes Brouwer's place.
//! With one harmonic the forces at rest fill a disc and the rule of `stuck` is that disc: a solution exists always. With more harmonics
//! `stuck` asks for a force that stays within the limit at all times, while the convex set that Kakutani needs also contains forces whose first harmonic is up to
//! 4/π larger. A blocked force in that shell need not have a solution of either kind; beyond it the motion cannot be at rest.
//! With several contacts and several harmonics one cannot say beforehand which of them rest.
//!
//! **Exactly at an undamped resonance** the modal equation asks for a contact force that cancels the excitation, `F_1 = P`; friction has
//! one when |P| is below the limit of |F_1| for large amplitudes (Landesman and Lazer's condition), and none above.
//!
//! **Exactly at an undamped resonance of the sticking contact** the slider moves by as little as dissipates what the excitation
//! puts in, u = x_c + π/4 |u⁰|, and the phase is that of u⁰. A change ε of the frequency leaves 2 ε k x_c of the forces that
//! cancel: where that is not small against k u⁰, the numbers given do not determine the phase.

use num_complex::Complex64;

use super::balance::Rows;
use super::case::{Case, DampingSpec, Label, Reason};
use super::law::LawSpec;
use super::motion::Motion;

/// What a family knows about its cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Special {
    None,
    /// Undamped, exactly at a resonance of the structure without contact.
    FreeResonance,
    /// At a resonance of the structure with its contact fixed or sticking.
    StuckResonance,
    /// A static load on a structure that nothing supports.
    FreeBody,
}

/// The label of `case`.
pub(super) fn label(case: &Case, special: Special) -> Label {
    let refused = Label::MayBeRefused;
    let law = &case.contacts[0].law;
    let floating = case
        .stiffness
        .iter()
        .all(|row| row.iter().sum::<f64>().abs() <= 1e-9 * row.iter().map(|k| k.abs()).sum::<f64>());
    // The mean is an unknown where something even is excited and nothing but friction holds it; friction follows the mean.
    let even =
        case.loads.iter().any(|l| l.amplitude != 0.0 && (l.harmonic / case.fundamental()).is_multiple_of(2));
    let spring = matches!(law, LawSpec::Linear { .. } | LawSpec::Cubic { .. } | LawSpec::IwanSmooth { .. });
    if floating && (special == Special::FreeBody || even) && !spring {
        return refused(Reason::FreeBody);
    }
    if special == Special::FreeResonance && !matches!(law, LawSpec::Coulomb { .. }) {
        return at_resonance(case, law);
    }
    if special == Special::StuckResonance && is_undetermined(case) {
        return refused(Reason::Undetermined);
    }
    if case.contacts.iter().any(|contact| is_staircase(case, &contact.law)) {
        return refused(Reason::Staircase);
    }
    let sets = case.contacts.iter().any(|c| c.law.holding_force() > 0.0);
    if sets && (case.harmonics > case.fundamental() || even) {
        return shell(case, law);
    }
    Label::Solvable
}

/// Whether samples of `F_s tanh(ẇ/v)` resolve its flank no more: their sum is then a staircase over the motion, and its solution may lie on
/// a riser that is narrower than a rounding unit. A damper only reduces the velocity that the contact has without it, as Re(iG) ≥ 0.
fn is_staircase(case: &Case, law: &LawSpec) -> bool {
    let Ok(model) = case.model() else { return false };
    // A polygon's sliders stick for a share √(x/a) of the period after a turning point: far less than the way between samples.
    if let (LawSpec::IwanPolygon { backbone }, true) = (law, case.harmonics > case.fundamental()) {
        let amplitude: f64 = case
            .loads
            .iter()
            .flat_map(|load| Rows::new(case, &model, load.harmonic).receptances())
            .map(|(_, free)| free.norm())
            .fold(0.0, f64::max);
        return backbone.first().is_some_and(|[x, _]| amplitude > 1e4 * x);
    }
    let LawSpec::Coulomb { velocity, .. } = law else { return false };
    let rate = |load: &hbm::Excitation| {
        let all = Rows::new(case, &model, load.harmonic).receptances();
        let free = all.iter().map(|(_, free)| free.norm()).fold(0.0, f64::max);
        std::f64::consts::TAU * case.frequency * load.harmonic as f64 * free
    };
    let rate: f64 = case.loads.iter().map(rate).sum();
    rate.is_nan() || rate > 100.0 * velocity
}

/// Sixteen rounding units of the force of a sticking spring may be as much as this part of the excitation at it.
const DETERMINED: f64 = 1e-7;

/// Whether the excitation is lost in the last digits of the forces that cancel at an undamped resonance of the sticking contact.
fn is_undetermined(case: &Case) -> bool {
    let [contact] = case.contacts.as_slice() else { return false };
    let LawSpec::ElasticCoulomb { stiffness, .. } = contact.law else { return false };
    let (DampingSpec::None, Ok(model)) = (&case.damping, case.model()) else { return false };
    case.loads.iter().filter(|load| load.amplitude != 0.0).any(|load| {
        let Some(&(g, free)) = Rows::new(case, &model, load.harmonic).receptances().first() else {
            return false;
        };
        let detuning = (1.0 + stiffness * contact.scale * g).norm();
        let least = 16.0 * f64::EPSILON / DETERMINED * length(&contact.law);
        detuning < 1e-9 && free.norm() < least
    })
}

fn at_resonance(case: &Case, law: &LawSpec) -> Label {
    let Some(limit) = law.first_harmonic_limit() else { return Label::Solvable };
    // u⁰/G has a limit at the resonance: a little beside it both are regular.
    let mut beside = case.clone();
    beside.frequency *= 1.0 + 1e-6;
    let wanted = blocked(&beside).map_or(f64::INFINITY, |forces| peak(&forces));
    if wanted > 0.9 * limit {
        return Label::MayBeRefused(Reason::UnboundedResonance);
    }
    if case.harmonics > 1 && law.holding_force() > 0.0 {
        return shell(&beside, law);
    }
    Label::Solvable
}

/// Whether the blocked force lies between what the contact holds and what no motion at rest can need.
fn shell(case: &Case, law: &LawSpec) -> Label {
    if case.contacts.len() > 1 {
        return Label::MayBeRefused(Reason::HoldingShell);
    }
    let Some(forces) = blocked(case) else { return Label::MayBeRefused(Reason::HoldingShell) };
    let limit = law.holding_force() * case.contacts[0].scale;
    let LawSpec::ScaledLoop { series, magnitude, phase, .. } = law else { return Label::Solvable };
    // The largest force of a loop at rest: c_1, and the higher harmonics with σ(0).
    let sine = -(phase.limit - phase.span).sin();
    let first = series.get(1).copied().unwrap_or_default();
    let sigma = magnitude.value(0.0) * first.norm() * sine / first.im;
    let higher: f64 = series.iter().skip(2).map(|c| c.norm() * sigma).sum();
    let largest = 4.0 / std::f64::consts::PI * (limit + higher * case.contacts[0].scale);
    let mut moving = forces.clone();
    moving[0] = Complex64::ZERO;
    if peak(&forces) <= limit * (1.0 - 1e-9) || peak(&moving) > largest * (1.0 + 1e-9) {
        Label::Solvable
    } else {
        Label::MayBeRefused(Reason::HoldingShell)
    }
}

/// Harmonics u⁰_k/G_k of the force that keeps the first contact at rest, by order of Ω; `None` where G_k vanishes.
pub(super) fn blocked(case: &Case) -> Option<Vec<Complex64>> {
    let model = case.model().ok()?;
    let mut forces = vec![Complex64::ZERO; case.harmonics + 1];
    for load in case.loads.iter().filter(|load| load.amplitude != 0.0) {
        let (g, free) = *Rows::new(case, &model, load.harmonic).receptances().first()?;
        let force = free / g;
        if !force.is_finite() {
            return None;
        }
        forces[load.harmonic] = force;
    }
    Some(forces)
}

/// max |f(t)| of a force with these harmonics.
pub(super) fn peak(forces: &[Complex64]) -> f64 {
    if let [_, only] = forces {
        return only.norm() + forces[0].norm();
    }
    let motion = Motion { spectrum: forces.to_vec() };
    motion.turns().into_iter().fold(motion.mean().abs(), |top, turn| top.max(turn.w.abs()))
}

/// The amplitude that stands for a law.
pub(super) fn length(law: &LawSpec) -> f64 {
    match law {
        LawSpec::ScaledLoop { displacement, .. } | LawSpec::IwanSmooth { displacement, .. } => *displacement,
        LawSpec::LoopFamily { loops } => loops.last().map_or(1.0, |(a, _)| *a),
        LawSpec::ElasticCoulomb { stiffness, slip_force } => slip_force / stiffness,
        LawSpec::IwanPolygon { backbone } => backbone.first().map_or(1.0, |[x, _]| *x),
        LawSpec::Cubic { stiffness } => stiffness.abs().powf(-1.0 / 3.0),
        _ => 1.0,
    }
}
