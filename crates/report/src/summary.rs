//! What stands above the curves: facts, peaks, and the columns behind the pictures.

use scene::{Curve, Response, highest, peaks};

use crate::data::{ContactColumns, Fact, Other, Parameter, PeakLine, Points};
use crate::recorded::{Contact, Kind, Recorded, RecordedLine};

/// What a result runs along.
pub(crate) fn parameter(recorded: &Recorded) -> Parameter {
    let unit = if recorded.along() == "frequency" { "Hz" } else { "" };
    Parameter { name: recorded.along().to_owned(), unit }
}

/// What there is to say in a line each.
pub(crate) fn facts(recorded: &Recorded) -> Vec<Fact> {
    let points = &recorded.points;
    let solved = points.iter().filter(|point| point.displacement.is_some()).count();
    let unit = parameter(recorded).unit;
    let mut facts = vec![Fact {
        what: "points",
        value: match points.len() - solved {
            0 => format!("{solved}, all solved"),
            failed => format!("{}, {failed} of them not solved", points.len()),
        },
    }];
    if recorded.kind == Kind::Mode {
        let mode = recorded.mode.map_or(String::new(), |mode| format!("number {mode}"));
        facts.push(Fact { what: "nonlinear mode", value: mode });
    }
    let (least, most) = (points.iter().map(|p| p.harmonics).min(), recorded.harmonics());
    facts.push(Fact {
        what: "harmonics",
        value: match least {
            Some(least) if least < most => format!("{least} to {most}, as many as a point needs"),
            _ => most.to_string(),
        },
    });
    let worst = |value: fn(&RecordedLine) -> Option<f64>| {
        let known = points.iter().filter_map(|point| Some((value(point)?, point.place())));
        known.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut error = |what, worst: Option<(f64, f64)>, none: &str| {
        let value = match worst {
            Some((0.0, _)) => "none (forces are evaluated without samples)".to_owned(),
            Some((error, place)) => format!("{error:.1e} (relative, at {} {unit})", short(place)),
            None => none.to_owned(),
        };
        facts.push(Fact { what, value });
    };
    let none = "no estimate was made";
    error("largest estimated truncation error", worst(|point| point.truncation_error), none);
    error("largest estimated sampling error", worst(|point| point.sampling_error), none);
    if recorded.points.iter().any(|point| point.stability.is_some()) {
        let stable = |stable| {
            let judged = points.iter().filter_map(|point| point.stability.as_ref());
            judged.filter(|stability| stability.stable == stable).count()
        };
        let value = format!("{} stable, {} unstable", stable(Some(true)), stable(Some(false)));
        facts.push(Fact { what: "stability", value });
    }
    if !recorded.reason.is_empty() {
        facts.push(Fact { what: "the curve ends early", value: recorded.reason.clone() });
    }
    facts
}

/// A number to seven digits, without the noise of its last ones.
fn short(number: f64) -> f64 {
    format!("{number:.6e}").parse().unwrap_or(number)
}

/// The columns of the points, one row of amplitudes a dof.
pub(crate) fn points(recorded: &Recorded) -> Points {
    let harmonic = recorded.fundamental();
    let mut columns = Points::default();
    for point in &recorded.points {
        columns.parameter.push(match recorded.kind {
            Kind::Curve => point.place(),
            Kind::Sweep | Kind::Mode => point.frequency,
        });
        columns.frequency.push(point.frequency);
        columns.status.push(point.status.clone());
        columns.reason.push(point.reason.clone());
        columns.harmonics.push(point.harmonics);
        columns.iterations.push(point.iterations);
        columns.residual.push(point.residual);
        columns.truncation.push(point.truncation_error);
        columns.sampling.push(point.sampling_error);
        columns.solutions.push(point.solutions);
        columns.stable.push(point.stability.as_ref().and_then(|stability| stability.stable));
        columns.fold.push(point.fold);
        columns.damping_ratio.push(point.damping_ratio);
    }
    for dof in &recorded.dofs {
        let amplitude = |point: &RecordedLine| point.amplitude(dof, harmonic);
        columns.amplitude.push(recorded.points.iter().map(|p| Some(amplitude(p)?.norm())).collect());
        columns.phase.push(recorded.points.iter().map(|p| Some(amplitude(p)?.arg())).collect());
    }
    for (point, line) in recorded.points.iter().enumerate() {
        for other in &line.others {
            let amplitude = |dof: &String| other.amplitude(dof, harmonic).map(num_complex::Complex64::norm);
            columns.others.push(Other { point, amplitude: recorded.dofs.iter().map(amplitude).collect() });
        }
    }
    columns
}

/// The contacts of a result, those of its first solved point.
pub(crate) fn contacts(recorded: &Recorded) -> Vec<ContactColumns> {
    let Some(first) = recorded.points.iter().find_map(|point| point.contacts.as_ref()) else {
        return Vec::new();
    };
    let columns = |(name, contact): &(String, Contact)| {
        let directions: Vec<String> =
            contact.directions.iter().flat_map(|named| &named.0).map(|(name, _)| name.clone()).collect();
        let at = |point: &'_ RecordedLine| -> Option<Contact> {
            let (_, contact) = point.contacts.as_ref()?.0.iter().find(|(other, _)| other == name)?;
            Some(contact.clone())
        };
        let each: Vec<Option<Contact>> = recorded.points.iter().map(at).collect();
        let of_direction = |i: usize| {
            let amplitude = |contact: &Option<Contact>| {
                let contact = contact.as_ref()?;
                match &contact.directions {
                    Some(directions) => directions.0.get(i).map(|(_, direction)| direction.amplitude),
                    None => contact.amplitude,
                }
            };
            each.iter().map(amplitude).collect()
        };
        ContactColumns {
            name: name.clone(),
            state: each.iter().map(|c| c.as_ref().map(|c| c.state.clone())).collect(),
            dissipation: each.iter().map(|c| c.as_ref().map(|c| c.dissipation)).collect(),
            extrapolated: each.iter().map(|c| c.as_ref().is_some_and(|c| c.extrapolated)).collect(),
            amplitude: (0..directions.len().max(1)).map(of_direction).collect(),
            directions,
        }
    };
    first.0.iter().map(columns).collect()
}

