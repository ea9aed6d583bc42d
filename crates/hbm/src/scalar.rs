//! One harmonic, one contact: a real equation whose roots are all found, without a starting guess.
//!
//! With the complex secant stiffness `k(a) = F_1(a)/a`, which depends on a = |u_1| alone,
//! `u_1 = u⁰ / (1 + G k(a))`, so
//!
//! ```text
//! φ(a) = |a + G F_1(a)| − |u⁰| = 0
//! ```
//!
//! Springs S lent to a singular structure make it `|(1 − G S) a + G F_1(a)|`.

use contact::DescribingFunction;
use num_complex::Complex64;

use crate::dense::Entry;
use crate::holding::HOLDING_SLACK;

/// The balance of the first harmonic at one contact.
pub(crate) struct ScalarBalance<'l> {
    pub(crate) law: &'l dyn DescribingFunction,
    /// Factor on the law's force.
    pub(crate) scale: f64,
    /// G in m/N.
    pub(crate) receptance: Complex64,
    /// 1 − G S: one, but where springs S were lent to a singular structure.
    pub(crate) own: Complex64,
    /// |u⁰| in m, not zero.
    pub(crate) free: f64,
    /// Amplitude in m at which the law has its character.
    pub(crate) length: f64,
}

/// A solution of the balance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Root {
    /// Amplitude in m.
    pub(crate) a: f64,
    /// a + G F_1(a) in m: the free response is this long and has this phase against the displacement.
    z: Complex64,
    /// F_1(a) in N of a motion a cos τ, with the factor of the contact.
    pub(crate) force: Complex64,
    /// |φ| relative to |u⁰|.
    pub(crate) residual: f64,
}

impl Root {
    /// Harmonic of the relative displacement in m that belongs to the free response `free`.
    pub(crate) fn displacement(&self, free: Complex64) -> Complex64 {
        // Of magnitude a, whatever rounding makes of |z| = |u⁰| where its terms nearly cancel.
        let direction = free / self.z;
        direction * (self.a / direction.magnitude())
    }

    /// Whether the law creates energy at this amplitude: no root there is a motion of a friction contact.
    pub(crate) fn creates_energy(&self) -> bool {
        self.force.im < 0.0
    }
}

/// A node of the search: amplitude, F_1, z = a + G F_1(a) and dz/da, φ = |z| − |u⁰| and φ'.
#[derive(Clone, Copy)]
struct Node {
    a: f64,
    force: Complex64,
    z: Complex64,
    dz: Complex64,
    value: f64,
    slope: f64,
}

/// Neighbouring nodes of the grid differ by this factor at most.
const RATIO: f64 = 2.0;

/// A cell in which φ turns more than once is halved at most this often.
const HALVINGS: usize = 12;

/// No grid spans more nodes than this (2^240 covers all of f64's useful range).
const MOST_NODES: usize = 240;

/// Bounds of roots are moved outwards by this part: far more than rounding.
const OUTWARDS: f64 = 1e-12;

