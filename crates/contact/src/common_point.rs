//! Where a slider rests that never slips: the point nearest to its start that all positions of the body can reach.
//!
//! At every instant the slider lies in the disc of radius ρ(τ) around w(τ). A point in all discs stays where it is; if there is
//! none, the slider slips in every period. The nearest such point is fixed by at most as many discs as there are directions,
//! found by exchange: take in the disc that is violated most, keep those that still matter.

use std::array::from_fn;

use crate::slider::dot;

/// A point as a function of the start and of at most two discs, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CommonPoint<const D: usize> {
    pub(crate) point: [f64; D],
    /// Samples of the discs on whose edge it lies.
    pub(crate) edges: [Option<usize>; 2],
    /// ∂point/∂start.
    pub(crate) by_start: [[f64; D]; D],
    /// ∂point/∂(centre of each disc).
    pub(crate) by_centre: [[[f64; D]; D]; 2],
    /// ∂point/∂(radius of each disc).
    pub(crate) by_radius: [[f64; D]; 2],
}

/// A disc: centre and radius.
pub(crate) type Disc<const D: usize> = ([f64; D], f64);

fn minus<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    from_fn(|i| a[i] - b[i])
}

fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

impl<const D: usize> CommonPoint<D> {
    /// The start itself.
    pub(crate) fn free(start: [f64; D]) -> Self {
        Self {
            point: start,
            edges: [None; 2],
            by_start: from_fn(|i| from_fn(|j| f64::from(u8::from(i == j)))),
            by_centre: [[[0.0; D]; D]; 2],
            by_radius: [[0.0; D]; 2],
        }
    }

    /// s = w − ρ e with e = (w − start)/|w − start|.
    fn on_edge(start: [f64; D], sample: usize, (centre, radius): Disc<D>) -> Self {
        let from = minus(centre, start);
        let distance = norm(from);
        let e = from.map(|x| x / distance);
        // ∂s/∂start = (ρ/|w − start|)(I − e eᵀ)
        let turn: [[f64; D]; D] =
            from_fn(|i| from_fn(|j| radius / distance * (f64::from(u8::from(i == j)) - e[i] * e[j])));
        let rest = from_fn(|i| from_fn(|j| f64::from(u8::from(i == j)) - turn[i][j]));
        Self {
            point: from_fn(|i| centre[i] - radius * e[i]),
            edges: [Some(sample), None],
            by_start: if D == 1 { [[0.0; D]; D] } else { turn },
            by_centre: [if D == 1 { [[1.0; D]; D] } else { rest }, [[0.0; D]; D]],
            by_radius: [e.map(|x| -x), [0.0; D]],
        }
    }

    /// One of the two points on both edges; the start does not matter. Two directions only.
    fn on_both(samples: [usize; 2], discs: [Disc<D>; 2], side: f64) -> Option<Self> {
        if D != 2 {
            return None;
        }
        let [(centre, radius), (other, other_radius)] = discs;
        let between = minus(other, centre);
        let distance = norm(between);
        let along = 0.5 * (distance + (radius - other_radius) * (radius + other_radius) / distance);
        let square = (radius - along) * (radius + along);
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        let e = between.map(|x| x / distance);
        let across: [f64; D] = from_fn(|i| if i == 0 { -e[D - 1] } else { e[0] });
        let point: [f64; D] = from_fn(|i| centre[i] + along * e[i] + side * square.sqrt() * across[i]);
        // (s − w_i)·(δs − δw_i) = ρ_i δρ_i for both discs: the rows of the inverse belong to the discs.
        let (p, q) = (minus(point, centre), minus(point, other));
        let determinant = p[0] * q[D - 1] - p[D - 1] * q[0];
        let columns: [[f64; D]; 2] = [
            from_fn(|i| if i == 0 { q[D - 1] } else { -q[0] } / determinant),
            from_fn(|i| if i == 0 { -p[D - 1] } else { p[0] } / determinant),
        ];
        let outer = |column: [f64; D], row: [f64; D]| from_fn(|i| from_fn(|j| column[i] * row[j]));
        Some(Self {
            point,
            edges: samples.map(Some),
            by_start: [[0.0; D]; D],
            by_centre: [outer(columns[0], p), outer(columns[1], q)],
            by_radius: [columns[0].map(|x| x * radius), columns[1].map(|x| x * other_radius)],
        })
    }

    /// The point of all discs nearest to `start`; `None` when they have none in common. What a disc is missed by less than
    /// `tolerance` does not count.
    pub(crate) fn nearest(
        start: [f64; D],
        samples: usize,
        disc: impl Fn(usize) -> Disc<D>,
        tolerance: f64,
    ) -> Option<Self> {
        let missed = |point: [f64; D], j: usize| {
            let (centre, radius) = disc(j);
            norm(minus(centre, point)) - radius
        };
        let mut best = Self::free(start);
        // Each exchange moves the point away from the start, so that no set of discs returns.
        for _ in 0..=samples {
            let (mut worst, mut by) = (0, tolerance);
            for j in 0..samples {
                let distance = missed(best.point, j);
                if distance > by {
                    (worst, by) = (j, distance);
                }
            }
            if by == tolerance {
                return Some(best);
            }
            let inside = |candidate: &Self| {
                best.edges.iter().flatten().all(|&j| missed(candidate.point, j) <= tolerance)
            };
            let single = Self::on_edge(start, worst, disc(worst));
            if inside(&single) {
                best = single;
                continue;
            }
            let pairs = best.edges.iter().flatten().flat_map(|&j| {
                [1.0, -1.0].map(|side| Self::on_both([worst, j], [disc(worst), disc(j)], side))
            });
            let far = |candidate: &Self| norm(minus(candidate.point, start));
            best = pairs.flatten().filter(inside).min_by(|a, b| far(a).total_cmp(&far(b)))?;
        }
        None
    }
}
