//! One axis: its range, its ticks, and where a value lies on it.

use std::sync::Arc;

use kuva::TickFormat;

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    /// Common logarithm, labelled with powers of ten.
    Decades,
}

/// An axis in *places*: the value times a unit factor, or its common logarithm.
#[derive(Debug, Clone)]
pub struct Axis {
    /// With the unit, `frequency (Hz)`.
    pub label: String,
    scale: Scale,
    /// Place = value · factor on a linear axis.
    factor: f64,
    /// Place of the first end.
    pub(super) low: f64,
    /// Place of the second end.
    pub(super) high: f64,
}

/// Most decades that all get a label.
const LABELLED_DECADES: f64 = 8.0;

impl Axis {
    /// From the least to the greatest of `values` without margin; like the others, `None` without a finite value.
    pub fn tight(label: String, values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = extent(values)?;
        let margin = if low < high { 0.0 } else { 0.05 * low.abs().max(1.0) };
        Some(Self { label, scale: Scale::Linear, factor: 1.0, low: low - margin, high: high + margin })
    }

    /// The same for numbers without a known unit: those that would be long are written in powers of a thousand, which the
    /// label names.
    pub fn counted(label: &str, values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut axis = Self::tight(label.to_owned(), values)?;
        let largest = axis.low.abs().max(axis.high.abs());
        if !(1e-2..1e4).contains(&largest) && largest > 0.0 {
            let exponent = 3 * (largest.log10() / 3.0).floor() as i32;
            axis.factor = 10_f64.powi(-exponent);
            (axis.low, axis.high) = (axis.low * axis.factor, axis.high * axis.factor);
            axis.label = format!("{label} (10{})", superscript(exponent));
        }
        Some(axis)
    }

    /// A linear axis with a margin of 6 %, in the SI multiple of `unit` that makes the numbers short.
    pub fn measured(quantity: &str, unit: &str, values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = extent(values)?;
        let largest = low.abs().max(high.abs());
        let (prefix, factor) = si_prefix(largest);
        let margin = if low < high { 0.06 * (high - low) } else { 0.5 * largest.max(f64::MIN_POSITIVE) };
        Some(Self {
            label: format!("{quantity} ({prefix}{unit})"),
            scale: Scale::Linear,
            factor,
            low: (low - margin) * factor,
            high: (high + margin) * factor,
        })
    }

    /// A logarithmic axis with a margin of 4 %, at least one whole decade; values that have no logarithm are left out.
    pub fn decades(label: String, values: impl Iterator<Item = f64>) -> Option<Self> {
        let logarithms = values.filter(|v| *v > 0.0).map(f64::log10);
        let (low, high) = extent(logarithms)?;
        let margin = 0.04 * (high - low).max(1.0);
        let (mut low, mut high) = (low - margin, high + margin);
        if high.floor() - low.ceil() < 1.0 {
            // Fewer than two powers of ten inside: take the neighbour that is nearer, then the other if need be.
            if low - low.floor() < high.ceil() - high {
                low = low.floor()
            } else {
                high = high.ceil()
            }
            if high.floor() - low.ceil() < 1.0 {
                (low, high) = (low.floor(), high.ceil());
            }
        }
        Some(Self { label, scale: Scale::Decades, factor: 1.0, low, high })
    }

