//! One period at chosen points: harmonics and waveforms of the dofs, loops of the contacts.

use std::f64::consts::TAU;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use num_complex::Complex64;
use scene::{ContactMotion, Prepared, RecordedPoint, Spectrum};

use crate::data::Motions;
use crate::recorded::{Recorded, RecordedLine};

/// Instants a period at least.
pub(crate) const SAMPLES: usize = 128;

/// Points of a result with a period at most, and numbers of all periods together.
const MOST_POINTS: usize = 400;
const MOST_NUMBERS: usize = 2_000_000;

/// Periods of some points, collected one after the other.
pub(crate) struct Periods {
    motions: Motions,
    bytes: Vec<u8>,
}

impl Periods {
    /// For `recorded`, whose periods have so many instants and whose contacts so many directions.
    pub(crate) fn new(recorded: &Recorded, samples: usize, force: &'static str) -> Self {
        let first = recorded.points.iter().find_map(RecordedLine::motion);
        let (mut orders, mut rows) = (Vec::new(), 0);
        if let Some(motion) = first {
            rows = motion.contacts.0.iter().map(|(_, contact)| contact.directions.len()).sum();
        }
        let spectra = recorded.points.iter().flat_map(|point| &point.displacement).flat_map(|named| &named.0);
        for (_, spectrum) in spectra {
            orders.extend(spectrum.0.iter().filter(|(_, w)| *w != Complex64::ZERO).map(|(k, _)| *k));
            orders.sort_unstable();
            orders.dedup();
        }
        Self { motions: Motions { samples, orders, rows, force, ..Motions::default() }, bytes: Vec::new() }
    }

    /// The points that get a period: all, or marked ones and others spread evenly.
    pub(crate) fn choose(&mut self, recorded: &Recorded, marked: &dyn Fn(usize) -> bool) -> Vec<usize> {
        let Motions { samples, orders, rows, note, .. } = &mut self.motions;
        let numbers = recorded.dofs.len() * (orders.len() + *samples) + 2 * *rows * *samples;
        let most = (MOST_NUMBERS / numbers.max(1)).clamp(1, MOST_POINTS);
        let moves = |point: &RecordedLine| point.frequency > 0.0 && point.displacement.is_some();
        let points = || recorded.points.iter().enumerate().filter(|(_, point)| moves(point));
        let known: Vec<usize> =
            points().filter(|(_, point)| point.motion().is_some()).map(|(index, _)| index).collect();
        if known.is_empty() && points().next().is_some() {
            *note = Some(
                "The result does not hold the relative displacements of its contacts, so there are no loops: solve it again \
                 with this version."
                    .into(),
            );
        }
        if known.len() <= most {
            return known;
        }
        let mut chosen: Vec<usize> =
            known.iter().copied().filter(|index| marked(*index)).take(most / 2).collect();
        let others = most - chosen.len();
        let last = known.len() - 1;
        let even = (0..others).filter_map(|i| known.get(i * last / others.saturating_sub(1).max(1)).copied());
        chosen.extend(even);
        chosen.sort_unstable();
        chosen.dedup();
        *note = Some(format!(
            "To keep this page small, loops and waveforms are kept at {} of {} points; for the others those of the nearest \
             point are shown. The curves have all points.",
            chosen.len(),
            known.len()
        ));
        chosen
    }

