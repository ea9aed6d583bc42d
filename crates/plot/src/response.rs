//! The forced response: amplitude against frequency, one panel a dof.

use std::path::Path;

use anyhow::{Result, ensure};

use super::axis::Axis;
use super::chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
use super::curve_plot::{by_stability, marks};
use super::sheet::COLUMN;
use super::{image, pen, sheet};

/// One dof over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The dof's name.
    pub title: String,
    /// Frequency in Hz and amplitude in m with contact; `None` where no solution was found.
    pub contact: Vec<(f64, Option<f64>)>,
    /// Likewise without contact forces.
    pub linear: Vec<(f64, Option<f64>)>,
    /// For each point of `contact`: a contact left the range its law was measured in. May be empty.
    pub extrapolated: Vec<bool>,
    /// Likewise: the point is known to be unstable. May be empty.
    pub unstable: Vec<bool>,
}

/// A forced response.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Written above all panels; may be empty.
    pub title: String,
    /// One a dof.
    pub panels: Vec<Panel>,
    /// What the amplitudes are, for example "peak displacement" or "|W_1|".
    pub quantity: String,
}

/// Draws `response` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_response(response: &Response, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(response)?, path)
}

/// A third of a wide page in px (1/96 in).
const THIRD: f64 = 236.0;

/// Columns, panel width and height of the frame for a number of panels.
fn arrangement(panels: usize) -> (usize, f64, f64) {
    match panels {
        0..=3 => (1, COLUMN, 150.0),
        4..=8 => (2, COLUMN, 140.0),
        _ => (3, THIRD, 120.0),
    }
}

fn draw(response: &Response) -> Result<String> {
    let solved = |panel: &Panel| panel.contact.iter().chain(&panel.linear).any(|(_, a)| drawable(*a));
    ensure!(response.panels.iter().any(solved), "nothing to plot: no point of the response was solved");
    let frequencies =
        || response.panels.iter().flat_map(|p| p.contact.iter().chain(&p.linear)).map(|(f, _)| *f);
    let label = "frequency (Hz)".to_owned();
    let wide = spans_decades(frequencies());
    let x = if wide { Axis::decades(label, frequencies()) } else { Axis::tight(label, frequencies()) };
    let Some(x) = x else { anyhow::bail!("nothing to plot: no frequency is a number") };

    let (columns, width, frame) = arrangement(response.panels.len());
    let count = response.panels.len();
    let charts = response.panels.iter().map(in_order).enumerate().map(|(i, panel)| {
        let lowest = i + columns >= count;
        let rug = extrapolated_stretches(&panel);
        let amplitudes = panel.contact.iter().chain(&panel.linear).filter_map(|(_, a)| *a);
        let label = format!("{} (m)", subscripted(&response.quantity));
        let y = Axis::decades(label.clone(), amplitudes)
            .or_else(|| Axis::decades(label, [1e-6].into_iter()))
            .unwrap_or_else(|| x.clone());
        let (stable, unstable) = by_stability(panel.contact.into_iter().zip(marks(&panel.unstable)));
        Chart {
            heading: panel.title,
            x: x.clone(),
            y,
            curves: vec![
                Curve { name: "without contact", points: panel.linear, pen: pen::REFERENCE },
                Curve { name: "with contact", points: stable, pen: pen::MAIN },
                Curve { name: "", points: unstable, pen: pen::UNSTABLE },
            ],
            rug,
            rug_name: "extrapolated",
            label_x: lowest,
            label_y: i % columns == 0,
            legend: false,
            width,
            height: TOP + frame + if lowest { BOTTOM } else { BOTTOM_BARE },
        }
    });
    Ok(sheet::sheet(&response.title, columns, charts.collect()))
}

/// The panel with its points in the order of frequency; a scene may list them in any.
fn in_order(panel: &Panel) -> Panel {
    let marks = marks(&panel.extrapolated).zip(marks(&panel.unstable));
    let mut contact: Vec<_> = panel.contact.iter().copied().zip(marks).collect();
    contact.sort_by(|((a, _), _), ((b, _), _)| a.total_cmp(b));
    let mut linear = panel.linear.clone();
    linear.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let (contact, (extrapolated, unstable)) = contact.into_iter().unzip();
    Panel { title: panel.title.clone(), contact, linear, extrapolated, unstable }
}

/// "W_12" as it is printed: W₁₂.
pub(super) fn subscripted(text: &str) -> String {
    let mut printed = String::new();
    let mut below = false;
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        let digit = letter.to_digit(10);
        match digit.and_then(|digit| char::from_u32('₀' as u32 + digit)) {
            Some(subscript) if below => printed.push(subscript),
            _ => {
                below = letter == '_' && letters.peek().is_some_and(char::is_ascii_digit);
                printed.extend((!below).then_some(letter));
            }
        }
    }
    printed
}

fn drawable(amplitude: Option<f64>) -> bool {
    amplitude.is_some_and(|a| a > 0.0 && a.is_finite())
}

/// Whether the frequencies are spaced logarithmically over two decades or more.
fn spans_decades(frequencies: impl Iterator<Item = f64>) -> bool {
    let mut sorted: Vec<f64> = frequencies.filter(|f| f.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let (Some(&first), Some(&last)) = (sorted.first(), sorted.last()) else { return false };
    let Some(&middle) = sorted.get(sorted.len() / 2) else { return false };
    first > 0.0 && last >= 100.0 * first && middle < 0.25 * (first + last)
}

/// Stretches of frequency whose points are extrapolated, each up to halfway to its neighbours.
fn extrapolated_stretches(panel: &Panel) -> Vec<(f64, f64)> {
    let mut stretches: Vec<(f64, f64)> = Vec::new();
    let frequency = |i: usize| panel.contact.get(i).map(|(f, _)| *f);
    let mut open = false;
    for (i, &(f, _)) in panel.contact.iter().enumerate() {
        let marked = panel.extrapolated.get(i).copied().unwrap_or(false);
        let before = i.checked_sub(1).and_then(frequency).map_or(f, |g| 0.5 * (f + g));
        let after = frequency(i + 1).map_or(f, |g| 0.5 * (f + g));
        match stretches.last_mut() {
            Some((_, end)) if marked && open => *end = after,
            _ if marked => stretches.push((before, after)),
            _ => {}
        }
        open = marked;
    }
    stretches
}

#[cfg(test)]
mod tests;
