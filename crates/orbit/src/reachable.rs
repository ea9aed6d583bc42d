//! Of all places within reach of a moving body at every instant, the one nearest to its mean.
//!
//! `|s − u(τ)| ≤ ρ(τ)`. Along a line that is an interval; in a plane the common part of infinitely many discs, found by exchange: the
//! disc that misses the place by most is taken in until none does.

use crate::polynomial::{Polynomial, derivative, sign_changes, value};
use crate::press::{length, square};

/// Part of the reach by which a place keeps away from its edge, where a slider would begin to slip.
const INSIDE: f64 = 1e-12;
/// Discs that are taken in at most; the distance that is missed falls quadratically with their number.
const MOST_DISCS: usize = 30;
/// Part of the radius that counts as nothing.
const NOTHING: f64 = 1e-14;

/// A stretch of the motion, s ∈ [0, 1].
pub(crate) struct Stretch {
    /// Radians.
    pub(crate) length: f64,
    /// u(s); the second direction may be zero.
    pub(crate) body: [Polynomial; 2],
    /// ρ(s).
    pub(crate) reach: Polynomial,
}

/// Centre and radius.
type Disc = ([f64; 2], f64);

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The place in one or two directions, and the largest displacement of the body. The mean itself where no place is within reach at
/// every instant.
pub(crate) fn nearest(stretches: &[Stretch], directions: usize) -> ([f64; 2], f64) {
    let period: f64 = stretches.iter().map(|stretch| stretch.length).sum();
    let mean = [0, 1].map(|direction| {
        let over = |stretch: &Stretch| {
            let u = stretch.body.get(direction).into_iter().flatten();
            stretch.length * u.zip(1..).map(|(c, j)| c / f64::from(j)).sum::<f64>()
        };
        stretches.iter().map(over).sum::<f64>() / period
    });
    let ends = stretches.iter().map(|stretch| length([0, 1].map(|d| value(&stretch.body[d], 0.0))));
    let size = ends.fold(0.0, f64::max);
    let place = if directions == 1 { [on_line(stretches, mean[0]), 0.0] } else { in_plane(stretches, mean) };
    (place, size)
}

/// The place between the highest lower and the lowest upper edge of the reach.
fn on_line(stretches: &[Stretch], mean: f64) -> f64 {
    let mut roots = Vec::new();
    let mut edge = |sign: f64| {
        let mut most = f64::NEG_INFINITY;
        for Stretch { body: [u, _], reach, .. } in stretches {
            let mut edge = *u;
            for (edge, reach) in edge.iter_mut().zip(reach) {
                *edge = sign * *edge - (1.0 - INSIDE) * reach;
            }
            roots.clear();
            sign_changes(&derivative(&edge), &mut roots);
            let at = roots.iter().copied().chain([0.0, 1.0]).map(|s| value(&edge, s));
            most = at.fold(most, f64::max);
        }
        sign * most
    };
    let (low, high) = (edge(1.0), edge(-1.0));
    if low <= high { mean.clamp(low, high) } else { mean }
}

fn in_plane(stretches: &[Stretch], mean: [f64; 2]) -> [f64; 2] {
    let mut discs: Vec<Disc> = Vec::new();
    let mut place = mean;
    for _ in 0..MOST_DISCS {
        let Some(disc) = missing_most(stretches, place) else { return place };
        discs.push(disc);
        match nearest_of(&discs, mean) {
            Some(found) => place = found,
            None => return mean,
        }
    }
    place
}

/// The disc that misses `place` by most; `None` where all contain it.
fn missing_most(stretches: &[Stretch], place: [f64; 2]) -> Option<Disc> {
    let mut roots = Vec::new();
    let mut worst: Option<(f64, Disc)> = None;
    for Stretch { body, reach, .. } in stretches {
        let reach = reach.map(|c| (1.0 - INSIDE) * c);
        let mut outside = square(&reach).map(|c| -c);
        for (u, place) in body.iter().zip(place) {
            let mut from = *u;
            if let Some(constant) = from.first_mut() {
                *constant -= place;
            }
            outside.iter_mut().zip(square(&from)).for_each(|(outside, square)| *outside += square);
        }
        roots.clear();
        sign_changes(&derivative(&outside), &mut roots);
        for s in roots.iter().copied().chain([0.0, 1.0]) {
            let disc = ([value(&body[0], s), value(&body[1], s)], value(&reach, s));
            let missed = length(minus(place, disc.0)) - disc.1;
            if missed > NOTHING * disc.1 && worst.is_none_or(|(most, _)| missed > most) {
                worst = Some((missed, disc));
            }
        }
    }
    worst.map(|(_, disc)| disc)
}

