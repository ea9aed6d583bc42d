//! The fit: from a record to a loop, with its noise and what was noticed on the way.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::average::{Bin, Polygon, bin_means};
use crate::checks::{check_coverage, check_samples};
use crate::drift::{force_drift, without_drift};
use crate::error::FitError;
use crate::features::{backlash, direct_dissipation, interior_reversals};
use crate::harmonics;
use crate::hysteresis_loop::Loop;
use crate::loop_phase::{largest_gap, loop_phases};
use crate::noise;
use crate::notes::Note;
use crate::record::Record;
use crate::turning_points::{TurningPoint, range};

/// How to fit. The default suits a rig's record; every part can be set alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitSettings {
    /// Highest harmonic to look at, at least 1. Fewer are used where the samples lie too far apart.
    pub max_harmonics: usize,
    /// Cycles count as steady while their amplitudes agree within this, relative (±), above 0 and below 1.
    pub steady_tolerance: f64,
    /// A harmonic is kept when it is this many times its standard error, not negative. Noise alone passes
    /// with a probability of `e^{−significance²}`.
    pub significance: f64,
    /// Largest gap in force at which a single cycle still counts as closed, relative to the force's range,
    /// positive.
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
    /// Loop phase \[rad\], from 0 below 2π: unloading up to π, loading from there.
    pub theta: Vec<f64>,
    /// Displacement `a cos θ` \[m\], without offset.
    pub displacement: Vec<f64>,
    /// Force \[N\], without offset.
    pub force: Vec<f64>,
}

/// A fitted record.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The loop: amplitude and the harmonics above the noise, zero where there is only noise, without mean.
    pub hysteresis_loop: Loop,
    /// Number of steady cycles: pairs of an upper and a lower steady turning point.
    pub cycles: usize,
    /// Number of complete unloading and of loading branches that were averaged. A direction of which there
    /// are only pieces, at the ends of the record, counts as one.
    pub branches: (usize, usize),
    /// Period of the steady cycles \[s\], where the record has times and more than one turning point of a
    /// kind.
    pub period: Option<f64>,
    /// Scatter of the force about the mean cycle, root mean square over the samples, relative to |F_1|
    /// \[-\]. For a single cycle: what the series of all harmonics that the sampling determines does not
    /// explain.
    pub noise: f64,
    /// Even content of the loop relative to |F_1| \[-\]; see [`Loop::even_content`].
    pub even_content: f64,
    /// Standard error of every harmonic looked at \[N\] (of its complex amplitude: root of the expected
    /// squared error); the index is the harmonic.
    pub harmonic_noise: Vec<f64>,
    /// Mean force over loop phase \[N\]; removed from the loop, since a rig's zero is arbitrary.
    pub force_mean: f64,
    /// Mean of the steady turning points \[m\]; removed.
    pub displacement_mean: f64,
    /// Drift of the displacement \[m per cycle\]; removed.
    pub displacement_drift: f64,
    /// Drift of the force \[N per cycle\]; removed.
    pub force_drift: f64,
    /// `∮ f dw` \[J per cycle\] by the trapezoid rule over the raw samples of the steady branches; to be
    /// compared with [`Loop::dissipation`].
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
        self.even_content <= self.noise.max(EVEN_CONTENT_LIMIT)
    }

    /// The harmonics that were kept, in order.
    pub fn kept_harmonics(&self) -> impl Iterator<Item = usize> {
        let coefficients = self.hysteresis_loop.coefficients().iter().enumerate();
        coefficients.filter(|(_, c)| **c != Complex64::ZERO).map(|(k, _)| k)
    }
}

/// Even content up to which a loop counts as symmetric.
pub const EVEN_CONTENT_LIMIT: f64 = 0.02;

/// Fits the Fourier series over loop phase to a record (Hoffmann et al. 2017, section 3).
///
/// Turning points are placed between the samples, the steady cycles found, and every sample of their branches
/// gets its loop phase; offset and drift go. The samples are averaged over loop phase and the series fitted
/// by FFT, corrected until the spacing of the samples no longer matters. The harmonics that do not rise
/// above the noise are dropped.
///
/// # Errors
/// When the record is no loop: too few samples, a constant, numbers that are not finite, an open curve, no
/// steady cycle, no area, or a force against the motion. The message says what to try.
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
    check_coverage(&phases, &steady, range(f), settings.closure_tolerance)?;
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
    let direct_dissipation = direct_dissipation(&phases, w, f, &steady.points, &mean_cycle);
    let first_point = steady.points.first().map_or(0, |p| p.sample);
    let last_point = steady.points.last().map_or(0, |p| p.sample);

    if phases.branches == (1, 1) {
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
    if even_content > relative_noise.max(EVEN_CONTENT_LIMIT) {
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

/// Relative size below which a harmonic is rounding.
const NEGLIGIBLE: f64 = 1e-9;

fn mean_cycle(means: &[Bin], points: usize, amplitude: f64, force_mean: f64) -> MeanCycle {
    let theta: Vec<f64> = (0..points).map(|j| TAU * j as f64 / points as f64).collect();
    MeanCycle {
        displacement: theta.iter().map(|t| amplitude * t.cos()).collect(),
        force: Polygon::through(means).resample(points).iter().map(|f| f - force_mean).collect(),
        theta,
    }
}
