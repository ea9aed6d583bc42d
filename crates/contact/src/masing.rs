//! Masing's memory: which branch of a friction loop the contact is on at every instant of a period.
//!
//! From the global maximum to the global minimum the contact unloads along the loop's upper branch, and back along
//! the lower one. A reversal in between starts a minor branch of the same shape from where it happens towards the
//! reversal before it; when the displacement gets back there, the minor loop is closed, forgotten, and the branch
//! it interrupted goes on. The nesting is the rainflow decomposition of the period begun at the global maximum.
//!
//! The rule is continuous where reversals appear, vanish or tie. For a loop whose branches are not mirror images
//! a minor branch is scaled by the `ratio` that makes it end where it should.
//!
//! What the branches look like is a [`Shape`]: a measured loop, or a backbone.

use std::ops::Range;

use crate::path::{Path, Piece, mirror};
use crate::place::{Direction, Place};
use crate::real::Real;

/// The two branches of a friction loop at one amplitude.
pub(crate) trait Shape<T: Real> {
    /// What is kept of a place on a branch until all samples are evaluated together.
    type Spot: Copy;

    /// Whether the two branches mirror each other.
    fn is_odd(&self) -> bool;

    /// The force at the tip where the main branch of this direction begins.
    fn tip(&self, direction: Direction) -> T;

    /// What to keep of a place.
    fn spot(direction: Direction, place: Place<T>) -> Self::Spot;

    /// The raw values at all spots, into `values` of the same length; [`Shape::change_to`] makes changes of them.
    fn evaluate(&self, spots: &[Self::Spot], values: &mut [T]);

    /// Magnitude of the force change since the branch began, from the raw value.
    fn change_to(&self, direction: Direction, value: T) -> T;

    /// Magnitude S(p) of the force change since the branch began, at one place.
    fn change(&self, direction: Direction, place: Place<T>) -> T {
        let mut value = [T::from(0.0)];
        self.evaluate(&[Self::spot(direction, place)], &mut value);
        let [value] = value;
        self.change_to(direction, value)
    }
}

/// A branch: where it starts, where it would close, and how its force runs:
/// `f = f_start ∓ ratio · change(p)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Branch<T> {
    /// Turning point at which it starts.
    pub(crate) start: usize,
    /// Turning point at whose displacement it closes.
    pub(crate) target: usize,
    pub(crate) direction: Direction,
    pub(crate) force_at_start: T,
    /// 1 on the main branches and for odd loops.
    pub(crate) ratio: T,
    /// One of the two main branches: its far end is a tip of the loop.
    pub(crate) main: bool,
    /// The branch on which the start lies (itself for the two main ones).
    pub(crate) parent: usize,
}

/// The branches of one period and the samples on them; reused between evaluations.
#[derive(Debug, Clone)]
pub(crate) struct Masing<T, Spot> {
    pub(crate) branches: Vec<Branch<T>>,
    pub(crate) pieces: Vec<Piece>,
    /// Where every sample lies on its branch.
    pub(crate) spots: Vec<Spot>,
    /// The half period that was walked through where the other half mirrors it.
    pub(crate) half: Option<Piece>,
    stack: Vec<usize>,
}

/// Sample number within the period of a number that counted on past its end.
#[inline(always)]
pub(crate) fn wrap(j: usize, samples: usize) -> usize {
    if j < samples { j } else { j - samples }
}

impl<T: Real, Spot: Copy> Masing<T, Spot> {
    /// Empty buffers.
    pub(crate) fn new() -> Self {
        Self { branches: Vec::new(), pieces: Vec::new(), spots: Vec::new(), half: None, stack: Vec::new() }
    }

    /// Walks through one period of `path` with loop amplitude `a` and writes the force at every sample.
    pub(crate) fn trace<S>(&mut self, shape: &S, path: &impl Path<T>, a: T, force: &mut [T])
    where
        S: Shape<T, Spot = Spot>,
    {
        let samples = force.len();
        self.branches.clear();
        self.pieces.clear();
        self.spots.resize(samples, S::spot(Direction::Unloading, Place::at(T::from(0.0))));
        let (lowest, start) = (path.lowest(), wrap(path.first_sample(0), samples));
        self.half = (shape.is_odd() && path.mirrors()).then_some(Piece {
            owner: 0,
            first: start,
            length: samples / 2,
        });
        let legs = if self.half.is_some() { lowest } else { path.count() };
        for r in 0..legs {
            if r == 0 {
                self.begin_main(0, lowest, Direction::Unloading, shape.tip(Direction::Unloading));
            } else if r == lowest {
                self.begin_main(lowest, 0, Direction::Loading, shape.tip(Direction::Loading));
            } else {
                self.reverse(shape, path, a, r);
            }
            let mut end = path.first_sample(r + 1);
            if self.half.is_some() {
                // Neither a sample more nor one less, however the minimum is rounded.
                let half = path.first_sample(0) + samples / 2;
                end = if r + 1 == lowest { half } else { end.min(half) };
            }
            self.walk::<S>(path, a, path.first_sample(r), end, samples);
            self.close_until(path, path.tip(r + 1));
        }
        for range in self.walked(samples) {
            let (Some(spots), Some(force)) = (self.spots.get(range.clone()), force.get_mut(range)) else {
                continue;
            };
            shape.evaluate(spots, force);
        }
        for piece in &self.pieces {
            let Some(branch) = self.branches.get(piece.owner) else { continue };
            let sign = branch.direction.sign();
            piece.for_each(force, |f| {
                *f = branch.force_at_start + branch.ratio * shape.change_to(branch.direction, *f) * sign;
            });
        }
        if let Some(half) = self.half {
            mirror(force, half, |f| -f);
        }
    }

