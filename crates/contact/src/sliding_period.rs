//! The periodic state of a friction slider, and how it changes with the motion.
//!
//! A change is recursive in time, `δs_j = A_j δs_{j−1} + B_j δx_j + B'_j δx_{j−1}` with x the displacement and the load, and
//! closed over the period: `δs_0 = Φ δs_0 + c`, Φ the product of all A. A slider that never slips is instead a function of its
//! start and of the discs that hold it.

use std::array::from_fn;

use crate::common_point::CommonPoint;
use crate::error::LawError;
use crate::joint::JointMotion;
use crate::law::ContactState;
use crate::partials::Partials;
use crate::real::Real;
use crate::slider::{Grip, advance, dot};

/// Periods that are followed at most.
const LONGEST: usize = 200;

/// Periods that are simply followed before the map of one period onto the next is used.
const FOLLOWED: usize = 3;

type Matrix<const D: usize> = [[f64; D]; D];

/// What kind of periodic state it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Regime<const D: usize> {
    /// No friction, or no contact: no tangential force.
    Frictionless,
    /// Never slips.
    Resting(CommonPoint<D>),
    /// Slips or lifts off in every period, as the steps say.
    Sliding {
        /// Sample at which the period begins.
        first: usize,
        /// (I − Φ)⁻¹; `None` where the slider forgets everything at `first`.
        closure: Option<Matrix<D>>,
    },
}

/// A step from one sample to the next: where the slider is then, and the coefficients of its change.
#[derive(Debug, Clone, Copy)]
struct Step<const D: usize> {
    grip: Grip,
    slider: [f64; D],
    /// ∂s_j/∂s_{j−1}.
    memory: Matrix<D>,
    /// ∂s_j/∂w_{j−1} and ∂s_j/∂w_j.
    way: [Matrix<D>; 2],
    /// ∂s_j/∂ρ_{j−1} and ∂s_j/∂ρ_j.
    reach: [[f64; D]; 2],
}

/// One period of a slider; the buffers are reused.
#[derive(Debug)]
pub(crate) struct SlidingPeriod<const D: usize> {
    /// Load at every sample in N; negative: apart.
    pub(crate) loads: Vec<f64>,
    /// Periods that were followed.
    pub(crate) cycles: usize,
    /// The step that ends at every sample.
    steps: Vec<Step<D>>,
}

/// Where the body is at the samples.
struct Course<'a, const D: usize> {
    rows: [&'a [f64]; D],
    loads: &'a [f64],
    /// m/N.
    per_load: f64,
}

impl<const D: usize> Course<'_, D> {
    fn place(&self, j: usize) -> [f64; D] {
        from_fn(|i| self.rows[i].get(j).copied().unwrap_or(0.0))
    }

    fn reach(&self, j: usize) -> f64 {
        self.loads.get(j).copied().unwrap_or(0.0) * self.per_load
    }

    /// The sample with the least value of `key`, the first of several.
    fn least(&self, key: impl Fn(usize) -> f64) -> usize {
        (0..self.loads.len()).min_by(|&a, &b| key(a).total_cmp(&key(b))).unwrap_or(0)
    }
}

/// The slider after a step from `before` to `after`, each place and reach of the body.
pub(crate) fn follow<T: Real, const D: usize>(
    slider: [T; D],
    slipping: bool,
    before: ([T; D], T),
    after: ([T; D], T),
) -> ([T; D], Grip) {
    let ((w0, from), (w1, to)) = (before, after);
    let (q, grip): ([T; D], _) =
        advance(from_fn(|i| w0[i] - slider[i]), slipping, from_fn(|i| w1[i] - w0[i]), from, to);
    (if grip == Grip::Stick { slider } else { from_fn(|i| w1[i] - q[i]) }, grip)
}

impl<const D: usize> Step<D> {
    fn at_rest() -> Self {
        Self {
            grip: Grip::Apart,
            slider: [0.0; D],
            memory: [[0.0; D]; D],
            way: [[[0.0; D]; D]; 2],
            reach: [[0.0; D]; 2],
        }
    }

