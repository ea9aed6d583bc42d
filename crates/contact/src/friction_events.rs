//! Friction in one direction under a normal load, by its events: no samples, no sampling error.
//!
//! While the bodies touch, N and the edges w ∓ μN/k_t of the slider's room are trigonometric polynomials, and
//!
//! ```text
//! rest:   f_t = k_t (w − s)       s = w ∓ μN/k_t where an edge turned round, w where the bodies touched, or the mean
//! pushed: f_t = ± μ N             f_n = N (− N_0)
//! ```
//!
//! All forces are continuous, so that the phases of the events need no derivative; but s does where the bodies touch:
//! `δs = δw − (ẇ/ṅ) δn` there.

use std::f64::consts::TAU;

use crate::error::LawError;
use crate::events::ForcePiece;
use crate::gap::closed_stretches;
use crate::joint::{Coupling, JointMarks, JointMotion};
use crate::law::{ContactState, Motion};
use crate::normal_contact::NormalContact;
use crate::play::{Cause, Edge, Rest, Side, Stretch, follow};
use crate::tangent::Recall;
use crate::turning_points::{TurningPoint, TurningPoints, has_odd_only, jet_of};

/// Stretches shorter than this, in rad, say nothing about the state: a slider that is at rest under the body where they part
/// is pushed for an instant by rounding.
const LEAST: f64 = 1e-9;

/// Buffers of [`FrictionEvents::pieces`].
#[derive(Debug, Clone, Default)]
pub(crate) struct EventBuffers {
    approach: TurningPoints,
    lower: Edge,
    upper: Edge,
    /// From where to where the bodies touch.
    contacts: Vec<(f64, f64)>,
}

/// The law's numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrictionEvents<'a> {
    pub(crate) stiffness: f64,
    pub(crate) friction: f64,
    pub(crate) normal: &'a NormalContact,
}

/// The couplings of one tangential direction and the normal one: (force, displacement).
pub(crate) fn couplings() -> Vec<Coupling> {
    [(0, 0), (0, 1), (1, 1)]
        .map(|(force, displacement)| Coupling { force, displacement, pieces: Vec::new() })
        .into()
}

fn piece(from: f64, to: f64, stiffness: f64, offset: f64, memory: Option<(Recall, f64)>) -> ForcePiece {
    ForcePiece { from, to, stiffness, offset, start_force: 0.0, close: false, memory }
}

