//! The fit: from a record to a loop, with its noise and what was noticed on the way.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::average::{Bin, Polygon, bin_means, bin_of};
use crate::cycles::Steady;
use crate::error::FitError;
use crate::harmonics;
use crate::hysteresis_loop::Loop;
use crate::loop_phase::{LoopPhases, largest_gap, loop_phases};
use crate::noise;
use crate::notes::Note;
use crate::record::{Quantity, Record};
use crate::turning_points::{TurningPoint, extremes, sample_noise, turning_points};

/// How to fit. The default suits a rig's record; every part can be set alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitSettings {
    /// Highest harmonic to look at, at least 1. Fewer are used where the samples lie too far apart.
    pub max_harmonics: usize,
    /// Cycles count as steady while their amplitudes agree within this, relative (±), above 0 and below 1.
    pub steady_tolerance: f64,
    /// A harmonic is kept when it is this many times its standard error, not negative. Noise alone passes with a
    /// probability of `e^{−significance²}`.
    pub significance: f64,
    /// Largest gap in force at which a single cycle still counts as closed, relative to the force's range, positive.
    pub closure_tolerance: f64,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { max_harmonics: 31, steady_tolerance: 0.02, significance: 3.0, closure_tolerance: 0.1 }
    }
}

impl FitSettings {
    fn check(&self) -> Result<(), FitError> {
        let refuse = |name, must, value| Err(FitError::Setting { name, must, value });
        if self.max_harmonics == 0 {
            return refuse("max_harmonics", "at least 1", 0.0);
        }
        if !(self.steady_tolerance > 0.0 && self.steady_tolerance < 1.0) {
            return refuse("steady_tolerance", "above 0 and below 1", self.steady_tolerance);
        }
        if !(self.significance >= 0.0 && self.significance.is_finite()) {
            return refuse("significance", "finite and not negative", self.significance);
        }
        if !(self.closure_tolerance > 0.0 && self.closure_tolerance.is_finite()) {
            return refuse("closure_tolerance", "positive and finite", self.closure_tolerance);
        }
        Ok(())
    }
}

/// The averaged steady cycle on a uniform grid of loop phase, closed implicitly (2π is not repeated).
#[derive(Debug, Clone, PartialEq)]
pub struct MeanCycle {
    /// Loop phase [rad], from 0 below 2π: unloading up to π, loading from there.
    pub theta: Vec<f64>,
    /// Displacement `a cos θ` [m], without offset.
    pub displacement: Vec<f64>,
    /// Force [N], without offset.
    pub force: Vec<f64>,
}

/// A fitted record.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The loop: amplitude and the harmonics above the noise, zero where there is only noise, without mean.
    pub hysteresis_loop: Loop,
    /// Number of steady cycles: pairs of an upper and a lower steady turning point.
    pub cycles: usize,
    /// Number of complete unloading and of loading branches that were averaged. A direction that was only measured in
    /// pieces, at the ends of the record, counts these.
    pub branches: (usize, usize),
    /// Period of the steady cycles [s], where the record has times and more than one turning point of a kind.
    pub period: Option<f64>,
    /// Scatter of the force about the mean cycle, root mean square over the samples, relative to |F_1| \[-\]. For a
    /// single cycle: what the series of all harmonics that the sampling determines does not explain.
    pub noise: f64,
    /// Even content of the loop relative to |F_1| \[-\]; see [`Loop::even_content`].
    pub even_content: f64,
    /// Standard error of every harmonic looked at [N] (of its complex amplitude: root of the expected squared
    /// error); the index is the harmonic.
    pub harmonic_noise: Vec<f64>,
    /// Mean force over loop phase [N]; removed from the loop, since a rig's zero is arbitrary.
    pub force_mean: f64,
    /// Mean of the steady turning points [m]; removed.
    pub displacement_mean: f64,
    /// Drift of the displacement [m per cycle]; removed.
    pub displacement_drift: f64,
    /// Drift of the force [N per cycle]; removed.
    pub force_drift: f64,
    /// `∮ f dw` [J per cycle] by the trapezoid rule over the raw samples of the steady branches; to be compared
    /// with [`Loop::dissipation`].
    pub direct_dissipation: f64,
    /// The steady turning points, in order.
    pub turning_points: Vec<TurningPoint>,
    /// The record's samples from the first to the last steady turning point.
    pub steady_samples: Range<usize>,
    /// The averaged cycle, for plots.
    pub mean_cycle: MeanCycle,
    /// What was noticed.
    pub notes: Vec<Note>,
}