    /// Fills in the coefficients of the step from `slider`.
    fn differentiate(
        &mut self,
        slider: [f64; D],
        slipping: bool,
        before: ([f64; D], f64),
        after: ([f64; D], f64),
    ) {
        if matches!(self.grip, Grip::Stick | Grip::Apart) {
            return;
        }
        // Deflection, way and both reaches.
        let ((w0, from), (w1, to)) = (before, after);
        let (q, _) = advance::<Partials<6>, D>(
            from_fn(|i| Partials::input(w0[i] - slider[i], i)),
            slipping,
            from_fn(|i| Partials::input(w1[i] - w0[i], 2 + i)),
            Partials::input(from, 4),
            Partials::input(to, 5),
        );
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        self.memory = from_fn(|i| from_fn(|j| q[i].slopes[j]));
        self.way = [
            from_fn(|i| from_fn(|j| q[i].slopes[2 + j] - q[i].slopes[j])),
            from_fn(|i| from_fn(|j| unit(i, j) - q[i].slopes[2 + j])),
        ];
        self.reach = [from_fn(|i| -q[i].slopes[4]), from_fn(|i| -q[i].slopes[5])];
    }

    /// δs after the step from δs before it, for a change of the displacement in direction `moves`, or else of the reach.
    #[inline]
    fn change(&self, slider: [f64; D], moves: Option<usize>, [before, after]: [f64; 2]) -> [f64; D] {
        match (self.grip, moves) {
            (Grip::Stick, _) => slider,
            (Grip::Apart, None) => [0.0; D],
            (Grip::Apart, Some(k)) => from_fn(|i| if i == k { after } else { 0.0 }),
            (_, None) => from_fn(|i| {
                dot(self.memory[i], slider) + self.reach[0][i] * before + self.reach[1][i] * after
            }),
            (_, Some(k)) => from_fn(|i| {
                let [from, to] = [self.way[0][i][k], self.way[1][i][k]];
                dot(self.memory[i], slider) + from * before + to * after
            }),
        }
    }
}

impl<const D: usize> SlidingPeriod<D> {
    pub(crate) fn new(samples: usize) -> Self {
        Self { loads: Vec::with_capacity(samples), cycles: 0, steps: vec![Step::at_rest(); samples] }
    }

    pub(crate) fn samples(&self) -> usize {
        self.steps.len()
    }

    /// The slider at a sample; `None` where it is with the body.
    pub(crate) fn slider(&self, regime: &Regime<D>, sample: usize, direction: usize) -> Option<f64> {
        match regime {
            Regime::Frictionless => None,
            Regime::Resting(rest) => rest.point.get(direction).copied(),
            Regime::Sliding { .. } => self
                .steps
                .get(sample)
                .filter(|step| step.grip != Grip::Apart)
                .and_then(|step| step.slider.get(direction).copied()),
        }
    }

    /// Stick, slip or both while in contact.
    pub(crate) fn state(&self, regime: &Regime<D>) -> ContactState {
        let any = |wanted: fn(Grip) -> bool| self.steps.iter().any(|step| wanted(step.grip));
        match regime {
            Regime::Frictionless => ContactState::Slip,
            Regime::Resting(_) => ContactState::Stick,
            Regime::Sliding { .. } => {
                match (any(|g| g == Grip::Slip), any(|g| matches!(g, Grip::Stick | Grip::Caught))) {
                    (true, false) => ContactState::Slip,
                    (false, _) => ContactState::Stick,
                    _ => ContactState::Mixed,
                }
            }
        }
    }

