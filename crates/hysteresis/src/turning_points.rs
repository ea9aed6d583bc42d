//! Turning points of the displacement: found against noise, then placed between the samples.

use std::ops::Range;

/// A reversal of the displacement.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningPoint {
    /// The sample nearest to it (0 is the record's first).
    pub sample: usize,
    /// When it happens: time \[s\], or sample number where the record has no time; between the samples.
    pub position: f64,
    /// Displacement there \[m\].
    pub displacement: f64,
    /// Whether it is an upper one (unloading follows) or a lower one (loading follows).
    pub upper: bool,
    /// Whether the record begins or ends so close to it that only one side of it was seen.
    pub(crate) at_edge: bool,
    /// The samples around it that its parabola was fitted to.
    pub(crate) window: Range<usize>,
    /// Half the second derivative of the parabola, positive; none where no parabola fits.
    pub(crate) curvature: Option<f64>,
}

/// Reversals below this part of the record's range are not turning points of a cycle.
pub(crate) const REVERSAL: f64 = 0.25;

/// How close to a tip, in half heights of the record, the motion is taken for a parabola.
const DEPTH: std::ops::RangeInclusive<f64> = 1e-3..=0.1;

/// Largest minus smallest value.
pub(crate) fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - low
}

/// Standard deviation of the white noise in `values`, from how far each is off the cubic through its four
/// neighbours, which a motion sampled well hardly is. Robust against outliers (median). `position` may be
/// uneven.
pub(crate) fn sample_noise(position: &[f64], values: &[f64]) -> f64 {
    let mut off: Vec<f64> = position
        .windows(5)
        .zip(values.windows(5))
        .filter_map(|(u, v)| match (u, v) {
            (&[ua, ub, uc, ud, ue], &[a, b, c, d, e]) => {
                let near = [(ua, a), (ub, b), (ud, d), (ue, e)];
                let (mut cubic, mut variance) = (0.0, 1.0);
                for (i, (ui, vi)) in near.into_iter().enumerate() {
                    let others = near.iter().enumerate().filter(|(j, _)| *j != i);
                    let weight: f64 = others.map(|(_, (uj, _))| (uc - uj) / (ui - uj)).product();
                    cubic += weight * vi;
                    variance += weight * weight;
                }
                Some((c - cubic).abs() / variance.sqrt()).filter(|off| off.is_finite())
            }
            _ => None,
        })
        .collect();
    if off.is_empty() {
        return 0.0;
    }
    let middle = off.len() / 2;
    let (_, median, _) = off.select_nth_unstable_by(middle, f64::total_cmp);
    *median / 0.6745 // the median of |x| is 0.6745 standard deviations of a normal x
}

/// Alternating extremes between which the displacement travels at least `threshold`: sample and whether
/// upper. The first and the last may be the record's ends.
pub(crate) fn extremes(displacement: &[f64], threshold: f64) -> Vec<(usize, bool)> {
    let mut found = Vec::new();
    let Some(&start) = displacement.first() else { return found };
    let (mut low, mut high) = ((0, start), (0, start));
    let mut rising = None;
    for (sample, &w) in displacement.iter().enumerate() {
        if w > high.1 {
            high = (sample, w);
        }
        if w < low.1 {
            low = (sample, w);
        }
        if rising != Some(false) && w <= high.1 - threshold {
            found.push((high.0, true));
            rising = Some(false);
            low = (sample, w);
        } else if rising != Some(true) && w >= low.1 + threshold {
            found.push((low.0, false));
            rising = Some(true);
            high = (sample, w);
        }
    }
    match rising {
        Some(true) => found.push((high.0, true)),
        Some(false) => found.push((low.0, false)),
        None => {}
    }
    found
}

