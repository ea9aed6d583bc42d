//! The report: results one after the other, then what their scenes add.

use scene::{Frequencies, Harmonics, Prepared, RecordedPoint, Scene};

use crate::data::{Page, Points, Shown};
use crate::document;
use crate::error::ReportError;
use crate::motion::{self, Check, Periods};
use crate::recorded::{Kind, Recorded, RecordedLine};
use crate::source::Source;
use crate::summary;

/// Texts of scenes longer than this are left out of the page.
const LONGEST_TEXT: usize = 100_000;

/// Results over one axis.
#[derive(Debug, Default)]
pub struct Report {
    results: Vec<Recorded>,
    shown: Vec<Shown>,
}

impl Report {
    /// Adds a result, called `label`.
    ///
    /// # Errors
    /// When it has no points, or does not fit over the axis of those before.
    pub fn add(&mut self, label: &str, recorded: Recorded) -> Result<(), ReportError> {
        if recorded.points.is_empty() {
            return Err(ReportError::Empty(label.to_owned()));
        }
        if let Some((first, before)) = self.shown.first().zip(self.results.first())
            && before.along() != recorded.along()
        {
            return Err(ReportError::Axes {
                first: first.label.clone(),
                along: before.along().to_owned(),
                second: label.to_owned(),
                other: recorded.along().to_owned(),
            });
        }
        let points = summary::points(&recorded);
        let peaks = summary::peak_lines(&recorded, &points);
        let motions = motion::by_series(&recorded, &marked(&recorded, &points));
        self.shown.push(Shown {
            label: label.to_owned(),
            scene: recorded.scene.clone(),
            kind: match recorded.kind {
                Kind::Sweep => "sweep",
                Kind::Curve => "curve",
                Kind::Mode => "mode",
            },
            parameter: summary::parameter(&recorded),
            dofs: recorded.dofs.clone(),
            harmonic: recorded.fundamental(),
            facts: summary::facts(&recorded),
            notes: recorded.notes.clone(),
            peaks,
            points,
            contacts: summary::contacts(&recorded),
            motions,
            plan: None,
            scene_text: None,
        });
        self.results.push(recorded);
        Ok(())
    }

    /// Adds what a scene says about its results, those that bear its name: the plan, the response without contacts, and
    /// loops with the forces of the laws.
    ///
    /// # Errors
    /// When there is no such result, the scene cannot be posed, or a result is not one of this scene.
    pub fn explain(&mut self, source: &Source) -> Result<(), ReportError> {
        let name = source.scene.name();
        if !self.shown.iter().any(|shown| shown.scene == name) {
            let mut results: Vec<&str> = self.shown.iter().map(|shown| shown.scene.as_str()).collect();
            results.dedup();
            let results = results.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
            return Err(ReportError::OtherScene { scene: name.to_owned(), results });
        }
        for (recorded, shown) in self.results.iter().zip(&mut self.shown) {
            if shown.scene == name {
                explain(source, recorded, shown)?;
            }
        }
        Ok(())
    }

    /// The page.
    ///
    /// # Errors
    /// Without a result, or in a program that was built without the page.
    pub fn html(&self) -> Result<String, ReportError> {
        document::fill(document::page().ok_or(ReportError::NoPage)?, self)
    }

    /// The data of the page, for other pages; its keys are those of `data.rs`.
    ///
    /// # Errors
    /// Without a result.
    pub fn json(&self) -> Result<String, ReportError> {
        self.title()?;
        let page = Page { version: env!("CARGO_PKG_VERSION"), results: &self.shown };
        Ok(serde_json::to_string(&page)?)
    }

    /// The name of the first scene.
    pub(crate) fn title(&self) -> Result<&str, ReportError> {
        Ok(&self.shown.first().ok_or(ReportError::Nothing)?.scene)
    }
}