impl Fit {
    /// Whether the loop may be taken for symmetric: its even content is below the noise or 2 %. Then
    /// [`Loop::odd_part`] loses nothing that was measured.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.even_content <= self.noise.max(SYMMETRIC)
    }

    /// The harmonics that were kept, in order.
    pub fn kept_harmonics(&self) -> impl Iterator<Item = usize> {
        let coefficients = self.hysteresis_loop.coefficients().iter().enumerate();
        coefficients.filter(|(_, c)| **c != Complex64::ZERO).map(|(k, _)| k)
    }
}

/// Even content up to which a loop counts as symmetric.
const SYMMETRIC: f64 = 0.02;
/// Reversals below this part of the record's range are not turning points of a cycle.
const REVERSAL: f64 = 0.25;
/// Fewest samples that can make a cycle.
const FEWEST: usize = 8;
/// Largest step in loop phase [rad] without a sample.
const GAP: f64 = 0.6;

/// Fits the Fourier series over loop phase to a record (Hoffmann et al. 2017, section 3).
///
/// Turning points are placed between the samples, the steady cycles found, and every sample of their branches
/// gets its loop phase; offset and drift go. The samples are averaged over loop phase and the series fitted by FFT,
/// corrected until the spacing of the samples no longer matters. The harmonics that do not rise above the
/// noise are dropped.
///
/// # Errors
/// When the record is no loop: too few samples, a constant, numbers that are not finite, an open curve, no steady cycle, no area,
/// or a force against the motion. The message says what to try.
pub fn fit(record: &Record, settings: &FitSettings) -> Result<Fit, FitError> {
    settings.check()?;
    check_samples(record)?;
    let (w, f) = (&record.displacement, &record.force);
    let increases = |t: &&Vec<f64>| t.windows(2).all(|pair| pair.first() < pair.last());
    let clock = record.time.as_ref().filter(increases);
    let position = clock.cloned().unwrap_or_else(|| (0..w.len()).map(|j| j as f64).collect());

    let (w, steady, drift_removed) = without_drift(&position, w, settings.steady_tolerance)?;
    let w = &w;
    let amplitude = steady.amplitude();
    let mut phases = loop_phases(&position, w, f, &steady)?;
    check_coverage(&phases, &steady, range(f), settings)?;
    let mut notes = Vec::new();
    if steady.skipped != (0, 0) {
        notes.push(Note::RunUpRunDown { before: steady.skipped.0, after: steady.skipped.1 });
    }

    let cycles = steady.cycles();
    let per_cycle = 2 * phases.samples.len() / (phases.branches.0 + phases.branches.1).max(1);
    let bins = per_cycle.next_power_of_two().clamp(64, 4096);
    let span =
        steady.points.last().map_or(0.0, |p| p.position) - steady.points.first().map_or(0.0, |p| p.position);
    let cycle = steady.period().unwrap_or(span);
    let drift = force_drift(&phases, bins);
    for sample in &mut phases.samples {
        sample.force -=
            drift * (sample.position - steady.points.first().map_or(0.0, |p| p.position) - 0.5 * span);
    }

    // The series of all harmonics that the samples determine.
    let pairs: Vec<(f64, f64)> = phases.samples.iter().map(|s| (s.theta, s.force)).collect();
    let means = bin_means(pairs.iter().copied(), bins);
    let gap = largest_gap(means.iter().map(|bin| bin.theta).collect()).1;
    let considered = settings.max_harmonics.min(means.len() / 4).min((PI / gap) as usize).max(1);
    if considered < settings.max_harmonics {
        notes.push(Note::CoarseSampling { harmonics: considered, asked: settings.max_harmonics });
    }
    let series = harmonics::fit_series(&pairs, bins, considered);
    let noise = noise::measure(&phases, &means, &series);

    // A loop at all?
    let first = series.get(1).copied().unwrap_or_default();
    let uncertainty = settings.significance * noise.harmonics.get(1).copied().unwrap_or(0.0);
    let floor = NEGLIGIBLE * first.norm();
    if first.im.abs() <= uncertainty.max(floor) {
        let work = PI * amplitude * first.im.abs();
        return Err(FitError::NoArea { work, uncertainty: PI * amplitude * uncertainty.max(floor) });
    }
    if first.im < 0.0 {
        return Err(FitError::AgainstMotion { work: PI * amplitude * first.im });
    }

    let force_mean = series.first().map_or(0.0, |mean| mean.re);
    let kept: Vec<Complex64> = (series.iter().zip(&noise.harmonics).enumerate())
        .map(|(k, (c, error))| {
            let above = c.norm() > (settings.significance * error).max(floor);
            if k == 1 || (k > 1 && above) { *c } else { Complex64::ZERO }
        })
        .collect();
    let number = kept.iter().filter(|c| **c != Complex64::ZERO).count();
    notes.push(Note::Harmonics { kept: number, considered, significance: settings.significance });
    let hysteresis_loop = Loop::new(amplitude, kept)?;

    let relative_noise = noise.scatter / hysteresis_loop.force_amplitude();
    let even_content = hysteresis_loop.even_content();
    let displacement_drift = (drift_removed + steady.drift) * cycle;
    let height = 2.0 * amplitude;
    let mean_cycle = mean_cycle(&means, bins.max(256), amplitude, force_mean);
    let direct_dissipation = direct_dissipation(&phases, w, f, &steady.points, force_mean);
    let first_point = steady.points.first().map_or(0, |p| p.sample);
    let last_point = steady.points.last().map_or(0, |p| p.sample);

    if cycles == 1 && phases.branches.0.max(phases.branches.1) == 1 {
        notes.push(Note::SingleCycle);
    }
    let part = first_point..last_point + 1;
    let columns = (position.get(part.clone()).unwrap_or(&[]), w.get(part).unwrap_or(&[]));
    notes.extend(interior_reversals(columns, steady.points.len(), height));
    let drifted = (displacement_drift * span / cycle / amplitude).abs();
    if drifted > 0.01 {
        notes.push(Note::DisplacementDrift { relative: drifted });
    }
    let force_drifted = (drift * span).abs() / hysteresis_loop.force_amplitude();
    if force_drifted > 0.02 {
        notes.push(Note::ForceDrift { relative: force_drifted });
    }
    if even_content > relative_noise.max(SYMMETRIC) {
        notes.push(Note::Asymmetric { even_content });
    }
    notes.extend(backlash(&mean_cycle));
    if let Some(ratio) = noise.sliding_ratio.filter(|ratio| *ratio > 1.5 && relative_noise > 0.01) {
        notes.push(Note::Chatter { noise: relative_noise, ratio });
    }
    let series_dissipation = hysteresis_loop.dissipation();
    if (direct_dissipation / series_dissipation - 1.0).abs() > 0.03 {
        notes.push(Note::DissipationMismatch { direct: direct_dissipation, series: series_dissipation });
    }

    let displaced = |mut point: TurningPoint| {
        point.displacement += drift_removed * (point.position - steady.centre);
        point
    };
    let turning_points = steady.points.iter().cloned().map(displaced).collect();
    Ok(Fit {
        hysteresis_loop,
        cycles,
        branches: phases.branches,
        period: clock.and(steady.period()),
        noise: relative_noise,
        even_content,
        harmonic_noise: noise.harmonics,
        force_mean,
        displacement_mean: steady.middle(),
        displacement_drift,
        force_drift: drift * cycle,
        direct_dissipation,
        turning_points,
        steady_samples: first_point..last_point + 1,
        mean_cycle,
        notes,
    })
}