/// The peaks of the responses, with the linear ones where they are known. A curve names its own.
pub(crate) fn peak_lines(recorded: &Recorded, points: &Points) -> Vec<PeakLine> {
    let mut lines = Vec::new();
    for (i, dof) in recorded.dofs.iter().enumerate() {
        let Some(amplitude) = points.amplitude.get(i) else { continue };
        let curve = |amplitude: &[Option<f64>]| -> Curve {
            points.parameter.iter().copied().zip(amplitude.iter().copied()).collect()
        };
        let contact = curve(amplitude);
        let linear = points.linear.as_ref().and_then(|linear| linear.get(i)).map(|row| curve(row));
        let pair = |peak: scene::Peak| (peak.frequency, peak.amplitude);
        let mut line = |contact: Option<(f64, f64)>, linear: Option<(f64, f64)>| {
            lines.push(PeakLine { dof: dof.clone(), contact, linear });
        };
        match (recorded.kind, linear) {
            (Kind::Sweep, Some(linear)) => {
                for found in (Response { dof: dof.clone(), contact, linear }).resonances() {
                    line(found.contact.map(pair), found.linear.map(pair));
                }
            }
            (Kind::Sweep, None) => {
                let inside = peaks(&contact);
                let shown = if inside.is_empty() { highest(&contact).into_iter().collect() } else { inside };
                shown.into_iter().for_each(|peak| line(Some(pair(peak)), None));
            }
            (Kind::Curve, _) => {
                for (point, at) in recorded.points.iter().zip(&contact) {
                    if point.peaks.contains(dof) {
                        line(at.1.map(|amplitude| (at.0, amplitude)), None);
                    }
                }
            }
            (Kind::Mode, _) => {}
        }
    }
    lines
}
