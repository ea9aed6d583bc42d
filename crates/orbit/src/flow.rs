//! Motion of a piecewise-linear system: the exponential series of the current linear system, step by step, from event
//! to event.
//!
//! While a set of sliders sticks and a set of contacts is closed the system is linear,
//!
//! ```text
//! M̃ y'' + D̃ y' + (K̃ + Σ_c β_c (k_c β_cᵀ + κ_c β_nᵀ)) y = load(τ) − Σ_c β_c constant_c
//! ```
//!
//! with k_c the stiffness of contact c's spring and sticking sliders, and κ_c = ±μk_n while a joint slips under the
//! pressure of its normal direction n. Its solution over a step of at most one radian of
//! the fastest motion is a Taylor series of [`TERMS`] terms, exact to rounding; that is the matrix exponential, and
//! unlike eigenvectors it does not care about rigid-body modes, critical damping or resonance. A force that turns while a joint
//! slips in two directions ([`crate::turning`]) makes it a nonlinear one, whose series is as exact over shorter steps. Events
//! are sign changes of polynomials, none of which can be missed.

use crate::error::OrbitError;
use crate::links::{Elastic, Friction, Link, Press};
use crate::opening;
use crate::path::{Element, Path, PhaseEvent, Piece};
use crate::polynomial::{Polynomial, TERMS, derivative, divided_by_s, root, sign_changes, value};
use crate::press::{Change, Touch};
use crate::scaled::{Scaled, add_product, row_norm};
use crate::settings::EventKind;
use crate::tangents::Tangents;
use crate::turning::Turning;

/// Steps a period beyond which something is wrong.
const MOST_STEPS: usize = 20_000_000;

/// What a slider does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// Force / limit = offset + gain · u.
    Stick { offset: f64 },
    /// Force / limit = direction.
    Slip { direction: f64 },
}

/// The moving system.
#[derive(Debug)]
pub(crate) struct Flow<'a> {
    pub(crate) system: &'a Scaled,
    pub(crate) y: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) sliders: Vec<Motion>,
    /// What every contact that opens does.
    pub(crate) touches: Vec<Touch>,
    /// Of every contact that opens, the direction in which slip has just ended.
    pub(crate) turned: Vec<Option<[f64; 2]>>,
    /// Of every contact that opens, whether it has just closed.
    pub(crate) met: Vec<bool>,
    /// Forces that turn in this step, one a contact that opens.
    pub(crate) turnings: Vec<Option<Turning<f64>>>,
    tau: f64,
    /// The velocity of a contact is zero by definition: an event has just found it there.
    zero: Vec<bool>,
    /// Of every link.
    elastic: Vec<Elastic>,
    /// Directions of the contacts at the begin of the step.
    directions: Vec<f64>,
    pub(crate) coefficients: Vec<f64>,
    pub(crate) roots: Vec<f64>,
    structure: (f64, f64),
    /// Largest |y| and |v| on the way.
    pub(crate) peak: (f64, f64),
}

/// The next event in a step.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Next {
    /// The sliders of a contact that slip stick.
    Stick { contact: usize },
    /// A slider begins to slip.
    Slip { slider: usize, direction: f64 },
    /// A contact that can open changes.
    Touch { press: usize, change: Change },
}

impl<'a> Flow<'a> {
    /// The system at τ = 0 with the given y, y' and slider forces in units of their limits.
    pub(crate) fn new(system: &'a Scaled) -> Self {
        let (n, contacts) = (system.dofs, system.links.len());
        Self {
            system,
            y: vec![0.0; n],
            v: vec![0.0; n],
            sliders: vec![Motion::Stick { offset: 0.0 }; system.sliders.len()],
            touches: vec![Touch::Apart; system.presses.len()],
            turned: vec![None; system.presses.len()],
            met: vec![false; system.presses.len()],
            turnings: vec![None; system.presses.len()],
            tau: 0.0,
            zero: vec![false; contacts],
            elastic: vec![Elastic::default(); contacts],
            directions: vec![0.0; contacts],
            coefficients: vec![0.0; TERMS * n],
            roots: Vec::new(),
            structure: (row_norm(&system.damping_rate, n), row_norm(&system.stiffness_rate, n)),
            peak: (0.0, 0.0),
        }
    }

