//! Charts side by side on one sheet, as one SVG text.

use kuva::backend::svg::SvgBackend;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::chart::{self, Chart};
use super::legend::{Entry, Legend, ROW};
use super::pen;

/// Family names written into the SVG; the PNG uses the first.
const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Height of the title line in px.
const TITLE: f64 = 22.0;
/// Baseline of the title in px.
const TITLE_BASELINE: f64 = 15.0;

/// Column width of a journal in px.
pub const COLUMN: f64 = 340.0;

/// Charts row by row in `columns` columns under a common title (may be empty), as SVG. Charts that ask for a legend have
/// it inside. When none does, in one column the first chart carries it, and several columns have it in a row above.
pub fn sheet(title: &str, columns: usize, charts: Vec<Chart>) -> String {
    decorated(title, columns, charts, &|_, _| ())
}

/// The same with something more in every chart: `add` gets it as it is drawn, and its drawing.
pub(super) fn decorated(
    title: &str,
    columns: usize,
    mut charts: Vec<Chart>,
    add: &dyn Fn(&Chart, &mut Scene),
) -> String {
    let columns = columns.max(1);
    let column_width = charts.iter().map(|chart| chart.width).fold(0.0, f64::max);
    let rows: Vec<f64> =
        charts.chunks(columns).map(|row| row.iter().map(|c| c.height).fold(0.0, f64::max)).collect();
    let width = column_width * columns.min(charts.len()) as f64;

    let mut names: Vec<Entry> = Vec::new();
    if charts.iter().any(|chart| chart.legend) {
        // Each has its own.
    } else if columns > 1 {
        for entry in charts.iter().flat_map(Entry::of) {
            if !names.contains(&entry) {
                names.push(entry);
            }
        }
    } else if let Some(first) = charts.first_mut() {
        first.legend = true;
    }
    let title_width = if title.is_empty() { 0.0 } else { pen::text_width(title, pen::LABEL_SIZE) + 20.0 };
    let beside = chart::LEFT + title_width + Legend::row_width(&names) + chart::RIGHT <= width;
    let title_height = if title.is_empty() && names.is_empty() { 0.0 } else { TITLE };
    let head = title_height + if beside || title.is_empty() { 0.0 } else { ROW };

    let mut sheet = Scene::new(width, head + rows.iter().sum::<f64>() + 2.0);
    sheet.font_family = Some(FONTS.to_owned());
    let at = (chart::LEFT, TITLE_BASELINE);
    chart::write(&mut sheet, title, at, pen::LABEL_SIZE, TextAnchor::Start, false);
    let middle = head - TITLE + TITLE_BASELINE - 0.36 * f64::from(pen::LABEL_SIZE);
    Legend::in_a_row(&names, width - chart::RIGHT, middle).draw(&mut sheet);
    for (i, chart) in charts.into_iter().enumerate() {
        let (row, column) = (i / columns, i % columns);
        let x = column as f64 * column_width;
        let y = head + rows.iter().take(row).sum::<f64>();
        let panel = chart.draw(add);
        sheet.add(Primitive::GroupStart {
            transform: Some(format!("translate({x:.2},{y:.2})")),
            title: None,
            extra_attrs: None,
        });
        sheet.elements.extend(panel.elements.into_iter().filter(|element| !clips(element)));
        sheet.add(Primitive::GroupEnd);
    }
    let (width, height) = (sheet.width, sheet.height);
    for_print(&SvgBackend::new().with_pretty(true).render_scene(&sheet), width, height)
}

/// Every axis covers its data, so nothing needs clipping; kuva numbers its clips through the life of the program, and
/// the same data would not give the same file.
fn clips(element: &Primitive) -> bool {
    matches!(element, Primitive::ClipStart { .. } | Primitive::ClipEnd)
}

/// Gives the drawing a physical size (96 px an inch) that scales, and round joins; adds what kuva leaves out.
fn for_print(svg: &str, width: f64, height: f64) -> String {
    let Some((head, body)) = svg.split_once('>') else { return svg.to_owned() };
    let fonts = head.find(" font-family").and_then(|at| head.get(at..)).unwrap_or_default();
    let millimetres = 25.4 / 96.0;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.2}mm\" height=\"{:.2}mm\" \
         viewBox=\"0 0 {width} {height}\" stroke-linejoin=\"round\"{fonts}>{body}",
        width * millimetres,
        height * millimetres,
    )
}
