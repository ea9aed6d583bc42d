//! Shooting: from the start by following the motion, then Newton's method on the map of a period, or of half of one
//! where mirrored motions have mirrored forces.

use std::f64::consts::{PI, TAU};

use faer::Mat;

use crate::error::OrbitError;
use crate::settings::Settings;

/// Steps of Newton's method in one attempt.
const MOST_STEPS: usize = 25;
/// Singular values below this, relative to one or to the largest, are directions in which nothing changes (the rest
/// position of sliders that never slip, a rigid body): Newton's method leaves them as they are.
const NEUTRAL: f64 = 1e-11;
/// Periods after which a motion is looked at for repeating.
const MOST_PERIODS: usize = 12;
/// Difference below which it has repeated.
const REPEATED: f64 = 1e-6;
/// Closure at which nothing is left to gain.
const ROUNDING: f64 = 1e-15;

/// What a passage saw on its way.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Passage {
    /// Largest |y| and |y'|.
    pub(crate) peak: (f64, f64),
}

/// The map from the state at τ = 0 to that at a later phase.
pub(crate) trait Map {
    /// The end state at phase `until`, and its derivative where asked for.
    fn pass(
        &mut self,
        from: &[f64],
        until: f64,
        end: &mut Vec<f64>,
        derivative: Option<&mut Mat<f64>>,
    ) -> Result<Passage, OrbitError>;

    /// Factors that make differences of states relative to the motion's own size, at most 1 then.
    fn weights(&self, passage: Passage, weights: &mut Vec<f64>);

    /// Makes a state one that exists (slider forces within their limits).
    fn admit(&self, state: &mut [f64]);
}

/// A closed orbit.
#[derive(Debug, Clone)]
pub(crate) struct Closed {
    pub(crate) state: Vec<f64>,
    pub(crate) iterations: usize,
    pub(crate) periods: usize,
}

/// x(until) = sign · x(0).
#[derive(Debug, Clone, Copy)]
struct Section {
    until: f64,
    sign: f64,
}

const HALF: Section = Section { until: PI, sign: -1.0 };
const FULL: Section = Section { until: TAU, sign: 1.0 };

/// An evaluated state of Newton's method.
struct Trial {
    state: Vec<f64>,
    residual: Vec<f64>,
    weights: Vec<f64>,
    derivative: Mat<f64>,
    size: f64,
}

/// Finds the state at τ = 0 of a periodic motion. `odd` allows half periods, `alone` says that no motion without that
/// symmetry is to be expected.
pub(crate) fn close(
    map: &mut dyn Map,
    start: Vec<f64>,
    (odd, alone): (bool, bool),
    settings: &Settings,
) -> Result<Closed, OrbitError> {
    let mut state = start;
    let (mut iterations, mut periods, mut best) = (0, 0, f64::INFINITY);
    let mut next_attempt = if settings.start.is_some() { 0 } else { 2.min(settings.settling_periods) };
    let (mut end, mut weights) = (Vec::new(), Vec::new());
    loop {
        let mut difference = (f64::INFINITY, f64::INFINITY);
        while periods < next_attempt {
            let passage = map.pass(&state, TAU, &mut end, None)?;
            map.weights(passage, &mut weights);
            difference.0 = distance(&end, &state, 1.0, &weights);
            std::mem::swap(&mut state, &mut end);
            periods += 1;
        }
        if odd && !alone {
            let passage = map.pass(&state, PI, &mut end, None)?;
            map.weights(passage, &mut weights);
            difference.1 = distance(&end, &state, -1.0, &weights);
        }
        let mirrored = odd && (alone || difference.1 <= 30.0 * difference.0);
        for section in [HALF, FULL] {
            if section.sign < 0.0 && !mirrored {
                continue;
            }
            let (closed, size, steps) = newton(map, &state, section, settings.closure);
            iterations += steps;
            best = best.min(size);
            if let Some(state) = closed {
                return Ok(Closed { state, iterations, periods });
            }
        }
        if periods >= settings.settling_periods {
            if let Some((periods, closure)) = repeats_after(map, &state)? {
                return Err(OrbitError::Subharmonic { periods, closure });
            }
            return Err(OrbitError::NotClosed { closure: best, periods, iterations });
        }
        next_attempt =
            (2 * periods).clamp(2, settings.settling_periods.max(2)).min(settings.settling_periods);
    }
}

/// Closes a motion that begins near an orbit already known.
pub(crate) fn again(map: &mut dyn Map, state: &[f64], known: &Closed, closure: f64) -> Option<Closed> {
    let (state, _, steps) = newton(map, state, FULL, closure);
    Some(Closed { state: state?, iterations: known.iterations + steps, periods: known.periods })
}

/// How many periods, more than one, bring the motion back to `state`, and how close.
fn repeats_after(map: &mut dyn Map, state: &[f64]) -> Result<Option<(usize, f64)>, OrbitError> {
    let (mut from, mut end, mut weights) = (state.to_vec(), Vec::new(), Vec::new());
    for periods in 1..=MOST_PERIODS {
        let passage = map.pass(&from, TAU, &mut end, None)?;
        map.weights(passage, &mut weights);
        let difference = distance(&end, state, 1.0, &weights);
        if difference < REPEATED {
            return Ok((periods > 1).then_some((periods, difference)));
        }
        std::mem::swap(&mut from, &mut end);
    }
    Ok(None)
}