    /// Begins at τ = 0 in the state (y, y', forces / limits of sliders, elongations of the springs of sliding presses).
    pub(crate) fn begin(&mut self, state: &[f64]) {
        let n = self.system.dofs;
        let (y, rest) = state.split_at(n.min(state.len()));
        let (v, forces) = rest.split_at(n.min(rest.len()));
        self.y.copy_from_slice(y);
        self.v.copy_from_slice(v);
        for ((motion, slider), force) in self.sliders.iter_mut().zip(&self.system.sliders).zip(forces) {
            let u = self.system.links.get(slider.contact).map_or(0.0, |link| link.relative(&self.y));
            *motion = Motion::Stick { offset: force.clamp(-1.0, 1.0) - slider.gain * u };
        }
        let system = self.system;
        let mut pulls = forces.get(self.sliders.len()..).unwrap_or_default().iter().copied();
        for (press, touch) in system.presses.iter().zip(&mut self.touches) {
            let pull = press.take_pull(&mut pulls);
            *touch = opening::begin(press, &system.links, &self.y, pull);
        }
        self.turned.fill(None);
        self.met.fill(false);
        self.tau = 0.0;
        self.zero.fill(false);
        self.peak = (0.0, 0.0);
    }

    /// The state as [`Flow::begin`] takes it.
    pub(crate) fn state(&self, out: &mut Vec<f64>) {
        out.clear();
        out.extend_from_slice(&self.y);
        out.extend_from_slice(&self.v);
        for (motion, slider) in self.sliders.iter().zip(&self.system.sliders) {
            out.push(match motion {
                Motion::Slip { direction } => *direction,
                Motion::Stick { offset } => offset + slider.gain * self.relative(slider.contact),
            });
        }
        for (press, touch) in self.system.presses.iter().zip(&self.touches) {
            let pull = opening::pull(press, *touch, &self.system.links, &self.y);
            out.extend(press.friction.iter().flat_map(Friction::links).zip(pull).map(|(_, pull)| pull));
        }
    }

    fn relative(&self, contact: usize) -> f64 {
        self.system.links.get(contact).map_or(0.0, |link| link.relative(&self.y))
    }

    /// Follows the motion until phase `until`, with its derivative and a record of it where asked for.
    pub(crate) fn follow(
        &mut self,
        until: f64,
        mut tangents: Option<&mut Tangents>,
        mut path: Option<&mut Path>,
    ) -> Result<(), OrbitError> {
        let mut without_progress = 0;
        for _ in 0..MOST_STEPS {
            if self.tau >= until {
                return Ok(());
            }
            let events = path.as_deref_mut().map(|path| &mut path.events);
            let length = self.prepare(until, events, tangents.as_deref_mut());
            let (s, next) = self.next_event();
            let step = s * length;
            if let Some(tangents) = tangents.as_deref_mut() {
                tangents.step(self, length, s);
            }
            if let Some(path) = path.as_deref_mut().filter(|_| step > 0.0) {
                self.record(length, s, path);
            }
            self.advance(
                length,
                s,
                if next.is_none() && self.tau + length >= until { Some(until) } else { None },
            );
            if step > 1e-13 {
                without_progress = 0;
                self.zero.fill(false);
                self.turned.fill(None);
                self.met.fill(false);
            } else {
                without_progress += 1;
            }
            if without_progress > 8 * (self.sliders.len() + self.touches.len() + 1) {
                return Err(OrbitError::Chatter { time: self.tau / self.system.omega });
            }
            if !(self.y.iter().chain(&self.v).all(|x| x.abs() < 1e30)) {
                return Err(OrbitError::Unbounded);
            }
            if let Some(next) = next {
                let slipping = self.slipping(next);
                let events = path.as_deref_mut().map(|path| &mut path.events);
                self.change(next, events, tangents.as_deref_mut());
                // Found where the slider turns: its velocity is zero by definition.
                if let (Next::Touch { press, change: Change::Stick }, Some(direction)) = (next, slipping)
                    && let Some(turned) = self.turned.get_mut(press)
                {
                    *turned = Some(direction);
                }
            }
        }
        Err(OrbitError::Chatter { time: self.tau / self.system.omega })
    }

