//! What the search found, as tables.

use super::Reconstruction;
use super::parameters::{Physical, QUANTITIES};
use super::search::SHAPELESS;
use crate::markdown::{significant, table};
use crate::paper::statements::STATEMENTS;

/// Significant digits of the best set's numbers.
const DIGITS: i32 = 3;

impl Reconstruction {
    /// Parameters without dimensions and how far they are determined.
    pub(crate) fn parameter_table(&self) -> String {
        let rows: Vec<[String; 3]> = (QUANTITIES.iter().zip(&self.ranges.0))
            .map(|(quantity, (low, high))| {
                let number = |value: f64, digits| {
                    format!("{} {}", significant(value, digits), quantity.unit).trim_end().to_owned()
                };
                let best = (quantity.value)(&self.search.best, &self.physical);
                let range = format!("{} … {}", significant(*low, 2), number(*high, 2));
                [quantity.name.to_owned(), number(best, DIGITS), range]
            })
            .collect();
        table(["", "best", "all statements hold for"], &rows)
    }

    /// The same with dimensions.
    pub(crate) fn physical_table(&self) -> String {
        let Physical { mass: [m1, m2], stiffness, damping, excitation, contact_stiffness, slip_force } =
            self.physical;
        let rows = [
            ("m1", m1, "kg"),
            ("m2", m2, "kg"),
            ("c1 = c2", stiffness, "N/m"),
            ("d", damping, "N s/m"),
            ("f̂", excitation, "N"),
            ("k_t", contact_stiffness, "N/m"),
            ("F_s", slip_force, "N"),
        ];
        let row = |(name, value, unit): (&str, f64, &str)| {
            [name.to_owned(), format!("{} {unit}", significant(value, DIGITS))]
        };
        table(["with W* = 8 µm and F* = 12 N", "in the scenes"], &rows.map(row))
    }

    /// Where the starts of the search ended.
    pub(crate) fn search_table(&self) -> String {
        let mut rows: Vec<[String; 4]> = Vec::new();
        let mut counted: Vec<(f64, usize, usize)> = Vec::new();
        for (i, cost) in self.search.costs.iter().enumerate() {
            match counted.iter_mut().find(|(other, ..)| (cost / other - 1.0).abs() < 1e-2) {
                Some((_, count, _)) => *count += 1,
                None => counted.push((*cost, 1, i)),
            }
        }
        for (cost, count, first) in counted {
            let end = &self.search.ends[first];
            let ratio = significant(end.mass_ratio, 2);
            let cost = if cost < SHAPELESS { significant(cost, 2) } else { "no such peaks".to_owned() };
            rows.push([count.to_string(), cost, ratio, significant(end.friction, 2)]);
        }
        table(["starts", "sum of squares", "m2/m1", "F*/(c1 W*)"], &rows)
    }
}

/// The two values of m2/m1 that give exactly the stated ratio of undamped resonances R = f2/f1 when c1 = c2: with
/// x = √(m2/m1), 2 x + 1/x = R + 1/R.
pub(crate) fn mass_ratios() -> String {
    let [first, second] = [STATEMENTS[0].stated, STATEMENTS[1].stated];
    let sum = second / first + first / second;
    let root = (sum * sum - 8.0).sqrt();
    let ratio = |sign: f64| significant(((sum + sign * root) / 4.0).powi(2), DIGITS);
    format!("{} or {}", ratio(-1.0), ratio(1.0))
}