impl FrictionEvents<'_> {
    /// The pieces of all couplings.
    pub(crate) fn pieces(
        &self,
        motion: &JointMotion,
        buffers: &mut EventBuffers,
        couplings: &mut [Coupling],
    ) -> Result<JointMarks, LawError> {
        let [own, by_load, normal] = couplings else { return Err(LawError::OtherWorkspace) };
        [&mut *own, by_load].into_iter().for_each(|coupling| coupling.pieces.clear());
        let mut marks = self.normal_pieces(motion, buffers, normal)?;
        let always = buffers.contacts.first() == Some(&(0.0, TAU));
        let at_rest = self.normal.load(0.0);
        let kn = self.normal.stiffness();
        if buffers.contacts.is_empty() || self.friction == 0.0 {
            return Ok(marks);
        }
        let (spectrum, approach) = (motion.spectrum_of(0), motion.spectrum_of(1));
        let per_load = self.friction / self.stiffness;
        for (edge, side) in [(&mut buffers.lower, Side::Lower), (&mut buffers.upper, Side::Upper)] {
            // w ∓ (μ/k_t)(N(0) + k_n n)
            let by = -side.sign() * per_load;
            let shift = |k: usize| if k == 0 { by * at_rest } else { 0.0 };
            let waves = spectrum.iter().zip(approach).enumerate();
            let speeds = motion.velocity_of(0).iter().zip(motion.velocity_of(1));
            edge.set(
                waves.map(|(k, (w, n))| w + n * (by * kn) + shift(k)),
                speeds.map(|(w, n)| w + n * (by * kn)),
            )?;
        }
        let edges = [&buffers.lower, &buffers.upper];
        let (mut rests, mut slips) = (false, false);
        let mut visit = |from: f64, to: f64, stretch: Stretch| match stretch {
            Stretch::Resting(rest) => {
                rests |= to - from > LEAST;
                let (recall, by) = self.memory(rest.cause, motion);
                let memory = Some((recall, -self.stiffness));
                own.pieces.push(piece(from, to, self.stiffness, -self.stiffness * rest.level, memory));
                if by != 0.0 {
                    by_load.pieces.push(piece(from, to, 0.0, 0.0, Some((recall, by))));
                }
            }
            Stretch::Pushed(side) => {
                slips |= to - from > LEAST;
                let friction = side.sign() * self.friction;
                by_load.pieces.push(piece(from, to, friction * kn, friction * at_rest, None));
            }
        };
        if always {
            let mean = spectrum.first().map_or(0.0, |mean| mean.re);
            let (begin, rest) = start(edges, mean);
            follow(edges, (begin, begin + TAU), Ok(rest), &mut visit)?;
        } else {
            for &(from, to) in &buffers.contacts {
                let pushed = |(edge, side): (&Edge, Side)| edge.pushing(from, side).map(|leg| (side, leg));
                let begin = [(edges[0], Side::Lower), (edges[1], Side::Upper)].into_iter().find_map(pushed);
                let level = jet_of(spectrum, has_odd_only(spectrum), from).displacement;
                let rest = Rest { level, cause: Cause::Touched(from) };
                follow(edges, (from, to), begin.map_or(Ok(rest), Err), &mut visit)?;
            }
        }
        marks.state = match (rests, slips) {
            (true, true) => ContactState::Mixed,
            (true, false) => ContactState::Stick,
            _ => ContactState::Slip,
        };
        Ok(marks)
    }

    /// The pieces of the normal force, which depends on the approach alone; marks as if nothing stuck.
    pub(crate) fn normal_pieces(
        &self,
        motion: &JointMotion,
        buffers: &mut EventBuffers,
        normal: &mut Coupling,
    ) -> Result<JointMarks, LawError> {
        normal.pieces.clear();
        let always = self.find_contacts(motion, buffers)?;
        let at_rest = self.normal.load(0.0);
        let kn = self.normal.stiffness();
        let balanced = self.normal.balanced();
        if always {
            normal.pieces.push(piece(0.0, TAU, kn, at_rest - balanced, None));
        } else {
            let touching = |&(from, to): &(f64, f64)| piece(from, to, kn, at_rest, None);
            normal.pieces.extend(buffers.contacts.iter().map(touching));
            normal.pieces.push(piece(0.0, TAU, 0.0, -balanced, None));
        }
        let touching: f64 = buffers.contacts.iter().map(|(from, to)| to - from).sum();
        let apart = if always { 0.0 } else { 1.0 - touching / TAU };
        let state = if buffers.contacts.is_empty() { ContactState::Apart } else { ContactState::Slip };
        Ok(JointMarks { state, apart, cycles: 1, extrapolated: false })
    }

    /// Fills in from where to where the bodies touch; whether they always do.
    fn find_contacts(&self, motion: &JointMotion, buffers: &mut EventBuffers) -> Result<bool, LawError> {
        buffers.contacts.clear();
        let normal = motion.directions.saturating_sub(1);
        let approach = Motion {
            spectrum: motion.spectrum_of(normal),
            displacement: &[],
            velocity: motion.velocity_of(normal),
            odd: false,
            omega: 0.0,
        };
        match buffers.approach.find(&approach) {
            Err(LawError::NoMotion) => {
                let mean = approach.spectrum.first().map_or(0.0, |mean| mean.re);
                let touches = self.normal.load(mean) > 0.0;
                buffers.contacts.extend(touches.then_some((0.0, TAU)));
                return Ok(touches);
            }
            found => found?,
        }
        let touch = |from: f64, to: f64| buffers.contacts.push((from, to));
        Ok(closed_stretches(approach.spectrum, &buffers.approach, self.normal.touching_at(), touch))
    }

    /// What the slider recalls, and what −k_t times its change is per change of the approach there.
    fn memory(&self, cause: Cause, motion: &JointMotion) -> (Recall, f64) {
        match cause {
            Cause::Mean => (Recall::Mean, 0.0),
            Cause::Turned(side, tau) => {
                let by = side.sign() * self.friction * self.normal.stiffness();
                (Recall::Displacement { tau }, by)
            }
            Cause::Touched(tau) => {
                let speed = |spectrum| jet_of(spectrum, has_odd_only(spectrum), tau).velocity;
                let ratio = speed(motion.spectrum_of(0)) / speed(motion.spectrum_of(1));
                (Recall::Displacement { tau }, self.stiffness * ratio)
            }
        }
    }
}

/// Where a period of a contact that never opens begins, and where the slider rests then: at the highest point of the lower edge,
/// to which it is pushed in every period, or, where it never slips, as near to the mean displacement as the edges let it.
fn start([lower, upper]: [&Edge; 2], mean: f64) -> (f64, Rest) {
    let top = lower.extremes().map(|(top, _)| top);
    let bottom = upper.extremes().map(|(_, bottom)| bottom);
    let highest = top.map_or(lower.mean(), |tip| tip.displacement);
    let lowest = bottom.map_or(upper.mean(), |tip| tip.displacement);
    let turned = |side, tip: TurningPoint| {
        (tip.tau, Rest { level: tip.displacement, cause: Cause::Turned(side, tip.tau) })
    };
    match (top, bottom) {
        (Some(top), _) if highest > lowest || mean < highest => turned(Side::Lower, top),
        (_, Some(bottom)) if highest > lowest || mean > lowest => turned(Side::Upper, bottom),
        _ => (0.0, Rest { level: mean, cause: Cause::Mean }),
    }
}
