//! One pair of boxed axes with its curves.

use kuva::plot::{LinePlot, LineStyle};
use kuva::render::color::Color;
use kuva::render::layout::{AxisLine, ComputedLayout, Layout, TickAlign, TickFormat, TickPos};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};

use super::axis::Axis;
use super::legend::Legend;
use super::pen::{self, Pen};

/// A curve in the units of its data; `None` interrupts it.
#[derive(Debug, Clone)]
pub struct Curve {
    /// For the legend; a curve without a name is not in it.
    pub name: &'static str,
    /// Abscissa and ordinate; a point between two gaps is drawn as a dot.
    pub points: Vec<(f64, Option<f64>)>,
    /// How it is drawn.
    pub pen: Pen,
}

/// One pair of axes with curves, drawn in the order given.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Written above the frame on the left.
    pub heading: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Drawn in this order.
    pub curves: Vec<Curve>,
    /// Stretches of x marked along the lower edge of the frame.
    pub rug: Vec<(f64, f64)>,
    /// What the marked stretches mean.
    pub rug_name: &'static str,
    /// Write numbers and label on the lower edge.
    pub label_x: bool,
    /// Write the label on the left edge.
    pub label_y: bool,
    /// Name the curves inside the frame.
    pub legend: bool,
    /// Of the whole chart, labels included, in px.
    pub width: f64,
    /// Likewise; [`TOP`] and [`BOTTOM`] are margins.
    pub height: f64,
}

/// Margins beside the frame in px.
pub(super) const LEFT: f64 = 50.0;
pub(super) const RIGHT: f64 = 12.0;
/// Margin above a frame in px.
pub const TOP: f64 = 20.0;
/// Margin below a frame with numbers and label in px.
pub const BOTTOM: f64 = 36.0;
/// Margin below a frame without numbers in px.
pub const BOTTOM_BARE: f64 = 8.0;

/// Points closer than this to the last one drawn are left out, in px.
const FINEST: f64 = 0.15;

impl Chart {
    pub(super) fn bottom(&self) -> f64 {
        if self.label_x { BOTTOM } else { BOTTOM_BARE }
    }

    /// Draws the chart, and what `add` adds to it. The y axis is extended upwards until a legend fits beside the curves.
    pub(super) fn draw(mut self, add: &dyn Fn(&Self, &mut Scene)) -> Scene {
        let mut layout = self.layout();
        let mut legend = None;
        let step = 0.06 * (self.y.high - self.y.low);
        for _ in 0..if self.legend { 12 } else { 0 } {
            legend = Legend::beside(&self, &ComputedLayout::from_layout(&layout));
            if legend.is_some() {
                break;
            }
            self.y.high += step;
            layout = self.layout();
        }
        let computed = ComputedLayout::from_layout(&layout);
        let mut scene = render_multiple(self.lines(&computed), layout);
        self.add_minor_ticks(&mut scene, &computed);
        self.add_points(&mut scene, &computed);
        self.add_rug(&mut scene, &computed);
        self.add_words(&mut scene);
        if let Some(legend) = legend {
            legend.draw(&mut scene);
        }
        add(&self, &mut scene);
        scene
    }

    pub(super) fn layout(&self) -> Layout {
        let x_format = if self.label_x { self.x.format() } else { TickFormat::Custom(blank()) };
        let mut layout = Layout::new((self.x.low, self.x.high), (self.y.low, self.y.high))
            .with_width(self.width)
            .with_height(self.height)
            .with_force_margins(LEFT, RIGHT)
            .with_force_margins_y(TOP, self.bottom())
            .with_x_axis_min(self.x.low)
            .with_x_axis_max(self.x.high)
            .with_y_axis_min(self.y.low)
            .with_y_axis_max(self.y.high)
            .with_show_grid(false)
            .with_axis_line(AxisLine::Box)
            .with_tick_align(TickAlign::Inside)
            .with_tick_pos(TickPos::Both)
            .with_tick_length(pen::TICK)
            .with_tick_width(pen::FRAME_WIDTH)
            .with_axis_line_width(pen::FRAME_WIDTH)
            .with_tick_size(pen::TICK_SIZE)
            .with_label_size(pen::LABEL_SIZE)
            .with_ticks(if self.width < 300.0 { 4 } else { 6 })
            .with_x_tick_format(x_format)
            .with_y_tick_format(self.y.format());
        if let Some(step) = self.x.step() {
            layout = layout.with_x_tick_step(step);
        }
        if let Some(step) = self.y.step() {
            layout = layout.with_y_tick_step(step);
        }
        layout
    }

    /// The solved stretches of a curve in px: one list of points each.
    pub(super) fn stretches(&self, curve: &Curve, computed: &ComputedLayout) -> Vec<Vec<(f64, f64)>> {
        let mut stretches = vec![Vec::new()];
        for &(x, y) in &curve.points {
            let place = y.and_then(|y| Some((self.x.place(x)?, self.y.place(y)?)));
            match (place, stretches.last_mut()) {
                (Some((x, y)), Some(stretch)) => stretch.push((computed.map_x(x), computed.map_y(y))),
                (None, Some(stretch)) if !stretch.is_empty() => stretches.push(Vec::new()),
                _ => {}
            }
        }
        stretches.retain(|stretch| !stretch.is_empty());
        stretches
    }