    /// The samples that were walked through: all, or half a period.
    pub(crate) fn walked(&self, samples: usize) -> [Range<usize>; 2] {
        self.half.unwrap_or(Piece { owner: 0, first: 0, length: samples }).ranges(samples)
    }

    fn begin_main(&mut self, start: usize, target: usize, direction: Direction, force_at_start: T) {
        self.stack.clear();
        self.stack.push(self.branches.len());
        let parent = self.branches.len();
        let ratio = T::from(1.0);
        self.branches.push(Branch { start, target, direction, force_at_start, ratio, main: true, parent });
    }

    /// Starts a minor branch at turning point `r`, towards the start of the branch it interrupts.
    fn reverse(&mut self, shape: &impl Shape<T>, path: &impl Path<T>, a: T, r: usize) {
        let Some((parent, branch)) = self.current() else { return };
        let sign = branch.direction.sign();
        let turn = Place::at((path.tip(r) - path.tip(branch.start)) * sign / a);
        let change = shape.change(branch.direction, turn);
        let direction = branch.direction.reversed();
        let ratio = if shape.is_odd() || turn.gone.value() <= 0.0 {
            branch.ratio
        } else {
            // Ends at the force where the interrupted branch began.
            branch.ratio * change / shape.change(direction, turn)
        };
        self.stack.push(self.branches.len());
        self.branches.push(Branch {
            start: r,
            target: branch.start,
            direction,
            force_at_start: branch.force_at_start + branch.ratio * change * sign,
            ratio,
            main: false,
            parent,
        });
    }

    fn current(&self) -> Option<(usize, Branch<T>)> {
        let index = *self.stack.last()?;
        Some((index, *self.branches.get(index)?))
    }

    /// Forgets every minor loop that is closed when the displacement arrives at `w`.
    fn close_until(&mut self, path: &impl Path<T>, w: T) {
        while self.stack.len() > 2 {
            let Some((_, branch)) = self.current() else { return };
            let beyond = (w - path.tip(branch.target)) * branch.direction.sign();
            if beyond.value() <= 0.0 {
                return;
            }
            self.stack.truncate(self.stack.len() - 2);
        }
    }

    /// Places samples `first..end` (counted on past a full period) between two turning points on their branches.
    fn walk<S>(&mut self, path: &impl Path<T>, a: T, first: usize, end: usize, samples: usize)
    where
        S: Shape<T, Spot = Spot>,
    {
        let per_amplitude = T::from(1.0) / a;
        let mut from = first;
        while from < end {
            self.close_until(path, path.sample(wrap(from, samples)));
            let Some((owner, branch)) = self.current() else { return };
            // The branch may close on the way; on the lowest two levels it cannot.
            let closes = self.stack.len() > 2;
            let target = path.tip(branch.target);
            let sign = branch.direction.sign();
            let mut j = from;
            while j < end {
                let sample = wrap(j, samples);
                if closes && ((path.sample(sample) - target) * sign).value() > 0.0 {
                    break;
                }
                let here = branch.place(path, per_amplitude, sample);
                if let Some(spot) = self.spots.get_mut(sample) {
                    *spot = S::spot(branch.direction, here);
                }
                j += 1;
            }
            self.pieces.push(Piece { owner, first: wrap(from, samples), length: j - from });
            from = j;
        }
    }
}

impl<T: Real> Branch<T> {
    /// Where sample `j` lies on the branch. On a main branch it is measured from the nearer tip.
    #[inline]
    pub(crate) fn place(&self, path: &impl Path<T>, per_amplitude: T, j: usize) -> Place<T> {
        let here = Place::at(path.distance(j, self.start) * per_amplitude);
        if self.main && here.left.value() < 1.0 {
            return Place::at(path.distance(j, self.target) * per_amplitude).reversed();
        }
        here
    }
}