/// Finds the steady cycles and takes the drift they show off the displacement, which moves the turning points a little:
/// until they stay. Returns the displacement, its steady part and the drift that was taken off [m per unit of position], about the
/// centre of the steady part.
fn without_drift(
    position: &[f64],
    displacement: &[f64],
    tolerance: f64,
) -> Result<(Vec<f64>, Steady, f64), FitError> {
    let mut w = displacement.to_vec();
    let mut removed = 0.0;
    let mut passes = 0;
    loop {
        let height = range(&w);
        let points = turning_points(position, &w, &extremes(&w, REVERSAL * height), height);
        let steady = Steady::find(&points, tolerance)?;
        let span = position.last().copied().unwrap_or(0.0) - position.first().copied().unwrap_or(0.0);
        passes += 1;
        if (steady.drift * span).abs() <= 1e-9 * height || passes > 3 {
            return Ok((w, steady, removed));
        }
        removed += steady.drift;
        for ((w, raw), u) in w.iter_mut().zip(displacement).zip(position) {
            *w = raw - removed * (u - steady.centre);
        }
    }
}

/// Relative size below which a harmonic is rounding.
const NEGLIGIBLE: f64 = 1e-9;

/// Largest minus smallest value.
fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - low
}

/// Refuses what cannot be a loop whatever its shape.
fn check_samples(record: &Record) -> Result<(), FitError> {
    let found = record.displacement.len();
    let lengths_agree =
        record.force.len() == found && record.time.as_ref().is_none_or(|time| time.len() == found);
    if !lengths_agree {
        return Err(FitError::Lengths { displacement: found, force: record.force.len() });
    }
    if found < FEWEST {
        return Err(FitError::TooFewSamples { found, needed: FEWEST });
    }
    let columns = [
        (Quantity::Time, record.time.as_deref().unwrap_or(&[])),
        (Quantity::Displacement, &record.displacement),
        (Quantity::Force, &record.force),
    ];
    for (quantity, values) in columns {
        if let Some(sample) = values.iter().position(|value| !value.is_finite()) {
            return Err(FitError::NotFinite { place: record.place(sample), quantity });
        }
    }
    for (quantity, values) in columns.into_iter().skip(1) {
        let value = values.first().copied().unwrap_or(0.0);
        if values.iter().all(|other| *other == value) {
            return Err(FitError::Constant { quantity, value });
        }
    }
    Ok(())
}