/// The point of all discs nearest to `mean`, which is in none of them or on the edge of one or two.
fn nearest_of(discs: &[Disc], mean: [f64; 2]) -> Option<[f64; 2]> {
    let inside = |point: &[f64; 2]| {
        discs.iter().all(|(centre, radius)| length(minus(*point, *centre)) <= radius * (1.0 + 10.0 * NOTHING))
    };
    let single = |&(centre, radius): &Disc| {
        let from = minus(mean, centre);
        let factor = radius / length(from);
        [centre[0] + factor * from[0], centre[1] + factor * from[1]]
    };
    let singles = discs.iter().map(single);
    let pairs = discs.iter().enumerate().flat_map(|(i, a)| discs.iter().skip(i + 1).map(move |b| (a, b)));
    let pairs = pairs.flat_map(|(a, b)| [1.0, -1.0].into_iter().filter_map(|side| on_both(*a, *b, side)));
    let far = |point: &[f64; 2]| length(minus(*point, mean));
    singles.chain(pairs).filter(inside).min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// One of the two points on both edges.
fn on_both((centre, radius): Disc, (other, other_radius): Disc, side: f64) -> Option<[f64; 2]> {
    let between = minus(other, centre);
    let distance = length(between);
    let along = 0.5 * (distance + (radius - other_radius) * (radius + other_radius) / distance);
    let across = side * ((radius - along) * (radius + along)).sqrt();
    let e = between.map(|x| x / distance);
    let point = [centre[0] + along * e[0] - across * e[1], centre[1] + along * e[1] + across * e[0]];
    point.iter().all(|x| x.is_finite()).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial::TERMS;

    /// A body that goes along a parabola, u = (s, 4a s (1 − s)), with a constant reach.
    fn parabola(height: f64, reach: f64) -> Stretch {
        let mut stretch = Stretch { length: 1.0, body: [[0.0; TERMS]; 2], reach: [0.0; TERMS] };
        stretch.body[0][1] = 1.0;
        stretch.body[1][1] = 4.0 * height;
        stretch.body[1][2] = -4.0 * height;
        stretch.reach[0] = reach;
        stretch
    }

    #[test]
    fn the_mean_is_taken_where_it_is_within_reach() {
        for directions in [1, 2] {
            let (place, size) = nearest(&[parabola(0.3, 0.8)], directions);
            let expected = [0.5, if directions == 2 { 0.2 } else { 0.0 }];
            assert!(length(minus(place, expected)) < 1e-15, "{place:?}");
            assert!(size == 0.0);
        }
    }

    /// Both ends are farther than the reach from the mean (½, ⅔a): the place is on both edges, at the height √(ρ² − ¼).
    #[test]
    fn the_nearest_place_is_on_two_edges() {
        let (place, _) = nearest(&[parabola(0.3, 0.51)], 2);
        let expected = [0.5, (0.51_f64 * 0.51 - 0.25).sqrt()];
        assert!(length(minus(place, expected)) < 1e-11, "{place:?}");
        // No place is within reach of both ends.
        assert_eq!(nearest(&[parabola(0.3, 0.49)], 1).0[0], 0.5);
    }

    /// The reach shrinks towards the end of a straight way, u = (s, 0), ρ = 0.9 − 0.5 s: the end holds the place at 0.6.
    #[test]
    fn a_lone_edge_holds_the_place() {
        let mut stretch = parabola(0.0, 0.9);
        stretch.reach[1] = -0.5;
        for directions in [1, 2] {
            let (place, _) =
                nearest(&[Stretch { body: stretch.body, reach: stretch.reach, length: 2.0 }], directions);
            assert!(length(minus(place, [0.6, 0.0])) < 1e-11, "{place:?}");
        }
    }
}