/// Places the extremes between the samples: the vertex of the parabola of least squares through the samples
/// near the tip, as deep as noise demands. `position` never decreases; `height` is the record's range \[m\].
pub(crate) fn turning_points(
    position: &[f64],
    displacement: &[f64],
    extremes: &[(usize, bool)],
    height: f64,
) -> Vec<TurningPoint> {
    let half = 0.5 * height;
    let noise = sample_noise(position, displacement);
    let depth = (8.0 * noise).clamp(DEPTH.start() * half, DEPTH.end() * half);
    extremes
        .iter()
        .filter_map(|&(sample, upper)| {
            let raw = *displacement.get(sample)?;
            let mut point = TurningPoint {
                sample,
                position: *position.get(sample)?,
                displacement: raw,
                upper,
                at_edge: false,
                window: window(displacement, sample, depth + 5.0 * noise),
                curvature: None,
            };
            // Noise decides where the first window ends; the next ones are even about the vertex.
            let mut window = point.window.clone();
            point.at_edge = window.start == 0 || window.end == displacement.len();
            if window.len() >= 7 && !point.at_edge {
                // Of a dwell or a corner, should it be one, the middle.
                let (first, last) = (position.get(window.start)?, position.get(window.end - 1)?);
                point.position = 0.5 * (first + last);
            }
            for _ in 0..3 {
                let near = position.get(window.clone())?;
                let parabola = Parabola::fit(near, displacement.get(window.clone())?, point.position)
                    .filter(|parabola| parabola.is_tip(near, upper, point.at_edge))
                    .filter(|parabola| parabola.misfit <= (3.0 * noise).max(0.1 * depth)) // no corner
                    .filter(|parabola| parabola.drop(near) >= 0.25 * depth) // no dwell
                    .filter(|parabola| (parabola.vertex().1 - raw).abs() <= (0.1 * half).max(6.0 * noise));
                let Some(parabola) = parabola else { break };
                (point.position, point.displacement) = parabola.vertex();
                point.curvature = Some(parabola.second.abs());
                let width = near.last()? - near.first()?;
                let reach = (depth / parabola.second.abs()).sqrt().min(width);
                let even = position.partition_point(|u| *u < point.position - reach)
                    ..position.partition_point(|u| *u <= point.position + reach);
                point.window = std::mem::replace(&mut window, even);
                if window.len() < 7 || window == point.window {
                    break;
                }
            }
            Some(point)
        })
        .collect()
}

/// The samples in a row around an extreme that are no further than `depth` from it, and at least its
/// neighbours.
fn window(displacement: &[f64], sample: usize, depth: f64) -> Range<usize> {
    let Some(&tip) = displacement.get(sample) else { return sample..sample };
    let near = |w: &&f64| (**w - tip).abs() <= depth;
    let before = displacement.iter().take(sample).rev().take_while(near).count().max(1);
    let after = displacement.iter().skip(sample + 1).take_while(near).count().max(1);
    sample.saturating_sub(before)..(sample + 1 + after).min(displacement.len())
}

/// `level + slope·x + second·x²` with `x = position − centre`.
struct Parabola {
    centre: f64,
    level: f64,
    slope: f64,
    second: f64,
    /// Root mean square distance of the samples from it.
    misfit: f64,
}

impl Parabola {
    /// Least squares with orthogonal polynomials, which need no linear system.
    fn fit(position: &[f64], values: &[f64], centre: f64) -> Option<Self> {
        let n = values.len() as f64;
        let mean = position.iter().map(|u| u - centre).sum::<f64>() / n;
        let x = || position.iter().map(|u| u - centre - mean);
        let sum2: f64 = x().map(|x| x * x).sum();
        let skew = x().map(|x| x * x * x).sum::<f64>() / sum2;
        let quadratic = |x: f64| x * x - skew * x - sum2 / n;
        let norm: f64 = x().map(|x| quadratic(x).powi(2)).sum();
        let level = values.iter().sum::<f64>() / n;
        let slope = x().zip(values).map(|(x, w)| x * (w - level)).sum::<f64>() / sum2;
        let second = x().zip(values).map(|(x, w)| quadratic(x) * (w - level)).sum::<f64>() / norm;
        let off = |(x, w): (f64, &f64)| (w - level - slope * x - second * quadratic(x)).powi(2);
        let parabola = Self {
            centre: centre + mean,
            level: level - second * sum2 / n,
            slope: slope - second * skew,
            second,
            misfit: (x().zip(values).map(off).sum::<f64>() / n).sqrt(),
        };
        let enough = values.len() >= 3 && norm > 1e-12 * sum2 * sum2;
        (enough && parabola.second.is_finite() && parabola.slope.is_finite()).then_some(parabola)
    }

    /// Whether it turns the right way, inside the window. At an edge of the record one side of the tip was
    /// not seen: its vertex may lie a little outside.
    fn is_tip(&self, window: &[f64], upper: bool, at_edge: bool) -> bool {
        let (Some(first), Some(last)) = (window.first(), window.last()) else { return false };
        let slack = if at_edge { 0.5 * (last - first) } else { 0.0 };
        let vertex = self.vertex().0;
        let turns = if upper { self.second < 0.0 } else { self.second > 0.0 };
        turns && vertex >= first - slack && vertex <= last + slack
    }

