//! A quantity over two parameters as coloured cells.

use std::path::Path;

use anyhow::{Result, bail, ensure};
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::axis::Axis;
use super::chart::{self, BOTTOM, Chart, LEFT, RIGHT, TOP};
use super::sheet::{COLUMN, decorated};
use super::{image, pen};

/// One parameter and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Written along the axis.
    pub label: String,
    /// Ascending or descending.
    pub values: Vec<f64>,
    /// On a logarithmic axis.
    pub logarithmic: bool,
}

/// A quantity over two parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Abscissa.
    pub x: Parameter,
    /// Ordinate.
    pub y: Parameter,
    /// What the colours mean and its unit, `("peak of w2", "m")`.
    pub quantity: (String, &'static str),
    /// `cells[i][j]` at `x.values[i]`, `y.values[j]`; `None` where it is not known.
    pub cells: Vec<Vec<Option<f64>>>,
}

/// Draws `map` and writes it to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, nothing to draw, or a file that cannot be written; then `path` is as it was.
pub fn write_heat_map(map: &HeatMap, path: &Path) -> Result<()> {
    image::ImageFormat::of(path)?;
    image::write(&draw(map)?, path)
}

/// Height of the frame in px (1/96 in).
const FRAME: f64 = 240.0;

/// Quantities that span more than this have logarithmic colours.
const WIDE: f64 = 10.0;

/// Colours from dark to light, equally spaced to the eye and in grey print (viridis).
const COLOURS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Cells without a value.
const UNKNOWN: &str = "#dcdcdc";

/// Colour bar: largest and least width and height in px, and how many steps it is drawn with.
const BAR: (f64, f64, f64) = (96.0, 24.0, 8.0);
const STEPS: usize = 96;

fn draw(map: &HeatMap) -> Result<String> {
    let known = || map.cells.iter().flatten().flatten().copied().filter(|value| value.is_finite());
    let (low, high) =
        known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (f64::min(a, v), f64::max(b, v)));
    ensure!(low <= high, "nothing to plot: no cell has a value");
    let (Some(x), Some(y)) = (axis(&map.x), axis(&map.y)) else {
        bail!("nothing to plot: a parameter has no values");
    };
    let Some(measure) = Axis::measured(&map.quantity.0, map.quantity.1, known()) else {
        bail!("nothing to plot: no cell has a value");
    };
    let colours = Colours { low, high, logarithmic: low > 0.0 && high > WIDE * low };
    let chart = Chart {
        heading: if colours.logarithmic { format!("{}, log", measure.label) } else { measure.label.clone() },
        x,
        y,
        curves: Vec::new(),
        rug: Vec::new(),
        rug_name: "",
        label_x: true,
        label_y: true,
        legend: false,
        width: COLUMN,
        height: TOP + FRAME + BOTTOM,
    };
    // Three digits.
    let shown = |value: f64| {
        let place = measure.place(value).unwrap_or(value);
        let decimals = (2.0 - place.abs().max(1e-4).log10().floor()).clamp(0.0, 6.0);
        format!("{place:.*}", decimals as usize)
    };
    Ok(decorated("", 1, vec![chart], &|chart, scene| {
        let cells = cells(map, &colours, chart);
        // Below everything that is drawn already.
        scene.elements.splice(0..0, cells);
        colour_bar(scene, chart, &colours, [shown(low), shown(high)]);
    }))
}

/// An axis without margins whose ends are those of the outermost cells.
fn axis(parameter: &Parameter) -> Option<Axis> {
    let values = || parameter.values.iter().copied();
    let mut axis = if parameter.logarithmic && values().all(|value| value > 0.0) {
        Axis::decades(parameter.label.clone(), values())?
    } else {
        Axis::counted(&parameter.label, values())?
    };
    let edges = edges(&axis, &parameter.values);
    let ends = (edges.first().copied()?, edges.last().copied()?);
    (axis.low, axis.high) = (ends.0.min(ends.1), ends.0.max(ends.1));
    Some(axis)
}

/// Places of the borders between cells, and of both ends.
fn edges(axis: &Axis, values: &[f64]) -> Vec<f64> {
    let places: Vec<f64> = values.iter().filter_map(|value| axis.place(*value)).collect();
    let half = |a: Option<&f64>, b: Option<&f64>| match (a, b) {
        (Some(a), Some(b)) => 0.5 * (b - a),
        _ => 0.5,
    };
    let (first, last) = (places.first(), places.last());
    let before = first.map(|place| place - half(first, places.get(1)));
    let after = last.map(|place| place + half(places.len().checked_sub(2).and_then(|i| places.get(i)), last));
    let between = places.windows(2).map(|pair| 0.5 * pair.iter().sum::<f64>());
    before.into_iter().chain(between).chain(after).collect()
}

