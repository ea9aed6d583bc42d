//! All peaks of one response: its curve is followed over the whole range, and points solved one by one look for what the
//! curve does not reach.

use crate::continuation::ContinuationOptions;
use crate::course::{Course, FrequencyCourse};
use crate::error::PlanError;
use crate::peak_search::{Search, Summit, amplitude};
use crate::problem::Problem;
use crate::prominence::prominence;
use crate::tracer::{Place, Tracer};

/// The peaks of one response.
#[derive(Debug, Clone, Default)]
pub(crate) struct Survey {
    /// By falling amplitude.
    pub(crate) summits: Vec<Summit>,
    /// The curve leads from one end of the range to the other.
    pub(crate) traced: bool,
    /// A point (Hz, m) inside the range that is higher than every peak that was found.
    pub(crate) higher: Option<(f64, f64)>,
    /// The response is higher than its peaks at this end of the range (Hz, m).
    pub(crate) edge: Option<(f64, f64)>,
    /// A curve had more places than are followed.
    pub(crate) cut: bool,
    /// Points without a solution.
    pub(crate) unsolved: usize,
    /// Newton steps.
    pub(crate) corrections: usize,
}

/// Points solved one by one, evenly over the range; the resonances of the linear structure come on top.
const POINTS: usize = 33;

/// Peaks below this part of the highest are left out: one that becomes the highest is followed back from the next survey.
const LOW: f64 = 0.3;

/// First step along a curve.
const FIRST_STEP: f64 = 0.01;

/// Places of one curve at most.
const MOST_PLACES: usize = 4_000;

/// Two places of a curve with a summit between them.
struct Top {
    from: Place,
    /// At both.
    growth: (f64, f64),
    /// From one to the other.
    length: f64,
    /// Number of the first along the curve.
    at: usize,
}

