//! Loop phase of every sample: where on the loop it was measured.
//!
//! θ = arccos ξ loses half of its digits near the tips and turns the noise of the displacement into jitter of
//! θ there. So the distance to the tip a branch starts from, `p = 1 − ξ`, is taken directly, near the tips
//! from the parabola through many samples instead of from single ones, and `θ = 2 asin √(p/2)`.

use std::f64::consts::{PI, TAU};

use crate::cycles::Steady;
use crate::error::FitError;
use crate::turning_points::TurningPoint;

/// A sample with its place on the loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhasedSample {
    /// Loop phase in [0, 2π]: unloading up to π, loading above.
    pub theta: f64,
    /// Time \[s\] or sample number.
    pub position: f64,
    /// Force \[N\].
    pub force: f64,
    /// Number of its branch among those of the steady part.
    pub branch: usize,
}

/// The samples of the steady branches.
pub(crate) struct LoopPhases {
    /// In the order of measurement within a branch.
    pub samples: Vec<PhasedSample>,
    /// Number of unloading and of loading branches.
    pub branches: (usize, usize),
    /// Whether a branch had to be put together from its pieces at the two ends of the record.
    pub joined: bool,
}

/// How far, in heights, a tip at the record's edge may be from where it should be to count as seen.
const EDGE_TOLERANCE: f64 = 2e-3;

/// One end of a branch.
struct Tip {
    position: f64,
    displacement: f64,
    parabola: Option<(std::ops::Range<usize>, f64)>,
}

impl Tip {
    fn at(point: &TurningPoint) -> Self {
        let parabola = point.curvature.map(|c| (point.window.clone(), c));
        Self { position: point.position, displacement: point.displacement, parabola }
    }

    /// Distance of a sample from this tip \[m\], along the motion.
    fn distance(&self, sample: usize, position: f64, displacement: f64) -> f64 {
        match &self.parabola {
            Some((window, curvature)) if window.contains(&sample) => {
                curvature * (position - self.position).powi(2)
            }
            _ => (displacement - self.displacement).abs(),
        }
    }

    fn near(&self, sample: usize) -> bool {
        self.parabola.as_ref().is_some_and(|(window, _)| window.contains(&sample))
    }
}

/// Gives the samples of every complete steady branch their loop phase. A direction without a complete
/// branch is put together from its pieces at the ends of the record.
pub(crate) fn loop_phases(
    position: &[f64],
    displacement: &[f64],
    force: &[f64],
    steady: &Steady,
) -> Result<LoopPhases, FitError> {
    let height = 2.0 * steady.amplitude();
    let seen = |p: &TurningPoint| {
        let off = (p.displacement - steady.level(p.upper, p.position)).abs();
        !p.at_edge || off <= EDGE_TOLERANCE * height
    };
    let mut phases = LoopPhases { samples: Vec::new(), branches: (0, 0), joined: false };
    let mut add = |from: Tip, to: Tip, range: (f64, f64), loading: bool, whole: bool| {
        let first = position.partition_point(|&u| u < range.0);
        let last = position.partition_point(|&u| u < range.1);
        if last <= first {
            return;
        }
        let counter = if loading { &mut phases.branches.1 } else { &mut phases.branches.0 };
        // All pieces of a direction are one branch.
        if whole || *counter == 0 {
            *counter += 1;
        }
        phases.joined |= !whole;
        let branch = phases.branches.0 + phases.branches.1 - 1;
        let half = 0.5 * (from.displacement - to.displacement).abs();
        let columns = position.iter().zip(displacement).zip(force).enumerate();
        for (sample, ((&u, &w), &f)) in columns.take(last).skip(first) {
            let started = from.distance(sample, u, w) / half;
            let ahead = to.distance(sample, u, w) / half;
            // The nearer tip is the more accurate one.
            let before_middle = if to.near(sample) { false } else { from.near(sample) || started < ahead };
            let theta = if before_middle {
                2.0 * (0.5 * started).sqrt().min(1.0).asin()
            } else {
                PI - 2.0 * (0.5 * ahead).sqrt().min(1.0).asin()
            };
            let theta = if loading { PI + theta } else { theta };
            phases.samples.push(PhasedSample { theta, position: u, force: f, branch });
        }
    };

    for loading in [false, true] {
        let mut found = false;
        for (a, b) in steady.points.iter().zip(steady.points.iter().skip(1)) {
            if a.upper != loading && seen(a) && seen(b) {
                add(Tip::at(a), Tip::at(b), (a.position, b.position), loading, true);
                found = true;
            }
        }
        if found {
            continue;
        }
        // Pieces: from the record's start to the first turning point, from the last one to the end, and
        // between a turning point and one too close to the edge to be seen.
        let tip = |point: Option<&TurningPoint>, upper: bool, position: f64| match point {
            Some(point) if seen(point) => Tip::at(point),
            _ => Tip { position, displacement: steady.level(upper, position), parabola: None },
        };
        let ends = |point: Option<&TurningPoint>, other: f64| point.map_or(other, |p| p.position);
        let none = std::iter::once(None);
        let before = none.clone().chain(steady.points.iter().map(Some));
        let after = steady.points.iter().map(Some).chain(none);
        for (a, b) in before.zip(after) {
            let upper_first = a.map_or_else(|| b.is_some_and(|b| !b.upper), |a| a.upper);
            if upper_first == loading {
                continue;
            }
            let near = a.or(b).map_or(0.0, |p| p.position);
            let range = (ends(a, steady.reach.0), ends(b, steady.reach.1));
            let (from, to) = (tip(a, !loading, near), tip(b, loading, near));
            add(from, to, range, loading, false);
        }
    }
    Ok(phases)
}

/// Largest step between neighbouring loop phases, around the circle: its start and its width \[rad\].
pub(crate) fn largest_gap(mut thetas: Vec<f64>) -> (f64, f64) {
    thetas.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (thetas.first(), thetas.last()) else { return (0.0, TAU) };
    thetas
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some((*a, b - a)),
            _ => None,
        })
        .fold((last, first + TAU - last), |widest, gap| if gap.1 > widest.1 { gap } else { widest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::turning_points::{extremes, turning_points};
    use rand::SeedableRng;

    #[test]
    fn noise_does_not_blur_the_loop_phase_at_the_tips() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let (samples, noise) = (1000.0, 1e-3);
        let position: Vec<f64> = (0..6000).map(f64::from).collect();
        let w: Vec<f64> = position
            .iter()
            .map(|u| (TAU * u / samples).sin() + noise * crate::synthetic::normal(&mut rng))
            .collect();
        let points = turning_points(&position, &w, &extremes(&w, 0.5), 2.0);
        let steady = Steady::find(&points, 0.02).unwrap();
        let phases = loop_phases(&position, &w, &w, &steady).unwrap();
        let off = |sample: &PhasedSample| {
            let exact = (TAU * sample.position / samples - 0.5 * PI).rem_euclid(TAU);
            let off = (sample.theta - exact).abs();
            (exact % PI, off.min(TAU - off))
        };
        let near: Vec<f64> =
            phases.samples.iter().map(off).filter(|(tip, _)| tip.min(PI - tip) < 0.03).map(|o| o.1).collect();
        let rms = (near.iter().map(|off| off * off).sum::<f64>() / near.len() as f64).sqrt();
        // From single samples it would be about √(2 · noise) = 0.045.
        assert!(near.len() > 50 && rms < 0.008, "{rms}");
    }
}
