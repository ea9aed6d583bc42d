//! Reading a result: the JSON that `sweep`, `continue` and `backbone` write.

use scene::{Named, RecordedContact, RecordedPoint, Spectrum};
use serde::Deserialize;
use serde_json::Value;

use crate::error::ReportError;

/// Which command wrote a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Sweep,
    Curve,
    Mode,
}

/// A result that was written down.
#[derive(Debug, Clone, Deserialize)]
pub struct Recorded {
    #[serde(skip, default = "Recorded::sweep")]
    pub(crate) kind: Kind,
    pub(crate) scene: String,
    /// Of a nonlinear mode: not there.
    #[serde(default)]
    pub(crate) dofs: Vec<String>,
    /// Of a nonlinear mode only.
    dof: Option<String>,
    /// Of a mode only, counted from one.
    pub(crate) mode: Option<usize>,
    /// Of a curve only: `frequency` or a JSON pointer.
    pub(crate) parameter: Option<String>,
    #[serde(default)]
    pub(crate) reason: String,
    #[serde(default)]
    pub(crate) notes: Vec<String>,
    pub(crate) points: Vec<RecordedLine>,
}

/// One point of a result.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct RecordedLine {
    pub(crate) frequency: f64,
    pub(crate) status: String,
    pub(crate) harmonics: usize,
    pub(crate) iterations: usize,
    /// Null where it is not finite.
    pub(crate) residual: Option<f64>,
    pub(crate) reason: Option<String>,
    pub(crate) truncation_error: Option<f64>,
    pub(crate) sampling_error: Option<f64>,
    pub(crate) solutions: Option<usize>,
    pub(crate) displacement: Option<Named<Spectrum>>,
    pub(crate) contacts: Option<Named<Contact>>,
    pub(crate) stability: Option<Stability>,
    /// The other solutions, where they were asked for.
    #[serde(default)]
    pub(crate) others: Vec<RecordedLine>,
    /// Of a curve only.
    pub(crate) parameter: Option<f64>,
    #[serde(default)]
    pub(crate) fold: bool,
    #[serde(default)]
    pub(crate) peaks: Vec<String>,
    /// Of a mode only.
    pub(crate) damping_ratio: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Stability {
    pub(crate) stable: Option<bool>,
}

/// A contact at a point: in one direction, with amplitude and spectra, or in several.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Contact {
    pub(crate) state: String,
    pub(crate) dissipation: f64,
    pub(crate) extrapolated: bool,
    pub(crate) amplitude: Option<f64>,
    displacement: Option<Spectrum>,
    force: Option<Spectrum>,
    pub(crate) directions: Option<Named<Direction>>,
}

/// One direction of a contact.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Direction {
    pub(crate) amplitude: f64,
    displacement: Spectrum,
    force: Spectrum,
}

/// Keys by which results of other commands are known.
const OTHERS: [(&str, &str); 6] = [
    ("reference", "truncation"),
    ("study", "study"),
    ("curves", "peaks"),
    ("events", "orbit"),
    ("steps", "explain"),
    ("model", "scene"),
];

impl Recorded {
    /// Reads the text of a result.
    ///
    /// # Errors
    /// When it is none, or one that a report does not show.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        let no_result = |error: serde_json::Error| ReportError::NoResult(error.to_string());
        let value: Value = serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(no_result)?;
        let has = |key: &str| value.get(key).is_some();
        if !has("points") {
            return Err(match OTHERS.iter().find(|(key, _)| has(key)) {
                Some((_, "scene")) => ReportError::NoResult(
                    "this is a scene; solve it first (stickslip sweep SCENE -o result.json)".into(),
                ),
                Some((_, command)) => ReportError::OtherCommand(command),
                None => ReportError::NoResult("it has no points".into()),
            });
        }
        match value.get("format_version").and_then(Value::as_u64) {
            Some(1) => {}
            Some(other) => return Err(ReportError::Version(u32::try_from(other).unwrap_or(u32::MAX))),
            None => return Err(ReportError::NoResult("it has no format_version".into())),
        }
        let kind = match (has("mode"), has("parameter")) {
            (true, _) => Kind::Mode,
            (false, true) => Kind::Curve,
            (false, false) => Kind::Sweep,
        };
        // From the text, not from the value: an object's order is that of the text.
        let mut result: Self =
            serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(no_result)?;
        result.kind = kind;
        result.dofs.extend(result.dof.take());
        Ok(result)
    }

    fn sweep() -> Kind {
        Kind::Sweep
    }

    /// What it runs along.
    pub(crate) fn along(&self) -> &str {
        self.parameter.as_deref().unwrap_or("frequency")
    }

    /// The most harmonics of a point.
    pub(crate) fn harmonics(&self) -> usize {
        self.points.iter().map(|point| point.harmonics).max().unwrap_or(1).max(1)
    }

    /// The lowest harmonic that moves: the one whose amplitude a response shows.
    pub(crate) fn fundamental(&self) -> usize {
        let spectra = self.points.iter().flat_map(|point| &point.displacement).flat_map(|named| &named.0);
        let orders = spectra.flat_map(|(_, spectrum)| &spectrum.0).map(|(k, _)| *k);
        orders.filter(|k| *k > 0).min().unwrap_or(1)
    }
}

impl RecordedLine {
    /// Where it stands on the axis.
    pub(crate) fn place(&self) -> f64 {
        self.parameter.unwrap_or(self.frequency)
    }

    /// The complex amplitude of one harmonic of a dof.
    pub(crate) fn amplitude(&self, dof: &str, harmonic: usize) -> Option<num_complex::Complex64> {
        let (_, spectrum) = self.displacement.as_ref()?.0.iter().find(|(name, _)| name == dof)?;
        let found = spectrum.0.iter().find(|(k, _)| *k == harmonic);
        Some(found.map_or(num_complex::Complex64::ZERO, |(_, w)| *w))
    }

    /// The motion; `None` when the point failed, or when a contact's relative displacement was not written down.
    pub(crate) fn motion(&self) -> Option<RecordedPoint> {
        let contact = |(name, contact): &(String, Contact)| {
            let directions = match &contact.directions {
                Some(directions) => {
                    directions.0.iter().map(|(_, d)| (d.displacement.clone(), d.force.clone())).collect()
                }
                None => vec![(contact.displacement.clone()?, contact.force.clone()?)],
            };
            Some((name.clone(), RecordedContact { held: contact.state == "held", directions }))
        };
        Some(RecordedPoint {
            frequency: self.frequency,
            harmonics: self.harmonics,
            displacement: self.displacement.clone()?,
            contacts: Named(self.contacts.as_ref()?.0.iter().map(contact).collect::<Option<_>>()?),
        })
    }
}