/// Points that are worth a period whatever is left out: folds, peaks, and the highest point of every dof.
fn marked(recorded: &Recorded, points: &Points) -> impl Fn(usize) -> bool {
    let highest = points.amplitude.iter().filter_map(|row| {
        let known = row.iter().enumerate().filter_map(|(index, amplitude)| Some((index, (*amplitude)?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(index, _)| index)
    });
    let named = |point: &RecordedLine| point.fold || !point.peaks.is_empty();
    let named = recorded.points.iter().enumerate().filter(|(_, point)| named(point)).map(|(index, _)| index);
    let marked: Vec<usize> = highest.chain(named).collect();
    move |index| marked.contains(&index)
}

fn explain(source: &Source, recorded: &Recorded, shown: &mut Shown) -> Result<(), ReportError> {
    let label = shown.label.clone();
    let mismatch = |mismatch| ReportError::Mismatch { label: label.clone(), mismatch };
    let scene = as_solved(source.scene.clone(), recorded, &shown.label)?;
    let prepared = scene.prepare()?;
    let along_entry = recorded.along() != "frequency";

    let mut periods = Periods::new(recorded, instants(recorded, &prepared), "law");
    let chosen = periods.choose(recorded, &marked(recorded, &shown.points));
    let compared = motion::compared(&chosen);
    for index in chosen {
        let Some((line, point)) = recorded.points.get(index).and_then(|line| Some((line, line.motion()?)))
        else {
            continue;
        };
        let check = compared.contains(&index).then_some(Check { structure: recorded.kind != Kind::Mode });
        let mut add = |point: &RecordedPoint, prepared: &Prepared| {
            motion::by_law(&mut periods, index, point, prepared, check).map_err(mismatch)
        };
        if along_entry {
            let variant = source.variants.scene(&[(recorded.along(), line.place())])?;
            let variant = as_solved(variant, recorded, &shown.label)?;
            add(&point, &variant.prepare()?)?;
        } else {
            add(&point, &prepared)?;
        }
    }
    shown.motions = periods.finish();
    if !along_entry && recorded.kind != Kind::Mode {
        shown.points.linear = linear(recorded, &prepared, shown.harmonic);
        shown.peaks = summary::peak_lines(recorded, &shown.points);
    }
    shown.plan = Some(prepared.explain());
    shown.scene_text = Some(match source.text.len() {
        0..=LONGEST_TEXT => source.text.clone(),
        length => format!("(the scene's file has {length} bytes and is not shown)"),
    });
    Ok(())
}

/// The scene with dofs, harmonics and frequencies of a result.
fn as_solved(scene: Scene, recorded: &Recorded, label: &str) -> Result<Scene, ReportError> {
    let most = recorded.harmonics();
    let (Harmonics::All(own) | Harmonics::Needed { max: own, .. }) = scene.harmonics();
    let kept = match scene.harmonics() {
        Harmonics::All(own) => own == most,
        Harmonics::Needed { .. } => own >= most,
    };
    let scene = if kept { scene } else { scene.with_harmonics(most)? };
    let frequencies = match recorded.kind {
        // What is left out of a large structure depends on the range alone.
        Kind::Sweep => recorded.points.iter().map(|point| point.frequency).collect(),
        Kind::Curve | Kind::Mode => {
            let all = || recorded.points.iter().map(|point| point.frequency);
            vec![all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
        }
    };
    let problem = |problem| ReportError::Frequencies { label: label.to_owned(), problem };
    let scene = scene.with_frequencies(Frequencies::list(frequencies).map_err(problem)?);
    if recorded.kind == Kind::Mode { Ok(scene.with_output(&recorded.dofs)?) } else { Ok(scene) }
}

/// How many instants the plan's periods have.
fn instants(recorded: &Recorded, prepared: &Prepared) -> usize {
    let motion = recorded.points.iter().find_map(RecordedLine::motion);
    let solution = motion.and_then(|motion| prepared.recall(&motion).ok());
    let wave = solution.and_then(|solution| prepared.plan().waveform(&solution, motion::SAMPLES));
    wave.map_or(motion::SAMPLES, |wave| wave.phase.len())
}

/// Amplitudes without contacts, `[dof][point]`.
fn linear(recorded: &Recorded, prepared: &Prepared, harmonic: usize) -> Option<Vec<Vec<Option<f64>>>> {
    let plan = prepared.plan();
    let column = plan.orders().iter().position(|order| *order == harmonic)?;
    let mut workspace = plan.workspace();
    let mut rows = vec![Vec::with_capacity(recorded.points.len()); recorded.dofs.len()];
    for point in &recorded.points {
        let response = plan.linear_response(point.frequency, &mut workspace).unwrap_or_default();
        for (dof, row) in rows.iter_mut().enumerate() {
            row.push(response.get(dof).and_then(|row| row.get(column)).map(|w| w.norm()));
        }
    }
    Some(rows)
}
