//! The paper's statements about its Fig. 4, each with what it allows, against what a pair of scenes gives.

use std::path::Path;

use anyhow::{Context, Result, bail};
use hbm::Problem;
use scene::Scene;

use super::reading::{Agreement, BLADE, ROOT, Reading};
use crate::markdown::{signed, table};

/// One number that the paper prints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Statement {
    /// What it is about.
    pub(crate) about: &'static str,
    /// The paper's words or nearly so.
    pub(crate) words: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) stated: f64,
    /// How far a reconstruction may be off: half the last printed digit, or more where the number was read off a curve.
    pub(crate) tolerance: f64,
    /// The value of a pair of scenes.
    pub(crate) value: fn(&Reading) -> f64,
}

/// Every number about Fig. 4.
pub(crate) const STATEMENTS: [Statement; 8] = [
    Statement {
        about: "first linear resonance",
        words: "two resonance frequencies at 43 Hz …",
        unit: "Hz",
        stated: 43.0,
        tolerance: 0.5,
        value: |r| r.linear_first.frequency,
    },
    Statement {
        about: "second linear resonance",
        words: "… and 108 Hz",
        unit: "Hz",
        stated: 108.0,
        tolerance: 0.7,
        value: |r| r.linear_second.frequency,
    },
    Statement {
        about: "hysteresis model, first resonance of m2 lower by",
        words: "reduced by 96%",
        unit: "%",
        stated: 96.0,
        tolerance: 0.5,
        value: |r| 100.0 * (1.0 - r.first.amplitude / r.linear_first.amplitude),
    },
    Statement {
        about: "hysteresis model, first resonance of m2 moved by",
        words: "a frequency shift by 15 Hz",
        unit: "Hz",
        stated: 15.0,
        tolerance: 0.7,
        value: |r| r.first.frequency - r.linear_first.frequency,
    },
    Statement {
        about: "hysteresis model, second resonance of m2 lower by",
        words: "reduced by 72%",
        unit: "%",
        stated: 72.0,
        tolerance: 1.0,
        value: |r| 100.0 * (1.0 - r.second.amplitude / r.linear_second.amplitude),
    },
    Statement {
        about: "hysteresis model, second resonance of m2 moved by",
        words: "without a frequency shift",
        unit: "Hz",
        stated: 0.0,
        tolerance: 1.0,
        value: |r| r.second.frequency - r.linear_second.frequency,
    },
    Statement {
        about: "elastic Coulomb, slip begins at",
        words: "a sharp bend at 55 Hz …",
        unit: "Hz",
        stated: 55.0,
        tolerance: 1.0,
        value: |r| r.slip.0,
    },
    Statement {
        about: "elastic Coulomb, slip ends at",
        words: "… and 118 Hz",
        unit: "Hz",
        stated: 118.0,
        tolerance: 1.5,
        value: |r| r.slip.1,
    },
];

impl Statement {
    pub(crate) fn deviation(&self, reading: &Reading) -> f64 {
        (self.value)(reading) - self.stated
    }

    pub(crate) fn holds(&self, reading: &Reading) -> bool {
        self.deviation(reading).abs() <= self.tolerance
    }
}

/// Elastic Coulomb is "tuned to fit the static response of m2": the ratio of the two models' static |W_1| of m2 may
/// differ from one by this.
pub(crate) const STATIC_TOLERANCE: f64 = 0.005;

/// Where "both models also agree quantitatively well", and the part of it where both slip, in Hz.
pub(crate) const AGREE: [(f64, f64); 2] = [(60.0, 120.0), (65.0, 110.0)];

/// Every statement against its value.
pub(crate) struct Comparison {
    pub(crate) reading: Reading,
    /// Of m1 and m2 in each of [`AGREE`].
    pub(crate) agreement: Vec<(String, Agreement)>,
}

impl Comparison {
    pub(crate) fn of(hysteresis: &Problem, coulomb: &Problem) -> Result<Self> {
        let reading = Reading::of(hysteresis, coulomb)?
            .context("the response has not the peaks that the paper describes")?;
        let mut agreement = Vec::new();
        for (from, to) in AGREE {
            for (mass, output) in [("m1", ROOT), ("m2", BLADE)] {
                let agrees = Agreement::of(hysteresis, coulomb, output, (from, to), 0.1)?;
                agreement.push((format!("{mass}, {from} Hz to {to} Hz"), agrees));
            }
        }
        Ok(Self { reading, agreement })
    }

    /// From the files of the hysteresis scene and the elastic Coulomb scene.
    pub(crate) fn of_scenes(files: &[impl AsRef<Path>; 2]) -> Result<Self> {
        let [hysteresis, coulomb] =
            [Scene::from_file(files[0].as_ref())?, Scene::from_file(files[1].as_ref())?];
        Self::of(hysteresis.problem()?, coulomb.problem()?)
    }

    /// Static |W_1| of m2, elastic Coulomb over hysteresis model, minus one.
    fn static_deviation(&self) -> f64 {
        let (hysteresis, coulomb) = self.reading.static_amplitudes;
        coulomb / hysteresis - 1.0
    }

    /// Fails when a statement does not hold, and says which.
    pub(crate) fn require(&self) -> Result<()> {
        let missed: Vec<String> = (STATEMENTS.iter().filter(|s| !s.holds(&self.reading)))
            .map(|s| {
                format!(
                    "{}: {:.3} {}, not {} ± {}",
                    s.about,
                    (s.value)(&self.reading),
                    s.unit,
                    s.stated,
                    s.tolerance
                )
            })
            .collect();
        if !missed.is_empty() {
            bail!("the paper's statements do not hold: {}", missed.join("; "));
        }
        if self.static_deviation().abs() > STATIC_TOLERANCE {
            bail!("the static responses of m2 differ by {:.2} %", 100.0 * self.static_deviation());
        }
        Ok(())
    }

    /// The statements as a table.
    pub(crate) fn table(&self) -> String {
        let mut rows: Vec<[String; 5]> = STATEMENTS
            .iter()
            .map(|s| {
                let value = (s.value)(&self.reading);
                [
                    s.about.to_owned(),
                    format!("“{}”", s.words),
                    format!("{value:.2} {}", s.unit).replace('-', "−"),
                    signed(s.deviation(&self.reading), 2),
                    format!("± {}", s.tolerance),
                ]
            })
            .collect();
        rows.push([
            "elastic Coulomb, static response of m2".to_owned(),
            "“tuned to fit the static response of m2”".to_owned(),
            format!("{:.4} of it", 1.0 + self.static_deviation()),
            signed(self.static_deviation(), 4),
            format!("± {STATIC_TOLERANCE}"),
        ]);
        table(["Fig. 4", "the paper", "reproduced", "deviation", "tolerance"], &rows)
    }

    /// How well the two models agree, in words with numbers.
    pub(crate) fn agreement_table(&self) -> String {
        let percent = |value: f64| format!("{:.0} %", 100.0 * value);
        let row = |(what, a): &(String, Agreement)| {
            [what.clone(), percent(a.median), percent(a.largest), format!("{:.0} Hz", a.at)]
        };
        let rows: Vec<_> = self.agreement.iter().map(row).collect();
        table(["difference of |W₁|", "median", "largest", "at"], &rows)
    }
}