    /// The periodic state under the loads that were filled in; `per_load` is μ/k_t in m/N, `mean` the mean displacement.
    ///
    /// # Errors
    /// [`LawError::NoPeriodicState`] when the state still changes after many periods.
    pub(crate) fn find(
        &mut self,
        motion: &JointMotion,
        per_load: f64,
        mean: [f64; D],
    ) -> Result<Regime<D>, LawError> {
        let Self { loads, cycles, steps } = self;
        *cycles = 1;
        let course = Course { rows: from_fn(|i| motion.displacement_of(i)), loads, per_load };
        if per_load == 0.0 || loads.iter().all(|load| *load <= 0.0) {
            return Ok(Regime::Frictionless);
        }
        let least = course.least(|j| course.reach(j));
        if course.reach(least) <= 0.0 {
            march(steps, &course, least, (course.place(least), false), true);
            return Ok(Regime::Sliding { first: least, closure: None });
        }
        let largest = motion.displacement.iter().fold(0.0_f64, |top, w| top.max(w.abs()));
        let tolerance = 16.0 * f64::EPSILON * largest;
        let disc = |j: usize| (course.place(j), course.reach(j));
        if let Some(rest) = CommonPoint::nearest(mean, loads.len(), disc, tolerance) {
            return Ok(Regime::Resting(rest));
        }
        if D == 1 {
            // The highest lower edge is where the slider is dragged to.
            let lower = |j: usize| course.place(j)[0] - course.reach(j);
            let first = course.least(|j| -lower(j));
            march(steps, &course, first, ([lower(first); D], true), true);
            return Ok(Regime::Sliding { first, closure: None });
        }
        let start = held_to(mean, disc(least));
        let (closure, end) = settle(steps, &course, least, start, cycles, tolerance)?;
        let slips = steps.iter().any(|step| step.grip == Grip::Slip);
        Ok(if slips {
            Regime::Sliding { first: least, closure: Some(closure) }
        } else {
            // All discs have a common point to within rounding.
            let mut rest = CommonPoint::free(mean);
            rest.point = end;
            Regime::Resting(rest)
        })
    }

    /// δs at every sample, to `visit`, for the change `by` of the displacement in direction `moves`, or else of the normal
    /// approach, of which the reach is `per_approach` times; `mean` is the change of the mean displacement.
    pub(crate) fn change(
        &self,
        regime: &Regime<D>,
        by: &[f64],
        moves: Option<usize>,
        per_approach: f64,
        mean: f64,
        mut visit: impl FnMut(usize, [f64; D]),
    ) {
        let factor = if moves.is_some() { 1.0 } else { per_approach };
        let at = |j: usize| by.get(j).copied().unwrap_or(0.0) * factor;
        let samples = self.steps.len();
        match regime {
            Regime::Frictionless => (0..samples).for_each(|j| {
                let w = by.get(j).copied().unwrap_or(0.0);
                visit(j, from_fn(|i| if moves == Some(i) { w } else { 0.0 }));
            }),
            Regime::Resting(rest) => {
                let mut slider: [f64; D] = from_fn(|i| moves.map_or(0.0, |k| rest.by_start[i][k] * mean));
                for (edge, sample) in rest.edges.iter().enumerate() {
                    let Some(j) = *sample else { continue };
                    for (i, s) in slider.iter_mut().enumerate() {
                        *s += at(j) * moves.map_or(rest.by_radius[edge][i], |k| rest.by_centre[edge][i][k]);
                    }
                }
                (0..samples).for_each(|j| visit(j, slider));
            }
            Regime::Sliding { first, closure } => {
                let pass = |mut slider: [f64; D], visit: &mut dyn FnMut(usize, [f64; D])| {
                    let mut before = at(*first);
                    for j in (first + 1..samples).chain(0..=*first) {
                        let Some(step) = self.steps.get(j) else { continue };
                        let after = at(j);
                        slider = step.change(slider, moves, [before, after]);
                        before = after;
                        visit(j, slider);
                    }
                    slider
                };
                // Without memory of the step before, the first change is that of the last step alone.
                let start = match closure {
                    Some(closure) => {
                        let open = pass([0.0; D], &mut |_, _| ());
                        from_fn(|i| dot(closure[i], open))
                    }
                    None => self.steps.get(*first).map_or([0.0; D], |step| {
                        let before = at(first.checked_sub(1).unwrap_or(samples - 1));
                        step.change([0.0; D], moves, [before, at(*first)])
                    }),
                };
                pass(start, &mut visit);
            }
        }
    }
}

/// The point of the disc nearest to `point`.
fn held_to<const D: usize>(point: [f64; D], (centre, radius): ([f64; D], f64)) -> [f64; D] {
    let from: [f64; D] = from_fn(|i| point[i] - centre[i]);
    let distance = dot(from, from).sqrt();
    if distance <= radius { point } else { from_fn(|i| centre[i] + from[i] * (radius / distance)) }
}

