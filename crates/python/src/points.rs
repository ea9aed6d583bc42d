//! The points of a result as arrays: one row a point, NaN where a point failed.

use std::collections::BTreeSet;

use num_complex::Complex64;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use scene::{ContactOutcome, ContactPoint, DirectionPoint, JointPoint, Point, PointStability, Spectrum};

use crate::arrays::{shaped, vector};

const MISSING: Complex64 = Complex64 { re: f64::NAN, im: f64::NAN };

/// The harmonics that any of the spectra has, ascending.
fn orders(points: &[&Point]) -> Vec<usize> {
    let spectra = points.iter().filter_map(|point| point.displacement.as_ref());
    let orders: BTreeSet<usize> =
        spectra.flat_map(|named| named.0.iter().flat_map(|(_, s)| s.0.iter().map(|(k, _)| *k))).collect();
    orders.into_iter().collect()
}

/// A spectrum over `orders`; zero where it has no such harmonic, missing where there is no spectrum.
fn row<'a>(spectrum: Option<&'a Spectrum>, orders: &'a [usize]) -> impl Iterator<Item = Complex64> + 'a {
    orders.iter().map(move |order| match spectrum {
        None => MISSING,
        Some(spectrum) => spectrum
            .0
            .binary_search_by_key(order, |(k, _)| *k)
            .ok()
            .and_then(|at| spectrum.0.get(at))
            .map_or(Complex64::ZERO, |(_, amplitude)| *amplitude),
    })
}

/// What `points` hold, by names.
pub(crate) fn columns<'py>(
    py: Python<'py>,
    points: &[&Point],
    dofs: &[String],
) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let numbers =
        |of: fn(&Point) -> f64| vector(py, points.iter().map(|point| of(point)).collect::<Vec<f64>>());
    let counts = |of: fn(&Point) -> usize| {
        vector(py, points.iter().map(|point| of(point) as i64).collect::<Vec<i64>>())
    };
    columns.set_item("frequency", numbers(|p| p.frequency))?;
    columns.set_item("status", PyList::new(py, points.iter().map(|p| p.status))?)?;
    columns.set_item("reason", PyList::new(py, points.iter().map(|p| p.reason.clone()))?)?;
    columns.set_item("harmonics", counts(|p| p.harmonics))?;
    columns.set_item("iterations", counts(|p| p.iterations))?;
    columns.set_item("residual", numbers(|p| p.residual))?;
    columns.set_item("truncation_error", numbers(|p| p.truncation_error.unwrap_or(f64::NAN)))?;
    columns.set_item("sampling_error", numbers(|p| p.sampling_error.unwrap_or(f64::NAN)))?;

    columns.set_item("stable", PyList::new(py, points.iter().map(|p| judged(p).and_then(|s| s.stable)))?)?;
    columns.set_item("stability_error", numbers(|p| judged(p).map_or(f64::NAN, |s| s.error)))?;
    let most = points.iter().filter_map(|p| judged(p)).map(|s| s.multipliers.len()).max().unwrap_or(0);
    let multipliers = points.iter().flat_map(|point| {
        let known = judged(point).map_or(&[][..], |s| &s.multipliers);
        (0..most).map(|i| known.get(i).copied().unwrap_or(MISSING))
    });
    columns.set_item("multipliers", shaped(py, multipliers.collect(), &[points.len(), most])?)?;

    let orders = orders(points);
    let spectra = points.iter().flat_map(|point| {
        (0..dofs.len()).flat_map(|dof| {
            let named = point.displacement.as_ref().and_then(|named| named.0.get(dof));
            row(named.map(|(_, spectrum)| spectrum), &orders)
        })
    });
    let shape = [points.len(), dofs.len(), orders.len()];
    columns.set_item("displacement", shaped(py, spectra.collect(), &shape)?)?;
    columns.set_item("contacts", contacts(py, points, &orders)?)?;
    columns.set_item("orders", vector(py, orders.iter().map(|k| *k as i64).collect::<Vec<i64>>()))?;
    columns.set_item("dofs", PyList::new(py, dofs)?)?;
    Ok(columns)
}