impl ScalarBalance<'_> {
    fn node(&self, a: f64) -> Node {
        let first = self.law.first_harmonic(a);
        let force = first.force * self.scale;
        let z = self.own * a + self.receptance * force;
        let dz = self.own + self.receptance * (first.derivative * self.scale);
        let norm = z.magnitude();
        let slope = if norm > 0.0 { (z.re * dz.re + z.im * dz.im) / norm } else { 0.0 };
        Node { a, force, z, dz, value: norm - self.free, slope }
    }

    fn root(&self, node: Node) -> Root {
        Root { a: node.a, z: node.z, force: node.force, residual: node.value.abs() / self.free }
    }

    /// |G F_1(a)| in m.
    fn pull(&self, a: f64) -> f64 {
        (self.receptance * (self.law.first_harmonic(a).force * self.scale)).magnitude()
    }

    /// What |G F_1| does not exceed up to amplitude `a` where the law knows it, in m.
    fn largest_pull(&self, a: f64) -> Option<f64> {
        let largest = self.receptance.magnitude() * self.scale * self.law.largest(a)?;
        largest.is_finite().then_some(largest)
    }

    /// Whether the contact can hold the excitation at rest, up to the rounding of both.
    pub(crate) fn can_hold(&self) -> bool {
        let limit = self.receptance * self.law.at_rest() * self.scale;
        limit != Complex64::ZERO && self.free <= limit.magnitude() * (1.0 + HOLDING_SLACK)
    }

    /// No root lies above: there the displacement outweighs a pull that falls behind it, a pull that runs ahead
    /// outweighs the displacement, or the law has become a spring and the balance is linear.
    fn upper_end(&self) -> f64 {
        let own = self.own.magnitude();
        if let Some(largest) = self.largest_pull(f64::INFINITY).filter(|_| own > 0.0) {
            return (self.free + largest) / own * (1.0 + OUTWARDS);
        }
        let pull = |a: f64| self.largest_pull(a).unwrap_or_else(|| self.pull(a));
        let mut a = self.free.max(self.length);
        let mut here = pull(a);
        for _ in 0..MOST_NODES {
            let beyond = pull(2.0 * a);
            // Up to rounding, which a spring shows at large amplitudes.
            let softening = beyond <= 2.0 * here * (1.0 + 1e-12);
            if softening && a * own > self.free + here {
                return self.drawn_in(a, own);
            }
            let ahead = || self.pull(a) > a * own + self.free;
            if if softening { self.linear_above(a) } else { ahead() } {
                break;
            }
            a *= RATIO;
            here = beyond;
        }
        a
    }

    /// An upper bound of the roots below `a`, by what the law can pull at most: `a ≤ (|u⁰| + |G F_1|)/|1 − G S|`.
    fn drawn_in(&self, a: f64, own: f64) -> f64 {
        let mut upper = a;
        for _ in 0..3 {
            let Some(largest) = self.largest_pull(upper) else { break };
            upper = upper.min((self.free + largest) / own * (1.0 + OUTWARDS));
        }
        upper
    }

    /// Of a softening law: beyond `a` the force is a spring's plus a rest that hardly grows, and the balance too large for a root:
    /// with `F = k a + R`, `|1 + G k| a > |u⁰| + |G R|`.
    fn linear_above(&self, a: f64) -> bool {
        let force = |a: f64| self.receptance * self.law.first_harmonic(a).force * self.scale;
        let (one, two, four) = (force(a), force(2.0 * a), force(4.0 * a));
        let (before, slope) = ((two - one) / a, (four - two) / (2.0 * a));
        let rest = four - slope * (4.0 * a);
        let stiffness = (self.own + slope).magnitude();
        (slope - before).magnitude() < 1e-3 * stiffness && a * stiffness > self.free + 2.0 * rest.magnitude()
    }

    /// No root lies below, or so close to rest that the law is linear there up to rest itself.
    fn lower_end(&self, upper: f64) -> f64 {
        let own = self.own.magnitude();
        let least = self.largest_pull(upper).map_or(0.0, |largest| (self.free - largest) / own);
        if least > 0.0 && least < upper {
            return least * (1.0 - OUTWARDS);
        }
        let floor = if self.law.at_rest() == Complex64::ZERO {
            0.0
        } else {
            1e-3 * self.law.landmark().unwrap_or(self.length)
        };
        let mut a = 0.5 * upper.min(self.free.max(self.length));
        for _ in 0..MOST_NODES {
            let pull = self.largest_pull(a).unwrap_or_else(|| self.pull(a));
            if a <= floor || a * own + pull < self.free {
                break;
            }
            a /= RATIO;
        }
        a
    }

    /// All solutions with a > 0, ascending, appended to `roots`.
    pub(crate) fn roots(&self, roots: &mut Vec<Root>) {
        let upper = self.upper_end();
        let mut lower = self.lower_end(upper);
        let landmark = self.law.landmark().filter(|l| *l > lower && *l < upper);
        let mut left;
        if let Some(end) = self.law.spring_up_to().filter(|end| *end > lower) {
            left = self.node(end);
            if left.value > 0.0 {
                // Proportional to the amplitude: the root is known.
                let part = self.free / (left.value + self.free);
                let (z, force) = (left.z * part, left.force * part);
                roots.push(Root { a: end * part, z, force, residual: 0.0 });
            }
            if end >= upper {
                return;
            }
            lower = end;
            left = self.beyond_landmark(left, roots);
        } else {
            left = self.node(if self.law.at_rest() == Complex64::ZERO { lower } else { 0.0 });
        }
        let mut a = if left.a == 0.0 { lower } else { lower * RATIO };
        loop {
            let last = a >= upper;
            let mut right = a.min(upper);
            if let Some(l) = landmark.filter(|l| left.a < *l && *l < right) {
                right = l;
            } else {
                a = right * RATIO;
            }
            let node = self.node(right);
            self.cell(left, node, HALVINGS, roots);
            left = if Some(right) == landmark { self.beyond_landmark(node, roots) } else { node };
            if last && right >= upper {
                if node.value == 0.0 && left.a == node.a {
                    roots.push(self.root(node));
                }
                break;
            }
        }
    }

    /// The slope may jump at a landmark: the node just beyond it. A root may lie in between.
    fn beyond_landmark(&self, node: Node, roots: &mut Vec<Root>) -> Node {
        let after = |steps: u32| self.node(node.a * (1.0 + f64::from(steps) * f64::EPSILON));
        let beyond = after(4);
        if node.value * beyond.value <= 0.0 && beyond.value != 0.0 {
            // Of the few numbers between them the one that balances best.
            let between = [node, after(1), after(2), after(3), beyond];
            let best = between.into_iter().min_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
            roots.push(self.root(best.unwrap_or(node)));
        }
        beyond
    }

    /// Roots between two nodes. Where the slope changes sign the cell is split at the extreme value, so that a pair
    /// of roots that nearly touch is not lost.
    fn cell(&self, left: Node, right: Node, halvings: usize, roots: &mut Vec<Root>) {
        if halvings > 0 && turns(left, right) > 1 {
            let middle = self.node(0.5 * (left.a + right.a));
            self.cell(left, middle, halvings - 1, roots);
            self.cell(middle, right, halvings - 1, roots);
            return;
        }
        if left.slope * right.slope >= 0.0 {
            self.monotone(left, right, roots);
            return;
        }
        let (mut low, mut high) = (left, right);
        for _ in 0..60 {
            let secant = low.a + (high.a - low.a) * low.slope / (low.slope - high.slope);
            let margin = 0.05 * (high.a - low.a);
            let middle = self.node(secant.clamp(low.a + margin, high.a - margin));
            if middle.slope * low.slope > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
            // Enough once φ has changed sign between an end and the extreme, or the extreme is found.
            let crossed = middle.value * left.value < 0.0 && middle.value * right.value < 0.0;
            if crossed || high.a - low.a <= 1e-13 * high.a {
                break;
            }
        }
        let lowest = (low.value < high.value) == (left.value > 0.0);
        let extreme = if lowest { low } else { high };
        if left.value * extreme.value > 0.0
            && right.value * extreme.value > 0.0
            && extreme.value.abs() <= 1e-14 * self.free
        {
            roots.push(self.root(extreme));
            return;
        }
        self.monotone(left, extreme, roots);
        self.monotone(extreme, right, roots);
    }

    /// The root between two nodes of different sign, by Newton's method kept inside the bracket.
    fn monotone(&self, left: Node, right: Node, roots: &mut Vec<Root>) {
        if left.value == 0.0 && left.a > 0.0 {
            roots.push(self.root(left));
            return;
        }
        if left.value * right.value >= 0.0 {
            return;
        }
        let (mut low, mut high) = (left, right);
        let mut here = if left.value.abs() < right.value.abs() { left } else { right };
        let mut before = 0.0;
        for _ in 0..100 {
            let newton = here.a - here.value / here.slope;
            let inside = newton > low.a && newton < high.a;
            let next = if inside { newton } else { 0.5 * (low.a + high.a) };
            let step = (next - here.a).abs();
            here = self.node(next);
            // Of steps that shrink quadratically the next one, c³/s² or less, is known to be lost in rounding. Beside a
            // kink they do not, and the residual says so.
            let settled = inside
                && step * step * step <= 0.5 * f64::EPSILON * next * before * before
                && here.value.abs() <= SETTLED * self.free;
            before = step;
            if here.value * low.value > 0.0 {
                low = here;
            } else {
                high = here;
            }
            if here.value == 0.0
                || settled
                || step <= 2.0 * f64::EPSILON * next
                || high.a - low.a <= 2.0 * f64::EPSILON * high.a
            {
                break;
            }
        }
        roots.push(self.root(here));
    }
}

