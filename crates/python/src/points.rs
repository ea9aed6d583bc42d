//! The points of a result as arrays: one row a point, NaN where a point failed.

use std::collections::BTreeSet;

use num_complex::Complex64;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use scene::{ContactPoint, Point, Spectrum};

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

/// By the contacts' names what they do.
fn contacts<'py>(py: Python<'py>, points: &[&Point], orders: &[usize]) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let Some(names) = points.iter().find_map(|point| point.contacts.as_ref()) else { return Ok(all) };
    for (index, (name, _)) in names.0.iter().enumerate() {
        let rows: Vec<Option<&ContactPoint>> = points
            .iter()
            .map(|point| {
                point.contacts.as_ref().and_then(|named| named.0.get(index)).map(|(_, contact)| contact)
            })
            .collect();
        let numbers = |of: fn(&ContactPoint) -> f64| {
            vector(py, rows.iter().map(|row| row.map_or(f64::NAN, of)).collect::<Vec<f64>>())
        };
        let contact = PyDict::new(py);
        contact.set_item("amplitude", numbers(|c| c.amplitude))?;
        contact.set_item("dissipation", numbers(|c| c.dissipation))?;
        contact.set_item("state", PyList::new(py, rows.iter().map(|row| row.map(|c| c.state)))?)?;
        let extrapolated: Vec<bool> = rows.iter().map(|row| row.is_some_and(|c| c.extrapolated)).collect();
        contact.set_item("extrapolated", vector(py, extrapolated))?;
        let forces = rows.iter().flat_map(|contact| row(contact.map(|c| &c.force), orders));
        contact.set_item("force", shaped(py, forces.collect(), &[rows.len(), orders.len()])?)?;
        all.set_item(name, contact)?;
    }
    Ok(all)
}
