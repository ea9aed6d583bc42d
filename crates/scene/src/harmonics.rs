//! `harmonics`: N, or as many as each point needs; also in the short form `15` or `1e-6:63`.

use std::fmt;
use std::str::FromStr;

use hbm::Settings;

use crate::error::SceneError;
use crate::read::{Node, show};

pub(crate) const ADAPTIVE_KEYS: [&str; 2] = ["tolerance", "max"];

/// Harmonics beyond this are a slip of the pen.
pub(crate) const MOST_HARMONICS: usize = 4095;

/// How many harmonics the points of a sweep have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Harmonics {
    /// N at every point.
    All(usize),
    /// As many as each point needs.
    Needed {
        /// Relative l2 error of the displacement spectrum at which a point needs no more.
        tolerance: f64,
        /// The most a point may take.
        max: usize,
    },
}

impl Harmonics {
    /// The paper's method.
    pub(crate) const ONE: Self = Self::All(1);

    /// Reads N, or a tolerance and the most harmonics.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn read(node: &Node) -> Result<Self, SceneError> {
        if !node.is_object() {
            return node.whole(1, MOST_HARMONICS).map(Self::All);
        }
        let entry = node.object("tolerance and max", &ADAPTIVE_KEYS)?;
        let tolerance = entry.need("tolerance", "1e-6")?;
        let max = entry.need("max", "63, the most that a point may take")?.whole(1, MOST_HARMONICS)?;
        let error = tolerance.positive()?;
        if error >= 1.0 {
            let problem = format!("is a relative error and must be below 1, got {}", show(error));
            return Err(tolerance.error(problem));
        }
        Ok(Self::Needed { tolerance: error, max })
    }

    /// Checks numbers that do not come from a scene's text.
    pub(crate) fn check(self) -> Result<Self, SceneError> {
        let (Self::All(most) | Self::Needed { max: most, .. }) = self;
        if !(1..=MOST_HARMONICS).contains(&most) {
            let problem = format!("must be a whole number from 1 to {MOST_HARMONICS}, got {most}");
            return Err(SceneError::entry("harmonics", problem));
        }
        match self {
            Self::Needed { tolerance, .. } if !(tolerance > 0.0 && tolerance < 1.0) => {
                Err(SceneError::entry(
                    "harmonics",
                    format!("the tolerance is a relative error between 0 and 1, got {}", show(tolerance)),
                ))
            }
            good => Ok(good),
        }
    }

    /// Whether an estimate of the truncation error is made when nobody says: not where one harmonic is solved in closed
    /// form and nothing is known beyond it.
    fn estimated(self) -> bool {
        self != Self::ONE
    }

    /// Writes itself into the settings of the balance; `estimate` is what the scene says about it.
    pub(crate) fn apply(self, estimate: Option<bool>, settings: &mut Settings) {
        (settings.harmonics, settings.truncation) = match self {
            Self::All(n) => (n, None),
            Self::Needed { tolerance, max } => (max, Some(tolerance)),
        };
        settings.estimate = estimate.unwrap_or(self.estimated());
    }
}

impl From<usize> for Harmonics {
    fn from(n: usize) -> Self {
        Self::All(n)
    }
}

/// `15`, or `1e-6 (at most 63)`.
impl fmt::Display for Harmonics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All(n) => write!(f, "{n}"),
            Self::Needed { tolerance, max } => write!(f, "{} (at most {max})", show(*tolerance)),
        }
    }
}

/// Why a text is no number of harmonics.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}; write N, or TOLERANCE:MAX for as many as each point needs, for example 15 or 1e-6:63")]
pub struct BadHarmonics(String);

impl FromStr for Harmonics {
    type Err = BadHarmonics;

    /// Reads `N` or `TOLERANCE:MAX`. Whether the numbers can be is checked when a scene takes them.
    fn from_str(text: &str) -> Result<Self, BadHarmonics> {
        let whole = |text: &str| {
            text.trim().parse().map_err(|_| BadHarmonics(format!("{text:?} is no whole number of harmonics")))
        };
        let Some((tolerance, max)) = text.split_once(':') else {
            return whole(text).map(Self::All);
        };
        let max = whole(max)?;
        match tolerance.trim().parse() {
            Ok(tolerance) if f64::is_finite(tolerance) => Ok(Self::Needed { tolerance, max }),
            _ => Err(BadHarmonics(format!("{tolerance:?} is no relative error"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_form_means_the_same() {
        assert_eq!("7".parse(), Ok(Harmonics::All(7)));
        assert_eq!("1e-6:63".parse(), Ok(Harmonics::Needed { tolerance: 1e-6, max: 63 }));
        for text in ["", "x", "1.5", "1e-6:", ":63", "nan:63", "1e-6:63:7", "-1"] {
            let error = text.parse::<Harmonics>().unwrap_err().to_string();
            assert!(error.contains("TOLERANCE:MAX"), "{text}: {error}");
        }
        for text in ["0", "4096", "0:63", "1:63", "-1e-3:63", "1e-3:0"] {
            let error = text.parse::<Harmonics>().unwrap().check().unwrap_err().to_string();
            assert!(error.starts_with("harmonics: "), "{text}: {error}");
        }
    }

    #[test]
    fn an_estimate_is_made_where_more_than_the_first_harmonic_is_solved() {
        let estimate = |harmonics: Harmonics, wish| {
            let mut settings = Settings::new(1);
            harmonics.apply(wish, &mut settings);
            settings.estimate
        };
        assert!(!estimate(1.into(), None) && estimate(1.into(), Some(true)));
        assert!(estimate(3.into(), None) && !estimate(3.into(), Some(false)));
        assert!(estimate(Harmonics::Needed { tolerance: 1e-3, max: 1 }, None));
    }
}
