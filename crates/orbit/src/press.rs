//! Contacts that open, with and without friction: what they do between events, and when that changes.
//!
//! With N = max(p + k_n u_n, 0) along the normal and f the tangential force,
//!
//! ```text
//! apart          N = 0, f = 0                                       until N rises above zero
//! stick          f = k_t (u_t − rest)                               until σ f rises above μN
//! slip along σ   f = σ μN; the slider moves: σ k_t u_t' > μN'       until it would move against f
//! ```
//!
//! In two tangential directions the length of f takes the place of σ f, and slip is that of [`crate::turning`]. All forces are
//! continuous: the rate of f alone jumps at an event, which is the sign of a polynomial.

use crate::links::Press;
use crate::polynomial::{Polynomial, TERMS, derivative, divided_by_s, root, sign_changes, value};
use crate::turning::Turning;

/// What a contact that can open does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Touch {
    /// No force.
    Apart,
    /// Pressed, without friction.
    Closed,
    /// f = k_t (u_t − rest).
    Stick { rest: [f64; 2] },
    /// f = direction · μN; a unit vector, ±1 with one tangential direction.
    Slip { direction: [f64; 2] },
}

/// What begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Change {
    Open,
    Close,
    Stick,
    Slip { direction: [f64; 2] },
}

/// A press over a step, s ∈ [0, 1].
pub(crate) struct Course<'a> {
    pub(crate) press: &'a Press,
    pub(crate) touch: Touch,
    /// u_n.
    pub(crate) normal: Polynomial,
    /// u_t; zero without friction.
    pub(crate) tangential: [Polynomial; 2],
    /// The force, where it turns.
    pub(crate) turning: Option<&'a Turning<f64>>,
    /// σ μN − f has the rate zero at s = 0 by definition, for this σ: slip along σ has just ended there.
    pub(crate) turned: Option<[f64; 2]>,
    /// N is zero at s = 0 by definition: the bodies have just met there.
    pub(crate) met: bool,
}