    /// The series of the next step, after sliders that cannot go on as they were have changed; returns its length.
    fn prepare(
        &mut self,
        until: f64,
        mut events: Option<&mut Vec<PhaseEvent>>,
        mut tangents: Option<&mut Tangents>,
    ) -> f64 {
        let mut length = self.series(until);
        // Every pass changes the state of a slider, whose contact has one direction: twice as many passes suffice.
        for _ in 0..2 * self.sliders.len() + 4 * self.touches.len() + 1 {
            for c in 0..self.directions.len() {
                let direction = self.direction(c);
                if let Some(slot) = self.directions.get_mut(c) {
                    *slot = direction;
                }
            }
            let mut changed = false;
            for slider in 0..self.sliders.len() {
                if let Some(next) = self.at_once(slider) {
                    self.change(next, events.as_deref_mut(), tangents.as_deref_mut());
                    changed = true;
                }
            }
            for press in 0..self.touches.len() {
                if let Some(next) = self.press_at_once(press) {
                    self.change(next, events.as_deref_mut(), tangents.as_deref_mut());
                    changed = true;
                }
            }
            if !changed {
                break;
            }
            length = self.series(until);
        }
        length
    }

    /// A change that is due at the begin of a step.
    fn at_once(&self, slider: usize) -> Option<Next> {
        let (motion, data) = (self.sliders.get(slider)?, self.system.sliders.get(slider)?);
        let direction = *self.directions.get(data.contact)?;
        match motion {
            Motion::Stick { offset } => {
                let force = offset + data.gain * self.relative(data.contact);
                (force * direction >= 1.0).then_some(Next::Slip { slider, direction })
            }
            Motion::Slip { direction: own } => {
                (own * direction < 0.0).then_some(Next::Stick { contact: data.contact })
            }
        }
    }

    /// Coefficients of y over the longest allowed step; returns its length.
    fn series(&mut self, until: f64) -> f64 {
        for ((elastic, link), c) in self.elastic.iter_mut().zip(&self.system.links).zip(0..) {
            *elastic = Elastic { stiffness: link.spring, ..Elastic::default() };
            let own = self.sliders.iter().zip(&self.system.sliders).filter(|(_, data)| data.contact == c);
            for (motion, data) in own {
                match motion {
                    Motion::Stick { offset } => {
                        elastic.stiffness += data.stiffness;
                        elastic.constant += data.limit * offset;
                    }
                    Motion::Slip { direction } => elastic.constant += data.limit * direction,
                }
            }
        }
        for (press, touch) in self.system.presses.iter().zip(&self.touches) {
            opening::set_elastic(press, *touch, &mut self.elastic);
        }
        let mut length = (1.0 / self.fastest()).min(until - self.tau);
        if self.system.presses.iter().any(Press::is_planar) {
            // The square of a series has to be one as well.
            length = length.min(0.5 / self.fastest()).min(self.begin_turnings());
        }
        let n = self.system.dofs;
        let mut factor = length * length;
        for (j, row) in self.coefficients.chunks_exact_mut(n).skip(2).enumerate() {
            row.fill(0.0);
            self.system.add_load(self.tau, j as i32, factor, row);
            factor *= length / (j + 1) as f64;
        }
        for ((y, v), i) in self.y.iter().zip(&self.v).zip(0..) {
            set(&mut self.coefficients, i, *y);
            set(&mut self.coefficients, n + i, length * v);
        }
        for (link, Elastic { constant, .. }) in self.system.links.iter().zip(&self.elastic) {
            if let Some(row) = self.coefficients.get_mut(2 * n..3 * n) {
                for (row, acceleration) in row.iter_mut().zip(&link.acceleration) {
                    *row -= length * length * constant * acceleration;
                }
            }
        }
        let (system, turnings) = (self.system, &mut self.turnings);
        recur(system, &self.elastic, length, &mut self.coefficients, |j, c, after, next| {
            for (press, turning) in system.presses.iter().zip(turnings.iter_mut()) {
                if let Some(turning) = turning {
                    let force = opening::extend(press, &system.links, turning, (j, c, after));
                    press.push(&system.links, force, length * length, next);
                }
            }
        });
        self.shorten(length)
    }

