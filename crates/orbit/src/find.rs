//! From a system to its orbit.

use std::f64::consts::TAU;

use crate::error::OrbitError;
use crate::orbit::Orbit;
use crate::path::{Element, PhaseEvent};
use crate::piecewise::Piecewise;
use crate::resting::settle;
use crate::scaled::Scaled;
use crate::settings::{Event, Settings};
use crate::shooting::{Map, Passage, close, distance};
use crate::smooth::Smooth;
use crate::system::System;

/// Looks for the periodic orbit of `system` at `frequency` in Hz: one of a single period of the excitation. It may be
/// unstable ([`Orbit::multipliers`]); a motion that repeats only after several periods beside none of one is an error.
///
/// # Errors
/// [`OrbitError`] when there is none, or none was found.
pub fn find(system: &System, frequency: f64, settings: &Settings) -> Result<Orbit, OrbitError> {
    let system = Scaled::new(system, frequency)?;
    let start = start(&system, settings)?;
    let odd = system.is_odd();
    let (closed, (path, end, _), weights) = if system.is_smooth() {
        let mut map = Smooth::new(&system, settings.tolerance);
        let closed = close(&mut map, start, (odd, false), settings)?;
        let record = map.record(&closed.state, TAU)?;
        let weights = weights(&map, record.2);
        (closed, record, weights)
    } else {
        let mut map = Piecewise::new(&system);
        let closed = close(&mut map, start, (odd, true), settings)?;
        let closed = settle(&mut map, closed, settings.closure)?;
        let record = map.record(&closed.state, TAU)?;
        let weights = weights(&map, record.2);
        (closed, record, weights)
    };
    let closure = distance(&end, &closed.state, 1.0, &weights);
    if closure > settings.closure {
        let (periods, iterations) = (closed.periods, closed.iterations);
        return Err(OrbitError::NotClosed { closure, periods, iterations });
    }
    let orbit = Orbit {
        events: path.events.iter().filter_map(|event| physical(&system, event)).collect(),
        state: closed.state,
        closure,
        iterations: closed.iterations,
        periods: closed.periods,
        tolerance: settings.tolerance,
        path,
        system,
    };
    let stuck = orbit.events.is_empty() && !orbit.locked_sliders().is_empty();
    if stuck { Err(OrbitError::Stuck) } else { Ok(orbit) }
}

fn weights(map: &dyn Map, passage: Passage) -> Vec<f64> {
    let mut weights = Vec::new();
    map.weights(passage, &mut weights);
    weights
}

fn physical(system: &Scaled, event: &PhaseEvent) -> Option<Event> {
    let (contact, slider) = match event.element {
        Element::Slider(slider) => {
            let contact = system.sliders.get(slider)?.contact;
            (contact, slider - system.links.get(contact)?.sliders.start)
        }
        Element::Press(press) => (system.presses.get(press)?.contact, 0),
    };
    Some(Event {
        time: event.tau / system.omega,
        contact,
        slider,
        kind: event.kind,
        direction: event.direction,
    })
}

/// The state to start from without dimensions.
fn start(system: &Scaled, settings: &Settings) -> Result<Vec<f64>, OrbitError> {
    let n = system.dofs;
    let sliders = system.sliders.len() + system.pulls().count();
    let Some(state) = &settings.start else { return Ok(vec![0.0; 2 * n + sliders]) };
    for (what, given, expected) in [
        ("displacements", state.displacement.len(), n),
        ("velocities", state.velocity.len(), n),
        ("sliders", state.sliders.len(), sliders),
    ] {
        if given != expected {
            return Err(OrbitError::Start { what, given, expected });
        }
    }
    let weighed = |x: &[f64], unit: f64| -> Vec<f64> {
        x.iter().zip(&system.root_mass).map(|(x, root)| x * root / unit).collect()
    };
    let mut out = weighed(&state.displacement, system.size);
    out.extend(weighed(&state.velocity, system.size * system.omega));
    let forces = state.sliders.iter().zip(&system.sliders);
    out.extend(forces.map(|(force, slider)| (force / (slider.limit * system.force())).clamp(-1.0, 1.0)));
    // Friction is cut to what the pressure allows where the motion begins.
    let pulls = state.sliders.iter().skip(system.sliders.len()).zip(system.pulls());
    out.extend(pulls.map(|(force, (friction, _))| force / (friction.stiffness * system.force())));
    if out.iter().all(|x| x.is_finite()) {
        Ok(out)
    } else {
        Err(OrbitError::NotFinite { what: "the state to start from".to_owned() })
    }
}
