//! The two scenes that come out of the search, rounded to what is determined.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use super::parameters::Physical;
use crate::markdown::significant;
use crate::paper::statements::Comparison;

/// Significant digits of every reconstructed number.
const DIGITS: i32 = 3;

/// Texts of the scene files.
pub(crate) struct Scenes {
    hysteresis: String,
    coulomb: String,
}

/// Where the scenes are.
pub(crate) fn files(root: &Path) -> [PathBuf; 2] {
    ["hoffmann-2017.json", "hoffmann-2017-elastic-coulomb.json"].map(|name| root.join("scenes").join(name))
}

impl Scenes {
    pub(crate) fn of(physical: &Physical) -> Self {
        let loop_law = r#"{ "type": "scaled_loop", "loop": { "file": "loops/reference.csv" } }"#;
        let coulomb_law = format!(
            "{{ \"type\": \"elastic_coulomb\", \"stiffness\": {}, \"slip_force\": {} }}",
            significant(physical.contact_stiffness, DIGITS),
            significant(physical.slip_force, DIGITS)
        );
        Self {
            hysteresis: text(
                physical,
                "hoffmann-2017",
                "with the paper's contact law. The loop is synthetic, its force of 12 N is assumed; with one harmonic only its amplitudes matter.",
                loop_law,
            ),
            coulomb: text(
                physical,
                "hoffmann-2017-elastic-coulomb",
                "with elastic Coulomb friction tuned to the same static response of w2, the paper's comparison.",
                &coulomb_law,
            ),
        }
    }

    /// Writes both files; fails when a statement does not hold for what was written.
    pub(crate) fn write(&self, root: &Path) -> Result<()> {
        for (path, text) in files(root).iter().zip([&self.hysteresis, &self.coulomb]) {
            fs::write(path, text).with_context(|| path.display().to_string())?;
        }
        Comparison::of_scenes(&files(root))?.require()
    }

    /// Fails unless both files are what [`Scenes::write`] writes.
    pub(crate) fn check(&self, root: &Path) -> Result<()> {
        for (path, text) in files(root).iter().zip([&self.hysteresis, &self.coulomb]) {
            let written = fs::read_to_string(path).with_context(|| path.display().to_string())?;
            // A checkout may have changed line ends.
            let same = written.lines().eq(text.lines());
            ensure!(same, "{} is not what `cargo xtask reconstruct` writes", path.display());
        }
        Ok(())
    }
}

fn text(physical: &Physical, name: &str, what: &str, law: &str) -> String {
    let number = |value: f64| significant(value, DIGITS);
    let [m1, m2] = physical.mass.map(number);
    let (d, c, amplitude) =
        (number(physical.damping), number(physical.stiffness), number(physical.excitation));
    // Twice the rounded one, so that c1 = c2 exactly.
    let both = significant(2.0 * c.parse().unwrap_or(physical.stiffness), DIGITS + 1);
    format!(
        r#"{{
  "comment": "Blade root w1 and blade w2 of Hoffmann, Panning-von Scheidt and Wallaschek (2017), Fig. 1, {what} The paper prints no parameters: these are reconstructed from its statements about Fig. 4, written by `cargo xtask reconstruct`. They are not the paper's values.",
  "name": "{name}",
  "model": {{
    "dofs": ["w1", "w2"],
    "mass": [[{m1}, 0.0], [0.0, {m2}]],
    "damping": [[{d}, 0.0], [0.0, {d}]],
    "stiffness": [[{both}, -{c}], [-{c}, {c}]]
  }},
  "excitation": [{{ "dof": "w2", "harmonic": 1, "amplitude": {amplitude}, "phase": 0.0 }}],
  "contacts": [
    {{
      "name": "root",
      "between": ["w1", "ground"],
      "law": {law}
    }}
  ],
  "frequencies": {{ "from": 1.0, "to": 200.0, "points": 797 }},
  "harmonics": 1,
  "output": ["w1", "w2"]
}}
"#
    )
}
