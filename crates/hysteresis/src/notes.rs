//! What a fit noticed and its user should know.

use std::fmt;

/// A remark about a fitted record: nothing that forbids its use, all that a careful engineer would want to
/// hear.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Branches before and after the steady cycles were left out.
    RunUpRunDown {
        /// Branches before.
        before: usize,
        /// Branches after.
        after: usize,
    },
    /// Only one cycle: no scatter between cycles, so noise is what the series cannot explain.
    SingleCycle,
    /// Which harmonics were kept.
    Harmonics {
        /// How many were kept.
        kept: usize,
        /// How many were looked at (1 to this one).
        considered: usize,
        /// Required ratio of a harmonic to its standard error.
        significance: f64,
    },
    /// The sampling determines fewer harmonics than were asked for.
    CoarseSampling {
        /// Highest harmonic it determines.
        harmonics: usize,
        /// Highest harmonic asked for.
        asked: usize,
    },
    /// The displacement turns back inside the cycle.
    InteriorReversals {
        /// Number of such turning points in the steady part.
        count: usize,
        /// Largest way back over the peak-to-peak displacement.
        largest: f64,
    },
    /// The displacement drifted; the drift was removed.
    DisplacementDrift {
        /// Drift over the steady part relative to the amplitude.
        relative: f64,
    },
    /// The force drifted; the drift was removed.
    ForceDrift {
        /// Drift over the steady part relative to |F_1|.
        relative: f64,
    },
    /// The loop is not symmetric about its centre.
    Asymmetric {
        /// Its even content relative to |F_1|.
        even_content: f64,
    },
    /// A plateau where the force passes through zero: clearance in the rig or the contact.
    Backlash {
        /// Width of the plateau \[m\], mean of both directions.
        width: f64,
    },
    /// The force scatters much more where the contact slides than where the force passes through zero.
    Chatter {
        /// Scatter relative to |F_1|.
        noise: f64,
        /// How many times larger the scatter is while sliding.
        ratio: f64,
    },
    /// The area of the raw curve and of the series differ.
    DissipationMismatch {
        /// Trapezoid rule over the raw samples \[J per cycle\].
        direct: f64,
        /// From the series \[J per cycle\].
        series: f64,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::RunUpRunDown { before, after } => write!(
                f,
                "what is not steady was left out: branches before the steady cycles {before}, after them {after}"
            ),
            Self::SingleCycle => f.write_str(
                "there is only one cycle, so the noise is what the series cannot explain; several cycles would tell noise from shape",
            ),
            Self::Harmonics { kept, considered, significance } => write!(
                f,
                "{kept} of {considered} harmonics were kept; the others do not rise above {significance} times their own noise"
            ),
            Self::CoarseSampling { harmonics, asked } => {
                write!(f, "the samples lie too far apart for {asked} harmonics; {harmonics} were looked at")
            }
            Self::InteriorReversals { count, largest } => write!(
                f,
                "the displacement turns back {count} times inside the steady cycles, by up to {:.1} % of its range; \
                 such minor loops are averaged into the main one",
                100.0 * largest
            ),
            Self::DisplacementDrift { relative } => write!(
                f,
                "the displacement drifts by {:.1} % of its amplitude over the steady cycles; the drift was removed",
                100.0 * relative
            ),
            Self::ForceDrift { relative } => write!(
                f,
                "the force drifts by {:.1} % of its first harmonic over the steady cycles; the drift was removed",
                100.0 * relative
            ),
            Self::Asymmetric { even_content } => write!(
                f,
                "the loop is not symmetric: its even harmonics amount to {:.1} % of the first",
                100.0 * even_content
            ),
            Self::Backlash { width } => write!(
                f,
                "the force stays near zero over {:.4e} m of each way: backlash; the series keeps it, a scaled loop would scale it too",
                width
            ),
            Self::Chatter { noise, ratio } => write!(
                f,
                "the force scatters by {:.1} % of its first harmonic, {ratio:.1} times as much while sliding as where it passes through zero: \
                 stick-slip chatter, averaged out of the series",
                100.0 * noise
            ),
            Self::DissipationMismatch { direct, series } => write!(
                f,
                "the raw curve encloses {direct:.4e} J a cycle but the series {series:.4e} J: \
                 the cycles differ, or the displacement is noisy where the force is steep"
            ),
        }
    }
}
