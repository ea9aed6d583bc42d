//! Polynomials over one time step, s ∈ [0, 1], and every root they have there.

/// Coefficients of a series over a step; with steps of at most one radian of the fastest motion the last is below
/// rounding.
pub(crate) const TERMS: usize = 20;

/// Intervals that are looked at; only a polynomial that is zero but for rounding needs as many.
const MOST_INTERVALS: u32 = 1000;

/// `Σ c_j s^j`.
pub(crate) type Polynomial = [f64; TERMS];

/// Halvings of the step after which two roots count as one that only touches.
const MOST_HALVINGS: u32 = 40;

/// The value at `s`.
pub(crate) fn value(c: &[f64], s: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// The derivative.
pub(crate) fn derivative(c: &Polynomial) -> Polynomial {
    let mut out = [0.0; TERMS];
    for (j, (out, c)) in out.iter_mut().zip(c.iter().skip(1)).enumerate() {
        *out = (j + 1) as f64 * c;
    }
    out
}

/// c(s)/s for a polynomial with c(0) = 0.
pub(crate) fn divided_by_s(c: &Polynomial) -> Polynomial {
    let mut out = [0.0; TERMS];
    for (out, c) in out.iter_mut().zip(c.iter().skip(1)) {
        *out = *c;
    }
    out
}

/// Appends all s ∈ (0, 1] where the polynomial changes its sign, ascending. Intervals are halved until a bound on the
/// series shows that there is no root, or that there is no more than one.
pub(crate) fn sign_changes(c: &Polynomial, roots: &mut Vec<f64>) {
    let mut budget = MOST_INTERVALS;
    if c.iter().any(|c| *c != 0.0) {
        search(c, (0.0, 1.0), 0, &mut budget, roots);
    }
}

fn search(c: &Polynomial, (start, width): (f64, f64), halvings: u32, budget: &mut u32, roots: &mut Vec<f64>) {
    let [constant, slope, rest @ ..] = c;
    let beyond: f64 = rest.iter().map(|c| c.abs()).sum();
    if constant.abs() > slope.abs() + beyond {
        return;
    }
    let bend: f64 = rest.iter().enumerate().map(|(j, c)| (j + 2) as f64 * c.abs()).sum();
    let end: f64 = c.iter().sum();
    let monotone = slope.abs() > bend;
    let changes = constant * end < 0.0 || (end == 0.0 && monotone && *constant != 0.0);
    *budget = budget.saturating_sub(1);
    if monotone || halvings == MOST_HALVINGS || *budget == 0 {
        if changes {
            roots.push(start + width * root(c, 0.0, (0.0, 1.0)));
        }
        return;
    }
    let (left, right) = halves(c);
    search(&left, (start, 0.5 * width), halvings + 1, budget, roots);
    search(&right, (start + 0.5 * width, 0.5 * width), halvings + 1, budget, roots);
}

/// The polynomial over the left and the right half of its interval, each as a polynomial over [0, 1].
fn halves(c: &Polynomial) -> (Polynomial, Polynomial) {
    let mut left = *c;
    let mut factor = 1.0;
    for c in &mut left {
        *c *= factor;
        factor *= 0.5;
    }
    // Taylor's shift by 1 (repeated Horner).
    let mut right = left;
    for i in 0..TERMS {
        let mut carry = 0.0;
        for c in right.iter_mut().skip(i).rev() {
            *c += carry;
            carry = *c;
        }
    }
    (left, right)
}

/// The root of c(s) = `level` between `a` and `b`, where the polynomial is monotone and passes the level: Newton's
/// method kept inside the bracket, to rounding.
pub(crate) fn root(c: &Polynomial, level: f64, (a, b): (f64, f64)) -> f64 {
    let slope = derivative(c);
    let f = |s: f64| value(c, s) - level;
    let (mut low, mut high) = (a, b);
    let sign = if f(b) > f(a) { 1.0 } else { -1.0 };
    let mut s = 0.5 * (a + b);
    for _ in 0..200 {
        let at = sign * f(s);
        if at == 0.0 {
            return s;
        }
        if at < 0.0 {
            low = s;
        } else {
            high = s;
        }
        let newton = s - at / (sign * value(&slope, s));
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - s).abs() <= 1e-16 * next.abs() || next == low || next == high {
            return next;
        }
        s = next;
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots_of(factors: &[f64]) -> Vec<f64> {
        let mut c = [0.0; TERMS];
        c[0] = 1.0;
        for (degree, root) in factors.iter().enumerate() {
            for j in (0..=degree + 1).rev() {
                c[j] = if j > 0 { c[j - 1] } else { 0.0 } - root * c[j];
            }
        }
        let mut roots = Vec::new();
        sign_changes(&c, &mut roots);
        roots
    }

    #[test]
    fn every_change_of_sign_is_found() {
        for factors in [&[0.5][..], &[0.1, 0.2, 0.3], &[0.4, 0.400_001, 0.9], &[1.0], &[1e-9, 0.7]] {
            let found = roots_of(factors);
            assert_eq!(found.len(), factors.len(), "{factors:?}: {found:?}");
            for (found, expected) in found.iter().zip(factors) {
                assert!((found - expected).abs() < 1e-9, "{factors:?}: {found:?}");
            }
        }
        // Outside, complex, touching.
        assert!(roots_of(&[-0.3, 1.2]).is_empty());
        assert!(roots_of(&[0.5, 0.5]).is_empty());
        let mut none = Vec::new();
        sign_changes(&[0.0; TERMS], &mut none);
        assert!(none.is_empty());
    }
}
