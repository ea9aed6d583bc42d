//! A scene: what is to be solved, read and checked.

use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use contact::Law;
use hbm::{Contact, Excitation, ExcitationKind, Jacobian, Plan, Problem, Settings};
use structure::Progress;

use crate::contacts::{self, Contacts};
use crate::dofs::Dofs;
use crate::error::SceneError;
use crate::excitation;
use crate::frequencies::Frequencies;
use crate::harmonics::Harmonics;
use crate::json::{self, Json};
use crate::model;
use crate::pose::Posed;
use crate::read::Node;
use crate::records::Records;
use crate::run::Prepared;
use crate::solver;
use crate::structure::Structure;

pub(crate) const KEYS: [&str; 8] =
    ["name", "model", "excitation", "contacts", "frequencies", "harmonics", "output", "solver"];

/// Up to this many dofs all are recovered when a scene does not say which.
const EVERY_OUTPUT: usize = 16;

/// A scene that was read and checked.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) name: String,
    pub(crate) structure: Structure,
    /// Its dofs and those of contacts and output are those of the structure that move.
    pub(crate) excitation: Vec<Excitation>,
    /// Directions of base excitations.
    pub(crate) directions: Vec<Option<String>>,
    pub(crate) contacts: Contacts,
    pub(crate) output: Vec<usize>,
    /// The problem in the terms of the balance, made when it is first needed.
    posed: OnceLock<Posed>,
    /// It is kept although harmonics and frequencies change.
    settled: bool,
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
        let structure = model::read(&scene.need("model", "{\"dofs\": …}")?, records)?;
        let dofs = structure.dofs();
        let excitation = scene.need("excitation", "[{\"dof\": …, \"amplitude\": …}], or [] for none")?;
        let excitation = excitation::read(&excitation, dofs)?;
        let contacts = contacts::read(scene.get("contacts"), dofs, records)?;
        let form = "{\"from\": 20.0, \"to\": 200.0, \"points\": 721}";
        let frequencies = Frequencies::read(&scene.need("frequencies", form)?)?;
        let harmonics = scene.get("harmonics").map_or(Ok(Harmonics::ONE), |node| Harmonics::read(&node))?;
        let mut settings = Settings::new(1);
        let estimate = solver::read(scene.get("solver"), &mut settings)?;
        harmonics.apply(estimate, &mut settings);
        let output = match scene.get("output") {
            Some(node) => read_output(&node, dofs)?,
            None => usual_output(&excitation.entries, &contacts, dofs.len()),
        };
        let notes = [structure.notes(), &excitation.notes, &contacts.notes].concat();
        Ok(Self {
            name: name.to_owned(),
            structure,
            excitation: excitation.entries,
            directions: excitation.directions,
            contacts,
            output,
            posed: OnceLock::new(),
            settled: false,
            settings,
            estimate,
            frequencies,
            notes,
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
        self.forget();
        Ok(self)
    }

    /// The same scene at other frequencies.
    #[must_use]
    pub fn with_frequencies(mut self, frequencies: Frequencies) -> Self {
        self.frequencies = frequencies;
        self.forget();
        self
    }

    /// The same scene with its structure made ready for the harmonics and frequencies it has now: it stays so, whatever
    /// they become. Only structures that are reduced depend on them.
    ///
    /// # Errors
    /// [`SceneError`] when the structure cannot be reduced.
    pub fn settled(mut self) -> Result<Self, SceneError> {
        self.posed(&mut |_| ())?;
        self.settled = true;
        Ok(self)
    }

    /// What was made for other harmonics and frequencies does not count.
    fn forget(&mut self) {
        if !self.settled {
            self.posed = OnceLock::new();
        }
    }

    /// The same scene with the displacements of other dofs recovered.
    ///
    /// # Errors
    /// When a name is no dof.
    pub fn with_output(self, names: &[String]) -> Result<Self, SceneError> {
        let index = |name: &String| {
            self.structure.dofs().find(name).map_err(|problem| SceneError::entry("output", problem))
        };
        let output = names.iter().map(index).collect::<Result<_, _>>()?;
        Ok(self.recovering(output))
    }

    pub(crate) fn recovering(mut self, output: Vec<usize>) -> Self {
        (self.output, self.posed) = (output, OnceLock::new());
        self
    }

    /// The same scene with all solutions wanted, where they are known.
    #[must_use]
    pub fn with_all_solutions(mut self) -> Self {
        self.settings.all_solutions = true;
        self
    }

    /// The same scene with the stability of every point wanted.
    #[must_use]
    pub fn with_stability(mut self) -> Self {
        self.settings.stability = true;
        self
    }

    /// The same scene with another law at the contacts called `name`, or `name[0]`, `name[1]`, …; its derivative is taken by
    /// differences. For laws that no scene file can hold.
    ///
    /// # Errors
    /// When there is no such contact.
    pub fn with_law(mut self, name: &str, law: &Arc<dyn Law>) -> Result<Self, SceneError> {
        let belongs = |contact: &Contact| {
            contact.name.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('['))
        };
        let mut found = false;
        for contact in self.contacts.contacts.iter_mut().filter(|contact| belongs(contact)) {
            contact.law = law.clone();
            found = true;
        }
        if !found {
            return Err(SceneError::entry("contacts", format!("there is no contact {name:?}")));
        }
        self.settings.jacobian = Jacobian::Difference;
        self.posed = OnceLock::new();
        Ok(self)
    }

    /// The scene's name; that of its file when it has none.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the model's dofs that move.
    pub fn dofs(&self) -> &[String] {
        self.structure.dofs().names()
    }

    /// Names of the dofs whose displacement is recovered.
    pub fn output(&self) -> Vec<&str> {
        let name = |dof: &usize| self.dofs().get(*dof).map(String::as_str);
        self.output.iter().filter_map(name).collect()
    }

    /// Names of the contacts in one direction and in several, those of `pairs` one by one.
    pub fn contacts(&self) -> impl Iterator<Item = &str> {
        self.contacts.names()
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

    /// The problem in the terms of the balance. A structure that is reduced has the dofs of contacts, excitation and
    /// output first, then modal coordinates; it is reduced when this is first asked for.
    ///
    /// # Errors
    /// [`SceneError`] when the structure cannot be reduced.
    pub fn problem(&self) -> Result<&Problem, SceneError> {
        self.problem_with(&mut |_| ())
    }

    /// Likewise, telling what is being done: a large structure takes its time.
    ///
    /// # Errors
    /// [`SceneError`] when the structure cannot be reduced.
    pub fn problem_with(&self, progress: &mut dyn FnMut(Progress)) -> Result<&Problem, SceneError> {
        Ok(&self.posed(progress)?.problem)
    }

    pub(crate) fn posed(&self, progress: &mut dyn FnMut(Progress)) -> Result<&Posed, SceneError> {
        if let Some(posed) = self.posed.get() {
            return Ok(posed);
        }
        let posed = self.pose(progress)?;
        Ok(self.posed.get_or_init(|| posed))
    }

    /// The harmonics of Ω that are excited.
    pub fn excited(&self) -> impl Iterator<Item = usize> {
        self.excitation.iter().filter(|entry| entry.amplitude != 0.0).map(|entry| entry.harmonic)
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
        self.prepare_with(&mut |_| ())
    }

    /// Likewise, telling what is being done: a large structure takes its time.
    ///
    /// # Errors
    /// [`SceneError`] when the problem cannot be solved as posed.
    pub fn prepare_with(&self, progress: &mut dyn FnMut(Progress)) -> Result<Prepared<'_>, SceneError> {
        let began = Instant::now();
        let refused = |error: hbm::PlanError| SceneError::entry(&error.place, error.problem);
        let (posed, plan) = match self.direct() {
            Some((problem, base)) => {
                (None, Plan::direct_with_base(&problem, &base, &self.settings).map_err(refused)?)
            }
            None => {
                let posed = self.posed(progress)?;
                (Some(posed), Plan::new(&posed.problem, &self.settings).map_err(refused)?)
            }
        };
        Ok(Prepared::new(self, posed, plan, self.read_in + began.elapsed()))
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
fn usual_output(excitation: &[Excitation], contacts: &Contacts, n: usize) -> Vec<usize> {
    if n <= EVERY_OUTPUT {
        return (0..n).collect();
    }
    let shaken = excitation.iter().filter(|e| e.kind != ExcitationKind::Base).map(|e| e.dof);
    let mut output: Vec<usize> = contacts.touched().chain(shaken).collect();
    output.sort_unstable();
    output.dedup();
    // A model that nothing touches and only its base shakes: its first dofs.
    if output.is_empty() { (0..EVERY_OUTPUT).collect() } else { output }
}