/// The point of the disc's edge nearest to `point`.
fn on_edge<const D: usize>(point: [f64; D], (centre, radius): ([f64; D], f64)) -> [f64; D] {
    let from: [f64; D] = from_fn(|i| point[i] - centre[i]);
    let distance = dot(from, from).sqrt();
    from_fn(|i| centre[i] + from[i] * (radius / distance))
}

/// Follows one period from sample `first`; the steps get their coefficients where `differentiate`. Returns the state at its
/// end.
fn march<const D: usize>(
    steps: &mut [Step<D>],
    course: &Course<D>,
    first: usize,
    (mut slider, mut slipping): ([f64; D], bool),
    differentiate: bool,
) -> ([f64; D], bool) {
    let samples = steps.len();
    let mut before = (course.place(first), course.reach(first));
    for j in (first + 1..samples).chain(0..=first) {
        let Some(step) = steps.get_mut(j) else { continue };
        let after = (course.place(j), course.reach(j));
        let (next, grip) = follow(slider, slipping, before, after);
        (step.slider, step.grip) = (next, grip);
        if differentiate {
            step.differentiate(slider, slipping, before, after);
        }
        (slider, slipping, before) = (next, grip == Grip::Slip, after);
    }
    (slider, slipping)
}

/// Follows periods from `start` at sample `first` until the state repeats. There is one such state, and the map P of a period
/// brings no two states apart, so that Newton's method on s = P(s) may be used to get there sooner. Returns (I − Φ)⁻¹ and the
/// state.
fn settle<const D: usize>(
    steps: &mut [Step<D>],
    course: &Course<D>,
    first: usize,
    start: [f64; D],
    cycles: &mut usize,
    tolerance: f64,
) -> Result<(Matrix<D>, [f64; D]), LawError> {
    let mut state = (start, false);
    let mut last = f64::INFINITY;
    let mut change = f64::INFINITY;
    for cycle in 1..=LONGEST {
        *cycles = cycle;
        let differentiate = cycle >= FOLLOWED;
        let end = march(steps, course, first, state, differentiate);
        let way: [f64; D] = from_fn(|i| end.0[i] - state.0[i]);
        change = dot(way, way).sqrt();
        if !differentiate {
            state = end;
            continue;
        }
        let closure = closure(steps, first);
        if change <= tolerance {
            return Ok((closure, end.0));
        }
        // A step of Newton's method that did not help is followed by a period as it comes.
        let leap: [f64; D] = from_fn(|i| state.0[i] + dot(closure[i], way));
        state = if change <= 0.5 * last && leap.iter().all(|x| x.is_finite()) {
            let disc = (course.place(first), course.reach(first));
            (if end.1 { on_edge(leap, disc) } else { held_to(leap, disc) }, end.1)
        } else {
            end
        };
        last = change;
    }
    Err(LawError::NoPeriodicState { cycles: LONGEST, change })
}

/// (I − Φ)⁻¹ of the steps that follow sample `first`.
fn closure<const D: usize>(steps: &[Step<D>], first: usize) -> Matrix<D> {
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let mut phi: Matrix<D> = from_fn(|i| from_fn(|j| unit(i, j)));
    let (early, late) = steps.split_at((first + 1).min(steps.len()));
    for step in late.iter().chain(early).filter(|step| step.grip != Grip::Stick) {
        let columns: Matrix<D> = from_fn(|j| from_fn(|i| phi[i][j]));
        phi = from_fn(|i| from_fn(|j| dot(step.memory[i], columns[j])));
    }
    let open: Matrix<D> = from_fn(|i| from_fn(|j| unit(i, j) - phi[i][j]));
    if D == 1 {
        return [[1.0 / open[0][0]; D]; D];
    }
    let determinant = open[0][0] * open[D - 1][D - 1] - open[0][D - 1] * open[D - 1][0];
    from_fn(|i| from_fn(|j| if i == j { open[1 - i][1 - j] } else { -open[i][j] } / determinant))
}