impl Course<'_> {
    /// N before it is cut.
    fn pressure(&self) -> Polynomial {
        let mut n = self.normal.map(|c| self.press.stiffness * c);
        if let Some(constant) = n.first_mut() {
            *constant += self.press.pressure;
        }
        n
    }

    /// μN − σ k_t (u_t − rest).
    fn margin(&self, direction: f64, rest: f64) -> Polynomial {
        let Some(friction) = &self.press.friction else { return [0.0; TERMS] };
        let mut margin = self.pressure();
        for (margin, u) in margin.iter_mut().zip(self.tangential.iter().flatten()) {
            *margin = friction.coefficient * *margin - direction * friction.stiffness * u;
        }
        if let Some(constant) = margin.first_mut() {
            *constant += direction * friction.stiffness * rest;
        }
        margin
    }

    /// The derivative of the margin, divided by s as often as it begins with zero.
    fn margin_rate(&self, direction: f64) -> Polynomial {
        let mut rate = derivative(&self.margin(direction, 0.0));
        let turned = self.turned.is_some_and(|[own, _]| own == direction);
        if let Some(first) = rate.first_mut().filter(|_| turned) {
            *first = 0.0;
        }
        stripped(rate)
    }

    /// (μN/k_t)² − |u_t − rest|², of which the parting factor μN/k_t + |u_t − rest| is positive, and its derivative, divided by
    /// s as often as it begins with zero.
    fn room(&self, rest: [f64; 2]) -> (Polynomial, Polynomial) {
        let reach = self.pressure().map(|c| self.press.reach() * c);
        let mut room = square(&reach);
        for (u, rest) in self.tangential.iter().zip(rest) {
            let mut pull = *u;
            if let Some(constant) = pull.first_mut() {
                *constant -= rest;
            }
            room.iter_mut().zip(square(&pull)).for_each(|(room, square)| *room -= square);
        }
        if self.turned.is_some() || self.met {
            room.iter_mut().take(2).for_each(|c| *c = 0.0);
        }
        let rate = stripped(derivative(&room));
        (room, rate)
    }

    /// The direction of the spring's force while it sticks.
    fn pulls_along(&self, s: f64, rest: [f64; 2]) -> [f64; 2] {
        let [first, second] = &self.tangential;
        unit([value(first, s) - rest[0], value(second, s) - rest[1]])
    }

    /// A change that is due at the begin of the step.
    pub(crate) fn at_once(&self) -> Option<Change> {
        let pressure = self.pressure();
        let rate = first(&stripped(derivative(&pressure)));
        if self.touch == Touch::Apart {
            return (first(&pressure) >= 0.0 && rate > 0.0).then_some(Change::Close);
        }
        if first(&pressure) <= 0.0 && rate < 0.0 {
            return Some(Change::Open);
        }
        match self.touch {
            Touch::Stick { rest } if self.press.is_planar() => {
                let (room, rate) = self.room(rest);
                (first(&room) <= 0.0 && first(&rate) < 0.0)
                    .then(|| Change::Slip { direction: self.pulls_along(0.0, rest) })
            }
            Touch::Stick { rest: [rest, _] } => [1.0, -1.0]
                .into_iter()
                .find(|&direction| {
                    first(&self.margin(direction, rest)) <= 0.0 && first(&self.margin_rate(direction)) < 0.0
                })
                .map(|direction| Change::Slip { direction: [direction, 0.0] }),
            Touch::Slip { direction: [direction, _] } => {
                let slides = match self.turning {
                    Some(turning) => stripped(turning.slide()),
                    None => self.margin_rate(direction).map(|c| -c),
                };
                (first(&slides) < 0.0).then_some(Change::Stick)
            }
            Touch::Apart | Touch::Closed => None,
        }
    }

    /// The first change in (0, 1], and where.
    pub(crate) fn next(&self, roots: &mut Vec<f64>) -> Option<(f64, Change)> {
        let pressure = self.pressure();
        if self.touch == Touch::Apart {
            let negative = pressure.map(|c| -c);
            return first_fall(&negative, &stripped(derivative(&negative)), roots)
                .map(|s| (s, Change::Close));
        }
        let open = first_fall(&pressure, &stripped(derivative(&pressure)), roots).map(|s| (s, Change::Open));
        let other = match self.touch {
            Touch::Stick { rest } if self.press.is_planar() => {
                let (room, rate) = self.room(rest);
                first_fall(&room, &rate, roots)
                    .map(|s| (s, Change::Slip { direction: self.pulls_along(s, rest) }))
            }
            Touch::Stick { rest: [rest, _] } => [1.0, -1.0]
                .into_iter()
                .filter_map(|direction| {
                    let margin = self.margin(direction, rest);
                    let s = first_fall(&margin, &self.margin_rate(direction), roots)?;
                    Some((s, Change::Slip { direction: [direction, 0.0] }))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0)),
            Touch::Slip { direction: [direction, _] } => {
                roots.clear();
                let slides = self.turning.map(|turning| stripped(turning.slide()));
                sign_changes(&slides.unwrap_or_else(|| self.margin_rate(direction)), roots);
                roots.first().map(|s| (*s, Change::Stick))
            }
            Touch::Apart | Touch::Closed => None,
        };
        // Where friction ends together with the pressure, it ends first.
        other.into_iter().chain(open).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Press {
    /// How a contact closes that has no friction force yet, with the given velocities: it slips where μN cannot keep up
    /// with the tangential spring.
    pub(crate) fn closes(&self, normal: f64, tangential: [f64; 2], rest: [f64; 2]) -> Touch {
        let Some(friction) = self.friction.filter(|friction| friction.coefficient > 0.0) else {
            return Touch::Closed;
        };
        let pull = friction.stiffness * length(tangential);
        let grip = friction.coefficient * self.stiffness * normal;
        if pull < grip { Touch::Stick { rest } } else { Touch::Slip { direction: unit(tangential) } }
    }
}

/// |x|; exact along an axis.
pub(crate) fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// x/|x|; the first axis for zero.
pub(crate) fn unit(x: [f64; 2]) -> [f64; 2] {
    let length = length(x);
    if length > 0.0 { x.map(|x| x / length) } else { [1.0, 0.0] }
}

/// c²; exact to rounding where the series falls fast enough.
pub(crate) fn square(c: &Polynomial) -> Polynomial {
    std::array::from_fn(|n| {
        let pairs = c.iter().take(n + 1).zip(c.iter().take(n + 1).rev());
        pairs.map(|(a, b)| a * b).sum()
    })
}

fn first(c: &Polynomial) -> f64 {
    c.first().copied().unwrap_or(0.0)
}

fn stripped(mut c: Polynomial) -> Polynomial {
    for _ in 0..TERMS {
        if first(&c) != 0.0 {
            break;
        }
        c = divided_by_s(&c);
    }
    c
}

/// The first place in (0, 1] at which `x`, not negative at s = 0, falls below zero; `rate` has the sign of its
/// derivative.
fn first_fall(x: &Polynomial, rate: &Polynomial, roots: &mut Vec<f64>) -> Option<f64> {
    roots.clear();
    sign_changes(rate, roots);
    let (mut start, mut falls) = (0.0, first(rate) < 0.0);
    for end in roots.iter().copied().chain([f64::INFINITY]) {
        let stop = end.min(1.0);
        if falls && value(x, stop) < 0.0 {
            return Some(root(x, 0.0, (start, stop)));
        }
        if stop >= 1.0 {
            break;
        }
        (start, falls) = (end, !falls);
    }
    None
}
