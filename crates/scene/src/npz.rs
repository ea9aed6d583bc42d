//! The result of a sweep or a curve as arrays: one row a point, NaN where a point failed.

use std::io::{self, Write};

use arrays::NpzWriter;
use num_complex::Complex64;

use crate::curve::{CurveOutcome, CurveOutcomePoint};
use crate::outcome::{ContactOutcome, DirectionPoint, Outcome, Point, Spectrum};

const MISSING: Complex64 = Complex64 { re: f64::NAN, im: f64::NAN };

impl Outcome {
    /// Writes the points as an archive of NumPy arrays; the table of them is in the book's page on formats. What does not fit into
    /// arrays is left to JSON: reasons, histories, further solutions.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_npz(&self, out: impl Write) -> io::Result<()> {
        let mut archive = NpzWriter::new(out);
        about(&mut archive, &self.scene, self.units, &self.notes)?;
        let points: Vec<&Point> = self.points.iter().collect();
        write_points(&mut archive, &points, &self.dofs)?;
        archive.finish()
    }
}

impl CurveOutcome {
    /// Writes the curve as an archive of NumPy arrays, those of a sweep with those of the curve beside them.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_npz(&self, out: impl Write) -> io::Result<()> {
        let mut archive = NpzWriter::new(out);
        about(&mut archive, &self.scene, self.units, &self.notes)?;
        let (points, n) = (&self.points, [self.points.len()]);
        archive.text("along", &[], [self.parameter.as_str()])?;
        archive.text("end", &[], [self.end])?;
        archive.numbers("parameter", &n, points.iter().map(|point| point.parameter))?;
        archive.numbers("arclength", &n, points.iter().map(|point| point.arclength))?;
        archive.truth("fold", &n, points.iter().map(|point| point.fold))?;
        let peak = |point: &CurveOutcomePoint, dof| point.peaks.contains(dof);
        let peaks = points.iter().flat_map(|point| self.dofs.iter().map(move |dof| peak(point, dof)));
        archive.truth("peak", &[points.len(), self.dofs.len()], peaks)?;
        let points: Vec<&Point> = self.points.iter().map(|point| &point.point).collect();
        write_points(&mut archive, &points, &self.dofs)?;
        archive.finish()
    }
}

fn about<W: Write>(archive: &mut NpzWriter<W>, scene: &str, units: &str, notes: &[String]) -> io::Result<()> {
    archive.whole("format_version", &[], [1])?;
    archive.text("version", &[], [env!("CARGO_PKG_VERSION")])?;
    archive.text("scene", &[], [scene])?;
    archive.text("units", &[], [units])?;
    archive.text("notes", &[notes.len()], notes.iter().map(String::as_str))
}

fn write_points<W: Write>(archive: &mut NpzWriter<W>, points: &[&Point], dofs: &[String]) -> io::Result<()> {
    let n = [points.len()];
    archive.text("dofs", &[dofs.len()], dofs.iter().map(String::as_str))?;
    archive.numbers("frequency", &n, points.iter().map(|point| point.frequency))?;
    archive.text("status", &n, points.iter().map(|point| point.status))?;
    archive.truth("converged", &n, points.iter().map(|point| point.displacement.is_some()))?;
    archive.whole("harmonics", &n, points.iter().map(|point| point.harmonics as i64))?;
    archive.whole("iterations", &n, points.iter().map(|point| point.iterations as i64))?;
    archive.numbers("residual", &n, points.iter().map(|point| point.residual))?;
    let estimate = |value: Option<f64>| value.unwrap_or(f64::NAN);
    archive.numbers("truncation_error", &n, points.iter().map(|point| estimate(point.truncation_error)))?;
    archive.numbers("sampling_error", &n, points.iter().map(|point| estimate(point.sampling_error)))?;
    let solutions = points.iter().map(|point| point.solutions.map_or(-1, |count| count as i64));
    archive.whole("solutions", &n, solutions)?;
    if points.iter().any(|point| point.stability.is_some()) {
        let stable = |point: &Point| point.stability.as_ref()?.as_ref()?.stable;
        archive.whole("stable", &n, points.iter().map(|point| stable(point).map_or(-1, i64::from)))?;
    }

    let last = points.iter().flat_map(|point| spectra(point)).flat_map(|spectrum| &spectrum.0);
    let extent = last.map(|(k, _)| k + 1).max().unwrap_or(1);
    let rows = points.iter().flat_map(|point| {
        (0..dofs.len()).flat_map(move |dof| {
            let named = point.displacement.as_ref().and_then(|named| named.0.get(dof));
            row(named.map(|(_, spectrum)| spectrum), extent)
        })
    });
    archive.complex("W", &[points.len(), dofs.len(), extent], rows)?;
    write_contacts(archive, points, extent)
}

