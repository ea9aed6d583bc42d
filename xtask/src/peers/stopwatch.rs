//! Processor time of an action, as the peers' is measured: what else the machine does is not charged.

use std::fs;
use std::time::Instant;

/// Time in s that repeats take together, at least.
const ENOUGH: f64 = 0.3;

/// Mean time of an action in s after a warm-up: processor time of this thread where the system tells it, else on the clock.
pub(super) fn seconds(mut action: impl FnMut()) -> f64 {
    action();
    let (clock, processor) = (Instant::now(), processor_time());
    let mut repeats = 0;
    while clock.elapsed().as_secs_f64() < ENOUGH || repeats < 5 {
        action();
        repeats += 1;
    }
    let elapsed = clock.elapsed().as_secs_f64();
    let used = processor.zip(processor_time()).map(|(before, after)| after - before);
    // The system counts in ticks; what it says of a few of them is no measurement.
    used.filter(|used| *used > 0.1 * ENOUGH).unwrap_or(elapsed) / f64::from(repeats)
}

/// What this thread has used so far in s: Linux's first number of `schedstat`, in ns.
fn processor_time() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}
