//! Names of curves: inside the frame where no curve runs, or in a row above all frames.

use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::chart::{self, Chart};
use super::pen::{self, Pen};

/// A sample stroke and its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    name: &'static str,
    pen: Pen,
}

/// Entries and where each begins: left end of the sample, middle of the row, in px.
#[derive(Debug, Clone)]
pub(super) struct Legend {
    entries: Vec<(Entry, f64, f64)>,
}

/// Height of a row, length of a sample, its distance from the name, between names in a row, from the frame; in px.
pub(super) const ROW: f64 = 14.0;
const SAMPLE: f64 = 26.0;
const GAP: f64 = 6.0;
const BETWEEN: f64 = 16.0;
const INSET: f64 = 9.0;
/// Free space kept around a legend.
const CLEAR: f64 = 3.0;

/// An upright rectangle: left, top, right, bottom.
type Box = (f64, f64, f64, f64);

impl Entry {
    /// What there is to name in a chart: the most important curve is drawn last and named first.
    pub(super) fn of(chart: &Chart) -> Vec<Self> {
        let drawn = chart
            .curves
            .iter()
            .rev()
            .filter(|c| !c.name.is_empty() && c.points.iter().any(|(_, y)| y.is_some()));
        let mut entries: Vec<Self> = drawn.map(|c| Self { name: c.name, pen: c.pen }).collect();
        if !chart.rug.is_empty() {
            entries.push(Self { name: chart.rug_name, pen: pen::RUG });
        }
        entries
    }

    fn width(&self) -> f64 {
        SAMPLE + GAP + pen::text_width(self.name, pen::TICK_SIZE)
    }
}

impl Legend {
    /// The legend of `chart` in the first of the frame's corners, the middle of its edges, or its centre, that no curve
    /// crosses.
    pub(super) fn beside(chart: &Chart, computed: &ComputedLayout) -> Option<Self> {
        let entries = Entry::of(chart);
        let width = entries.iter().map(Entry::width).fold(0.0, f64::max);
        let height = ROW * entries.len() as f64;
        let lift = if chart.rug.is_empty() { 0.0 } else { pen::RUG.width };
        let (left, right) = (chart::LEFT + INSET, chart.width - chart::RIGHT - INSET - width);
        let (top, bottom) =
            (chart::TOP + INSET - 2.0, chart.height - chart.bottom() - INSET + 2.0 - height - lift);
        let (across, down) = (0.5 * (left + right), 0.5 * (top + bottom));
        let corners = [(right, top), (left, top), (right, bottom), (left, bottom)];
        let middles = [(across, top), (across, bottom), (across, down)];
        let curves: Vec<_> = chart.curves.iter().flat_map(|curve| chart.stretches(curve, computed)).collect();
        let free = |&(x, y): &(f64, f64)| {
            let room = (x - CLEAR, y - CLEAR, x + width + CLEAR, y + height + CLEAR);
            !curves.iter().any(|curve| crosses(curve, room))
        };
        let (x, y) = corners.into_iter().chain(middles).find(free)?;
        let row = |i: usize| y + (i as f64 + 0.5) * ROW;
        Some(Self { entries: entries.into_iter().enumerate().map(|(i, entry)| (entry, x, row(i))).collect() })
    }

    /// `entries` in one row that ends at `right`, its middle at `y`.
    pub(super) fn in_a_row(entries: &[Entry], right: f64, y: f64) -> Self {
        let mut x = right - Self::row_width(entries);
        let mut place = |entry: &Entry| {
            let here = x;
            x += entry.width() + BETWEEN;
            (*entry, here, y)
        };
        Self { entries: entries.iter().map(&mut place).collect() }
    }

    pub(super) fn row_width(entries: &[Entry]) -> f64 {
        entries.iter().map(Entry::width).sum::<f64>() + BETWEEN * entries.len().saturating_sub(1) as f64
    }

    pub(super) fn draw(&self, scene: &mut Scene) {
        for &(Entry { name, pen }, x, y) in &self.entries {
            match pen.dot {
                Some(radius) => chart::dot(scene, (x + 0.5 * SAMPLE, y), radius, pen.color),
                None => scene.add(Primitive::Line {
                    x1: x,
                    y1: y,
                    x2: x + SAMPLE,
                    y2: y,
                    stroke: pen.color.into(),
                    stroke_width: pen.width.max(1.0),
                    stroke_dasharray: pen.dash.map(str::to_owned),
                }),
            }
            let at = (x + SAMPLE + GAP, y + 0.36 * f64::from(pen::TICK_SIZE));
            chart::write(scene, name, at, pen::TICK_SIZE, TextAnchor::Start, false);
        }
    }
}

/// Whether the polyline enters the box.
fn crosses(points: &[(f64, f64)], room: Box) -> bool {
    let alone = points.iter().any(|&p| segment_enters(p, p, room));
    alone || points.windows(2).any(|pair| matches!(*pair, [a, b] if segment_enters(a, b, room)))
}

/// Liang–Barsky: whether any part of the segment a–b lies in the box.
fn segment_enters(a: (f64, f64), b: (f64, f64), (left, top, right, bottom): Box) -> bool {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (step, room) in [(-dx, a.0 - left), (dx, right - a.0), (-dy, a.1 - top), (dy, bottom - a.1)] {
        if step == 0.0 {
            if room < 0.0 {
                return false;
            }
        } else if step < 0.0 {
            enter = enter.max(room / step);
        } else {
            leave = leave.min(room / step);
        }
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_clipped_correctly() {
        let room = (10.0, 10.0, 20.0, 20.0);
        assert!(segment_enters((0.0, 15.0), (30.0, 15.0), room));
        assert!(segment_enters((15.0, 0.0), (15.0, 30.0), room));
        assert!(segment_enters((12.0, 12.0), (13.0, 13.0), room));
        assert!(segment_enters((15.0, 15.0), (15.0, 15.0), room));
        assert!(!segment_enters((0.0, 0.0), (5.0, 30.0), room));
        assert!(!segment_enters((0.0, 15.0), (9.0, 15.0), room));
        assert!(!segment_enters((0.0, 18.0), (8.0, 30.0), room));
        assert!(!segment_enters((25.0, 25.0), (25.0, 25.0), room));
    }
}