/// Refuses a cycle with parts that nobody measured, or whose ends do not meet.
fn check_coverage(
    phases: &LoopPhases,
    steady: &Steady,
    force_range: f64,
    settings: &FitSettings,
) -> Result<(), FitError> {
    let branches = (phases.branches.0 + phases.branches.1).max(1);
    if phases.samples.len() * 2 / branches < FEWEST {
        return Err(FitError::TooFewSamples { found: phases.samples.len() * 2 / branches, needed: FEWEST });
    }
    let (start, gap) = largest_gap(phases.samples.iter().map(|s| s.theta).collect());
    if gap > GAP {
        let displacement = |theta: f64| 1e6 * (steady.middle() + steady.amplitude() * theta.cos());
        let direction = if (start + 0.5 * gap) % TAU < PI { "unloading" } else { "loading" };
        return Err(FitError::OpenCurve {
            reason: format!(
                "between {:.4} µm and {:.4} µm, while {direction}, there is no sample",
                displacement(start),
                displacement(start + gap)
            ),
        });
    }
    let by_time = |a: &&crate::loop_phase::PhasedSample, b: &&crate::loop_phase::PhasedSample| {
        a.position.total_cmp(&b.position)
    };
    let ends = (phases.samples.iter().min_by(by_time), phases.samples.iter().max_by(by_time));
    if let (true, (Some(first), Some(last))) = (phases.joined, ends) {
        let apart = (first.theta - last.theta).abs();
        let jump = (first.force - last.force).abs();
        if apart.min(TAU - apart) < GAP && jump > settings.closure_tolerance * force_range {
            let reason = format!(
                "its ends differ by {jump:.4} N, {:.0} % of the force's range",
                100.0 * jump / force_range
            );
            return Err(FitError::OpenCurve { reason });
        }
    }
    Ok(())
}

/// Drift of the force [N per unit of position], from samples at the same loop phase in different cycles: least squares
/// with a mean of its own for every bin. Zero where no bin was passed twice.
fn force_drift(phases: &LoopPhases, bins: usize) -> f64 {
    if phases.branches.0.min(phases.branches.1) < 2 {
        return 0.0;
    }
    let mut sums = vec![(0.0, 0.0, 0.0); bins];
    for sample in &phases.samples {
        if let Some((count, position, force)) = sums.get_mut(bin_of(sample.theta, bins)) {
            *count += 1.0;
            *position += sample.position;
            *force += sample.force;
        }
    }
    let (mut covariance, mut variance) = (0.0, 0.0);
    for sample in &phases.samples {
        if let Some((count, position, force)) = sums.get(bin_of(sample.theta, bins)) {
            let later = sample.position - position / count;
            covariance += later * (sample.force - force / count);
            variance += later * later;
        }
    }
    if variance > 0.0 { covariance / variance } else { 0.0 }
}

fn mean_cycle(means: &[Bin], points: usize, amplitude: f64, force_mean: f64) -> MeanCycle {
    let theta: Vec<f64> = (0..points).map(|j| TAU * j as f64 / points as f64).collect();
    MeanCycle {
        displacement: theta.iter().map(|t| amplitude * t.cos()).collect(),
        force: Polygon::through(means).resample(points).iter().map(|f| f - force_mean).collect(),
        theta,
    }
}

