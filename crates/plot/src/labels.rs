//! Names written at the right ends of curves, where a legend would need as many dashes as there are curves.

use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::chart::{BOTTOM, Chart, TOP};
use super::pen;

/// A name beside a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// What is written.
    pub text: String,
    /// The point in the units of the data; the text begins right of it.
    pub at: (f64, f64),
    /// As SVG writes it.
    pub color: &'static str,
}

/// Distance of baselines, of a text from its point, of a text from the frame, in px.
const LINE: f64 = 11.5;
const GAP: f64 = 5.0;
const INSET: f64 = 4.0;

/// Writes `labels`, moved up or down until they do not overlap.
pub(super) fn draw(scene: &mut Scene, chart: &Chart, labels: &[Label]) {
    let computed = ComputedLayout::from_layout(&chart.layout());
    let mut placed: Vec<(f64, f64, &Label)> = labels
        .iter()
        .filter_map(|label| {
            let (x, y) = (chart.x.place(label.at.0)?, chart.y.place(label.at.1)?);
            Some((computed.map_x(x) + GAP, computed.map_y(y), label))
        })
        .collect();
    placed.sort_by(|a, b| a.1.total_cmp(&b.1));
    let lowest = chart.height - BOTTOM - INSET - 0.5 * LINE;
    let mut free = TOP + INSET + 0.5 * LINE;
    for (_, y, _) in &mut placed {
        *y = y.max(free);
        free = *y + LINE;
    }
    let mut free = lowest;
    for (_, y, _) in placed.iter_mut().rev() {
        *y = y.min(free);
        free = *y - LINE;
    }
    for (x, y, label) in placed {
        scene.add(Primitive::Text {
            x,
            y: y + 0.36 * f64::from(pen::TICK_SIZE),
            content: label.text.clone(),
            size: pen::TICK_SIZE,
            anchor: TextAnchor::Start,
            rotate: None,
            bold: false,
            color: Some(label.color.into()),
        });
    }
}

/// Width in px that the longest label needs right of its point.
pub(super) fn room(labels: &[Label]) -> f64 {
    let width = |label: &Label| pen::text_width(&label.text, pen::TICK_SIZE);
    labels.iter().map(width).fold(0.0, f64::max) + GAP + INSET
}