    /// The place of a value; `None` where it has none (not finite, no logarithm).
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let place = match self.scale {
            Scale::Linear => value * self.factor,
            Scale::Decades if value > 0.0 => value.log10(),
            Scale::Decades => return None,
        };
        place.is_finite().then_some(place)
    }

    /// Distance of labelled ticks where it is not left to the drawing.
    pub(super) fn step(&self) -> Option<f64> {
        match self.scale {
            Scale::Linear => None,
            Scale::Decades => Some(((self.high - self.low) / LABELLED_DECADES).ceil().max(1.0)),
        }
    }

    /// Places of unlabelled ticks: 2 … 9 times a power of ten, or the powers between labelled ones.
    pub(super) fn minor_ticks(&self) -> Vec<f64> {
        let Some(step) = self.step() else { return Vec::new() };
        let decades = (self.low.floor() as i32)..=(self.high.ceil() as i32);
        let inside = |place: &f64| *place > self.low && *place < self.high;
        if step > 1.0 {
            return decades.map(f64::from).filter(inside).collect();
        }
        decades
            .flat_map(|decade| (2..10).map(move |n| f64::from(decade) + f64::from(n).log10()))
            .filter(inside)
            .collect()
    }

    /// How kuva writes a tick: powers of ten, a true minus sign.
    pub(super) fn format(&self) -> TickFormat {
        let scale = self.scale;
        TickFormat::Custom(Arc::new(move |place| match scale {
            Scale::Decades => format!("10{}", superscript(place.round() as i32)),
            Scale::Linear => TickFormat::Auto.format(place).replace('-', "\u{2212}"),
        }))
    }
}

/// Least and greatest of the finite values.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|v| v.is_finite()).fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((f64::min(low, v), f64::max(high, v))),
    })
}

/// SI prefix under which `largest` lies between 1 and 1000, and its factor.
fn si_prefix(largest: f64) -> (&'static str, f64) {
    const PREFIXES: [(&str, f64); 7] =
        [("G", 1e-9), ("M", 1e-6), ("k", 1e-3), ("", 1.0), ("m", 1e3), ("\u{b5}", 1e6), ("n", 1e9)];
    PREFIXES.into_iter().find(|(_, factor)| largest * factor >= 1.0).unwrap_or(("n", 1e9))
}

fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).and_then(|d| DIGITS.get(d as usize)).copied().unwrap_or('⁻');
    exponent.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_shows_two_powers_of_ten_at_least() {
        for (low, high) in [(2e-6, 5e-6), (9e-6, 1.1e-5), (1e-5, 1e-5), (3e-9, 2e-3)] {
            let axis = Axis::decades(String::new(), [low, high].into_iter()).unwrap();
            assert!(axis.high.floor() - axis.low.ceil() >= 1.0, "{low} … {high}: {axis:?}");
            assert!(axis.low < low.log10() && axis.high > high.log10());
        }
    }

    #[test]
    fn ticks_are_typeset() {
        let decades = Axis::decades(String::new(), [1e-12, 1.0].into_iter()).unwrap();
        assert_eq!(decades.format().format(-12.0), "10⁻¹²");
        let linear = Axis::measured("force", "N", [-12.0, 12.0].into_iter()).unwrap();
        assert_eq!(linear.format().format(-5.0), "−5");
        assert_eq!(linear.label, "force (N)");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(si_prefix(8e-6), ("µ", 1e6));
        assert_eq!(si_prefix(0.0381), ("m", 1e3));
        assert_eq!(si_prefix(1334.0), ("k", 1e-3));
        assert_eq!(si_prefix(0.0).0, "n");
    }

    #[test]
    fn long_numbers_are_counted_in_powers_of_a_thousand() {
        let axis = |low: f64, high: f64| Axis::counted("k", [low, high].into_iter()).unwrap();
        let stiff = axis(2e6, 7.5e6);
        assert_eq!((stiff.label.as_str(), stiff.place(5e6)), ("k (10⁶)", Some(5.0)));
        assert_eq!(axis(1e-6, 2e-5).label, "k (10⁻⁶)");
        assert_eq!((axis(5.0, 1200.0).label.as_str(), axis(0.0, 0.0).label.as_str()), ("k", "k"));
    }

    #[test]
    fn values_without_a_place_have_none() {
        let axis = Axis::decades(String::new(), [1.0, 0.0, f64::NAN].into_iter()).unwrap();
        assert_eq!(axis.place(0.0), None);
        assert_eq!(axis.place(-1.0), None);
        assert_eq!(axis.place(100.0), Some(2.0));
        assert!(Axis::decades(String::new(), [0.0, -1.0].into_iter()).is_none());
    }
}
