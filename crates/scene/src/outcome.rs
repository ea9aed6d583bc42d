//! The result of a sweep as plain data for JSON, and its other written form, long CSV.

use arrays::{Cell, Kind, Table};
use contact::ContactState;
use hbm::{ContactSolution, DirectionSolution, JointSolution, Solution, Status};
use num_complex::Complex64;
use serde::ser::{SerializeMap, SerializeTuple};
use serde::{Serialize, Serializer};

use crate::contacts::Place;
use crate::notes;
use crate::reduction::ReductionFacts;
use crate::run::Solved;
use crate::scene::Scene;
use crate::stability::{self, PointStability};

/// The result of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// 1; raised when a reader of older results would be misled.
    pub format_version: u32,
    /// The scene's name.
    pub scene: String,
    /// The dofs whose displacement is given.
    pub dofs: Vec<String>,
    /// Units of every number.
    pub units: &'static str,
    /// How the structure was reduced; not there when it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reduction: Option<ReductionFacts>,
    /// What a user should be told.
    pub notes: Vec<String>,
    /// One entry a frequency, in the scene's order.
    pub points: Vec<Point>,
    /// How long it took; the one part that differs from run to run.
    pub timing: Timing,
}

/// How long a sweep took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// Reading the scene and planning, in s.
    pub setup_s: f64,
    /// Solving all points, in s.
    pub solve_s: f64,
    /// Threads that worked.
    pub threads: usize,
}

/// One frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// In Hz.
    pub frequency: f64,
    /// `converged`, `stuck` or `failed`.
    pub status: &'static str,
    /// N of this point.
    pub harmonics: usize,
    /// How many of its harmonics were found by substitution.
    pub slaved: usize,
    /// Newton steps, all attempts together.
    pub iterations: usize,
    /// Relative to the excitation.
    pub residual: f64,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Relative residuals of the last attempt of a failed point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_history: Option<Vec<f64>>,
    /// What was tried before a point was given up, in order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tried: Option<Vec<&'static str>>,
    /// Estimated relative l2 error of the displacement spectrum from having stopped at N, the worst of the dofs; `None`
    /// where no estimate was made.
    pub truncation_error: Option<f64>,
    /// Likewise from sampling the contact forces; 0 without samples.
    pub sampling_error: Option<f64>,
    /// How many solutions exist, where that is known.
    pub solutions: Option<usize>,
    /// Spectrum in m of each output dof; not there when the point failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Named<Spectrum>>,
    /// What each contact does; not there when the point failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<Named<ContactOutcome>>,
    /// Whether it is stable; not there when that was not asked for or the point failed, null where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stability: Option<Option<PointStability>>,
    /// The other solutions, where asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub others: Option<Vec<Point>>,
}

impl Point {
    /// Whether it is known to be unstable.
    pub fn is_unstable(&self) -> bool {
        matches!(&self.stability, Some(Some(stability)) if stability.stable == Some(false))
    }
}

/// One contact at one frequency: its law acts in one direction or in several.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ContactOutcome {
    /// In one.
    One(ContactPoint),
    /// In several.
    Several(JointPoint),
}

impl ContactOutcome {
    /// What the contact does: `stick`, `slip`, `mixed`, `held` or `apart`.
    pub fn state(&self) -> &'static str {
        match self {
            Self::One(contact) => contact.state,
            Self::Several(joint) => joint.state,
        }
    }

    /// In J per cycle.
    pub fn dissipation(&self) -> f64 {
        match self {
            Self::One(contact) => contact.dissipation,
            Self::Several(joint) => joint.dissipation,
        }
    }

    /// The motion left the range in which the law was measured.
    pub fn extrapolated(&self) -> bool {
        match self {
            Self::One(contact) => contact.extrapolated,
            Self::Several(joint) => joint.extrapolated,
        }
    }
}

/// One contact in one direction at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactPoint {
    /// Half the peak-to-peak relative displacement, in m.
    pub amplitude: f64,
    /// `stick`, `slip`, `mixed`, `held` or `apart`.
    pub state: &'static str,
    /// In J per cycle.
    pub dissipation: f64,
    /// Relative displacement first − second, in m.
    pub displacement: Spectrum,
    /// On the first body, in N.
    pub force: Spectrum,
    /// Reversals of the relative displacement in a period.
    pub turning_points: usize,
    /// The amplitude left the range in which the law was measured.
    pub extrapolated: bool,
}