impl Search<'_> {
    /// The peaks of the response of `problem`; `going` answers `false` when it is to be given up, which leaves `None`.
    ///
    /// # Errors
    /// As [`crate::Plan::new`].
    pub(crate) fn survey(
        &self,
        problem: &Problem,
        going: &dyn Fn() -> bool,
    ) -> Result<Option<Survey>, PlanError> {
        let mut course = FrequencyCourse::new(problem, self.settings)?;
        let (low, high) = self.range;
        let points = self.points(&course);
        let mut ws = course.plan().workspace();
        if !course.plan.begin(low, &mut ws) {
            return Ok(Some(Survey { unsolved: points.len(), ..Survey::default() }));
        }
        let options = ContinuationOptions::default();
        let mut tracer = Tracer::new(&mut course, &mut ws, self.range, &options);
        let mut survey = Survey::default();
        for (from, to) in [(low, high), (high, low)] {
            survey.traced = self.trace(from, to, &mut tracer, &mut survey, going);
            // The other end would lead into the same.
            if survey.traced || survey.cut || !going() {
                break;
            }
        }
        self.check(&points, &mut tracer, &mut survey, going);
        survey.corrections = tracer.corrections;
        survey.keep_high();
        Ok(going().then_some(survey))
    }

    /// Frequencies in Hz that are solved one by one, ascending.
    fn points(&self, course: &FrequencyCourse) -> Vec<f64> {
        let (low, high) = self.range;
        let even = (0..POINTS).map(|i| low + (high - low) * i as f64 / (POINTS - 1) as f64);
        let mut points: Vec<f64> =
            even.chain(course.resonant().filter(|hertz| *hertz > low && *hertz < high)).collect();
        points.sort_by(f64::total_cmp);
        points.dedup();
        points
    }

    /// Collects the summits of the curve that begins at `from`; whether it leads to `to`.
    fn trace(
        &self,
        from: f64,
        to: f64,
        tracer: &mut Tracer,
        survey: &mut Survey,
        going: &dyn Fn() -> bool,
    ) -> bool {
        let (Some(mut here), _) = tracer.start(from) else { return false };
        face(&mut here, to - from);
        tracer.length = FIRST_STEP;
        let Some((mut growth, first)) = tracer.growth_and_height(&here, self.dof) else { return false };
        let mut heights = vec![first];
        let mut tops: Vec<Top> = Vec::new();
        let mut end = None;
        for _ in 0..MOST_PLACES {
            let Some((next, length)) = tracer.step(&here).filter(|_| going()) else { break };
            if tracer.comes_to_rest() {
                break;
            }
            let Some((ahead, height)) = tracer.growth_and_height(&next, self.dof) else { break };
            if growth > 0.0 && ahead <= 0.0 {
                tops.push(Top { from: here, growth: (growth, ahead), length, at: heights.len() - 1 });
            }
            heights.push(height);
            let beyond = |end: f64, sign: f64| (next.parameter - end) * sign * (to - from).signum() >= 0.0;
            if beyond(to, 1.0) || beyond(from, -1.0) {
                end = Some(beyond(to, 1.0));
                break;
            }
            (here, growth) = (next, ahead);
        }
        survey.cut = end.is_none() && heights.len() > MOST_PLACES;
        let noise = tracer.course.plan().noise();
        for top in tops {
            let at = if heights.get(top.at + 1) > heights.get(top.at) { top.at + 1 } else { top.at };
            let Some(height) = heights.get(at).copied() else { continue };
            // Between two places the summit may stand above both.
            let wiggle = tracer.course.plan().samples_kinks() && prominence(&heights, at) <= noise * height;
            if !wiggle && let Some(summit) = tracer.enclosed(&top.from, top.growth, top.length, self) {
                add(&mut survey.summits, summit);
            }
        }
        end == Some(true)
    }

    /// Solves points one by one and climbs from where they are higher than every summit.
    fn check(&self, points: &[f64], tracer: &mut Tracer, survey: &mut Survey, going: &dyn Fn() -> bool) {
        let slot = tracer.course.plan().first_slot();
        let mut heights = Vec::with_capacity(points.len());
        for &hertz in points {
            if !going() {
                return;
            }
            let (_, solution) = tracer.start(hertz);
            let height = slot.and_then(|slot| amplitude(&solution, slot, self.dof));
            survey.unsolved += usize::from(height.is_none());
            heights.extend(height.map(|height| (hertz, height)));
        }
        for i in 0..heights.len() {
            let Some(&(hertz, height)) = heights.get(i) else { continue };
            let beside = |j: Option<usize>| j.and_then(|j| heights.get(j)).map(|(_, height)| *height);
            let (before, after) = (beside(i.checked_sub(1)), beside(i.checked_add(1)));
            let rises = before.is_none_or(|before| height >= before) && after.is_none_or(|a| height >= a);
            if !rises || !survey.is_exceeded(height) {
                continue;
            }
            let found = match tracer.start(hertz) {
                (Some(place), _) => tracer.climb(place, self, None, f64::INFINITY),
                (None, solution) if solution.status.solved() => {
                    let (summit, steps) = self.at_rest(hertz, tracer.course.plan(), tracer.ws);
                    tracer.corrections += steps;
                    summit
                }
                _ => None,
            };
            if let Some(summit) = found {
                add(&mut survey.summits, summit);
            }
            if survey.is_exceeded(height) {
                let worse = |known: Option<(f64, f64)>| known.is_none_or(|(_, known)| height > known);
                match before.is_none() || after.is_none() {
                    true if worse(survey.edge) => survey.edge = Some((hertz, height)),
                    false if worse(survey.higher) => survey.higher = Some((hertz, height)),
                    _ => {}
                }
            }
        }
        let exceeded = |point: &(f64, f64)| survey.is_exceeded(point.1);
        (survey.higher, survey.edge) =
            (survey.higher.filter(exceeded), survey.edge.filter(|point| survey.is_exceeded(point.1)));
    }
}

impl Survey {
    /// Whether a point is higher than every summit.
    fn is_exceeded(&self, height: f64) -> bool {
        self.summits.iter().all(|summit| height > summit.amplitude * (1.0 + summit.noise))
    }

    /// Sorts the summits and leaves out the low ones.
    fn keep_high(&mut self) {
        self.summits.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let highest = self.summits.first().map_or(0.0, |summit| summit.amplitude);
        self.summits.retain(|summit| summit.amplitude >= LOW * highest);
    }
}

/// Adds a summit that is not known yet.
fn add(summits: &mut Vec<Summit>, summit: Summit) {
    if !summits.iter().any(|known| known.is(&summit)) {
        summits.push(summit);
    }
}

/// Turns the tangent so that the parameter goes the way of `way`.
fn face(place: &mut Place, way: f64) {
    if place.tangent.last().is_some_and(|along| along * way < 0.0) {
        for entry in &mut place.tangent {
            *entry = -*entry;
        }
    }
}