/// Its stability, where it is known.
fn judged(point: &Point) -> Option<&PointStability> {
    point.stability.as_ref()?.as_ref()
}

/// By the contacts' names what they do; those in several directions by direction.
fn contacts<'py>(py: Python<'py>, points: &[&Point], orders: &[usize]) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let Some(names) = points.iter().find_map(|point| point.contacts.as_ref()) else { return Ok(all) };
    for (index, (name, kind)) in names.0.iter().enumerate() {
        let rows: Vec<Option<&ContactOutcome>> = points
            .iter()
            .map(|point| {
                point.contacts.as_ref().and_then(|named| named.0.get(index)).map(|(_, contact)| contact)
            })
            .collect();
        let contact = PyDict::new(py);
        let number = |of: fn(&ContactOutcome) -> f64| {
            vector(py, rows.iter().map(|row| row.map_or(f64::NAN, of)).collect::<Vec<f64>>())
        };
        contact.set_item("dissipation", number(ContactOutcome::dissipation))?;
        contact.set_item("state", PyList::new(py, rows.iter().map(|row| row.map(ContactOutcome::state)))?)?;
        let extrapolated: Vec<bool> =
            rows.iter().map(|row| row.is_some_and(ContactOutcome::extrapolated)).collect();
        contact.set_item("extrapolated", vector(py, extrapolated))?;
        let joint = match kind {
            ContactOutcome::One(_) => {
                let rows: Vec<Option<&ContactPoint>> = rows.iter().map(|row| row.and_then(one)).collect();
                let amplitudes: Vec<f64> =
                    rows.iter().map(|row| row.map_or(f64::NAN, |c| c.amplitude)).collect();
                contact.set_item("amplitude", vector(py, amplitudes))?;
                let forces = rows.iter().flat_map(|contact| row(contact.map(|c| &c.force), orders));
                contact.set_item("force", shaped(py, forces.collect(), &[rows.len(), orders.len()])?)?;
                all.set_item(name, contact)?;
                continue;
            }
            ContactOutcome::Several(joint) => joint,
        };
        let joints: Vec<Option<&JointPoint>> = rows.iter().map(|row| row.and_then(several)).collect();
        contact.set_item(
            "apart",
            vector(py, joints.iter().map(|row| row.map_or(f64::NAN, |c| c.apart)).collect::<Vec<f64>>()),
        )?;
        let directions = PyDict::new(py);
        for (index, (direction, _)) in joint.directions.0.iter().enumerate() {
            let rows: Vec<Option<&DirectionPoint>> = joints
                .iter()
                .map(|row| row.and_then(|c| c.directions.0.get(index)).map(|(_, d)| d))
                .collect();
            let columns = PyDict::new(py);
            let amplitudes: Vec<f64> = rows.iter().map(|row| row.map_or(f64::NAN, |d| d.amplitude)).collect();
            columns.set_item("amplitude", vector(py, amplitudes))?;
            for (what, of) in
                [("displacement", displacement as fn(&DirectionPoint) -> &Spectrum), ("force", force)]
            {
                let spectra = rows.iter().flat_map(|d| row(d.map(of), orders));
                columns.set_item(what, shaped(py, spectra.collect(), &[rows.len(), orders.len()])?)?;
            }
            directions.set_item(direction, columns)?;
        }
        contact.set_item("directions", directions)?;
        all.set_item(name, contact)?;
    }
    Ok(all)
}

fn one(contact: &ContactOutcome) -> Option<&ContactPoint> {
    match contact {
        ContactOutcome::One(contact) => Some(contact),
        ContactOutcome::Several(_) => None,
    }
}

fn several(contact: &ContactOutcome) -> Option<&JointPoint> {
    match contact {
        ContactOutcome::One(_) => None,
        ContactOutcome::Several(joint) => Some(joint),
    }
}

fn displacement(direction: &DirectionPoint) -> &Spectrum {
    &direction.displacement
}

fn force(direction: &DirectionPoint) -> &Spectrum {
    &direction.force
}