/// One contact in several directions at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointPoint {
    /// `stick`, `slip`, `mixed` or `apart`.
    pub state: &'static str,
    /// Part of the period during which the bodies are apart, 0 … 1.
    pub apart: f64,
    /// Periods of the motion until the state of the contact repeats itself.
    pub cycles: usize,
    /// Of all directions together, in J per cycle.
    pub dissipation: f64,
    /// The motion left the range in which the law was measured.
    pub extrapolated: bool,
    /// `tangential` or `tangential1` and `tangential2`, then `normal`.
    pub directions: Named<DirectionPoint>,
}

/// One direction of a contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DirectionPoint {
    /// Half the peak-to-peak relative displacement, in m.
    pub amplitude: f64,
    /// Relative displacement, in m; towards each other is positive in the normal direction.
    pub displacement: Spectrum,
    /// On the first body along the direction's axis, in N, beyond what a preload exerts.
    pub force: Spectrum,
}

/// The names of `count` directions of a contact, the normal one last.
pub fn direction_names(count: usize) -> &'static [&'static str] {
    match count {
        0 | 1 => &["normal"],
        2 => &["tangential", "normal"],
        _ => &["tangential1", "tangential2", "normal"],
    }
}

/// Values under names, in a fixed order; an object in JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<T>(pub Vec<(String, T)>);

/// Harmonics and their one-sided complex amplitudes; `[[k, re, im], …]` in JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum(pub Vec<(usize, Complex64)>);

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

impl Serialize for Spectrum {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|(k, amplitude)| Line(*k, *amplitude)))
    }
}

/// `[k, re, im]`; the mean has no imaginary part.
struct Line(usize, Complex64);

impl Serialize for Line {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut line = serializer.serialize_tuple(3)?;
        line.serialize_element(&self.0)?;
        line.serialize_element(&self.1.re)?;
        if self.0 == 0 {
            line.serialize_element(&0)?
        } else {
            line.serialize_element(&self.1.im)?
        }
        line.end()
    }
}

impl Spectrum {
    pub(crate) fn new(orders: &[usize], amplitudes: &[Complex64]) -> Self {
        Self(orders.iter().copied().zip(amplitudes.iter().copied()).collect())
    }
}

impl Outcome {
    pub(crate) fn new(solved: &Solved, timing: Timing) -> Self {
        let (scene, plan) = (solved.prepared.scene, &solved.prepared.plan);
        let names = Names::of(scene, plan.orders());
        let mut notes = notes::all(solved.prepared, solved.solutions());
        let places = solved.solutions().iter().map(|solution| (solution.frequency, solution));
        notes.extend(stability::notes(places, &solved.unknown, " Hz"));
        if solved.interrupted() {
            let (done, all) = (solved.solutions().len(), scene.frequencies().as_slice().len());
            notes.push(format!("stopped after {done} of {all} points; the others are not in the result"));
        }
        Self {
            format_version: 1,
            scene: scene.name.clone(),
            dofs: names.dofs.iter().map(|name| (*name).to_owned()).collect(),
            units: "SI, Hz, rad",
            reduction: solved.prepared.reduction(),
            notes,
            points: solved.solutions().iter().map(|solution| names.point(solution, names.others)).collect(),
            timing,
        }
    }

    /// The displacements as a long table, one row a harmonic; a failed point has one row with empty values.
    pub fn table(&self) -> Table<'_> {
        let columns = [
            ("frequency", Kind::Plain),
            ("status", Kind::Text),
            ("dof", Kind::Text),
            ("harmonic", Kind::Whole),
            ("re", Kind::Number),
            ("im", Kind::Number),
        ];
        Table::new(columns, |take| {
            for point in &self.points {
                let (frequency, status) = (Cell::Number(point.frequency), Cell::Text(point.status));
                let Some(displacement) = &point.displacement else {
                    take(&[frequency, status, Cell::Missing, Cell::Missing, Cell::Missing, Cell::Missing])?;
                    continue;
                };
                for (dof, spectrum) in &displacement.0 {
                    for (k, w) in &spectrum.0 {
                        let (re, im) = (Cell::Number(w.re), Cell::Number(w.im));
                        take(&[frequency, status, Cell::Text(dof), Cell::Whole(*k), re, im])?;
                    }
                }
            }
            Ok(())
        })
    }
}

/// The names that turn a solution's rows and columns into a result.
pub(crate) struct Names<'a> {
    dofs: Vec<&'a str>,
    contacts: Vec<(&'a str, Place)>,
    orders: &'a [usize],
    others: bool,
    stability: bool,
}

