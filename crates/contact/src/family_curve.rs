//! How the Fourier coefficients of a family of loops run over the displacement amplitude.
//!
//! Three parts, joined with continuous first derivative; c_i and m_i are the coefficients and their slopes dc/d ln a at
//! the i-th measured amplitude a_i:
//!
//! ```text
//! a ≤ a_0          c = s (2 − s) c_0 − s (1 − s) m_0,  s = a/a_0        κ a + O(a²): sticking, then the first slip
//! a_i ≤ a ≤ a_i+1  cubic Hermite polynomial in ln a
//! a ≥ a_n          c = c_n + (1 − a_n/a) m_n                            A + B/a: gross slip
//! ```
//!
//! The slopes are those of parabolas through three neighbours: third order in the step of ln a. They are not held to keep
//! every component monotone (as Fritsch and Carlson do): a harmonic may well have an extreme value between two loops, as
//! Re c_1 of the paper's law has, and there a monotone curve loses an order. What must not happen between two loops is
//! another thing:
//!
//! # Why no loop in between creates energy
//!
//! Every part is a Bézier curve (a straight line in 1/a at the end) in the space of loops, and so a convex combination of
//! its control loops: `c_0 − ½ m_0` at rest, `c_i ± (h/3) m_i` beside each measurement with h the step in ln a, `c_n +
//! m_n` at the end. The half-width of a loop is linear in its coefficients; where it is not negative for the control
//! loops it is not negative for any loop. Where a slope would make a control loop's half-width negative, all of that
//! slope is reduced until it does not: at slope zero the control loops are the measured ones. The same holds for Im c_1, the
//! dissipation, and for the stiffness at rest.

use std::f64::consts::PI;

use num_complex::Complex64;

/// Phases on a half loop at which the half-width is looked at, a harmonic.
const PHASES_PER_HARMONIC: usize = 8;

/// Half-width below zero that is put up with, relative to the loop's largest: what cutting off a series leaves near the
/// tips, where the half-width itself goes to zero.
const RIPPLE: f64 = 1e-3;

/// One measured amplitude.
#[derive(Debug, Clone, PartialEq)]
struct Node {
    /// In m.
    amplitude: f64,
    /// c_k in N, index k; c_0 is zero.
    coefficients: Vec<Complex64>,
    /// dc_k/d ln a in N.
    slopes: Vec<Complex64>,
}

/// c_k(a) through the measured ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FamilyCurve {
    /// Ascending in amplitude; at least two.
    nodes: Vec<Node>,
    harmonics: usize,
}

/// The two nodes beside an amplitude, and the weights of `[c_i, m_i, c_{i+1}, m_{i+1}]` there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blend {
    lower: usize,
    /// Weights of c_k(a).
    weights: [f64; 4],
    /// Weights of dc_k/da, in 1/m.
    rates: [f64; 4],
}

impl FamilyCurve {
    /// The curve through loops of the given amplitudes (ascending) and coefficients (c_0 and c_1 present, all of one
    /// length).
    pub(crate) fn through(loops: Vec<(f64, Vec<Complex64>)>) -> Self {
        let harmonics = loops.iter().map(|(_, c)| c.len()).max().unwrap_or(0);
        let mut nodes: Vec<Node> = loops
            .into_iter()
            .map(|(amplitude, coefficients)| Node {
                amplitude,
                slopes: vec![Complex64::ZERO; harmonics],
                coefficients,
            })
            .collect();
        for k in 0..harmonics {
            slope_component(&mut nodes, k, |c| c.re, |c| &mut c.re);
            slope_component(&mut nodes, k, |c| c.im, |c| &mut c.im);
        }
        let mut curve = Self { nodes, harmonics };
        curve.keep_passive();
        curve
    }

    /// The amplitudes in m of the first and the last measured loop.
    pub(crate) fn range(&self) -> (f64, f64) {
        let amplitude = |node: Option<&Node>| node.map_or(0.0, |node| node.amplitude);
        (amplitude(self.nodes.first()), amplitude(self.nodes.last()))
    }

    /// Number of coefficients, c_0 included.
    pub(crate) fn len(&self) -> usize {
        self.harmonics
    }

