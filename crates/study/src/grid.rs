//! A study: a grid over entries of a scene and numbers of harmonics, and what is kept of each case.

use std::path::{Path, PathBuf};

use scene::reading::{Node, Object, parse, show};
use scene::{Frequencies, Harmonics, Scene, SceneError, Variants};

use crate::axis::Axis;
use crate::error::StudyError;
use crate::fingerprint::Fingerprint;

pub(crate) const KEYS: [&str; 7] = ["name", "scene", "vary", "harmonics", "frequencies", "output", "keep"];

/// What is kept of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// Every point of the response.
    Points,
    /// The maxima of the response.
    Peaks,
}

/// A study that was read and checked.
#[derive(Debug)]
pub struct Study {
    name: String,
    variants: Variants,
    axes: Vec<Axis>,
    harmonics: Vec<Harmonics>,
    keep: Keep,
    frequencies: Option<Frequencies>,
    output: Option<Vec<String>>,
    /// Output dofs of the first case, and so of all.
    dofs: Vec<String>,
    points: usize,
    fingerprint: Fingerprint,
    /// The scene's file.
    scene: PathBuf,
}

/// One case: the values of the varied entries, in the order of the axes, and its harmonics.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// One value an axis.
    pub values: Vec<f64>,
    /// How many harmonics.
    pub harmonics: Harmonics,
}

/// More cases than this are a slip of the pen.
const MOST_CASES: usize = 10_000_000;

/// More rows than this do not fit.
const MOST_ROWS: usize = 10_000_000;

impl Study {
    /// Reads a study's file; the scene's name is relative to it.
    ///
    /// # Errors
    /// [`StudyError`] with what is wrong, and where.
    pub fn from_file(path: &Path) -> Result<Self, StudyError> {
        let unreadable = |source| StudyError::Unreadable { path: path.to_owned(), source };
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Self::from_str(&text, path.parent().unwrap_or(Path::new("")), &name)
    }

    /// Reads a study's text; the scene's name is relative to `base`, `name` is for studies without one.
    ///
    /// # Errors
    /// [`StudyError`] with what is wrong, and where.
    pub fn from_str(text: &str, base: &Path, name: &str) -> Result<Self, StudyError> {
        let json = parse(text).map_err(StudyError::Study)?;
        let entries =
            Node::root(&json).object("scene, vary, harmonics, keep", &KEYS).map_err(StudyError::Study)?;
        let wishes = Wishes::read(&entries).map_err(StudyError::Study)?;
        let path = base.join(&wishes.scene);
        let in_scene = |error: SceneError| match error {
            SceneError::Unreadable { .. } => StudyError::Study(SceneError::entry("scene", error.to_string())),
            error => StudyError::InScene { path: path.clone(), error },
        };
        let variants = Variants::from_file(&path).map_err(in_scene)?;
        for axis in &wishes.axes {
            let refused =
                |problem| StudyError::Study(SceneError::entry(&format!("vary.{}", axis.pointer), problem));
            variants.number(&axis.pointer).map_err(refused)?;
            if let Some(problem) = wishes.overrides(&axis.pointer) {
                return Err(refused(problem));
            }
        }
        let mut study = Self {
            name: wishes.name.unwrap_or_else(|| name.to_owned()),
            variants,
            axes: wishes.axes,
            harmonics: wishes.harmonics,
            keep: wishes.keep,
            frequencies: wishes.frequencies,
            output: wishes.output,
            dofs: Vec::new(),
            points: 0,
            fingerprint: Fingerprint::default(),
            scene: path.clone(),
        };
        study.check(&path)?;
        study.fingerprint = Fingerprint::of(text, &path, &study.variants.files());
        Ok(study)
    }

    /// Checks sizes, and the values of every axis once, the others being at their first.
    fn check(&mut self, path: &Path) -> Result<(), StudyError> {
        let scene =
            self.variants.scene(&[]).map_err(|error| StudyError::InScene { path: path.to_owned(), error })?;
        if self.harmonics.is_empty() {
            self.harmonics.push(scene.harmonics());
        }
        let lengths = self.axes.iter().map(|axis| axis.values.len()).chain([self.harmonics.len()]);
        let cases = lengths.fold(1, usize::saturating_mul);
        if cases > MOST_CASES {
            let problem =
                format!("makes {cases} cases with the harmonics, more than {MOST_CASES}; take fewer points");
            return Err(StudyError::Study(SceneError::entry("vary", problem)));
        }
        let first = self.solvable(0)?;
        self.dofs = first.output().into_iter().map(str::to_owned).collect();
        self.points = first.frequencies().as_slice().len();
        let kept = if self.keep == Keep::Points { self.points } else { 1 };
        let rows = cases.saturating_mul(kept).saturating_mul(self.dofs.len());
        if rows > MOST_ROWS {
            let problem = format!(
                "{cases} cases with {kept} points and {} dofs make {rows} rows, more than {MOST_ROWS}; take fewer \
                 points, or keep \"peaks\"",
                self.dofs.len()
            );
            return Err(StudyError::Study(SceneError::entry("keep", problem)));
        }
        let mut stride = cases;
        for axis in &self.axes {
            stride /= axis.values.len();
            for i in worth_trying(&axis.values) {
                self.solvable(i * stride)?;
            }
        }
        for i in 1..self.harmonics.len() {
            self.solvable(i)?;
        }
        Ok(())
    }

    /// The scene of a case, which can be planned.
    fn solvable(&self, index: usize) -> Result<Scene, StudyError> {
        let scene = self.scene(index)?;
        match scene.prepare() {
            Ok(_) => {}
            Err(error) => return Err(self.in_case(index, error)),
        }
        Ok(scene)
    }