/// Largest weighed `|end − sign · start|`.
pub(crate) fn distance(end: &[f64], start: &[f64], sign: f64, weights: &[f64]) -> f64 {
    let differences = end.iter().zip(start).zip(weights).map(|((e, s), w)| (e - sign * s).abs() * w);
    differences.fold(0.0, |top, d| if d.is_nan() { f64::INFINITY } else { top.max(d) })
}

/// Newton's method from `start`; the state when it closed, the smallest size of the residual, the steps.
fn newton(
    map: &mut dyn Map,
    start: &[f64],
    section: Section,
    closure: f64,
) -> (Option<Vec<f64>>, f64, usize) {
    let Some(mut current) = evaluate(map, start.to_vec(), section) else { return (None, f64::INFINITY, 0) };
    for step in 1..=MOST_STEPS {
        if current.size <= ROUNDING {
            return (Some(current.state), current.size, step - 1);
        }
        let accepted = direction(&current, section).and_then(|change| {
            [1.0, 0.5, 0.25, 0.1, 0.03].iter().find_map(|share| {
                let mut state = current.state.clone();
                state.iter_mut().zip(&change).for_each(|(x, dx)| *x += share * dx);
                map.admit(&mut state);
                evaluate(map, state, section)
                    .filter(|trial| trial.size < (1.0 - 0.1 * share) * current.size)
                    // At rounding there is no use in shorter steps.
                    .map_or_else(|| (current.size <= closure).then_some(None), |trial| Some(Some(trial)))
            })
        });
        match accepted.flatten() {
            Some(trial) => current = trial,
            None if current.size <= closure => return (Some(current.state), current.size, step),
            None => return (None, current.size, step),
        }
    }
    ((current.size <= closure).then_some(current.state), current.size, MOST_STEPS)
}

fn evaluate(map: &mut dyn Map, state: Vec<f64>, section: Section) -> Option<Trial> {
    let (mut end, mut weights) = (Vec::new(), Vec::new());
    let mut derivative = Mat::zeros(state.len(), state.len());
    let passage = map.pass(&state, section.until, &mut end, Some(&mut derivative)).ok()?;
    map.weights(passage, &mut weights);
    let size = distance(&end, &state, section.sign, &weights);
    let residual = end.iter().zip(&state).map(|(e, s)| e - section.sign * s).collect();
    size.is_finite().then_some(Trial { state, residual, weights, derivative, size })
}

/// The solution of `(sign − Φ) δ = r` of smallest norm, in weighed states.
fn direction(trial: &Trial, section: Section) -> Option<Vec<f64>> {
    let n = trial.state.len();
    let weight = |i: usize| trial.weights.get(i).copied().unwrap_or(1.0);
    let matrix = Mat::from_fn(n, n, |i, j| {
        let unit = if i == j { section.sign } else { 0.0 };
        (unit - trial.derivative[(i, j)]) * weight(i) / weight(j)
    });
    let svd = matrix.svd().ok()?;
    let values = svd.S().column_vector();
    let largest = values.iter().fold(0.0_f64, |top, s| top.max(*s));
    let mut change = vec![0.0; n];
    for (q, value) in values.iter().enumerate().filter(|(_, value)| **value > NEUTRAL * largest.max(1.0)) {
        let along: f64 =
            trial.residual.iter().enumerate().map(|(i, r)| svd.U()[(i, q)] * r * weight(i)).sum();
        for (j, change) in change.iter_mut().enumerate() {
            *change += along / value * svd.V()[(j, q)] / weight(j);
        }
    }
    change.iter().all(|x| x.is_finite()).then_some(change)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Swaps two states in every period and has no fixed point: x → x + 1 below ½, x − 1 above, contracting to 0 and 1.
    struct Swap;

    impl Map for Swap {
        fn pass(
            &mut self,
            from: &[f64],
            _until: f64,
            end: &mut Vec<f64>,
            derivative: Option<&mut Mat<f64>>,
        ) -> Result<Passage, OrbitError> {
            let x = from.first().copied().unwrap_or(0.0);
            end.clear();
            end.push(if x < 0.5 { 1.0 + 0.5 * x } else { 0.5 * (x - 1.0) });
            if let Some(derivative) = derivative {
                derivative[(0, 0)] = 0.5;
            }
            Ok(Passage { peak: (1.0, 1.0) })
        }

        fn weights(&self, _passage: Passage, weights: &mut Vec<f64>) {
            weights.clear();
            weights.push(1.0);
        }

        fn admit(&self, _state: &mut [f64]) {}
    }

    #[test]
    fn a_motion_of_two_periods_is_named() {
        let error = close(&mut Swap, vec![0.2], (false, false), &Settings::default()).unwrap_err();
        let OrbitError::Subharmonic { periods, closure } = error else { panic!("{error}") };
        assert_eq!(periods, 2);
        assert!(closure < 1e-6);
    }
}
