//! Units of a record's columns and their size in SI units.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A unit that is not one of those a record may be in.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{found}` is no unit of {dimension} known here; known are {known} (capitals matter)")]
pub struct UnknownUnit {
    /// What was found.
    pub found: String,
    /// What should be measured in it: length, force or time.
    pub dimension: &'static str,
    /// The units that would have been understood.
    pub known: &'static str,
}

macro_rules! unit {
    ($(#[$meta:meta])* $name:ident, $dimension:literal, $known:literal,
     { $($(#[$variant_meta:meta])* $variant:ident = $si:literal, $symbol:literal $(| $alias:literal)*;)* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub enum $name { $($(#[$variant_meta])* $variant,)* }

        impl $name {
            /// Every unit of this kind.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// How many SI units (m, N or s) one of this unit is.
            #[must_use]
            pub fn in_si(self) -> f64 {
                match self { $(Self::$variant => $si,)* }
            }

            /// The symbol as written in a header.
            #[must_use]
            pub fn symbol(self) -> &'static str {
                match self { $(Self::$variant => $symbol,)* }
            }
        }

        impl FromStr for $name {
            type Err = UnknownUnit;

            fn from_str(text: &str) -> Result<Self, UnknownUnit> {
                // Both micro signs: U+00B5 (on keyboards) and U+03BC (Greek letter mu).
                let plain = text.trim().replace(['\u{b5}', '\u{3bc}'], "u");
                match plain.as_str() {
                    $($symbol $(| $alias)* => Ok(Self::$variant),)*
                    _ => Err(UnknownUnit { found: text.trim().to_owned(), dimension: $dimension, known: $known }),
                }
            }
        }

        impl TryFrom<String> for $name {
            type Error = UnknownUnit;

            fn try_from(text: String) -> Result<Self, UnknownUnit> {
                text.parse()
            }
        }

        impl From<$name> for String {
            fn from(unit: $name) -> Self {
                unit.symbol().to_owned()
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.symbol())
            }
        }
    };
}

unit! {
    /// Unit of a displacement.
    LengthUnit, "length", "m, mm, um, µm, nm, in", {
        /// Metre.
        Metre = 1.0, "m";
        /// Millimetre.
        Millimetre = 1e-3, "mm";
        /// Micrometre, written um, µm (U+00B5) or μm (U+03BC).
        Micrometre = 1e-6, "um";
        /// Nanometre.
        Nanometre = 1e-9, "nm";
        /// International inch, 25.4 mm exactly.
        Inch = 0.0254, "in" | "inch";
    }
}

unit! {
    /// Unit of a force.
    ForceUnit, "force", "N, mN, kN, lbf, kip", {
        /// Newton.
        Newton = 1.0, "N";
        /// Millinewton.
        Millinewton = 1e-3, "mN";
        /// Kilonewton.
        Kilonewton = 1e3, "kN";
        /// Pound-force: 0.45359237 kg × 9.80665 m/s².
        PoundForce = 4.448_221_615_260_5, "lbf";
        /// Kip: 1000 pounds-force.
        Kip = 4_448.221_615_260_5, "kip" | "kips";
    }
}

unit! {
    /// Unit of time.
    TimeUnit, "time", "s, ms", {
        /// Second.
        Second = 1.0, "s" | "sec";
        /// Millisecond.
        Millisecond = 1e-3, "ms";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_is_read_back_as_its_own_unit() {
        for &unit in LengthUnit::ALL {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
        for &unit in ForceUnit::ALL {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
        for &unit in TimeUnit::ALL {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
    }

    #[test]
    fn both_micro_signs_are_micrometres() {
        assert_eq!("\u{b5}m".parse(), Ok(LengthUnit::Micrometre));
        assert_eq!("\u{3bc}m".parse(), Ok(LengthUnit::Micrometre));
    }

    #[test]
    fn customary_units_have_their_defined_size() {
        let pound_force = 0.453_592_37 * 9.806_65;
        assert!((ForceUnit::PoundForce.in_si() - pound_force).abs() < 1e-15 * pound_force);
        assert!((ForceUnit::Kip.in_si() - 1000.0 * pound_force).abs() < 1e-12);
        assert!((LengthUnit::Inch.in_si() - 0.0254).abs() < 1e-18);
    }

    #[test]
    fn capitals_matter_and_the_error_lists_what_is_known() {
        let error = "MN".parse::<ForceUnit>().unwrap_err();
        assert!(error.to_string().contains("N, mN, kN, lbf, kip"), "{error}");
        assert!("N".parse::<LengthUnit>().is_err());
    }
}