/// All spectra of a point.
fn spectra(point: &Point) -> impl Iterator<Item = &Spectrum> {
    let displacements =
        point.displacement.iter().flat_map(|named| named.0.iter().map(|(_, spectrum)| spectrum));
    let contacts = point.contacts.iter().flat_map(|named| &named.0);
    displacements.chain(contacts.flat_map(|(name, contact)| directions(name, contact)).map(|row| row.force))
}

/// The harmonics 0 … `extent` − 1: zero where a spectrum has no such harmonic, NaN where there is no spectrum.
fn row(spectrum: Option<&Spectrum>, extent: usize) -> Vec<Complex64> {
    let Some(spectrum) = spectrum else { return vec![MISSING; extent] };
    let mut row = vec![Complex64::ZERO; extent];
    for (k, amplitude) in &spectrum.0 {
        if let Some(place) = row.get_mut(*k) {
            *place = *amplitude;
        }
    }
    row
}

/// What a contact does in one direction.
struct Direction<'p> {
    name: String,
    amplitude: f64,
    force: &'p Spectrum,
}

/// The contact itself where it has one direction, else `contact.direction`.
fn directions<'p>(name: &str, contact: &'p ContactOutcome) -> Vec<Direction<'p>> {
    match contact {
        ContactOutcome::One(contact) => {
            vec![Direction { name: name.to_owned(), amplitude: contact.amplitude, force: &contact.force }]
        }
        ContactOutcome::Several(joint) => {
            let one = |(direction, point): &'p (String, DirectionPoint)| Direction {
                name: format!("{name}.{direction}"),
                amplitude: point.amplitude,
                force: &point.force,
            };
            joint.directions.0.iter().map(one).collect()
        }
    }
}

fn write_contacts<'p, W: Write>(
    archive: &mut NpzWriter<W>,
    points: &[&'p Point],
    extent: usize,
) -> io::Result<()> {
    let known = points.iter().find_map(|point| point.contacts.as_ref());
    let contacts: Vec<&(String, ContactOutcome)> = known.into_iter().flat_map(|named| &named.0).collect();
    let shape = [points.len(), contacts.len()];
    let at = |point: &'p Point, index: usize| Some(&point.contacts.as_ref()?.0.get(index)?.1);
    let each: Vec<Option<&ContactOutcome>> =
        points.iter().flat_map(|point| (0..contacts.len()).map(move |index| at(point, index))).collect();
    archive.text("contacts", &[contacts.len()], contacts.iter().map(|(name, _)| name.as_str()))?;
    archive.text(
        "contact_state",
        &shape,
        each.iter().map(|contact| contact.map_or("", ContactOutcome::state)),
    )?;
    let dissipation = each.iter().map(|contact| contact.map_or(f64::NAN, ContactOutcome::dissipation));
    archive.numbers("contact_dissipation", &shape, dissipation)?;
    let extrapolated = each.iter().map(|contact| contact.is_some_and(ContactOutcome::extrapolated));
    archive.truth("contact_extrapolated", &shape, extrapolated)?;

    let names: Vec<String> =
        contacts.iter().flat_map(|(name, contact)| directions(name, contact)).map(|row| row.name).collect();
    let rows = |point: &Point| -> Vec<(f64, Vec<Complex64>)> {
        let named = point.contacts.iter().flat_map(|named| &named.0);
        let known = named.flat_map(|(name, contact)| directions(name, contact));
        let mut rows: Vec<_> = known.map(|found| (found.amplitude, row(Some(found.force), extent))).collect();
        rows.resize_with(names.len(), || (f64::NAN, row(None, extent)));
        rows
    };
    archive.text("contact_direction", &[names.len()], names.iter().map(String::as_str))?;
    let amplitudes = points.iter().flat_map(|point| rows(point)).map(|(amplitude, _)| amplitude);
    archive.numbers("contact_amplitude", &[points.len(), names.len()], amplitudes)?;
    let forces = points.iter().flat_map(|point| rows(point)).flat_map(|(_, force)| force);
    archive.complex("contact_force", &[points.len(), names.len(), extent], forces)
}