    /// Cuts the step to what the series of forces that turn can say; returns its length.
    fn shorten(&mut self, length: f64) -> f64 {
        let factor = self.turnings.iter().flatten().map(Turning::valid).fold(1.0, f64::min);
        if factor < 1.0 {
            let mut power = 1.0;
            for row in self.coefficients.chunks_exact_mut(self.system.dofs) {
                row.iter_mut().for_each(|c| *c *= power);
                power *= factor;
            }
            self.turnings.iter_mut().flatten().for_each(|turning| turning.shorten(factor));
        }
        factor * length
    }

    /// A bound on the rate of the fastest motion: r² = ‖M̃⁻¹D̃‖ r + ‖M̃⁻¹K̃_c‖, and the highest load.
    fn fastest(&self) -> f64 {
        let (damping, mut stiffness) = self.structure;
        for ((link, elastic), c) in self.system.links.iter().zip(&self.elastic).zip(0..) {
            let row = link.acceleration.iter().fold(0.0_f64, |top, a| top.max(a.abs()));
            for (other, k) in elastic.parts(c) {
                let ends = self.system.links.get(other).map_or(&[][..], |link| &link.ends);
                stiffness += k.abs() * row * ends.iter().map(|(_, beta)| beta.abs()).sum::<f64>();
            }
        }
        // A force that turns follows its pressure.
        for (press, touch) in self.system.presses.iter().zip(&self.touches) {
            if let (Touch::Slip { .. }, true) = (touch, press.is_planar()) {
                let sum = |link: &Link| link.ends.iter().map(|(_, beta)| beta.abs()).sum::<f64>();
                let along = press
                    .friction
                    .iter()
                    .flat_map(Friction::links)
                    .filter_map(|link| self.system.links.get(link));
                let row = along.flat_map(|link| &link.acceleration).fold(0.0_f64, |top, a| top.max(a.abs()));
                let friction = press.friction.map_or(0.0, |friction| friction.coefficient * press.stiffness);
                stiffness += 2.0 * friction * row * self.system.links.get(press.normal).map_or(0.0, sum);
            }
        }
        let rate = 0.5 * (damping + (damping * damping + 4.0 * stiffness).sqrt());
        let highest = self.system.loads.iter().map(|load| load.harmonic).max().unwrap_or(1);
        rate.max(highest as f64)
    }

    /// The relative velocity of a contact over the step, times its length; s times less where it begins at zero by
    /// definition.
    fn velocity(&self, contact: usize) -> (Polynomial, Polynomial) {
        let Some(link) = self.system.links.get(contact) else { return ([0.0; TERMS], [0.0; TERMS]) };
        let mut u = [0.0; TERMS];
        for (u, row) in u.iter_mut().zip(self.coefficients.chunks_exact(self.system.dofs)) {
            *u = link.relative(row);
        }
        let mut rate = derivative(&u);
        let defined = self.zero.get(contact).copied().unwrap_or(false);
        let mut stripped = 0;
        if let Some(first) = rate.first_mut().filter(|_| defined) {
            *first = 0.0;
        }
        while rate.first() == Some(&0.0) && stripped < TERMS {
            rate = divided_by_s(&rate);
            stripped += 1;
        }
        (u, rate)
    }

    /// Direction in which a contact moves right after the begin of the step; 0 when it does not move.
    fn direction(&self, contact: usize) -> f64 {
        let (_, rate) = self.velocity(contact);
        match rate.first() {
            Some(first) if *first != 0.0 => first.signum(),
            _ => 0.0,
        }
    }

