//! The largest amplitude of a response with contacts at rest.
//!
//! A contact whose law is set-valued at rest may hold still over a range of frequencies. No curve leads into it, but every point of
//! it is known on its own, and where all such contacts rest the response is that of a linear structure: its largest amplitude is
//! enclosed by three frequencies and closed in by golden sections.

use crate::peak_search::{Pose, Search, Summit, amplitude};
use crate::plan::Plan;
use crate::workspace::Workspace;

/// First step from a guess, relative to the frequency, and the farthest from it.
const FIRST_STEP: f64 = 1e-4;
const FARTHEST: f64 = 0.05;

/// The frequency is closed in to this part of itself: the height is known to the square, and not to less than rounding.
const CLOSE: f64 = 1e-8;

impl Search<'_> {
    /// The summit uphill from `hertz`, with contacts at rest all the way; and the Newton steps it took.
    pub(crate) fn at_rest(&self, hertz: f64, plan: &Plan, ws: &mut Workspace) -> (Option<Summit>, usize) {
        let mut steps = 0;
        let found = self.climb_at_rest(hertz, &mut |at| {
            let height = self.resting(at, plan, ws).map(|summit| summit.amplitude);
            steps += ws.stats.iterations;
            height
        });
        (found.and_then(|at| self.resting(at, plan, ws)), steps)
    }

    /// The frequency in Hz of the largest of `height` uphill from `hertz`.
    fn climb_at_rest(&self, hertz: f64, height: &mut dyn FnMut(f64) -> Option<f64>) -> Option<f64> {
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let mut step = FIRST_STEP * hertz;
        let (mut low, mut middle) = (hertz, hertz);
        let mut top = height(hertz)?;
        if height(hertz + step)? < top {
            step = -step;
        }
        let mut high = loop {
            let next = middle + step;
            if !self.holds(next) || (next - hertz).abs() > FARTHEST * hertz {
                return None;
            }
            let there = height(next)?;
            if there < top {
                break next;
            }
            (low, middle, top) = (middle, next, there);
            step *= 1.5;
        };
        if middle == hertz {
            low = hertz - step;
            height(low).filter(|there| *there <= top)?;
        }
        let (mut x, mut y) = (high - RATIO * (high - low), low + RATIO * (high - low));
        let (mut at_x, mut at_y) = (height(x)?, height(y)?);
        while (high - low).abs() > CLOSE * hertz {
            if at_x >= at_y {
                (high, y, at_y) = (y, x, at_x);
                x = high - RATIO * (high - low);
                at_x = height(x)?;
            } else {
                (low, x, at_x) = (x, y, at_y);
                y = low + RATIO * (high - low);
                at_y = height(y)?;
            }
        }
        Some(if at_x >= at_y { x } else { y })
    }

    /// The response at a frequency, as if it were a summit; `None` where nothing rests.
    fn resting(&self, hertz: f64, plan: &Plan, ws: &mut Workspace) -> Option<Summit> {
        let solution = plan.solve(hertz, ws);
        let rests = solution.status.solved() && ws.point.width() < plan.rows();
        let amplitude = amplitude(&solution, plan.first_slot()?, self.dof)?;
        rests.then(|| Summit { amplitude, noise: plan.noise(), pose: Pose::at_rest(hertz), solution })
    }
}
