//! A scene: what is to be solved, read and checked.

use std::path::Path;
use std::time::{Duration, Instant};

use hbm::{Plan, Problem, Settings};

use crate::contacts;
use crate::error::SceneError;
use crate::excitation;
use crate::frequencies::Frequencies;
use crate::harmonics::Harmonics;
use crate::json::{self, Json};
use crate::model::{self, Dofs};
use crate::read::{Node, suggestion};
use crate::records::Records;
use crate::run::Prepared;
use crate::solver;

pub(crate) const KEYS: [&str; 8] =
    ["name", "model", "excitation", "contacts", "frequencies", "harmonics", "output", "solver"];

/// Up to this many dofs all are recovered when a scene does not say which.
const EVERY_OUTPUT: usize = 16;

/// A scene that was read and checked.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) name: String,
    pub(crate) dofs: Dofs,
    pub(crate) problem: Problem,
    pub(crate) settings: Settings,
    /// What `solver.estimate` says.
    estimate: Option<bool>,
    pub(crate) frequencies: Frequencies,
    pub(crate) notes: Vec<String>,
    read_in: Duration,
}

impl Scene {
    /// Reads a scene's file; names of files in it are relative to it.
    ///
    /// # Errors
    /// [`SceneError`] with what is wrong and where.
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        let mut scene = Self::from_str(&text, path.parent().unwrap_or(Path::new("")))?;
        scene.name_if_none(&path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default());
        Ok(scene)
    }

    /// Reads a scene's text; names of files in it are relative to `base`.
    ///
    /// # Errors
    /// [`SceneError`] with what is wrong and where.
    pub fn from_str(text: &str, base: &Path) -> Result<Self, SceneError> {
        let began = Instant::now();
        Self::from_json(&json::parse(text)?, &Records::new(base), began)
    }

    /// Reads a scene whose text was read from `began` on.
    pub(crate) fn from_json(json: &Json, records: &Records, began: Instant) -> Result<Self, SceneError> {
        let scene = Node::root(json).object("model, excitation, contacts, frequencies, …", &KEYS)?;
        let name = scene.get("name").map_or(Ok(""), |node| node.text("a name"))?;
        let (dofs, model) = model::read(&scene.need("model", "{\"dofs\": …}")?)?;
        let excitation = scene.need("excitation", "[{\"dof\": …, \"amplitude\": …}], or [] for none")?;
        let excitation = excitation::read(&excitation, &dofs)?;
        let contacts = contacts::read(scene.get("contacts"), &dofs, records)?;
        let form = "{\"from\": 20.0, \"to\": 200.0, \"points\": 721}";
        let frequencies = Frequencies::read(&scene.need("frequencies", form)?)?;
        let harmonics = scene.get("harmonics").map_or(Ok(Harmonics::ONE), |node| Harmonics::read(&node))?;
        let mut settings = Settings::new(1);
        let estimate = solver::read(scene.get("solver"), &mut settings)?;
        harmonics.apply(estimate, &mut settings);
        let mut problem = Problem { model, excitation, contacts: contacts.contacts, output: Vec::new() };
        problem.output = match scene.get("output") {
            Some(node) => read_output(&node, &dofs)?,
            None => usual_output(&problem, dofs.len()),
        };
        Ok(Self {
            name: name.to_owned(),
            dofs,
            problem,
            settings,
            estimate,
            frequencies,
            notes: contacts.notes,
            read_in: began.elapsed(),
        })
    }

    /// Calls a scene that has no name by that of its file.
    pub(crate) fn name_if_none(&mut self, name: &str) {
        if self.name.is_empty() {
            name.clone_into(&mut self.name);
        }
    }

    /// The same scene with another number of harmonics.
    ///
    /// # Errors
    /// When it is none.
    pub fn with_harmonics(mut self, harmonics: impl Into<Harmonics>) -> Result<Self, SceneError> {
        harmonics.into().check()?.apply(self.estimate, &mut self.settings);
        Ok(self)
    }

    /// The same scene at other frequencies.
    #[must_use]
    pub fn with_frequencies(mut self, frequencies: Frequencies) -> Self {
        self.frequencies = frequencies;
        self
    }

    /// The same scene with the displacements of other dofs recovered.
    ///
    /// # Errors
    /// When a name is no dof.
    pub fn with_output(mut self, names: &[String]) -> Result<Self, SceneError> {
        let index = |name: &String| {
            let known = self.dofs.names();
            known.iter().position(|dof| dof == name).ok_or_else(|| {
                let some: Vec<&str> = known.iter().take(EVERY_OUTPUT).map(String::as_str).collect();
                SceneError::entry("output", format!("there is no dof {name:?}; {}", suggestion(name, &some)))
            })
        };
        self.problem.output = names.iter().map(index).collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// The same scene with all solutions wanted, where they are known.
    #[must_use]
    pub fn with_all_solutions(mut self) -> Self {
        self.settings.all_solutions = true;
        self
    }

    /// The scene's name; that of its file when it has none.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the model's dofs.
    pub fn dofs(&self) -> &[String] {
        self.dofs.names()
    }

    /// Names of the dofs whose displacement is recovered.
    pub fn output(&self) -> Vec<&str> {
        let name = |dof: &usize| self.dofs.names().get(*dof).map(String::as_str);
        self.problem.output.iter().filter_map(name).collect()
    }

    /// Names of the contacts, those of `pairs` one by one.
    pub fn contacts(&self) -> impl Iterator<Item = &str> {
        self.problem.contacts.iter().map(|contact| contact.name.as_str())
    }

    /// How many harmonics its points have.
    pub fn harmonics(&self) -> Harmonics {
        match self.settings.truncation {
            Some(tolerance) => Harmonics::Needed { tolerance, max: self.settings.harmonics },
            None => Harmonics::All(self.settings.harmonics),
        }
    }

    /// The frequencies of the sweep.
    pub fn frequencies(&self) -> &Frequencies {
        &self.frequencies
    }

    /// The problem in the terms of the balance.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How it is to be solved.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What a user should know about the scene's data.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Makes everything that the frequencies share.
    ///
    /// # Errors
    /// [`SceneError`] when the problem cannot be solved as posed.
    pub fn prepare(&self) -> Result<Prepared<'_>, SceneError> {
        let began = Instant::now();
        let plan = Plan::new(&self.problem, &self.settings)
            .map_err(|error| SceneError::entry(&error.place, error.problem))?;
        Ok(Prepared::new(self, plan, self.read_in + began.elapsed()))
    }
}

fn read_output(node: &Node, dofs: &Dofs) -> Result<Vec<usize>, SceneError> {
    let mut output = Vec::new();
    for item in node.some("of names of dofs")? {
        let dof = dofs.index(&item)?;
        if output.contains(&dof) {
            return Err(item.error("is in the list already; keep one"));
        }
        output.push(dof);
    }
    Ok(output)
}

/// Every dof of a small model, else those that carry contacts or excitation.
fn usual_output(problem: &Problem, n: usize) -> Vec<usize> {
    if n <= EVERY_OUTPUT {
        return (0..n).collect();
    }
    let touched = problem.contacts.iter().flat_map(|contact| [Some(contact.first), contact.second]);
    let shaken =
        problem.excitation.iter().filter(|e| e.kind != hbm::ExcitationKind::Base).map(|e| Some(e.dof));
    let mut output: Vec<usize> = touched.chain(shaken).flatten().collect();
    output.sort_unstable();
    output.dedup();
    // A model that nothing touches and only its base shakes: its first dofs.
    if output.is_empty() { (0..EVERY_OUTPUT).collect() } else { output }
}