    /// Where `a` > 0 (m) lies between the measured amplitudes.
    pub(crate) fn blend(&self, a: f64) -> Blend {
        let (first, last) = self.range();
        if a <= first {
            let s = a / first;
            return Blend {
                lower: 0,
                weights: [s * (2.0 - s), s * (s - 1.0), 0.0, 0.0],
                rates: [(2.0 - 2.0 * s) / first, (2.0 * s - 1.0) / first, 0.0, 0.0],
            };
        }
        if a >= last {
            return Blend {
                lower: self.nodes.len().saturating_sub(2),
                weights: [0.0, 0.0, 1.0, 1.0 - last / a],
                rates: [0.0, 0.0, 0.0, last / (a * a)],
            };
        }
        let upper = self.nodes.partition_point(|node| node.amplitude <= a).max(1);
        let at = |i: usize| self.nodes.get(i).map_or(first, |node| node.amplitude);
        let (left, right) = (at(upper - 1), at(upper));
        let h = (right / left).ln();
        let t = (a / left).ln() / h;
        let (u, per) = (1.0 - t, 1.0 / (h * a));
        Blend {
            lower: upper - 1,
            weights: [u * u * (1.0 + 2.0 * t), h * t * u * u, t * t * (3.0 - 2.0 * t), -h * t * t * u],
            rates: [
                -6.0 * t * u * per,
                h * u * (1.0 - 3.0 * t) * per,
                6.0 * t * u * per,
                h * t * (3.0 * t - 2.0) * per,
            ],
        }
    }

    fn combine(&self, lower: usize, weights: [f64; 4]) -> impl Iterator<Item = Complex64> + Clone {
        let rows = |i: usize| {
            let node = self.nodes.get(i);
            (node.map_or(&[][..], |node| &node.coefficients), node.map_or(&[][..], |node| &node.slopes))
        };
        let ((c, m), (d, n)) = (rows(lower), rows(lower + 1));
        let [wc, wm, wd, wn] = weights;
        c.iter().zip(m).zip(d.iter().zip(n)).map(move |((c, m), (d, n))| c * wc + m * wm + d * wd + n * wn)
    }

    /// c_k in N, k = 0, 1, …
    pub(crate) fn coefficients(&self, blend: Blend) -> impl Iterator<Item = Complex64> + Clone {
        self.combine(blend.lower, blend.weights)
    }

    /// dc_k/da in N/m.
    pub(crate) fn derivatives(&self, blend: Blend) -> impl Iterator<Item = Complex64> + Clone {
        self.combine(blend.lower, blend.rates)
    }

    /// `lim_{a→0} c_1/a` in N/m.
    pub(crate) fn stick_stiffness(&self) -> Complex64 {
        self.nodes.first().map_or(Complex64::ZERO, |node| {
            let part = |row: &[Complex64]| row.get(1).copied().unwrap_or_default();
            (part(&node.coefficients) * 2.0 - part(&node.slopes)) / node.amplitude
        })
    }

    /// Reduces slopes until no control loop has a negative half-width (see the top of this file), and the stiffness at
    /// rest and its loss are not negative.
    fn keep_passive(&mut self) {
        let steps: Vec<f64> = self
            .nodes
            .windows(2)
            .map(|pair| match pair {
                [left, right] => (right.amplitude / left.amplitude).ln(),
                _ => 0.0,
            })
            .collect();
        let phases = PHASES_PER_HARMONIC * self.harmonics;
        for (i, node) in self.nodes.iter_mut().enumerate() {
            let before = i.checked_sub(1).and_then(|i| steps.get(i));
            let after = steps.get(i);
            // Control loops are c + β m.
            let back = before.map_or(-0.5, |h| -h / 3.0);
            let ahead = after.map_or(1.0, |h| h / 3.0);
            let widths: Vec<(f64, f64)> = (1..phases)
                .map(|j| PI * j as f64 / phases as f64)
                .map(|theta| (half_width(&node.coefficients, theta), half_width(&node.slopes, theta)))
                .collect();
            let largest = widths.iter().fold(0.0_f64, |top, (width, _)| top.max(*width));
            let first = |row: &[Complex64]| row.get(1).copied().unwrap_or_default();
            let (c, m) = (first(&node.coefficients), first(&node.slopes));
            let mut keep = 1.0_f64;
            for beta in [back, ahead] {
                for &(width, slope) in &widths {
                    if width >= 0.0 {
                        keep = keep.min(largest_factor(width + RIPPLE * largest, beta * slope));
                    }
                }
                keep = keep.min(largest_factor(c.im, beta * m.im));
                if before.is_none() {
                    keep = keep.min(largest_factor(c.re, beta * m.re));
                }
            }
            node.slopes.iter_mut().for_each(|m| *m *= keep);
        }
    }
}

/// Largest λ ≤ 1 with value + λ change ≥ 0, for value ≥ 0; 1 where the value is negative itself.
fn largest_factor(value: f64, change: f64) -> f64 {
    if value < 0.0 || value + change >= 0.0 { 1.0 } else { -value / change }
}