struct Colours {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Colours {
    fn of(&self, value: f64) -> String {
        let part = match (self.low < self.high, self.logarithmic) {
            (false, _) => 0.5,
            (true, false) => (value - self.low) / (self.high - self.low),
            (true, true) => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        at(part)
    }
}

/// The colour at a part of the scale.
fn at(part: f64) -> String {
    let place = part.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let left = (place.floor() as usize).min(COLOURS.len() - 2);
    let mix = |i: usize| {
        let end = |j: usize| COLOURS.get(j).and_then(|colour| colour.get(i)).copied().map_or(0.0, f64::from);
        (end(left) + (place - left as f64) * (end(left + 1) - end(left))).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

fn cells(map: &HeatMap, colours: &Colours, chart: &Chart) -> Vec<Primitive> {
    let computed = ComputedLayout::from_layout(&chart.layout());
    let across: Vec<f64> =
        edges(&chart.x, &map.x.values).iter().map(|place| computed.map_x(*place)).collect();
    let up: Vec<f64> = edges(&chart.y, &map.y.values).iter().map(|place| computed.map_y(*place)).collect();
    let mut drawn = Vec::new();
    for (column, pair) in map.cells.iter().zip(across.windows(2)) {
        for (cell, sides) in column.iter().zip(up.windows(2)) {
            if let (&[left, right], &[bottom, top]) = (pair, sides) {
                let fill = cell.map_or(UNKNOWN.to_owned(), |value| colours.of(value));
                drawn.push(rectangle(left, top, right, bottom, &fill));
            }
        }
    }
    drawn
}

fn rectangle(x1: f64, y1: f64, x2: f64, y2: f64, fill: &str) -> Primitive {
    // A hair larger than it is, so that no light shows between neighbours.
    const HAIR: f64 = 0.15;
    Primitive::Rect {
        x: x1.min(x2) - HAIR,
        y: y1.min(y2) - HAIR,
        width: (x2 - x1).abs() + 2.0 * HAIR,
        height: (y2 - y1).abs() + 2.0 * HAIR,
        fill: fill.into(),
        stroke: None,
        stroke_width: None,
        opacity: None,
    }
}

/// The colours between their least and greatest value, above the frame on the right.
fn colour_bar(scene: &mut Scene, chart: &Chart, colours: &Colours, [least, most]: [String; 2]) {
    let (widest, narrowest, height) = BAR;
    let right = chart.width - RIGHT - pen::text_width(&most, pen::TICK_SIZE) - 4.0;
    let heading = LEFT + pen::text_width(&chart.heading, pen::LABEL_SIZE);
    let free = right - heading - pen::text_width(&least, pen::TICK_SIZE) - 14.0;
    let width = free.clamp(narrowest, widest);
    let left = right - width;
    let top = TOP - 6.0 - height;
    let step = width / STEPS as f64;
    for i in 0..STEPS {
        let x = left + i as f64 * step;
        scene.add(rectangle(x, top, x + step, top + height, &at((i as f64 + 0.5) / STEPS as f64)));
    }
    let baseline = top + height;
    chart::write(scene, &least, (left - 4.0, baseline), pen::TICK_SIZE, TextAnchor::End, false);
    if colours.low < colours.high {
        chart::write(scene, &most, (right + 4.0, baseline), pen::TICK_SIZE, TextAnchor::Start, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(logarithmic: bool) -> HeatMap {
        let value = |i: usize| if logarithmic { 10f64.powf(i as f64 / 6.0) } else { 5.0 + i as f64 };
        let x: Vec<f64> = (0..19).map(value).collect();
        let y: Vec<f64> = (0..12).map(|i| 2e6 + 5e5 * i as f64).collect();
        let height = |i: usize, j: usize| {
            let (a, b) = (i as f64 / 18.0 - 0.4, j as f64 / 11.0 - 0.6);
            ((i, j) != (3, 4)).then(|| {
                2e-5 * (0.2 + (a * a + b * b)) * if logarithmic { 1.0 } else { 1.0 + 40.0 * a.abs() }
            })
        };
        HeatMap {
            cells: (0..19).map(|i| (0..12).map(|j| height(i, j)).collect()).collect(),
            x: Parameter { label: "/contacts/0/law/slip_force".into(), values: x, logarithmic },
            y: Parameter { label: "/contacts/0/law/stiffness".into(), values: y, logarithmic: false },
            quantity: ("peak of w2".into(), "m"),
        }
    }

    #[test]
    fn every_cell_is_a_rectangle_and_unknown_ones_are_grey() {
        let svg = draw(&example(true)).unwrap();
        assert!(svg.matches("<rect").count() >= 19 * 12 + STEPS);
        assert_eq!(svg.matches(UNKNOWN).count(), 1);
        assert!(svg.contains("10¹") && svg.contains("peak of w2 (µm)"));
        let none = HeatMap { cells: vec![vec![None; 12]; 19], ..example(true) };
        assert!(draw(&none).unwrap_err().to_string().contains("nothing to plot"));
    }

    #[test]
    fn borders_lie_between_the_values() {
        let axis = Axis::tight(String::new(), [1.0, 4.0].into_iter()).unwrap();
        assert_eq!(edges(&axis, &[1.0, 2.0, 4.0]), [0.5, 1.5, 3.0, 5.0]);
        assert_eq!(edges(&axis, &[2.0]), [1.5, 2.5]);
        assert_eq!((at(0.0).as_str(), at(1.0).as_str()), ("#440154", "#fde725"));
    }

    /// For looking at: `STICKSLIP_FIGURES=folder cargo test -p stickslip-plot figures`.
    #[test]
    fn figures_of_heat_maps_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let folder = std::env::var_os("STICKSLIP_FIGURES").map_or(folder.path().to_owned(), Into::into);
        write_heat_map(&example(true), &folder.join("heat-log.png")).unwrap();
        write_heat_map(&example(false), &folder.join("heat.png")).unwrap();
    }
}
