//! `law` of type `loop_family`: measured loops at several amplitudes.

use std::sync::Arc;

use contact::{Law, LoopFamily};

use crate::error::SceneError;
use crate::law::{ReadLaw, read_symmetry, refused};
use crate::loops::{self, MeasuredLoop};
use crate::read::Node;
use crate::records::Records;

pub(crate) const KEYS: [&str; 3] = ["type", "loops", "symmetric"];

/// Reads the law.
pub(crate) fn read(node: &Node, records: &Records) -> Result<ReadLaw<dyn Law>, SceneError> {
    let law = node.object("a family of loops", &KEYS)?;
    let symmetry = read_symmetry(&law)?;
    let form = "[{\"file\": \"small.csv\"}, {\"file\": \"large.csv\"}]";
    let entries = law.need("loops", form)?.list("of measured loops")?;
    let mut measured = Vec::with_capacity(entries.len());
    let mut loudest: f64 = 0.0;
    let mut notes = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let MeasuredLoop::Series { hysteresis_loop, noise, notes: own } = loops::read(entry, records)? else {
            return Err(entry.error(
                "a family needs each loop's phase, so \"force\" is not enough; write \"harmonics\" ([[1, re, im], …]) or \"file\"",
            ));
        };
        measured.push(hysteresis_loop);
        loudest = loudest.max(noise);
        notes.extend(own.into_iter().map(|note| format!("loops[{i}]: {note}")));
    }
    let family = LoopFamily::new(&measured, loudest, symmetry).map_err(|error| refused(law.path(), error))?;
    notes.extend(loops::even_note("the family's largest", family.even_content(), family.is_odd()));
    Ok(ReadLaw { law: Arc::new(family), notes })
}