/// Half the difference of the loading and the unloading branch in N, Σ Im c_k sin kθ, at loop phase θ in (0, π).
fn half_width(coefficients: &[Complex64], theta: f64) -> f64 {
    let turn = Complex64::cis(theta);
    let mut wave = Complex64::ONE;
    let mut sum = 0.0;
    for c in coefficients {
        sum += c.im * wave.im;
        wave *= turn;
    }
    sum
}

/// Slopes over ln a of one component of c_k at all nodes.
fn slope_component(
    nodes: &mut [Node],
    k: usize,
    read: impl Fn(&Complex64) -> f64,
    write: impl Fn(&mut Complex64) -> &mut f64,
) {
    let value = |node: &Node| node.coefficients.get(k).map_or(0.0, &read);
    let points: Vec<(f64, f64)> = nodes.iter().map(|node| (node.amplitude.ln(), value(node))).collect();
    // (step, secant) of every interval.
    let intervals: Vec<(f64, f64)> = points
        .windows(2)
        .filter_map(|pair| match pair {
            [(x, y), (u, v)] => Some((u - x, (v - y) / (u - x))),
            _ => None,
        })
        .collect();
    for (i, node) in nodes.iter_mut().enumerate() {
        let at = |i: usize| intervals.get(i).copied();
        let slope = match (i.checked_sub(1).and_then(at), at(i)) {
            (Some((h, left)), Some((g, right))) => (g * left + h * right) / (h + g),
            (None, Some((h, here))) => end_slope(h, here, at(1)),
            (Some((h, here)), None) => end_slope(h, here, i.checked_sub(2).and_then(at)),
            (None, None) => 0.0,
        };
        if let Some(slot) = node.slopes.get_mut(k) {
            *write(slot) = slope;
        }
    }
}

/// Slope at an end: of the parabola through the last three points, or of the line through two.
fn end_slope(h: f64, here: f64, next: Option<(f64, f64)>) -> f64 {
    next.map_or(here, |(g, beyond)| here + (here - beyond) * h / (h + g))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn loop_of(first: Complex64, third: Complex64) -> Vec<Complex64> {
        vec![Complex64::ZERO, first, Complex64::ZERO, third]
    }

    fn at(curve: &FamilyCurve, a: f64) -> Vec<Complex64> {
        curve.coefficients(curve.blend(a)).collect()
    }

    #[test]
    fn a_slope_that_would_turn_a_loop_inside_out_is_reduced() {
        // Half-width at θ = π/2 is Im c_1 − Im c_3: 0.02, 0.9, 0.02 at three amplitudes whose own components all are
        // monotone, so that unlimited slopes would dip below zero beside them.
        let loops = [
            (1.0, loop_of(c(1.0, 1.0), c(0.0, 0.98))),
            (1.1, loop_of(c(1.0, 3.0), c(0.0, 1.0))),
            (4.0, loop_of(c(1.0, 3.2), c(0.0, 3.1))),
            (5.0, loop_of(c(1.0, 6.0), c(0.0, 3.2))),
        ];
        let width = |curve: &FamilyCurve, a: f64| {
            (1..100)
                .map(|j| half_width(&at(curve, a), PI * f64::from(j) / 100.0))
                .fold(f64::INFINITY, f64::min)
        };
        let lowest = |curve: &FamilyCurve| {
            (0..400).map(|j| width(curve, 0.5 * 1.01_f64.powi(j))).fold(f64::INFINITY, f64::min)
        };
        let limited = FamilyCurve::through(loops.to_vec());
        let mut free = limited.clone();
        for k in 0..free.harmonics {
            slope_component(&mut free.nodes, k, |c| c.re, |c| &mut c.re);
            slope_component(&mut free.nodes, k, |c| c.im, |c| &mut c.im);
        }
        assert!(lowest(&free) < -0.02, "the example needs no limit: {}", lowest(&free));
        assert!(lowest(&limited) > -2.0 * RIPPLE * 6.0, "{}", lowest(&limited));
    }

    #[test]
    fn parabolas_are_exact() {
        // Re c_1 = 5 + x + 0.1 x², x = ln a.
        let parabola = |x: f64| 5.0 + x + 0.1 * x * x;
        let loops = [0.0, 0.5, 1.2, 1.5_f64].map(|x| (x.exp(), loop_of(c(parabola(x), 1.0), c(0.0, 0.0))));
        let curve = FamilyCurve::through(loops.to_vec());
        for j in 0..=30 {
            let x = 0.05 * f64::from(j);
            let got = at(&curve, x.exp());
            assert!((got[1].re - parabola(x)).abs() < 1e-13, "{x}: {} {}", got[1].re, parabola(x));
        }
    }
}
