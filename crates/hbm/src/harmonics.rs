//! Which harmonics a problem needs: the base period reduced to the common divisor of the excited harmonics, even
//! ones left out where nothing excites them.

use crate::problem::Problem;

/// The harmonics of the unknowns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Harmonics {
    /// The base frequency is this multiple of Ω. A loop law is not invariant under counting a motion of period
    /// T/3 as one of period T, so the shortest period is the right one.
    pub(crate) fundamental: usize,
    /// Only odd multiples of the base frequency.
    pub(crate) odd: bool,
    /// Multiples of the base frequency, ascending, those of an estimate included.
    pub(crate) reduced: Vec<usize>,
    /// The same as harmonics of Ω.
    pub(crate) orders: Vec<usize>,
    /// The highest multiple of the base frequency that a solution may have.
    pub(crate) asked: usize,
    /// Highest excited multiple of the base frequency.
    pub(crate) highest_excited: usize,
}

impl Harmonics {
    /// The harmonics of `problem` up to `highest` · Ω, and with `estimate` those beyond that an estimate of the truncation
    /// error looks at. An undriven mean is left out where one harmonic is asked for and no law depends on it.
    pub(crate) fn new<M>(problem: &Problem<M>, highest: usize, estimate: bool, mean_is_free: bool) -> Self {
        let excited = || problem.excitation.iter().filter(|e| e.amplitude != 0.0).map(|e| e.harmonic);
        let fundamental = match excited().fold(0, gcd) {
            0 => 1,
            divisor => divisor,
        };
        let moving = excited().any(|k| k > 0);
        // A contact pressure that varies makes even harmonics of odd ones.
        let odd_laws = problem.joints.is_empty() && problem.contacts.iter().all(|c| c.law.nature().odd);
        let odd = odd_laws && moving && excited().all(|k| (k / fundamental) % 2 == 1);
        let asked = if moving { highest / fundamental } else { 0 };
        let room = if estimate && moving { beyond(asked) } else { asked };
        let statics = excited().any(|k| k == 0) || !mean_is_free || asked > 1;
        let reduced: Vec<usize> = match (moving, odd) {
            (false, _) => vec![0],
            (true, true) => (1..=room).step_by(2).collect(),
            (true, false) => (if statics { 0 } else { 1 }..=room).collect(),
        };
        Self {
            fundamental,
            odd,
            orders: reduced.iter().map(|k| k * fundamental).collect(),
            reduced,
            asked,
            highest_excited: excited().max().unwrap_or(0) / fundamental,
        }
    }

    /// Highest multiple of the base frequency, those of an estimate included.
    pub(crate) fn highest(&self) -> usize {
        self.reduced.last().copied().unwrap_or(0)
    }

    /// How many of the harmonics are at most `n` times the base frequency.
    pub(crate) fn up_to(&self, n: usize) -> usize {
        self.reduced.partition_point(|&k| k <= n)
    }
}

/// How far an estimate looks beyond `n` harmonics: as far as halves the step of a ladder.
pub(crate) fn beyond(n: usize) -> usize {
    (2 * n + 1).max(7)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_divisors() {
        assert_eq!(gcd(0, 3), 3);
        assert_eq!(gcd(6, 4), 2);
        assert_eq!([9, 6, 3].into_iter().fold(0, gcd), 3);
        assert_eq!([0, 0].into_iter().fold(0, gcd), 0);
    }
}