    /// The first event of the step, s ∈ (0, 1]; 1 when there is none.
    fn next_event(&mut self) -> (f64, Option<Next>) {
        let (mut earliest, mut next) = (1.0, None);
        let mut roots = std::mem::take(&mut self.roots);
        for (c, link) in self.system.links.iter().enumerate() {
            if link.sliders.is_empty() {
                continue;
            }
            let (u, rate) = self.velocity(c);
            roots.clear();
            sign_changes(&rate, &mut roots);
            let mut direction = self.directions.get(c).copied().unwrap_or(0.0);
            let mut start = 0.0;
            for end in roots.iter().copied().chain([f64::INFINITY]) {
                if start >= earliest {
                    break;
                }
                // From `start` to `end` the contact moves in one direction.
                let stop = end.min(1.0);
                let slip = link.sliders.clone().filter_map(|slider| {
                    let level = self.limit(slider, direction)?;
                    (direction * (value(&u, stop) - level) > 0.0).then_some((slider, level))
                });
                let first = slip.min_by(|a, b| (direction * a.1).total_cmp(&(direction * b.1)));
                if let Some((slider, level)) = first {
                    let s = root(&u, level, (start, stop));
                    if s < earliest {
                        (earliest, next) = (s, Some(Next::Slip { slider, direction }));
                    }
                    break;
                }
                let comes_first = end < earliest || (end <= 1.0 && next.is_none());
                if comes_first && link.sliders.clone().any(|slider| self.slips(slider)) {
                    (earliest, next) = (end, Some(Next::Stick { contact: c }));
                    break;
                }
                (start, direction) = (end, -direction);
            }
        }
        self.roots = roots;
        match self.next_of_presses() {
            Some((s, touch)) if s < earliest || next.is_none() => (s, Some(touch)),
            _ => (earliest, next),
        }
    }

    /// The direction in which the contact slips that is about to change.
    fn slipping(&self, next: Next) -> Option<[f64; 2]> {
        let Next::Touch { press, .. } = next else { return None };
        match self.touches.get(press)? {
            Touch::Slip { direction } => Some(*direction),
            _ => None,
        }
    }

    fn slips(&self, slider: usize) -> bool {
        matches!(self.sliders.get(slider), Some(Motion::Slip { .. }))
    }

    /// u at which a sticking slider reaches its limit in `direction`.
    fn limit(&self, slider: usize, direction: f64) -> Option<f64> {
        match (self.sliders.get(slider)?, self.system.sliders.get(slider)?) {
            (Motion::Stick { offset }, data) if direction != 0.0 => Some((direction - offset) / data.gain),
            _ => None,
        }
    }

    /// Goes to place `s` of the step.
    fn advance(&mut self, length: f64, s: f64, to: Option<f64>) {
        let n = self.system.dofs;
        for (i, (y, v)) in self.y.iter_mut().zip(&mut self.v).enumerate() {
            let (mut position, mut rate) = (0.0, 0.0);
            for row in self.coefficients.chunks_exact(n).rev() {
                rate = rate * s + position;
                position = position * s + row.get(i).copied().unwrap_or(0.0);
            }
            (*y, *v) = (position, rate / length);
            self.peak = (self.peak.0.max(y.abs()), self.peak.1.max(v.abs()));
        }
        self.turn(s);
        self.tau = to.unwrap_or(self.tau + s * length);
    }

