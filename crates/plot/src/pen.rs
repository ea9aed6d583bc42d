//! Strokes and type sizes of all figures: chosen to survive grey print at column width.

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// As SVG writes it.
    pub color: &'static str,
    /// In px (1/96 in).
    pub width: f64,
    /// Dash lengths; `None` is solid.
    pub dash: Option<&'static str>,
    /// Radius of the dots that mark each point, in px; `None` joins the points by a line instead.
    pub dot: Option<f64>,
}

/// What the figure is about: dark and solid.
pub const MAIN: Pen = Pen { color: "#12397a", width: 1.4, dash: None, dot: None };
/// Parts of it that are unstable: dashed.
pub const UNSTABLE: Pen = Pen { color: "#12397a", width: 1.2, dash: Some("4 2.5"), dot: None };
/// What it is compared with: lighter in grey print, dash-dotted.
pub const REFERENCE: Pen = Pen { color: "#d2691e", width: 1.2, dash: Some("6 2 1.5 2"), dot: None };
/// A fit over its data: dashed.
pub const FIT: Pen = Pen { color: "#d2691e", width: 1.4, dash: Some("5 2.2"), dot: None };
/// Measured points.
pub const POINT: Pen = Pen { color: "#12397a", width: 1.2, dash: None, dot: Some(2.6) };
/// Raw data behind everything.
pub const FAINT: Pen = Pen { color: "#b8b8b8", width: 0.6, dash: None, dot: None };
/// Stretches of the abscissa that deserve a remark.
pub const RUG: Pen = Pen { color: "#9a9a9a", width: 2.4, dash: None, dot: None };

/// Frame and ticks.
pub(super) const FRAME: &str = "#000000";
pub(super) const FRAME_WIDTH: f64 = 0.8;
pub(super) const TICK: f64 = 4.5;
pub(super) const MINOR_TICK: f64 = 2.5;

/// Type sizes in px: 8.25 pt, 7.5 pt.
pub(super) const LABEL_SIZE: u32 = 11;
pub(super) const TICK_SIZE: u32 = 10;

/// Width of `text` in px by the advances of DejaVu Sans, rounded up in groups of letters.
pub(super) fn text_width(text: &str, size: u32) -> f64 {
    let advance = |letter: char| match letter {
        'i' | 'j' | 'l' | ' ' | '.' | ',' | '|' | '\'' => 0.34,
        'f' | 'r' | 't' | 'I' | '(' | ')' | '-' => 0.42,
        'c' | 's' | 'z' => 0.55,
        'm' | 'w' | 'M' | 'W' | '=' => 0.99,
        lower if lower.is_lowercase() || lower.is_ascii_digit() => 0.64,
        _ => 0.79,
    };
    f64::from(size) * text.chars().map(advance).sum::<f64>()
}