/// `∮ f dw` per cycle by the trapezoid rule: over the branches between turning points, or around the whole record where
/// there is only one cycle. The mean force does no work over a closed cycle; without it a cycle that does not quite close
/// does less harm.
fn direct_dissipation(
    phases: &LoopPhases,
    displacement: &[f64],
    force: &[f64],
    points: &[TurningPoint],
    force_mean: f64,
) -> f64 {
    let chord = |w0: &f64, w1: &f64, f0: &f64, f1: &f64| (0.5 * (f0 + f1) - force_mean) * (w1 - w0);
    let work = |range: Range<usize>| -> f64 {
        let w = displacement.get(range.clone()).unwrap_or(&[]);
        let f = force.get(range).unwrap_or(&[]);
        let (ends, starts) = (w.iter().skip(1).zip(f.iter().skip(1)), w.iter().zip(f));
        starts.zip(ends).map(|((w0, f0), (w1, f1))| chord(w0, w1, f0, f1)).sum()
    };
    if phases.joined {
        let ends = (displacement.last(), displacement.first(), force.last(), force.first());
        let closing = match ends {
            (Some(w0), Some(w1), Some(f0), Some(f1)) => chord(w0, w1, f0, f1),
            _ => 0.0,
        };
        return work(0..displacement.len()) + closing;
    }
    let mean = |upper: bool| {
        let pairs = points.iter().zip(points.iter().skip(1)).filter(|(a, _)| a.upper == upper);
        let (sum, count) =
            pairs.fold((0.0, 0.0), |(sum, n), (a, b)| (sum + work(a.sample..b.sample + 1), n + 1.0));
        sum / f64::max(count, 1.0)
    };
    mean(true) + mean(false)
}

/// Reversals inside the steady part that are too large for noise.
fn interior_reversals((position, displacement): (&[f64], &[f64]), main: usize, height: f64) -> Option<Note> {
    let threshold = (12.0 * sample_noise(position, displacement)).max(0.02 * height);
    let all = extremes(displacement, threshold);
    let count = all.len().saturating_sub(main);
    let levels: Vec<f64> = all.iter().filter_map(|(sample, _)| displacement.get(*sample).copied()).collect();
    let steps = levels.iter().zip(levels.iter().skip(1)).map(|(a, b)| (a - b).abs());
    let largest = steps.filter(|step| *step < REVERSAL * height).fold(0.0, f64::max) / height;
    (count > 0 && largest > 0.0).then_some(Note::InteriorReversals { count, largest })
}

/// A plateau in the middle of the force, in both directions: the displacement travelled in bands of a twentieth of the force's
/// range has a peak there, and is at least a third smaller on both sides. (Without backlash the way a band takes grows all
/// along a branch.)
fn backlash(cycle: &MeanCycle) -> Option<Note> {
    const BANDS: usize = 20;
    let low = cycle.force.iter().copied().fold(f64::INFINITY, f64::min);
    let band = range(&cycle.force) / BANDS as f64;
    let n = cycle.force.len();
    let next = |values: &[f64], j: usize| values.get((j + 1) % n).copied().unwrap_or(0.0);
    let mut width = 0.0;
    for unloading in [true, false] {
        let mut ways = [0.0; BANDS];
        for (j, ((theta, w), f)) in cycle.theta.iter().zip(&cycle.displacement).zip(&cycle.force).enumerate()
        {
            let force = 0.5 * (f + next(&cycle.force, j));
            let way = ways.get_mut(((force - low) / band) as usize);
            if let Some(way) = way.filter(|_| (*theta < PI) == unloading) {
                *way += (next(&cycle.displacement, j) - w).abs();
            }
        }
        let way = |i: usize| ways.get(i).copied().unwrap_or(0.0);
        let peak = (7..13).max_by(|&i, &j| way(i).total_cmp(&way(j))).unwrap_or(0);
        let (above, below) = (0.5 * (way(peak + 3) + way(peak + 4)), 0.5 * (way(peak - 3) + way(peak - 4)));
        if way(peak) < 1.5 * f64::max(above, below) {
            return None;
        }
        let around: f64 = (peak - 1..=peak + 1).map(way).sum();
        width += 0.5 * (around - 1.5 * (above + below));
    }
    Some(Note::Backlash { width })
}