    /// Adds a point: `displacement` one row a dof, `contacts` one pair of rows a direction. A point whose rows do not fit
    /// is left out.
    pub(crate) fn push<'a>(
        &mut self,
        index: usize,
        point: &RecordedPoint,
        displacement: impl Iterator<Item = &'a [f64]>,
        contacts: impl Iterator<Item = (&'a [f64], &'a [f64])>,
    ) {
        let mut numbers: Vec<f64> = Vec::new();
        for (_, spectrum) in &point.displacement.0 {
            let amplitude = |order: &usize| at(spectrum, *order).norm();
            numbers.extend(self.motions.orders.iter().map(amplitude));
        }
        let mut count = 0;
        for row in displacement {
            numbers.extend(row);
            count += row.len();
        }
        for (w, force) in contacts {
            numbers.extend(w);
            // As a rig would measure it: against the force on the first body.
            numbers.extend(force.iter().map(|f| if *f == 0.0 { 0.0 } else { -f }));
            count += w.len() + force.len();
        }
        let dofs = point.displacement.0.len();
        if count == (dofs + 2 * self.motions.rows) * self.motions.samples {
            self.motions.points.push(index);
            self.bytes.extend(numbers.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
    }

    /// All of them.
    pub(crate) fn finish(mut self) -> Motions {
        self.motions.data = STANDARD.encode(&self.bytes);
        self.motions
    }
}

/// Periods from the harmonics of the result alone, where its scene is not known.
pub(crate) fn by_series(recorded: &Recorded, marked: &dyn Fn(usize) -> bool) -> Motions {
    let samples = SAMPLES.max((4 * (recorded.harmonics() + 1)).next_power_of_two());
    let mut periods = Periods::new(recorded, samples, "series");
    for index in periods.choose(recorded, marked) {
        let Some(motion) = recorded.points.get(index).and_then(RecordedLine::motion) else { continue };
        let in_time = |spectrum: &Spectrum| sampled(spectrum, samples);
        let displacement: Vec<_> = motion.displacement.0.iter().map(|(_, w)| in_time(w)).collect();
        let directions = motion.contacts.0.iter().flat_map(|(_, contact)| &contact.directions);
        let contacts: Vec<_> = directions.map(|(w, force)| (in_time(w), in_time(force))).collect();
        let pairs = contacts.iter().map(|(w, force)| (w.as_slice(), force.as_slice()));
        periods.push(index, &motion, displacement.iter().map(Vec::as_slice), pairs);
    }
    periods.finish()
}

/// Adds the period of a point as the laws of its scene make it.
///
/// # Errors
/// [`scene::Mismatch`] when the point is not one of the scene; `check` asks for more than names.
pub(crate) fn by_law(
    periods: &mut Periods,
    index: usize,
    point: &RecordedPoint,
    prepared: &Prepared,
    check: Option<Check>,
) -> Result<(), scene::Mismatch> {
    let solution = prepared.recall(point)?;
    if let Some(check) = check {
        if check.structure {
            prepared.check_structure(&solution, &mut prepared.plan().workspace())?;
        }
        check_laws(prepared, &solution)?;
    }
    let Some(wave) = prepared.plan().waveform(&solution, SAMPLES) else { return Ok(()) };
    let motions: Vec<ContactMotion> = prepared.scene().contact_motions(&wave);
    let directions = motions.iter().flat_map(|contact| &contact.directions);
    let pairs = directions.map(|direction| (direction.displacement, direction.force));
    periods.push(index, point, wave.displacement.iter().map(Vec::as_slice), pairs);
    Ok(())
}

/// Whether a point is compared with its scene number by number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Check {
    /// Displacements under the recorded forces too; those of a mode are no response to the excitation.
    pub(crate) structure: bool,
}

/// Instants a period where forces are compared.
const FINE: usize = 1024;

/// Compares forces at many instants; where those of the result may come from few, also at as many.
fn check_laws(prepared: &Prepared, solution: &hbm::Solution) -> Result<(), scene::Mismatch> {
    let plan = prepared.plan();
    let compare = |samples: usize| {
        plan.waveform(solution, samples).map_or(Ok(()), |wave| prepared.check_laws(solution, &wave))
    };
    match plan.facts().samples {
        0 => compare(FINE),
        few => compare(FINE).or_else(|_| compare(few)),
    }
}

/// The points that are compared: some, spread evenly.
pub(crate) fn compared(chosen: &[usize]) -> Vec<usize> {
    const COUNT: usize = 7;
    let last = chosen.len().saturating_sub(1);
    let mut some: Vec<usize> =
        (0..COUNT).filter_map(|i| chosen.get(i * last / (COUNT - 1)).copied()).collect();
    some.dedup();
    some
}

fn at(spectrum: &Spectrum, order: usize) -> Complex64 {
    spectrum.0.iter().find(|(k, _)| *k == order).map_or(Complex64::ZERO, |(_, w)| *w)
}

/// Re Σ W_k e^{ikθ} at equidistant θ.
fn sampled(spectrum: &Spectrum, samples: usize) -> Vec<f64> {
    let turn = |j: usize| Complex64::cis(TAU * (j % samples) as f64 / samples as f64);
    let value = |j: usize| spectrum.0.iter().map(|(k, w)| (w * turn(k * j)).re).sum();
    (0..samples).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_the_sum_of_its_cosines() {
        let spectrum =
            Spectrum(vec![(0, Complex64::new(0.5, 0.0)), (1, Complex64::new(3.0, 4.0)), (3, Complex64::I)]);
        let samples = sampled(&spectrum, 512);
        for (j, sample) in samples.iter().enumerate() {
            let theta = TAU * j as f64 / 512.0;
            let expected = 0.5 + 5.0 * (theta + (4.0_f64 / 3.0).atan()).cos() - (3.0 * theta).sin();
            assert!((sample - expected).abs() < 1e-13);
        }
    }

    #[test]
    fn compared_points_reach_from_end_to_end() {
        assert_eq!(compared(&[]), [0; 0]);
        assert_eq!(compared(&[4]), [4]);
        assert_eq!(compared(&[4, 9]), [4, 9]);
        let many = compared(&(0..100).collect::<Vec<_>>());
        assert_eq!((many.len(), many.first(), many.last()), (7, Some(&0), Some(&99)));
    }
}