    pub(crate) fn in_case(&self, index: usize, error: SceneError) -> StudyError {
        let case = self.case(index);
        let values = self
            .axes
            .iter()
            .zip(&case.values)
            .map(|(axis, value)| format!("{} = {}", axis.pointer, show(*value)));
        let mut words: Vec<String> = values.collect();
        words.push(format!("harmonics = {}", case.harmonics));
        StudyError::Case { case: words.join(", "), error }
    }

    /// The scene of a case.
    ///
    /// # Errors
    /// When its values make no scene.
    pub fn scene(&self, index: usize) -> Result<Scene, StudyError> {
        let case = self.case(index);
        let changes: Vec<(&str, f64)> =
            self.axes.iter().map(|axis| axis.pointer.as_str()).zip(case.values).collect();
        let build = || -> Result<Scene, SceneError> {
            let mut scene = self.variants.scene(&changes)?.with_harmonics(case.harmonics)?;
            if let Some(frequencies) = &self.frequencies {
                scene = scene.with_frequencies(frequencies.clone());
            }
            match &self.output {
                Some(names) => scene.with_output(names),
                None => Ok(scene),
            }
        };
        build().map_err(|error| self.in_case(index, error))
    }

    /// How many cases there are.
    pub fn cases(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product::<usize>() * self.harmonics.len()
    }

    /// A case by its number: the first axis is the slowest, harmonics are the fastest.
    pub fn case(&self, index: usize) -> Case {
        let count = self.harmonics.len().max(1);
        let harmonics = self.harmonics.get(index % count).copied().unwrap_or(Harmonics::All(1));
        let mut rest = index / count;
        let mut values: Vec<f64> = Vec::with_capacity(self.axes.len());
        for axis in self.axes.iter().rev() {
            values.extend(axis.values.get(rest % axis.values.len()));
            rest /= axis.values.len();
        }
        values.reverse();
        Case { values, harmonics }
    }

    /// The study's name; that of its file when it has none.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What is varied.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The numbers of harmonics.
    pub fn harmonics(&self) -> &[Harmonics] {
        &self.harmonics
    }

    /// What is kept.
    pub fn keep(&self) -> Keep {
        self.keep
    }

    /// The output dofs.
    pub fn dofs(&self) -> &[String] {
        &self.dofs
    }

    /// Frequencies of a case.
    pub fn points(&self) -> usize {
        self.points
    }

    /// The files it reads: its scene and the records of that.
    pub fn files(&self) -> Vec<PathBuf> {
        std::iter::once(self.scene.clone()).chain(self.variants.files()).collect()
    }

    /// Names the text of the study, its scene and its records.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }
}

/// Up to this many values of an axis are all tried before anything is solved.
const TRIED: usize = 1000;

/// Positions of the values that are tried: all of a few, of many the extremes.
fn worth_trying(values: &[f64]) -> Vec<usize> {
    if values.len() <= TRIED {
        return (1..values.len()).collect();
    }
    let positions = || values.iter().enumerate();
    let least = positions().min_by(|a, b| a.1.total_cmp(b.1));
    let most = positions().max_by(|a, b| a.1.total_cmp(b.1));
    [least, most].into_iter().flatten().map(|(i, _)| i).collect()
}

/// What a study's text says.
struct Wishes {
    name: Option<String>,
    scene: String,
    axes: Vec<Axis>,
    harmonics: Vec<Harmonics>,
    keep: Keep,
    frequencies: Option<Frequencies>,
    output: Option<Vec<String>>,
}

impl Wishes {
    /// Why an entry of the scene cannot be varied: the study decides it, and the values would do nothing.
    fn overrides(&self, pointer: &str) -> Option<String> {
        let within = |part: &str| {
            pointer.strip_prefix(part).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        if within("/harmonics") {
            Some("is not varied here; write \"harmonics\": [1, 3, 7] beside \"vary\"".into())
        } else if within("/frequencies") && self.frequencies.is_some() {
            Some(
                "would change nothing: the study has \"frequencies\" of its own; leave one of them out"
                    .into(),
            )
        } else {
            None
        }
    }

    fn read(entries: &Object) -> Result<Self, SceneError> {
        let vary = entries
            .need("vary", "{\"/excitation/0/amplitude\": {\"from\": 1, \"to\": 10, \"points\": 10}}")?;
        let axis = |(pointer, node): (&str, Node)| Axis::read(pointer, &node);
        let axes = vary.any_object("JSON pointers into the scene and their values")?.members().map(axis);
        let harmonics = match entries.get("harmonics") {
            Some(list) if list.is_list() => {
                list.some("of harmonics")?.iter().map(Harmonics::read).collect::<Result<_, _>>()?
            }
            Some(one) => vec![Harmonics::read(&one)?],
            None => Vec::new(),
        };
        let names = |node: Node| -> Result<Vec<String>, SceneError> {
            let items = node.some("of names of dofs")?;
            items.iter().map(|item| Ok(item.text("the name of a dof")?.to_owned())).collect()
        };
        Ok(Self {
            name: entries.get("name").map(|node| Ok(node.text("a name")?.to_owned())).transpose()?,
            scene: entries.need("scene", "\"scene.json\"")?.text("the name of a scene's file")?.to_owned(),
            axes: axes.collect::<Result<_, SceneError>>()?,
            harmonics,
            keep: entries
                .need("keep", "\"peaks\" or \"points\"")?
                .choice(&[("points", Keep::Points), ("peaks", Keep::Peaks)])?,
            frequencies: entries.get("frequencies").map(|node| Frequencies::read(&node)).transpose()?,
            output: entries.get("output").map(names).transpose()?,
        })
    }
}