    /// How far it falls from its vertex inside the window.
    fn drop(&self, window: &[f64]) -> f64 {
        let vertex = self.vertex().0;
        let ends = window.first().into_iter().chain(window.last());
        ends.map(|u| self.second.abs() * (u - vertex).powi(2)).fold(0.0, f64::max)
    }

    fn vertex(&self) -> (f64, f64) {
        let x = -0.5 * self.slope / self.second;
        (self.centre + x, self.level + 0.5 * self.slope * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn extremes_alternate_and_ignore_what_is_below_the_threshold() {
        let w = [0.0, 0.5, 0.45, 1.0, 0.9, 0.95, 0.0, -1.0, -0.95, 0.3];
        assert_eq!(extremes(&w, 0.4), [(0, false), (3, true), (7, false), (9, true)]);
        assert_eq!(extremes(&[1.0, 1.1], 0.4), []);
    }

    #[test]
    fn noise_of_a_known_size_is_measured() {
        use rand::SeedableRng;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let w: Vec<f64> = (0..20_000)
            .map(|j| (2.0 * PI * f64::from(j) / 200.0).sin() + 0.01 * crate::synthetic::normal(&mut rng))
            .collect();
        let u: Vec<f64> = (0..20_000).map(f64::from).collect();
        let measured = sample_noise(&u, &w) / 0.01;
        // A median of 20 000 correlated numbers has a standard error of about 1.5 %.
        assert!((measured - 1.0).abs() < 0.04, "{measured}");
    }

    #[test]
    fn a_parabola_is_found_again_exactly() {
        let u: Vec<f64> = [0.0, 0.1, 0.35, 0.4, 0.9, 1.0].iter().map(|u| u + 1e3).collect();
        let w: Vec<f64> = u.iter().map(|u| 3.0 - 2.0 * (u - 1000.3).powi(2)).collect();
        let fitted = Parabola::fit(&u, &w, 1000.4).unwrap();
        let (vertex, level) = fitted.vertex();
        assert!(
            (vertex - 1000.3).abs() < 1e-10
                && (level - 3.0).abs() < 1e-10
                && (fitted.second + 2.0).abs() < 1e-9
        );
    }

    #[test]
    fn a_dwell_is_no_parabola() {
        use rand::SeedableRng;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let u: Vec<f64> = (0..4000).map(f64::from).collect();
        let mut noise = || 1e-3 * crate::synthetic::normal(&mut rng);
        let w: Vec<f64> =
            u.iter().map(|u| (1.5 * (2.0 * PI * u / 400.0).sin()).clamp(-1.0, 1.0) + noise()).collect();
        let points = turning_points(&u, &w, &extremes(&w, 0.5), 2.0);
        for point in points.iter().filter(|p| !p.at_edge) {
            assert!(point.curvature.is_none(), "{point:?}");
            assert!((point.displacement.abs() - 1.0).abs() < 5e-3, "{point:?}");
        }
        assert!(points.len() > 18);
    }

    #[test]
    fn tips_of_a_coarsely_sampled_cosine_are_placed_between_the_samples() {
        // 17.3 samples a cycle: the sample nearest to a tip misses it by up to 1.6 % of the amplitude.
        let step = 2.0 * PI / 17.3;
        let u: Vec<f64> = (0..90).map(f64::from).collect();
        let w: Vec<f64> = u.iter().map(|u| (step * u - 1.0).cos()).collect();
        let points = turning_points(&u, &w, &extremes(&w, 0.5), 2.0);
        let seen = points.iter().filter(|p| !p.at_edge);
        for (k, point) in seen.enumerate() {
            let exact = (1.0 + PI * k as f64) / step;
            // A parabola through samples −h/2, h/2, 3h/2 off the tip, the worst place, misses the tip by
            // Π|x_i|·|cos'''|/6 = (3h³/8)(h/2)/6 = h⁴/32.
            assert!((point.displacement.abs() - 1.0).abs() < step.powi(4) / 32.0, "{point:?}");
            assert!((point.position - exact).abs() < 0.02, "{point:?} {exact}");
        }
    }
}