    fn lines(&self, computed: &ComputedLayout) -> Vec<Plot> {
        let mut lines = Vec::new();
        for curve in self.curves.iter().filter(|curve| curve.pen.dot.is_none()) {
            for stretch in self.stretches(curve, computed) {
                let back = |(x, y): (f64, f64)| {
                    let across = (x - LEFT) / computed.plot_width();
                    let up = (self.height - self.bottom() - y) / computed.plot_height();
                    (
                        self.x.low + across * (self.x.high - self.x.low),
                        self.y.low + up * (self.y.high - self.y.low),
                    )
                };
                let line = LinePlot::new()
                    .with_data(thinned(&stretch).into_iter().map(back))
                    .with_color(curve.pen.color)
                    .with_stroke_width(curve.pen.width);
                lines.push(Plot::Line(match curve.pen.dash {
                    Some(dash) => line.with_line_style(LineStyle::Custom(dash.to_owned())),
                    None => line,
                }));
            }
        }
        if lines.is_empty() {
            // An empty frame: kuva draws axes only where there is something to plot.
            lines.push(Plot::Line(LinePlot::new().with_data([(self.x.low, self.y.low)])));
        }
        lines
    }

    /// Measured points are dots, and so is a solved point between unsolved neighbours.
    fn add_points(&self, scene: &mut Scene, computed: &ComputedLayout) {
        for curve in &self.curves {
            for stretch in self.stretches(curve, computed) {
                match (curve.pen.dot, stretch.as_slice()) {
                    (Some(radius), points) => {
                        points.iter().for_each(|at| dot(scene, *at, radius, curve.pen.color))
                    }
                    (None, [alone]) => dot(scene, *alone, curve.pen.width, curve.pen.color),
                    _ => {}
                }
            }
        }
    }

    fn add_minor_ticks(&self, scene: &mut Scene, computed: &ComputedLayout) {
        let (left, right) = (LEFT, self.width - RIGHT);
        let (top, bottom) = (TOP, self.height - self.bottom());
        for place in self.y.minor_ticks() {
            let y = computed.map_y(place);
            stroke(scene, (left, y), (left + pen::MINOR_TICK, y));
            stroke(scene, (right - pen::MINOR_TICK, y), (right, y));
        }
        for place in self.x.minor_ticks() {
            let x = computed.map_x(place);
            stroke(scene, (x, bottom), (x, bottom - pen::MINOR_TICK));
            stroke(scene, (x, top), (x, top + pen::MINOR_TICK));
        }
    }

    fn add_rug(&self, scene: &mut Scene, computed: &ComputedLayout) {
        let y = self.height - self.bottom() - 0.5 * (pen::RUG.width + pen::FRAME_WIDTH);
        for &(from, to) in &self.rug {
            if let (Some(from), Some(to)) = (self.x.place(from), self.x.place(to)) {
                let x1 = computed.map_x(from).max(LEFT + 0.5 * pen::FRAME_WIDTH);
                let x2 = computed.map_x(to).min(self.width - RIGHT - 0.5 * pen::FRAME_WIDTH);
                scene.add(Primitive::Line {
                    x1,
                    y1: y,
                    x2,
                    y2: y,
                    stroke: pen::RUG.color.into(),
                    stroke_width: pen::RUG.width,
                    stroke_dasharray: None,
                });
            }
        }
    }

    fn add_words(&self, scene: &mut Scene) {
        let (left, right) = (LEFT, self.width - RIGHT);
        let (top, bottom) = (TOP, self.height - self.bottom());
        write(scene, &self.heading, (left, top - 6.0), pen::LABEL_SIZE, TextAnchor::Start, false);
        if self.label_x {
            let at = (0.5 * (left + right), bottom + 30.0);
            write(scene, &self.x.label, at, pen::LABEL_SIZE, TextAnchor::Middle, false);
        }
        if self.label_y {
            let at = (13.0, 0.5 * (top + bottom));
            write(scene, &self.y.label, at, pen::LABEL_SIZE, TextAnchor::Middle, true);
        }
        let empty = |curve: &Curve| curve.points.iter().all(|(_, y)| y.is_none());
        if !self.curves.is_empty() && self.curves.iter().all(empty) {
            let at = (0.5 * (left + right), 0.5 * (top + bottom));
            write(scene, "no solution", at, pen::TICK_SIZE, TextAnchor::Middle, false);
        }
    }
}

fn blank() -> std::sync::Arc<dyn Fn(f64) -> String + Send + Sync> {
    std::sync::Arc::new(|_| String::new())
}

/// Leaves out points that no print would resolve; the ends stay.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let far = kept.last().is_none_or(|&(u, v)| (x - u).hypot(y - v) >= FINEST);
        if far || i + 1 == points.len() {
            kept.push((x, y));
        }
    }
    kept
}

pub(super) fn dot(scene: &mut Scene, (cx, cy): (f64, f64), r: f64, color: &str) {
    scene.add(Primitive::Circle {
        cx,
        cy,
        r,
        fill: color.into(),
        fill_opacity: None,
        stroke: None,
        stroke_width: None,
    });
}

fn stroke(scene: &mut Scene, (x1, y1): (f64, f64), (x2, y2): (f64, f64)) {
    scene.add(Primitive::Line {
        x1,
        y1,
        x2,
        y2,
        stroke: Color::from(pen::FRAME),
        stroke_width: pen::FRAME_WIDTH,
        stroke_dasharray: None,
    });
}

/// Writes `text` with its baseline at `(x, y)`, upwards when `vertical`.
pub(super) fn write(
    scene: &mut Scene,
    text: &str,
    (x, y): (f64, f64),
    size: u32,
    anchor: TextAnchor,
    vertical: bool,
) {
    scene.add(Primitive::Text {
        x,
        y,
        content: text.to_owned(),
        size,
        anchor,
        rotate: vertical.then_some(-90.0),
        bold: false,
        color: None,
    });
}
