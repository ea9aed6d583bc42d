//! Strokes of these figures: told apart by dash and by brightness, so that grey print keeps them.

use plot::Pen;
pub(crate) use plot::pen::{MAIN, REFERENCE};

/// Elastic Coulomb friction: dotted, as in the paper.
pub(crate) const DOTTED: Pen = Pen { color: "#1a1a1a", width: 1.5, dash: Some("1.5 2"), dot: None };
/// The paper's scaling function, eq. (6): dotted there.
pub(crate) const SCALING: Pen = Pen { color: "#d2691e", width: 1.6, dash: Some("1.6 2"), dot: None };
/// Dots at turning points.
pub(crate) const DOT: Pen = Pen { color: "#d2691e", width: 2.2, dash: None, dot: None };
/// A predicted loop: dashed, as in the paper.
pub(crate) const PREDICTED: Pen = Pen { color: "#12397a", width: 1.4, dash: Some("5 2.2"), dot: None };
/// Its monoharmonic approximation.
pub(crate) const ONE_HARMONIC: Pen = Pen { color: "#d2691e", width: 1.2, dash: None, dot: None };
/// A record behind what is made of it.
pub(crate) const RECORD: Pen = Pen { color: "#c4c4c4", width: 0.5, dash: None, dot: None };

/// A loop for comparison.
pub(crate) const BEHIND: Pen = Pen { color: "#8f8f8f", width: 0.9, dash: None, dot: None };

/// N = 1, 3, 7, 31.
pub(crate) const HARMONICS: [Pen; 4] = [
    Pen { color: "#d2691e", width: 1.2, dash: Some("6 2 1.5 2"), dot: None },
    Pen { color: "#5b8db8", width: 1.2, dash: Some("1.5 2"), dot: None },
    Pen { color: "#6a6a6a", width: 1.2, dash: Some("5 2.2"), dot: None },
    Pen { color: "#12397a", width: 1.4, dash: None, dot: None },
];