    /// A slider changes between stick and slip.
    fn change(
        &mut self,
        next: Next,
        mut events: Option<&mut Vec<PhaseEvent>>,
        mut tangents: Option<&mut Tangents>,
    ) {
        if let Next::Touch { press, change } = next {
            self.change_touch((press, change), events, tangents);
            return;
        }
        let tau = self.tau;
        let mut note = |slider: usize, kind: EventKind, direction: f64| {
            if let Some(events) = events.as_deref_mut() {
                let direction = if direction > 0.0 { 1 } else { -1 };
                events.push(PhaseEvent { tau, element: Element::Slider(slider), kind, direction });
            }
        };
        match next {
            Next::Touch { .. } => {}
            Next::Slip { slider, direction } => {
                if let Some(motion) = self.sliders.get_mut(slider) {
                    *motion = Motion::Slip { direction };
                }
                note(slider, EventKind::Slip, direction);
                if let Some(tangents) = tangents {
                    tangents.slips(slider);
                }
            }
            Next::Stick { contact } => {
                let u = self.relative(contact);
                let own = self.system.links.get(contact).map_or(0..0, |link| link.sliders.clone());
                if let Some(zero) = self.zero.get_mut(contact) {
                    *zero = true;
                }
                for slider in own {
                    let (Some(motion), Some(data)) =
                        (self.sliders.get_mut(slider), self.system.sliders.get(slider))
                    else {
                        continue;
                    };
                    if let Motion::Slip { direction } = *motion {
                        *motion = Motion::Stick { offset: direction - data.gain * u };
                        note(slider, EventKind::Stick, direction);
                        if let Some(tangents) = tangents.as_deref_mut() {
                            tangents.sticks(self.system, slider);
                        }
                    }
                }
            }
        }
    }

    fn record(&self, length: f64, s: f64, path: &mut Path) {
        let n = self.system.dofs;
        let mut coefficients = self.coefficients.clone();
        let mut factor = 1.0;
        for row in coefficients.chunks_exact_mut(n) {
            row.iter_mut().for_each(|c| *c *= factor);
            factor *= s;
        }
        let (start, length) = (self.tau, s * length);
        let turning = self.system.presses.iter().zip(&self.turnings).flat_map(|(press, turning)| {
            let turning = turning.as_ref().zip(press.friction);
            turning.into_iter().flat_map(|(turning, friction)| {
                let over = move |pull: &Polynomial| {
                    let mut power = friction.stiffness;
                    pull.map(|c| {
                        let scaled = c * power;
                        power *= s;
                        scaled
                    })
                };
                friction.links().zip(turning.pull().iter().map(over))
            })
        });
        let turning = turning.collect();
        path.pieces.push(Piece { start, length, coefficients, elastic: self.elastic.clone(), turning });
    }

    /// Of every link in this step.
    pub(crate) fn elastic(&self) -> &[Elastic] {
        &self.elastic
    }

    /// The present phase.
    pub(crate) fn tau(&self) -> f64 {
        self.tau
    }
}

/// The recursion of the series: `(j+1)(j+2) c_{j+2} = source_j − length² K c_j − length (j+1) D c_{j+1}`, K with the
/// contacts' stiffnesses. c_0, c_1 and, in place of the others, the sources are given. `bend(j, c_j, c_{j+1}, source_j)` takes from
/// the sources what is not linear; it is asked for the last two orders too, without a source.
pub(crate) fn recur(
    system: &Scaled,
    elastic: &[Elastic],
    length: f64,
    coefficients: &mut [f64],
    mut bend: impl FnMut(usize, &[f64], &[f64], &mut [f64]),
) {
    let n = system.dofs;
    for j in 0..TERMS - 2 {
        let Some((known, next)) = coefficients.split_at_mut_checked((j + 2) * n) else { return };
        let (Some(c), Some(c1), Some(next)) =
            (known.get(j * n..(j + 1) * n), known.get((j + 1) * n..), next.get_mut(..n))
        else {
            return;
        };
        add_product(&system.stiffness_rate, c, -length * length, next);
        add_product(&system.damping_rate, c1, -length * (j + 1) as f64, next);
        for ((link, elastic), own) in system.links.iter().zip(elastic).zip(0..) {
            let pull = elastic.pull(length * length, own, &system.links, c);
            for (next, acceleration) in next.iter_mut().zip(&link.acceleration) {
                *next -= pull * acceleration;
            }
        }
        bend(j, c, c1, next);
        let divisor = ((j + 1) * (j + 2)) as f64;
        next.iter_mut().for_each(|next| *next /= divisor);
    }
    for j in TERMS - 2..TERMS {
        let row = |j: usize| coefficients.get(j * n..(j + 1) * n).unwrap_or_default();
        bend(j, row(j), row(j + 1), &mut []);
    }
}

fn set(row: &mut [f64], index: usize, x: f64) {
    if let Some(slot) = row.get_mut(index) {
        *slot = x;
    }
}