/// Relative residual of a root that needs no further step.
const SETTLED: f64 = 1e-14;

/// How often φ turns between two nodes, as far as the cubic through z and dz/da at both shows: z is smooth where
/// |z| has a kink.
fn turns(left: Node, right: Node) -> usize {
    let h = right.a - left.a;
    let size = |t: f64| {
        let (u, rest) = (1.0 - t, t * (1.0 - t));
        let ends = left.z * (u * u * (1.0 + 2.0 * t)) + right.z * (t * t * (3.0 - 2.0 * t));
        (ends + (left.dz * u - right.dz * t) * (rest * h)).norm_sqr()
    };
    let sizes = [left.z.norm_sqr(), size(0.25), size(0.5), size(0.75), right.z.norm_sqr()];
    let [a, b, c, d, e] = sizes;
    let rises = [left.slope, b - a, c - b, d - c, e - d, right.slope];
    rises.windows(2).filter(|pair| pair.iter().product::<f64>() < 0.0).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::{
        Cubic, CubicParameters, ElasticCoulomb, ElasticCoulombParameters, Iwan, IwanParameters, Law,
        MagnitudeLaw, PhaseLaw, ScaledLoop,
    };
    use std::f64::consts::PI;

    fn roots(law: &dyn Law, receptance: Complex64, free: f64) -> Vec<f64> {
        let mut roots = Vec::new();
        let balance = ScalarBalance {
            law: law.describing_function().unwrap(),
            scale: 1.0,
            receptance,
            own: Complex64::ONE,
            free,
            length: law.length().unwrap_or(free),
        };
        balance.roots(&mut roots);
        roots.iter().map(|root| root.a).collect()
    }

    #[test]
    fn the_three_solutions_of_an_undamped_duffing_oscillator() {
        // a + G ¾ k₃ a³ = ± u⁰ with G = −1, ¾ k₃ = 1, u⁰ = 0.2: a − a³ = ±0.2.
        let law = Cubic::new(CubicParameters { stiffness: 4.0 / 3.0 }).unwrap();
        let found = roots(&law, Complex64::new(-1.0, 0.0), 0.2);
        // Roots of a³ − a ± 0.2 = 0 by Viète: a = 2/√3 cos(…).
        let r = 2.0 / 3.0_f64.sqrt();
        let angle = (0.2 * 1.5 * 3.0_f64.sqrt()).acos() / 3.0;
        let mut expected = vec![
            r * angle.cos(),
            r * (angle - 2.0 * PI / 3.0).cos().abs(),
            r * (angle + 2.0 * PI / 3.0).cos().abs(),
        ];
        expected.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 3, "{found:?}");
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-14, "{found:?} {expected:?}");
        }
    }

    /// a − a³ has a hump of height 0.3849 between its zeros: below that height there are three roots, above one, wherever
    /// the hump falls between the nodes of the grid.
    #[test]
    fn pairs_are_found_wherever_the_grid_falls() {
        let law = Cubic::new(CubicParameters { stiffness: 4.0 / 3.0 }).unwrap();
        for i in 1..400 {
            let free = 1e-3 * f64::from(i);
            let found = roots(&law, Complex64::new(-1.0, 0.0), free);
            assert_eq!(
                found.len(),
                if free < 2.0 / (3.0 * 3.0_f64.sqrt()) { 3 } else { 1 },
                "{free}: {found:?}"
            );
            for a in found {
                assert!(((a - a.powi(3)).abs() - free).abs() < 1e-14, "{free}: {a}");
            }
        }
    }

    #[test]
    fn a_nearly_touching_pair_is_found() {
        // a − a³ has its maximum 2/(3√3) at a = 1/√3; just below it two roots lie 1e-6 apart.
        let law = Cubic::new(CubicParameters { stiffness: 4.0 / 3.0 }).unwrap();
        let top = 2.0 / (3.0 * 3.0_f64.sqrt());
        let found = roots(&law, Complex64::new(-1.0, 0.0), top * (1.0 - 1e-12));
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((found[0] - 1.0 / 3.0_f64.sqrt()).abs() < 1e-6 && (found[1] - found[0]) < 2e-6);
        assert_eq!(roots(&law, Complex64::new(-1.0, 0.0), top * (1.0 + 1e-9)).len(), 1);
    }

    #[test]
    fn a_sticking_element_is_a_spring() {
        let law = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 3.0, slip_force: 1.0 }).unwrap();
        let g = Complex64::new(0.5, -0.2);
        let found = roots(&law, g, 0.1);
        assert_eq!(found.len(), 1);
        assert!((found[0] - 0.1 / (1.0 + 3.0 * g).norm()).abs() < 1e-16);
    }

    #[test]
    fn slip_limit() {
        // Large excitation: the force tends to the damping force 4 F_s / π in quadrature.
        let law = ElasticCoulomb::new(ElasticCoulombParameters { stiffness: 3.0, slip_force: 1.0 }).unwrap();
        let g = Complex64::new(0.0, -1.0);
        let found = roots(&law, g, 1e9);
        assert_eq!(found.len(), 1);
        assert!((found[0] - (1e9 - 4.0 / PI)).abs() < 1e-3);
    }

    /// A stack of sliders that ends in a spring, at the resonance of the mass on that spring: the pull never falls behind
    /// the displacement, and the root lies below the law's length.
    #[test]
    fn a_spring_that_stays() {
        let parameters =
            IwanParameters { displacement: 1.0, force: 1.0, magnitude: MagnitudeLaw::default(), range: 10.0 };
        let law = Iwan::from_magnitude(parameters).unwrap();
        for receptance in [Complex64::new(-8.0, -30.0), Complex64::new(60.0, -1.0), Complex64::new(-1e3, 0.0)]
        {
            for free in [1e-3, 0.3, 30.0] {
                let found = roots(&law, receptance, free);
                assert_eq!(found.len() % 2, 1, "{receptance} {free}: {found:?}");
                for a in found {
                    let z = a + receptance * law.describing_function().unwrap().first_harmonic(a).force;
                    assert!(
                        (z.norm() - free).abs() < 1e-12 * (free + a * receptance.norm()),
                        "{receptance} {free} {a}"
                    );
                }
            }
        }
    }

    #[test]
    fn held_or_sliding() {
        let law = ScaledLoop::ellipse(1.0, 1.0, MagnitudeLaw::default(), PhaseLaw::default()).unwrap();
        let g = Complex64::new(1.0, 0.0);
        assert!(roots(&law, g, 0.0129).is_empty());
        let found = roots(&law, g, 0.01292);
        assert_eq!(found.len(), 1);
        assert!(found[0] < 1e-3);
    }
}
