//! How the cases ended, by family.

use anyhow::{Result, ensure};

use super::SOLVED;
use super::case::Label;
use super::families::FAMILIES;
use super::run::{Ending, Record};
use crate::markdown;

/// Counts of one family.
#[derive(Debug, Clone, Default)]
struct Counts {
    cases: usize,
    solvable: usize,
    solved: usize,
    stuck: usize,
    refused: usize,
    failed: usize,
    wrong: usize,
    panicked: usize,
    backward: f64,
    slowest: f64,
}

/// All families, and their sum.
pub(super) struct Table {
    rows: Vec<(&'static str, Counts)>,
    all: Counts,
}

impl Counts {
    fn add(&mut self, record: &Record) {
        self.cases += 1;
        self.solvable += usize::from(record.label == Label::Solvable);
        self.slowest = self.slowest.max(record.seconds);
        match &record.ending {
            Ending::Solved(margin) => {
                self.solved += 1;
                self.backward = self.backward.max(margin.backward);
            }
            Ending::Stuck(margin) => {
                self.stuck += 1;
                self.backward = self.backward.max(margin.backward);
            }
            Ending::Refused(_) => self.refused += 1,
            Ending::Failed(_) => self.failed += 1,
            Ending::Wrong(_) => self.wrong += 1,
            Ending::Panicked(_) => self.panicked += 1,
        }
    }

    fn cells(&self, name: &str) -> [String; 11] {
        [
            name.to_owned(),
            self.cases.to_string(),
            self.solvable.to_string(),
            self.solved.to_string(),
            self.stuck.to_string(),
            self.refused.to_string(),
            self.failed.to_string(),
            self.wrong.to_string(),
            self.panicked.to_string(),
            format!("{:.0e}", self.backward),
            format!("{:.3}", self.slowest),
        ]
    }
}

impl Table {
    pub(super) fn of(records: &[Record]) -> Self {
        let mut rows: Vec<(&'static str, Counts)> =
            FAMILIES.iter().map(|family| (family.name, Counts::default())).collect();
        let mut all = Counts::default();
        for record in records {
            all.add(record);
            if let Some((_, counts)) = rows.iter_mut().find(|(name, _)| *name == record.family) {
                counts.add(record);
            }
        }
        Self { rows, all }
    }

    /// The table as Markdown.
    pub(super) fn markdown(&self) -> String {
        let head = [
            "family",
            "cases",
            "solvable",
            "solved",
            "stuck",
            "refused",
            "failed",
            "wrong",
            "panicked",
            "residual",
            "slowest, s",
        ];
        let rows: Vec<[String; 11]> = self
            .rows
            .iter()
            .map(|(name, counts)| counts.cells(name))
            .chain([self.all.cells("**all**")])
            .collect();
        markdown::table(head, &rows)
    }

    /// Fails unless nothing is wrong, nothing panicked, and what can be solved is.
    pub(super) fn check(&self) -> Result<()> {
        let Counts { wrong, panicked, failed, solvable, .. } = self.all;
        ensure!(wrong == 0, "{wrong} reported solutions are none");
        ensure!(panicked == 0, "{panicked} cases panicked");
        let most = (solvable as f64 * (1.0 - SOLVED)).floor() as usize;
        ensure!(failed <= most, "{failed} of {solvable} solvable cases failed, more than {most}");
        Ok(())
    }
}