impl<'a> Names<'a> {
    pub(crate) fn of(scene: &'a Scene, orders: &'a [usize]) -> Self {
        Self {
            dofs: scene.output(),
            contacts: scene.contacts().zip(scene.contacts.order.iter().copied()).collect(),
            orders,
            others: scene.settings.all_solutions,
            stability: scene.settings.stability,
        }
    }

    pub(crate) fn point(&self, solution: &Solution, others: bool) -> Point {
        let solved = solution.status.solved();
        let displacement = || {
            let rows = self.dofs.iter().zip(&solution.displacement);
            Named(rows.map(|(name, row)| ((*name).to_owned(), Spectrum::new(self.orders, row))).collect())
        };
        let contacts = || {
            let one = |(name, place): &(&str, Place)| {
                let answer = match *place {
                    Place::Contact(i) => ContactOutcome::One(self.contact(solution.contacts.get(i)?)),
                    Place::Joint(i) => ContactOutcome::Several(self.joint(solution.joints.get(i)?)),
                };
                Some(((*name).to_owned(), answer))
            };
            Named(self.contacts.iter().filter_map(one).collect())
        };
        let (status, reason) = match &solution.status {
            Status::Converged => ("converged", None),
            Status::Stuck => ("stuck", None),
            Status::Failed(reason) => ("failed", Some(reason.to_string())),
        };
        Point {
            frequency: solution.frequency,
            status,
            harmonics: solution.harmonics,
            slaved: solution.slaved,
            iterations: solution.stats.iterations,
            residual: solution.residual,
            reason,
            residual_history: (!solved).then(|| solution.residual_history.clone()),
            tried: (!solved).then(|| tried(&solution.stats)),
            truncation_error: solution.truncation_error,
            sampling_error: solution.sampling_error,
            solutions: solution.solutions,
            displacement: solved.then(displacement),
            contacts: solved.then(contacts),
            stability: (solved && self.stability)
                .then(|| solution.stability.as_ref().map(PointStability::new)),
            others: others.then(|| solution.others.iter().map(|other| self.point(other, false)).collect()),
        }
    }

    fn contact(&self, contact: &ContactSolution) -> ContactPoint {
        ContactPoint {
            amplitude: contact.amplitude,
            state: state(contact.state),
            dissipation: contact.dissipation,
            displacement: Spectrum::new(self.orders, &contact.displacement),
            force: Spectrum::new(self.orders, &contact.force),
            turning_points: contact.turning_points,
            extrapolated: contact.extrapolated,
        }
    }

    fn joint(&self, joint: &JointSolution) -> JointPoint {
        let direction = |direction: &DirectionSolution| DirectionPoint {
            amplitude: direction.amplitude,
            displacement: Spectrum::new(self.orders, &direction.displacement),
            force: Spectrum::new(self.orders, &direction.force),
        };
        let names = direction_names(joint.directions.len()).iter().map(|name| (*name).to_owned());
        JointPoint {
            state: state(joint.state),
            apart: joint.apart,
            cycles: joint.cycles,
            dissipation: joint.dissipation,
            extrapolated: joint.extrapolated,
            directions: Named(names.zip(joint.directions.iter().map(direction)).collect()),
        }
    }
}

fn state(state: ContactState) -> &'static str {
    match state {
        ContactState::Stick => "stick",
        ContactState::Slip => "slip",
        ContactState::Mixed => "mixed",
        ContactState::Held => "held",
        ContactState::Apart => "apart",
    }
}

/// The starts and fallbacks of a point, in the order of the solver.
fn tried(stats: &hbm::Stats) -> Vec<&'static str> {
    let all = [
        ("ladder of harmonics", stats.rungs),
        ("smaller rungs", stats.extra_rungs),
        ("homotopy from secant stiffnesses", stats.secant_homotopies),
        ("homotopy in the contact stiffness", stats.stiffness_homotopies),
        ("homotopy in the contact force", stats.contact_homotopies),
        ("homotopy in the excitation", stats.excitation_homotopies),
        ("homotopy in the damping", stats.damping_homotopies),
        ("homotopy along its arc", stats.arclength_homotopies),
        ("start at rest", stats.starts_at_rest),
        ("perturbed starts", stats.perturbed_starts),
        ("detours over other frequencies", stats.detours),
    ];
    all.into_iter().filter(|(_, count)| *count > 0).map(|(name, _)| name).collect()
}
