//! Time of a repeated action.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

/// How often something is repeated to know its time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Patience {
    /// Repeats after the warm-up, at least.
    pub least: usize,
    /// At most.
    pub most: usize,
    /// No further repeat once the least are done and this time in s is over.
    pub enough: f64,
    /// A warm-up longer than this, in s, is the only measurement.
    pub longest: f64,
}

/// What the stopwatch showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed {
    /// Median in s.
    pub seconds: f64,
    /// Repeats behind it.
    pub repeats: usize,
}

impl Patience {
    /// Warms up, then repeats.
    pub fn time(&self, mut action: impl FnMut()) -> Timed {
        let mut once = || {
            let began = Instant::now();
            action();
            began.elapsed()
        };
        let warm_up = once();
        if warm_up.as_secs_f64() > self.longest {
            return Timed { seconds: warm_up.as_secs_f64(), repeats: 1 };
        }
        let began = Instant::now();
        let mut times: Vec<Duration> = Vec::new();
        let more = |done: usize| {
            done < self.least || (done < self.most && began.elapsed().as_secs_f64() < self.enough)
        };
        while more(times.len()) {
            times.push(once());
        }
        times.sort_unstable();
        let median = times.get(times.len() / 2).copied().unwrap_or(warm_up);
        Timed { seconds: median.as_secs_f64(), repeats: times.len().max(1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_are_bounded_on_both_sides() {
        let mut count = 0;
        let patience = Patience { least: 3, most: 5, enough: 1e9, longest: 1e9 };
        assert_eq!(patience.time(|| count += 1).repeats, 5);
        assert_eq!(count, 6);
        assert_eq!(Patience { enough: 0.0, ..patience }.time(|| ()).repeats, 3);
        assert_eq!(Patience { longest: -1.0, ..patience }.time(|| ()).repeats, 1);
    }
}
